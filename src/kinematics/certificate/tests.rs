//! The true motion stays within the bounds, and a step of any size follows it.

mod paths;

use nalgebra::{Rotation2, Vector2};
use proptest::prelude::*;

use crate::kinematics::reference::generated::{BAR, Ground, chain, lift_from_below, scissor_lift};
use crate::kinematics::reference::{assembled, grown, part};
use crate::kinematics::{DriverPath, Path, Pose, Progress, Solver};
use crate::mechanism::{DriverId, MarkerId, Mechanism, Source};

/// Number of places of a sub-step at which the true motion is compared with the bounds.
const SAMPLES: u32 = 12;
/// Rounding of both motions: some eps over the least reciprocal condition, 1e-3, for metres and
/// radians below ten.
const MOTION_ROUNDING: f64 = 1e-11;

/// Returns the part of a path between two places.
fn piece(path: &Path, mechanism: &Mechanism, [from, to]: [f64; 2]) -> Path {
    let mut piece = path.clone();
    piece.start = path.time(from);
    piece.duration = path.duration * (to - from);
    for (s, values) in [(from, &mut piece.from), (to, &mut piece.to)] {
        for (k, value) in values.iter_mut().enumerate() {
            *value = path.from[k] + s * (path.to[k] - path.from[k]);
        }
        mechanism.derive_parameters(values);
    }
    for driver_path in &mut piece.driver_paths {
        if let DriverPath::Input {
            position,
            velocity,
            acceleration,
            jump,
        } = driver_path
        {
            // The rest of the jump falls linearly along the part.
            let tau = from * path.duration;
            *position += tau * (*velocity + 0.5 * tau * *acceleration) + (1.0 - to) * *jump;
            *velocity += tau * *acceleration;
            *jump *= to - from;
        }
    }
    piece
}

/// Largest ratio of the deviation of the true motion to its bound.
#[derive(Clone, Copy, Debug, Default)]
struct Filled {
    angles: f64,
    points: f64,
}

/// Returns the pivot of a body in the pose `q`.
fn pivot(solver: &Solver, body: usize, q: &[f64]) -> Vector2<f64> {
    let s = solver.compiled.plan.pivots.or_origin(body);
    Vector2::new(q[3 * body], q[3 * body + 1]) + Rotation2::new(q[3 * body + 2]) * s
}

/// Asserts that the motion along `path` from `home`, which `solver` made in one sub-step, stays
/// within the bounds; `other` makes it by small steps.
fn check_inside(
    solver: &Solver,
    other: &mut Solver,
    home: &Pose,
    path: &Path,
    what: &str,
) -> Filled {
    let mechanism = solver.mechanism();
    let bodies = mechanism.bodies.len();
    let end = &solver.pose().q;
    let bounds = &solver.tracker.bounds;
    let deviation = |column| bounds.deviation(column, &solver.compiled.plan.pivots);
    let mut filled = Filled::default();
    other.restore(home);
    for look in 1..SAMPLES {
        let [before, s] = [look - 1, look].map(|k| f64::from(k) / f64::from(SAMPLES));
        let piece = piece(path, mechanism, [before, s]);
        if let Err(blocked) = other.track(&piece) {
            panic!("{what}: certified, but blocked at {s}: {blocked:?}");
        }
        let q = &other.pose().q;
        let look_at = |off: f64, radius: f64, of: &str, filled: &mut f64| {
            assert!(
                off <= radius + MOTION_ROUNDING,
                "{what}: {of} off by {off:e} of {radius:e} at {s}"
            );
            *filled = filled.max(off / (radius + MOTION_ROUNDING));
        };
        for column in 0..q.len() {
            let straight = home.q[column] + s * (end[column] - home.q[column]);
            let of = solver.system().describe_unknown(column) + &format!(" ({column})");
            let (off, radius) = ((q[column] - straight).abs(), deviation(column));
            look_at(off, radius, &of, &mut filled.angles);
        }
        for body in 0..bodies {
            let [from, to] = [&home.q, end].map(|q| pivot(solver, body, q));
            let off = (pivot(solver, body, q) - (from + (to - from) * s)).norm();
            let of = format!("pivot of {}", mechanism.bodies[body].name);
            look_at(
                off,
                bounds.body(body).point_deviation,
                &of,
                &mut filled.points,
            );
        }
    }
    filled
}

