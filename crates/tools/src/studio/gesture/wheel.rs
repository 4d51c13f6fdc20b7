//! Wheels: where they have their centres, and what carries them.

use super::shift::refresh_estimates;
use super::{Editing, Onto, Refusal, Target, marker_name};
use biela::mechanism::MarkerId;

/// The centre of a wheel.
pub(super) struct Centre {
    /// Global point \[m\].
    pub(super) at: [f64; 2],
    /// Bodies that carry it, by their names; `ground` for ground.
    pub(super) carriers: Vec<String>,
    /// The marker at the centre of a wheel that is there already.
    wheel: Option<MarkerId>,
    target: Target,
}

impl Centre {
    /// Returns the centre of a wheel at a target; a `fixed` one is part of the body of the marker there.
    pub(super) fn of(editing: &Editing, target: &Target, fixed: bool) -> Result<Self, Refusal> {
        let at = editing.settled(target)?;
        let target = Target {
            at,
            onto: target.onto.clone(),
        };
        let path = match &target.onto {
            Onto::Marker(path) => path.clone(),
            Onto::Body(body) => {
                editing.body(body)?;
                return Ok(Self {
                    at,
                    carriers: vec![body.clone()],
                    wheel: None,
                    target,
                });
            }
            Onto::Ground | Onto::Sheet => {
                let carriers = vec!["ground".to_owned()];
                return Ok(Self {
                    at,
                    carriers,
                    wheel: None,
                    target,
                });
            }
        };
        let mechanism = editing.mechanism()?;
        let marker = editing.marker(&path)?;
        let pinned = editing.drawn.pinned_to(marker);
        let wheels = mechanism.joints.iter().flat_map(|joint| {
            let own = joint.wheels();
            let second = own.filter(|wheels| !wheels.is_on_line()).map(|_| joint.to);
            own.map(|_| joint.from).into_iter().chain(second)
        });
        // The ring of a planetary gear may be ground, which is no wheel that turns.
        let mut wheels = wheels.filter(|id| mechanism.markers[id.index()].body.is_some());
        let wheel = if fixed && mechanism.markers[marker.index()].body.is_some() {
            Some(marker)
        } else {
            wheels.find(|id| pinned.contains(id))
        };
        let others = pinned.iter().filter(|id| Some(**id) != wheel);
        let carriers = others.map(|id| editing.body_of(*id).map(str::to_owned));
        let carriers: Vec<String> = carriers.collect::<Result<_, _>>()?;
        Ok(Self {
            at,
            carriers,
            wheel,
            target,
        })
    }

    /// Writes the places of all bodies where the wheel will mesh with one that may have turned, as the
    /// estimates decide how it does.
    pub(super) fn settle(&self, editing: &mut Editing) {
        /// Part of the drawing's size, and angle \[rad\]: about the last digit of an estimate.
        const FAR: f64 = 2e-4;
        if self.wheel.is_some() || self.carriers.iter().all(|body| body != "ground") {
            refresh_estimates(editing, FAR);
        }
    }

    /// Returns the path of the marker at the centre of the wheel, which is made and pinned if there is
    /// none yet.
    pub(super) fn make(&self, editing: &mut Editing, word: &str) -> Result<String, Refusal> {
        if let Some(wheel) = self.wheel {
            return Ok(editing.mechanism()?.marker_path(wheel));
        }
        let carrier = editing.marker_at(&self.target)?;
        let letter = marker_name(&carrier).to_owned();
        let [x, y] = self.at;
        let body = editing.add_body(word, &[(letter.clone(), [0.0; 3])], [x, y, 0.0]);
        let centre = format!("{body}.{letter}");
        editing.join(&letter, "revolute", [&carrier, &centre]);
        Ok(centre)
    }
}
