//! Poses of a mechanism along the motion that a picture shows.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{DriverPath, End, Path, RangeSettings, Solver};
use biela::mechanism::{DriverId, Mechanism};

/// Poses along a whole motion: curves look smooth.
const STEPS: usize = 240;
/// Most bodies in all poses of a turn; a large mechanism has fewer poses.
const MOST_PLACED: usize = 240_000;
/// Most turns of the driver that are tried to bring the mechanism back; otherwise one is shown.
const MOST_TURNS: usize = 8;
/// Lengths of the mechanism within which the limits of a length are sought.
const SEARCHED: f64 = 3.0;
/// Greatest distance from the start that counts as back, as a part of the longest way of a body,
/// and in radians.
const BACK: f64 = 1e-6;

/// Returns the generalized coordinates along the motion that starts at, or passes through, the
/// solver's pose; at least this pose. The solver returns to it.
pub(super) fn sweep(solver: &mut Solver) -> Vec<Vec<f64>> {
    let home = solver.pose().clone();
    let mechanism = Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    home.set_path(&mut path);
    let crank = first_angle(&mechanism);
    let bodies = mechanism.bodies.len();
    let [steps, most_turns] = resolution(&mechanism);
    let mut poses = vec![home.q.clone()];
    if mechanism.uses_time() {
        let duration = (mechanism.simulation.stop - home.time).max(0.0);
        path.duration = duration / steps as f64;
        for _ in 0..steps {
            path.start = solver.pose().time;
            if !advance(solver, &path, &mut poses) {
                break;
            }
        }
    } else if let Some(crank) = crank {
        let mut turn = |solver: &mut Solver, by: f64, poses: &mut Vec<Vec<f64>>| {
            turn(solver, &mut path, crank, [by, steps as f64], poses)
        };
        let driver = &mechanism.drivers[crank];
        let start = home.drivers[crank];
        // A start beyond a limit leaves no way to that side.
        let room = |limit: f64, sign: f64| (sign * (limit - start)).clamp(0.0, TAU);
        let up = driver.max.map_or(TAU, |max| room(max, 1.0));
        let down = driver.min.map_or(TAU, |min| room(min, -1.0));
        let is_limited = driver.min.is_some() || driver.max.is_some();
        if turn(solver, up, &mut poses) && !is_limited {
            for _ in 1..most_turns {
                if is_back(&poses, bodies) || !turn(solver, TAU, &mut poses) {
                    break;
                }
            }
            if !is_back(&poses, bodies) {
                poses.truncate(steps + 1);
            }
            solver.restore(&home);
            return poses;
        }
        solver.restore(&home);
        let mut back = Vec::new();
        turn(solver, -down, &mut back);
        back.reverse();
        back.append(&mut poses);
        poses = back;
    } else if let Some(driver) = usual_driver(&mechanism)
        && !mechanism.outputs.markers.is_empty()
    {
        // For the paths of points alone: ways as long as a cylinder could go would be long. A length
        // without a limit has no whole range.
        poses = follow_up_to(solver, driver, [None; 2], 0.0);
    }
    solver.restore(&home);
    poses
}

/// Returns the generalized coordinates along the range of one driver between bounds, with the others
/// held, from its lower to its upper end; of a driver that turns fully, from the solver's pose on.
/// Without a limit, an angle makes one turn, and a length changes by the size of the mechanism.
pub(super) fn follow(
    solver: &mut Solver,
    driver: DriverId,
    bounds: [Option<f64>; 2],
) -> Vec<Vec<f64>> {
    follow_up_to(solver, driver, bounds, 1.0)
}

