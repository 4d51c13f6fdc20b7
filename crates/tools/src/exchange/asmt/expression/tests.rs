//! Expressions and their values.

use std::sync::Arc;

use super::{constant, force, is_zero, motion, parse};
use biela::kinematics::Solver;
use biela::mechanism::{DriverId, Mechanism, Source};

#[test]
fn expressions_are_written_in_the_words_of_mechanism_files() {
    for (theirs, ours) in [
        ("pi/3 + 2*pi*time", "pi/3 + 2*pi*t"),
        ("2.0d*time", "2*t"),
        ("1.5d-1*sin(2*pi*time)", "0.15*sin(2*pi*t)"),
        ("\"a comment\" -arctan(time)<n>", "-atan(t)"),
        ("1-(time)^2", "1 - t^2"),
        ("2*-1*(time - (1 - time))", "2*(-1)*(t - (1 - t))"),
        ("-(1 + time)/2/(3*time)", "(-(1 + t))/2/(3*t)"),
    ] {
        assert_eq!(motion(theirs).as_deref(), Some(ours), "{theirs}");
    }
    let spring = "(0.0d + 10.0d*(rIJ(self) + (-0.5d)) + 2*vrIJ(self))";
    let ours = "0 + 10*(position + (-0.5)) + 2*velocity";
    assert_eq!(force(spring).as_deref(), Some(ours));
    assert_eq!(motion(spring), None);
    assert_eq!(constant("time"), None);
    assert!(is_zero("0.0d") && !is_zero("1") && !is_zero("time"));
    for unknown in [
        "",
        "spline(time)",
        "2 time",
        "(time",
        "time)",
        "sin",
        "time +",
        "\"open",
        "1..2",
        ".",
        "é",
        "2*é",
        "9d999",
        "rIJ(a)",
        "integral(time, sin(time^2))",
        "integral(time, (time + 1)^2)",
    ] {
        assert_eq!(motion(unknown), None, "{unknown}");
    }
}

/// Functions of pieces have the values of their closed forms, before, between and behind their
/// ends, as they are read and as they are written.
#[test]
fn integrals_and_ramps_have_their_values() {
    type Function = fn(f64) -> f64;
    let cases: [(&str, Function); 4] = [
        ("rampstep(time, 1, 2, 3, 6)", |t| {
            2.0 + 2.0 * (t.clamp(1.0, 3.0) - 1.0)
        }),
        ("integral(time, rampstep(time, 0.25, 0, 3, 5.5))*-1", |t| {
            let ramp = t.clamp(0.25, 3.0) - 0.25;
            -(ramp * ramp + 5.5 * (t.max(3.0) - 3.0))
        }),
        (
            "integral(time, piecewise(time, functions(0, 4*sin(2*(time - 0.5)), 1), transitions(0.5, 2)))",
            |t| {
                let phase = 2.0 * (t.clamp(0.5, 2.0) - 0.5);
                2.0 * (1.0 - phase.cos()) + (t.max(2.0) - 2.0)
            },
        ),
        ("integral(time, 3*time^2 - 2*time)", |t| t.powi(3) - t * t),
    ];
    for (text, function) in cases {
        let term = parse(text).expect("it is read");
        let written = motion(text).expect("it is written");
        let source = Source::new(
            "test.toml",
            format!(
                "format = 1\nname = \"a\"\n[ground.markers]\nO = [0, 0]\n\
                 [bodies.b]\nmarkers = {{ O = [0, 0] }}\n[joints]\n\
                 pin = {{ type = \"revolute\", markers = [\"ground.O\", \"b.O\"] }}\n[drivers]\n\
                 d = {{ coordinate = \"angle\", markers = [\"ground.O\", \"b.O\"], motion = \"{written}\" }}\n"
            ),
        );
        let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
        let solver = Solver::new(Arc::new(mechanism)).expect("the driver matches");
        for t in [0.0, 0.3, 0.9, 1.7, 2.5, 4.0] {
            let right = function(t);
            // Some ten operations.
            let rounding = 1e-14 * right.abs().max(1.0);
            assert!((term.value(t) - right).abs() <= rounding, "{text} at {t}");
            let moved = solver.motion(DriverId(0), t).value;
            assert!((moved - right).abs() <= rounding, "{written} at {t}");
        }
    }
    assert_eq!(
        motion("piecewise(time, functions(0, 1), transitions(2))"),
        None
    );
}
