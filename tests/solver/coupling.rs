//! Equations between coordinates, phases and measures of forces against closed forms.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::Arc;

use crate::common::{assembled, parse, shipped, straight_to};
use biela::kinematics::{
    Direction, DriverPath, Error, Fit, Output, OutputSource, Path, Reason, Solution, Solver,
};
use biela::mechanism::{Jet, Mechanism, ParameterId, Signal};

/// Two arms on pivots of their own; `more` has the coupling of `b` with the driver `a`.
fn arms(more: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "arms"
[parameters]
k = {{ value = 0.7, tunable = true }}
[ground.markers]
A = [0, 0]
B = [1, 0]
[bodies.first]
markers = {{ A = [0, 0] }}
[bodies.second]
markers = {{ B = [0, 0] }}
estimate = [1, 0, 0]
mass = 2
center = [0.3, 0]
inertia = 0.05
[joints]
A = {{ type = "revolute", markers = ["ground.A", "first.A"] }}
B = {{ type = "revolute", markers = ["ground.B", "second.B"] }}
{more}
[measures]
b = {{ coordinate = "angle", markers = ["ground.B", "second.B"] }}
[drivers]
a = {{ coordinate = "angle", markers = ["ground.A", "first.A"], start = 0 }}
"#
    ))
}

/// Solves rates and forces for a driver at its value with these rates.
fn solved(solver: &mut Solver, [velocity, acceleration]: [f64; 2]) -> Solution {
    let mut solution = Solution::new(solver);
    solution.seek_forces(solver);
    solution.driver_rates[0] = Jet::new(solver.pose().drivers[0], [velocity, acceleration]);
    solution.solve(solver).expect("the pose is regular");
    solution
}

/// Returns the value of an output.
fn value(solver: &Solver, solution: &Solution, name: &str) -> f64 {
    let outputs = Output::all(solver.mechanism());
    let output = outputs.iter().find(|output| output.name == name);
    solution.value(solver, output.expect("the output is there"))
}

/// One arm follows a function of the other: place, rates and efforts are those of the function. By
/// virtual power the driver's effort is b′ times the torque that moves the second arm. Numbers of the
/// order of ten take some tens of roundings.
#[test]
fn an_arm_follows_a_function_of_another() {
    let law = r#"tie = { type = "coupling", equation = "b = k*sin(2*a) + law(a)", law = "x^2/4" }"#;
    let (mut solver, mut path) = assembled(&arms(law));
    for a in [0.3, 1.2, -0.8, 4.0] {
        straight_to(&solver, &mut path, a);
        solver.track(&path).expect("nothing is in the way");
        let (first, second) = (1.4, -0.6);
        let solution = solved(&mut solver, [first, second]);
        let b = 0.7 * (2.0 * a).sin() + a * a / 4.0;
        let (b1, b2) = (1.4 * (2.0 * a).cos() + a / 2.0, 0.5 - 2.8 * (2.0 * a).sin());
        let (velocity, acceleration) = (b1 * first, b1 * second + b2 * first * first);
        let torque = (0.05 + 2.0 * 0.09) * acceleration + 2.0 * 9.81 * 0.3 * b.cos();
        for (name, expected, tolerance) in [
            ("b.position", b, 1e-14),
            ("b.velocity", velocity, 1e-13),
            ("b.acceleration", acceleration, 1e-12),
            ("a.effort", b1 * torque, 1e-12),
            ("tie.effort", torque, 1e-12),
            ("tie.b.effort", torque, 1e-12),
            ("tie.a.effort", -b1 * torque, 1e-12),
        ] {
            let found = value(&solver, &solution, name);
            assert!(
                (found - expected).abs() <= tolerance * expected.abs().max(10.0),
                "{name} at a = {a}: {found} {expected}"
            );
        }
    }
}

/// A table of a law, its turns included: b gains a quarter turn back per turn of a, at rest between.
#[test]
fn a_law_through_points_goes_on_over_turns() {
    let law = r#"tie = { type = "coupling", equation = "b = law(a)", law = { table = [[0, 0], ["90*deg", 0], ["180*deg", "-90*deg"], ["360*deg", "-90*deg"]], law = "polynomial_345", ends = "periodic" } }"#;
    let (mut solver, mut path) = assembled(&arms(law));
    for turns in 0..3 {
        for (part, risen) in [(0.1, 0.0), (0.375, 0.5), (0.6, 1.0), (0.99, 1.0)] {
            straight_to(&solver, &mut path, TAU * (f64::from(turns) + part));
            solver.track(&path).expect("nothing is in the way");
            let expected = -FRAC_PI_2 * (f64::from(turns) + risen);
            assert!((solver.pose().q[5] - expected).abs() < 1e-14, "{part}");
        }
    }
}

