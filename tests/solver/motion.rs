//! Prescribed motions as tables: exact rates, ends, parameters, files.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::common::mechanisms::crank;
use crate::common::{assembled, parse, shipped};
use biela::kinematics::{Path, Rates, Reason, Solver};
use biela::mechanism::{DriverId, Jet, ParameterId};

const LAWS: [&str; 8] = [
    "spline",
    "polynomial_345",
    "polynomial_4567",
    "cycloidal",
    "harmonic",
    "modified_sine",
    "modified_trapezoidal",
    "trapezoidal",
];

/// A crank whose angle follows the motion.
fn turning(motion: &str) -> Solver {
    assembled(&parse(&crank(&format!("motion = {motion}")))).0
}

fn at(solver: &Solver, time: f64) -> Jet {
    solver.motion(DriverId(0), time)
}

#[test]
fn rates_are_the_derivatives_of_the_value() {
    // Central differences of fourth order: with h = 1e-3 both errors, h⁴/30 times a fifth
    // derivative of up to some 1e5 and the rounding eps/h, stay below 1e-8.
    const H: f64 = 1e-3;
    let difference =
        |f: &dyn Fn(f64) -> f64| (8.0 * (f(H) - f(-H)) - (f(2.0 * H) - f(-2.0 * H))) / (12.0 * H);
    let points = "[[0, 0.5], ['1/2', 2], [1.5, 2], [2.25, -1]]";
    for law in LAWS {
        for ends in ["clamped", "natural", "periodic"] {
            if ends == "natural" && law != "spline" {
                continue;
            }
            let solver = turning(&format!(
                "{{ table = {points}, law = '{law}', ends = '{ends}' }}"
            ));
            // Away from where pieces meet, whose higher derivatives jump.
            for time in [
                -0.8, 0.1, 0.22, 0.3, 0.45, 0.9, 1.6, 1.8, 1.95, 2.2, 2.6, 5.03,
            ] {
                let jet = at(&solver, time);
                let first = difference(&|h| at(&solver, time + h).value);
                let second = difference(&|h| at(&solver, time + h).first());
                assert!((jet.first() - first).abs() < 1e-7, "{law} {ends} {time}");
                assert!((jet.second() - second).abs() < 1e-6, "{law} {ends} {time}");
            }
        }
    }
}

#[test]
fn ends_are_as_asked_for() {
    let rest = |value| Jet::constant(value);
    for law in LAWS {
        let solver = turning(&format!(
            "{{ table = [[1, 2], [2, 5], [3, 4]], law = '{law}' }}"
        ));
        assert_eq!(at(&solver, 0.0), rest(2.0), "{law}");
        assert_eq!(at(&solver, 7.0), rest(4.0), "{law}");
        for (time, value) in [(1.0, 2.0), (2.0, 5.0), (3.0, 4.0)] {
            assert!((at(&solver, time).value - value).abs() < 1e-15, "{law}");
        }
    }
    // A spline without bending is a straight line, and goes on as one.
    let natural = turning("{ table = [[1, 2], [2, 4], [3, 6]], ends = 'natural' }");
    for time in [-10.0, 1.5, 20.0] {
        let jet = at(&natural, time);
        assert!((jet.value - 2.0 * time).abs() < 1e-14);
        assert!((jet.first() - 2.0).abs() < 1e-15 && jet.second() == 0.0);
    }
}

/// An indexing table: a quarter turn in the first half of each second, at rest in the other.
#[test]
fn periodic_motions_keep_their_phase_over_a_thousand_turns() {
    let mut solver = turning(
        "{ table = [[0, 0], [0.5, '90*deg'], [1, '90*deg']], law = 'cycloidal', ends = 'periodic' }",
    );
    let mut path = Path::new(solver.mechanism());
    for step in 0..16_000 {
        path.start = 0.25 * f64::from(step);
        path.duration = 0.25;
        solver.track(&path).expect("a wheel turns on for ever");
        let quarters = f64::from(step / 4) + [0.5, 1.0, 1.0, 1.0][step as usize % 4];
        let exact = quarters * FRAC_PI_2;
        let ulp = exact.next_up() - exact;
        assert!((solver.pose().q[2] - exact).abs() <= 4.0 * ulp, "{step}");
    }
    assert!((solver.pose().q[2] - 1000.0 * TAU).abs() <= 4.0 * 2_f64.powi(-40));
}