/// Tracks the longest of some first parts of `path` that is certified in one sub-step, and asserts
/// that the motion stays within the bounds. Returns that part and the ratios to the bounds.
fn check_path(solver: &mut Solver, other: &mut Solver, path: &Path, what: &str) -> (f64, Filled) {
    let mut home = solver.pose().clone();
    solver.save(&mut home);
    let mut s = 1.0;
    while s > 1e-3 {
        let path = piece(path, &solver.mechanism().clone(), [0.0, s]);
        solver.restore(&home);
        if let Ok(Progress {
            substeps: 1,
            checked: 0,
            ..
        }) = solver.track(&path)
        {
            let filled = check_inside(solver, other, &home, &path, what);
            return (s, filled);
        }
        s *= 0.6;
    }
    solver.restore(&home);
    (0.0, Filled::default())
}

/// Returns a path on which each input driver moves by its part of `by`.
fn move_drivers(solver: &Solver, by: f64) -> Path {
    let mut path = Path::new(solver.mechanism());
    path.start = solver.pose().time;
    path.duration = by.abs();
    path.from.copy_from_slice(&solver.pose().parameters);
    path.to.copy_from_slice(&solver.pose().parameters);
    for (k, (driver_path, now)) in path
        .driver_paths
        .iter_mut()
        .zip(&solver.pose().drivers)
        .enumerate()
    {
        if let DriverPath::Input {
            position,
            jump,
            acceleration,
            ..
        } = driver_path
        {
            *position = now + by / (k + 1) as f64;
            *jump = now - *position;
            // On a parabola, too.
            *acceleration = 0.4 / by;
        }
    }
    path
}

/// Checks steps of all sizes from several places of the motion. Returns the largest certified step
/// and the largest ratios to the bounds.
fn sweep(source: &Source, sizes: &[f64], places: u32) -> (f64, Filled) {
    let what = source.name();
    let (mut solver, _) = assembled(source);
    let (mut other, _) = assembled(source);
    let (mut largest, mut fullest) = (0.0_f64, Filled::default());
    for _ in 0..places {
        let home = solver.pose().clone();
        for &by in sizes {
            solver.restore(&home);
            let path = move_drivers(&solver, by);
            let (s, filled) = check_path(&mut solver, &mut other, &path, what);
            largest = largest.max(s * by.abs());
            fullest.angles = fullest.angles.max(filled.angles);
            fullest.points = fullest.points.max(filled.points);
        }
        solver.restore(&home);
        let path = move_drivers(&solver, 0.37 * sizes[0]);
        // A dead point may stop the motion; the pose in front of it serves as well.
        let _ = solver.track(&path);
    }
    (largest, fullest)
}

fn shipped() -> impl Iterator<Item = Source> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms");
    let files = std::fs::read_dir(folder).expect("it is shipped");
    let paths = files.map(|file| file.expect("it can be read").path());
    let mut paths: Vec<_> = paths
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    paths.sort();
    paths.into_iter().map(|path| {
        let name = path
            .file_stem()
            .map(|name| name.to_string_lossy().into_owned());
        Source::open(name.unwrap_or_default(), &path).expect("it can be read")
    })
}

#[test]
fn every_shipped_mechanism_stays_within_its_bounds() {
    for source in shipped() {
        let (mechanism, _) = Mechanism::parse(&source).expect("it has no errors");
        let angle = mechanism.drivers.iter().all(|driver| {
            matches!(
                driver.coordinate.kind,
                crate::mechanism::CoordinateKind::Angle
            )
        });
        let scale = if angle { 1.0 } else { 0.1 };
        let sizes = [1.0, -0.3, 0.02].map(|size: f64| size * scale);
        let (largest, _) = sweep(&source, &sizes, 2);
        assert!(largest >= 0.02 * scale, "{}: {largest}", source.name());
    }
}

/// Bounds much wider than the motion would shorten sub-steps without need.
#[test]
fn the_motion_uses_a_large_part_of_its_bounds() {
    for (name, angles) in [
        ("four_bar", 0.5),
        ("slider_crank", 0.3),
        ("double_rocker", 0.03),
    ] {
        let source = shipped()
            .find(|source| source.name() == name)
            .expect("it is shipped");
        let (_, filled) = sweep(&source, &[0.2], 8);
        assert!(filled.angles > angles, "{name}: {filled:?}");
    }
}

