//! Steps of any size keep to the continuous motion, and stop where it ends.

mod common;
#[path = "common/generated.rs"]
#[allow(dead_code, reason = "also used by `benches/`")]
mod generated;

use std::f64::consts::{PI, TAU};

use biela::kinematics::{Curve, Path, Reason, Solver};
use biela::mechanism::Jet;
use common::{EXACT, assembled, parse, shipped, straight_to};
use generated::{Ground, chain, lift_from_below, lift_from_below_pose, scissor_lift};
use proptest::prelude::*;

/// q at rounding level: some eps times the condition, 1e-14, in metres and radians below ten.
const SAME_POSE: f64 = 1e-13;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A crank may jump by almost half a turn either way: the closed form, which has one branch
    /// only, tells where the continuous motion ends.
    #[test]
    fn large_steps_stay_on_the_branch(steps in prop::collection::vec(-3.1..3.1_f64, 1..20)) {
        for exact in EXACT.iter().filter(|exact| exact.file != "tlv") {
            let mechanism = shipped(exact.file);
            let (mut solver, mut path) = assembled(&mechanism);
            let mut angle = solver.pose().drivers[0];
            for step in &steps {
                angle += step;
                straight_to(&solver, &mut path, angle);
                prop_assert!(solver.track(&path).is_ok(), "{} at {angle}", exact.file);
                let truth: Vec<_> = exact
                    .solution(&mechanism, Jet::constant(angle))
                    .iter()
                    .map(|q| q.value)
                    .collect();
                let off = difference(&solver.pose().q, &truth);
                // Angles grow with the turns, and their rounding with them.
                prop_assert!(off < SAME_POSE * angle.abs().max(1.0), "{}: {off:e}", exact.file);
            }
        }
    }

    /// The same for the telescopic side, whose length has limits at 0.15 m and 0.65 m.
    #[test]
    fn large_strokes_stay_on_the_branch(lengths in prop::collection::vec(0.16..0.64_f64, 1..20)) {
        let mechanism = shipped("tlv");
        let exact = EXACT.iter().find(|exact| exact.file == "tlv").expect("it is listed");
        let (mut solver, mut path) = assembled(&mechanism);
        for length in lengths {
            straight_to(&solver, &mut path, length);
            prop_assert!(solver.track(&path).is_ok(), "at {length}");
            let solution = exact.solution(&mechanism, Jet::constant(length));
            let truth: Vec<_> = solution.iter().map(|q| q.value).collect();
            // 0.01 m from a limit of 0.65 m the arm's angle changes 12 times as fast as the length
            // does in arm lengths, and the closed form loses as much.
            prop_assert!(difference(&solver.pose().q, &truth) < 20.0 * SAME_POSE);
        }
    }
}

#[test]
fn a_whole_turn_in_one_step_is_a_whole_turn() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let before = solver.pose().q.clone();
    let target = solver.pose().drivers[0] + TAU;
    straight_to(&solver, &mut path, target);
    let progress = solver.track(&path).expect("the crank turns fully");
    // A sub-step of more than half a turn has chords that tell nothing of the way between.
    assert!((3..20).contains(&progress.substeps), "{progress:?}");
    assert_eq!(progress.checked, 0);
    let mut expected = before;
    expected[2] += TAU;
    assert!(difference(&solver.pose().q, &expected) < SAME_POSE);
}

#[test]
fn a_thousand_turns_keep_their_phase() {
    let mechanism = shipped("four_bar");
    let exact = &EXACT[2];
    let (mut solver, mut path) = assembled(&mechanism);
    let start = solver.pose().drivers[0];
    for turn in 1..=1000 {
        straight_to(&solver, &mut path, start + TAU * f64::from(turn));
        solver.track(&path).expect("the crank turns fully");
    }
    let angle = solver.pose().drivers[0];
    // The crank's equation is phi − u = 0: its angle is the driver's to the last bit or two.
    assert!((solver.pose().q[2] - angle).abs() <= 2.0 * f64::EPSILON * angle);
    let solution = exact.solution(&mechanism, Jet::constant(angle));
    for k in [5, 8] {
        // An angle of 6,000 rad has a rounding of 1e-12, and so has its sine.
        assert!((solver.pose().q[k] - solution[k].value).abs() < 2e-12);
    }
}

