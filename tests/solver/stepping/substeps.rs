//! The number of sub-steps of a step, and whether they are proved.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;

use biela::kinematics::{DriverPath, Reason};

use crate::common::{assembled, parse, shipped, straight_to};
use crate::generated::{Ground, chain, lift_from_below, lift_from_below_pose, scissor_lift};
use crate::stepping::difference;

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

/// A carriage moves straight along its rail with all that it carries, and the driver is its
/// distance along an axis that it carries: nothing turns, at any distance from the start.
#[test]
fn straight_motions_are_one_substep_at_any_distance() {
    let (mut solver, mut path) = assembled(&parse(
        "format = 1\nname = \"carriage\"\n\
         [ground.markers]\nO = [0, 0]\n\
         [bodies.carriage]\nmarkers = { A = [0, 0], P = [0, 0.3], B = [0.4, 0.1] }\n\
         estimate = [1, 0, 0]\n\
         [bodies.arm]\nmarkers = { P = [0, 0], C = [0.3, 0.2] }\nestimate = [1, 0.3, 0]\n\
         [joints]\n\
         rail = { type = \"translational\", markers = [\"ground.O\", \"carriage.A\"] }\n\
         pin = { type = \"revolute\", markers = [\"carriage.P\", \"arm.P\"] }\n\
         [constraints]\n\
         rod = { coordinate = \"distance\", markers = [\"carriage.B\", \"arm.C\"], value = 0.4 }\n\
         [drivers]\n\
         u = { coordinate = \"x\", markers = [\"ground.O\", \"carriage.A\"], axes = \"arm.P\", \
         start = 1 }\n",
    ));
    let start = solver.pose().q.clone();
    for distance in [3.0, 10.0, 30.0, 100.0] {
        let mut go = |target: f64| {
            straight_to(&solver, &mut path, target);
            let progress = solver.track(&path).expect("the rail is endless");
            (progress.substeps, progress.checked)
        };
        go(distance);
        assert_eq!(go(distance + 0.1), (1, 0), "at {distance} m");
        // Rounding of lengths at that distance, over the length of the arm.
        let turned = [2, 5].map(|angle| solver.pose().q[angle] - start[angle]);
        let rounding = 8.0 * f64::EPSILON * distance / 0.3;
        assert!(
            turned.iter().all(|angle| angle.abs() < rounding),
            "{turned:?}"
        );
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

/// A row of `count` rods, each of which moves a slider, along x and along y in turn. The crank of
/// 0.1 m has its pin at the start of the first rod.
fn row_of_sliders(count: usize, crank: f64) -> String {
    let (mut ground, mut bodies, mut joints) = (String::new(), String::new(), String::new());
    let mut pin = ([0.1 * crank.cos(), 0.1 * crank.sin()], "crank.B".to_owned());
    for k in 0..count {
        let ([x, y], marker) = &pin;
        let [along, across] = [(0.3_f64 * 0.3 - 0.2 * 0.2).sqrt(), 0.2];
        let (place, tilt) = if k.is_multiple_of(2) {
            ([x + along, y - across], 0.0)
        } else {
            ([x + across, y + along], FRAC_PI_2)
        };
        let [px, py] = place;
        let phi = (py - y).atan2(px - x);
        let _ = writeln!(ground, "G{k} = [{px:?}, {py:?}, {tilt:?}]");
        let _ = write!(
            bodies,
            "[bodies.rod_{k}]\nmarkers = {{ A = [0, 0], B = [0.3, 0] }}\n\
             estimate = [{x:?}, {y:?}, {phi:?}]\n\
             [bodies.slider_{k}]\nmarkers = {{ A = [0, 0], G = [0, 0, {tilt:?}] }}\n\
             estimate = [{px:?}, {py:?}, 0]\n"
        );
        let _ = write!(
            joints,
            "A{k} = {{ type = 'revolute', markers = ['{marker}', 'rod_{k}.A'] }}\n\
             B{k} = {{ type = 'revolute', markers = ['rod_{k}.B', 'slider_{k}.A'] }}\n\
             S{k} = {{ type = 'translational', markers = ['ground.G{k}', 'slider_{k}.G'] }}\n"
        );
        pin = (place, format!("slider_{k}.A"));
    }
    format!(
        "format = 1\nname = 'sliders'\n[ground.markers]\nO = [0, 0]\n{ground}\
         [bodies.crank]\nmarkers = {{ A = [0, 0], B = [0.1, 0] }}\nestimate = [0, 0, {crank:?}]\n\
         {bodies}[joints]\nO = {{ type = 'revolute', markers = ['ground.O', 'crank.A'] }}\n{joints}\
         [drivers]\nu = {{ coordinate = 'angle', markers = ['ground.O', 'crank.A'], \
         start = {crank:?} }}\n"
    )
}

/// A slider passes nine tenths of its motion on to the next one, and so much of its uncertainty.
#[test]
fn rows_of_sliders_are_proved_at_any_length() {
    for count in [10, 30, 40, 200] {
        let mechanism = parse(&row_of_sliders(count, 1.0));
        let (mut solver, mut path) = assembled(&mechanism);
        let body = |name: String| 3 * mechanism.body_id(&name).expect("it has it").index();
        let home = solver.pose().q.clone();
        for step in 1..=20 {
            let angle = 1.0 + 1e-3 * f64::from(step);
            straight_to(&solver, &mut path, angle);
            let progress = solver.track(&path).expect("nothing is in the way");
            let steps = (progress.substeps, progress.checked);
            assert_eq!(steps, (1, 0), "{count} sliders");
            let mut pin = [0.1 * angle.cos(), 0.1 * angle.sin()];
            for k in 0..count {
                let slider = body(format!("slider_{k}"));
                // Each slider keeps to its line, a rod's length from the pin before it.
                let (along, across) = if k.is_multiple_of(2) { (0, 1) } else { (1, 0) };
                let line = home[slider + across];
                let reach = 0.3 * 0.3 - (line - pin[across]).powi(2);
                pin[along] += reach.sqrt();
                pin[across] = line;
                let found = [0, 1].map(|axis: usize| solver.pose().q[slider + axis]);
                let off = (found[0] - pin[0]).hypot(found[1] - pin[1]);
                // Some roundings of a coordinate, of which ten add up, as each passes on nine tenths.
                let far = 1.0 + pin[0].abs() + pin[1].abs();
                assert!(off < 128.0 * f64::EPSILON * far, "{count}, {k}: {off:e}");
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
        for (driver, driver_path) in path.driver_paths.iter_mut().enumerate() {
            let here = solver.pose().drivers[driver];
            *driver_path = DriverPath::Input {
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

/// Lengths that are nothing but rounding, here 0.1 + 0.2 - 0.3, give a mechanism no size: it has the
/// same condition as with zeros in their places.
#[test]
fn rounding_is_no_size() {
    let gears = |off: &str| {
        parse(&format!(
            "format = 1\nname = \"gears\"\n[ground.markers]\nO = [0, 0]\nP = [0.3, 0]\n\
             [bodies.a.markers]\nO = [0.3, 0]\nT = [\"0.3 + {off}\", 0]\n\
             [bodies.b.markers]\nP = [0, 0]\n[joints]\n\
             O = {{ type = \"revolute\", markers = [\"ground.O\", \"a.O\"] }}\n\
             P = {{ type = \"revolute\", markers = [\"ground.P\", \"b.P\"] }}\n\
             g = {{ type = \"gear\", markers = [\"a.T\", \"b.P\"], radii = [1, 2] }}\n[drivers]\n\
             u = {{ coordinate = \"angle\", markers = [\"ground.O\", \"a.O\"], start = 1 }}\n"
        ))
    };
    let [crank, short, tiny] = ["0.02", "5e-4", "1e-6"].map(|length| {
        format!(
            "[bodies.crank.markers]\nO = [0, 0]\nA = [{length}, 0]\n[drivers]\n\
             v = {{ coordinate = \"angle\", markers = [\"ground.O\", \"crank.O\"], start = 1 }}\n\
             [joints]\nO = {{ type = \"revolute\", markers = [\"ground.O\", \"crank.O\"] }}"
        )
    });
    let alone = "[drivers]\n[joints]";
    let slides = |beside: &str, off: &str| {
        let (before, joints) = beside.split_once("[drivers]").expect("it has drivers");
        let (drivers, joints) = joints.split_once("[joints]").expect("it has joints");
        parse(&format!(
            "format = 1\nname = \"slides\"\n[ground.markers]\nO = [0, 0]\nW = [0, 0, \"90*deg\"]\n\
             {before}\n[bodies.s.markers]\nB = [0, 0]\n[bodies.u.markers]\nC = [0, 0]\n\
             [joints]\n{joints}\n\
             w = {{ type = \"translational\", markers = [\"ground.O\", \"s.B\"] }}\n\
             w2 = {{ type = \"translational\", markers = [\"ground.W\", \"u.C\"] }}\n\
             c = {{ type = \"revolute_translational\", markers = [\"s.B\", \"u.C\"], \
             offset = \"{off}\" }}\n[drivers]\n{drivers}\n\
             e = {{ coordinate = \"x\", markers = [\"ground.O\", \"s.B\"], start = 0.01 }}\n"
        ))
    };
    let pairs = ["0.1 + 0.2 - 0.3", "0"].map(|off| {
        let [a, b, c, d] = [alone, &crank, &short, &tiny].map(|beside| slides(beside, off));
        [gears(off), a, b, c, d].map(|file| assembled(&file).0.rcond())
    });
    assert_eq!(pairs[0].map(f64::to_bits), pairs[1].map(f64::to_bits));
}
