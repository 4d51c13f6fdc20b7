//! The way from the file's own pose to the values at the start: the assembly mode is the file's,
//! whole turns of drivers count, and what lies in the way is told.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::common::exact::{EXACT, Exact};
use crate::common::{Instance, assembled, instance_of, parse, shipped, stems};
use biela::fmi::{Interface, State, value_reference};
use biela::kinematics::{DriverPath, Error, Path, Pose, Progress, Rates, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism};

/// Turns whose pose is compared.
const TURNS: [i32; 4] = [3, 1_000, 10_000, -10_000];
/// Steps per turn of motions that are followed step by step.
const STEPS: u32 = 48;
/// Error of a pose that is followed, in metres and radians: some eps times the condition of the
/// mechanisms here.
const FOLLOWED: f64 = 1e-11;

/// Starts with drivers and parameters at these values.
fn start(
    solver: &mut Solver,
    drivers: &[(usize, f64)],
    parameters: &[(&str, f64)],
) -> Result<Progress, Error> {
    let home = solver.pose().clone();
    let mechanism = Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    home.set_path(&mut path);
    for (driver, value) in drivers {
        path.driver_paths[*driver] = DriverPath::held(*value, home.drivers[*driver]);
    }
    for (name, value) in parameters {
        let id = mechanism.parameters.iter().position(|p| p.name == *name);
        path.to[id.expect("a parameter")] = *value;
    }
    mechanism.derive_parameters(&mut path.to);
    solver.start(&home, &path)
}

/// Moves some drivers to their values in steps. Returns whether the motion goes on to the end.
fn follow(solver: &mut Solver, drivers: &[usize], by: f64, steps: u32) -> bool {
    let from = solver.pose().drivers.clone();
    let mut path = Path::new(solver.mechanism());
    (1..=steps).all(|step| {
        solver.pose().set_path(&mut path);
        for &driver in drivers {
            let to = from[driver] + by * f64::from(step) / f64::from(steps);
            path.driver_paths[driver] = DriverPath::held(to, solver.pose().drivers[driver]);
        }
        solver.track(&path).is_ok()
    })
}

/// Largest |dq/du| at the pose, for drivers that move together.
fn steepness(solver: &mut Solver, drivers: &[usize]) -> f64 {
    let mut rates = Rates::new(solver.pose().q.len());
    let rate = |id: DriverId| f64::from(u8::from(drivers.contains(&id.index())));
    solver
        .solve_rates(|id| Jet::new(0.0, [rate(id), 0.0]), &mut rates)
        .expect("the pose is regular");
    rates
        .velocity()
        .iter()
        .fold(1.0, |most, v| v.abs().max(most))
}

/// Returns the error that the rounding of a driver's value and of the bodies' angles leaves.
fn rounding(solver: &mut Solver, drivers: &[usize]) -> f64 {
    let pose = solver.pose();
    let angles = pose.q.iter().chain(&pose.drivers);
    let largest = angles.fold(0.0_f64, |most, angle| angle.abs().max(most));
    FOLLOWED + 4.0 * f64::EPSILON * largest * steepness(solver, drivers)
}

fn assert_same(solver: &mut Solver, drivers: &[usize], truth: &[f64], what: &str) {
    let same = rounding(solver, drivers);
    for (column, (q, truth)) in solver.pose().q.iter().zip(truth).enumerate() {
        let off = (q - truth).abs();
        assert!(
            off <= same,
            "{what}: q[{column}] is {q}, not {truth}: {off:e} > {same:e}"
        );
    }
}

/// The poses after whole turns of some drivers, from a pose beyond home.
struct Turning {
    /// The fewest turns after which the motion repeats itself.
    period: usize,
    /// The poses after 0, 1, … turns, up to one less than two periods.
    poses: Vec<Pose>,
}

