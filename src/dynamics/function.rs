//! A function of the motion that is positive while a passive force keeps its mode.

/// Functions per passive force.
pub(super) const FUNCTIONS: usize = 2;

/// Part of a force that is its rounding: that of the equations of motion, of some bodies and joints.
pub(super) const FORCE_ROUNDING: f64 = 1024.0 * f64::EPSILON;

/// A function of the motion that is positive while a mode lasts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Function {
    pub(super) value: f64,
    /// Its rate, unless it is a force, and the rate of this, if it is a gap.
    pub(super) rates: [Option<f64>; 2],
    /// A value that is rounding.
    pub(super) rounding: f64,
    /// For a gap, the direction in which it grows with its coordinate.
    pub(super) gap: Option<f64>,
}

impl Function {
    /// Returns the function as an event indicator: negative beyond rounding.
    pub(super) fn indicator(&self) -> f64 {
        self.value + 2.0 * self.rounding
    }

    /// Returns how far below zero the function may be at an event.
    pub(super) fn slack(&self, after: &Self, scale: f64) -> f64 {
        let rounding = self.rounding.max(after.rounding);
        match self.rates[0] {
            Some(_) => rounding,
            None => {
                let largest = scale.max(self.value.abs()).max(after.value.abs());
                rounding.max(FORCE_ROUNDING * largest)
            }
        }
    }

    /// Returns whether the function is zero at the end of a step, and falls.
    pub(super) fn ends_at(&self, after: &Self) -> bool {
        let falls = match after.rates[0] {
            Some(rate) => rate < 0.0,
            None => after.value < self.value,
        };
        after.value <= 0.0 && falls
    }

    /// Returns the time from the start of a step at which the function, which ends below zero, is a
    /// little below it; a secant counts the value at the start with a weight.
    pub(super) fn zero(&self, after: &Self, h: f64, slack: f64, weight: f64) -> f64 {
        // A bounce ends where it began, so that it gains no height.
        let aim = (-0.5 * slack).min(self.value);
        let rise = after.value - self.value;
        let [Some(first), Some(last)] = [self.rates[0], after.rates[0]] else {
            let value = self.value * weight;
            return h * (value - aim) / (value - after.value);
        };
        // The cubic without its value at the start: from there on, however soon, it may be at the aim
        // and rise.
        let (first, last) = (h * first, h * last);
        let third = first + last - 2.0 * rise;
        let second = rise - first - third;
        let on_cubic = |part: f64| part * (first + part * (second + part * third));
        h * bisect(0.0, 1.0, |part| on_cubic(part) > aim - self.value)
    }
}

/// Returns where a condition that holds at `low` and not at `high` ends.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    high
}
