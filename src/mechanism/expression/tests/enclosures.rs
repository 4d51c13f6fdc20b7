//! Enclosures: that they contain, that they are narrow, and where there is none.

use super::*;

fn enclose(text: &str, low: f64, high: f64) -> Option<Jet3<Interval>> {
    let expression = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    expression.enclose(&|id| VALUES[id.index()], Interval::new(low, high))
}

/// Value, first, second and third derivative.
fn orders<S: Copy>(jet: Jet3<S>) -> [S; 4] {
    let [first, second, third] = jet.derivatives;
    [jet.value, first, second, third]
}

/// Returns whether `value`, which comes from arithmetic that rounds to the nearest, may be a
/// rounded value from `interval`.
fn contains_rounded(interval: Interval, value: f64) -> bool {
    // Some ten operations of half an epsilon each, with a magnification of a hundred.
    let slack = 1e-13 * (1.0 + value.abs());
    interval.low - slack <= value && value <= interval.high + slack
}

#[test]
fn bounds_are_near_the_truth_on_a_tenth_of_a_radian() {
    // With the parameters length = r = 0.5 and e = 0.15.
    let profiles = [
        "0.04 + 0.01*(1 - cos(t))",
        "sqrt(length^2 - (0.15*sin(t))^2) + 0.15*cos(t)",
        "0.03 + 0.005*sin(2*t)",
        "hypot(length*cos(t), 0.3*sin(t))",
        "1/(2 + 0.5*cos(t))",
    ];
    for text in profiles {
        let magnitudes = |low: f64, width: f64| {
            let samples = (0..=100).map(|k| orders(jet3(text, low + 0.01 * width * f64::from(k))));
            samples.fold([0.0; 4], |most: [f64; 4], sample| {
                [0, 1, 2, 3].map(|k| most[k].max(sample[k].abs()))
            })
        };
        let over_a_turn = magnitudes(0.0, 2.0 * PI);
        for step in 0..63 {
            let low = 0.1 * f64::from(step);
            let enclosure = orders(enclose(text, low, low + 0.1).expect(text));
            let truth = magnitudes(low, 0.1);
            for (order, bounds) in enclosure.into_iter().enumerate() {
                let (bound, truth) = (bounds.magnitude(), truth[order]);
                let what = format!("derivative {order} of {text} from {low}: {bounds:?}, {truth}");
                assert!(bound >= truth * (1.0 - 1e-12), "{what}");
                let most = match order {
                    // The bound may be farther off near a change of sign of the third derivative,
                    // but not by what matters beside the rest of the turn.
                    3 => 2.0 * truth.max(0.02 * over_a_turn[order]),
                    _ => 1.5 * truth,
                };
                assert!(bound <= most, "{what}");
            }
        }
    }
}

#[test]
fn what_is_not_smooth_is_not_enclosed() {
    let cases = [
        ("abs(t)", -1.0, 1.0),
        ("abs(sin(t))*t", 3.0, 3.2),
        ("sign(t)", -1.0, 1.0),
        ("floor(t)", 0.5, 1.5),
        ("ceil(t)", 0.5, 1.5),
        ("mod(t, b)", 2.0, 4.0),
        ("mod(t, t - 1)", 0.5, 1.5),
        ("min(t, 1)", 0.5, 1.5),
        ("max(t, 1)", 0.5, 1.5),
        ("max(sqrt(t), -1)", -1.0, 1.0),
        ("min(sqrt(t), -1)", -1.0, 1.0),
        ("0*asin(t)", 0.5, 1.5),
        ("sqrt(t)", 0.0, 1.0),
        ("sqrt(t)", -1.0, 1.0),
        ("sqrt(t)", -2.0, -1.0),
        ("ln(t)", 0.0, 1.0),
        ("log10(t)", -1.0, 1.0),
        ("asin(t)", 0.5, 1.0),
        ("acos(t)", 0.5, 1.5),
        ("asin(t)", 1.5, 2.0),
        ("tan(t)", 1.5, 1.6),
        ("1/t", -1.0, 1.0),
        ("1/t", 0.0, 1.0),
        ("1/(t - t)", 0.0, 1.0),
        ("t^-2", -1.0, 1.0),
        ("t^-3", 0.0, 1.0),
        ("t^0.5", 0.0, 1.0),
        ("t^2.5", 0.0, 1.0),
        ("t^3.5", -1.0, 1.0),
        ("t^t", 0.0, 1.0),
        ("(-1)^t", 0.5, 1.5),
        ("hypot(t, 0)", -1.0, 1.0),
        ("hypot(t, t)", -1.0, 1.0),
        ("atan2(t, -1)", -1.0, 1.0),
        ("atan2(t, -1)", -1.0, 0.0),
        ("atan2(t, t)", -1.0, 1.0),
        ("exp(t)", 0.0, 1000.0),
        ("sqrt(-a)*t", 0.0, 1.0),
        ("t", 1.0, -1.0),
        ("t", f64::NAN, 1.0),
        ("t", 0.0, f64::INFINITY),
    ];
    for (text, low, high) in cases {
        assert_eq!(enclose(text, low, high), None, "{text} on [{low}, {high}]");
    }
}