/// A Geneva wheel as an expression with `floor`, `mod` and corners: one step over three turns ends where
/// many do, and each rate is that of the closed form.
#[test]
fn a_geneva_wheel_indexes_and_dwells() {
    let law = r#"tie = { type = "coupling", equation = "b = -pi/2*floor((a + pi)/(2*pi)) - law(mod(a + pi, 2*pi) - pi)", law = "atan2(sin(max(-pi/4, min(pi/4, x)))*sqrt(0.5), 1 - cos(max(-pi/4, min(pi/4, x)))*sqrt(0.5))" }"#;
    let (mut solver, mut path) = assembled(&arms(law));
    let wheel = |a: f64| {
        let turns = ((a + PI) / TAU).floor();
        let x = (a - TAU * turns).clamp(-FRAC_PI_4, FRAC_PI_4);
        let r = 0.5_f64.sqrt();
        let rate = (r * x.cos() - r * r) / (1.0 + r * r - 2.0 * r * x.cos());
        let moves = x.abs() < FRAC_PI_4;
        let angle = -FRAC_PI_2 * turns - (r * x.sin()).atan2(1.0 - r * x.cos());
        (angle, if moves { -rate } else { 0.0 })
    };
    for k in 1..=60 {
        let a = 0.31 * f64::from(k);
        straight_to(&solver, &mut path, a);
        solver.track(&path).expect("nothing is in the way");
        let solution = solved(&mut solver, [1.0, 0.0]);
        let (angle, rate) = wheel(a);
        assert!(
            (value(&solver, &solution, "b.position") - angle).abs() < 1e-13,
            "{a}"
        );
        assert!(
            (value(&solver, &solution, "b.velocity") - rate).abs() < 1e-12,
            "{a}"
        );
    }
    straight_to(&solver, &mut path, -0.2);
    let progress = solver.track(&path).expect("it goes back in one step");
    assert!(progress.checked == 0, "each sub-step is proved");
    assert!((solver.pose().q[5] - wheel(-0.2).0).abs() < 1e-13);
}

/// A law that jumps stops the motion where it does; a corner is passed.
#[test]
fn a_motion_stops_where_a_law_jumps() {
    let law = r#"tie = { type = "coupling", equation = "b = floor(a - 0.75)/4" }"#;
    let (mut solver, mut path) = assembled(&arms(law));
    straight_to(&solver, &mut path, 2.0);
    let blocked = solver.track(&path).expect_err("it jumps at 0.75");
    assert!(
        matches!(blocked.reason, Reason::Lost | Reason::TooLong),
        "{blocked:?}"
    );
    assert!((solver.pose().drivers[0] - 0.75).abs() < 1e-6);

    let law = r#"tie = { type = "coupling", equation = "b = abs(a - 0.75)/4" }"#;
    let (mut solver, mut path) = assembled(&arms(law));
    straight_to(&solver, &mut path, 2.0);
    solver.track(&path).expect("a corner is no jump");
    assert!((solver.pose().q[5] - 1.25 / 4.0).abs() < 1e-15);
}

/// A ratio is solved, or refused by its name: in radians and sizes, here 1 m, up to a million.
#[test]
fn a_ratio_too_large_is_named() {
    for (equation, far) in [
        ("b = 1e9*a", "b"),
        ("a = 1e-9*b", "b"),
        ("b = 1e9*sin(a)", "b"),
        ("1e8*b = a", "a"),
        ("b = 3e7*a", "b"),
    ] {
        let law = format!("tie = {{ type = 'coupling', equation = '{equation}' }}");
        let solver = Solver::assembled(arms(&law), &Path::new(&arms(&law)));
        match solver {
            Err(Error::Ratio { far: named, .. }) => assert_eq!(named, far, "{equation}"),
            Err(other) => panic!("{equation}: {other}"),
            Ok(mut solver) => {
                // It follows the driver to rounding then.
                let mut path = Path::new(solver.mechanism());
                straight_to(&solver, &mut path, 1.0);
                solver.track(&path).expect(equation);
                let b = solver.pose().q[5];
                assert!(
                    (b - 1e-8).abs() <= 8.0 * f64::EPSILON * 1e-8,
                    "{equation}: {b}"
                );
            }
        }
    }
    // A coordinate in between divides it.
    let law = "tie = { type = 'coupling', equation = 'b = 1e5*a' }";
    let (mut solver, mut path) = assembled(&arms(law));
    straight_to(&solver, &mut path, 1.0);
    solver.track(&path).expect("it turns");
    assert!((solver.pose().q[5] - 1e5).abs() <= 8.0 * f64::EPSILON * 1e5);
}

