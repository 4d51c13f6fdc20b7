//! Dead points are located, change points are crossed on the smooth motion.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use biela::kinematics::{Path, Rates, Reason, SingularKind, Solver};
use biela::mechanism::{Jet, Mechanism};
use proptest::prelude::*;

use crate::common::exact::{Errors, Exact};
use crate::common::mechanisms::four_bar_at;
use crate::common::{assembled, parse, shipped, straight_to};

/// The parallelogram as shipped, and crossed: B is mirrored in the line from A to O4, so that the
/// coupler turns by twice the angle of that line.
const PARALLEL: Exact = Exact {
    file: "parallelogram",
    bodies: &[
        ("crank", ["0", "0", "t"]),
        (
            "coupler",
            ["crank_length*cos(t)", "crank_length*sin(t)", "0"],
        ),
        ("follower", ["base", "0", "t"]),
    ],
    formulas: &[],
    range: (0.0, 0.0),
};
const CROSSED: Exact = Exact {
    file: "parallelogram",
    bodies: &[
        ("crank", ["0", "0", "t"]),
        (
            "coupler",
            ["crank_length*cos(t)", "crank_length*sin(t)", "{coupler}"],
        ),
        ("follower", ["base", "0", "{coupler} - t"]),
    ],
    formulas: &[(
        "coupler",
        "2*atan2(-crank_length*sin(t), base - crank_length*cos(t))",
    )],
    range: (0.0, 0.0),
};

/// The crossed parallelogram: the same file with other estimates.
fn crossed() -> Arc<Mechanism> {
    let text = std::fs::read_to_string("mechanisms/parallelogram.toml")
        .expect("it is shipped")
        .replace(
            "estimate = [0.05, 0.09, 0]",
            "estimate = [0.05, 0.09, \"-60*deg\"]",
        )
        .replace(
            "estimate = [\"base\", 0, \"60*deg\"]",
            "estimate = [\"base\", 0, \"-120*deg\"]",
        );
    parse(&text)
}

/// Largest errors of position, velocity and acceleration over a number of turns of `steps` steps,
/// and the change points passed.
fn turn(
    mechanism: &Arc<Mechanism>,
    exact: &Exact,
    turns: u32,
    steps: u32,
    offset: f64,
) -> ([f64; 3], u32) {
    let (mut solver, mut path) = assembled(mechanism);
    let mut rates = Rates::new(solver.pose().q.len());
    let start = PI / 3.0;
    let mut worst = [0.0; 3];
    let mut crossings = 0;
    let (u, v) = (1.0, 0.3);
    for step in 1..=turns * steps {
        let angle = start + offset + TAU * f64::from(step) / f64::from(steps);
        straight_to(&solver, &mut path, angle);
        let progress = solver
            .track(&path)
            .unwrap_or_else(|blocked| panic!("{} at {angle}: {blocked:?}", exact.file));
        crossings += progress.crossings;
        let driver = Jet::new(angle, [u, v]);
        solver
            .solve_rates(|_| driver, &mut rates)
            .expect("rates exist on the smooth motion");
        for (k, truth) in exact.solution(mechanism, driver).iter().enumerate() {
            let found = [
                solver.pose().q[k],
                rates.velocity()[k],
                rates.acceleration()[k],
            ];
            let truth = [truth.value, truth.first(), truth.second()];
            for order in 0..3 {
                worst[order] = f64::max(worst[order], (found[order] - truth[order]).abs());
            }
        }
    }
    (worst, crossings)
}

/// Closer than the 1e-9, 1e-7 and 1e-5 that are asked for next to a change point.
fn assert_right([position, velocity, acceleration]: [f64; 3]) {
    assert!(
        position < 1e-11 && velocity < 1e-9 && acceleration < 1e-6,
        "{position:e} {velocity:e} {acceleration:e}"
    );
}

#[test]
fn a_parallelogram_turns_through_its_change_points() {
    for (mechanism, exact) in [(shipped("parallelogram"), PARALLEL), (crossed(), CROSSED)] {
        for (turns, steps) in [(20, 10), (5, 100), (1, 10_000)] {
            let (worst, crossings) = turn(&mechanism, &exact, turns, steps, 0.0);
            assert_eq!(crossings, 2 * turns);
            assert_right(worst);
        }
    }
}