/// Two slides: while the lift changes, the gripper goes straight to where the new table has it,
/// with no velocity from the change.
#[test]
fn a_table_follows_its_parameters() {
    let mechanism = shipped("pick_and_place");
    let (mut solver, mut path) = assembled(&mechanism);
    let lift = mechanism.parameter_id("lift").expect("it has one");
    let reach = mechanism.driver_id("reach").expect("it has one");
    path.duration = 0.3;
    path.to[lift.index()] = 0.2;
    solver.track(&path).expect("slides move freely");
    // At 0.15 of the cycle: polynomial 3-4-5 from 2 to 1 lifts, two thirds of the way.
    let tau: f64 = 2.0 / 3.0;
    let stroke = tau.powi(3) * (10.0 - 15.0 * tau + 6.0 * tau * tau);
    let value = 0.2 * (2.0 - stroke);
    let rate = -0.2 * 30.0 * (tau * (1.0 - tau)).powi(2) / (0.15 * 2.0);
    let gripper = mechanism.body_id("gripper").expect("it has one");
    assert!((solver.pose().q[3 * gripper.index() + 1] - (0.3 - value)).abs() < 1e-15);
    let motion = solver.motion(reach, 0.3);
    assert!((motion.value - value).abs() < 1e-15);
    assert!((motion.first() - rate).abs() < 1e-14);
}

#[test]
fn times_that_parameters_disorder_are_refused_and_lose_nothing() {
    let mechanism = parse(
        "format = 1\nname = 'slide'\n[parameters]\nrise = { value = 0.4, tunable = true }\n\
         [ground.markers]\nO = [0, 0]\n[bodies.slide]\nmarkers = { O = [0, 0] }\n[joints]\n\
         O = { type = 'translational', markers = ['ground.O', 'slide.O'] }\n[drivers]\n\
         x = { coordinate = 'x', markers = ['ground.O', 'slide.O'], \
         motion = { table = [[0, 0], ['rise', 1], [1, 0]], law = 'harmonic' } }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    path.duration = 0.2;
    solver.track(&path).expect("the file's values are right");
    let before = solver.pose().clone();
    path.start = 0.2;
    path.to[ParameterId(0).index()] = 1.2;
    let blocked = solver.track(&path).expect_err("the times do not rise");
    let Reason::Value(error) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(
        error.to_string(),
        "driver `x` has no finite value: the times of its table must rise"
    );
    // It stands where the second and third time meet, and can go back.
    assert!((solver.pose().parameters[0] - 1.0).abs() < 1e-9);
    solver.restore(&before);
    path.to[0] = 0.4;
    path.duration = 0.2;
    solver.track(&path).expect("as before");
    assert!((solver.pose().q[0] - 1.0).abs() < 1e-15);
}

/// √(1 − t) ends with an endless slope, and has no value beyond. The mechanism is not to blame.
#[test]
fn a_motion_without_rates_is_named() {
    let mut solver = turning("'sqrt(1 - t)'");
    let mut path = Path::new(solver.mechanism());
    path.duration = 1.0;
    solver.track(&path).expect("a wheel turns freely");
    let mut rates = Rates::new(3);
    let motion = at(&solver, 1.0);
    let error = solver
        .solve_rates(|_| motion, &mut rates)
        .expect_err("the slope is endless");
    let expected = "driver `turn` has no finite velocity or acceleration";
    assert_eq!(error.to_string(), expected);
    path.start = 1.0;
    let blocked = solver.track(&path).expect_err("there is no value");
    let Reason::Value(error) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(error.to_string(), "driver `turn` has no finite value");
}

#[test]
fn a_file_beside_gives_the_same_motion() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let text = |motion: &str| crank(&format!("motion = {motion}"));
    std::fs::write(
        folder.path().join("turn.csv"),
        "ms;deg;note\n0;0;start\n500;60;\n2000;-30;end\n",
    )
    .expect("it can be written");
    let path = folder.path().join("wheel.toml");
    std::fs::write(&path, text("{ file = 'turn.csv', scale = [0.001, 'deg'] }"))
        .expect("it can be written");
    let source = biela::mechanism::Source::open("wheel.toml", &path).expect("it was written");
    let (mechanism, _) = biela::mechanism::Mechanism::parse(&source).expect("it is right");
    assert_eq!(mechanism.table_files.len(), 1);
    let from_file = assembled(&mechanism.into()).0;
    let inline = assembled(&parse(&text(
        "{ table = [[0, 0], [0.5, '60*deg'], [2, '-30*deg']] }",
    )))
    .0;
    for step in 0..50 {
        let time = 0.05 * f64::from(step);
        let (a, b) = (at(&from_file, time), at(&inline, time));
        assert!((a.value - b.value).abs() < 1e-15 && (a.second() - b.second()).abs() < 1e-12);
    }
}

