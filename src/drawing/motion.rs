//! The motion that a picture shows: poses of a mechanism along it.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::kinematics::{Curve, Path, Solver};
use crate::mechanism::{CoordinateKind, Motion};

/// Poses along a whole motion: fine enough for curves to look smooth.
const STEPS: usize = 240;
/// A mechanism that so many turns of its driver do not bring back shows one.
const MOST_TURNS: usize = 8;
/// How near, as a part of the way that bodies went and in radians, is back.
const BACK: f64 = 1e-6;

/// The generalized coordinates along the motion that starts, or passes, where the solver stands;
/// at least those. The solver is back there in the end.
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
        .position(|driver| driver.coordinate.kind == CoordinateKind::Angle);
    let mut poses = vec![home.q.clone()];
    if moves {
        let duration = (mechanism.simulation.stop - home.time).max(0.0);
        path.duration = duration / STEPS as f64;
        for _ in 0..STEPS {
            path.start = solver.pose().time;
            if !advance(solver, &path, &mut poses) {
                break;
            }
        }
    } else if let Some(crank) = crank {
        if turn(solver, &mut path, crank, TAU, &mut poses) {
            for _ in 1..MOST_TURNS {
                if is_back(&poses) || !turn(solver, &mut path, crank, TAU, &mut poses) {
                    break;
                }
            }
            if !is_back(&poses) {
                poses.truncate(STEPS + 1);
            }
            solver.restore(&home);
            return poses;
        }
        solver.restore(&home);
        let mut back = Vec::new();
        turn(solver, &mut path, crank, -TAU, &mut back);
        back.reverse();
        back.append(&mut poses);
        poses = back;
    }
    solver.restore(&home);
    poses
}

/// Whether all bodies are in the end where they started, whatever full turns they made.
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

/// Turns a driver by an angle; false if something is in the way.
fn turn(
    solver: &mut Solver,
    path: &mut Path,
    driver: usize,
    by: f64,
    poses: &mut Vec<Vec<f64>>,
) -> bool {
    let step = by / STEPS as f64;
    (0..STEPS).all(|_| {
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

/// Goes along a path as far as possible; false if that is not to its end.
fn advance(solver: &mut Solver, path: &Path, poses: &mut Vec<Vec<f64>>) -> bool {
    let followed = solver.track(path);
    poses.push(solver.pose().q.clone());
    followed.is_ok()
}
