//! The same motion under other names, in another order, elsewhere, with another freedom, backwards.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use biela::mechanism::{Expression, Mechanism};

use super::lagrange::{FOUR_BAR, GRAVITY, four_bar_kinematics, rod, torque_input, zero};
use super::minimal::{Mass, Minimal, body, from, unloaded};
use super::pendulum::swinging;
use super::refused::four_bar_with;
use super::run::{Fed, MARKS, Run, assert_follows, assert_lagrange, error, times};
use super::taylor::Taylor;
use crate::common::{folder, moved, parse, shipped};

fn text(name: &str) -> String {
    let path = folder("mechanisms").join(format!("{name}.toml"));
    std::fs::read_to_string(path).expect("it is shipped")
}

/// The crank's angle, the coupler's, the rocker's and the transmission angle as freedoms: the same
/// motion between the dead points of all four.
#[test]
fn any_coordinate_as_freedom_gives_the_same_motion() {
    let start = 60.0_f64.to_radians();
    let crank = Taylor::new(start, 12.0, 0.0);
    let (_, coupler, rocker) = four_bar_kinematics(crank);
    let times = times(0.06, 12);
    let exact = FOUR_BAR.motion(&[start, 12.0], &times);
    for (markers, coordinate) in [
        ("[\"ground.O2\", \"crank.O\"]", crank),
        ("[\"ground.O2\", \"coupler.A\"]", coupler),
        ("[\"ground.O4\", \"rocker.O\"]", rocker),
        ("[\"coupler.B\", \"rocker.B\"]", rocker - coupler),
        ("[\"crank.A\", \"rocker.O\"]", rocker - crank),
    ] {
        let mechanism = parse(&four_bar_with(markers, coordinate.value, coordinate.first));
        for (tolerance, mark) in MARKS {
            let mut run = Run::new(&mechanism, tolerance, torque_input());
            let mut largest = 0.0_f64;
            for (time, exact) in times.iter().zip(&exact) {
                run.to(*time);
                let found = [run.solver.pose().q[2]];
                largest = largest.max(error(&found, &exact[..1]));
            }
            println!("| freedom {markers} {tolerance:e} | {largest:.1e} / {mark:e} |");
            assert!(largest < mark, "{markers}: {largest}");
        }
    }
}

/// Values and velocities after some time, for a mechanism that is moved as its gravity is.
fn end(mechanism: &Arc<Mechanism>, fed: Fed, until: f64) -> Vec<f64> {
    let mut run = Run::new(mechanism, 1e-10, fed);
    for time in times(until, 5) {
        run.to(time);
    }
    run.state()
}

/// Turned and moved, with gravity turned too: the same values of the freedoms to the mark.
#[test]
fn the_motion_is_the_same_elsewhere() {
    for (name, fed, until) in [
        ("double_pendulum", Fed::default(), 2.0),
        ("five_bar_free", Fed::default(), 2.0),
        ("four_bar_free", torque_input(), 2.0),
        ("cart_pole", torque_input(), 3.0),
        ("swinging_tip", Fed::default(), 3.0),
    ] {
        let mechanism = shipped(name);
        let expected = end(&mechanism, fed, until);
        for (turn, to) in [(0.7, [0.0, 0.0]), (-2.5, [3.0, -40.0]), (1.9, [1e3, 1e3])] {
            let mut elsewhere = moved(&mechanism, turn, to);
            let (sin, cos) = f64::sin_cos(turn);
            let gravity = [9.81 * sin, -9.81 * cos].map(Expression::constant);
            Arc::get_mut(&mut elsewhere)
                .expect("nobody else has it")
                .simulation
                .gravity = gravity;
            let found = end(&elsewhere, fed, until);
            let off = error(&found, &expected);
            println!("| {name} turned {turn}, moved {to:?} | {off:.1e} / 1e-8 |");
            assert!(off < 1e-8, "{name}: {off}");
        }
    }
}

