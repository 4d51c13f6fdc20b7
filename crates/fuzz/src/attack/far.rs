//! Starts many turns away against the same way in tiny steps.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{DriverPath, Error, Path, Pose, Solver};
use biela::mechanism::{Mechanism, Source};

use super::{Case, SAME, TINY, distance, is_given_up};
use crate::mutation::Chance;

/// Turns that are added to the jump of a driver.
const TURNS: [f64; 6] = [1.0, 2.0, 3.0, 5.0, 1_000.0, 12_345.0];
/// Tiny steps per turn.
const STEPS: u32 = 100;
/// Most turns after which the mechanism may be at its start again.
const MOST_TURNS: usize = 4;

/// A mechanism on its way to a start.
struct Way {
    solver: Solver,
    home: Pose,
    parameters: Vec<f64>,
    drivers: Vec<f64>,
}

/// The end of tiny steps.
enum Stop {
    /// The motion ends on the way.
    Blocked,
    /// A step takes too many sub-steps.
    GivenUp,
    /// The motion does not repeat itself soon.
    Endless,
}

/// Adds turns to a driver that is an angle, if there is one, and starts there.
///
/// # Errors
///
/// The difference from tiny steps on the same way, in words.
pub(super) fn difference(case: &Case, chance: &mut Chance) -> Result<(), String> {
    let source = Source::new("attack.toml", case.text.as_str());
    let (mechanism, _) = Mechanism::parse(&source).expect("it was read before");
    let mechanism = Arc::new(mechanism);
    let drivers = mechanism.drivers.iter().enumerate();
    let angles = drivers.filter(|(_, driver)| driver.coordinate.kind.is_angle());
    let angles: Vec<usize> = angles.map(|(index, _)| index).collect();
    if angles.is_empty() {
        return Ok(());
    }
    let turned = angles[chance.below(angles.len())];
    let sign = if chance.below(2) == 0 { 1.0 } else { -1.0 };
    let turns = sign * TURNS[chance.below(TURNS.len())];
    let solver = Solver::assembled(Arc::clone(&mechanism), &Path::new(&mechanism));
    let solver = solver.expect("it was assembled before");
    let home = solver.pose().clone();
    let mut way = Way {
        parameters: home.parameters.clone(),
        drivers: case.drivers.clone(),
        solver,
        home,
    };
    way.drivers[turned] += TAU * turns;
    for (name, value) in &case.parameters {
        let index = mechanism.parameters.iter().position(|p| p.name == *name);
        way.parameters[index.expect("the case names its own parameters")] = *value;
    }
    mechanism.derive_parameters(&mut way.parameters);
    let truth = way.follow_turns();
    let started = way.start();
    let words = |what: &str| format!("starting {turns} turns away in driver {turned}: {what}");
    match (started, truth) {
        (Ok(q), Ok(truth)) => {
            let off = distance(&q, &truth);
            if off <= SAME {
                Ok(())
            } else {
                Err(words(&format!("{off:.1e} away from tiny steps")))
            }
        }
        (Err(error), Ok(_)) => Err(words(&format!("refused: {error}"))),
        // The whole way, straight, may pass by the obstacle.
        (Ok(q), Err(Stop::Blocked)) => match way.follow_straight(turns) {
            Ok(truth) if distance(&q, &truth) <= SAME => Ok(()),
            Ok(truth) => {
                let off = distance(&q, &truth);
                Err(words(&format!("{off:.1e} away from the straight way")))
            }
            Err(Stop::Blocked) => Err(words("goes where tiny steps are blocked")),
            Err(_) => Ok(()),
        },
        (Err(Error::NoWay { .. } | Error::NotAssembled { .. } | Error::Singular { .. }), _)
        | (Ok(_), Err(Stop::GivenUp | Stop::Endless)) => Ok(()),
        (Err(error), _) => Err(words(&error.to_string())),
    }
}

impl Way {
    /// Starts at the end. Returns q there.
    fn start(&mut self) -> Result<Vec<f64>, Error> {
        self.solver.restore(&self.home);
        let path = self.path(
            [&self.home.parameters, &self.home.drivers],
            [&self.parameters, &self.drivers],
        );
        self.solver.start(&self.home, &path)?;
        Ok(self.solver.pose().q.clone())
    }

