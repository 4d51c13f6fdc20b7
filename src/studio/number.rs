//! Numbers as a person writes them.

use crate::mechanism::shortest;

/// Returns an angle \[rad\] as it stands in a file, in degrees to these decimals.
pub(super) fn angle(value: f64, decimals: usize) -> String {
    match &*shortest(value.to_degrees(), decimals) {
        "0" => "0".to_owned(),
        degrees => format!("\"{degrees}*deg\""),
    }
}

/// Returns the angle in (−π, π] that differs by whole turns.
pub(super) fn within_turn(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let rest = angle - turn * (angle / turn).round();
    if rest <= -std::f64::consts::PI {
        rest + turn
    } else {
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_zeros_that_say_nothing() {
        assert_eq!(shortest(0.25, 4), "0.25");
        assert_eq!(shortest(-0.000_01, 4), "0");
        assert_eq!(shortest(30.0, 0), "30");
        assert_eq!(angle(60.0_f64.to_radians(), 2), "\"60*deg\"");
        assert_eq!(angle(0.0, 2), "0");
    }
}
