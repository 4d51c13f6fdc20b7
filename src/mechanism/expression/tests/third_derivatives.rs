//! The third derivative against closed forms, against differences and against other expressions.

use super::*;

fn assert_jets3_near(found: Jet3, expected: Jet3, tolerance: f64, what: &str) {
    assert_near(found.value, expected.value, tolerance, what);
    assert_near(
        found.first(),
        expected.first(),
        tolerance,
        &format!("({what})′"),
    );
    assert_near(
        found.second(),
        expected.second(),
        tolerance,
        &format!("({what})″"),
    );
    assert_near(
        found.third(),
        expected.third(),
        tolerance,
        &format!("({what})‴"),
    );
}

/// An expression in force computes the same by fewer operations: they differ by some roundings of
/// derivatives that are up to a thousand times the value.
#[test]
fn expressions_in_force_agree_with_plain_ones() {
    let others = [
        ("b*cos(t) + sqrt(a^2 - (length*sin(t))^2)", -7.0, 7.0),
        ("a + length/2*(1 - cos(t - b))", -7.0, 7.0),
        ("sin(t*t)*cos(t*t) - sin(t*t)^2", -2.0, 2.0),
        ("-sqrt(exp(t) + 1)", -2.0, 2.0),
        ("a + b", -1.0, 1.0),
        ("t", -1.0, 1.0),
    ];
    let mut in_force = ExpressionInForce::default();
    for &(text, low, high) in SMOOTH.iter().chain(&others) {
        let expression = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        in_force.set(&expression, &|id: ParameterId| VALUES[id.index()]);
        for k in 0..=40 {
            let t = low + (high - low) * f64::from(k) / 40.0;
            let found = in_force.evaluate(t).expect("it is short");
            let expected = jet3(text, t);
            if expected.is_finite() {
                assert_jets3_near(found, expected, 1e-12, text);
            } else {
                assert!(!found.is_finite(), "{text} at {t}: {found:?}");
            }
        }
    }
}

#[test]
fn long_expressions_have_no_program_in_force() {
    let terms: Vec<_> = (1..20).map(|k| format!("sin({k}*t)")).collect();
    let expression = parse(&terms.join(" + ")).expect("it parses");
    let mut in_force = ExpressionInForce::default();
    in_force.set(&expression, &|_| 0.0);
    assert_eq!(in_force.evaluate(1.0), None);
}

#[test]
fn third_derivatives_are_those_of_the_closed_forms() {
    for t in [0.15, 0.3, 0.7, 0.95_f64] {
        let (sin, cos) = t.sin_cos();
        let (r, ln) = ((1.0 - t * t).sqrt(), t.ln());
        let s = 1.0 + t * t;
        let cases = [
            ("a + b*t", 0.0),
            ("t*t*t", 6.0),
            ("t^4", 24.0 * t),
            ("1/t", -6.0 / t.powi(4)),
            ("t^-1", -6.0 / t.powi(4)),
            ("t^2.5", 2.5 * 1.5 * 0.5 / t.sqrt()),
            ("sin(3*t)", -27.0 * (3.0 * t).cos()),
            ("cos(3*t)", 27.0 * (3.0 * t).sin()),
            ("sin(t)*cos(t)", -4.0 * (2.0 * t).cos()),
            ("tan(t)", (2.0 + 4.0 * sin * sin) / cos.powi(4)),
            ("asin(t)", (1.0 + 2.0 * t * t) / r.powi(5)),
            ("acos(t)", -(1.0 + 2.0 * t * t) / r.powi(5)),
            ("atan(t)", (6.0 * t * t - 2.0) / s.powi(3)),
            ("atan2(t, 1)", (6.0 * t * t - 2.0) / s.powi(3)),
            ("atan2(1, t)", (2.0 - 6.0 * t * t) / s.powi(3)),
            ("sinh(t)", t.cosh()),
            ("cosh(t)", t.sinh()),
            ("tanh(t)", (4.0 * t.sinh().powi(2) - 2.0) / t.cosh().powi(4)),
            ("sqrt(t)", 0.375 * t.powf(-2.5)),
            ("hypot(t, 1)", -3.0 * t * s.powf(-2.5)),
            ("hypot(1, t)", -3.0 * t * s.powf(-2.5)),
            ("exp(-2*t)", -8.0 * (-2.0 * t).exp()),
            ("ln(t)", 2.0 / t.powi(3)),
            ("log10(t)", 2.0 / t.powi(3) / 10_f64.ln()),
            ("a^t", 2_f64.ln().powi(3) * 2_f64.powf(t)),
            (
                "t^t",
                t.powf(t) * ((1.0 + ln).powi(3) + 3.0 * (1.0 + ln) / t - 1.0 / (t * t)),
            ),
            ("abs(-t^3)", 6.0),
            ("floor(t) + ceil(t) + sign(t)", 0.0),
            ("min(t^3, 7) + max(t^4, -1)", 6.0 + 24.0 * t),
            ("mod(t^3, b)", 6.0),
        ];
        for (text, third) in cases {
            // The arithmetic of some ten operations; near 0.95 the arc functions divide by
            // (1 − t²)^2.5, which takes a few digits.
            assert_near(
                jet3(text, t).third(),
                third,
                1e-13,
                &format!("{text} at {t}"),
            );
        }
    }
}

