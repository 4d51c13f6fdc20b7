//! Texts: errors with their places, what names mean where, and printing.

use super::*;

#[test]
fn the_parameters_used_are_each_listed_once() {
    let expression = parse("length*a + a*t^2").expect("legal");
    let used: Vec<ParameterId> = expression.parameters().collect();
    assert_eq!(used, [ParameterId(0), ParameterId(2)]);
    assert!(expression.uses(Variable::Time));
    assert!(!parse("a").expect("legal").uses(Variable::Time));
    assert_eq!(expression.literal(), None);
    assert_eq!(parse("2*3 - 1").expect("legal").literal(), Some(5.0));
    assert_eq!(parse("0*a").expect("legal").literal(), None);
}

#[test]
fn errors_say_where_and_what_would_be_right() {
    let lines: Vec<String> = [
        "",
        "  ",
        "2m",
        "2mm",
        "2 a",
        "a(1)",
        "(a)(b)",
        "2(a)",
        "1 +",
        "1 + * 2",
        "a**2",
        ")",
        "(",
        "(1 + (2)",
        "1)",
        "sin",
        "sin a",
        "sin()",
        "sin(1, 2)",
        "atan2(1)",
        "min(1)",
        "min(,)",
        "log(a)",
        "pow(a, 2)",
        "sim(a)",
        "lenght",
        "2*m",
        "0.005*m",
        "0.07 m",
        "0,5",
        "1.2.3",
        "1..2",
        "1e999",
        "1e",
        "a.b",
        "π",
        "60°",
        "a − b",
        "a\u{0}b",
        "é",
        "1/0",
        "1 + sqrt(2 - 3)*a",
        "10^400",
        "(0/0)",
        "_a",
        "2^",
        "a = b",
        "[1]",
        "t t",
        "1_000",
    ]
    .into_iter()
    .map(|text| {
        let error = parse(text).expect_err(text);
        let marked = &text[error.span.clone()];
        let help = error.help.map_or(String::new(), |help| format!("; {help}"));
        format!("{text:?} at {marked:?}: {}{help}", error.message)
    })
    .collect();
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn time_is_refused_where_it_has_no_place() {
    let parameters = NameTable::new();
    let scope = Scope::new(&parameters, &[]);
    let error = Expression::parse("2*t", scope).expect_err("no time here");
    assert_eq!(error.span, 2..3);
    assert_eq!(
        error.message,
        "only a `motion` or the `value` of a force may use time `t`"
    );
    assert_eq!(error.help, None);
}

#[test]
fn the_polar_angle_has_its_place_in_a_profile() {
    let parse = |text, names: &[&'static str], variables: &[Variable]| {
        let ids = (0..).map(ParameterId);
        let parameters: NameTable<'_, ParameterId> = names.iter().copied().zip(ids).collect();
        let scope = Scope::new(&parameters, variables);
        Expression::parse(text, scope)
    };
    let profile = &[Variable::PolarAngle][..];
    let cam = parse("2 + cos(theta)", &[], profile).expect("legal");
    assert!(cam.uses(Variable::PolarAngle));
    assert_eq!(cam.display(|_| "").to_string(), "2.0 + cos(theta)");
    assert_near(cam.evaluate(&|_| 0.0, PI), 1.0, 0.0, "a cam");

    // Elsewhere a parameter may bear the name.
    let tilted = parse("2*theta", &["theta"], &[Variable::Time]).expect("legal");
    assert!(!tilted.uses(Variable::PolarAngle));
    assert!(parse("1", &["theta"], profile).is_ok());

    let failing: [(&str, &[&str], _, &str, &str); 4] = [
        (
            "2*theta",
            &["theta"],
            profile,
            "`theta` is both a parameter and the variable here",
            "rename the parameter",
        ),
        (
            "2*theta",
            &[],
            &[],
            "no parameter `theta`",
            "only a cam's `profile` may use `theta`, its polar angle",
        ),
        (
            "2*theta",
            &["thet"],
            &[Variable::Time],
            "no parameter `theta`",
            "only a cam's `profile` may use `theta`, its polar angle",
        ),
        (
            "2*t",
            &[],
            profile,
            "only a `motion` or the `value` of a force may use time `t`",
            "here the variable is `theta`",
        ),
    ];
    for (text, names, variable, message, help) in failing {
        let error = parse(text, names, variable).expect_err(text);
        assert_eq!(error.span, 2..text.len(), "{text}");
        assert_eq!(error.message, message);
        assert_eq!(error.help.as_deref(), Some(help));
    }
}

#[test]
fn deep_nesting_is_refused_not_overflown() {
    let nested = |open: &str, close: &str, depth: usize| {
        parse(&format!("{}t{}", open.repeat(depth), close.repeat(depth)))
    };
    let kinds = [
        ("(", ")"),
        ("-", ""),
        ("t^", ""),
        ("t + (", ")"),
        ("sin(", ")"),
        ("max(t, ", ")"),
    ];
    for (open, close) in kinds {
        assert!(nested(open, close, 20).is_ok(), "{open}");
        let error = nested(open, close, 100_000).expect_err(open);
        assert!(error.message.contains("nested too deeply"), "{open}");
    }
}

#[test]
fn length_is_no_nesting() {
    let sum = parse(&format!("t{}", " + t*2".repeat(10_000))).expect("legal");
    let value: f64 = sum.evaluate(&|_| 0.0, 1.0);
    assert_near(value, 20_001.0, 0.0, "long sum");
    let max = parse(&format!("max(0{})", ", t".repeat(10_000))).expect("legal");
    assert_near(max.evaluate(&|_| 0.0, 1.0), 1.0, 0.0, "long list");
}

proptest! {
    #[test]
    fn printed_and_parsed_again_it_is_the_same(text in any_text()) {
        // A part that is constant and not finite is refused; nothing to print then.
        if let Ok(expression) = parse(&text) {
            let printed = expression.display(|id| NAMES[id.index()]).to_string();
            let again = parse(&printed);
            prop_assert_eq!(again.as_ref(), Ok(&expression), "{}", printed);
        }
    }

    #[test]
    fn no_text_is_a_panic(text in "[ a-bt0-9.+*/^()e,µ-]{0,40}|\\PC{0,40}") {
        if let Err(error) = parse(&text) {
            prop_assert!(text.get(error.span).is_some());
        }
    }
}