/// A slider–crank that a table drives past its dead point and back within each period: one step
/// a period, at rest at both ends, finds it all the same.
#[test]
fn what_a_table_does_within_a_step_is_not_overlooked() {
    let text = |peak: &str| {
        format!(
            "format = 1\nname = 'pulse'\n[ground.markers]\nO = [0, 0]\n[bodies.crank]\n\
             markers = {{ O = [0, 0], A = [1, 0] }}\nestimate = [0, 0, 1]\n[bodies.rod]\n\
             markers = {{ A = [0, 0], B = [2, 0] }}\nestimate = [0.5, 0.8, -0.5]\n\
             [bodies.slider]\nmarkers = {{ B = [0, 0] }}\nestimate = [2.3, 0, 0]\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n\
             A = {{ type = 'revolute', markers = ['crank.A', 'rod.A'] }}\n\
             B = {{ type = 'revolute', markers = ['rod.B', 'slider.B'] }}\n\
             way = {{ type = 'translational', markers = ['ground.O', 'slider.B'] }}\n[drivers]\n\
             x = {{ coordinate = 'x', markers = ['ground.O', 'slider.B'], motion = {{ \
             table = [[0, 2.5], [0.56, 2.5], [0.68, {peak}], [0.80, 2.5], [1, 2.5]], \
             law = 'cycloidal', ends = 'periodic' }} }}\n"
        )
    };
    for step in [1.0, 0.1] {
        let (mut solver, mut path) = assembled(&parse(&text("2.9")));
        path.duration = step;
        for k in 0..20 {
            path.start = f64::from(k) * step;
            solver.track(&path).expect("within the reach of 3");
        }
        let (mut solver, mut path) = assembled(&parse(&text("3.1")));
        path.duration = step;
        let mut ended = None;
        for k in 0..10 {
            path.start = f64::from(k) * step;
            if let Err(blocked) = solver.track(&path) {
                ended = Some(path.start + blocked.s * step);
                break;
            }
        }
        // The slider reaches 3 after 5/6 of the stroke from 2.5 to 3.1: τ − sin(2πτ)/2π = 5/6
        // at τ = 0.6866, in 0.12 s. Near the dead point it stops a little before.
        let ended = ended.expect("3.1 is out of reach");
        assert!((ended - (0.56 + 0.12 * 0.6866)).abs() < 1e-4, "{ended}");
    }
}

/// Two wheels, one of which has a motion with a jump.
#[test]
fn the_motion_that_jumps_is_named() {
    let wheel = |name: &str| {
        format!("pin_{name} = {{ type = 'revolute', markers = ['ground.O', '{name}.O'] }}\n")
    };
    let driver = |name: &str, motion: &str| {
        format!(
            "turn_{name} = {{ coordinate = 'angle', markers = ['ground.O', '{name}.O'], \
             motion = '{motion}' }}\n"
        )
    };
    let mechanism = parse(&format!(
        "format = 1\nname = 'wheels'\n[ground.markers]\nO = [0, 0]\n\
         [bodies.a]\nmarkers = {{ O = [0, 0] }}\n[bodies.b]\nmarkers = {{ O = [0, 0] }}\n\
         [joints]\n{}{}[drivers]\n{}{}",
        wheel("a"),
        wheel("b"),
        driver("a", "sin(t)"),
        driver("b", "floor(t + 0.7)"),
    ));
    let (mut solver, mut path) = assembled(&mechanism);
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("it jumps at 0.3 s");
    assert_eq!(blocked.reason, Reason::Jump(DriverId(1)));
    assert!((blocked.s - 0.3).abs() < 1e-9, "{blocked:?}");
}
