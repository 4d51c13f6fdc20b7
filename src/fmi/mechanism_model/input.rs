//! The inputs of one driver: their path during a step, and the rates in force.

use super::variables::Order;
use crate::fmi::codec::{Codec, Unreadable};

/// Source of the velocity and acceleration of inputs: the FMU's parameter `rates`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RateSource {
    Auto = 1,
    Inputs = 2,
    Estimated = 3,
}

impl RateSource {
    pub(super) const ALL: [Self; 3] = [Self::Auto, Self::Inputs, Self::Estimated];
}

/// Extrapolation of inputs without input derivatives: the FMU's parameter `extrapolation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extrapolation {
    Hold = 1,
    Taylor = 2,
}

impl Extrapolation {
    pub(super) const ALL: [Self; 2] = [Self::Hold, Self::Taylor];
}

/// Velocity and acceleration of a driver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DriverRates {
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

/// A position and velocity, and the communication point at which the host set them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sample {
    time: f64,
    position: f64,
    velocity: f64,
}

/// The last three samples, newest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct History([Option<Sample>; 3]);

/// The three FMI inputs of one driver.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DriverInput {
    /// Position, velocity and acceleration.
    values: [f64; 3],
    /// First and second derivative of each value for the next step.
    derivatives: [[f64; 2]; 3],
    /// Whether the host has set a derivative of each value since the last step.
    derivative_given: [bool; 3],
    /// Whether the host has ever set each value to other than zero; unused for the position.
    ever_nonzero: [bool; 3],
    history: History,
}

impl DriverInput {
    /// Returns the inputs at their start values: rates of zero.
    pub(super) fn new(start: f64) -> Self {
        Self {
            values: [start, 0.0, 0.0],
            derivatives: [[0.0; 2]; 3],
            derivative_given: [false; 3],
            ever_nonzero: [false; 3],
            history: History::default(),
        }
    }

    pub(super) fn get(&self, order: Order) -> f64 {
        self.values[order as usize]
    }

    pub(super) fn set(&mut self, order: Order, value: f64) {
        self.values[order as usize] = value;
        self.ever_nonzero[order as usize] |= value != 0.0;
    }

    /// Sets the derivative of order 1 or 2 of one of the three inputs for the next step.
    pub(super) fn set_derivative(&mut self, order: Order, derivative: usize, value: f64) {
        self.derivatives[order as usize][derivative - 1] = value;
        self.derivative_given[order as usize] = true;
    }

    /// Returns the rate inputs.
    pub(super) fn given_rates(&self) -> DriverRates {
        DriverRates {
            velocity: self.values[1],
            acceleration: self.values[2],
        }
    }

    /// Returns the velocity and acceleration that extrapolate the position in a step from `time`.
    pub(super) fn path_rates(
        &self,
        source: RateSource,
        extrapolation: Extrapolation,
        time: f64,
    ) -> DriverRates {
        if self.derivative_given[0] {
            let [velocity, acceleration] = self.derivatives[0];
            DriverRates {
                velocity,
                acceleration,
            }
        } else if extrapolation == Extrapolation::Taylor {
            self.rates(source, time, 0.0)
        } else {
            DriverRates::default()
        }
    }

    /// Returns the rates in force at the end of a step of size `h` from `time`; with `h = 0` those
    /// at `time` itself.
    pub(super) fn rates_after(
        &self,
        source: RateSource,
        extrapolation: Extrapolation,
        time: f64,
        h: f64,
    ) -> DriverRates {
        let carried = extrapolation == Extrapolation::Taylor && !self.derivative_given[0];
        if carried {
            let DriverRates {
                velocity,
                acceleration,
            } = self.rates(source, time, 0.0);
            DriverRates {
                velocity: velocity + h * acceleration,
                acceleration,
            }
        } else {
            self.rates(source, time, h)
        }
    }

    /// Returns the rates by the rules of `rates`: input derivatives, rate inputs, or an estimate.
    fn rates(&self, source: RateSource, time: f64, h: f64) -> DriverRates {
        let given = self.ever_nonzero[1] || self.ever_nonzero[2];
        match source {
            RateSource::Auto | RateSource::Inputs if self.derivative_given[0] => {
                let [first, second] = self.derivatives[0];
                DriverRates {
                    velocity: first + h * second,
                    acceleration: second,
                }
            }
            RateSource::Inputs => DriverRates {
                velocity: self.carried(Order::Velocity, h),
                acceleration: self.carried(Order::Acceleration, h),
            },
            RateSource::Auto if given => DriverRates {
                velocity: self.carried(Order::Velocity, h),
                acceleration: if self.ever_nonzero[2] {
                    self.carried(Order::Acceleration, h)
                } else {
                    self.velocity_difference(time)
                },
            },
            RateSource::Auto | RateSource::Estimated => self.with_sample(time).estimate(),
        }
    }