impl Turning {
    /// Follows turns until the motion repeats itself; `None` where it ends.
    fn of(solver: &mut Solver, drivers: &[usize], sign: f64) -> Option<Self> {
        let mut poses = vec![solver.pose().clone()];
        for period in 1.. {
            assert!(period < 60, "the motion does not repeat itself");
            while poses.len() <= 2 * period {
                if !follow(solver, drivers, sign * TAU, STEPS) {
                    return None;
                }
                poses.push(solver.pose().clone());
            }
            let way = |k: usize| {
                let ends = poses[k + period].q.iter().zip(&poses[k].q);
                ends.map(|(to, from)| to - from).collect::<Vec<_>>()
            };
            let (first, second) = (way(0), way(period));
            let mut ways = first.iter().zip(&second);
            if ways.all(|(first, second)| (first - second).abs() < 1e-9) {
                return Some(Self { period, poses });
            }
        }
        None
    }

    /// Returns q after a number of turns.
    fn after(&self, turns: usize) -> Vec<f64> {
        let first = turns % self.period;
        let (times, from, to) = (
            (turns / self.period) as f64,
            &self.poses[first].q,
            &self.poses[first + self.period].q,
        );
        let way = |from: f64, to: f64| {
            let turns = ((to - from) / TAU).round();
            // Whole turns are exact; an unknown that comes back stays.
            if (to - from - TAU * turns).abs() < 1e-9 {
                TAU * turns
            } else {
                to - from
            }
        };
        let ends = from.iter().zip(to);
        ends.map(|(from, to)| from + times * way(*from, *to))
            .collect()
    }
}

/// Compares starts of a mechanism at many turns of some drivers with turns that are followed.
/// Returns whether these drivers turn.
fn compare_turns(mechanism: &Arc<Mechanism>, drivers: &[usize], part: f64) -> bool {
    let (mut solver, _) = assembled(mechanism);
    let home = solver.pose().clone();
    let mut turned = false;
    for turns in TURNS {
        let sign = f64::from(turns.signum());
        let what = format!("{}, {drivers:?}, {turns} turns", mechanism.name);
        let goal: Vec<_> = drivers
            .iter()
            .map(|d| {
                (
                    *d,
                    home.drivers[*d] + (f64::from(turns) + sign * part) * TAU,
                )
            })
            .collect();
        solver.restore(&home);
        let turning = follow(&mut solver, drivers, sign * part * TAU, STEPS)
            .then(|| Turning::of(&mut solver, drivers, sign))
            .flatten();
        solver.restore(&home);
        let started = start(&mut solver, &goal, &[]);
        let Some(turning) = turning else {
            // Within the swing of a crank the mechanism closes, beyond it or a stop it may not.
            let error = started.expect_err(&what);
            let refused = matches!(
                error,
                Error::NoWay { .. } | Error::NotAssembled { .. } | Error::BeyondStop { .. }
            );
            assert!(refused, "{what}: {error}");
            continue;
        };
        let progress = started.unwrap_or_else(|error| panic!("{what}: {error}"));
        turned = true;
        let truth = turning.after(turns.unsigned_abs() as usize);
        assert_same(&mut solver, drivers, &truth, &what);
        // Two periods and the parts before and behind, not thousands of turns.
        let most = 600 * (turning.period as u32 + 2);
        assert!(progress.substeps < most, "{what}: {progress:?}");
    }
    turned
}

