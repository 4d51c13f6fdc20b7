//! Contacts and friction that hold coordinates, in words.

use super::event::Meeting;
use super::motion::FreeMotion;
use super::passive::Mode;
use crate::mechanism::{Force, Mechanism, shown};

/// A contact that pushes, or friction that sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Index of its force in the mechanism.
    pub force: usize,
    /// The force along its coordinate \[N or N m\]: the output `….effort` of a stop and of friction.
    pub size: f64,
    /// Force up to which friction sticks \[N or N m\], `None` for a contact.
    pub limit: Option<f64>,
}

impl Held {
    /// Returns the name of the stop, the joint or the friction.
    #[must_use]
    pub fn name<'a>(&self, mechanism: &'a Mechanism) -> &'a str {
        &mechanism.forces[self.force].name
    }

    /// Describes what holds, with its force.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let Force { name, load, .. } = &mechanism.forces[self.force];
        let coordinate = load.coordinate();
        let kind = coordinate.expect("it acts along a coordinate").kind;
        let unit = kind.effort_unit().suffix();
        let (size, push) = (shown(self.size), shown(self.size.abs()));
        match (self.limit, Meeting::of(load, mechanism)) {
            (Some(limit), _) => format!(
                "friction `{name}` sticks, {size}{unit} of up to {}{unit}",
                shown(limit)
            ),
            (None, Meeting::Stop(stop)) => format!("on {stop} `{name}`, {push}{unit}"),
            (None, Meeting::Rope) => format!("rope `{name}` is taut, {push}{unit}"),
            (None, Meeting::Parts) => format!("the parts of joint `{name}` touch, {push}{unit}"),
        }
    }
}

impl FreeMotion {
    /// Returns the number of places at which a contact touches at the accepted point, by the index of its
    /// stop.
    pub(super) fn touching(&self, mechanism: &Mechanism, stop: usize) -> u32 {
        let shapes = mechanism.stops[stop].coordinate.shapes();
        let passive = &self.equations.passive;
        let all = passive.list.iter().zip(&passive.modes);
        let touching =
            all.filter(|(own, mode)| own.coordinate.shapes() == shapes && **mode != Mode::Free);
        touching.map(|_| 1).sum()
    }

    /// Returns the contacts and frictions that hold coordinates at the accepted point.
    #[must_use]
    pub fn held(&self) -> Vec<Held> {
        let passive = &self.equations.passive;
        let points = self.equations.accepted.passive.iter().enumerate();
        let held = points.filter(|(k, _)| passive.is_held(*k) && self.equations.moves(*k));
        let mut list: Vec<Held> = Vec::new();
        for own in held.map(|(k, at)| self.holding(k, at.force)) {
            // A contact has the sum of its elements.
            match list.last_mut().filter(|last| last.force == own.force) {
                Some(last) => last.size += own.size,
                None => list.push(own),
            }
        }
        list
    }

    /// Returns what a passive force holds with this size.
    pub(super) fn holding(&self, force: usize, size: f64) -> Held {
        let passive = &self.equations.passive.list[force];
        let at = &self.equations.accepted.passive[force];
        Held {
            force: self.equations.passive.told(force),
            size,
            limit: passive.cause.friction().map(|_| at.bounds[1]),
        }
    }
}
