//! Three cranks and more on one coupler, turned through the poses where they are flat.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{End, RangeSettings, SingularKind};
use biela::mechanism::{DriverId, Mechanism};

use crate::common::{assembled, moved, parse, straight_to};
use crate::redundancy::mechanisms::{angle_driver, body, double, file, joint, parallelogram};

/// Cranks that all turn alike, their pins not in one line: regular at every angle, the flat ones
/// included, for who may choose among the equations.
#[test]
fn three_cranks_turn_through_their_flat_poses() {
    turn_three_cranks(&[(10, 100), (100, 20), (1000, 2)]);
}

/// The same for longer.
#[test]
#[ignore = "takes a minute without optimisation"]
fn three_cranks_turn_a_hundred_times() {
    turn_three_cranks(&[(10, 100), (100, 100), (1000, 100)]);
}

/// Turns them with so many steps a turn, for so many turns.
fn turn_three_cranks(runs: &[(u32, u32)]) {
    let mechanism = parse(&parallelogram(&[[0.2, 0.1]], 60.0, true));
    let phi = |name: &str| 3 * mechanism.body_id(name).expect("it has it").index() + 2;
    let phi = ["crank", "rocker", "crank_5", "coupler"].map(phi);
    for &(steps, turns) in runs {
        let (mut solver, mut path) = assembled(&mechanism);
        for step in 1..=turns * steps {
            let angle = TAU / 6.0 + TAU * f64::from(step) / f64::from(steps);
            straight_to(&solver, &mut path, angle);
            let progress = solver
                .track(&path)
                .unwrap_or_else(|blocked| panic!("{blocked:?}"));
            assert!(progress.substeps < 30, "{step} of {steps}: {progress:?}");
            let q = &solver.pose().q;
            // Rows that are not quite fit are kept: some digits are lost, three at the most.
            let rounding = 1e3 * f64::EPSILON * angle.max(1.0);
            for &phi in &phi[..3] {
                assert!(
                    (q[phi] - angle).abs() < rounding,
                    "{step} of {steps}: {}",
                    q[phi] - angle
                );
            }
            assert!(q[phi[3]].abs() < rounding, "{step} of {steps}");
        }
    }
}

/// The same while the cranks become longer: rows near dependence are left in time, however the
/// sub-steps come to lie.
#[test]
fn three_cranks_of_moving_length_turn_through_their_flat_poses() {
    let text = parallelogram(&[[0.2, 0.1]], 60.0, true)
        .replace("[0.1, 0]", "['r', 0]")
        .replace(
            "[ground.markers]",
            "[parameters]\nr = { value = 0.1, tunable = true }\n[ground.markers]",
        );
    let mechanism = parse(&text);
    let phi = |name: &str| 3 * mechanism.body_id(name).expect("it has it").index() + 2;
    let phi = ["crank", "rocker", "crank_5", "coupler"].map(phi);
    let start = TAU / 6.0;
    for turn in [-4.0, -3.4, -2.7, -1.9, 2.2, 2.9, 3.5, 4.1] {
        for length in [0.07, 0.085, 0.12, 0.16] {
            let (mut solver, mut path) = assembled(&mechanism);
            for (angle, length) in [(start + turn, length), (start, 0.1)] {
                straight_to(&solver, &mut path, angle);
                path.from.clone_from(&solver.pose().parameters);
                path.to[0] = length;
                let progress = solver
                    .track(&path)
                    .unwrap_or_else(|blocked| panic!("{turn}, {length}: {blocked:?}"));
                assert!(progress.substeps < 500, "{turn}, {length}: {progress:?}");
                let q = &solver.pose().q;
                // As above.
                let rounding = 1e3 * f64::EPSILON * angle.abs().max(1.0);
                for &phi in &phi[..3] {
                    assert!((q[phi] - angle).abs() < rounding, "{turn}, {length}");
                }
                assert!(q[phi[3]].abs() < rounding, "{turn}, {length}");
            }
        }
    }
}

/// With their pins in line cranks laid flat lose rank whatever rows are chosen: change points that
/// are crossed part by part, each part reading the crossing of the one before.
#[test]
fn cranks_in_line_cross_their_change_points() {
    for more in [
        &[[0.2, 0.0]][..],
        &[[0.05, 0.0]],
        &[[0.37, 0.0]],
        &[[-0.3, 0.0]],
        &[[0.8, 0.0]],
        &[[0.1, 0.0], [0.3, 0.0]],
    ] {
        let text = parallelogram(more, 60.0, true);
        // Driven at each crank in turn.
        let cranks = (5..5 + more.len()).map(|k| (format!("O{k}"), format!("crank_{k}")));
        let cranks = [("O2", "crank"), ("O4", "rocker")]
            .map(|(pivot, crank)| (pivot.to_owned(), crank.to_owned()))
            .into_iter()
            .chain(cranks);
        for (pivot, crank) in cranks {
            let text = text.replace(
                "[\"ground.O2\", \"crank.O\"], start",
                &format!("[\"ground.{pivot}\", \"{crank}.O\"], start"),
            );
            let mechanism = parse(&text);
            for tilt in [0.0, 0.3, 1.1, -2.0] {
                cross_change_points(
                    &format!("{more:?}, {crank} driven, at {tilt}"),
                    &moved(&mechanism, tilt, [0.0; 2]),
                    tilt,
                );
            }
        }
    }
}

