//! Redundancies that end on the way: with a parameter, or with the pose.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{Error, Reason};
use biela::mechanism::Mechanism;

use crate::common::{assembled, parse, straight_to};
use crate::redundancy::mechanisms::{angle_driver, body, file, joint, parallelogram, with_joints};

/// A rod beside the coupler that may have another length.
fn with_rod() -> Arc<Mechanism> {
    let text = with_joints(
        &parallelogram(&[], 60.0, true),
        "rod = { type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = \"rod_length\" }",
    );
    parse(&text.replace(
        "[ground.markers]",
        "[parameters]\nrod_length = 0.4\n[ground.markers]",
    ))
}

#[test]
fn a_parameter_that_ends_a_redundancy_is_refused() {
    let mechanism = with_rod();
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    path.from = vec![0.4];
    path.to = vec![0.41];
    let blocked = solver.track(&path).expect_err("the rod is too long");
    let Reason::Contradiction(open) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(open.origin, "joint `rod`");
    // The gap is that of the first attempt, over all of the path.
    assert!((open.gap - 0.01).abs() < 1e-12, "{open}");
    // A gap of a thousand millionth of the size counts as one.
    let reached = solver.pose().parameters[0] - 0.4;
    assert!((0.0..1e-9).contains(&reached), "{reached:e}");
    let error = solver.assemble(&path).expect_err("nor can it be assembled");
    let Error::Contradiction { origins, open, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(origins[..], ["joint `A`", "joint `B`", "joint `rod`"]);
    assert_eq!(open.to_string(), "joint `rod` stays open by 10.00 mm");
    // Nothing is lost.
    solver.restore(&home);
    assert!(solver.residual() < 4.0 * f64::EPSILON);
    path.to = vec![0.4];
    straight_to(&solver, &mut path, 2.0);
    solver.track(&path).expect("it moves as before");
    assert!(solver.residual() < 8.0 * f64::EPSILON);
}

/// A follower held at the height of a cam that is round for anyone who measures, until it has
/// turned on to its lobe.
#[test]
fn a_redundancy_that_ends_on_the_way_stops_the_mechanism_there() {
    let bodies = body("cam", "O = [0, 0]", "0, 0, \"90*deg\"")
        + &body("follower", "P = [0, 0, \"90*deg\"]", "0, 0.05, 0");
    let joints = joint("O", "revolute", "ground.O", "cam.O")
        + &joint("guide", "translational", "ground.up", "follower.P")
        + "contact = { type = \"cam\", markers = [\"cam.O\", \"follower.P\"], follower = \"knife\", \
           profile = \"0.05 + 0.01*sin(theta/2)^40\" }\n\
           [constraints]\n\
           level = { coordinate = \"y\", markers = [\"ground.O\", \"follower.P\"], value = 0.05 }\n";
    let driver = angle_driver("turn", "ground.O", "cam.O", 90.0);
    let ground = "O = [0, 0]\nup = [0, 0, \"90*deg\"]";
    let text = file(ground, &bodies, &joints, &driver);
    let (mut solver, mut path) = assembled(&parse(&text));
    assert_eq!(solver.redundancies()[0].origin, "constraint `level`");
    // The contact is at theta = 90° − u.
    straight_to(&solver, &mut path, -TAU / 12.0);
    let blocked = solver.track(&path).expect_err("the lobe begins on the way");
    let Reason::Contradiction(open) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(open.origin, "constraint `level`");
    // A gap is a thousand millionth of the size, 0.05 m; its rounding is a thousandth of that.
    let theta = 2.0 * (1e-9_f64 * 0.05 / 0.01).powf(1.0 / 40.0).asin();
    let reached = solver.pose().drivers[0];
    assert!((TAU / 4.0 - reached - theta).abs() < 1e-3, "{reached}");
    // The message names the joint that was found open beyond.
    assert!(open.gap > 5e-11, "{open}");
}

/// A follower held on the round part of a cam whose lobe, 5 mm high, passes under it: whatever the
/// steps, the mechanism stops where the lobe begins, and without a lobe it turns in few sub-steps;
/// also while a parameter moves, of which the cam knows nothing.
#[test]
fn a_lobe_between_two_steps_is_found() {
    let cam = |lobe: &str| {
        let bodies =
            body("cam", "O = [0, 0]", "0, 0, 0") + &body("follower", "P = [0, 0]", "0, 0.05, 0");
        let joints = joint("O", "revolute", "ground.O", "cam.O")
            + &joint("hold", "weld", "ground.H", "follower.P")
            + &format!(
                "contact = {{ type = \"cam\", markers = [\"cam.O\", \"follower.P\"], \
                 follower = \"knife\", \
                 profile = \"0.05{lobe}\" }}\n"
            );
        let driver = angle_driver("u", "ground.O", "cam.O", 0.0);
        let ground = "O = [0, 0]\nH = [0, 0.05]\nK = [\"far\", 0]";
        parse(&file(ground, &bodies, &joints, &driver).replace(
            "[ground.markers]",
            "[parameters]\nfar = { value = 1, tunable = true }\n[ground.markers]",
        ))
    };
    // The contact is at theta = 90° − u. A gap is a thousand millionth of the size, 0.05 m.
    let open = (1e-9_f64 * 0.05 / 5.0).cbrt();
    let begins = TAU / 4.0 - (0.9 + open).acos();
    for (steps, moves) in [1, 2, 3, 4, 100]
        .into_iter()
        .flat_map(|n| [(n, 0.0), (n, 0.01)])
    {
        let (mut solver, mut path) = assembled(&cam(" + 5*max(0, cos(theta) - 0.9)^3"));
        assert_eq!(solver.redundancies()[0].origin, "joint `contact`");
        let blocked = (1..=steps).find_map(|step| {
            straight_to(&solver, &mut path, TAU * f64::from(step) / f64::from(steps));
            path.from.clone_from(&solver.pose().parameters);
            path.to[0] = path.from[0] + moves;
            solver.track(&path).err()
        });
        let blocked = blocked.expect("the lobe is on the way");
        let Reason::Contradiction(open) = &blocked.reason else {
            panic!("{steps}: {blocked:?}");
        };
        assert_eq!(open.origin, "joint `contact`");
        let reached = solver.pose().drivers[0];
        assert!((reached - begins).abs() < 1e-3, "{steps}: {reached}");
    }
    for moves in [0.0, 0.01] {
        let (mut solver, mut path) = assembled(&cam(""));
        straight_to(&solver, &mut path, TAU);
        path.to[0] += moves;
        let progress = solver.track(&path).expect("it is round");
        assert!(progress.substeps < 20, "{progress:?}");
        assert_eq!(progress.checked, 0, "{progress:?}");
    }
}
