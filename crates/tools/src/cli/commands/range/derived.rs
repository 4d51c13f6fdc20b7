//! Computed measures over the range of a driver.

use super::follower::Follower;
use super::search::{Largest, Measured, largest};
use biela::kinematics::{Extreme, Range, Solver};
use biela::mechanism::{DerivedMeasure, DriverId, Order, Unit, shown};

/// Speed of the driver \[m/s or rad/s\] at which measures that use rates are computed, unless it is
/// given.
const UNIT_SPEED: f64 = 1.0;

/// Part of the largest value that is rounding.
const NO_VALUE: f64 = 1e-12;

/// A computed measure over the range of a driver.
pub(in crate::cli) struct DerivedRange {
    /// Its values at the samples, not numbers where it has none.
    pub(in crate::cli) values: Vec<f64>,
    /// Its least and its greatest value, infinite where it grows without bound; `None` without any
    /// value.
    pub(in crate::cli) extremes: Option<[Extreme; 2]>,
    /// Speed of the driver \[m/s or rad/s\] if it uses rates.
    pub(super) speed: Option<f64>,
}

impl DerivedRange {
    /// Returns the computed measures of a mechanism. The pose is restored.
    pub(in crate::cli) fn all(
        solver: &mut Solver,
        driver: DriverId,
        range: &Range,
        speed: Option<f64>,
    ) -> Vec<Self> {
        let speed = speed.unwrap_or(UNIT_SPEED);
        let mut follower = Follower::new(solver, driver, range, speed);
        let mut measures = follower.mechanism.derived.iter();
        if measures.any(DerivedMeasure::uses_forces) {
            follower.solution.seek_forces(follower.solver);
        }
        let derived = 0..follower.mechanism.derived.len();
        derived
            .map(|index| Self::new(&mut follower, index, range, speed))
            .collect()
    }

    fn new(follower: &mut Follower<'_>, index: usize, range: &Range, speed: f64) -> Self {
        let uses_rates = uses_rates(&follower.mechanism.derived[index]);
        let of = |follower: &Follower<'_>| {
            let Follower {
                solver, solution, ..
            } = follower;
            let value = solver.derived(
                index,
                &solution.rates,
                &solution.driver_rates,
                solution.forces(),
            );
            value.is_finite().then_some(value)
        };
        let samples = range.samples.iter().map(|sample| {
            let has_rates = follower.visit(sample).is_ok();
            let value = of(follower).filter(|_| has_rates || !uses_rates);
            (sample.driver, value)
        });
        let samples: Vec<(f64, Option<f64>)> = samples.collect();
        let mut extreme = |sign: f64| {
            let signed = |value: f64| -> Measured<()> { (sign * value, ()) };
            let signs = samples.iter().map(|(at, value)| (*at, value.map(signed)));
            follower.restore();
            let found = largest(&signs.collect::<Vec<_>>(), |at| {
                follower.follow(at)?;
                of(follower).map(signed)
            });
            Some(match found? {
                Largest::Value((value, ()), driver) => Extreme {
                    value: sign * value,
                    driver,
                },
                Largest::Unbounded(driver) => Extreme {
                    value: sign * f64::INFINITY,
                    driver,
                },
            })
        };
        let extremes = extreme(-1.0).zip(extreme(1.0));
        Self {
            extremes: extremes.map(|(least, greatest)| [least, greatest]),
            values: (samples.iter())
                .map(|(_, value)| value.unwrap_or(f64::NAN))
                .collect(),
            speed: uses_rates.then_some(speed),
        }
    }

    /// Returns the least and the greatest value as text.
    pub(super) fn shown(&self, measure: &DerivedMeasure) -> Option<[String; 2]> {
        let values = self.extremes?.map(|extreme| extreme.value);
        let size = values.map(f64::abs).into_iter().filter(|s| s.is_finite());
        let rounding = NO_VALUE * size.fold(0.0, f64::max);
        let unit = measure.unit.map_or_else(String::new, Unit::suffix);
        Some(values.map(|value| match value {
            f64::INFINITY => "infinity".to_owned(),
            f64::NEG_INFINITY => "-infinity".to_owned(),
            value if value.abs() <= rounding => format!("0{unit}"),
            value => format!("{}{unit}", shown(value)),
        }))
    }
}

/// Returns whether a computed measure uses velocities or accelerations.
pub(super) fn uses_rates(measure: &DerivedMeasure) -> bool {
    measure.order() != Order::Position
}