    /// Returns an input, extrapolated over `h` by its own derivatives.
    fn carried(&self, order: Order, h: f64) -> f64 {
        let [first, second] = self.derivatives[order as usize];
        self.values[order as usize] + h * (first + 0.5 * h * second)
    }

    /// Returns the backward difference of the velocity input.
    fn velocity_difference(&self, time: f64) -> f64 {
        match self.with_sample(time).0 {
            [Some(newest), Some(before), _] => {
                (newest.velocity - before.velocity) / (newest.time - before.time)
            }
            _ => 0.0,
        }
    }

    /// Returns the history with the present values as its newest sample.
    fn with_sample(&self, time: f64) -> History {
        let sample = Some(Sample {
            time,
            position: self.values[0],
            velocity: self.values[1],
        });
        match self.history.0 {
            // The present values replace a sample of the same communication point.
            [Some(newest), b, c] if newest.time >= time => History([sample, b, c]),
            [a, b, _] => History([sample, a, b]),
        }
    }

    /// Ends a step that started at `time`: records a sample and clears the derivatives.
    pub(super) fn complete_step(&mut self, time: f64) {
        self.history = self.with_sample(time);
        self.derivatives = [[0.0; 2]; 3];
        self.derivative_given = [false; 3];
    }

    /// Visits all fields.
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            values,
            derivatives,
            derivative_given,
            ever_nonzero,
            history,
        } = self;
        for value in values.iter_mut().chain(derivatives.as_flattened_mut()) {
            codec.finite(value)?;
        }
        for flag in derivative_given.iter_mut().chain(ever_nonzero) {
            codec.flag(flag)?;
        }
        let samples = history.0.iter_mut();
        samples.into_iter().try_for_each(|sample| {
            codec.option(sample, Sample::default(), |codec, sample| {
                codec.finite(&mut sample.time)?;
                codec.finite(&mut sample.position)?;
                codec.finite(&mut sample.velocity)
            })
        })
    }
}

impl History {
    /// Returns the derivatives of the polynomial through all samples at the newest one.
    fn estimate(&self) -> DriverRates {
        let slope = |a: Sample, b: Sample| (a.position - b.position) / (a.time - b.time);
        match self.0 {
            [Some(newest), Some(before), Some(oldest)] => {
                let last = slope(newest, before);
                let curvature = (last - slope(before, oldest)) / (newest.time - oldest.time);
                DriverRates {
                    velocity: last + curvature * (newest.time - before.time),
                    acceleration: 2.0 * curvature,
                }
            }
            [Some(newest), Some(before), None] => DriverRates {
                velocity: slope(newest, before),
                acceleration: 0.0,
            },
            _ => DriverRates::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLD: Extrapolation = Extrapolation::Hold;
    const TAYLOR: Extrapolation = Extrapolation::Taylor;

    /// Returns an input that a host set to `position(t)` before steps at these times.
    fn after_steps(times: &[f64], position: impl Fn(f64) -> f64) -> DriverInput {
        let mut input = DriverInput::new(0.0);
        for &time in times {
            input.set(Order::Position, position(time));
            input.complete_step(time);
        }
        input
    }

    fn rates(velocity: f64, acceleration: f64) -> DriverRates {
        DriverRates {
            velocity,
            acceleration,
        }
    }

    #[test]
    fn a_parabola_is_estimated_exactly_whatever_the_steps() {
        // Numbers whose sums and quotients are exact in binary.
        let input = after_steps(&[1.0, 1.5, 3.5], |t| 2.0 + 3.0 * t + 4.0 * t * t);
        for source in [RateSource::Auto, RateSource::Estimated] {
            assert_eq!(
                input.rates_after(source, HOLD, 3.5, 0.25),
                rates(3.0 + 8.0 * 3.5, 8.0)
            );
        }
    }

    #[test]
    fn two_samples_give_a_line_and_one_gives_rest() {
        let position = |t: f64| 5.0 - 2.0 * t;
        let one = after_steps(&[1.0], position);
        assert_eq!(
            one.rates_after(RateSource::Auto, HOLD, 1.0, 1.0),
            rates(0.0, 0.0)
        );
        let two = after_steps(&[1.0, 2.0], position);
        assert_eq!(
            two.rates_after(RateSource::Auto, HOLD, 2.0, 1.0),
            rates(-2.0, 0.0)
        );
    }

    #[test]
    fn a_communication_point_is_one_sample_however_often_it_is_set() {
        let mut input = after_steps(&[0.0, 1.0], |t| t);
        input.set(Order::Position, 7.0);
        input.complete_step(1.0);
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 1.0, 1.0),
            rates(7.0, 0.0)
        );
    }