/// Turns cranks in line, on ground that is tilted, through their change points.
fn cross_change_points(name: &str, mechanism: &Arc<Mechanism>, tilt: f64) {
    let turning = mechanism.bodies.iter().enumerate();
    let turning: Vec<_> = turning
        .filter(|(_, body)| body.name != "coupler")
        .map(|(place, _)| 3 * place + 2)
        .collect();
    for steps in [7, 30] {
        let (mut solver, mut path) = assembled(mechanism);
        for step in 1..=2 * steps {
            let angle = TAU / 6.0 + TAU * f64::from(step) / f64::from(steps);
            straight_to(&solver, &mut path, angle);
            solver
                .track(&path)
                .unwrap_or_else(|blocked| panic!("{name}, {step} of {steps}: {blocked:?}"));
            for &phi in &turning {
                // As what is interpolated next to a change point.
                let off = solver.pose().q[phi] - tilt - angle;
                assert!(off.abs() < 1e-9, "{name}, {step} of {steps}: {off:e}");
            }
        }
    }
}

/// A change point is one for all rows: redundant ones elsewhere do not keep the mechanism from
/// crossing it.
#[test]
fn a_parallelogram_with_a_doubled_pin_crosses_its_change_points() {
    let text = double(&parallelogram(&[], 60.0, true), "A");
    let (mut solver, mut path) = assembled(&parse(&text));
    let rocker = solver.mechanism().body_id("rocker").expect("it has one");
    for step in 1..=72 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step);
        straight_to(&solver, &mut path, angle);
        solver
            .track(&path)
            .unwrap_or_else(|blocked| panic!("{step}: {blocked:?}"));
        // The change points are known to 1e-9, as is what is said next to them.
        let off = solver.pose().q[3 * rocker.index() + 2] - angle;
        assert!(off.abs() < 1e-9, "{step}: {off:e}");
    }
}

/// Three cranks that carry a platform on two links, a third link holding it to ground. In front of
/// its dead points the rows in use and those that would take their place are about equally fit:
/// rows are not changed to and fro.
#[test]
fn rows_are_not_changed_in_a_circle() {
    let bodies = body(
        "crank",
        "O = [0.3, 0], A = [0.5, 0]",
        "0.12678547852220975, 0.271892336110995, \"245*deg\"",
    ) + &body(
        "coupler",
        "A = [0, 0], M = [0.175, 0.1], B = [0.35, 0]",
        "-0.08452365234813984, -0.18126155740733002, 0",
    ) + &body(
        "rocker",
        "D = [0.3, 0], B = [0.5, 0], Q0 = [0.08640211966479111, -0.03147478299566531], \
         Q1 = [-0.27163850684161556, -0.13613147428623618]",
        "0.47678547852220976, 0.271892336110995, \"245*deg\"",
    ) + &body(
        "third",
        "E = [0.3, 0], M = [0.5, 0]",
        "0.3017854785222097, 0.37189233611099504, \"245*deg\"",
    ) + &body(
        "P",
        "B0 = [-0.39123830755458666, 0.3998185003560202], \
         B1 = [0.010115980928676382, -0.2909090074482299], \
         B2 = [0.10564864003401653, 0.3170396683778869]",
        "-0.7666910263851403, -0.7714167666755275, -2.121229557603924",
    );
    let link = |name: &str, from: &str, to: &str, length: f64| {
        joint(name, "link", from, to).replace(" }\n", &format!(", length = {length:?} }}\n"))
    };
    let joints = joint("O", "revolute", "ground.O", "crank.O")
        + &joint("A", "revolute", "crank.A", "coupler.A")
        + &joint("B", "revolute", "coupler.B", "rocker.B")
        + &joint("D", "revolute", "ground.D", "rocker.D")
        + &joint("E", "revolute", "ground.E", "third.E")
        + &joint("M", "revolute", "coupler.M", "third.M")
        + &link("L0", "rocker.Q0", "P.B0", 1.0630195453778877)
        + &link("L1", "rocker.Q1", "P.B1", 1.9138756600487161)
        + &link("L2", "ground.A2", "P.B2", 0.5635681005723489);
    let ground = "O = [0, 0]\nE = [0.175, 0.1]\nD = [0.35, 0]\n\
                  A2 = [-0.15816264158184823, -0.6239213904973742]";
    let driver = angle_driver("u", "ground.O", "crank.O", 245.0);
    let text = file(ground, &bodies, &joints, &driver);
    let (mut solver, _) = assembled(&parse(&text));
    // The density of samples decides where rows are changed.
    let mut range = |samples: u32| {
        let settings = RangeSettings {
            samples,
            ..RangeSettings::default()
        };
        let range = solver.range(DriverId(0), &settings);
        [range.lower, range.upper].map(|end| match end {
            End::Singular(point) => {
                assert_eq!(point.kind, SingularKind::DeadPoint);
                // Two links from the rocker and one from ground hold the plate.
                let links = ["joint `L0`", "joint `L1`", "joint `L2`"];
                assert_eq!(point.bodies, links, "{}", point.geometry);
                assert!(
                    point.geometry.ends_with("meet in one point"),
                    "{}",
                    point.geometry
                );
                point.drivers[0]
            }
            end => panic!("{end:?}"),
        })
    };
    let (coarse, fine) = (range(120), range(360));
    for (coarse, fine) in coarse.iter().zip(fine) {
        assert!((coarse - fine).abs() < 1e-9, "{coarse} {fine}");
    }
}

