//! Redundant mechanisms move like their twins without what is redundant.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{Rates, Solver};
use biela::mechanism::{Jet, Mechanism};
use proptest::prelude::*;

use crate::common::{assembled, parse, shipped, stems, straight_to};
use crate::mechanisms::{
    belt, cam_touched_twice, crank_angle, double, four_bar, joint, slider_crank, wheels,
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
        (double(&four_bar(), "A"), four_bar(), 60.0),
        (double(&four_bar(), "O4"), four_bar(), 60.0),
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
        if !names.is_empty() && !text.contains("file = ") {
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
        prop_assert_eq!(&redundancies[0].element, &format!("joint `{joint}_again`"));
        prop_assert_eq!(redundancies[0].redundant, redundancies[0].equations);
        let twin = shipped(name);
        if twin.drivers.first().is_some_and(|driver| driver.motion().is_none()) {
            let values: Vec<_> = (1..=10).map(|k| start + 0.004 * f64::from(k)).collect();
            compare(&doubled, &twin, &values, &format!("{name}, {joint}"));
        }
    }
}