#[test]
fn a_piece_that_is_decided_is_enclosed_as_itself() {
    let cases = [
        ("abs(t)", 0.0, 1.0, "t"),
        ("abs(t)", -1.0, 0.0, "-t"),
        ("abs(t^3)", 0.0, 2.0, "t^3"),
        ("sign(t)", 0.1, 1.0, "1"),
        ("floor(t)", 2.0, 2.9, "2"),
        ("ceil(t)", 2.1, 3.0, "3"),
        ("mod(t, b)", 3.5, 5.0, "t - 3"),
        ("min(t, 1)", 0.0, 1.0, "t"),
        ("min(t, 1)", 1.0, 2.0, "1"),
        ("max(t, 1)", 1.0, 2.0, "t"),
        ("max(t, 1)", 0.0, 1.0, "1"),
        ("min(t, 3, t^2)", -1.0, -0.5, "t"),
        ("max(abs(t), 5)", -1.0, 1.0, "5"),
        ("floor(abs(t)/10)", -1.0, 1.0, "0"),
        ("sign(3 + floor(t))", -0.5, 0.5, "1"),
    ];
    for (text, low, high, piece) in cases {
        let found = enclose(text, low, high).expect(text);
        let expected = enclose(piece, low, high).expect(piece);
        for (found, expected) in orders(found).into_iter().zip(orders(expected)) {
            for (found, expected) in [(found.low, expected.low), (found.high, expected.high)] {
                assert_near(found, expected, 1e-15, text);
            }
        }
    }
    // Onto its jump from above the angle is continuous.
    let angle = enclose("atan2(t, -1)", 0.0, 1.0).expect("smooth").value;
    assert_near(angle.low, 0.75 * PI, 1e-15, "least angle");
    assert_near(angle.high, PI, 1e-15, "largest angle");
}

#[test]
fn what_does_not_vary_is_always_enclosed() {
    let texts = [
        "abs(a - 2)",
        "sign(a - 2)",
        "floor(a - 2)",
        "ceil(0.1*b - 0.3)",
        "floor(0.1*b/0.1)",
        "mod(0.3, 0.1*a/2)",
        "min(0.1*b, 0.3)",
        "max(0.1*b, 0.3)",
        "sqrt(a - 2)",
        "hypot(a - 2, 0)",
        "atan2(a - 2, -1)",
        "atan2(a - 2, 0)",
        "(a - 2)^0.5",
        "(a - 2)^(1/b)",
        "(-a)^b",
        "acos(a - 1)",
        "asin(1 - a)",
        "tan(pi/a)",
    ];
    for text in texts {
        let enclosure = enclose(&format!("{text} + t"), 0.0, 1.0).expect(text);
        let [zero, one] = [0.0, 1.0].map(Interval::point);
        assert_eq!(enclosure.first(), one, "{text}");
        assert_eq!([enclosure.second(), enclosure.third()], [zero; 2], "{text}");
        let constant = enclose(text, 0.0, 1.0).expect(text).value;
        assert!(constant.contains(value(text)), "{text}: {constant:?}");
    }
}

