//! Numbers of a file, in their units.

use biela::mechanism::constant;
use biela::mechanism::{rounded, shortest};

/// Digits of an estimate: far more than assembly needs, few enough to hide rounding. Half of them would
/// still assemble; with more, estimates end in the rounding of the pose.
const ESTIMATE_DIGITS: usize = 12;
/// Digits with which a number is written in full.
const ALL_DIGITS: usize = 17;

/// Writes a number in full. Very large and very small ones have a power of ten: a row of more digits
/// would be no integer of TOML.
pub fn written(number: f64) -> String {
    if number == 0.0 || (1e-15..1e15).contains(&number.abs()) {
        format!("{}", number + 0.0)
    } else {
        format!("{number:e}")
    }
}

/// Writes a number, which has been written, in a unit. Zero needs none.
pub fn in_unit(number: String, unit: &str) -> String {
    match &*number {
        "0" => number,
        _ => format!("\"{number}*{unit}\""),
    }
}

/// Writes an angle \[rad\] in degrees to these decimals.
pub fn degrees(angle: f64, decimals: usize) -> String {
    in_unit(shortest(angle.to_degrees(), decimals), "deg")
}

/// A number times a unit, as in `"40*mm"`.
pub struct NumberInUnit<'a> {
    unit: &'a str,
    factor: f64,
}

impl<'a> NumberInUnit<'a> {
    /// Reads a value of the file, which is TOML; `None` for all others.
    pub fn of(value: &'a str) -> Option<Self> {
        let value = value.trim();
        let mut inside = ['"', '\''].into_iter().filter_map(|quote| {
            let rest = value.strip_prefix(quote)?;
            rest.strip_suffix(quote)
        });
        let (number, unit) = inside.next()?.split_once('*')?;
        number.trim().parse::<f64>().ok()?;
        let unit = unit.trim();
        let factor = constant(unit)?;
        Some(Self { unit, factor })
    }

    /// Returns the size of the unit \[SI\].
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Writes a number of this unit.
    pub fn write(&self, number: &str) -> String {
        format!("\"{number}*{}\"", self.unit)
    }

    /// Writes a value \[SI\] in full, in the unit of an `old` one if that has one.
    pub fn write_in_unit_of(old: Option<&'a str>, value: f64) -> String {
        match old.and_then(Self::of) {
            Some(own) => own.write(&written(quotient(value, own.factor))),
            None => written(quotient(value, 1.0)),
        }
    }
}

/// Returns a value in units of a factor. It is rounded to twelve digits where these give the value
/// to rounding, otherwise it has all.
fn quotient(value: f64, factor: f64) -> f64 {
    /// Units in the last place of the value by which product and quotient can miss it.
    const NEAR: f64 = 4.0 * f64::EPSILON;
    let number = value / factor;
    let is_near = |number: &f64| (number * factor - value).abs() <= NEAR * value.abs();
    Some(rounded(number, 12))
        .filter(is_near)
        .unwrap_or_else(|| rounded(number, ALL_DIGITS))
}

/// Returns the largest coordinate of a body in q \[m\], the size to which estimates are rounded.
pub fn largest_coordinate(q: &[f64]) -> f64 {
    let lengths = q.chunks_exact(3).flat_map(|q| [q[0].abs(), q[1].abs()]);
    lengths.fold(0.0, f64::max)
}

/// Writes the estimate of a body at x, y \[m\] and phi \[rad\], in the units of the `old` parts where
/// these have some. `size` is that of the mechanism, against which rounding is nothing.
///
/// Without an old angle, and after zero, which says nothing of its unit, phi is in degrees.
pub fn estimate<'a>(
    [x, y, phi]: [f64; 3],
    size: f64,
    old: impl Fn(usize) -> Option<&'a str>,
) -> String {
    let part = |value: f64, scale: f64| {
        let smallest = scale * 10_f64.powi(1 - ESTIMATE_DIGITS as i32);
        if value.abs() <= smallest {
            "0".to_owned()
        } else {
            written(rounded(value, ESTIMATE_DIGITS))
        }
    };
    let own = |index| old(index).and_then(NumberInUnit::of);
    let length = |index, value| match own(index) {
        Some(own) => own.write(&part(value / own.factor, size / own.factor)),
        None => part(value, size),
    };
    let turn = std::f64::consts::TAU;
    let is_in_radians = |old: &str| old.parse::<f64>().is_ok_and(|old| old != 0.0);
    let phi = match own(2) {
        Some(own) => own.write(&part(phi / own.factor, turn / own.factor)),
        None if old(2).is_some_and(is_in_radians) => part(phi, turn),
        None => in_unit(part(phi.to_degrees(), 360.0), "deg"),
    };
    format!("[{}, {}, {phi}]", length(0, x), length(1, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_zeros_that_say_nothing() {
        assert_eq!(degrees(60.0_f64.to_radians(), 2), "\"60*deg\"");
        assert_eq!(degrees(0.0, 2), "0");
        assert_eq!(written(-0.0), "0");
        assert_eq!(written(1e22), "1e22");
    }

    #[test]
    fn every_number_that_is_written_is_toml_and_reads_as_itself() {
        for number in [0.1, -2.5e-8, 1e22, 1.5e300, 5e-324, 123_456_789.0, f64::MAX] {
            let text = format!("number = {}", written(number));
            let document: toml_edit::DocumentMut = text.parse().expect("it is TOML");
            let item = &document["number"];
            let integer = item.as_integer().map(|whole| whole as f64);
            assert_eq!(item.as_float().or(integer), Some(number), "{text}");
        }
    }

    #[test]
    fn an_estimate_is_short_exact_enough_and_in_the_units_of_the_old_one() {
        let frame = [
            41.451_705_977_309_4e-3,
            -6e-17,
            59.999_999_999_999_99_f64.to_radians(),
        ];
        assert_eq!(
            estimate(frame, 0.1, |_| None),
            "[0.0414517059773, 0, \"60*deg\"]"
        );
        let old = ["\"40*mm\"", "0", "1.2"];
        assert_eq!(
            estimate(frame, 0.1, |index| old.get(index).copied()),
            "[\"41.4517059773*mm\", 0, 1.0471975512]"
        );
    }
}
