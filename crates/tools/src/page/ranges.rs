//! Ranges and speeds of the drivers that a reader moves.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{End, RangeSettings, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism};

/// Resolution and extent of the ranges of drivers: steps of three degrees, one turn, lengths up to
/// the size of the mechanism.
const RANGE: RangeSettings = RangeSettings {
    samples: 120,
    turns: 1,
    lengths: 1.0,
    bounds: [None; 2],
    transmission: false,
};
/// Time that a driver takes for a turn, or from one end of its range to the other \[s\].
const PERIOD: [f64; 2] = [4.0, 2.0];

/// The range of a driver that is an input.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DriverRange {
    /// The ends \[m or rad\]; of a driver that turns fully, one turn.
    pub(super) ends: [f64; 2],
    /// Whether the driver turns fully.
    pub(super) turns: bool,
    /// The cause of each end, in a few words; `None` where the range goes on.
    pub(super) causes: [Option<String>; 2],
}

/// Returns the range of each driver that is an input, and poses in the ranges; none for drivers
/// beyond the first `own`, with which the hand holds the mechanism.
pub(super) fn driver_ranges(
    solver: &mut Solver,
    own: usize,
) -> (Vec<Option<DriverRange>>, Vec<Vec<f64>>) {
    let mechanism = Arc::clone(solver.mechanism());
    let home = solver.pose().clone();
    let mut poses = Vec::new();
    let ranges = mechanism.drivers.iter().enumerate().map(|(index, driver)| {
        if driver.motion().is_some() || index >= own {
            return None;
        }
        let range = solver.range(DriverId(index), &RANGE);
        let value = home.drivers[index];
        let is_angle = driver.coordinate.kind.is_angle();
        let end = |end: &End| match end {
            End::Turns(_) => None,
            End::Singular(point) => Some(point.drivers[index]),
            End::NotFound { .. } if is_angle => None,
            End::Stop { value, .. }
            | End::Blocked { value, .. }
            | End::Bound { value }
            | End::NotFound { value } => Some(*value),
        };
        let ends = [end(&range.lower), end(&range.upper)];
        let causes = [cause(&range.lower, "min"), cause(&range.upper, "max")];
        poses.extend(range.samples.into_iter().map(|sample| sample.pose.q));
        let turns = ends == [None, None];
        let ends = match ends {
            [Some(low), Some(high)] => [low, high],
            [Some(low), None] => [low, low + TAU],
            [None, Some(high)] => [high - TAU, high],
            [None, None] => {
                let low = TAU * (value / TAU).floor();
                [low, low + TAU]
            }
        };
        Some(DriverRange {
            ends,
            turns,
            causes,
        })
    });
    let ranges = ranges.collect();
    solver.restore(&home);
    (ranges, poses)
}

/// Returns the cause of the end of a range; `key` of the driver bounds it on this side.
fn cause(end: &End, key: &str) -> Option<String> {
    match end {
        End::Turns(_) | End::NotFound { .. } => None,
        End::Singular(_) => Some("dead point".to_owned()),
        End::Stop { limit, .. } => Some(format!("stop `{}`", limit.stop)),
        End::Blocked { .. } => Some("blocked".to_owned()),
        End::Bound { .. } => Some(format!("`{key}`")),
    }
}

/// Returns rates for drivers that are inputs: a turn, or the range, in some seconds.
pub(super) fn driver_speeds(mechanism: &Mechanism, ranges: &[Option<DriverRange>]) -> Vec<Jet> {
    let drivers = mechanism.drivers.iter().zip(ranges);
    let rates = drivers.map(|(driver, range)| match range {
        Some(_) if driver.coordinate.kind.is_angle() => TAU / PERIOD[0],
        Some(range) => (range.ends[1] - range.ends[0]) / PERIOD[1],
        None => 0.0,
    });
    rates.map(|rate| Jet::new(0.0, [rate, 0.0])).collect()
}

/// Returns the rates of the drivers at the start: the usual ones; beside freedoms, which move by
/// themselves, all others rest.
pub(super) fn start_rates(mechanism: &Mechanism, ranges: &[Option<DriverRange>]) -> Vec<Jet> {
    if !mechanism.has_freedoms() {
        return driver_speeds(mechanism, ranges);
    }
    let drivers = mechanism.drivers.iter();
    drivers
        .map(|driver| Jet::new(0.0, [driver.start_velocity(), 0.0]))
        .collect()
}