/// Stops at every distance from a change point: position, velocity and acceleration are those of
/// the smooth motion, and saved poses lead on as before.
#[test]
fn outputs_next_to_a_change_point_are_those_of_the_motion() {
    for (mechanism, exact) in [(shipped("parallelogram"), PARALLEL), (crossed(), CROSSED)] {
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(solver.pose().q.len());
        let mut targets = vec![PI, 0.0, PI];
        for exponent in 1..16 {
            let off = 10_f64.powi(-exponent);
            targets.extend([PI - off, PI + off, PI - off, -off, off]);
        }
        for target in targets {
            straight_to(&solver, &mut path, target);
            solver.track(&path).expect("the crank turns fully");
            let driver = Jet::new(target, [1.0, -0.7]);
            let pose = solver.pose().clone();
            for restored in [false, true] {
                if restored {
                    solver.restore(&pose);
                }
                solver
                    .solve_rates(|_| driver, &mut rates)
                    .expect("rates exist on the smooth motion");
                let mut errors = Errors::default();
                errors.collect(&solver, &rates, &exact.solution(&mechanism, driver));
                assert_right(errors.error);
            }
            // Honest: the Jacobian is what it is.
            let distance = (target - (target / PI).round() * PI).abs();
            let rcond = solver.rcond();
            assert!(rcond <= 2.0 * distance + 1e-13, "{rcond} {distance}");
        }
    }
}

/// Assembled next to a change point, as its estimates say; at the point itself no estimate tells
/// which motion is meant.
#[test]
fn a_mechanism_starts_next_to_a_change_point_but_not_on_it() {
    let text = std::fs::read_to_string("mechanisms/parallelogram.toml").expect("it is shipped");
    let at = |degrees: f64| {
        let mechanism = parse(&text.replace("60*deg", &format!("{degrees:?}*deg")));
        let path = Path::new(&mechanism);
        let mut solver = Solver::new(Arc::clone(&mechanism)).expect("the drivers match");
        solver.assemble(&path).map(|_| (solver, mechanism))
    };
    for off in [1.0, 1e-1, 1e-2] {
        let (mut solver, mechanism) = at(180.0 - off).expect("it closes");
        let mut rates = Rates::new(solver.pose().q.len());
        let driver = Jet::new(solver.pose().drivers[0], [1.0, -0.7]);
        solver
            .solve_rates(|_| driver, &mut rates)
            .expect("it moves");
        let mut errors = Errors::default();
        errors.collect(&solver, &rates, &PARALLEL.solution(&mechanism, driver));
        assert_right(errors.error);
    }
    let error = at(180.0).expect_err("it may go on either way");
    assert!(
        matches!(error, biela::kinematics::Error::Singular { .. }),
        "{error}"
    );
    assert!(error.to_string().contains("change point"), "{error}");
    // A start a little aside is offered, one at which it has just been assembled the other way.
    let mechanism = parse(&text.replace("60*deg", "180*deg"));
    let offered = biela::kinematics::offer_start(error, &mechanism).to_string();
    let aside = "start a little aside, such as with driver `crank_angle` at 181 deg";
    assert!(offered.ends_with(aside), "{offered}");
    at(181.0).expect("it closes");
}

#[test]
fn a_pose_next_to_a_change_point_leads_on_with_the_same_bits() {
    let mechanism = crossed();
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, PI - 0.001);
    solver.track(&path).expect("nothing is in the way");
    let pose = solver.pose().clone();
    assert_eq!(pose.crossings.len(), 1);
    let mut on = |solver: &mut Solver| {
        let mut seen = Vec::new();
        for target in [PI, PI + 0.003, PI - 0.002, PI + 0.1, PI + 1.0] {
            straight_to(solver, &mut path, target);
            let progress = solver.track(&path).expect("the crank turns fully");
            seen.push((solver.pose().clone(), progress));
        }
        seen
    };
    let first = on(&mut solver);
    solver.restore(&pose);
    assert_eq!(on(&mut solver), first);
    let mut other = Solver::new(mechanism).expect("the drivers match");
    other.restore(&pose);
    assert_eq!(on(&mut other), first);
}