/// As [`follow`], where a length without a limit changes by these sizes of the mechanism.
fn follow_up_to(
    solver: &mut Solver,
    driver: DriverId,
    bounds: [Option<f64>; 2],
    sizes: f64,
) -> Vec<Vec<f64>> {
    let [steps, turns] = resolution(solver.mechanism());
    let settings = RangeSettings {
        samples: steps as u32,
        turns: turns as u32,
        lengths: SEARCHED,
        bounds,
        transmission: false,
    };
    let start = solver.pose().drivers[driver.index()];
    let range = solver.range(driver, &settings);
    let kind = solver.mechanism().drivers[driver.index()].coordinate.kind;
    let shown = |end: &End| match *end {
        End::NotFound { .. } if kind.is_angle() => Some(start + TAU),
        End::NotFound { value } => Some(start + sizes * (value - start) / SEARCHED),
        _ => None,
    };
    // One turn upwards shows both ways of an angle without limits.
    let low = match shown(&range.lower) {
        Some(_) if kind.is_angle() => start,
        low => low.unwrap_or(f64::NEG_INFINITY),
    };
    let high = shown(&range.upper).map_or(f64::INFINITY, |high| high + 1e-9 * high.abs());
    let within = |value: f64| (low..=high).contains(&value);
    let samples = range.samples.into_iter();
    let mut poses: Vec<Vec<f64>> = (samples.filter(|sample| within(sample.driver)))
        .map(|sample| sample.pose.q)
        .collect();
    if poses.is_empty() {
        poses.push(solver.pose().q.clone());
    }
    poses
}

/// Returns poses spread evenly over a motion of this many bodies: from one end to the other or, where
/// the motion returns to its start, without the start.
pub(super) fn spread(motion: &[Vec<f64>], bodies: usize, count: usize) -> Vec<Vec<f64>> {
    let last = motion.len() - 1;
    let index = |k: usize, parts: usize| (k * last + parts / 2) / parts;
    let indices: Vec<usize> = if last == 0 {
        Vec::new()
    } else if is_back(motion, bodies) {
        (1..=count).map(|k| index(k, count + 1)).collect()
    } else if count == 1 {
        vec![last]
    } else {
        (0..count).map(|k| index(k, count - 1)).collect()
    };
    indices.into_iter().map(|k| motion[k].clone()).collect()
}

/// Returns the driver that a picture follows if nothing is prescribed: the first angle or, without
/// any, the first one.
#[must_use]
pub fn usual_driver(mechanism: &Mechanism) -> Option<DriverId> {
    let first = (!mechanism.drivers.is_empty()).then_some(0);
    first_angle(mechanism).or(first).map(DriverId)
}

fn first_angle(mechanism: &Mechanism) -> Option<usize> {
    let mut drivers = mechanism.drivers.iter();
    drivers.position(|driver| driver.coordinate.kind.is_angle())
}

/// Returns the number of poses per turn, and the greatest number of turns.
fn resolution(mechanism: &Mechanism) -> [usize; 2] {
    let fewer = MOST_PLACED / mechanism.bodies.len().max(1);
    let steps = fewer.clamp(STEPS / 10, STEPS);
    [steps, (fewer / STEPS).clamp(1, MOST_TURNS)]
}

/// Returns whether all bodies end where they started, but for full turns.
fn is_back(poses: &[Vec<f64>], bodies: usize) -> bool {
    let (start, end) = (&poses[0], &poses[poses.len() - 1]);
    let coordinates = 3 * bodies;
    let off = |q: &[f64], k: usize| (q[k] - start[k]).abs();
    let is_angle = |k: usize| k % 3 == 2;
    let lengths = || (0..coordinates).filter(|k| !is_angle(*k));
    let farthest = poses
        .iter()
        .flat_map(|q| lengths().map(|k| off(q, k)))
        .fold(0.0, f64::max);
    (0..coordinates).all(|k| {
        if is_angle(k) {
            let turns = off(end, k) / TAU;
            (turns - turns.round()).abs() * TAU < BACK
        } else {
            off(end, k) <= BACK * farthest
        }
    })
}