    #[test]
    fn rate_inputs_count_once_one_was_not_zero() {
        let mut input = after_steps(&[0.0, 1.0, 2.0], |t| t * t);
        input.set(Order::Velocity, 0.0);
        input.set(Order::Acceleration, 0.0);
        let estimated = rates(4.0, 2.0);
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 2.0, 1.0),
            estimated
        );
        assert_eq!(
            input.rates_after(RateSource::Inputs, HOLD, 2.0, 1.0),
            rates(0.0, 0.0)
        );
        input.set(Order::Velocity, 10.0);
        input.set(Order::Acceleration, 20.0);
        // Back at zero, where the motion turns: they still count.
        input.set(Order::Velocity, 0.0);
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 2.0, 1.0),
            rates(0.0, 20.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Inputs, HOLD, 2.0, 1.0),
            rates(0.0, 20.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Estimated, HOLD, 2.0, 1.0),
            estimated
        );
    }

    #[test]
    fn velocity_alone_is_differenced() {
        let mut input = DriverInput::new(0.0);
        input.set(Order::Velocity, 3.0);
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 0.0, 0.5),
            rates(3.0, 0.0)
        );
        input.complete_step(0.0);
        input.set(Order::Velocity, 4.0);
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 0.5, 0.5),
            rates(4.0, 2.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Inputs, HOLD, 0.5, 0.5),
            rates(4.0, 0.0)
        );
    }

    #[test]
    fn input_derivatives_come_first_and_last_one_step() {
        let mut input = DriverInput::new(1.0);
        input.set(Order::Velocity, 100.0);
        input.set_derivative(Order::Position, 1, 2.0);
        input.set_derivative(Order::Position, 2, 4.0);
        for source in [RateSource::Auto, RateSource::Inputs] {
            assert_eq!(input.path_rates(source, HOLD, 0.0), rates(2.0, 4.0));
            assert_eq!(input.rates_after(source, HOLD, 0.0, 0.5), rates(4.0, 4.0));
        }
        // The path follows them even where rates are estimated.
        assert_eq!(
            input.path_rates(RateSource::Estimated, HOLD, 0.0),
            rates(2.0, 4.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Estimated, HOLD, 0.0, 0.5),
            rates(0.0, 0.0)
        );
        input.complete_step(0.0);
        assert_eq!(
            input.path_rates(RateSource::Auto, HOLD, 0.5),
            rates(0.0, 0.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Inputs, HOLD, 0.5, 0.5),
            rates(100.0, 0.0)
        );
    }

    #[test]
    fn derivatives_of_rate_inputs_carry_these_along() {
        let mut input = DriverInput::new(0.0);
        input.set(Order::Velocity, 1.0);
        input.set_derivative(Order::Velocity, 1, 2.0);
        input.set_derivative(Order::Velocity, 2, 8.0);
        input.set(Order::Acceleration, 3.0);
        input.set_derivative(Order::Acceleration, 1, 4.0);
        assert_eq!(
            input.path_rates(RateSource::Auto, HOLD, 0.0),
            rates(0.0, 0.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Auto, HOLD, 0.0, 0.5),
            rates(3.0, 5.0)
        );
    }

    #[test]
    fn taylor_carries_the_rates_in_force_at_the_start_of_the_step() {
        let input = after_steps(&[0.0, 1.0, 2.0], |t| t * t);
        assert_eq!(
            input.path_rates(RateSource::Auto, TAYLOR, 2.0),
            rates(4.0, 2.0)
        );
        assert_eq!(
            input.rates_after(RateSource::Auto, TAYLOR, 2.0, 0.5),
            rates(5.0, 2.0)
        );
        assert_eq!(
            input.path_rates(RateSource::Auto, HOLD, 2.0),
            rates(0.0, 0.0)
        );
    }
}
