//! Redundant mechanisms move like their twins without what is redundant.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{Rates, Solver};
use biela::mechanism::{Jet, Mechanism};
use proptest::prelude::*;

use crate::common::{assembled, parse, shipped, stems, straight_to, text};
use crate::redundancy::mechanisms::{
    angle_driver, belt, body, cam_touched_twice, crank_angle, double, file, joint, slider_crank,
    wheels,
};

/// q and its rates of the bodies of `twin`, as `solver` has them: body by body, by name.
fn motion_of(solver: &mut Solver, twin: &Mechanism) -> [Vec<f64>; 3] {
    let mut rates = Rates::new(solver.pose().q.len());
    let unit = |_| Jet::new(0.0, [1.0, 0.5]);
    solver
        .solve_rates(unit, &mut rates)
        .expect("the pose is regular");
    let places: Vec<_> = twin
        .bodies
        .iter()
        .map(|body| {
            solver
                .mechanism()
                .body_id(&body.name)
                .expect("both have it")
        })
        .flat_map(|body| (0..3).map(move |k| 3 * body.index() + k))
        .collect();
    let of = |all: &[f64]| places.iter().map(|&place| all[place]).collect();
    [
        of(&solver.pose().q),
        of(rates.velocity()),
        of(rates.acceleration()),
    ]
}

/// Moves both along the first driver's values and compares: q, velocity and acceleration, each
/// once more amplified by the condition.
fn compare(redundant: &Arc<Mechanism>, twin: &Arc<Mechanism>, values: &[f64], what: &str) {
    let (mut solver, mut path) = assembled(redundant);
    let (mut other, mut other_path) = assembled(twin);
    assert!(!solver.redundancies().is_empty(), "{what}");
    assert!(other.redundancies().is_empty(), "{what}");
    for &value in values {
        straight_to(&solver, &mut path, value);
        straight_to(&other, &mut other_path, value);
        let moved = (
            solver.track(&path).is_ok(),
            other.track(&other_path).is_ok(),
        );
        assert_eq!(moved.0, moved.1, "{what} at {value}");
        if !moved.0 {
            return;
        }
        let rcond = other.rcond();
        assert!(solver.residual() < 1e-9, "{what} at {value}");
        let found = motion_of(&mut solver, twin);
        let expected = motion_of(&mut other, twin);
        for (order, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let size = expected.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            let rounding = 100.0 * f64::EPSILON * size / rcond.powi(order as i32 + 1).min(1.0);
            for (a, b) in found.iter().zip(expected) {
                assert!(
                    (a - b).abs() <= rounding,
                    "{what} at {value}, order {order}: {a} {b}"
                );
            }
        }
    }
}

fn turn_from(start: f64) -> Vec<f64> {
    (1..=36)
        .map(|k| start.to_radians() + f64::from(k) * TAU / 36.0)
        .collect()
}

#[test]
fn redundant_mechanisms_move_like_their_twins() {
    let again = joint("again", "translational", "ground.guide_2", "slider.front");
    let guided = slider_crank("", "", &crank_angle());
    let pairs = [
        (
            slider_crank("", &again, &crank_angle()),
            guided.clone(),
            65.0,
        ),
        (slider_crank(&again, "", &crank_angle()), guided, 65.0),
        (
            double(&text("mechanisms/four_bar.toml"), "A"),
            text("mechanisms/four_bar.toml"),
            60.0,
        ),
        (
            double(&text("mechanisms/four_bar.toml"), "O4"),
            text("mechanisms/four_bar.toml"),
            60.0,
        ),
        (wheels(&belt(false)), wheels(""), 40.0),
    ];
    for (k, (redundant, twin, start)) in pairs.iter().enumerate() {
        compare(
            &parse(redundant),
            &parse(twin),
            &turn_from(*start),
            &format!("pair {k}"),
        );
    }
    compare(
        &parse(&cam_touched_twice()),
        &shipped("cam_roller"),
        &turn_from(60.0),
        "cam",
    );
}

