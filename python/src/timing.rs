//! Drivers whose values at the poses of a target are free.

use std::f64::consts::TAU;

use biela::mechanism::{DriverId, Mechanism};

use crate::error::Failure;

/// Number of steps along the motion of a driver, at whose ends the nearest pose to each target is
/// looked for.
pub(crate) const STEPS: usize = 36;

/// A driver whose values at the rows of a target are free.
pub(crate) struct FreeDriver {
    pub(crate) driver: DriverId,
    /// Range in which the nearest poses are looked for, and distance between two of them.
    pub(crate) bounds: [f64; 2],
    pub(crate) step: f64,
    /// Whether its values at the rows ascend or descend, within a turn or its range.
    in_order: bool,
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
        Ok(Self {
            driver: id,
            bounds,
            step: range / STEPS as f64,
            in_order,
        })
    }

    /// Returns the range of the value at a pose, whose predecessors have these values. Values in
    /// order ascend or descend.
    pub(crate) fn range(&self, before: &[f64], ascend: bool) -> [f64; 2] {
        let [low, high] = self.bounds;
        match before {
            [first, .., last] | [first @ last] if self.in_order => {
                let turn = self.step * STEPS as f64;
                if ascend {
                    [low.max(*last), high.min(first + turn)]
                } else {
                    [low.max(first - turn), high.min(*last)]
                }
            }
            _ => [low, high],
        }
    }

    /// Chooses a point of a curve for each pose, so that the sum of gaps is smallest. The points of
    /// the curve are in the order of the driver's values, `gaps` by pose, then by point. Returns the
    /// sum and the values.
    pub(crate) fn nearest(&self, curve: &[f64], gaps: &[Vec<f64>]) -> (f64, Vec<f64>) {
        if !self.in_order {
            let nearest = gaps.iter().map(|gaps| {
                let points = gaps.iter().zip(curve);
                points.fold((f64::INFINITY, f64::NAN), |best, (gap, at)| {
                    if *gap < best.0 { (*gap, *at) } else { best }
                })
            });
            let (gaps, values): (Vec<f64>, Vec<f64>) = nearest.unzip();
            return (gaps.iter().sum(), values);
        }
        let count = curve.len();
        // On a curve that closes, the first pose may be at any point.
        let closes = count > STEPS && self.bounds == [-f64::INFINITY, f64::INFINITY];
        let turn = self.step * STEPS as f64;
        let point = |place: usize| {
            if closes {
                (place % STEPS, (place / STEPS) as f64 * turn)
            } else {
                (place, 0.0)
            }
        };
        let mut best = (f64::INFINITY, vec![f64::NAN; gaps.len()]);
        for start in 0..if closes { STEPS } else { 1 } {
            let mut places: Vec<usize> = (start..start + count).collect();
            for _ in ["ascending", "descending"] {
                let gap = |pose: usize, index: usize| gaps[pose][point(places[index]).0];
                let (sum, chosen) = in_order(gaps.len(), count, gap);
                if sum < best.0 {
                    let values = chosen.iter().map(|&index| {
                        let (index, laps) = point(places[index]);
                        curve[index] + laps
                    });
                    best = (sum, values.collect());
                }
                places.reverse();
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
