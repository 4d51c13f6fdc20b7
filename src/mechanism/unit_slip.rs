//! Numbers that are legal but look like ones in another unit than SI.

use std::f64::consts::TAU;

use super::wording::shown;
use crate::unit::{DisplayUnit, UnitName};

/// Least length \[m\] that may have been meant in millimetres: few mechanisms are larger.
pub(super) const LARGE: f64 = 10.0;
/// Ratio of two neighbouring lengths from which they are likely to be in different units: between
/// the parts of one mechanism it is a few tens.
pub(super) const GAP: f64 = 200.0;
/// Right angle in degrees.
const RIGHT_ANGLE: f64 = 90.0;
/// Round number of radians per second, such as 450 and 900, whose multiples may be meant as such.
const ROUND: f64 = 50.0;

/// Says that an angle \[rad\] of more than a turn looks like degrees; `None` for any other.
pub fn large_angle(angle: f64) -> Option<String> {
    let (number, degrees) = (shown(angle), angle.to_degrees());
    (angle.abs() > TAU).then(|| format!("an angle of {number} rad is {degrees:.1} deg"))
}

/// Says that samples of an angle \[rad\] look like degrees: more than a turn at the start, or
/// [whole angles](whole_angles). `None` for any others.
pub fn large_angles(samples: &[f64]) -> Option<String> {
    whole_angles(samples).or_else(|| large_angle(*samples.first()?))
}

/// Says that samples of an angle \[rad\] look like degrees by their digits: up to more than a turn in
/// whole numbers, or from a whole number to whole right angles. `None` for any others.
#[must_use]
pub fn whole_angles(samples: &[f64]) -> Option<String> {
    let is_whole = samples.iter().all(|sample| sample.fract() == 0.0);
    let larger = |a: f64, b: &f64| if b.abs() > a.abs() { *b } else { a };
    let largest = samples.iter().fold(0.0, larger);
    let is_range = samples.first()?.fract() == 0.0 && largest % RIGHT_ANGLE == 0.0;
    large_angle(largest).filter(|_| is_whole || is_range)
}

/// Says that a velocity \[rad/s\] of whole right angles looks like degrees; `None` for any other.
pub fn large_velocity(velocity: f64) -> Option<String> {
    let is_suspect = velocity != 0.0 && velocity % RIGHT_ANGLE == 0.0 && velocity % ROUND != 0.0;
    let (number, degrees) = (shown(velocity), velocity.to_degrees());
    is_suspect.then(|| format!("a velocity of {number} rad/s is {degrees:.1} deg/s"))
}

/// Says that a length \[m\] looks like millimetres, or like the unit that shows it, beside the one
/// that it replaces; `None` for any other. The second text is that unit.
pub fn large_length(
    length: f64,
    usual: f64,
    display: Option<DisplayUnit>,
) -> Option<(String, UnitName)> {
    if let Some(found) = display.and_then(|display| large_in(length, display)) {
        return Some(found);
    }
    let is_suspect = length.abs() >= LARGE && usual != 0.0 && length.abs() >= GAP * usual.abs();
    let [length, usual] = [length, usual].map(shown);
    is_suspect.then(|| {
        (
            format!("a length of {length} m in place of {usual} m"),
            DisplayUnit::MILLIMETRE.name,
        )
    })
}

/// Says that a length \[m\] looks like one in the unit that shows it, whose name is the second text.
pub(super) fn large_in(length: f64, display: DisplayUnit) -> Option<(String, UnitName)> {
    let is_decimal = [DisplayUnit::MILLIMETRE, DisplayUnit::CENTIMETRE].contains(&display);
    let (number, name) = (shown(length), display.name);
    let shown = shown(length * display.factor);
    let is_suspect = is_decimal && length.abs() >= LARGE;
    is_suspect.then(|| (format!("a length of {number} m is {shown} {name}"), name))
}

/// Returns whether an expression is made of plain numbers, and perhaps of `t`: the author of any
/// other has thought of the unit.
pub fn is_plain(text: &str) -> bool {
    let mut words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "_.".contains(c)));
    words.all(|word| {
        let is_number = word.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        word.is_empty() || is_number || ["t", "sin", "cos"].contains(&word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_suspected_and_radians_are_not() {
        let sampled = |last: f64| {
            (0..8)
                .map(|k| last * f64::from(k) / 7.0)
                .collect::<Vec<_>>()
        };
        for (samples, is_suspect) in [
            (vec![0.0, 90.0], true),
            (vec![0.0, 30.0, 60.0], true),
            (sampled(360.0), true),
            (vec![60.5, 61.0], true),
            (sampled(TAU), false),
            (sampled(20.0 * TAU), false),
            (sampled(100.0), false),
            (vec![1.5, 90.0], false),
            (vec![0.0, 1.0, 2.0], false),
            (vec![], false),
        ] {
            assert_eq!(large_angles(&samples).is_some(), is_suspect, "{samples:?}");
            let is_whole = is_suspect && samples[0].fract() == 0.0;
            assert_eq!(whole_angles(&samples).is_some(), is_whole, "{samples:?}");
        }
        for (velocity, is_suspect) in [
            (90.0, true),
            (-360.0, true),
            (0.0, false),
            (10.0, false),
            (100.0, false),
            (314.159, false),
            (900.0, false),
        ] {
            assert_eq!(large_velocity(velocity).is_some(), is_suspect, "{velocity}");
        }
        for (text, plain) in [
            ("360*t", true),
            ("10 + 1e2*sin(3*t)", true),
            ("360*deg*t", false),
            ("2*pi*t", false),
            ("speed*t", false),
        ] {
            assert_eq!(is_plain(text), plain, "{text}");
        }
    }

    #[test]
    fn millimetres_are_suspected_and_metres_are_not() {
        let millimetre = Some(DisplayUnit::MILLIMETRE);
        for (length, usual, display, is_suspect) in [
            (60.0, 0.06, None, true),
            (60.0, 0.06, millimetre, true),
            (60.0, 0.0, millimetre, true),
            (60.0, 0.0, None, false),
            (60.0, 40.0, None, false),
            (6.0, 0.006, None, false),
            (0.12, 0.06, millimetre, false),
        ] {
            let found = large_length(length, usual, display);
            assert_eq!(found.is_some(), is_suspect, "{length} {usual}");
        }
    }
}
