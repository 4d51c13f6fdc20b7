//! Masses and forces of a link.

use super::Reader;
use super::link::Link;
use crate::exchange::draft::{Draft, Force, ForceKind, GROUND, LengthUnit, Mass, Point};
use crate::exchange::error::{Error, start_of};
use crate::exchange::note::Note;
use biela::mechanism::rounded;

/// Newtons per pound-force.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// Acceleration of gravity \[m/s²\].
const GRAVITY: f64 = 9.81;

impl Reader<'_> {
    /// Takes over the masses of links, unless all are the placeholders of a new link.
    pub(super) fn masses(&self, draft: &mut Draft) {
        let stands_for_none = |link: &&Link| (link.mass, link.inertia) == (1.0, 1.0);
        let links = &self.query.links;
        let reason = if links
            .iter()
            .filter(|link| !link.is_block)
            .all(|link| stands_for_none(&link))
        {
            "they are the placeholders of the source, 1 and 1"
        } else {
            let (mass, inertia, unit) = match self.query.unit {
                LengthUnit::Centimetre => (1e-3, 1e-4, "g and kg cm²"),
                LengthUnit::Metre => (1.0, 1.0, "kg and kg m²"),
                _ => (0.0, 0.0, ""),
            };
            if mass > 0.0 {
                self.take_masses(draft, mass, inertia);
                draft.note(Note::MassUnit { unit });
                return;
            }
            "the link does not tell their unit"
        };
        draft.note(Note::Masses { reason });
    }

    fn take_masses(&self, draft: &mut Draft, mass: f64, inertia: f64) {
        let has_root = self.query.links.iter().any(|link| link.is_root);
        for link in &self.query.links {
            let Some(&body) = self.body_of.get(&*link.id) else {
                continue;
            };
            if link.mass <= 0.0 || body == GROUND || (has_root && !link.is_root) {
                continue;
            }
            // A block has no place of its own but its joint's.
            let center = match link.joints.first().filter(|_| link.is_block) {
                Some(id) => self
                    .points
                    .get(&**id)
                    .map(|point| self.query.joints[*point].at),
                None => Some(link.center),
            };
            let added = Mass {
                mass: rounded(link.mass * mass, 12),
                inertia: rounded(
                    if link.is_block {
                        0.0
                    } else {
                        link.inertia * inertia
                    },
                    12,
                ),
                center: center.unwrap_or_default(),
            };
            let known = &mut draft.bodies[body.0].mass;
            *known = Some(match known.take() {
                None => added,
                Some(known) => known.with(&added, draft.unit.metres()),
            });
        }
        let gravity = if self.query.has_gravity { GRAVITY } else { 0.0 };
        draft.gravity = Some([0.0, -rounded(gravity / draft.unit.metres(), 9)]);
    }

    pub(super) fn forces(&self, draft: &mut Draft) -> Result<(), Error> {
        // In inches forces are pounds.
        let unit = match (self.query.unit, self.query.force_unit) {
            (LengthUnit::Inch, _) => Some(POUND_FORCE),
            (_, 0 | 1) => Some(1.0),
            _ => None,
        };
        for force in &self.query.forces {
            let left_out = |reason| Note::LeftOut {
                kind: "force",
                name: start_of(&force.name),
                reason,
            };
            let body = self.body_of.get(&*force.link);
            let body = *body.ok_or_else(|| Error::Unknown {
                place: format!("force `{}`", start_of(&force.name)),
                kind: "link",
                name: start_of(&force.link),
            })?;
            let [at, to] = force.line;
            let way = [to[0] - at[0], to[1] - at[1]];
            let length = way[0].hypot(way[1]);
            let Some(unit) = unit else {
                draft.note(left_out("its unit is not known"));
                continue;
            };
            if !force.is_outward {
                draft.note(left_out("its arrow is drawn the other way round"));
                continue;
            }
            if body == GROUND || length <= 0.0 {
                draft.note(left_out("it moves nothing"));
                continue;
            }
            let point = draft.add_point(
                body,
                Point {
                    name: force.name.clone(),
                    at,
                    // Axes as drawn turn with the body.
                    angle: force.is_local.then_some(0.0),
                },
            );
            let value = way.map(|part| {
                let part = rounded(force.size * unit * part / length, 9);
                format!("{}", part + 0.0)
            });
            draft.forces.push(Force {
                name: force.name.clone(),
                kind: ForceKind::At {
                    point,
                    axes: force.is_local.then_some(point),
                    value,
                    torque: "0".to_owned(),
                },
            });
        }
        Ok(())
    }
}