/// Three cranks on one coupler with the pivots `far` and `middle` beside the origin, of a length at
/// a scale, estimated at the angle `start`.
fn tilted_cranks(crank: f64, [far, middle]: [[f64; 2]; 2], start: f64, scale: f64) -> String {
    let tilt = far[1].atan2(far[0]);
    let place = |[x, y]: [f64; 2], phi: f64| format!("{:?}, {:?}, {phi:?}", x * scale, y * scale);
    // A pivot seen from the coupler, whose origin and ends move as those of the base.
    let own = |[x, y]: [f64; 2]| {
        let (sin, cos) = tilt.sin_cos();
        place([x * cos + y * sin, y * cos - x * sin], 0.0)
    };
    let bar = format!("O = [0, 0], A = [{:?}, 0]", crank * scale);
    let pivots = [("first", [0.0; 2]), ("second", far), ("third", middle)];
    let mut bodies = pivots
        .map(|(name, at)| body(name, &bar, &place(at, start)))
        .concat();
    let pin = [crank * start.cos(), crank * start.sin()];
    bodies += &body(
        "coupler",
        &pivots
            .map(|(name, at)| format!("{name} = [{}]", own(at)))
            .join(", "),
        &place(pin, tilt),
    );
    let ground = pivots
        .map(|(name, at)| format!("{name} = [{}]\n", place(at, 0.0)))
        .concat();
    let joints = pivots.map(|(name, _)| {
        let [pivot, pin] = ["pivot", "pin"].map(|end| format!("{name}_{end}"));
        let [own, tip] = ["O", "A"].map(|marker| format!("{name}.{marker}"));
        joint(&pivot, "revolute", &format!("ground.{name}"), &own)
            + &joint(&pin, "revolute", &tip, &format!("coupler.{name}"))
    });
    let driver = angle_driver("u", "ground.first", "first.O", start.to_degrees());
    file(&ground, &bodies, &joints.concat(), &driver)
}

/// The unit of length changes the rounding and nothing else: a jump past the places where the rows
/// in use depend on each other takes as many sub-steps, to a factor of two.
#[test]
fn other_units_cost_no_sub_steps_past_flat_poses() {
    let cases = [
        (
            0.176_823_765,
            [
                [0.457_402_373, -0.078_595_081],
                [0.309_638_340, -0.082_902_434],
            ],
            -2.619_051_322,
            -5.685_153_720,
        ),
        (
            0.186_098_948,
            [
                [0.456_036_913, 0.076_380_719],
                [0.422_821_724, -0.016_877_750],
            ],
            -0.288_171_431,
            0.732_537_141,
        ),
        (
            0.141_755_900,
            [
                [0.432_901_334, 0.058_785_801],
                [0.102_899_748, 0.196_118_374],
            ],
            -0.123_921_424,
            3.253_684_474,
        ),
    ];
    for (crank, pivots, start, target) in cases {
        let substeps = [1e-3, 0.0254, 0.3048, 1.0, 1e3].map(|scale| {
            let mechanism = parse(&tilted_cranks(crank, pivots, start, scale));
            let (mut solver, mut path) = assembled(&mechanism);
            straight_to(&solver, &mut path, target);
            let progress = solver.track(&path).expect("the cranks turn");
            for pivot in ["second", "third"] {
                let phi = 3 * mechanism.body_id(pivot).expect("it has it").index() + 2;
                // As what is interpolated next to a change point.
                assert!((solver.pose().q[phi] - target).abs() < 1e-9, "{pivot}");
            }
            progress.substeps
        });
        let [fewest, most] = [substeps.iter().min(), substeps.iter().max()];
        let (Some(fewest), Some(most)) = (fewest, most) else {
            unreachable!("there are scales");
        };
        assert!(most <= &(2 * fewest), "{substeps:?}");
    }
}