/// Bodies in reverse order and under other names.
#[test]
fn order_and_names_do_not_matter() {
    for (name, fed, until, names) in [
        ("double_pendulum", Fed::default(), 2.0, ["upper", "lower"]),
        ("four_bar_free", torque_input(), 2.0, ["crank", "rocker"]),
    ] {
        let text = text(name);
        let expected = end(&parse(&text), fed, until);
        let begin = text.find("\n[bodies.").expect("bodies");
        let joints = text.find("\n[joints]").expect("joints");
        let mut bodies: Vec<_> = text[begin..joints].split("\n[bodies.").skip(1).collect();
        bodies.reverse();
        let bodies: String = bodies.iter().flat_map(|b| ["\n[bodies.", b]).collect();
        let reversed = format!("{}{bodies}{}", &text[..begin], &text[joints..]);
        let [one, other] = names;
        let renamed = text
            .replace(one, "zz")
            .replace(other, one)
            .replace("zz", other);
        for changed in [reversed, renamed] {
            let off = error(&end(&parse(&changed), fed, until), &expected);
            println!("| {name} in another order | {off:.1e} / 1e-8 |");
            assert!(off < 1e-8, "{name}: {off}");
        }
    }
}

/// Forwards, all velocities negated, and as long again: back at the start.
#[test]
fn a_motion_without_losses_returns() {
    for (name, until) in [
        ("pendulum_free", 3.0),
        ("double_pendulum", 1.5),
        ("andrews_free", 0.02),
    ] {
        let mut run = Run::new(&shipped(name), 1e-10, Fed::default());
        let start = run.state();
        run.to(until);
        let velocities: Vec<f64> = run.free.velocities().collect();
        let freedoms = run.free.freedoms().to_vec();
        let Run {
            solver, free, fed, ..
        } = &mut run;
        let back = |freedom| {
            let place = freedoms.iter().position(|f| *f == freedom);
            -velocities[place.expect("a freedom")]
        };
        free.restart(solver, fed, back).expect("it starts");
        run.to(2.0 * until);
        let off = error(&run.state(), &start);
        println!("| {name} and back | {off:.1e} / 2e-8 |");
        // The mark for each of the two ways.
        assert!(off < 2e-8, "{name}: {off}");
    }
}

/// Three parallel cranks of 0.2 m under one beam, of which one is redundant, and more lines.
fn three_cranks(arm: &str, joint: &str, rest: &str) -> String {
    let crank = "markers = { O = [0, 0], A = [0.2, 0] }\nmass = 0.5\ninertia = 0.002\n\
                 center = [0.1, 0]";
    let (x, y) = (0.2 * f64::cos(-0.6), 0.2 * f64::sin(-0.6));
    let bodies: String = (0..3)
        .map(|k| {
            format!(
                "[bodies.crank{k}]\nestimate = [{}, 0, -0.6]\n{crank}\n",
                0.5 * f64::from(k)
            )
        })
        .collect();
    let joints: String = (0..3)
        .map(|k| {
            format!(
                "O{k} = {{ type = \"revolute\", markers = [\"ground.O{k}\", \"crank{k}.O\"] }}\n\
                 A{k} = {{ type = \"revolute\", markers = [\"crank{k}.A\", \"beam.A{k}\"] }}\n"
            )
        })
        .collect();
    format!(
        "format = 1\nname = \"cranks\"\n[ground.markers]\nO0 = [0, 0]\nO1 = [0.5, 0]\nO2 = [1, 0]\n\
         down = [0, 0, \"-90*deg\"]\n{bodies}\
         [bodies.beam]\nmarkers = {{ A0 = [0, 0], A1 = [0.5, 0], A2 = [1, 0], \
         P = [0.3, 0, \"-90*deg\"] }}\n\
         estimate = [{x}, {y}, 0]\nmass = 2\ninertia = 0.2\ncenter = [0.5, 0]\n\
         {arm}[joints]\n{joints}{joint}{rest}"
    )
}