    /// Goes to the end but for whole turns, then follows these turns, or infers them from the first
    /// ones if these repeat themselves.
    fn follow_turns(&mut self) -> Result<Vec<f64>, Stop> {
        self.solver.restore(&self.home);
        let mechanism = Arc::clone(self.solver.mechanism());
        let ends = self.home.drivers.iter().zip(&self.drivers);
        let turns: Vec<f64> = ends
            .zip(&mechanism.drivers)
            .map(|((from, to), driver)| {
                let is_angle = driver.coordinate.kind.is_angle();
                if is_angle {
                    ((to - from) / TAU).trunc()
                } else {
                    0.0
                }
            })
            .collect();
        let mut now: Vec<f64> = self.drivers.clone();
        for (value, turns) in now.iter_mut().zip(&turns) {
            *value -= TAU * turns;
        }
        self.go(&self.parameters.clone(), &now, TINY)?;
        let mut added = vec![0.0; self.home.q.len()];
        for (driver, count) in turns.iter().enumerate().filter(|(_, turns)| **turns != 0.0) {
            let per_turn = TAU.copysign(*count);
            let mut poses = vec![self.solver.pose().clone()];
            let count = count.abs() as usize;
            while poses.len() <= count {
                now[driver] += per_turn;
                self.go(&self.parameters.clone(), &now, STEPS)?;
                poses.push(self.solver.pose().clone());
                let done = poses.len() - 1;
                let [first, last] = [&poses[0].q, &poses[done].q];
                let ways: Vec<f64> = last.iter().zip(first).map(|(b, a)| b - a).collect();
                let is_whole = |way: &f64| (way - TAU * (way / TAU).round()).abs() < 1e-8;
                if ways.iter().all(is_whole) {
                    let (times, rest) = ((count / done) as f64, count % done);
                    for (added, way) in added.iter_mut().zip(&ways) {
                        *added += times * TAU * (way / TAU).round();
                    }
                    now[driver] = poses[rest].drivers[driver];
                    self.solver.restore(&poses[rest]);
                    break;
                }
                if done >= MOST_TURNS && count > done + 1 {
                    return Err(Stop::Endless);
                }
            }
        }
        let q = self.solver.pose().q.iter().zip(&added);
        Ok(q.map(|(q, added)| q + added).collect())
    }

    /// Goes straight to the end, with all turns.
    fn follow_straight(&mut self, turns: f64) -> Result<Vec<f64>, Stop> {
        self.solver.restore(&self.home);
        if turns.abs() > 10.0 {
            return Err(Stop::Endless);
        }
        let steps = TINY + STEPS * turns.abs() as u32;
        self.go(&self.parameters.clone(), &self.drivers.clone(), steps)?;
        Ok(self.solver.pose().q.clone())
    }

    /// Moves parameters and drivers straight to these values in tiny steps.
    fn go(&mut self, parameters: &[f64], drivers: &[f64], steps: u32) -> Result<(), Stop> {
        let from = self.solver.pose().clone();
        for step in 1..=steps {
            let s = f64::from(step) / f64::from(steps);
            let between = |from: &[f64], to: &[f64]| -> Vec<f64> {
                let ends = from.iter().zip(to);
                ends.map(|(from, to)| from + s * (to - from)).collect()
            };
            let (parameters, drivers) = (
                between(&from.parameters, parameters),
                between(&from.drivers, drivers),
            );
            let here = self.solver.pose();
            let path = self.path([&here.parameters, &here.drivers], [&parameters, &drivers]);
            self.solver.track(&path).map_err(|blocked| {
                if is_given_up(&blocked) {
                    Stop::GivenUp
                } else {
                    Stop::Blocked
                }
            })?;
        }
        Ok(())
    }

    /// Returns the straight path between parameters and drivers.
    fn path(&self, from: [&[f64]; 2], to: [&[f64]; 2]) -> Path {
        let mut path = Path::new(self.solver.mechanism());
        path.from.copy_from_slice(from[0]);
        path.to.copy_from_slice(to[0]);
        for (driver_path, (from, to)) in path.driver_paths.iter_mut().zip(from[1].iter().zip(to[1]))
        {
            *driver_path = DriverPath::held(*to, *from);
        }
        path
    }
}
