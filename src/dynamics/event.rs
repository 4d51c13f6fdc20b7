//! Events of a free motion, and how they are called.

use crate::mechanism::{Coordinate, Force, Load, Mechanism, fixed, shown};

/// An event of a free motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time \[s\].
    pub time: f64,
    /// Index of the force of the stop or of friction in the mechanism, of a contact that of its first
    /// element.
    pub force: usize,
    /// Its kind.
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// A coordinate meets a stop, or two shapes meet.
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

impl EventKind {
    /// Returns its word in tables: `impact`, `rests`, `leaves`, `sticks` or `slides`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Impact { .. } => "impact",
            Self::Rests => "rests",
            Self::Leaves => "leaves",
            Self::Sticks => "sticks",
            Self::Slides => "slides",
        }
    }
}

/// Kinds of what meets at a contact: each has words of its own.
pub(super) enum Meeting {
    /// A coordinate and its stop, or two shapes; the word for it.
    Stop(&'static str),
    /// The ends of a rope, as it is pulled taut.
    Rope,
    /// The two parts of another joint with play.
    Parts,
}

impl Meeting {
    /// Returns what meets where a passive force acts.
    pub(super) fn of(load: &Load, mechanism: &Mechanism) -> Self {
        match load.play().map(|joint| &mechanism.joints[joint]) {
            None => Self::Stop(match load.coordinate().and_then(Coordinate::shapes) {
                Some(_) => "contact",
                None => "stop",
            }),
            Some(joint) if joint.rope().is_some() => Self::Rope,
            Some(_) => Self::Parts,
        }
    }
}

impl Event {
    /// Describes the event, with its time.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let Force { name, load, .. } = &mechanism.forces[self.force];
        let coordinate = load.coordinate();
        let coordinate = coordinate.expect("events are those of passive forces");
        let speed = |speed| {
            let unit = coordinate.kind.units()[1].suffix();
            format!("{}{unit}", shown(speed))
        };
        let happens = match (self.kind, Meeting::of(load, mechanism)) {
            (EventKind::Impact { speed: before }, Meeting::Stop(stop)) => {
                format!("impact at {stop} `{name}` with {}", speed(before))
            }
            (EventKind::Rests, Meeting::Stop(stop)) => format!("rest at {stop} `{name}`"),
            (EventKind::Leaves, Meeting::Stop(stop)) => format!("{stop} `{name}` is left"),
            (EventKind::Impact { speed: before }, Meeting::Rope) => {
                format!("rope `{name}` pulls taut with {}", speed(before))
            }
            (EventKind::Rests, Meeting::Rope) => format!("rope `{name}` is taut"),
            (EventKind::Leaves, Meeting::Rope) => format!("rope `{name}` goes slack"),
            (EventKind::Impact { speed: before }, Meeting::Parts) => {
                format!("the parts of joint `{name}` meet with {}", speed(before))
            }
            (EventKind::Rests, Meeting::Parts) => format!("the parts of joint `{name}` touch"),
            (EventKind::Leaves, Meeting::Parts) => format!("the parts of joint `{name}` part"),
            (EventKind::Sticks, _) => format!("friction `{name}` sticks"),
            (EventKind::Slides, _) => format!("friction `{name}` slides"),
        };
        format!("t = {} s: {happens}", fixed(self.time, 9))
    }
}
