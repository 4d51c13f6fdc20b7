//! Events of a free motion, and how they are called.

use crate::mechanism::{Force, Joint, Mechanism, fixed, shown};

/// An event of a free motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time \[s\].
    pub time: f64,
    /// Index of the force of the stop or of friction in the mechanism.
    pub force: usize,
    /// Its kind.
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// A coordinate meets a stop.
    Impact {
        /// Speed before \[m/s or rad/s\].
        speed: f64,
    },
    /// A coordinate comes to rest at a stop: after the last bounce, if it bounces.
    Rests,
    /// A coordinate leaves a stop at which it rested.
    Leaves,
    /// Friction begins to stick.
    Sticks,
    /// Friction ceases to stick.
    Slides,
}

impl Event {
    /// Describes the event, with its time.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let Force { name, load, .. } = &mechanism.forces[self.force];
        let coordinate = load.coordinate();
        let coordinate = coordinate.expect("events are those of passive forces");
        let joint = load.play().map(|joint| &mechanism.joints[joint]);
        let speed = |speed| {
            let unit = coordinate.kind.units()[1].suffix();
            format!("{}{unit}", shown(speed))
        };
        let happens = match (self.kind, joint.map(Joint::rope)) {
            (EventKind::Impact { speed: before }, None) => {
                format!("impact at stop `{name}` with {}", speed(before))
            }
            (EventKind::Rests, None) => format!("rest at stop `{name}`"),
            (EventKind::Leaves, None) => format!("stop `{name}` is left"),
            (EventKind::Impact { speed: before }, Some(Some(_))) => {
                format!("rope `{name}` pulls taut with {}", speed(before))
            }
            (EventKind::Rests, Some(Some(_))) => format!("rope `{name}` is taut"),
            (EventKind::Leaves, Some(Some(_))) => format!("rope `{name}` goes slack"),
            (EventKind::Impact { speed: before }, Some(None)) => {
                format!("the parts of joint `{name}` meet with {}", speed(before))
            }
            (EventKind::Rests, Some(None)) => format!("the parts of joint `{name}` touch"),
            (EventKind::Leaves, Some(None)) => format!("the parts of joint `{name}` part"),
            (EventKind::Sticks, _) => format!("friction `{name}` sticks"),
            (EventKind::Slides, _) => format!("friction `{name}` slides"),
        };
        format!("t = {} s: {happens}", fixed(self.time, 9))
    }
}