#[test]
fn a_step_in_two_halves_is_the_same_step() {
    for exact in EXACT {
        let mechanism = shipped(exact.file);
        let (mut whole, mut path) = assembled(&mechanism);
        let (mut halves, _) = assembled(&mechanism);
        let now = whole.pose().drivers[0];
        let target = now + if exact.file == "tlv" { 0.1 } else { 1.0 };
        straight_to(&whole, &mut path, target);
        whole.track(&path).expect("nothing is in the way");
        for part in [0.5 * (now + target), target] {
            straight_to(&halves, &mut path, part);
            halves.track(&path).expect("nothing is in the way");
        }
        assert!(
            difference(&whole.pose().q, &halves.pose().q) < SAME_POSE,
            "{}",
            exact.file
        );
    }
}

#[test]
fn the_way_back_ends_where_the_way_out_began() {
    let mechanism = shipped("slider_crank");
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    for angle in [2.0, 5.0, 9.0, 5.0, 2.0, home.drivers[0]] {
        straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("the crank turns fully");
    }
    assert!(difference(&solver.pose().q, &home.q) < SAME_POSE);
}

/// The telescopic side of the triangle ends at base + arm = 0.65 m and at base − arm = 0.15 m.
#[test]
fn a_dead_point_is_where_the_triangle_ends() {
    for (target, limit) in [(0.7, 0.65), (0.1, 0.15)] {
        let mechanism = shipped("tlv");
        let (mut solver, mut path) = assembled(&mechanism);
        straight_to(&solver, &mut path, target);
        let blocked = solver.track(&path).expect_err("the triangle cannot close");
        let reached = solver.pose().drivers[0];
        assert!((reached - limit).abs() < 1e-9, "{reached} {limit}");
        assert!((blocked.s - (limit - 0.35) / (target - 0.35)).abs() < 1e-8);
        // The pose there is a valid one, and the way back is open.
        assert!(solver.residual() < 1e-14);
        straight_to(&solver, &mut path, 0.35);
        solver.track(&path).expect("the way back is open");
        assert!((solver.pose().q[2].to_degrees() - 60.0).abs() < 1e-9);
    }
}

/// At 0.65 m exactly the side has no velocity that would give the arm one.
#[test]
fn the_dead_point_itself_is_refused() {
    let mechanism = shipped("tlv");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, 0.65);
    solver.track(&path).expect_err("arm and base are in line");
    assert!(solver.pose().drivers[0] < 0.65);
    assert!(solver.pose().drivers[0] > 0.65 - 1e-9);
}

/// A distance cannot be zero or negative: the side is blocked before, never turned inside out.
#[test]
fn a_distance_stays_positive() {
    let mechanism = shipped("tlv");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, -0.35);
    solver.track(&path).expect_err("no distance is negative");
    assert!(solver.pose().drivers[0] >= 0.15);
}

#[test]
fn a_prescribed_motion_is_followed_along_its_own_curve() {
    // Both ends of the step have the same value; the peak between them is beyond the limit.
    let text = std::fs::read_to_string("mechanisms/tlv.toml")
        .expect("it is shipped")
        .replace("start = 0.35", "motion = \"0.35 + 0.4*sin(pi*t)\"");
    let mechanism = parse(&text);
    let (mut solver, mut path) = assembled(&mechanism);
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("the peak is at 0.75 m");
    // 0.35 + 0.4 sin(pi t) = 0.65 at t = asin(3/4)/pi.
    let limit = 0.75_f64.asin() / PI;
    assert!((blocked.s - limit).abs() < 1e-8, "{} {limit}", blocked.s);
    assert!((solver.pose().time - limit).abs() < 1e-8);
}

