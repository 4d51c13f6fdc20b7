//! Functions of the file, against formulas written apart.

use biela::mechanism::{
    Dual, Expression, Interval, Jet3, Mechanism, ParameterId, Source, Taylor, Variable,
};
use proptest::prelude::*;

/// A mechanism with functions, and expressions that call them over time.
fn with_functions(functions: &str) -> Mechanism {
    with_parameters(functions, "")
}

/// As [`with_functions`], with further parameters.
fn with_parameters(functions: &str, parameters: &str) -> Mechanism {
    let text = format!(
        "format = 1\nname = \"functions\"\n{functions}\n\
         [parameters]\n{parameters}k = {{ value = 1.5, tunable = true }}\n\
         [ground.markers]\nO = [0, 0]\n[bodies.a.markers]\nO = [0, 0]\n\
         [joints.O]\ntype = \"revolute\"\nmarkers = [\"ground.O\", \"a.O\"]\n\
         [drivers.a_turn]\ncoordinate = \"angle\"\nmarkers = [\"ground.O\", \"a.O\"]\nstart = 0\n"
    );
    let source = Source::new("functions.toml", text);
    let (mechanism, _) = Mechanism::parse(&source).unwrap_or_else(|problems| {
        panic!(
            "{:#?}",
            problems
                .iter()
                .map(|p| p.one_line(&source))
                .collect::<Vec<_>>()
        )
    });
    mechanism
}

fn call(mechanism: &Mechanism, text: &str) -> Expression {
    let parsed = mechanism.parse_expression(text, Some(Variable::Time));
    parsed.unwrap_or_else(|error| panic!("{text}: {}", error.message))
}

fn at(expression: &Expression, t: f64) -> f64 {
    expression.evaluate(&|_| 1.5, t)
}

/// Asserts that two numbers are the same, up to the rounding of one.
#[track_caller]
fn assert_same(found: f64, expected: f64) {
    let rounding = f64::EPSILON * expected.abs();
    assert!((found - expected).abs() <= rounding, "{found} {expected}");
}

const POINTS: [[f64; 2]; 4] = [[-1.0, 2.0], [0.0, 0.5], [0.5, 0.5], [2.0, -1.0]];

/// One function of each course and kind of ends through the same points, and one of them with a parameter.
fn all() -> Mechanism {
    let points = "[[-1, 2], [0, 0.5], [0.5, 0.5], [2, -1]]";
    let moving = "[[-1, 2], [0, \"k/3\"], [0.5, 0.5], [2, \"-k/1.5\"]]";
    let mut text = String::from("[functions]\n");
    for law in ["spline", "linear", "steps", "cycloidal", "harmonic"] {
        for ends in ["clamped", "linear", "zero", "periodic"] {
            text += &format!(
                "{law}_{ends} = {{ table = {points}, law = \"{law}\", ends = \"{ends}\" }}\n"
            );
        }
    }
    text += &format!("moved = {{ table = {moving} }}\n");
    text += &format!("scaled = {{ table = {points}, scale = [\"2\", \"k\"] }}\n");
    text += "sum = { of = [\"a\", \"b\"], value = \"a + 2*b + k\" }\n";
    text += "nested = { value = \"sum(spline_clamped(x), x^2)\" }\n";
    with_functions(&text)
}

/// The value of straight lines through the points.
fn on_lines(x: f64) -> f64 {
    let k = if x < 0.0 {
        0
    } else if x < 0.5 {
        1
    } else {
        2
    };
    let ([a, f], [b, g]) = (POINTS[k], POINTS[k + 1]);
    f + (g - f) * (x - a) / (b - a)
}

#[test]
fn lines_and_steps_are_those_of_their_points() {
    let mechanism = all();
    let [line, step] = ["linear_linear(t)", "steps_clamped(t)"].map(|text| call(&mechanism, text));
    for k in -40..=60 {
        let x = 0.05 * f64::from(k);
        assert!((at(&line, x) - on_lines(x)).abs() < 1e-14, "{x}");
        let held = POINTS.iter().rev().find(|point| point[0] <= x);
        let held = held.map_or(2.0, |point| point[1]);
        assert_same(at(&step, x), held);
    }
}