/// Drivers of the shipped mechanisms that are angles and turn fully.
const TURNING: &str = "andrews.beta andrews_free.beta bonnet_hinge.opening cam_flat.cam_angle \
    cam_flat_arm.cam_angle cam_knife.cam_angle cam_knife_arm.cam_angle cam_points.cam_angle \
    cam_roller.cam_angle cam_roller_arm.cam_angle cart_pole.lean chebyshev.coupler_angle corexy.motor_a corexy.motor_b \
    double_pendulum.shoulder double_pendulum.elbow double_rocker.worm_angle drag_link.crank_angle \
    elliptic_trammel.bar_angle engine.crank_angle engine_free.crank_angle \
    five_bar_free.left_angle five_bar_free.right_angle five_bar_robot.left_angle \
    five_bar_robot.right_angle four_bar.crank_angle four_bar_chain.post_angle \
    four_bar_free.crank_angle \
    geared_five_bar.crank_angle geneva_drive.crank_angle groove_cam.cam_angle hatch.opening \
    jansen_leg.crank_angle parallelogram.crank_angle \
    pendulum.swing_angle pendulum_free.swing planetary_gear.sun_angle rack_drive.crank_angle \
    rolling_wheel.turn scotch_yoke.crank_angle screw_jack.turn sewing_machine.shaft_angle \
    slider_crank.crank_angle slider_crank_motor.crank_angle slotted_lever.crank_angle \
    stephenson_six_bar.crank_angle swinging_tip.swing tlv_crank.arm_angle \
    toggle_press.crank_angle v_twin.crank_angle valve_train.cam_angle watt_six_bar.crank_angle \
    whitworth.crank_angle wiper.motor_angle wiper_motor.motor_angle";

#[test]
fn shipped_mechanisms_start_many_turns_away() {
    let mut turning = Vec::new();
    // A lift does not come back after turns of its screw, a gripper does not pass its part.
    let names = stems("mechanisms", "toml").into_iter();
    for name in names.filter(|name| !["scissor_lift_screw", "gripper"].contains(&name.as_str())) {
        let mechanism = shipped(&name);
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let is_input = driver.motion().is_none();
            if is_input
                && driver.coordinate.kind.is_angle()
                && compare_turns(&mechanism, &[index], 0.3)
            {
                turning.push(format!("{name}.{}", driver.name));
            }
        }
    }
    assert_eq!(turning.join(" "), TURNING);
}

/// The closed form of the drag link: coupler and follower are a triangle on the crank's pin and the
/// follower's pivot. The follower leads the crank by less than half a turn.
fn lead(angle: f64) -> f64 {
    let (base, crank, coupler, follower) = (0.04, 0.10, 0.09, 0.11);
    let (x, y) = (crank * f64::cos(angle) - base, crank * f64::sin(angle));
    let diagonal = x.hypot(y);
    let cosine = (diagonal * diagonal + follower * follower - coupler * coupler)
        / (2.0 * diagonal * follower);
    let lead = y.atan2(x) - f64::acos(cosine) - angle;
    lead - TAU * (lead / TAU).round()
}

#[test]
fn a_drag_link_starts_ten_thousand_turns_away_in_its_mode() {
    let angle = 90_f64.to_radians() + 4.0 + 10_000.0 * TAU;
    let (mut solver, _) = assembled(&shipped("drag_link"));
    start(&mut solver, &[(0, angle)], &[]).expect("it turns");
    let [crank, coupler, follower] = [2, 5, 8].map(|column| solver.pose().q[column]);
    // The rounding of the angle, and of the follower, which is three times as fast at most.
    let same = 8.0 * f64::EPSILON * angle;
    let truth = lead(angle);
    assert!((truth + 1.308).abs() < 1e-3, "{truth}");
    assert!((crank - angle).abs() <= same, "{crank}");
    assert!((follower - angle - truth).abs() <= same, "{follower}");
    // The coupler turns with both: it is never half a turn ahead of the follower.
    assert!((coupler - follower).abs() < 0.5 * TAU, "{coupler}");
}

/// The values at the start hold for parameters and turns together.
#[test]
fn parameters_move_with_turns() {
    let exact = EXACT.iter().find(|exact| exact.file == "four_bar");
    let exact: &Exact = exact.expect("it is listed");
    let mechanism = shipped("four_bar");
    let (mut solver, _) = assembled(&mechanism);
    let set = [("crank_length", 0.07), ("rocker_length", 0.28)];
    let angle = 1.0 + 12_345.6 * TAU;
    start(&mut solver, &[(0, angle)], &set).expect("it turns");
    let mut changed = Mechanism::clone(&mechanism);
    for (name, value) in set {
        let own = changed.parameters.iter_mut().find(|p| p.name == name);
        own.expect("a parameter").default = value;
    }
    let truth = exact.solution(&changed, Jet::constant(angle));
    let truth: Vec<_> = truth.iter().map(|q| q.value).collect();
    assert_same(&mut solver, &[0], &truth, "four_bar");
}

