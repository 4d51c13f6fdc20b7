//! Poses of a mechanism along the motion that a picture shows.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::kinematics::{Curve, Path, Solver};
use crate::mechanism::Motion;

/// Poses along a whole motion: curves look smooth.
const STEPS: usize = 240;
/// Most bodies in all poses of a turn; a large mechanism has fewer poses.
const MOST_PLACED: usize = 240_000;
/// Most turns of the driver that are tried to bring the mechanism back; otherwise one is shown.
const MOST_TURNS: usize = 8;
/// Greatest distance from the start that counts as back, as a part of the longest way of a body,
/// and in radians.
const BACK: f64 = 1e-6;

/// Returns the generalized coordinates along the motion that starts at, or passes through, the
/// solver's pose; at least this pose. The solver returns to it.
pub(super) fn sweep(solver: &mut Solver) -> Vec<Vec<f64>> {
    let home = solver.pose().clone();
    let mechanism = Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    path.start = home.time;
    path.from.clone_from(&home.parameters);
    path.to.clone_from(&home.parameters);
    for (curve, value) in path.curves.iter_mut().zip(&home.drivers) {
        if let Curve::Input { position, .. } = curve {
            *position = *value;
        }
    }
    let moves = mechanism
        .drivers
        .iter()
        .any(|driver| driver.motion().is_some_and(Motion::uses_time));
    let crank = mechanism
        .drivers
        .iter()
        .position(|driver| driver.coordinate.kind.is_angle());
    let fewer = MOST_PLACED / mechanism.bodies.len().max(1);
    let steps = fewer.clamp(STEPS / 10, STEPS);
    let most_turns = (fewer / STEPS).clamp(1, MOST_TURNS);
    let mut poses = vec![home.q.clone()];
    if moves {
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
                if is_back(&poses) || !turn(solver, TAU, &mut poses) {
                    break;
                }
            }
            if !is_back(&poses) {
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
    }
    solver.restore(&home);
    poses
}

/// Whether all bodies end where they started, but for full turns.
fn is_back(poses: &[Vec<f64>]) -> bool {
    let (start, end) = (&poses[0], &poses[poses.len() - 1]);
    let off = |q: &[f64], k: usize| (q[k] - start[k]).abs();
    let is_angle = |k: usize| k % 3 == 2;
    let lengths = || (0..start.len()).filter(|k| !is_angle(*k));
    let farthest = poses
        .iter()
        .flat_map(|q| lengths().map(|k| off(q, k)))
        .fold(0.0, f64::max);
    (0..start.len()).all(|k| {
        if is_angle(k) {
            let turns = off(end, k) / TAU;
            (turns - turns.round()).abs() * TAU < BACK
        } else {
            off(end, k) <= BACK * farthest
        }
    })
}

/// Turns a driver by an angle, in so many steps; false if the motion is blocked before.
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
        path.curves[driver] = Curve::Input {
            position: value + step,
            velocity: 0.0,
            acceleration: 0.0,
            jump: -step,
        };
        advance(solver, path, poses)
    })
}

/// Follows a path as far as possible; false if the motion is blocked before its end.
fn advance(solver: &mut Solver, path: &Path, poses: &mut Vec<Vec<f64>>) -> bool {
    let followed = solver.track(path);
    poses.push(solver.pose().q.clone());
    followed.is_ok()
}
