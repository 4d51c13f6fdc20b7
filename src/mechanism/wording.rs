//! Wording of messages: names in back quotes and numbers of few digits.

/// Longest piece of the file that a message repeats, in characters.
const MAX_QUOTED_LENGTH: usize = 60;

/// Significant digits of a number in a message.
const DIGITS: usize = 6;

/// Digits with which no two numbers look alike.
const ALL_DIGITS: usize = 17;

/// Returns "`a`, `b` or `c`".
pub(super) fn either(candidates: &[&str]) -> String {
    let Some((last, first)) = candidates.split_last() else {
        return "nothing".to_owned();
    };
    if first.is_empty() {
        return quoted(last);
    }
    let first: Vec<String> = first.iter().map(|candidate| quoted(candidate)).collect();
    format!("{} or {}", first.join(", "), quoted(last))
}

/// Returns a number with six digits at most.
pub fn shown(number: f64) -> String {
    shown_with(number, DIGITS)
}

/// Returns a time \[s\] without the rounding of a product: 0.7, not 0.7000000000000001.
#[must_use]
pub fn show_time(time: f64) -> String {
    let rounded = rounded(time, 15) + 0.0;
    if rounded == 0.0 || (1e-6..1e15).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Returns a number with this many decimals. Zero has no sign; a number of more than nine digits
/// before the point has a power of ten.
pub fn fixed(number: f64, decimals: usize) -> String {
    if number.abs() >= 1e9 {
        return format!("{number:.decimals$e}");
    }
    let text = format!("{number:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| b"0.".contains(&byte)) => digits.to_owned(),
        _ => text,
    }
}

/// Returns a number with at most this many decimals, without zeros at its end.
pub fn shortest(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    match text {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// Returns two numbers with as many decimals as tell them apart, at least this many.
pub(crate) fn fixed_apart(a: f64, b: f64, decimals: usize) -> [String; 2] {
    let shown = |decimals| [a, b].map(|number| fixed(number, decimals));
    let mut longer = (decimals..=ALL_DIGITS).map(shown);
    longer
        .find(|[a, b]| a != b)
        .unwrap_or_else(|| shown(decimals))
}

/// Returns two numbers with as many digits as tell them apart, six if that is enough.
pub(crate) fn shown_apart(a: f64, b: f64) -> [String; 2] {
    let shown = |digits| [a, b].map(|number| shown_with(number, digits));
    let different = |digits: &usize| shown(*digits)[0] != shown(*digits)[1];
    let digits = (DIGITS..=ALL_DIGITS).find(different);
    shown(digits.unwrap_or(DIGITS))
}

/// Returns a number rounded to significant digits.
pub fn rounded(number: f64, digits: usize) -> f64 {
    let text = format!("{number:.*e}", digits - 1);
    text.parse().unwrap_or(number)
}

fn shown_with(number: f64, digits: usize) -> String {
    let rounded = rounded(number, digits);
    if rounded == 0.0 || (1e-4..1e7).contains(&f64::abs(rounded)) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Returns a piece of the file in back quotes, on one line, cut where it is very long.
pub fn quoted(text: &str) -> String {
    let mut shown: String = text
        .chars()
        .take(MAX_QUOTED_LENGTH)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if text.chars().nth(MAX_QUOTED_LENGTH).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_and_no_rows_of_zeros() {
        let numbers = [
            0.0,
            1.0,
            -0.25,
            1e-6,
            1e300,
            0.1 + 0.2,
            123_456.789,
            -2.0 / 3.0,
        ];
        let numbers = numbers.map(shown);
        assert_eq!(
            numbers,
            [
                "0",
                "1",
                "-0.25",
                "1e-6",
                "1e300",
                "0.3",
                "123457",
                "-0.666667"
            ]
        );
        assert_eq!([f64::NAN, f64::INFINITY].map(shown), ["NaN", "inf"]);
    }

    #[test]
    fn zero_has_no_sign_and_large_numbers_have_no_rows_of_digits() {
        let numbers = [-0.0, -1e-12, -0.5, 1e300].map(|number| fixed(number, 3));
        assert_eq!(numbers, ["0.000", "0.000", "-0.500", "1.000e300"]);
        assert_eq!(
            [0.1 * 7.0, -0.0, 1.6e9 + 0.25, 1e300].map(show_time),
            ["0.7", "0", "1600000000.25", "1e300"]
        );
    }

    #[test]
    fn different_numbers_look_different() {
        assert_eq!(shown_apart(0.1, 0.2), ["0.1", "0.2"]);
        assert_eq!(shown_apart(0.1, 0.100_000_04), ["0.1", "0.10000004"]);
        assert_eq!(
            shown_apart(1.0, 1.0_f64.next_up()),
            ["1", "1.0000000000000002"]
        );
        assert_eq!(shown_apart(1.0, 1.0), ["1", "1"]);
    }

    #[test]
    fn quotes_stay_on_one_line() {
        assert_eq!(quoted("a\nb"), "`a\u{fffd}b`");
        assert!(quoted(&"y".repeat(100)).ends_with("y…`"));
        assert_eq!(either(&["a", "b", "c"]), "`a`, `b` or `c`");
    }
}