fn geared(radii: &str) -> Arc<Mechanism> {
    let text = std::fs::read_to_string(crate::common::folder("mechanisms/geared_five_bar.toml"));
    let text = text.expect("it is shipped");
    let changed = text.replace(r#"radii = ["base/3", "2*base/3"]"#, radii);
    assert_ne!(changed, text);
    parse(&changed)
}

/// The first wheel turns 53 times until the mechanism is back.
#[test]
fn wheels_with_many_teeth_come_back_after_many_turns() {
    assert!(compare_turns(&geared("teeth = [25, 53]"), &[0], 0.3));
}

/// After a turn the wheels are back but for 1.3e-10 rad, after a hundred they are not.
#[test]
fn wheels_that_are_almost_back_are_followed() {
    let mechanism = geared(r#"radii = ["base*(1 + 2e-11)", "base"]"#);
    let (mut solver, _) = assembled(&mechanism);
    let home = solver.pose().clone();
    let turned = 100.0 * TAU;
    start(&mut solver, &[(0, home.drivers[0] + turned)], &[]).expect("it turns");
    let off = solver.pose().q[5] - home.q[5] + turned;
    let truth = -2e-11 * turned;
    assert!(
        (off - truth).abs() <= 4.0 * f64::EPSILON * turned,
        "{off:e}"
    );
}

/// Two cranks that turn together, and not alone.
#[test]
fn drivers_that_turn_together_start_many_turns_away() {
    let mechanism = parse(
        r#"
        format = 1
        name = "two_cranks"
        [ground.markers]
        O = [0, 0]
        P = [0.5, 0]
        [bodies.left]
        markers = { O = [0, 0], A = [0.3, 0] }
        estimate = [0, 0, 1]
        [bodies.right]
        markers = { P = [0, 0], B = [0.3, 0] }
        estimate = [0.5, 0, 1]
        [bodies.first]
        markers = { A = [0, 0], C = [0.4, 0] }
        estimate = [0.2, 0.2, 0.9]
        [bodies.second]
        markers = { B = [0, 0], C = [0.4, 0] }
        estimate = [0.7, 0.2, 2.2]
        [joints]
        O = { type = "revolute", markers = ["ground.O", "left.O"] }
        P = { type = "revolute", markers = ["ground.P", "right.P"] }
        A = { type = "revolute", markers = ["left.A", "first.A"] }
        B = { type = "revolute", markers = ["right.B", "second.B"] }
        C = { type = "revolute", markers = ["first.C", "second.C"] }
        [drivers]
        left_angle = { coordinate = "angle", markers = ["ground.O", "left.O"], start = 1 }
        right_angle = { coordinate = "angle", markers = ["ground.P", "right.P"], start = 1 }
        "#,
    );
    assert!(!compare_turns(&mechanism, &[0], 0.3));
    assert!(compare_turns(&mechanism, &[0, 1], 0.3));
    // Beyond a whole turn one of them has a turn more.
    let (mut solver, _) = assembled(&mechanism);
    let (left, right) = (1.0 + 10_000.95 * TAU, 1.0 + 10_001.05 * TAU);
    start(&mut solver, &[(0, left), (1, right)], &[]).expect("both turn");
    let [left_phi, right_phi, first, second] = [2, 5, 8, 11].map(|c| solver.pose().q[c]);
    let same = 8.0 * f64::EPSILON * right;
    assert!((left_phi - left).abs() <= same && (right_phi - right).abs() <= same);
    // By symmetry the two links lean as much against the line between their pins.
    let a = [0.3 * left.cos(), 0.3 * left.sin()];
    let b = [0.5 + 0.3 * right.cos(), 0.3 * right.sin()];
    let along = f64::atan2(b[1] - a[1], b[0] - a[0]);
    let lean = f64::acos(0.5 * (b[0] - a[0]).hypot(b[1] - a[1]) / 0.4);
    assert!((first - along - lean).abs() <= 8.0 * same, "{first}");
    assert!(
        (second - along - (TAU / 2.0 - lean)).abs() <= 8.0 * same,
        "{second}"
    );
}

/// At a change point, where the bodies of the parallelogram are in line, and on from there.
#[test]
fn a_start_at_a_change_point_many_turns_away() {
    let mechanism = shipped("parallelogram");
    let (mut solver, mut path) = assembled(&mechanism);
    let angle = 10_000.0 * TAU;
    start(&mut solver, &[(0, angle)], &[]).expect("it turns");
    for step in 0..=8 {
        let angle = angle + 0.1 * f64::from(step);
        crate::common::straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("it turns on");
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let phi = solver.pose().q[3 * index + 2];
            // Links stay parallel: each turns with the crank or not at all.
            let off = [angle, 0.0].map(|truth| (phi - truth).abs());
            let off = off[0].min(off[1]);
            assert!(off <= 8.0 * f64::EPSILON * angle, "{}: {phi}", body.name);
        }
    }
}

/// The drag link with a prescribed motion of its crank.
fn prescribed(motion: &str) -> Arc<Mechanism> {
    let text = std::fs::read_to_string(crate::common::folder("mechanisms/drag_link.toml"));
    let text = text.expect("it is shipped");
    let changed = text.replace(r#"start = "90*deg""#, &format!(r#"motion = "{motion}""#));
    assert_ne!(changed, text);
    parse(&changed)
}

/// Value of an output.
fn value(instance: &mut Instance, name: &str) -> f64 {
    let list = instance.variables();
    let place = list.iter().position(|v| v.name == name).expect("an output");
    let mut values = [0.0];
    instance
        .get_real(&[value_reference(place)], &mut values)
        .expect("readable");
    values[0]
}

#[test]
fn a_prescribed_motion_starts_late() {
    for (motion, time) in [
        ("90*deg + 10*t", 6_283.0),
        ("90*deg - 10*t", 6_283.0),
        ("90*deg + 10*t", -6_283.0),
        ("90*deg + sin(10*t)", 100_000.0),
        ("90*deg + 5*sin(0.1*t) + 10*t", 1.6e7),
    ] {
        let mut instance = instance_of(prescribed(motion), Interface::CoSimulation);
        instance.setup_experiment(time, None).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        let angle = value(&mut instance, "crank_angle.position");
        let (found, truth) = (value(&mut instance, "lead.position"), lead(angle));
        // The rounding of the angle, and of the follower, which is three times as fast at most.
        let same = 8.0 * f64::EPSILON * angle.abs() + FOLLOWED;
        assert!(
            (found - truth).abs() <= same,
            "{motion}: {found}, not {truth}"
        );
    }
}

/// The four-bar driven at its rocker, which swings. One turn further it closes again, and no motion
/// leads there.
#[test]
fn a_start_beyond_a_dead_point_is_refused_with_the_reason() {
    let text = std::fs::read_to_string(crate::common::folder("mechanisms/four_bar.toml"));
    let text = text.expect("it is shipped").replace(
        r#"markers = ["ground.O2", "crank.O"], start = "60*deg""#,
        r#"markers = ["ground.O4", "rocker.O"], start = "140*deg""#,
    );
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let mut instance = instance_of(parse(&text), interface);
        instance.setup_experiment(0.0, None).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        let beyond = 140_f64.to_radians() + TAU;
        instance.set_real(&[1], &[beyond]).expect("legal");
        let error = instance
            .exit_initialization_mode()
            .expect_err("a dead point lies between");
        assert_eq!(instance.state(), State::Error);
        let message = error.to_string();
        for words in ["dead point", "driver `", "deg", "line"] {
            assert!(message.contains(words), "{message}");
        }
    }
}
