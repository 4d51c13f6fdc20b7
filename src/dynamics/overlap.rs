//! Overlaps of parts, as they are told.

use super::event::Meeting;
use crate::mechanism::{
    CoordinateKind, Driver, DriverId, DriverSource, Force, Mechanism, show_time, shown, shown_apart,
};

/// Parts that overlapped, and the freedoms that were moved to bring them apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Time \[s\].
    pub time: f64,
    /// Index of the force of each stop or joint in the mechanism, and how far its coordinate was beyond
    /// the limit \[m or rad\].
    pub depths: Vec<(usize, f64)>,
    /// Each freedom that was moved, with its values before and after \[m or rad\].
    pub moves: Vec<(DriverId, [f64; 2])>,
}

impl Overlap {
    /// Describes what overlapped, by how much, and which freedoms were moved, with the time.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let moves = self.moves.iter().map(|(freedom, [from, to])| {
            let driver = &mechanism.drivers[freedom.index()];
            let (factor, unit) = display(own_kind(driver));
            let [from, to] = shown_apart(from * factor, to * factor);
            format!("`{}` from {from} {unit} to {to} {unit}", driver.name)
        });
        let moves: Vec<_> = moves.collect();
        format!(
            "t = {} s: {}; moved apart: {}",
            show_time(self.time),
            describe(&self.depths, mechanism),
            moves.join(", ")
        )
    }
}

/// Returns the unit in which messages show a coordinate, with its factor.
fn display(kind: CoordinateKind) -> (f64, &'static str) {
    if kind.is_angle() {
        (1_f64.to_degrees(), "deg")
    } else {
        (1.0, "m")
    }
}

/// Returns the kind of a freedom's own coordinate, whatever the one in use.
pub(super) fn own_kind(driver: &Driver) -> CoordinateKind {
    match &driver.source {
        DriverSource::Free {
            named: Some(own), ..
        } => own.kind,
        _ => driver.coordinate.kind,
    }
}

/// Describes what overlaps, and by how much.
pub(super) fn describe(depths: &[(usize, f64)], mechanism: &Mechanism) -> String {
    let depths = depths.iter().map(|&(force, depth)| {
        let Force { name, load, .. } = &mechanism.forces[force];
        let coordinate = load.coordinate().expect("stops and joints have one");
        let (factor, unit) = display(coordinate.kind);
        let depth = format!("{} {unit}", shown(depth * factor));
        match Meeting::of(load, mechanism) {
            Meeting::Stop(stop) => format!("{stop} `{name}` is passed by {depth}"),
            Meeting::Rope => format!("rope `{name}` is too short by {depth}"),
            Meeting::Parts => format!("the parts of joint `{name}` overlap by {depth}"),
        }
    });
    depths.collect::<Vec<_>>().join(", ")
}
