//! Values against closed forms, derivatives against differences and against other expressions.

mod display;
mod enclosures;
mod text;
mod third_derivatives;

use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::mechanism::Jet;
use crate::mechanism::names::NameTable;

/// The parameters of these tests, in the order of their ids.
const NAMES: [&str; 3] = ["a", "b", "length"];

/// Their values.
const VALUES: [f64; 3] = [2.0, 3.0, 0.5];

/// Expressions that use every function and operator, each with a range of `t` in which it is
/// smooth.
const SMOOTH: [(&str, f64, f64); 40] = [
    ("3*t - t*t/b", -2.0, 2.0),
    ("-t", -2.0, 2.0),
    ("(1 + t)/(3 - t^2)", -1.5, 1.5),
    ("sin(a*t + 1)", -5.0, 5.0),
    ("cos(b*t)", -5.0, 5.0),
    ("tan(t)", -1.3, 1.3),
    ("tan(t)", 1.8, 4.4),
    ("asin(t)", -0.9, 0.9),
    ("acos(t/2)", -1.8, 1.8),
    ("atan(b*t)", -3.0, 3.0),
    ("atan2(t, b)", -5.0, 5.0),
    ("atan2(t, -b)", 0.1, 5.0),
    ("atan2(1 + t^2, sin(t))", -5.0, 5.0),
    ("atan2(-1, t - b)", -5.0, 5.0),
    ("sinh(t)", -2.0, 2.0),
    ("cosh(t)", -2.0, 2.0),
    ("tanh(2*t)", -2.0, 2.0),
    ("sqrt(t)", 0.2, 9.0),
    ("hypot(t, b)", -5.0, 5.0),
    ("hypot(cos(t), 2*sin(t))", -5.0, 5.0),
    ("exp(-t^2)", -2.0, 2.0),
    ("ln(t)", 0.2, 9.0),
    ("log10(t)", 0.2, 9.0),
    ("t*abs(t - 1)", 1.0, 3.0),
    ("abs(t)^3*sign(t)", -3.0, -0.1),
    ("t^2 + floor(t) + ceil(t)", 0.1, 0.9),
    ("mod(t^2, b)", 2.0, 2.4),
    ("mod(t, -b)", -2.9, -0.1),
    ("min(t^2, 9)", -2.9, 2.9),
    ("max(sin(t), -2, t/4)", -5.0, -2.6),
    ("t^2", -2.0, 2.0),
    ("t^3", -2.0, 2.0),
    ("t^5 - t^4", -2.0, 2.0),
    ("t^-2", 0.2, 3.0),
    ("t^-3", -3.0, -0.2),
    ("t^3.5", 0.0, 2.0),
    ("t^-0.7", 0.2, 3.0),
    ("t^(1/b)", 0.2, 3.0),
    ("b^t", -2.0, 2.0),
    ("(1.5 + sin(t))^cos(t)", -2.0, 2.0),
];

fn parse(text: &str) -> Result<Expression, ExpressionError> {
    let parameters: NameTable<'_, ParameterId> =
        NAMES.into_iter().zip((0..).map(ParameterId)).collect();
    Expression::parse(text, Scope::new(&parameters, &[Variable::Time]))
}

/// The value and three derivatives at time `t` for the same parameters.
fn jet3(text: &str, t: f64) -> Jet3 {
    let expression = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let parameter = |id: ParameterId| Jet3::constant(VALUES[id.index()]);
    expression.evaluate(&parameter, Jet3::variable(t))
}

/// The triple at time `t` for the parameters 2, 3 and 0.5.
fn jet(text: &str, t: f64) -> Jet {
    let expression = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let parameter = |id: ParameterId| Jet::constant(VALUES[id.index()]);
    expression.evaluate(&parameter, Jet::variable(t))
}

fn value(text: &str) -> f64 {
    jet(text, 0.0).value
}

/// Relative to the larger of the two and 1.
fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let scale = found.abs().max(expected.abs()).max(1.0);
    assert!(
        (found - expected).abs() <= tolerance * scale,
        "{what}: found {found}, expected {expected}"
    );
}

fn assert_jets_near(found: Jet, expected: Jet, tolerance: f64, what: &str) {
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
}

