//! The inputs of one driver: their path during a step, and the rates in force.
//!
//! Input derivatives shape the path of the variable that they are given for. Each rate comes from
//! the first source in its column that there is:
//!
//! | velocity | acceleration |
//! |---|---|
//! | the input `.velocity`, if it is in use | the input `.acceleration`, if it is in use |
//! | order 1 of `.position` | order 1 of `.velocity` |
//! | | order 2 of `.position` |
//! | | the backward difference of two velocities that are no estimates |
//! | the estimate | the estimate |
//!
//! The parameter `rates` decides whether an input is in use: `inputs` always, `estimated` never,
//! `auto` once the host has set it to other than zero after initialization. The estimate
//! differentiates the parabola through the last three positions at the newest one.

use std::f64::consts::TAU;

use super::history::{History, Sample};
use super::rule::{Rule, Source};
use crate::fmi::codec::{Codec, Unreadable};
use crate::mechanism::{Extrapolation, Order, RateSource};

/// The three FMI inputs of one driver.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DriverInput {
    /// Position, velocity and acceleration as set by the host.
    values: [f64; 3],
    /// Position in force: of a wrapped angle the turn nearest the driver's last value.
    position: f64,
    /// First and second derivative of each value for the next step, if set by the host.
    derivatives: [[Option<f64>; 2]; 3],
    /// Whether the host has set velocity and acceleration to other than zero after initialization.
    used: [bool; 2],
    /// Whether there are rate inputs: not of a driver that follows inputs of the file.
    has_rates: bool,
    history: History,
    /// Size \[s\] of the last step if the rates extrapolated the position in it, else 0.
    extrapolated_over: f64,
}

impl DriverInput {
    /// Returns the inputs at their start values: rates of zero.
    pub(super) fn new(start: f64) -> Self {
        Self {
            values: [start, 0.0, 0.0],
            position: start,
            derivatives: [[None; 2]; 3],
            used: [false; 2],
            has_rates: true,
            history: History::default(),
            extrapolated_over: 0.0,
        }
    }

    /// Returns the inputs without those of rates.
    pub(super) fn without_rates(self) -> Self {
        Self {
            has_rates: false,
            ..self
        }
    }

    /// Returns an input as set by the host.
    pub(super) fn get(&self, order: Order) -> f64 {
        self.values[order as usize]
    }

    /// Returns the position in force.
    pub(super) fn position(&self) -> f64 {
        self.position
    }

    pub(super) fn set(&mut self, order: Order, value: f64) {
        self.values[order as usize] = value;
        match order {
            Order::Position => self.position = value,
            Order::Velocity => self.used[0] |= value != 0.0,
            Order::Acceleration => self.used[1] |= value != 0.0,
        }
    }

    /// Sets a position modulo one turn: the turn nearest the driver's value `end` after the last
    /// step, whose rates came from `sources`, or nearest the last position if estimates of rates led
    /// there. An estimate must not decide about the turn that it is estimated from.
    // Inlined, it would keep the setters of all other inputs from being inlined.
    #[inline(never)]
    pub(super) fn set_wrapped(&mut self, value: f64, end: f64, sources: [Source; 2]) {
        let is_estimate = self.extrapolated_over > 0.0 && sources.contains(&Source::Estimate);
        let last = if is_estimate { self.position } else { end };
        self.set(Order::Position, value);
        self.position += TAU * ((last - value) / TAU).round();
    }

    /// Sets the derivative of order 1 or 2 of one of the three inputs for the next step.
    pub(super) fn set_derivative(&mut self, order: Order, derivative: usize, value: f64) {
        self.derivatives[order as usize][derivative - 1] = Some(value);
    }

    /// Ends initialization: rate inputs set before count at the start only.
    pub(super) fn start(&mut self) {
        self.used = [false; 2];
    }

    /// Forgets the samples before a jump: no estimate differentiates it.
    pub(super) fn forget_samples(&mut self) {
        self.history = History::default();
    }