#[test]
fn ends_hold_repeat_or_are_zero() {
    let mechanism = all();
    for law in ["spline", "linear", "steps", "cycloidal", "harmonic"] {
        let of = |ends: &str| call(&mechanism, &format!("{law}_{ends}(t)"));
        let (clamped, zero, periodic) = (of("clamped"), of("zero"), of("periodic"));
        for (x, value) in [(-3.0, 2.0), (-1.0, 2.0), (2.0, -1.0), (7.0, -1.0)] {
            assert_same(at(&clamped, x), value);
            let expected = if (-1.0..=2.0).contains(&x) {
                value
            } else {
                0.0
            };
            assert_same(at(&zero, x), expected);
        }
        // Each period begins where the one before has ended: lower by 3.
        for x in [-0.7, 0.2, 1.3] {
            assert!(
                (at(&periodic, x + 6.0) - (at(&periodic, x) - 6.0)).abs() < 1e-13,
                "{law}"
            );
        }
    }
}

#[test]
fn parameters_move_points_and_factors() {
    let mechanism = all();
    let [moved, fixed, scaled] =
        ["moved(t)", "spline_clamped(t)", "scaled(t)"].map(|text| call(&mechanism, text));
    for x in [-1.3, -0.4, 0.2, 1.1, 2.5] {
        // For k = 1.5 the points are the same.
        assert!((at(&moved, x) - at(&fixed, x)).abs() < 1e-14, "{x}");
        assert!(
            (at(&scaled, 2.0 * x) - 1.5 * at(&fixed, x)).abs() < 1e-14,
            "{x}"
        );
    }
    // The derivative by the parameter, against differences.
    for expression in [&moved, &scaled] {
        for x in [-0.4, 0.2, 1.1] {
            let value = |k: f64| expression.evaluate(&|_| k, x);
            let dual = expression.evaluate(&|_| Dual::variable(1.5), Dual::constant(x));
            // Splines are linear in their ordinates: differences are exact to rounding.
            let slope = (value(2.0) - value(1.0)) / 1.0;
            assert!((dual.first() - slope).abs() < 1e-13, "{x}");
        }
    }
    assert!(moved.parameters().eq([ParameterId(0)]));
}

#[test]
fn functions_call_functions() {
    let mechanism = all();
    let [nested, inner] = ["nested(t)", "spline_clamped(t)"].map(|text| call(&mechanism, text));
    for x in [-0.4, 0.2, 1.1] {
        assert!((at(&nested, x) - (at(&inner, x) + 2.0 * x * x + 1.5)).abs() < 1e-14);
    }
}

/// A parameter that calls a function follows from what that uses, by its value and its derivative: here by
/// way of a function whose points use a parameter, which calls one itself.
#[test]
fn parameters_call_functions() {
    let mechanism = with_parameters(
        "[functions]\n\
         square = { value = \"k*x^2\" }\n\
         line = { table = [[0, 0], [2, \"top\"]], law = \"linear\" }\n\
         plain = { table = [[0, 3], [1, 5]], law = \"linear\" }\n",
        "lift = \"line(0.5) + top\"\ntop = { value = \"square(2)\", max = \"plain(1) + 2\" }\n\
         start = { value = \"plain(0.5)\", tunable = true }\n",
    );
    // lift = top/4 + top, top = 4 k, and the last one is a number.
    assert_eq!(mechanism.default_parameters(), [7.5, 6.0, 4.0, 1.5]);
    let derived: Vec<bool> = mechanism.parameters.iter().map(|p| p.derived).collect();
    assert_eq!(derived, [true, true, false, false]);
    assert_eq!(mechanism.parameters[1].max, Some(7.0));
    let mut values = [0.0, 0.0, 4.0, 3.0].map(Dual::constant);
    values[3] = Dual::new(3.0, [1.0]);
    mechanism.derive_parameters(&mut values);
    let found = values.map(|value| [value.value, value.first()]);
    assert_eq!(found, [[15.0, 5.0], [12.0, 4.0], [4.0, 0.0], [3.0, 1.0]]);
}

