//! Drivers whose values at the poses of a target are free.

use std::f64::consts::TAU;

use biela::kinematics::Direction;
use biela::mechanism::{DriverId, Jet, Mechanism};

use crate::error::Failure;

/// Number of steps per turn of a driver, or in the range of a length, at whose ends the nearest pose
/// to each target is looked for.
const STEPS: usize = 36;
/// Largest number of turns that are scanned one way: some paths, such as those of geared cranks,
/// close after two.
const TURNS: usize = 2;
/// Largest number of steps one way; the last one tells whether the curve closes.
pub(crate) const MOST_STEPS: usize = TURNS * STEPS + 1;
/// Largest distance between the ends of a closed curve, as part of its extent. Next to a singular
/// position rounding is the root of machine precision, 1.5e-8.
const CLOSED: f64 = 1e-6;

/// A driver whose values at the rows of a target are free.
pub(crate) struct FreeDriver {
    pub(crate) driver: DriverId,
    /// Direction in which its value grows.
    pub(crate) direction: Direction,
    /// Limits of the values; infinite for an angle without limits.
    pub(crate) bounds: [f64; 2],
    /// Distance between two values at which the nearest poses are looked for.
    pub(crate) step: f64,
    /// Whether its values at the rows ascend or descend, within a turn or its range.
    in_order: bool,
}

/// Values of a target's variables along the motion of its free driver, at equal steps.
pub(crate) struct SampledVariables {
    /// The driver's value and the values of the variables at each point.
    pub(crate) points: Vec<(f64, Vec<f64>)>,
    /// Whether the last point is the first one again, after full turns of the driver.
    pub(crate) closes: bool,
}

impl SampledVariables {
    pub(crate) fn new(driver: f64, values: Vec<f64>) -> Self {
        Self {
            points: vec![(driver, values)],
            closes: false,
        }
    }

    /// Closes the curve if its last two points, after full turns, are the first two again. One point
    /// may be the same by chance or by symmetry.
    pub(crate) fn close(&mut self) {
        let [(_, first), (_, second), .., (_, last), (_, next)] = &self.points[..] else {
            return;
        };
        let distance = |a: &[f64], b: &[f64]| -> f64 {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
            squares.sum()
        };
        let extents = self
            .points
            .iter()
            .map(|(_, values)| distance(first, values));
        let same = CLOSED * CLOSED * extents.fold(0.0, f64::max);
        let turns_fully = self.points.len() % STEPS == 2;
        if turns_fully && distance(first, last) <= same && distance(second, next) <= same {
            self.points.pop();
            self.closes = true;
        }
    }
}

impl FreeDriver {
    /// Returns the driver of this name.
    ///
    /// # Errors
    ///
    /// It is a length without limits.
    pub(crate) fn new(
        mechanism: &Mechanism,
        id: DriverId,
        in_order: bool,
    ) -> Result<Self, Failure> {
        let driver = &mechanism.drivers[id.index()];
        let bounds = [driver.min, driver.max];
        let (bounds, range) = match (driver.coordinate.kind.is_angle(), bounds) {
            (true, [min, max]) => {
                let bounds = [min.unwrap_or(-f64::INFINITY), max.unwrap_or(f64::INFINITY)];
                (bounds, TAU)
            }
            (false, [Some(min), Some(max)]) => ([min, max], max - min),
            (false, _) => {
                return Err(Failure::Usage(format!(
                    "target: driver `{}` is a length without `min` and `max`; its values are free \
                     between limits only",
                    driver.name
                )));
            }
        };
        let mut direction = Direction::zero(mechanism);
        direction.drivers[id.index()] = Jet::constant(1.0);
        Ok(Self {
            driver: id,
            direction,
            bounds,
            step: range / STEPS as f64,
            in_order,
        })
    }

    /// Returns whether the driver has no limits.
    pub(crate) fn is_unlimited(&self) -> bool {
        self.bounds == [-f64::INFINITY, f64::INFINITY]
    }