/// A wheel that turns fifty times as fast as the crank, and that nothing else reads, leaves the
/// crossing as it is to the last bit.
#[test]
fn a_body_that_a_block_does_not_read_changes_no_crossing() {
    let alone = std::fs::read_to_string("mechanisms/parallelogram.toml").expect("it is shipped");
    let wheel = "[bodies.wheel]\nmarkers = { O = [0, 0] }\nestimate = [0, 0.51, 0]\n\n";
    let joints = "O5 = { type = \"revolute\", markers = [\"ground.O5\", \"wheel.O\"] }\n\
        mesh = { type = \"gear\", markers = [\"crank.O\", \"wheel.O\"], radii = [0.5, 0.01] }\n\n";
    let with_wheel = alone
        .replace("O4 = [\"base\", 0]", "O4 = [\"base\", 0]\nO5 = [0, 0.51]")
        .replace("[bodies.crank]", &format!("{wheel}[bodies.crank]"))
        .replace("[drivers]", &format!("{joints}[drivers]"));
    let crossing = |text: &str| {
        let (mut solver, mut path) = assembled(&parse(text));
        straight_to(&solver, &mut path, PI - 0.001);
        solver.track(&path).expect("nothing is in the way");
        let [crossing] = &solver.pose().crossings[..] else {
            panic!("one change point is near");
        };
        let of_block = (crossing.center, crossing.half_width);
        (of_block, crossing.coefficients.clone())
    };
    assert_eq!(crossing(&with_wheel), crossing(&alone));
}