/// Value and derivatives on some type of numbers with derivatives lie in their bounds over a range.
fn assert_enclosed(expression: &Expression, [low, high]: [f64; 2], x: f64) {
    let parameter = |_| Jet3::constant(1.5);
    let range = Jet3::variable(Interval::new(low, high));
    let bounds = expression.evaluate(&|_| Jet3::constant(1.5), range);
    let exact = expression.evaluate(&parameter, Jet3::variable(x));
    let near = |bound: Interval, value: f64| {
        let slack = 1e-9 * (1.0 + value.abs());
        bound.low - slack <= value && value <= bound.high + slack
    };
    assert!(near(bounds.value, exact.value), "{bounds:?} {exact:?}");
    let orders = bounds.derivatives.into_iter().zip(exact.derivatives);
    for (bound, value) in orders {
        assert!(near(bound, value), "{bounds:?} {exact:?}");
    }
    // The same with the slope along a further variable.
    type WithSlope = Taylor<Jet3<Interval>, 1>;
    let lifted = expression.evaluate(&|_| WithSlope::constant(1.5), WithSlope::variable(range));
    assert!(
        near(lifted.first().value, exact.first()),
        "{lifted:?} {exact:?}"
    );
}

proptest! {
    #[test]
    fn bounds_hold(low in -4.0..4.0_f64, width in 0.0..2.5_f64, part in 0.0..1.0_f64) {
        let mechanism = all();
        for function in mechanism.functions.list().iter().filter(|f| f.arguments == 1) {
            let expression = call(&mechanism, &format!("{}(t)", function.name));
            assert_enclosed(&expression, [low, low + width], low + part * width);
        }
    }

    /// Derivatives are those of the value, away from points: differences of second order on a step of h
    /// differ by a sixth of the third derivative, below 100 here, times h².
    #[test]
    fn derivatives_are_those_of_the_value(x in -0.95..1.95_f64) {
        const H: f64 = 1e-4;
        let mechanism = all();
        for function in mechanism.functions.list().iter().filter(|f| f.arguments == 1) {
            let expression = call(&mechanism, &format!("{}(t)", function.name));
            let is_near = POINTS.iter().any(|[at, _]| (at - x).abs() < 2.0 * H)
                || [0.5, -0.5].iter().any(|half| (x - half).abs() < 1e-2);
            if is_near {
                continue;
            }
            let jet = expression.evaluate(&|_| Jet3::constant(1.5), Jet3::variable(x));
            let slope = (at(&expression, x + H) - at(&expression, x - H)) / (2.0 * H);
            prop_assert!((jet.first() - slope).abs() < 100.0 * H * H, "{} {x}", function.name);
        }
    }
}