/// The shipped mechanisms whose joints are each on one line, with the names of these.
fn joints_on_lines() -> Vec<(String, Vec<String>)> {
    let mut found = Vec::new();
    for name in stems("mechanisms", "toml") {
        let text =
            std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped");
        let (_, rest) = text.split_once("[joints]").expect("it has joints");
        let (joints, _) = rest.split_once("\n[").expect("it has drivers");
        let lines = joints.lines().filter(|line| line.contains("= {"));
        let names: Vec<_> = lines
            .filter_map(|line| line.split_once('='))
            .map(|(key, _)| key.trim().to_owned())
            .collect();
        // A mechanism with a table in a file beside it is read from its place only.
        if !names.is_empty() && !text.contains(".csv\"") {
            found.push((name, names));
        }
    }
    assert!(found.len() > 20, "{found:?}");
    found
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// A joint declared twice changes nothing, and the second one is named.
    #[test]
    fn a_doubled_joint_changes_nothing(which in 0..1000_usize, joint in 0..1000_usize) {
        let all = joints_on_lines();
        let (name, joints) = &all[which % all.len()];
        let joint = &joints[joint % joints.len()];
        let text = std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped");
        let doubled = parse(&double(&text, joint));
        let (solver, _) = assembled(&doubled);
        let start = solver.pose().drivers.first().copied().unwrap_or(0.0);
        let redundancies = solver.redundancies();
        prop_assert_eq!(redundancies.len(), 1);
        prop_assert_eq!(&redundancies[0].origin, &format!("joint `{joint}_again`"));
        prop_assert_eq!(redundancies[0].redundant, redundancies[0].equations);
        let twin = shipped(name);
        if twin.drivers.first().is_some_and(|driver| driver.motion().is_none()) {
            let values: Vec<_> = (1..=10).map(|k| start + 0.004 * f64::from(k)).collect();
            compare(&doubled, &twin, &values, &format!("{name}, {joint}"));
        }
    }
}

/// Two equal slider-cranks on one slider, their crank pins joined, a little behind the dead point
/// at which their rods stand across the guide. In front of it and behind it rows that are solved
/// have change points of their own, which do not lie on the motion. Estimates on the motion are
/// kept, and the rods follow their closed form.
#[test]
fn change_points_beside_the_motion_do_not_change_its_branch() {
    let (crank, rod, guide) = (
        0.1822878341055163,
        0.2416238362936942,
        -0.19604062948997458_f64,
    );
    let apart = [-0.07406675841431998, -0.27266683966719363_f64];
    let (sin, cos) = guide.sin_cos();
    for (start, lean) in [
        (-0.3025934090933178_f64, -1.6866342929612108_f64),
        (-0.31, -1.62),
    ] {
        let pin = [crank * start.cos(), crank * start.sin()];
        let foot = [pin[0] + rod * lean.cos(), pin[1] + rod * lean.sin()];
        let own = [
            cos * apart[0] + sin * apart[1],
            cos * apart[1] - sin * apart[0],
        ];
        let ground = format!(
            "G = [{:?}, {:?}, {guide:?}]\nO0 = [0, 0]\nO1 = {apart:?}",
            foot[0], foot[1]
        );
        let bar = |name: &str, length: f64, [x, y]: [f64; 2], phi: f64| {
            let markers = format!("a = [0, 0], b = [{length:?}, 0]");
            body(name, &markers, &format!("{x:?}, {y:?}, {phi:?}"))
        };
        let there = |[x, y]: [f64; 2]| [x + apart[0], y + apart[1]];
        let bodies = bar(
            "link",
            apart[0].hypot(apart[1]),
            pin,
            apart[1].atan2(apart[0]),
        ) + &body(
            "slider",
            &format!("m0 = [0, 0], m1 = {own:?}"),
            &format!("{:?}, {:?}, {guide:?}", foot[0], foot[1]),
        ) + &bar("rod1", rod, there(pin), lean)
            + &bar("crank1", crank, apart, start)
            + &bar("rod0", rod, pin, lean)
            + &bar("crank0", crank, [0.0; 2], start);
        let pin_of = |name: &str, from: &str, to: &str| joint(name, "revolute", from, to);
        let joints = pin_of("L1", "link.b", "crank1.b")
            + &pin_of("L0", "link.a", "crank0.b")
            + &joint("G", "translational", "ground.G", "slider.m0")
            + &pin_of("B1", "slider.m1", "rod1.b")
            + &pin_of("A1", "rod1.a", "crank1.b")
            + &pin_of("O1", "crank1.a", "ground.O1")
            + &pin_of("B0", "slider.m0", "rod0.b")
            + &pin_of("A0", "rod0.a", "crank0.b")
            + &pin_of("O0", "crank0.a", "ground.O0");
        let degrees = start.to_degrees();
        let driver = angle_driver("u", "ground.O0", "crank0.a", degrees);
        let mechanism = parse(&file(&ground, &bodies, &joints, &driver));
        let (mut solver, mut path) = assembled(&mechanism);
        for phi in [start, -0.35, -0.569, -0.35, start] {
            straight_to(&solver, &mut path, phi);
            solver.track(&path).expect("no dead point is on the way");
            // The rod spans the height of its pin above the guide.
            let from = [crank * phi.cos() - foot[0], crank * phi.sin() - foot[1]];
            let height = cos * from[1] - sin * from[0];
            let exact = guide - (height / rod).asin();
            for name in ["rod0", "rod1"] {
                let body = mechanism.body_id(name).expect("it has it").index();
                let off = solver.pose().q[3 * body + 2] - exact;
                assert!(off.abs() < 1e-9, "{start}: {name} at {phi}: {off}");
            }
        }
    }
}