#[test]
fn chains_and_lifts_stay_within_their_bounds() {
    for (name, text, size) in [
        ("chain", chain(30, Ground::Straight), 0.4),
        ("lift of one", scissor_lift(1), 0.1),
        ("lift of six", scissor_lift(6), 0.1),
        (
            "straight lift",
            lift_from_below(9, 0.7, |_| [0.5, 0.5]),
            0.1,
        ),
        (
            "bent lift",
            lift_from_below(9, 0.7, |k| [0.5, 0.5 + 0.004 * (k as f64).sin()]),
            0.1,
        ),
    ] {
        let (largest, _) = sweep(&Source::new(name, &text), &[size, -0.1 * size], 2);
        assert!(largest > 0.05 * size, "{name}: {largest}");
    }
}

/// Returns the angle of a lift's bars, asin(height / (cells · bar)).
fn bar_angle(cells: usize, height: f64) -> f64 {
    (height / (cells as f64 * BAR)).asin()
}

/// Blocks of more than 32 torn unknowns are checked by estimates: in small steps forward and back,
/// and with long steps in between.
#[test]
fn large_lifts_stay_within_their_bounds() {
    const CELLS: usize = 20;
    let source = Source::new("lift", scissor_lift(CELLS));
    let (mut solver, _) = assembled(&source);
    let (mut other, _) = assembled(&source);
    let mut home = solver.pose().clone();
    for (steps, by) in [
        (40, 4e-4),
        (60, 1e-5),
        (30, -5e-4),
        (60, -1e-5),
        (3, 0.05),
        (20, 1e-3),
    ] {
        for step in 0..steps {
            solver.save(&mut home);
            let path = move_drivers(&solver, by);
            let what = format!("step {step} by {by}");
            let progress = solver.track(&path).expect(&what);
            assert!(progress.checked > 0, "{what}");
            if progress.substeps == 1 && step % 6 == 2 {
                check_inside(&solver, &mut other, &home, &path, &what);
            }
            let angle = bar_angle(CELLS, solver.pose().drivers[0]);
            let found = solver.pose().q[3 * (2 * CELLS - 2) + 2];
            assert!(
                (found - angle).abs() < MOTION_ROUNDING,
                "{what}: {found} {angle}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn random_mechanisms_stay_within_their_bounds(
        parts in prop::collection::vec(part(), 1..4),
        size in 0.05..1.2_f64,
    ) {
        let text = grown(&parts);
        let source = Source::new("grown", &text);
        let (mechanism, _) = Mechanism::parse(&source).expect("it has no errors");
        let path = Path::new(&mechanism);
        let mut solver = Solver::new(mechanism.into()).expect("the drivers match");
        // Some of them do not close.
        prop_assume!(solver.assemble(&path).is_ok() && solver.rcond() > 1e-3);
        sweep(&source, &[size, -0.3 * size], 2);
    }
}

/// Each parameter moves by a part of itself, while the drivers move or all but rest.
#[test]
fn mechanisms_with_moving_parameters_stay_within_their_bounds() {
    let mut moved = 0;
    for source in shipped() {
        let (mut solver, _) = assembled(&source);
        let (mut other, _) = assembled(&source);
        let mechanism = std::sync::Arc::clone(solver.mechanism());
        let home = solver.pose().clone();
        for (index, parameter) in mechanism.parameters.iter().enumerate() {
            if parameter.derived {
                continue;
            }
            solver.restore(&home);
            let by = if index % 2 == 0 { 1e-9 } else { 0.05 };
            let mut path = move_drivers(&solver, by);
            path.to[index] *= 1.05;
            mechanism.derive_parameters(&mut path.to);
            let what = format!("{}, {}", source.name(), parameter.name);
            let (s, _) = check_path(&mut solver, &mut other, &path, &what);
            moved += u32::from(s > 0.0);
        }
    }
    assert!(moved > 150, "{moved}");
}

/// Returns the mechanism with markers that two parameters shift and turn, each by its own part.
fn with_moving_markers(text: &str) -> String {
    let mut count = 0;
    let mut moving = |line: &str| {
        let mut parts = line.split('[');
        let mut text = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            count += 1;
            let (place, rest) = part.split_once(']').expect("it closes");
            let (x, y) = place.split_once(',').expect("it has two coordinates");
            // Spread evenly, so that no two markers move alike.
            let [k, l, m] =
                [1.0, 2.0, 3.0].map(|n: f64| 2.0 * (0.618 * n * f64::from(count)).fract() - 1.0);
            text += &format!(
                "[\"{x} + 0.1*({k}*sin(p) + {l}*r)\", \"{y} + 0.1*({l}*p^2 + {m}*r)\", \"0.1*{k}*(p + r)\"]"
            );
            text += rest;
        }
        text
    };
    let is_ground = |line: &str| line.starts_with("O = [") || line.starts_with('P');
    let lines = text.lines().map(|line| {
        if line.starts_with("markers =") || is_ground(line) {
            moving(line)
        } else {
            line.to_owned()
        }
    });
    let lines: Vec<_> = lines.collect();
    lines.join("\n") + "\n[parameters]\np = 0\nr = 0\n"
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Moving parameters change all numbers, their own terms and those of the motion among each
    /// other.
    #[test]
    fn random_mechanisms_stay_within_their_bounds_while_markers_move(
        parts in prop::collection::vec(part(), 1..4),
        by in prop::sample::select(vec![0.3, 0.05, 1e-9]),
        [p, r] in prop::array::uniform2(-0.4..0.4_f64),
    ) {
        let text = with_moving_markers(&grown(&parts));
        let source = Source::new("grown", &text);
        let (mechanism, _) = Mechanism::parse(&source)
            .unwrap_or_else(|diagnostics| panic!("{text}: {diagnostics:#?}"));
        let path = Path::new(&mechanism);
        let [mut solver, mut other] =
            [(); 2].map(|()| Solver::new(mechanism.clone().into()).expect("the drivers match"));
        // Some of them do not close.
        prop_assume!(solver.assemble(&path).is_ok() && solver.rcond() > 1e-3);
        prop_assume!(other.assemble(&path).is_ok());
        let mut path = move_drivers(&solver, by);
        path.to = vec![p, r];
        check_path(&mut solver, &mut other, &path, &text);
    }
}

/// Moving parameters are real variables of the path: their steps are proved, in as few sub-steps
/// as those of drivers.
#[test]
fn steps_of_moving_parameters_are_proved() {
    let (mut steps, mut substeps) = (0, 0);
    for source in shipped() {
        let (mut solver, _) = assembled(&source);
        let mechanism = std::sync::Arc::clone(solver.mechanism());
        let home = solver.pose().clone();
        for (index, parameter) in mechanism.parameters.iter().enumerate() {
            if parameter.derived {
                continue;
            }
            solver.restore(&home);
            let mut path = move_drivers(&solver, 1e-9);
            path.to[index] *= 1.05;
            mechanism.derive_parameters(&mut path.to);
            // The geometry of some does not allow for so much.
            if let Ok(progress) = solver.track(&path) {
                let what = format!("{}, {}", source.name(), parameter.name);
                assert_eq!(progress.checked, 0, "{what}");
                steps += 1;
                substeps += progress.substeps;
            }
        }
    }
    assert!(steps > 150 && substeps < 2 * steps, "{steps} {substeps}");
}

/// Numbers without moving parameters keep their bounds from one sub-step to the next. These are
/// those of a new solver, whatever moved before.
#[test]
fn bounds_of_numbers_do_not_depend_on_what_moved_before() {
    let move_one = |solver: &mut Solver, index: usize, by: f64| {
        let mechanism = std::sync::Arc::clone(solver.mechanism());
        let mut path = move_drivers(solver, 1e-3);
        path.to[index] *= by;
        mechanism.derive_parameters(&mut path.to);
        let end = solver.track(&path);
        let bounds = &solver.tracker.bounds.parameters;
        let markers = (0..mechanism.markers.len()).map(MarkerId);
        let markers: Vec<_> = markers
            .map(|marker| [bounds.position(marker), bounds.angle(marker)])
            .collect();
        let rows = 0..solver.compiled.system.equations().len();
        let targets: Vec<_> = rows.map(|row| bounds.target(row)).collect();
        format!("{end:?} {:?} {markers:?} {targets:?}", solver.pose())
    };
    let mut pairs = 0;
    for source in shipped() {
        let (mut solver, _) = assembled(&source);
        let home = solver.pose().clone();
        let parameters = solver.mechanism().parameters.clone();
        let own = parameters.iter().enumerate().filter(|(_, p)| !p.derived);
        let own: Vec<_> = own.map(|(index, _)| index).collect();
        for pair in own.windows(2) {
            move_one(&mut solver, pair[0], 1.01);
            solver.restore(&home);
            let after = move_one(&mut solver, pair[1], 1.001);
            solver.restore(&home);
            let (mut new, _) = assembled(&source);
            let alone = move_one(&mut new, pair[1], 1.001);
            assert_eq!(after, alone, "{}, {pair:?}", source.name());
            pairs += 1;
        }
    }
    assert!(pairs > 100, "{pairs}");
}

/// Prescribed motions of every kind deviate from their chords by no more than their bounds.
#[test]
fn prescribed_motions_stay_within_their_bounds() {
    let motions = [
        r#""0.5 + 0.8*sin(3*t)*exp(-t/2)""#,
        r#""abs(t - 0.31)""#,
        r#""0.3 + sqrt(0.1 + t)""#,
        r#"{ table = [[0, 0], [0.2, 0.3], [0.5, -0.2], [1, 0.4]] }"#,
        r#"{ table = [[0, 0], [0.2, 0.3], [0.5, -0.2], [1, 0.4]], law = "cycloidal" }"#,
        r#"{ table = [[0, 0], [0.2, 0.3], [0.5, 0]], law = "trapezoidal", ends = "periodic" }"#,
    ];
    for motion in motions {
        let text = format!(
            "format = 1\nname = 'm'\n[ground.markers]\nO = [0, 0]\n[bodies.a]\n\
             markers = {{ O = [0, 0] }}\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'a.O'] }}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.O', 'a.O'], motion = {motion} }}\n"
        );
        let (mut solver, _) = assembled(&Source::new(motion, &text));
        let mut most_filled = 0.0_f64;
        for step in 0..40 {
            let mut path = Path::new(solver.mechanism());
            path.start = solver.pose().time;
            path.duration = 0.001 + 0.0025 * f64::from(step % 10);
            let from = solver.pose().drivers[0];
            let progress = solver.track(&path).expect("a pendulum turns freely");
            if progress.substeps > 1 {
                continue;
            }
            let to = solver.pose().drivers[0];
            let radius = solver.tracker.bounds.drivers[0];
            for sample in 0..=20 {
                let s = f64::from(sample) / 20.0;
                let u = solver.motion(DriverId(0), path.time(s)).value;
                let off = (u - (from + s * (to - from))).abs();
                assert!(off <= radius + 1e-15, "{motion}: {off:e} of {radius:e}");
                most_filled = most_filled.max(off / radius);
            }
        }
        assert!(most_filled > 0.5, "{motion}: {most_filled}");
    }
}

/// The largest certified turn of the crank of the four-bar depends on the pose. The classical test
/// with fixed matrices reaches 0.87 to 1.13 rad.
#[test]
fn the_crank_of_the_four_bar_turns_far_in_one_substep() {
    let source = shipped()
        .find(|source| source.name() == "four_bar")
        .expect("it is shipped");
    let (mut solver, _) = assembled(&source);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..24 {
        let home = solver.pose().clone();
        let reaches = |solver: &mut Solver, by: f64| {
            solver.restore(&home);
            let mut path = move_drivers(solver, by);
            path.duration = 0.0;
            solver
                .track(&path)
                .is_ok_and(|progress| progress.substeps == 1)
        };
        let (mut low, mut high) = (0.0, 3.0);
        while high - low > 1e-3 {
            let by = 0.5 * (low + high);
            if reaches(&mut solver, by) {
                low = by
            } else {
                high = by
            }
        }
        least = least.min(low);
        most = most.max(low);
        solver.restore(&home);
        let path = move_drivers(&solver, std::f64::consts::TAU / 24.0);
        solver.track(&path).expect("the crank turns fully");
    }
    assert!(least > 0.87 && most < 2.5, "{least} {most}");
}