    /// Returns the range of the value at a pose, whose predecessors have these values. Values in
    /// order ascend or descend.
    pub(crate) fn range(&self, before: &[f64], ascend: bool) -> [f64; 2] {
        let [low, high] = self.bounds;
        match before {
            [first, .., last] | [first @ last] if self.in_order => {
                let turn = self.turn();
                if ascend {
                    [low.max(*last), high.min(first + turn)]
                } else {
                    [low.max(first - turn), high.min(*last)]
                }
            }
            _ => [low, high],
        }
    }

    /// Returns the index of the value that each of these follows: its own, or in order that of a value
    /// which ends its range; `None` at a limit of the driver.
    pub(crate) fn leaders(&self, values: &[f64]) -> Vec<Option<usize>> {
        let turn = self.turn();
        let mut leaders: Vec<Option<usize>> = Vec::with_capacity(values.len());
        for (pose, value) in values.iter().enumerate() {
            // The values of which the ends of the range are made.
            let before = if self.in_order { &values[..pose] } else { &[] };
            leaders.push(match before {
                _ if self.bounds.contains(value) => None,
                [.., last] if [*last].contains(value) => leaders[pose - 1],
                [first, ..] if [first + turn, first - turn].contains(value) => leaders[0],
                _ => Some(pose),
            });
        }
        leaders
    }

    /// Returns a turn of an angle, or the range of a length.
    fn turn(&self) -> f64 {
        self.step * STEPS as f64
    }

    /// Chooses a point of a curve for each pose, so that the sum of gaps is smallest. The points of
    /// the curve are in the order of the driver's values, `gaps` by pose, then by point. Returns the
    /// sum and the driver's values.
    pub(crate) fn nearest(&self, curve: &SampledVariables, gaps: &[Vec<f64>]) -> (f64, Vec<f64>) {
        let points = &curve.points;
        if !self.in_order {
            let nearest = gaps.iter().map(|gaps| {
                let points = gaps.iter().zip(points);
                points.fold((f64::INFINITY, f64::NAN), |best, (gap, (at, _))| {
                    if *gap < best.0 { (*gap, *at) } else { best }
                })
            });
            let (gaps, values): (Vec<f64>, Vec<f64>) = nearest.unzip();
            return (gaps.iter().sum(), values);
        }
        // The poses are within a turn, which begins at any point; on a curve that closes it goes on
        // from the end to the start.
        let count = points.len().min(STEPS + 1);
        let steps = points.len() - 1;
        let starts = if curve.closes {
            steps
        } else {
            points.len() - count + 1
        };
        let point = |place: usize| {
            if curve.closes {
                (
                    place % steps,
                    (place / steps) as f64 * self.step * steps as f64,
                )
            } else {
                (place, 0.0)
            }
        };
        let mut best = (f64::INFINITY, vec![f64::NAN; gaps.len()]);
        for start in 0..starts {
            for ascend in [true, false] {
                let point = |index: usize| {
                    let ahead = if ascend { index } else { count - 1 - index };
                    point(start + ahead)
                };
                let gap = |pose: usize, index: usize| gaps[pose][point(index).0];
                let (sum, chosen) = in_order(gaps.len(), count, gap);
                if sum < best.0 {
                    let values = chosen.iter().map(|&index| {
                        let (index, laps) = point(index);
                        points[index].0 + laps
                    });
                    best = (sum, values.collect());
                }
            }
        }
        best
    }
}

/// Chooses an index for each pose, none smaller than the one before, so that the sum of gaps is
/// smallest. Returns the sum and the indices.
fn in_order(poses: usize, count: usize, gap: impl Fn(usize, usize) -> f64) -> (f64, Vec<usize>) {
    // The smallest sum up to a pose with each index, and the index before it.
    let mut sums = vec![0.0; count];
    let mut before = vec![0; poses * count];
    for pose in 0..poses {
        let mut least = 0;
        for index in 0..count {
            if sums[index] < sums[least] {
                least = index;
            }
            before[pose * count + index] = least;
        }
        let indices = 0..count;
        sums = indices
            .map(|index| sums[before[pose * count + index]] + gap(pose, index))
            .collect();
    }
    let last = (0..count).min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    let Some(mut index) = last else {
        return (f64::INFINITY, Vec::new());
    };
    let sum = sums[index];
    let mut chosen = vec![index; poses];
    for pose in (0..poses).rev() {
        chosen[pose] = index;
        index = before[pose * count + index];
    }
    (sum, chosen)
}