#[test]
fn a_motion_at_rest_at_both_ends_is_followed_in_between() {
    // Value, velocity and acceleration are the same at both ends; the peak is at 0.75 m.
    let text = std::fs::read_to_string("mechanisms/tlv.toml")
        .expect("it is shipped")
        .replace("start = 0.35", "motion = \"0.35 + 0.4*sin(pi*t)^4\"");
    let (mut solver, mut path) = assembled(&parse(&text));
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("the peak is at 0.75 m");
    // sin(pi t)^4 = 3/4.
    let limit = 0.75_f64.powf(0.25).asin() / PI;
    assert!((blocked.s - limit).abs() < 1e-8, "{} {limit}", blocked.s);
}

#[test]
fn a_path_that_never_ends_is_given_up() {
    let (mut solver, mut path) = assembled(&shipped("four_bar"));
    for target in [1e8, 1e17] {
        straight_to(&solver, &mut path, target);
        let blocked = solver.track(&path).expect_err("that is too far to follow");
        assert_eq!(blocked.reason, Reason::TooLong);
        assert!(solver.residual() < 1e-10);
    }
}

#[test]
fn a_motion_that_leaves_its_domain_says_so() {
    let text = std::fs::read_to_string("mechanisms/pendulum.toml")
        .expect("it is shipped")
        .replace("start = \"30*deg\"", "motion = \"sqrt(0.5 - t)\"");
    let (mut solver, mut path) = assembled(&parse(&text));
    path.duration = 1.0;
    let blocked = solver.track(&path).expect_err("no root of -0.5");
    assert!(matches!(blocked.reason, Reason::Value(_)), "{blocked:?}");
    assert!((blocked.s - 0.5).abs() < 1e-6);
}

/// Two sliders on a rod of 0.5 micrometres: as accurate as one of half a metre.
#[test]
fn small_mechanisms_are_as_accurate_as_large_ones() {
    for scale in [1.0, 1e-6, 1e-9] {
        let text = format!(
            r#"
            format = 1
            name = "trammel"
            [ground.markers]
            X = [0, 0]
            Y = [0, 0, "90*deg"]
            [bodies.a]
            markers = {{ A = [0, 0] }}
            estimate = [{x}, 0, 0]
            [bodies.b]
            markers = {{ B = [0, 0] }}
            estimate = [0, {y}, "90*deg"]
            [joints]
            x = {{ type = "translational", markers = ["ground.X", "a.A"] }}
            y = {{ type = "translational", markers = ["ground.Y", "b.B"] }}
            rod = {{ type = "link", markers = ["a.A", "b.B"], length = {rod} }}
            [drivers]
            u = {{ coordinate = "x", markers = ["ground.X", "a.A"], start = {x} }}
            "#,
            x = 0.3 * scale,
            y = 0.4 * scale,
            rod = 0.5 * scale
        );
        let (mut solver, mut path) = assembled(&parse(&text));
        for u in [0.35, 0.1, 0.45] {
            straight_to(&solver, &mut path, u * scale);
            solver.track(&path).expect("the rod reaches");
            let y = (0.25 - u * u).sqrt() * scale;
            assert!(
                (solver.pose().q[4] - y).abs() < 1e-14 * scale,
                "scale {scale:e}"
            );
        }
    }
}

/// Gears keep their phase: the planet of a planetary gear turns 1 + z_sun/z_planet times as fast
/// as the arm around a sun that stands still.
#[test]
fn a_planet_keeps_its_phase_over_a_thousand_turns() {
    let mechanism = parse(
        r#"
        format = 1
        name = "planetary"
        [ground.markers]
        O = [0, 0]
        [bodies.arm]
        markers = { O = [0, 0], P = [0.06, 0] }
        [bodies.planet]
        markers = { C = [0, 0] }
        estimate = [0.06, 0, 0]
        [joints]
        O = { type = "revolute", markers = ["ground.O", "arm.O"] }
        P = { type = "revolute", markers = ["arm.P", "planet.C"] }
        mesh = { type = "gear", markers = ["ground.O", "planet.C"], teeth = [40, 20], carrier = "arm" }
        [drivers]
        turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0 }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    for turn in 1..=1000 {
        straight_to(&solver, &mut path, TAU * f64::from(turn));
        solver.track(&path).expect("gears turn fully");
    }
    let arm = solver.pose().q[2];
    let planet = solver.pose().q[5];
    assert!((planet - 3.0 * arm).abs() <= 4.0 * f64::EPSILON * planet);
}

