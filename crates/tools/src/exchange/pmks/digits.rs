//! Numbers and flags in 64 digits.

/// The digits, by value.
const DIGITS: &[u8; 64] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";

/// Parts of a unit in which decimals are counted.
pub(super) const PARTS: f64 = 1000.0;

/// Returns the value of a digit.
pub(super) fn digit(character: u8) -> Option<u64> {
    let index = DIGITS.iter().position(|digit| *digit == character)?;
    u64::try_from(index).ok()
}

/// Returns a whole number; one that begins with 0 is negative.
pub(super) fn integer(text: &str) -> Option<f64> {
    const MOST: usize = 8;
    let (sign, digits) = match text.strip_prefix('0') {
        Some(rest) if !rest.is_empty() => (-1.0, rest),
        _ => (1.0, text),
    };
    if digits.is_empty() || digits.len() > MOST {
        return None;
    }
    let mut value = 0_u64;
    for character in digits.bytes() {
        value = value * 64 + digit(character)?;
    }
    Some(sign * value as f64)
}

/// Returns the digits of a whole number; a negative one begins with 0.
pub(super) fn digits(value: f64) -> String {
    let mut rest = value.abs() as u64;
    let mut digits = Vec::new();
    loop {
        digits.push(DIGITS[(rest % 64) as usize]);
        rest /= 64;
        if rest == 0 {
            break;
        }
    }
    if value < 0.0 {
        digits.push(b'0');
    }
    digits.into_iter().rev().map(char::from).collect()
}

/// Returns a number that is written in thousandths.
pub(super) fn decimal(text: &str) -> Option<f64> {
    let value = integer(text)? / PARTS;
    crate::exchange::error::is_usable(value).then_some(value)
}

/// Returns the check character of a query: its length modulo 62.
pub(super) fn check(query: &str) -> char {
    char::from(DIGITS[query.len() % 62])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_64_digits_and_a_zero_for_minus() {
        for (text, value) in [("0", 0.0), ("K", 20.0), ("VG", 2000.0), ("010", -64.0)] {
            assert_eq!(integer(text), Some(value), "{text}");
        }
        for value in [0.0, 1.0, -1.0, 63.0, 64.0, -4095.0, 1e9] {
            assert_eq!(integer(&digits(value)), Some(value));
        }
        assert_eq!(decimal("Fe"), Some(1.0));
        for bad in ["", "é", "+", "123456789"] {
            assert_eq!(integer(bad), None, "{bad}");
        }
    }
}