/// A parallelogram with a redundant crank swings like one pendulum: ω² = Σ m a g/Σ J with
/// 3 cranks of 0.5 kg at 0.1 m, and the beam's 2 kg at 0.2 m.
#[test]
fn a_mechanism_with_redundant_joints_swings() {
    let rest = "[freedoms]\nswing = { coordinate = \"angle\", markers = [\"ground.down\", \
                \"crank0.O\"], start = 0.97 }\n";
    let inertia: f64 = 3.0 * (0.002 + 0.005) + 2.0 * 0.04;
    let moment = 3.0 * 0.05 + 2.0 * 0.2;
    let omega = (9.81 * moment / inertia).sqrt();
    let times = times(5.0, 20);
    assert_follows(
        "redundant crank",
        &parse(&three_cranks("", "", rest)),
        Fed::default(),
        &times,
        |index| swinging(omega, 0.97, times[index]),
        9.81 * moment * (1.0 - f64::cos(0.97)),
    );
}

fn driven_beam(z: &[Taylor], t: Taylor) -> Vec<Mass> {
    let crank = 0.3 * (5.0 * t).sin() - 0.6;
    let [x, y] = from(zero(), 0.2, crank);
    vec![body(
        0.3,
        rod(0.3, 0.4),
        [x + 0.3, y, z[0] - FRAC_PI_2],
        [0.2, 0.0],
    )]
}

/// A rod hangs from the beam of a driven parallelogram with a redundant crank.
#[test]
fn a_rod_swings_under_a_driven_mechanism_with_redundant_joints() {
    let arm = "[bodies.arm]\nmarkers = { P = [0, 0] }\nestimate = [0.46, -0.11, -1.17]\nmass = 0.3\n\
               inertia = 0.004\ncenter = [0.2, 0]\n";
    let joint = "P = { type = \"revolute\", markers = [\"beam.P\", \"arm.P\"] }\n";
    let rest = "[drivers]\ncrank = { coordinate = \"angle\", markers = [\"ground.O0\", \
                \"crank0.O\"], motion = \"-0.6 + 0.3*sin(5*t)\" }\n\
                [freedoms]\nswing = { coordinate = \"angle\", markers = [\"beam.P\", \"arm.P\"], \
                start = 0.4 }\n";
    let truth = Minimal {
        gravity: GRAVITY,
        masses: driven_beam,
        loads: unloaded,
    };
    let mechanism = parse(&three_cranks(arm, joint, rest));
    assert_lagrange(
        "rod under redundant cranks",
        &mechanism,
        Fed::default(),
        &truth,
        &times(4.0, 20),
    );
}

fn massless_coupler(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let (_, _, rocker) = four_bar_kinematics(z[0]);
    let o = Taylor::from(0.0);
    vec![body(0.8, 0.006, [o + 0.4, o, rocker], [0.15, 0.0])]
}

/// The crank and the coupler are massless: the rocker alone has a mass, and swings within the
/// range of the crank on which it moves.
#[test]
fn massless_bodies_pass_the_motion_on() {
    let massless: Vec<_> = text("four_bar_free")
        .lines()
        .filter(|line| {
            let line = line.trim();
            ![
                "mass = 2",
                "mass = 0.5",
                "inertia = 0.008",
                "inertia = 0.003",
                "center = [0.12",
            ]
            .iter()
            .any(|start| line.starts_with(start))
                && !line.starts_with("motor =")
                && !line.starts_with("pivot =")
        })
        .map(|line| {
            if line.contains("velocity = 12") {
                line.replace("velocity = 12", "velocity = 3")
            } else {
                line.to_owned()
            }
        })
        .collect();
    let truth = Minimal {
        gravity: GRAVITY,
        masses: massless_coupler,
        loads: unloaded,
    };
    // At the extreme positions of the rocker the crank has no inertia; the motion ends before.
    let mechanism = parse(&massless.join("\n"));
    assert_lagrange(
        "massless coupler",
        &mechanism,
        Fed::default(),
        &truth,
        &times(0.1, 5),
    );
}