/// A pinion of 20 mm on a rack: half a turn moves it by pi r, to the left if it turns forward.
#[test]
fn a_pinion_rolls() {
    let mechanism = parse(
        r#"
        format = 1
        name = "rack_drive"
        [ground.markers]
        R = [0, 0]
        way = [0, "20*mm"]
        [bodies.carriage]
        markers = { C = [0, 0] }
        estimate = [0, "20*mm", 0]
        [bodies.pinion]
        markers = { C = [0, 0] }
        estimate = [0, "20*mm", 0]
        [joints]
        way = { type = "translational", markers = ["ground.way", "carriage.C"] }
        axle = { type = "revolute", markers = ["carriage.C", "pinion.C"] }
        mesh = { type = "rack_and_pinion", markers = ["pinion.C", "ground.R"], radius = "20*mm" }
        [drivers]
        turn = { coordinate = "angle", markers = ["carriage.C", "pinion.C"], start = 0 }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, PI);
    solver.track(&path).expect("the rack has no end");
    assert!((solver.pose().q[0] + 0.02 * PI).abs() < 1e-15);
}

#[test]
fn parameters_move_the_mechanism_continuously() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let rocker = mechanism
        .parameter_id("rocker_length")
        .expect("it is in the file");
    path.to[rocker.index()] = 0.35;
    solver.track(&path).expect("a longer rocker closes as well");
    // The same mechanism, written with the longer rocker.
    let text = std::fs::read_to_string("mechanisms/four_bar.toml")
        .expect("it is shipped")
        .replace("value = 0.30", "value = 0.35");
    let (longer, _) = assembled(&parse(&text));
    assert!(difference(&solver.pose().q, &longer.pose().q) < SAME_POSE);
    assert_eq!(solver.pose().parameters, longer.pose().parameters);
}

#[test]
fn a_restored_pose_goes_on_with_the_same_bits() {
    let mechanisms = [
        (shipped("four_bar"), 0.3),
        (shipped("slider_crank"), 0.3),
        (shipped("five_bar_robot"), 0.01),
        (shipped("double_rocker"), 0.01),
        // One block with a sparse matrix.
        (parse(&scissor_lift(12)), 0.01),
        // Its one block is too large to be proved.
        (parse(&scissor_lift(20)), 0.01),
    ];
    for (mechanism, step) in mechanisms {
        let (mut solver, mut path) = assembled(&mechanism);
        let home = solver.pose().clone();
        let run = |solver: &mut Solver, path: &mut Path| {
            (1..50)
                .map(|k| {
                    straight_to(solver, path, home.drivers[0] + step * f64::from(k));
                    solver.track(path).expect("nothing is in the way");
                    solver.pose().clone()
                })
                .collect::<Vec<_>>()
        };
        let first = run(&mut solver, &mut path);
        solver.restore(&home);
        assert_eq!(run(&mut solver, &mut path), first, "{}", mechanism.name);
        let mut other = Solver::new(mechanism).expect("the drivers match");
        other.restore(&home);
        assert_eq!(run(&mut other, &mut path), first);
    }
}

#[test]
fn ten_thousand_steps_leave_no_residual_behind() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let start = solver.pose().drivers[0];
    for step in 1..=10_000 {
        let position = start + TAU * f64::from(step) / 1000.0;
        straight_to(&solver, &mut path, position);
        let progress = solver.track(&path).expect("the crank turns fully");
        // A predictor of second order needs one correction, or two where the motion is fast.
        assert!(
            progress.substeps == 1 && progress.iterations <= 2,
            "{progress:?}"
        );
        // Rounding of angles up to 63 rad.
        assert!(
            solver.residual() < 64.0 * f64::EPSILON,
            "{:e}",
            solver.residual()
        );
    }
}

/// A crank that starts from rest and turns by most of a turn within one step, by its acceleration
/// alone, through both change points of the parallelogram.
#[test]
fn a_turn_from_rest_is_followed_all_the_way() {
    let (mut solver, mut path) = assembled(&shipped("parallelogram"));
    let start = solver.pose().drivers[0];
    path.duration = 1.0;
    path.curves[0] = Curve::Input {
        position: start,
        velocity: 0.0,
        acceleration: 2.0 * 5.3,
        jump: 0.0,
    };
    let progress = solver.track(&path).expect("the crank turns fully");
    assert_eq!(progress.crossings, 2);
    assert!((solver.pose().q[8] - (start + 5.3)).abs() < SAME_POSE);
}