    /// Returns the derivatives of position, velocity and acceleration in force at an event by one of
    /// the three inputs: rates that are not given stay those of the last step.
    pub(super) fn change_at_event(&self, rates: RateSource, time: f64, order: Order) -> [f64; 3] {
        let (_, sources) = self.rates(rates, time, 0.0, 0.0);
        History::default().change(rates, sources, order)
    }

    /// Returns velocity and acceleration of the position's path at the start of a step of size `h`
    /// from `time`.
    pub(super) fn path(&self, rule: Rule, time: f64, h: f64) -> [f64; 2] {
        if self.is_extrapolated(rule) {
            self.rates(rule.rates, time, h, 0.0).0
        } else {
            self.derivatives[0].map(Option::unwrap_or_default)
        }
    }

    /// Returns whether the rates extrapolate the position in a step.
    fn is_extrapolated(&self, rule: Rule) -> bool {
        rule.extrapolation == Extrapolation::Taylor && self.derivatives[0] == [None, None]
    }

    /// Returns velocity and acceleration in force at the end of a step of size `h` from `time`, and
    /// their sources; with `h = 0` those at `time` itself.
    pub(super) fn rates_after(&self, rule: Rule, time: f64, h: f64) -> ([f64; 2], [Source; 2]) {
        let extrapolated = self.is_extrapolated(rule);
        let at = if extrapolated { 0.0 } else { h };
        let ([mut velocity, acceleration], sources) = self.rates(rule.rates, time, h, at);
        if extrapolated {
            velocity += h * acceleration;
        }
        ([velocity, acceleration], sources)
    }

    /// Returns the rates by the table above, at `at` in a step of size `h` from `time`, and their
    /// sources.
    #[inline(always)]
    fn rates(&self, rates: RateSource, time: f64, h: f64, at: f64) -> ([f64; 2], [Source; 2]) {
        let velocity = self.given_velocity(rates, at);
        let acceleration = self.given_acceleration(rates, at);
        if let (Some((velocity, of_velocity)), Some((acceleration, of_acceleration))) =
            (velocity, acceleration)
        {
            return ([velocity, acceleration], [of_velocity, of_acceleration]);
        }
        self.with_estimates(velocity, acceleration, rates, time, h)
    }

    /// Returns the rates by the table above, of which not both are given, at `time` before a step of
    /// size `h`, and their sources.
    fn with_estimates(
        &self,
        velocity: Option<(f64, Source)>,
        acceleration: Option<(f64, Source)>,
        rates: RateSource,
        time: f64,
        h: f64,
    ) -> ([f64; 2], [Source; 2]) {
        let mut history = self.history;
        history.push(self.sample(rates, time), h);
        let [first, second] = history.estimate().map(|rate| (rate, Source::Estimate));
        let difference = || Some((history.difference()?, Source::Difference));
        let (velocity, of_velocity) = velocity.unwrap_or(first);
        let (acceleration, of_acceleration) = acceleration.or_else(difference).unwrap_or(second);
        ([velocity, acceleration], [of_velocity, of_acceleration])
    }

    fn given_velocity(&self, rates: RateSource, h: f64) -> Option<(f64, Source)> {
        if self.is_used(Order::Velocity, rates, h) {
            return Some((self.extrapolated(Order::Velocity, h), Source::Input));
        }
        let [first, second] = self.derivatives[0];
        Some((first? + h * second.unwrap_or(0.0), Source::Derivatives))
    }

    fn given_acceleration(&self, rates: RateSource, h: f64) -> Option<(f64, Source)> {
        if self.is_used(Order::Acceleration, rates, h) {
            return Some((self.extrapolated(Order::Acceleration, h), Source::Input));
        }
        let [[_, of_position], [first, second], _] = self.derivatives;
        let of_velocity = first.map(|first| first + h * second.unwrap_or(0.0));
        Some((of_velocity.or(of_position)?, Source::Derivatives))
    }