/// A grid of a polynomial, cubic in both arguments: a spline without knots at the points next to the ends
/// is exact, and bilinear values are those of the formula at the points.
#[test]
fn grids_follow_their_values() {
    let f = |x: f64, y: f64| 1.0 + x * y - 0.5 * x * x * y + y * y * y - 0.2 * x * x * x;
    let xs = [-1.0, 0.0, 0.7, 1.5, 2.0];
    let ys = [0.0, 1.0, 1.5, 3.0];
    let mut csv = String::from("x\\y");
    for y in ys {
        csv += &format!(",{y}");
    }
    for x in xs {
        csv += &format!("\n{x}");
        for y in ys {
            csv += &format!(",{}", f(x, y));
        }
    }
    let folder = std::env::temp_dir().join(format!("biela-grid-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("map.csv"), csv).expect("a file");
    let text = "format = 1\nname = \"grid\"\n[functions]\n\
        smooth = { file = \"map.csv\", arguments = 2 }\n\
        flat = { file = \"map.csv\", arguments = 2, law = \"linear\", ends = \"linear\" }\n\
        out = { file = \"map.csv\", arguments = 2, ends = \"zero\" }\n\
        scaled = { file = \"map.csv\", arguments = 2, scale = [2, \"k\", -1] }\n\
        [parameters]\nk = 1.5\n\
        [ground.markers]\nO = [0, 0]\n[bodies.a.markers]\nO = [0, 0]\n\
        [joints.O]\ntype = \"revolute\"\nmarkers = [\"ground.O\", \"a.O\"]\n\
        [drivers.a_turn]\ncoordinate = \"angle\"\nmarkers = [\"ground.O\", \"a.O\"]\nstart = 0\n";
    let path = folder.join("grid.toml");
    std::fs::write(&path, text).expect("a file");
    let source = Source::open("grid.toml".to_owned(), &path).expect("it is text");
    let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
    std::fs::remove_dir_all(&folder).expect("it is ours");
    for k in 0..=30 {
        let x = -1.0 + 0.1 * f64::from(k);
        for y in [0.0, 0.4, 1.2, 2.0, 3.0] {
            let value = |name: &str| at(&call(&mechanism, &format!("{name}(t, {y})")), x);
            assert!((value("smooth") - f(x, y)).abs() < 1e-13, "{x} {y}");
            assert!((value("out") - f(x, y)).abs() < 1e-13);
            let scaled = at(
                &call(&mechanism, &format!("scaled(t, {})", 1.5 * y)),
                2.0 * x,
            );
            assert!((scaled + f(x, y)).abs() < 1e-13);
            // Partial derivatives by duals.
            let smooth = call(&mechanism, &format!("smooth(t, {y})"));
            let slope = smooth
                .evaluate(&|_| Dual::constant(1.5), Dual::variable(x))
                .first();
            let exact = y - x * y - 0.6 * x * x;
            assert!((slope - exact).abs() < 1e-12, "{slope} {exact}");
        }
    }
    let value = |name: &str, x: f64, y: f64| at(&call(&mechanism, &format!("{name}(t, {y})")), x);
    for (i, x) in xs.into_iter().enumerate() {
        assert!(
            (value("flat", x, 1.25) - 0.5 * (f(x, 1.0) + f(x, 1.5))).abs() < 1e-13,
            "{i}"
        );
    }
    // Beyond: the border's value, the last slope, zero.
    assert!((value("smooth", 5.0, -1.0) - f(2.0, 0.0)).abs() < 1e-13);
    let slope = (f(2.0, 1.0) - f(1.5, 1.0)) / 0.5;
    assert!((value("flat", 3.0, 1.0) - (f(2.0, 1.0) + slope)).abs() < 1e-12);
    assert_same(value("out", 2.5, 1.0), 0.0);
    // Bounds over ranges of the first argument.
    for name in ["smooth", "flat", "out"] {
        let expression = call(&mechanism, &format!("{name}(t, 1.2)"));
        for [low, high] in [[-0.5, 0.5], [0.8, 1.2], [1.4, 2.6]] {
            for part in [0.1, 0.45, 0.9] {
                assert_enclosed(&expression, [low, high], low + part * (high - low));
            }
        }
    }
}

#[test]
fn units_are_factors_unless_a_parameter_has_their_name() {
    let table = "table = [[0, 1], [90, 3]], law = \"linear\"";
    let mechanism = with_functions(&format!(
        "[functions]\n\
         gas = {{ {table}, scale = [\"deg\", \"bar\"] }}\n\
         flow = {{ {table}, scale = [\"mm/s\", \"l/min\"] }}\n\
         own = {{ {table}, scale = [\"k\", \"kN\"] }}\n"
    ));
    for (text, per_unit, size) in [
        ("gas(t)", std::f64::consts::PI / 180.0, 1e5),
        ("flow(t)", 1e-3, 1e-3 / 60.0),
        // `k` is a parameter.
        ("own(t)", 1.5, 1e3),
    ] {
        let found = at(&call(&mechanism, text), 45.0 * per_unit);
        assert!(
            (found / (2.0 * size) - 1.0).abs() < 4.0 * f64::EPSILON,
            "{text}"
        );
    }
}