/// Parts of an equation that jump in opposite ways at different times do not cancel, even where a step
/// passes both.
#[test]
fn jumps_of_two_coordinates_do_not_cancel() {
    let text = "format = 1\nname = 'floors'\nground.markers = { A = [0, 0], B = [1, 0], C = [2, 0] }\n\
        bodies.first.markers = { A = [0, 0] }\nbodies.second.markers = { B = [0, 0] }\n\
        bodies.third.markers = { C = [0, 0] }\n[joints]\n\
        A = { type = 'revolute', markers = ['ground.A', 'first.A'] }\n\
        B = { type = 'revolute', markers = ['ground.B', 'second.B'] }\n\
        C = { type = 'revolute', markers = ['ground.C', 'third.C'] }\n\
        tie = { type = 'coupling', equation = 'c = 0.1*(floor(a) - floor(b))' }\n[drivers]\n\
        a = { coordinate = 'angle', markers = ['ground.A', 'first.A'], start = 0.9 }\n\
        b = { coordinate = 'angle', markers = ['ground.B', 'second.B'], start = 1.1 }\n\
        [measures]\nc = { coordinate = 'angle', markers = ['ground.C', 'third.C'] }\n";
    let (mut solver, mut path) = assembled(&parse(text));
    for (driver_path, [from, to]) in path.driver_paths.iter_mut().zip([[0.9, 1.1], [1.1, 0.9]]) {
        *driver_path = DriverPath::Input {
            position: to,
            velocity: 0.0,
            acceleration: 0.0,
            jump: from - to,
        };
    }
    solver.track(&path).expect_err("both jump half-way");
}

/// A parameter that moves in a step moves the second arm; its derivative is that of the function.
#[test]
fn a_parameter_of_an_equation_moves() {
    for (law, slope) in [
        (
            r#"tie = { type = "coupling", equation = "b = k*a + 1 - k" }"#,
            1.0,
        ),
        (
            r#"tie = { type = "coupling", equation = "b = sin(k*a)" }"#,
            2.0 * (0.9_f64 * 2.0).cos(),
        ),
        (
            r#"tie = { type = "coupling", equation = "b = law(a)", law = { table = [[0, 0], [2, "k"], [4, 1]] } }"#,
            1.0,
        ),
    ] {
        let (mut solver, mut path) = assembled(&arms(law));
        straight_to(&solver, &mut path, 2.0);
        path.to[0] = 0.9;
        solver.track(&path).expect("nothing is in the way");
        let expected = match slope {
            1.0 if law.contains("law(a)") => 0.9,
            1.0 => 1.9,
            _ => (0.9_f64 * 2.0).sin(),
        };
        assert!((solver.pose().q[5] - expected).abs() < 1e-14, "{law}");
        let solution = solved(&mut solver, [0.0, 0.0]);
        let mechanism = Arc::clone(solver.mechanism());
        let direction = Direction::by_parameter(&mechanism, ParameterId(0));
        let along = solver.sensitivity(&solution.rates, &solution.driver_rates, &direction);
        let along = along.expect("it has derivatives");
        assert!(
            (along.signal(Signal::Measure(0)).value - slope).abs() < 1e-13,
            "{law}"
        );
    }
}

/// A second coupling that says the same is redundant; one that says something else is told.
#[test]
fn couplings_may_depend_on_each_other() {
    let same = r#"one = { type = "coupling", equation = "b = 2*a" }
other = { type = "coupling", equation = "6*a = 3*b" }"#;
    let (mut solver, mut path) = assembled(&arms(same));
    straight_to(&solver, &mut path, 3.0);
    solver.track(&path).expect("both agree");
    assert!((solver.pose().q[5] - 6.0).abs() < 1e-14);

    let other = same.replace("6*a", "0.1 + 6*a");
    let error = Solver::assembled(arms(&other), &Path::new(&arms(&other)));
    assert!(
        matches!(error, Err(Error::Contradiction { .. })),
        "{error:?}"
    );
}