    /// Returns whether a rate input is in use at the end of a step of size `h`.
    fn is_used(&self, order: Order, rates: RateSource, h: f64) -> bool {
        match rates {
            RateSource::Inputs => self.has_rates,
            RateSource::Estimated => false,
            RateSource::Auto => {
                let at_start = h <= 0.0 && self.history.is_empty();
                self.used[order as usize - 1] || at_start && self.values[order as usize] != 0.0
            }
        }
    }

    /// Returns a rate input at `h` on the path of its own derivatives.
    fn extrapolated(&self, order: Order, h: f64) -> f64 {
        let [first, second] = self.derivatives[order as usize];
        self.values[order as usize] + h * (first.unwrap_or(0.0) + 0.5 * h * second.unwrap_or(0.0))
    }

    /// Returns the inputs at a communication point.
    pub(super) fn sample(&self, rates: RateSource, time: f64) -> Sample {
        let value = |(value, _): (f64, Source)| value;
        Sample {
            time,
            position: self.position,
            velocity: self.given_velocity(rates, 0.0).map(value),
            acceleration: (self.given_acceleration(rates, 0.0))
                .filter(|(_, source)| *source == Source::Input)
                .map(value),
        }
    }

    /// Returns whether a step has ended since the start.
    pub(super) fn has_stepped(&self) -> bool {
        !self.history.is_empty()
    }

    /// Returns the derivatives of position, velocity and acceleration at the end of the last step,
    /// in which the rates came from `sources`, by one of the three inputs.
    pub(super) fn change_by_step(
        &self,
        rates: RateSource,
        sources: [Source; 2],
        order: Order,
    ) -> [f64; 3] {
        let h = self.extrapolated_over;
        let [position, velocity, acceleration] = self.history.change(rates, sources, order);
        [
            position + h * (velocity + 0.5 * h * acceleration),
            velocity + h * acceleration,
            acceleration,
        ]
    }

    /// Returns the derivatives of position, velocity and acceleration in force at `time`, before a
    /// step, by one of the three inputs.
    pub(super) fn change_by_value(&self, rates: RateSource, time: f64, order: Order) -> [f64; 3] {
        let (_, sources) = self.rates(rates, time, 0.0, 0.0);
        let mut history = self.history;
        history.push(self.sample(rates, time), 0.0);
        history.change(rates, sources, order)
    }

    /// Returns the last recorded sample before `time`.
    pub(super) fn last_sample(&self, time: f64) -> Option<&Sample> {
        self.history.newest().filter(|last| last.time < time)
    }

    /// Returns the change of the position in the last recorded step.
    pub(super) fn last_change(&self) -> f64 {
        self.history.last_change()
    }

    /// Ends a step of size `h`: records the inputs at its start, and clears the derivatives.
    pub(super) fn record(&mut self, rule: Rule, start: Sample, h: f64) {
        self.extrapolated_over = if self.is_extrapolated(rule) { h } else { 0.0 };
        self.history.push(start, h);
        self.derivatives = [[None; 2]; 3];
    }

    /// Visits all fields.
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            values,
            position,
            derivatives,
            used,
            has_rates: _,
            history,
            extrapolated_over,
        } = self;
        codec.each(
            values.iter_mut().chain([position, extrapolated_over]),
            Codec::finite,
        )?;
        codec.each(derivatives.as_flattened_mut(), |codec, derivative| {
            codec.option(derivative, 0.0, Codec::finite)
        })?;
        codec.each(used, Codec::flag)?;
        history.visit(codec)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "numbers exact in binary")]
mod tests {
    use super::*;