/// A stroke so long that the old value is lost beside it: refused, and nothing is lost.
#[test]
fn a_jump_beyond_all_rounding_is_refused() {
    let mechanism = parse(
        "format = 1\nname = 'slide'\n[ground.markers]\nO = [0, 0]\n[bodies.slide]\n\
         markers = { O = [0, 0] }\nestimate = [0.3, 0, 0]\n[joints]\n\
         O = { type = 'translational', markers = ['ground.O', 'slide.O'] }\n[drivers]\n\
         d = { coordinate = 'distance', markers = ['ground.O', 'slide.O'], start = 0.3 }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    let before = solver.pose().clone();
    straight_to(&solver, &mut path, -1e17);
    let blocked = solver.track(&path).expect_err("no distance is negative");
    assert!(matches!(blocked.reason, Reason::Value(_)), "{blocked:?}");
    assert_eq!(solver.pose().parameters, before.parameters);
    solver.restore(&before);
    straight_to(&solver, &mut path, 0.4);
    solver.track(&path).expect("the slide is as it was");
}

/// A slotted lever whose pivot lies on the pin's circle: where the pin runs over the pivot the
/// lever could point anywhere, and the smooth motion goes on. By the inscribed angle the lever
/// turns half as fast as the crank.
#[test]
fn a_pin_runs_over_the_pivot_of_its_slot() {
    let mechanism = parse(
        "format = 1\nname = 'lever'\n[ground.markers]\nO = [0, 0]\nL = [-1, 0]\n\
         [bodies.crank]\nmarkers = { O = [0, 0], A = [1, 0] }\nestimate = [0, 0, 1]\n\
         [bodies.lever]\nmarkers = { L = [0, 0], end = [2, 0] }\nestimate = [-1, 0, 0.5]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'crank.O'] }\n\
         L = { type = 'revolute', markers = ['ground.L', 'lever.L'] }\n\
         A = { type = 'slot', markers = ['lever.L', 'crank.A'] }\n[drivers]\n\
         u = { coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 1 }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    for target in [2.0, PI, 4.0, 2.0] {
        straight_to(&solver, &mut path, target);
        solver.track(&path).expect("the motion goes on");
        assert!(
            (solver.pose().q[5] - 0.5 * target).abs() < SAME_POSE,
            "{target}"
        );
    }
}

/// A hundred steps a turn are one sub-step each, proved, whatever the mechanism is made of; and so
/// they are in a chain of a thousand loops.
#[test]
fn ordinary_steps_are_one_substep() {
    let cranks = [
        "four_bar",
        "slider_crank",
        "tlv_crank",
        "slotted_lever",
        "jansen_leg",
        "watt_six_bar",
        "stephenson_six_bar",
        "whitworth",
        "scotch_yoke",
        "v_twin",
        "drag_link",
        "elliptic_trammel",
        "geared_five_bar",
        "planetary_gear",
        "cam_knife",
        "cam_flat",
        "chebyshev",
    ];
    let texts = cranks.map(|name| (name, shipped(name), 100));
    let long = ("chain", parse(&chain(1000, Ground::Straight)), 5);
    for (name, mechanism, steps) in texts.into_iter().chain([long]) {
        let (mut solver, mut path) = assembled(&mechanism);
        for _ in 0..steps {
            let target = solver.pose().drivers[0] + TAU / 100.0;
            straight_to(&solver, &mut path, target);
            let progress = solver.track(&path).expect("nothing is in the way");
            assert_eq!(
                (progress.substeps, progress.checked),
                (1, 0),
                "{name} at {target}"
            );
        }
    }
}

/// The uncertainty of one cell passes on to the next with its sign: in straight lifts unchanged, in
/// lifts whose bars do not cross in their middles by the cells' own leverage.
#[test]
fn lifts_driven_from_below_are_proved_at_any_height() {
    type Crossings = fn(usize) -> [f64; 2];
    let crossings: [(&str, Crossings); 3] = [
        ("straight", |_| [0.5, 0.5]),
        ("bent", |k| [0.5, 0.5 + 0.004 * (k as f64).sin()]),
        ("uneven", |k| {
            if k.is_multiple_of(2) {
                [0.47, 0.47]
            } else {
                [0.53, 0.53]
            }
        }),
    ];
    for (name, crossings) in crossings {
        for cells in [10, 26, 60, 200] {
            let mechanism = parse(&lift_from_below(cells, 40.0_f64.to_radians(), crossings));
            let (mut solver, mut path) = assembled(&mechanism);
            for step in 1..=20 {
                let angle = (40.0 + 0.05 * f64::from(step)).to_radians();
                straight_to(&solver, &mut path, angle);
                let progress = solver.track(&path).expect("the lift rises");
                let steps = (progress.substeps, progress.checked);
                assert_eq!(steps, (1, 0), "{name}, {cells} cells");
                let pose = lift_from_below_pose(cells, angle, crossings);
                let off = difference(&solver.pose().q, pose.as_flattened());
                // Some roundings of angles per cell, here and in the closed form, add up from cell
                // to cell, those of points once more.
                let rounding = 32.0 * f64::EPSILON * (cells * cells) as f64;
                assert!(off < rounding, "{name}, {cells} cells: {off:e}");
            }
        }
    }
}

/// A block of more than 32 torn unknowns has no rigorous bound, and says so.
#[test]
fn large_blocks_are_checked_only() {
    for (cells, proved) in [(12, true), (20, false)] {
        let (mut solver, mut path) = assembled(&parse(&scissor_lift(cells)));
        let target = solver.pose().drivers[0] + 0.001;
        straight_to(&solver, &mut path, target);
        let progress = solver.track(&path).expect("nothing is in the way");
        assert_eq!(progress.checked == 0, proved, "{cells} cells: {progress:?}");
    }
}

/// A platform on three legs of held lengths, of which markers on ground and on the platform move.
/// The truth is the same path in tiny parts.
#[test]
fn parameters_of_a_coupled_block_keep_to_the_motion() {
    let mechanism = parse(
        "format = 1\nname = 'platform'\n[parameters]\n\
         ax1 = { value = -0.07223632809180103, tunable = true }\n\
         bx1 = { value = -2.0114817526932045, tunable = true }\n\
         [ground.markers]\nA0 = [-1.0866542967255155, 1.0289542987520632]\n\
         A1 = ['ax1', 1.9191844705871113]\nA2 = [1.8960046370176933, -0.632748805538845]\n\
         [bodies.p]\nmarkers = { B0 = [-0.0031255749362728014, -1.4014883191453933], \
         B1 = ['bx1', -0.12565325423701357], B2 = [-0.16717283627790813, 1.775573902857885] }\n\
         estimate = [0.4445476906170683, 0.1519500280064077, -1.2986763296839756]\n[drivers]\n\
         u0 = { coordinate = 'distance', markers = ['ground.A0', 'p.B0'], \
         start = 1.2636272543926257 }\n\
         u1 = { coordinate = 'distance', markers = ['ground.A1', 'p.B1'], \
         start = 0.19902556736581078 }\n\
         u2 = { coordinate = 'distance', markers = ['ground.A2', 'p.B2'], \
         start = 1.4389280532955118 }\n",
    );
    let target = [-0.4471217504207009, -1.8663575853641738];
    let follow = |parts: u32| {
        let (mut solver, mut path) = assembled(&mechanism);
        let from = path.from.clone();
        for part in 1..=parts {
            let s = f64::from(part) / f64::from(parts);
            path.from.copy_from_slice(&path.to);
            for (to, (from, target)) in path.to.iter_mut().zip(from.iter().zip(target)) {
                *to = from + s * (target - from);
            }
            solver.track(&path).expect("the platform follows");
        }
        solver.pose().q.clone()
    };
    let (whole, truth) = (follow(1), follow(2000));
    assert!(difference(&whole, &truth) < 1e-9, "{whole:?} {truth:?}");
    assert!((truth[0] + 0.0435).abs() < 1e-4, "{truth:?}");
}

/// A length runs until links line up, and back, as a driver does.
#[test]
fn a_parameter_comes_back_from_a_dead_point() {
    let mechanism = shipped("jansen_leg");
    for (name, far) in [
        ("m", 0.1),
        ("j", 0.2),
        ("k", 0.2),
        ("a", 0.2),
        ("b", 0.12),
        ("f", 0.2),
    ] {
        let (mut solver, mut path) = assembled(&mechanism);
        let home = solver.pose().clone();
        let index = mechanism.parameter_id(name).expect("it has it").index();
        path.to[index] = far;
        solver.track(&path).expect_err("links line up");
        path.from.clone_from(&solver.pose().parameters);
        path.to.clone_from(&home.parameters);
        let back = solver.track(&path);
        assert!(back.is_ok(), "{name}: {back:?}");
        let off = difference(&solver.pose().q, &home.q);
        assert!(off < SAME_POSE, "{name}: {off}");
    }
}

/// A platform of 1 mm on three legs takes as many sub-steps beside a pendulum of 1 m or of 1 km as
/// alone, and is as regular.
#[test]
fn a_large_mechanism_beside_a_small_one_costs_it_no_sub_steps() {
    let file = |pendulum: [&str; 3]| {
        let [ground, body, rest] = pendulum;
        parse(&format!(
            "format = 1\nname = \"mixed\"\n[ground.markers]\nA0 = [-0.0008, -0.0005]\n\
             A1 = [0.0009, -0.0004]\nA2 = [0.0001, 0.0009]\n{ground}\n\
             [bodies.platform]\nmarkers = {{ B0 = [-0.0003, -0.0002], \
             B1 = [0.00035, -0.00015], B2 = [0.00005, 0.0003] }}\n\
             estimate = [0.00005, 0.0001, 0.2]\n{body}\n[drivers]\n\
             u0 = {{ coordinate = \"distance\", markers = [\"ground.A0\", \"platform.B0\"], \
             start = 0.0006880964176648267 }}\n\
             u1 = {{ coordinate = \"distance\", markers = [\"ground.A1\", \"platform.B1\"], \
             start = 0.0006373570317599123 }}\n\
             u2 = {{ coordinate = \"distance\", markers = [\"ground.A2\", \"platform.B2\"], \
             start = 0.0004997341725430079 }}\n{rest}\n"
        ))
    };
    let joints = ["1", "1000", "1e9"].map(|length| {
        format!(
            "[bodies.pendulum]\nmarkers = {{ O = [0, 0], T = [{length}, 0] }}\n[joints]\n\
             z = {{ type = \"revolute\", markers = [\"ground.Z\", \"pendulum.O\"] }}"
        )
    });
    let driver =
        "w = { coordinate = \"angle\", markers = [\"ground.Z\", \"pendulum.O\"], start = 0 }";
    let alone = ["", "[joints]", ""];
    let beside = |k: usize| ["Z = [0, 0]", joints[k].as_str(), driver];
    let [alone, beside @ ..] = [alone, beside(0), beside(1), beside(2)].map(|pendulum| {
        let (mut solver, mut path) = assembled(&file(pendulum));
        let rcond = solver.rcond();
        for (driver, curve) in path.curves.iter_mut().enumerate() {
            let here = solver.pose().drivers[driver];
            *curve = Curve::Input {
                position: 1.01 * here,
                velocity: 0.0,
                acceleration: 0.0,
                jump: -0.01 * here,
            };
        }
        let progress = solver.track(&path).expect("the legs reach");
        assert_eq!(progress.checked, 0);
        (progress.substeps, rcond)
    });
    assert!(alone.0 <= 10, "{alone:?}");
    for beside in beside {
        assert!(
            beside.0 <= alone.0 + 1,
            "{alone:?}, {beside:?} beside a pendulum"
        );
        // Sizes are scaled by powers of two.
        let ratio = beside.1 / alone.1;
        assert!(
            (0.5..2.0).contains(&ratio),
            "{alone:?}, {beside:?} beside a pendulum"
        );
    }
}