/// Wheels mesh as they are drawn, at a phase, or as their markers lie.
#[test]
fn wheels_mesh_as_they_are_drawn() {
    for (phase, expected) in [
        ("", 0.0),
        (", phase = '10*deg'", 10.0_f64.to_radians()),
        (", phase = 'drawn'", 0.3),
    ] {
        let gear = format!(
            "mesh = {{ type = 'gear', markers = ['first.A', 'second.B'], radii = [0.4, 0.6]{phase} }}"
        );
        let text = arms_text_with_estimate(&gear);
        let (mut solver, mut path) = assembled(&parse(&text));
        straight_to(&solver, &mut path, 1.5);
        solver.track(&path).expect("nothing is in the way");
        let found = solver.pose().q[5];
        assert!((found - (expected - 1.0)).abs() < 1e-14, "{phase}: {found}");
    }
}

/// Returns the two arms with the second one drawn at 0.3 rad.
fn arms_text_with_estimate(joint: &str) -> String {
    format!(
        "format = 1\nname = 'wheels'\nground.markers = {{ A = [0, 0], B = [1, 0] }}\n\
         bodies.first.markers = {{ A = [0, 0] }}\n\
         bodies.second = {{ markers = {{ B = [0, 0] }}, estimate = [1, 0, 0.3] }}\n\
         [joints]\nA = {{ type = 'revolute', markers = ['ground.A', 'first.A'] }}\n\
         B = {{ type = 'revolute', markers = ['ground.B', 'second.B'] }}\n{joint}\n\
         [drivers]\na = {{ coordinate = 'angle', markers = ['ground.A', 'first.A'], start = 0 }}\n"
    )
}

/// The error says so where wheels as drawn would let all else close.
#[test]
fn a_phase_that_contradicts_is_told_with_its_remedy() {
    let text = arms_text_with_estimate(
        "twin = { type = 'coupling', equation = 'b + a = 0.3' }\n\
         mesh = { type = 'gear', markers = ['first.A', 'second.B'], radii = [1, 1] }",
    ) + "[measures]\nb = { coordinate = 'angle', markers = ['ground.B', 'second.B'] }\n";
    let mechanism = parse(&text);
    let error = Solver::assembled(Arc::clone(&mechanism), &Path::new(&mechanism));
    let Err(Error::Contradiction { fit, .. }) = error else {
        panic!("they contradict each other: {error:?}");
    };
    assert!(matches!(fit.as_deref(), Some(Fit::Phase { .. })), "{fit:?}");
}

/// A measure may use forces; its value and its derivative follow theirs.
#[test]
fn a_measure_follows_the_forces_that_it_uses() {
    let mechanism = shipped("toggle_press");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, 5.0);
    solver.track(&path).expect("it turns fully");
    let mut solution = solved(&mut solver, [1.0, 0.0]);
    let outputs = Output::all(&mechanism);
    let own = outputs.iter().find(|output| output.name == "pin_force");
    let own = own.expect("the press has the measure").clone();
    assert!(matches!(own.source, OutputSource::Derived(_)) && own.uses_reactions());
    let [x, y] = ["A.fx", "A.fy"].map(|name| value(&solver, &solution, name));
    assert!((solution.value(&solver, &own) - x.hypot(y)).abs() < f64::EPSILON * x.hypot(y));

    let length = mechanism.parameter_id("crank_length").expect("it is there");
    let direction = Direction::by_parameter(&mechanism, length);
    let parts = ["A.fx", "A.fy"].map(|name| {
        let output = outputs.iter().find(|output| output.name == name);
        output.expect("it is there").clone()
    });
    let all = [own, parts[0].clone(), parts[1].clone()];
    let changes = solution.changes(&mut solver, &all, &direction);
    let [own, by_x, by_y] = changes.expect("they have derivatives")[..] else {
        panic!("three outputs");
    };
    let expected = (x * by_x + y * by_y) / x.hypot(y);
    assert!(
        (own - expected).abs() <= 1e-13 * expected.abs(),
        "{own} {expected}"
    );
}