    const AUTO: Rule = rule(RateSource::Auto, Extrapolation::Hold);
    const INPUTS: Rule = rule(RateSource::Inputs, Extrapolation::Hold);
    const ESTIMATED: Rule = rule(RateSource::Estimated, Extrapolation::Hold);
    const TAYLOR: Rule = rule(RateSource::Auto, Extrapolation::Taylor);
    const RULES: [Rule; 6] = [
        AUTO,
        INPUTS,
        ESTIMATED,
        TAYLOR,
        rule(RateSource::Inputs, Extrapolation::Taylor),
        rule(RateSource::Estimated, Extrapolation::Taylor),
    ];

    const fn rule(rates: RateSource, extrapolation: Extrapolation) -> Rule {
        Rule {
            rates,
            extrapolation,
        }
    }

    /// Returns an input that a host set to `position(t)` before a step at each of these times, the
    /// last of which has not ended yet.
    fn in_steps(times: &[f64], position: impl Fn(f64) -> f64) -> DriverInput {
        let mut input = DriverInput::new(0.0);
        for (step, &time) in times.iter().enumerate() {
            if step > 0 {
                let before = times[step - 1];
                record(&mut input, AUTO, before, time - before);
            }
            input.set(Order::Position, position(time));
        }
        input
    }

    /// Ends a step of size `h` from `start`.
    fn record(input: &mut DriverInput, rule: Rule, start: f64, h: f64) {
        let sample = input.sample(rule.rates, start);
        input.record(rule, sample, h);
    }

    fn rates_after(input: &DriverInput, rule: Rule, time: f64, h: f64) -> [f64; 2] {
        input.rates_after(rule, time, h).0
    }

    #[test]
    fn a_parabola_is_estimated_exactly_with_any_steps() {
        let input = in_steps(&[1.0, 1.5, 3.5], |t| 2.0 + 3.0 * t + 4.0 * t * t);
        for rule in [AUTO, ESTIMATED] {
            let expected = [3.0 + 8.0 * 3.5, 8.0];
            assert_eq!(rates_after(&input, rule, 3.5, 0.25), expected);
        }
    }

    #[test]
    fn two_samples_give_a_line_and_one_gives_rest() {
        let position = |t: f64| 5.0 - 2.0 * t;
        let one = in_steps(&[1.0], position);
        assert_eq!(rates_after(&one, AUTO, 1.0, 1.0), [0.0, 0.0]);
        let two = in_steps(&[1.0, 2.0], position);
        assert_eq!(rates_after(&two, AUTO, 2.0, 1.0), [-2.0, 0.0]);
    }

    #[test]
    fn a_communication_point_is_one_sample_with_any_number_of_values() {
        let mut input = in_steps(&[0.0, 1.0], |t| t);
        record(&mut input, AUTO, 1.0, 1.0);
        input.set(Order::Position, 7.0);
        record(&mut input, AUTO, 1.0, 1.0);
        assert_eq!(rates_after(&input, AUTO, 1.0, 1.0), [7.0, 0.0]);
    }

    /// An event at t = 2 s, marked by a step of 1e-12 s, before or after which the value jumps.
    #[test]
    fn a_jump_is_not_divided_by_a_short_step() {
        for event in [1e-12, 1e-6, 1e-3] {
            let jump = |t: f64| if t > 2.0 { 1.0 } else { 0.0 };
            for times in [
                &[0.0, 1.0, 2.0, 2.0 + event][..],
                &[1.0, 2.0, 2.0 + event, 3.0],
                &[2.0, 2.0 + event, 3.0],
                &[2.0, 2.0 + event],
            ] {
                let input = in_steps(times, jump);
                let now = times[times.len() - 1];
                let found = rates_after(&input, AUTO, now, 1.0);
                // A jump of 1 within a step of 1 s; the parabola through it adds half as much.
                assert!(found[0].abs() < 2.0, "{times:?}: {found:?}");
            }
        }
    }