#[test]
#[expect(clippy::float_cmp, reason = "the arithmetic is the same")]
fn numbers_operators_and_constants() {
    let cases = [
        ("1", 1.0),
        (".5", 0.5),
        ("2.", 2.0),
        ("1e-3", 1e-3),
        ("1E+3", 1e3),
        ("2.e1", 20.0),
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("7 - 4 - 2", 1.0),
        ("16/4/2", 2.0),
        ("-2^2", -4.0),
        ("-a^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-2^2", 0.0625),
        ("(-2)^3", -8.0),
        ("a*-b", -6.0),
        ("a--b", 5.0),
        ("+a", 2.0),
        ("-a*b", -6.0),
        ("2*-3^2", -18.0),
        ("pi", PI),
        ("180*deg", PI),
        ("5*mm", 5.0 * 1e-3),
        ("2*cm", 2.0 * 1e-2),
        ("\n a \t+\r b ", 5.0),
        ("min(a, b)", 2.0),
        ("max(a, b, 7, 1)", 7.0),
        ("min(b, a, 7, 1)", 1.0),
        ("mod(7, 3)", 1.0),
        ("mod(-7, 3)", 2.0),
        ("mod(7, -3)", -2.0),
        ("hypot(3, 4)", 5.0),
        ("atan2(1, -1)", 0.75 * PI),
        ("sign(-a)", -1.0),
        ("sign(0)", 0.0),
        ("floor(-0.5)", -1.0),
        ("ceil(0.5)", 1.0),
        ("abs(-a)", 2.0),
        ("ln(exp(a))", 2.0),
        ("log10(1000)", 3.0),
        ("sqrt(16)", 4.0),
    ];
    for (text, expected) in cases {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn triples_are_those_of_the_closed_forms() {
    for t in [-1.3, -0.4, 0.3, 0.7, 2.1_f64] {
        let (sin, cos) = t.sin_cos();
        let cases = [
            ("t", [t, 1.0, 0.0]),
            ("a + b*t", [2.0 + 3.0 * t, 3.0, 0.0]),
            ("t^2", [t * t, 2.0 * t, 2.0]),
            ("t^3", [t.powi(3), 3.0 * t * t, 6.0 * t]),
            ("1/t", [1.0 / t, -1.0 / (t * t), 2.0 / t.powi(3)]),
            ("t^-1", [1.0 / t, -1.0 / (t * t), 2.0 / t.powi(3)]),
            (
                "sin(3*t)",
                [
                    (3.0 * t).sin(),
                    3.0 * (3.0 * t).cos(),
                    -9.0 * (3.0 * t).sin(),
                ],
            ),
            (
                "sin(t)*cos(t)",
                [sin * cos, (2.0 * t).cos(), -2.0 * (2.0 * t).sin()],
            ),
            ("exp(a*t)", [1.0, 2.0, 4.0].map(|k| k * (2.0 * t).exp())),
            (
                "a^t",
                [1.0, 2_f64.ln(), 2_f64.ln().powi(2)].map(|k| k * 2_f64.powf(t)),
            ),
            ("abs(t)", [t.abs(), t.signum(), 0.0]),
            (
                "floor(t) + ceil(t) + sign(t)",
                [t.floor() + t.ceil() + t.signum(), 0.0, 0.0],
            ),
            ("max(t, 0)", if t > 0.0 { [t, 1.0, 0.0] } else { [0.0; 3] }),
            ("min(t, 0)", if t < 0.0 { [t, 1.0, 0.0] } else { [0.0; 3] }),
            ("mod(t, 2)", [t.rem_euclid(2.0), 1.0, 0.0]),
        ];
        for (text, [value, first, second]) in cases {
            let expected = Jet::new(value, [first, second]);
            assert_jets_near(jet(text, t), expected, 1e-14, &format!("{text} at {t}"));
        }
    }
}

#[test]
fn a_function_and_its_inverse_undo_each_other() {
    // The left side goes through derivative formulas that the right side does not have.
    let pairs = [
        ("asin(sin(t))", "t"),
        ("acos(cos(t))", "t"),
        ("atan(tan(t))", "t"),
        ("ln(exp(t))", "t"),
        ("log10(10^t)", "t"),
        ("sqrt(t)^2", "t"),
        ("atan2(a*sin(t), a*cos(t))", "t"),
        ("hypot(sin(t), cos(t))", "1"),
        ("hypot(3*t, 4*t)", "5*t"),
        ("cosh(t)^2 - sinh(t)^2", "1"),
        ("tanh(t)", "sinh(t)/cosh(t)"),
        ("tan(t)", "sin(t)/cos(t)"),
        ("(1 + t)^t", "exp(t*ln(1 + t))"),
        ("t^1.5", "t*sqrt(t)"),
        ("asin(t/2) + acos(t/2)", "pi/2"),
    ];
    for t in [0.2, 0.5, 0.9, 1.2] {
        for (left, right) in pairs {
            assert_jets_near(
                jet(left, t),
                jet(right, t),
                1e-13,
                &format!("{left} at {t}"),
            );
        }
    }
}

#[test]
fn constant_powers_are_right_at_zero_and_below() {
    let triple = |value, first, second| Jet::new(value, [first, second]);
    assert_eq!(jet("t^2", 0.0), triple(0.0, 0.0, 2.0));
    assert_eq!(jet("t^1", 0.0), triple(0.0, 1.0, 0.0));
    assert_eq!(jet("t^0", 0.0), triple(1.0, 0.0, 0.0));
    assert_eq!(jet("t^3", -2.0), triple(-8.0, 12.0, -12.0));
    assert_eq!(jet("t^a", -2.0), triple(4.0, -4.0, 2.0));
    assert_eq!(jet("t^-1", -2.0), triple(-0.5, -0.25, -0.25));
}

/// Integers to the rounding of an expression are integers, and its enclosure has them; others, some
/// thousand roundings away, are none.
#[test]
#[expect(clippy::float_cmp, reason = "whole numbers are exact")]
fn counts_are_whole_to_rounding() {
    for (text, whole) in [
        ("floor(10*0.3)", 3.0),
        ("floor(0.3/0.1)", 3.0),
        ("ceil(3*(1/3) + 1e-15)", 1.0),
        ("ceil(0.3/0.1)", 3.0),
        ("floor(-1e-16)", 0.0),
        ("floor(3 - 1e-12)", 2.0),
        ("ceil(-3 + 1e-12)", -2.0),
        ("mod(0.3, 0.1)", 0.0),
        ("mod(-1e-17, 1)", 0.0),
        ("mod(-0.3, -0.1)", 0.0),
    ] {
        assert_eq!(value(text), whole, "{text}");
        let expression = parse(text).expect(text);
        let bounds: Interval = expression.evaluate(&|_| Interval::point(0.0), Interval::point(0.0));
        assert!(bounds.contains(whole), "{text}: {bounds:?}");
    }
}

#[test]
fn what_does_not_vary_has_no_derivatives() {
    // Each has an infinite slope or none where it stands.
    for text in [
        "sqrt(a - 2)",
        "hypot(a - 2, 0)",
        "(a - 2)^0.5",
        "acos(a - 1)",
        "abs(a - 2)",
    ] {
        let jet = jet(text, 1.0);
        assert_eq!((jet.first(), jet.second()), (0.0, 0.0), "{text}");
    }
}

#[test]
fn outside_its_domain_a_function_is_not_finite() {
    for text in [
        "sqrt(-a)",
        "ln(0*a)",
        "asin(a)",
        "1/(a - 2)",
        "min(sqrt(-a), 1)",
        "max(1, sqrt(-a))",
    ] {
        assert!(!value(text).is_finite(), "{text}");
    }
}

/// Expressions that use everything, as text.
fn any_text() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        (0.0..10.0).prop_map(|number: f64| format!("{number:?}")),
        proptest::sample::select(vec!["a", "b", "length", "t", "pi", "deg", "2", "1e-3", "0"])
            .prop_map(str::to_owned),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let infix = proptest::sample::select(vec!["+", "-", "*", "/", "^"]);
        let function = proptest::sample::select(function::FUNCTIONS.to_vec());
        prop_oneof![
            (inner.clone(), infix, inner.clone()).prop_map(|(x, op, y)| format!("({x}){op}({y})")),
            inner.clone().prop_map(|x| format!("-({x})")),
            (function, inner.clone(), inner).prop_map(|((name, function), x, y)| {
                match function {
                    Operation::Unary(_) => format!("{name}({x})"),
                    _ => format!("{name}({x}, {y})"),
                }
            }),
        ]
    })
}

