//! The end of a move, and what stopped it.

use serde_json::{Value, json};

use biela::kinematics::{Blocked, Error, Path, Rates, Reason, Solver, StopLimit};
use biela::mechanism::{DriverId, Mechanism};

/// The outcome of a move.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The mechanism is where it was to go.
    Reached,
    /// The mechanism went as far as it could.
    Stopped(Obstacle),
    /// The mechanism is where it was before.
    Refused(Obstacle),
}

/// The cause of a stop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// The cause, for the reader.
    pub message: String,
    /// Global point of the cause \[m\], if it has one.
    pub at: Option<[f64; 2]>,
    /// Whether the mechanism can be assembled for the values asked for, on no continuous way.
    pub assembles: bool,
}

impl Outcome {
    /// Returns the outcome as the answer to a request; `place` returns a global point in the
    /// picture.
    pub(super) fn answer(&self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Value {
        let (word, obstacle) = match self {
            Self::Reached => return json!({ "outcome": "reached" }),
            Self::Stopped(obstacle) => ("stopped", obstacle),
            Self::Refused(obstacle) => ("refused", obstacle),
        };
        json!({
            "outcome": word,
            "message": obstacle.message,
            "at": obstacle.at.map(place),
            "assembles": obstacle.assembles,
        })
    }
}

impl Obstacle {
    /// Returns an obstacle without a place.
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            ..Self::default()
        }
    }

    /// Returns what stopped the solver on a path, which is at the last pose reached; `moves` tells
    /// which drivers move.
    pub(super) fn of_stop(
        blocked: &Blocked,
        solver: &Solver,
        path: &Path,
        moves: impl Fn(DriverId) -> bool,
    ) -> Self {
        let pose = solver.pose();
        let time = (path.duration > 0.0).then_some(pose.time);
        // The file does not know the drivers with which the hand holds it.
        let drivers = &solver.mechanism().drivers;
        let is_named = |id: DriverId| moves(id) && !drivers[id.index()].name.is_empty();
        let names: Vec<&str> = match &blocked.reason {
            Reason::Singular(point) => point.bodies.iter().map(String::as_str).collect(),
            Reason::Contradiction(open) => vec![&open.origin],
            _ => Vec::new(),
        };
        let at = match &blocked.reason {
            Reason::Stop(limit) => place_of_stop(limit, solver),
            _ => place_of(&names, solver),
        };
        Self {
            message: blocked.describe(solver.mechanism(), pose, time, is_named),
            at,
            assembles: false,
        }
    }

    /// Returns the error of an assembly; the solver is at a valid pose.
    pub(super) fn of_assembly(error: &Error, solver: &Solver) -> Self {
        let names: Vec<&str> = match error {
            Error::NotAssembled { open, .. } => open.iter().map(|o| o.origin.as_str()).collect(),
            Error::Singular { bodies, .. } => bodies.iter().map(String::as_str).collect(),
            _ => Vec::new(),
        };
        Self {
            message: error.to_string(),
            at: place_of(&names, solver),
            assembles: false,
        }
    }
}

/// Returns the point to which a stop measures, or which is on a curve.
fn place_of_stop(limit: &StopLimit, solver: &Solver) -> Option<[f64; 2]> {
    let mechanism = solver.mechanism();
    let stops = mechanism
        .stops
        .iter()
        .map(|stop| (&stop.name, stop.coordinate.to));
    let joints = mechanism.joints.iter().map(|joint| (&joint.name, joint.to));
    let (_, marker) = stops.chain(joints).find(|(name, _)| **name == limit.stop)?;
    let none = Rates::new(solver.pose().q.len());
    Some(solver.marker(marker, &none).map(|jet| jet.value))
}

/// Returns the place of things that messages name as joint `A` or body `rod`: a joint that is
/// named, one between two bodies that are, or a body.
fn place_of(names: &[&str], solver: &Solver) -> Option<[f64; 2]> {
    let mechanism: &Mechanism = solver.mechanism();
    let plain: Vec<&str> = names
        .iter()
        .filter_map(|name| name.split('`').nth(1))
        .collect();
    let is_named = |name: &str| plain.contains(&name);
    let is_body_named = |marker: biela::mechanism::MarkerId| {
        let body = mechanism.markers[marker.index()].body;
        body.is_some_and(|body| is_named(&mechanism.bodies[body.index()].name))
    };
    let joints = &mechanism.joints;
    let joint = (joints.iter().find(|joint| is_named(&joint.name)))
        .or_else(|| (joints.iter()).find(|j| is_body_named(j.from) && is_body_named(j.to)))
        .or_else(|| (joints.iter()).find(|j| is_body_named(j.to)));
    let none = Rates::new(solver.pose().q.len());
    joint.map(|joint| solver.marker(joint.to, &none).map(|jet| jet.value))
}