    /// Steps of 1 ms, one of 1 µs among them: u = t² is still differentiated exactly, up to
    /// rounding of 1e-16/1e-3².
    #[test]
    fn a_short_step_does_not_spoil_a_smooth_motion() {
        let times = [0.001, 0.002, 0.003, 0.003_001, 0.004, 0.005];
        for count in 3..=times.len() {
            let input = in_steps(&times[..count], |t| t * t);
            let now = times[count - 1];
            let found = rates_after(&input, AUTO, now, 0.001);
            assert!((found[0] - 2.0 * now).abs() < 1e-12, "{count}: {found:?}");
            assert!((found[1] - 2.0).abs() < 1e-9, "{count}: {found:?}");
        }
    }

    #[test]
    fn each_rate_input_counts_once_it_was_not_zero() {
        let mut input = in_steps(&[0.0, 1.0, 2.0], |t| t * t);
        input.set(Order::Velocity, 0.0);
        input.set(Order::Acceleration, 0.0);
        let estimated = [4.0, 2.0];
        assert_eq!(rates_after(&input, AUTO, 2.0, 1.0), estimated);
        assert_eq!(rates_after(&input, INPUTS, 2.0, 1.0), [0.0, 0.0]);
        // The acceleration alone: the velocity is still estimated.
        input.set(Order::Acceleration, 20.0);
        assert_eq!(rates_after(&input, AUTO, 2.0, 1.0), [4.0, 20.0]);
        input.set(Order::Velocity, 10.0);
        // Back at zero, where the motion turns: it still counts.
        input.set(Order::Velocity, 0.0);
        assert_eq!(rates_after(&input, AUTO, 2.0, 1.0), [0.0, 20.0]);
        assert_eq!(rates_after(&input, INPUTS, 2.0, 1.0), [0.0, 20.0]);
        assert_eq!(rates_after(&input, ESTIMATED, 2.0, 1.0), estimated);
    }