#[test]
fn two_ways_to_write_a_function_agree() {
    let pairs = [
        ("asin(sin(t))", "t"),
        ("acos(cos(t))", "t"),
        ("atan(tan(t))", "t"),
        ("ln(exp(t))", "t"),
        ("log10(10^t)", "t"),
        ("sqrt(t)^2", "t"),
        ("atan2(a*sin(t^2), a*cos(t^2))", "t^2"),
        ("hypot(t*sin(t), t*cos(t))", "t"),
        ("hypot(exp(t), t^2)", "sqrt(exp(2*t) + t^4)"),
        ("atan2(exp(t), 1 + t^2)", "atan(exp(t)/(1 + t^2))"),
        ("tanh(t)", "sinh(t)/cosh(t)"),
        ("tan(t)", "sin(t)/cos(t)"),
        ("(1 + t)^t", "exp(t*ln(1 + t))"),
        ("t^1.5", "t*sqrt(t)"),
        ("asin(t/2) + acos(t/2)", "pi/2"),
    ];
    for t in [0.2, 0.5, 0.9, 1.2] {
        for (left, right) in pairs {
            let what = format!("{left} at {t}");
            assert_jets3_near(jet3(left, t), jet3(right, t), 1e-12, &what);
        }
    }
}

#[test]
fn constant_powers_end_where_they_should() {
    let jet3_of = |value, first, second, third| Jet3::new(value, [first, second, third]);
    assert_eq!(jet3("t^2", 0.0), jet3_of(0.0, 0.0, 2.0, 0.0));
    assert_eq!(jet3("t^3", 0.0), jet3_of(0.0, 0.0, 0.0, 6.0));
    assert_eq!(jet3("t^1", 0.0), jet3_of(0.0, 1.0, 0.0, 0.0));
    assert_eq!(jet3("t^0", 0.0), jet3_of(1.0, 0.0, 0.0, 0.0));
    assert_eq!(jet3("t^3.5", 0.0), jet3_of(0.0, 0.0, 0.0, 0.0));
    assert_eq!(jet3("t^3", -2.0), jet3_of(-8.0, 12.0, -12.0, 6.0));
    assert_eq!(jet3("t^-1", -2.0), jet3_of(-0.5, -0.25, -0.25, -0.375));
}

#[test]
fn what_does_not_vary_has_no_third_derivative() {
    for text in [
        "sqrt(a - 2)",
        "hypot(a - 2, 0)",
        "atan2(a - 2, 0)",
        "(a - 2)^0.5",
        "acos(a - 1)",
        "abs(a - 2)",
    ] {
        assert_eq!(jet3(text, 1.0), Jet3::constant(value(text)), "{text}");
    }
}

proptest! {
    #[test]
    fn third_derivatives_are_the_limits_of_differences(
        (text, low, high) in proptest::sample::select(&SMOOTH[..]),
        part in 0.01..0.99_f64,
    ) {
        let t = low + (high - low) * part;
        // The error of a central difference is h²/6 times the fifth derivative, below 1e4 times
        // the third or 1 here, and the rounding of the second derivative over h.
        let h = 1e-4 * t.abs().min(1.0);
        let third = (jet(text, t + h).second() - jet(text, t - h).second()) / (2.0 * h);
        assert_near(jet3(text, t).third(), third, 1e-4, &format!("({text})‴ at {t}"));
    }

    #[test]
    fn lower_derivatives_are_those_of_triples(text in smooth_text(), t in 0.0..1.0_f64) {
        let found = jet3(&text, t);
        let lower = Jet::new(found.value, [found.first(), found.second()]);
        assert_jets_near(lower, jet(&text, t), 1e-12, &text);
        prop_assert!(found.third().is_finite());
    }

    #[test]
    fn third_derivatives_of_compositions_are_limits_too(text in smooth_text(), t in 0.0..1.0_f64) {
        // As for the second derivative of triples, with a fifth derivative of up to 1e5.
        let h = 1e-5;
        let third = (jet(&text, t + h).second() - jet(&text, t - h).second()) / (2.0 * h);
        assert_near(jet3(&text, t).third(), third, 1e-4, &text);
    }

    #[test]
    fn numbers_have_the_same_value(text in any_text(), t in -2.0..2.0_f64) {
        if let Ok(expression) = parse(&text) {
            let number = expression.evaluate(&|id| VALUES[id.index()], t);
            let value = jet3(&text, t).value;
            prop_assert!(number.to_bits() == value.to_bits(), "{} and {}", number, value);
        }
    }
}