/// Smooth expressions, finite with moderate derivatives for t in [0, 1].
fn smooth_text() -> impl Strategy<Value = String> {
    let leaf =
        proptest::sample::select(vec!["t", "a", "b", "length", "0.7", "t"]).prop_map(str::to_owned);
    leaf.prop_recursive(4, 20, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("({x} + {y})/2")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("sin({x} - {y})")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("cos({x})*{y}")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("{x}/(2 + cos({y}))")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("hypot(1 + {x}^2, {y})")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("atan2({x}, 1 + ({y})^2)")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("(1.5 + sin({x}))^cos({y})")),
            inner.clone().prop_map(|x| format!("sqrt(1 + ({x})^2)")),
            inner.clone().prop_map(|x| format!("ln(2 + sin({x}))")),
            inner.clone().prop_map(|x| format!("tanh({x})")),
            inner.clone().prop_map(|x| format!("atan({x})")),
            inner.prop_map(|x| format!("asin(0.9*sin({x}))")),
        ]
    })
}

proptest! {
    #[test]
    fn triples_are_the_limits_of_differences(text in smooth_text(), t in 0.0..1.0_f64) {
        let h = 1e-4;
        let here = jet(&text, t);
        let (before, after) = (jet(&text, t - h), jet(&text, t + h));
        // The error of a central difference is h²/6 times the third derivative, which stays
        // below some thousands here.
        let tolerance = 1e-4;
        assert_near(here.first(), (after.value - before.value) / (2.0 * h), tolerance, &text);
        assert_near(here.second(), (after.first() - before.first()) / (2.0 * h), tolerance, &text);
    }

    #[test]
    fn numbers_and_triples_have_the_same_value(text in any_text(), t in -2.0..2.0_f64) {
        if let Ok(expression) = parse(&text) {
            let number = expression.evaluate(&|id| VALUES[id.index()], t);
            prop_assert_eq!(number.to_bits(), jet(&text, t).value.to_bits());
        }
    }
}