#[test]
fn integer_powers_are_as_narrow_as_can_be() {
    let square = enclose("t^2", -1.0, 2.0).expect("smooth");
    let [value, first, second, third] = orders(square);
    assert_eq!(value, Interval::new(0.0, 4.0));
    assert_eq!(first, Interval::new(-2.0, 4.0));
    assert_eq!(second, Interval::point(2.0));
    assert_eq!(third, Interval::point(0.0));
    let cube = enclose("t^3", -1.0, 2.0).expect("smooth").value;
    assert_near(cube.low, -1.0, 1e-15, "least cube");
    assert_near(cube.high, 8.0, 1e-15, "largest cube");
}

#[test]
fn crests_and_troughs_are_reached() {
    for turn in [-1000.0, -1.0, 0.0, 1.0, 1e6] {
        let crest = turn * 2.0 * PI;
        let range = |text, from: f64, to: f64| enclose(text, crest + from, crest + to).expect(text);
        let highest = |text, from, to| range(text, from, to).value.high;
        assert_near(highest("cos(t)", -0.1, 0.2), 1.0, 0.0, "cos at its crest");
        assert_near(highest("cos(t)", 0.1, 0.2), 0.1_f64.cos(), 1e-9, "beyond");
        assert_near(range("cos(t)", 3.0, 3.2).value.low, -1.0, 0.0, "trough");
        assert_near(highest("sin(t)", 1.5, 1.6), 1.0, 0.0, "sin at its crest");
        assert_near(range("sin(t)", 4.7, 4.8).value.low, -1.0, 0.0, "trough");
    }
}

/// Whole numbers, of which sums, products and their bounds can be computed exactly.
fn whole() -> impl Strategy<Value = i64> {
    -(1_i64 << 53)..(1_i64 << 53)
}

#[expect(clippy::cast_precision_loss, reason = "up to 2^53 all are numbers")]
fn point(whole: i64) -> Interval {
    Interval::point(whole as f64)
}

/// Returns whether the bounds are one number or neighbours.
fn is_one_rounding(interval: Interval) -> bool {
    interval.high <= interval.low.next_up()
}

/// Returns whether the bounds are the numbers next to `exact`, or `exact` itself.
#[expect(clippy::cast_possible_truncation, reason = "whole numbers below 2^106")]
fn is_tight(interval: Interval, exact: i128) -> bool {
    let contains = (interval.low as i128) <= exact && exact <= (interval.high as i128);
    let known = interval.low as i128 == exact || interval.high as i128 == exact;
    contains && known == interval.is_single() && is_one_rounding(interval)
}