    #[test]
    fn rates_set_before_the_end_of_initialization_count_at_the_start_only() {
        let mut input = DriverInput::new(0.0);
        input.set(Order::Velocity, 3.0);
        input.start();
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.0), [3.0, 0.0]);
        assert_eq!(rates_after(&input, AUTO, 0.0, 1.0), [0.0, 0.0]);
        assert_eq!(rates_after(&input, INPUTS, 0.0, 1.0), [3.0, 0.0]);
        record(&mut input, AUTO, 0.0, 1.0);
        input.set(Order::Position, 7.0);
        assert_eq!(rates_after(&input, AUTO, 1.0, 1.0), [7.0, 0.0]);
        input.set(Order::Velocity, 3.0);
        assert_eq!(rates_after(&input, AUTO, 1.0, 1.0), [3.0, 0.0]);
    }

    #[test]
    fn a_velocity_alone_is_differenced() {
        let mut input = DriverInput::new(0.0);
        input.set(Order::Velocity, 3.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [3.0, 0.0]);
        record(&mut input, AUTO, 0.0, 1.0);
        input.set(Order::Velocity, 4.0);
        assert_eq!(rates_after(&input, AUTO, 0.5, 0.5), [4.0, 2.0]);
        assert_eq!(rates_after(&input, INPUTS, 0.5, 0.5), [4.0, 0.0]);
    }

    /// The velocity of the last step was an estimate: no difference with it.
    #[test]
    fn a_velocity_that_is_new_is_not_differenced() {
        let mut input = in_steps(&[0.0, 1.0, 2.0, 3.0], |t| t * t);
        input.set(Order::Velocity, 100.0);
        assert_eq!(rates_after(&input, AUTO, 3.0, 1.0), [100.0, 2.0]);
        record(&mut input, AUTO, 3.0, 1.0);
        input.set(Order::Velocity, 101.0);
        assert_eq!(rates_after(&input, AUTO, 4.0, 1.0), [101.0, 1.0]);
    }

    /// FMI 2.0, 4.2.1: each order by itself; rate inputs in use come first.
    #[test]
    fn input_derivatives_shape_the_path_and_replace_missing_rates() {
        let mut input = DriverInput::new(1.0);
        input.set_derivative(Order::Position, 1, 2.0);
        input.set_derivative(Order::Position, 2, 4.0);
        for rule in RULES {
            assert_eq!(input.path(rule, 0.0, 0.5), [2.0, 4.0], "{rule:?}");
        }
        for rule in [AUTO, ESTIMATED] {
            assert_eq!(rates_after(&input, rule, 0.0, 0.5), [4.0, 4.0]);
        }
        assert_eq!(rates_after(&input, INPUTS, 0.0, 0.5), [0.0, 0.0]);

        input.set(Order::Acceleration, 7.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [4.0, 7.0]);
        input.set(Order::Velocity, 100.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [100.0, 7.0]);
        assert_eq!(input.path(AUTO, 0.0, 0.5), [2.0, 4.0]);
    }

    #[test]
    fn input_derivatives_last_one_step() {
        let mut input = DriverInput::new(1.0);
        input.set_derivative(Order::Position, 1, 2.0);
        record(&mut input, AUTO, 0.0, 1.0);
        assert_eq!(input.path(AUTO, 0.5, 0.5), [0.0, 0.0]);
        assert_eq!(rates_after(&input, AUTO, 0.5, 0.5), [0.0, 0.0]);
    }

    /// All three inputs wired and order 1 given: the acceleration stays the input.
    #[test]
    fn order_1_leaves_a_wired_acceleration() {
        let mut input = DriverInput::new(1.0);
        input.set(Order::Velocity, 2.0);
        input.set(Order::Acceleration, 40.0);
        input.set_derivative(Order::Position, 1, 2.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [2.0, 40.0]);
    }

    /// Order 1 alone: the acceleration is the difference of two such velocities.
    #[test]
    fn order_1_alone_is_differenced() {
        let mut input = DriverInput::new(1.0);
        input.set_derivative(Order::Position, 1, 2.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [2.0, 0.0]);
        record(&mut input, AUTO, 0.0, 1.0);
        input.set_derivative(Order::Position, 1, 3.0);
        assert_eq!(rates_after(&input, AUTO, 0.5, 0.5), [3.0, 2.0]);
    }

    #[test]
    fn derivatives_of_rate_inputs_shape_their_paths() {
        let mut input = DriverInput::new(0.0);
        input.set(Order::Velocity, 1.0);
        input.set_derivative(Order::Velocity, 1, 2.0);
        assert_eq!(input.path(AUTO, 0.0, 0.5), [0.0, 0.0]);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [2.0, 2.0]);
        input.set_derivative(Order::Velocity, 2, 8.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [3.0, 6.0]);
        input.set(Order::Acceleration, 3.0);
        input.set_derivative(Order::Acceleration, 1, 4.0);
        assert_eq!(rates_after(&input, AUTO, 0.0, 0.5), [3.0, 5.0]);
    }

    #[test]
    fn taylor_extrapolates_by_the_rates_at_the_start_of_the_step() {
        let input = in_steps(&[0.0, 1.0, 2.0], |t| t * t);
        assert_eq!(input.path(TAYLOR, 2.0, 0.5), [4.0, 2.0]);
        assert_eq!(rates_after(&input, TAYLOR, 2.0, 0.5), [5.0, 2.0]);
        assert_eq!(input.path(AUTO, 2.0, 0.5), [0.0, 0.0]);
    }

    #[test]
    fn a_wrapped_angle_means_the_turn_nearest_the_last_value() {
        let mut input = DriverInput::new(0.0);
        for (value, last, turns) in [
            (0.1, 6.2, 1.0),
            (6.2, 0.1, -1.0),
            (-3.1, 3.1, 1.0),
            (0.5, 100.0, 16.0),
            (0.5, 0.4, 0.0),
        ] {
            input.set_wrapped(value, last, [Source::Input; 2]);
            assert_eq!(input.get(Order::Position).to_bits(), value.to_bits());
            assert!(
                (input.position() - value - turns * TAU).abs() < 1e-13,
                "{value}"
            );
        }
    }
}
