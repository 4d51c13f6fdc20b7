//! State of a drawing, and its lack until it is a mechanism that moves, in plain words.

use super::drawn::Drawn;
use biela::mechanism::{Driver, Joint, MarkerId};

/// The state of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Nothing is drawn.
    Empty,
    /// It moves, and something is not driven yet.
    Undriven,
    /// All is driven.
    Driven,
    /// Some of it moves by forces.
    Free,
    /// It does not close, or too much is driven.
    Open,
    /// It is rigid.
    Rigid,
}

impl State {
    /// Returns the state of a drawing.
    pub(super) fn of(drawn: &Drawn) -> Self {
        let Some(mechanism) = &drawn.mechanism else {
            return Self::Empty;
        };
        if drawn.open.is_some() {
            Self::Open
        } else if drawn.undriven > 0 {
            Self::Undriven
        } else if mechanism.drivers.is_empty() {
            Self::Rigid
        } else if mechanism.has_freedoms() {
            Self::Free
        } else {
            Self::Driven
        }
    }

    /// Returns the word for scripts.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::Undriven => "undriven",
            Self::Driven => "driven",
            Self::Free => "free",
            Self::Open => "open",
            Self::Rigid => "rigid",
        }
    }
}

/// Says what there is, and what is to be done next.
pub(super) fn sentence(drawn: &Drawn) -> String {
    let drivers = drawn.mechanism.as_ref().map_or(&[][..], |m| &m.drivers);
    let driven = drivers.len();
    let freedom = degrees(driven + drawn.undriven);
    match State::of(drawn) {
        State::Empty => "an empty sheet: draw a link by clicking its two ends".to_owned(),
        State::Open => {
            let error = drawn.open.as_ref();
            error.map(ToString::to_string).unwrap_or_default()
        }
        State::Rigid => "nothing can move: no degree of freedom is left".to_owned(),
        State::Undriven => {
            let lacking = match (driven, drawn.undriven) {
                _ if !is_on_ground(drawn) => {
                    "fix a point to ground, by a pivot or a slider".to_owned()
                }
                (0, 1) => "add a driver at a joint, or let it move freely".to_owned(),
                (0, count) => format!("{count} drivers are to be added, or more joints"),
                (_, 1) => "one is not driven yet: add a driver or a joint".to_owned(),
                (_, count) => {
                    format!("{count} are not driven yet: add as many drivers, or joints")
                }
            };
            format!("{freedom}: {lacking}")
        }
        State::Driven => format!("{freedom}, all driven: ready"),
        State::Free => {
            let free = drivers
                .iter()
                .filter(|driver| Driver::is_free(driver))
                .count();
            match driven - free {
                0 => format!("{freedom}, moved by forces: ready"),
                driven => format!("{freedom}: {driven} driven, {free} moved by forces: ready"),
            }
        }
    }
}

/// Returns whether a joint or a driver holds a body on ground.
fn is_on_ground(drawn: &Drawn) -> bool {
    drawn.mechanism.as_ref().is_some_and(|mechanism| {
        let of_ground = |id: MarkerId| mechanism.markers[id.index()].body.is_none();
        let mut joints = mechanism.joints.iter().flat_map(Joint::markers);
        let drivers = mechanism
            .drivers
            .iter()
            .flat_map(|d| d.coordinate.markers());
        joints.any(of_ground) || drivers.into_iter().any(of_ground)
    })
}

fn degrees(count: usize) -> String {
    match count {
        1 => "1 degree of freedom".to_owned(),
        _ => format!("{count} degrees of freedom"),
    }
}