proptest! {
    #[test]
    fn sums_and_products_are_rounded_outward(x in whole(), y in whole()) {
        let (exact_x, exact_y) = (i128::from(x), i128::from(y));
        prop_assert!(is_tight(point(x) + point(y), exact_x + exact_y));
        prop_assert!(is_tight(point(x) - point(y), exact_x - exact_y));
        prop_assert!(is_tight(point(x) * point(y), exact_x * exact_y));
        prop_assert!(is_tight(point(x).square(), exact_x * exact_x));
    }

    #[test]
    fn quotients_and_roots_are_rounded_outward(x in whole(), y in whole()) {
        prop_assume!(y != 0);
        let quotient = point(x) / point(y);
        prop_assert!(is_one_rounding(quotient));
        prop_assert!((quotient * point(y)).contains(point(x).low));
        let root = point(x.abs()).sqrt();
        prop_assert!(is_one_rounding(root));
        prop_assert!(root.square().contains(point(x.abs()).low));
    }

    #[test]
    fn tiny_results_are_rounded_outward(x in -1.0..1.0_f64, y in -1.0..1.0_f64) {
        // The bounds at 1e-320 hold the values at 1, scaled by powers of two.
        let scale = |exponent| Interval::point(2_f64.powi(exponent));
        let (x, y) = (Interval::point(x), Interval::point(y));
        let product = (x * scale(-540)) * (y * scale(-530));
        let scaled = (x * y) * scale(-1000) * scale(-70);
        prop_assert!(product.low <= scaled.high && scaled.low <= product.high);
        prop_assert!(product.low < product.high || product.is_zero());
    }

    #[test]
    fn enclosures_contain_every_point(
        (text, low, high) in proptest::sample::select(&SMOOTH[..]),
        ends in [0.0..1.0_f64, 0.0..1.0],
        part in 0.0..=1.0_f64,
    ) {
        let (first, last) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let at = |part: f64| (low + (high - low) * part).min(high);
        let (from, to) = (at(first), at(last));
        let t = (from + (to - from) * part).clamp(from, to);
        // A wide interval may be too much for a function of several variable parts.
        if let Some(enclosure) = enclose(text, from, to) {
            let point = orders(enclose(text, t, t).expect("defined in a part"));
            let rounded = orders(jet3(text, t));
            for (order, bounds) in orders(enclosure).into_iter().enumerate() {
                let what = format!("({text}) {order} at {t} of [{from}, {to}]: {bounds:?}");
                prop_assert!(contains_rounded(bounds, rounded[order]), "{}, {}", what, rounded[order]);
                let common = bounds.intersection(point[order]);
                prop_assert!(common.is_finite(), "{}, {:?}", what, point[order]);
            }
        } else {
            prop_assert!(to - from > 0.05, "{} on [{}, {}]", text, from, to);
        }
    }

    #[test]
    fn a_point_is_enclosed_within_rounding(
        (text, low, high) in proptest::sample::select(&SMOOTH[..]),
        part in 0.01..=0.99_f64,
    ) {
        let t = low + (high - low) * part;
        let rounded = orders(jet3(text, t));
        for (order, bounds) in orders(enclose(text, t, t).expect(text)).into_iter().enumerate() {
            let scale = bounds.magnitude().max(1.0);
            let width = bounds.high - bounds.low;
            prop_assert!(width <= 1e-12 * scale, "({}) {} at {}: {:?}", text, order, t, bounds);
            prop_assert!(contains_rounded(bounds, rounded[order]));
        }
    }

    #[test]
    fn enclosures_of_compositions_contain_every_point(
        text in smooth_text(),
        from in 0.0..1.0_f64,
        width in 0.0..0.2_f64,
        part in 0.0..=1.0_f64,
    ) {
        let t = (from + width * part).clamp(from, from + width);
        if let Some(enclosure) = enclose(&text, from, from + width) {
            let rounded = orders(jet3(&text, t));
            for (bounds, value) in orders(enclosure).into_iter().zip(rounded) {
                prop_assert!(contains_rounded(bounds, value), "{} at {}: {:?}, {}", text, t, bounds, value);
            }
        }
    }

    #[test]
    fn whatever_the_text_an_enclosure_contains_or_is_none(
        text in any_text(),
        ends in [-2.0..2.0_f64, -2.0..2.0],
        part in 0.0..=1.0_f64,
    ) {
        let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let t = (from + (to - from) * part).clamp(from, to);
        let Ok(expression) = parse(&text) else {
            return Ok(());
        };
        let range = Interval::new(from, to);
        if let Some(enclosure) = expression.enclose(&|id| VALUES[id.index()], range) {
            // Any formula may magnify rounding; how much, a point's own enclosure tells.
            if let Some(point) = expression.enclose(&|id| VALUES[id.index()], Interval::point(t)) {
                for (bounds, point) in orders(enclosure).into_iter().zip(orders(point)) {
                    prop_assert!(bounds.intersection(point).is_finite(), "{}: {:?}, {:?}", text, bounds, point);
                }
            }
        }
    }
}
