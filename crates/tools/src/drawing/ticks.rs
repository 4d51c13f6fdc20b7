//! Round numbers along an axis.

/// An axis between two round numbers, with ticks at round numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// The multiples of the step from the first to the last.
    pub(super) values: Vec<f64>,
    /// Decimals at which neighbours differ.
    decimals: usize,
}

/// Steps within a decade.
const DECIMAL: [f64; 3] = [1.0, 2.0, 5.0];
/// Steps of angles from ten degrees up that divide the turn.
const DEGREES: [f64; 9] = [10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0, 360.0];

impl Ticks {
    /// Returns ticks that enclose `low` to `high`, at most about `most` of them; `degrees` prefers
    /// parts of the turn. Numbers that differ by rounding count as one number.
    pub(super) fn around([low, high]: [f64; 2], most: f64, degrees: bool) -> Self {
        let [low, high] = widened([low, high]);
        let step = step((high - low) / most, degrees);
        // Rounding adds no tick.
        let first = (low / step + 1e-9).floor();
        let last = (high / step - 1e-9).ceil().max(first + 1.0);
        Self::from_multiples(first, last, step)
    }

    /// Returns ticks inside `low` to `high`, at most about `most` of them.
    pub(super) fn within([low, high]: [f64; 2], most: f64, degrees: bool) -> Self {
        let [low, high] = widened([low, high]);
        let step = step((high - low) / most, degrees);
        Self::from_multiples(
            (low / step - 1e-9).ceil(),
            (high / step + 1e-9).floor(),
            step,
        )
    }

    fn from_multiples(first: f64, last: f64, step: f64) -> Self {
        let count = (last - first) as usize;
        Self {
            // Adding zero makes a negative zero positive.
            values: (0..=count)
                .map(|k| (first + k as f64) * step + 0.0)
                .collect(),
            decimals: (-(step * (1.0 + 1e-9)).log10().floor()).max(0.0) as usize,
        }
    }

    /// Returns the first and the last tick.
    pub(super) fn range(&self) -> [f64; 2] {
        let end = |value: Option<&f64>| value.copied().unwrap_or(0.0);
        [end(self.values.first()), end(self.values.last())]
    }

    /// Returns a tick as text.
    pub(super) fn text(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals)
    }
}

/// Returns a range with some length.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    /// Largest number in SI units or degrees that counts as rounding.
    const NOTHING: f64 = 1e-9;
    let size = low.abs().max(high.abs());
    if high - low > NOTHING.max(1e-9 * size) {
        return [low, high];
    }
    let middle = 0.5 * (low + high);
    let half = if size > NOTHING { 0.1 * size } else { 1.0 };
    let middle = if size > NOTHING { middle } else { 0.0 };
    [middle - half, middle + half]
}

/// Returns the smallest round number that is not less.
fn step(least: f64, degrees: bool) -> f64 {
    let enough = |step: &f64| *step >= least * (1.0 - 1e-9);
    if degrees && least > 5.0 {
        let part = DEGREES.into_iter().find(enough);
        // Beyond a turn: round numbers of turns.
        return part.unwrap_or_else(|| 360.0 * step(least / 360.0, false));
    }
    let decade = 10_f64.powf(least.log10().floor());
    let steps = DECIMAL.map(|digit| digit * decade);
    steps.into_iter().find(enough).unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(ticks: &Ticks) -> Vec<String> {
        ticks.values.iter().map(|v| ticks.text(*v)).collect()
    }

    #[test]
    fn ticks_are_round_and_enclose_the_range() {
        for (range, most, degrees, expected) in [
            (
                [0.0, 1.0],
                5.0,
                false,
                &["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"][..],
            ),
            (
                [-0.3, 0.31],
                4.0,
                false,
                &["-0.4", "-0.2", "0.0", "0.2", "0.4"],
            ),
            ([12.0, 340.0], 5.0, true, &["0", "90", "180", "270", "360"]),
            (
                [0.0, 3600.0],
                5.0,
                true,
                &["0", "720", "1440", "2160", "2880", "3600"],
            ),
            (
                [1e-13, -1e-13],
                4.0,
                false,
                &["-1.0", "-0.5", "0.0", "0.5", "1.0"],
            ),
            (
                [6.0, 6.0 + 1e-12],
                4.0,
                false,
                &["5.0", "5.5", "6.0", "6.5", "7.0"],
            ),
            (
                [0.0, 4e4],
                4.0,
                false,
                &["0", "10000", "20000", "30000", "40000"],
            ),
        ] {
            assert_eq!(texts(&Ticks::around(range, most, degrees)), expected);
        }
        let inside = Ticks::within([0.25, 1.75], 5.0, false);
        assert_eq!(texts(&inside), ["0.5", "1.0", "1.5"]);
    }
}