/// Turns a driver by an angle in equal steps. Returns false if the motion is blocked before.
fn turn(
    solver: &mut Solver,
    path: &mut Path,
    driver: usize,
    [by, steps]: [f64; 2],
    poses: &mut Vec<Vec<f64>>,
) -> bool {
    let step = by / steps;
    (0..steps as usize).all(|_| {
        let value = solver.pose().drivers[driver];
        path.driver_paths[driver] = DriverPath::held(value + step, value);
        advance(solver, path, poses)
    })
}

/// Follows a path as far as possible; false if the motion is blocked before its end.
fn advance(solver: &mut Solver, path: &Path, poses: &mut Vec<Vec<f64>>) -> bool {
    let followed = solver.track(path);
    poses.push(solver.pose().q.clone());
    followed.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use biela::mechanism::Source;

    /// Number of bodies of the mechanisms here.
    const BODIES: usize = 3;

    /// Returns a shipped mechanism at its own pose.
    fn assembled(name: &str) -> Solver {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mechanisms");
        let file = folder.join(name).with_extension("toml");
        let source = Source::open(name.to_owned(), &file).expect("it is shipped");
        let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
        let mut solver = Solver::new(mechanism.into()).expect("it is determined");
        let path = Path::new(solver.mechanism());
        solver.assemble(&path).expect("it closes");
        solver
    }

    #[test]
    fn poses_reach_from_one_dead_point_to_the_other() {
        // The side between an arm of 0.25 m and a pivot 0.4 m from the arm's: law of cosines.
        let side = |q: &Vec<f64>| {
            (0.4_f64.powi(2) + 0.25_f64.powi(2) - 2.0 * 0.4 * 0.25 * q[2].cos()).sqrt()
        };
        let mut solver = assembled("tlv");
        let home = solver.pose().clone();
        let driver = usual_driver(solver.mechanism()).expect("it has one");
        let motion = follow(&mut solver, driver, [None; 2]);
        assert_eq!(*solver.pose(), home);
        let ends = spread(&motion, BODIES, 2);
        // Dead points are located to rounding: arm and base in line.
        for (end, length) in ends.iter().zip([0.15, 0.65]) {
            assert!((side(end) - length).abs() < 1e-11, "{}", side(end));
        }
        let four = spread(&motion, BODIES, 4);
        assert_eq!((&four[0], &four[3]), (&ends[0], &ends[1]));
        assert_eq!(spread(&motion, BODIES, 1), ends[1..]);
        assert!(spread(&motion[..1], BODIES, 3).is_empty());
        // Bounds stand in place of the dead points.
        let motion = follow(&mut solver, driver, [Some(0.3), Some(0.4)]);
        let ends = spread(&motion, BODIES, 2);
        assert!((side(&ends[0]) - 0.3).abs() < 1e-12 && (side(&ends[1]) - 0.4).abs() < 1e-12);
    }

    // The place of contact on a cam, an unknown of the joint's own, does not count.
    #[test]
    fn a_cam_is_back_after_a_turn() {
        for name in ["cam_flat", "cam_roller_arm", "cam_knife", "four_bar"] {
            let mut solver = assembled(name);
            let bodies = solver.mechanism().bodies.len();
            let motion = sweep(&mut solver);
            assert_eq!(motion.len(), STEPS + 1, "{name}");
            assert!(is_back(&motion, bodies), "{name}");
            assert!(!is_back(&motion[..STEPS], bodies), "{name}");
        }
    }

    #[test]
    fn poses_of_a_full_turn_leave_out_its_start() {
        let mut solver = assembled("four_bar");
        let home = solver.pose().q.clone();
        let driver = usual_driver(solver.mechanism()).expect("it has one");
        for motion in [sweep(&mut solver), follow(&mut solver, driver, [None; 2])] {
            let crank: Vec<f64> = spread(&motion, BODIES, 3)
                .iter()
                .map(|q| q[2] - home[2])
                .collect();
            for (turned, quarter) in crank.iter().zip([0.25, 0.5, 0.75]) {
                assert!((turned - quarter * TAU).abs() < 1e-9, "{crank:?}");
            }
        }
    }
}