/// The crank angles, from 0 to pi, at which coupler and rocker line up: where the diagonal is
/// their sum or their difference. By half-angles, which lose nothing near 0 and pi.
fn limits([a, b, c, d]: [f64; 4]) -> impl Iterator<Item = f64> {
    [c, -c].into_iter().filter_map(move |c| {
        let sine = (b + c + (a - d)) * (b + c - (a - d));
        let cosine = (a + d + (b + c)) * (a + d - (b + c));
        (sine > 0.0 && cosine > 0.0).then(|| 2.0 * sine.sqrt().atan2(cosine.sqrt()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Every crank that is blocked is so where the closed form says, both ways; one that turns
    /// fully is not blocked.
    #[test]
    fn limits_of_four_bars_agree_with_the_closed_form(
        lengths in [0.1..0.5_f64, 0.1..0.5_f64, 0.1..0.5_f64, 0.1..0.5_f64],
        crank in -3.1..3.1_f64,
        side in prop::sample::select(vec![-1.0, 1.0]),
    ) {
        let Some(text) = four_bar_at(lengths, crank, side) else {
            return Ok(());
        };
        let (mut solver, mut path) = assembled(&parse(&text));
        let limits: Vec<f64> = limits(lengths).flat_map(|limit| [limit, -limit]).collect();
        let start = solver.pose().clone();
        for way in [TAU, -TAU] {
            solver.restore(&start);
            straight_to(&solver, &mut path, crank + way);
            // The first limit on the way.
            let expected = limits
                .iter()
                .map(|limit| ((limit - crank) * way.signum()).rem_euclid(TAU))
                .fold(f64::INFINITY, f64::min);
            match solver.track(&path) {
                Ok(_) => prop_assert!(expected.is_infinite(), "{expected}"),
                Err(blocked) => {
                    let Reason::Singular(point) = &blocked.reason else {
                        panic!("{blocked:?}")
                    };
                    prop_assert_eq!(point.kind, SingularKind::DeadPoint);
                    let found = (point.drivers[0] - crank) * way.signum();
                    prop_assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                    prop_assert!((point.s * TAU - expected).abs() < 1e-12);
                    prop_assert_eq!(&point.bodies, &["body `coupler`", "body `rocker`"]);
                    // Its place is near, and the way back is open.
                    let near = (solver.pose().drivers[0] - crank) * way.signum();
                    prop_assert!(near <= found && near > found - 1e-9);
                    straight_to(&solver, &mut path, crank);
                    let back = solver.track(&path);
                    prop_assert!(back.is_ok(), "{blocked:?}\n{back:?}");
                    let off = (0..9).map(|k| (solver.pose().q[k] - start.q[k]).abs());
                    prop_assert!(off.fold(0.0, f64::max) < 1e-9);
                }
            }
        }
    }
}

/// A parallelogram with one link wrong by a relative 1e-12 to 1e-6 is none: where links come to
/// lie in line, it turns back at the dead points that the closed form has, or swings over to the
/// other branch as its exact motion does.
#[test]
fn a_slightly_wrong_parallelogram_moves_as_its_exact_lengths_say() {
    let start = PI / 3.0;
    for wrong in [1e-12, 1e-9, 1e-6] {
        for (link, sign, side) in (0..4).flat_map(|link| {
            [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
                .map(|(sign, side)| (link, sign, side))
        }) {
            let mut lengths = [0.1, 0.2, 0.1, 0.2];
            lengths[link] *= 1.0 + sign * wrong;
            let mechanism = parse(&four_bar_at(lengths, start, side).expect("it closes"));
            let (mut solver, mut path) = assembled(&mechanism);
            let [a, b, c, d] = lengths;
            let limit = limits(lengths)
                .flat_map(|limit| [limit, TAU - limit])
                .filter(|limit| *limit > start)
                .fold(f64::INFINITY, f64::min);
            let mut blocked = None;
            for step in 1..=20 {
                let target = start + PI * f64::from(step) / 10.0;
                straight_to(&solver, &mut path, target);
                if let Err(end) = solver.track(&path) {
                    blocked = Some(end.reason);
                    break;
                }
                // On which side of the diagonal the loop lies never changes.
                let (x, y) = (a * target.cos(), a * target.sin());
                let diagonal = (d - x).hypot(y);
                let cosine = (diagonal * diagonal + b * b - c * c) / (2.0 * diagonal * b);
                let coupler = f64::atan2(-y, d - x) + side * cosine.acos();
                let off = (solver.pose().q[5] - coupler).rem_euclid(TAU);
                // The arc cosine's rounding.
                assert!(off.min(TAU - off) < 1e-12, "{lengths:?} {target}: {off}");
            }
            match blocked {
                None => assert!(limit.is_infinite(), "{lengths:?}"),
                Some(Reason::Singular(point)) => {
                    assert_eq!(point.kind, SingularKind::DeadPoint);
                    // The lengths' own rounding, 5e-17 m in a difference of 1e-13 m.
                    let off = (point.drivers[0] - limit).abs();
                    assert!(off < 1e-9, "{lengths:?}: {} {limit}", point.drivers[0]);
                }
                Some(reason) => panic!("{lengths:?}: {reason:?}"),
            }
        }
    }
}

#[test]
#[ignore = "takes eight minutes: cargo test --release --test solver singular -- --ignored"]
fn a_thousand_turns_through_change_points() {
    for (mechanism, exact) in [(shipped("parallelogram"), PARALLEL), (crossed(), CROSSED)] {
        for steps in [10, 100, 10_000] {
            let (worst, crossings) = turn(&mechanism, &exact, 1000, steps, 0.0);
            println!("{steps} steps a turn: {worst:?}");
            assert_eq!(crossings, 2000);
            // Next to a change point; angles of 6,000 rad lose three digits more.
            assert!(worst[0] < 1e-9 && worst[1] < 1e-7 && worst[2] < 1e-5);
        }
    }
}

/// The rounding of coordinates far from the origin parts the two motions of a parallelogram, or
/// joins them: it is never taken for the motion. All numbers but the angle are exact in binary.
#[test]
fn a_parallelogram_far_from_the_origin_stays_one() {
    for far in [0.0, 65536.0, 1048576.0] {
        let (start, half): (f64, f64) = (0.3103522496548119, 0.5390625);
        let (sin, cos) = start.sin_cos();
        let mechanism = parse(&format!(
            "format = 1\nname = 'far'\n\
             [ground.markers]\nO = [{far}, {far}]\nD = [{}, {far}]\n\
             [bodies.crank]\nmarkers = {{ O = [-{half}, 0], A = [{half}, 0] }}\n\
             estimate = [{}, {}, {start}]\n\
             [bodies.coupler]\nmarkers = {{ A = [-0.234375, 0], B = [0.234375, 0] }}\n\
             estimate = [{}, {}, 0]\n\
             [bodies.rocker]\nmarkers = {{ D = [-{half}, 0], B = [{half}, 0] }}\n\
             estimate = [{}, {}, {start}]\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n\
             A = {{ type = 'revolute', markers = ['crank.A', 'coupler.A'] }}\n\
             B = {{ type = 'revolute', markers = ['coupler.B', 'rocker.B'] }}\n\
             D = {{ type = 'revolute', markers = ['ground.D', 'rocker.D'] }}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = {start} }}\n",
            far + 0.46875,
            far + half * cos,
            far + half * sin,
            far + 0.234375 + 2.0 * half * cos,
            far + 2.0 * half * sin,
            far + 0.46875 + half * cos,
            far + half * sin,
        ));
        for steps in [1, 5, 7, 100] {
            let (mut solver, mut path) = assembled(&mechanism);
            for step in 1..=steps {
                let target = start * (1.0 - 2.0 * f64::from(step) / f64::from(steps));
                straight_to(&solver, &mut path, target);
                if let Err(blocked) = solver.track(&path) {
                    assert!(matches!(blocked.reason, Reason::Singular(_)), "{blocked:?}");
                    assert!(far > 65536.0, "{far} {steps}: {blocked:?}");
                    break;
                }
            }
            // Next to the flat pose rounding is felt up to its square root.
            let coupler = solver.pose().q[5];
            assert!(coupler.abs() < 1e-4, "{far} {steps}: {coupler}");
        }
    }
}

/// An arm whose cylinder has its foot next to the arm's pivot is near a dead point of its own all
/// along, while a short link stops the bucket: the position that is named is that of the bucket.
#[test]
fn the_dead_point_that_stops_the_motion_is_named_not_another_one_behind_it() {
    let mechanism = parse(
        "format = 1\nname = 'excavator'\n[ground.markers]\nO = [0, 0]\n\
         F = [-0.0019341133183708448, 0.012326242769921919]\n\
         [bodies.boom]\nmarkers = { a = [0, 0], c = [-0.13331191324361524, -0.11585126957380293], \
         s = [0.4698636064379762, -0.1280040389299235], b = [0.6279906298059906, 0] }\n\
         estimate = [0, 0, 1.1266159773968458]\n\
         [bodies.stick]\nmarkers = { a = [0, 0], r = [0.04186620627463532, 0.03295391437930634], \
         f = [0.09222916224856116, 0.05839989293378037], \
         l = [0.37827540813364663, 0.05453885610244458], b = [0.21018348202805498, 0] }\n\
         estimate = [0.26985882119848437, 0.5670524206327746, -1.8910565183900072]\n\
         [bodies.bucket]\n\
         markers = { a = [0, 0], e = [-0.05980381615550692, -0.1283489055748533] }\n\
         estimate = [0.2036902166339794, 0.3675560249575046, -0.8485026892109385]\n\
         [bodies.lever]\nmarkers = { a = [0, 0], b = [0.19590640131493625, 0] }\n\
         estimate = [0.2025383517493513, 0.19084140854409523, 2.399361771408058]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'boom.a'] }\n\
         K = { type = 'revolute', markers = ['boom.b', 'stick.a'] }\n\
         W = { type = 'revolute', markers = ['stick.b', 'bucket.a'] }\n\
         L = { type = 'revolute', markers = ['stick.l', 'lever.a'] }\n\
         rod = { type = 'link', markers = ['lever.b', 'bucket.e'], length = 0.010607983911173723 }\n\
         [drivers]\n\
         u = { coordinate = 'distance', markers = ['ground.F', 'boom.c'], start = 0.1890162977763308 }\n\
         v = { coordinate = 'distance', markers = ['boom.s', 'stick.r'], start = 0.1506011515061987 }\n\
         w = { coordinate = 'distance', markers = ['stick.f', 'lever.b'], start = 0.27512688959228226 }\n",
    );
    let (mut solver, mut path) = assembled(&mechanism);
    let targets = [0.20534713219285566, 0.1311047561749372, 0.3565392472904871];
    let start = solver.pose().drivers.clone();
    for (driver_path, (from, to)) in path.driver_paths.iter_mut().zip(start.iter().zip(targets)) {
        *driver_path = biela::kinematics::DriverPath::Input {
            position: to,
            velocity: 0.0,
            acceleration: 0.0,
            jump: from - to,
        };
    }
    let blocked = solver.track(&path).expect_err("the link stops the bucket");
    let Reason::Singular(point) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    // There the link and the bucket's arm are in line.
    let q = &point.q;
    let at = |body: &str, [x, y]: [f64; 2]| {
        let body = 3 * mechanism.body_id(body).expect("it has it").index();
        let (sin, cos) = q[body + 2].sin_cos();
        [q[body] + cos * x - sin * y, q[body + 1] + sin * x + cos * y]
    };
    let [pin, ear] =
        [[0.0, 0.0], [-0.05980381615550692, -0.1283489055748533]].map(|place| at("bucket", place));
    let end = at("lever", [0.19590640131493625, 0.0]);
    let (arm, link) = (
        [ear[0] - pin[0], ear[1] - pin[1]],
        [end[0] - ear[0], end[1] - ear[1]],
    );
    let sine =
        (arm[0] * link[1] - arm[1] * link[0]) / (arm[0].hypot(arm[1]) * link[0].hypot(link[1]));
    // Some eps of the coordinates, of up to 1 m, over the link of 0.01 m.
    assert!(sine.abs() < 1e-12, "{sine} {blocked:?}");
    assert!((point.s - blocked.s).abs() < 1e-4, "{blocked:?}");
    assert_eq!(point.bodies, ["body `bucket`", "joint `rod`"], "{point:?}");
}
