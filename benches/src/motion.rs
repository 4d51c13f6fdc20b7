//! The same motion for biela and for the yardsticks.

use std::f64::consts::{FRAC_PI_3, TAU};
use std::sync::Arc;

use biela::kinematics::{Curve, Path, Rates, Solver};
use biela::mechanism::{Jet, Mechanism, Source};

use crate::generated::{BAR, BAR_ANGLE};

/// There and back again, for ever, in equal steps.
#[derive(Clone, Debug)]
pub struct Sweep {
    from: f64,
    step: f64,
    steps: u32,
    speed: f64,
    at: u32,
}

impl Sweep {
    /// A turn of a crank from 60° on at 10 rad/s.
    #[must_use]
    pub fn turn(steps: u32) -> Self {
        Self {
            from: FRAC_PI_3,
            step: TAU / f64::from(steps),
            steps,
            speed: 10.0,
            at: 0,
        }
    }

    /// A scissor lift from 30° to 60° in 10,000 steps, at 1 m/s.
    #[must_use]
    pub fn lift(cells: usize) -> Self {
        let height = |angle: f64| cells as f64 * BAR * angle.sin();
        Self {
            from: height(BAR_ANGLE),
            step: (height(2.0 * BAR_ANGLE) - height(BAR_ANGLE)) / 10_000.0,
            steps: 10_000,
            speed: 1.0,
            at: 0,
        }
    }

    /// The driver's next value and its rates.
    #[must_use]
    pub fn step(&mut self) -> Jet {
        // Little work: the yardsticks pay for it, too.
        self.at += 1;
        if self.at == 2 * self.steps {
            self.at = 0;
        }
        let back = self.at > self.steps;
        let done = if back {
            2 * self.steps - self.at
        } else {
            self.at
        };
        Jet::new(
            self.from + self.step * f64::from(done),
            [if back { -self.speed } else { self.speed }, 3.0],
        )
    }
}

/// A mechanism from its text.
///
/// # Panics
///
/// If it has errors.
#[must_use]
pub fn parse(text: &str) -> Arc<Mechanism> {
    match Mechanism::parse(&Source::new("bench.toml", text)) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(diagnostics) => panic!("{diagnostics:#?}"),
    }
}

/// A solver at its first pose, and a path on which nothing moves from there.
///
/// # Panics
///
/// If the mechanism does not close.
#[must_use]
pub fn set_up(text: &str) -> (Solver, Path) {
    let mechanism = parse(text);
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism).expect("the driver matches");
    solver.assemble(&path).expect("the mechanism closes");
    (solver, path)
}

/// A mechanism with one driver that biela moves.
#[derive(Debug)]
pub struct Moving {
    /// Stands at the last pose.
    pub solver: Solver,
    /// The rates there.
    pub rates: Rates,
    path: Path,
}

impl Moving {
    /// Assembles it.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let (solver, path) = set_up(text);
        Self {
            rates: Rates::new(solver.pose().q.len()),
            solver,
            path,
        }
    }

    /// Moves the driver to a value and gives all bodies the rates that go with its own. Returns
    /// the Newton iterations.
    ///
    /// # Panics
    ///
    /// If something is in the way.
    pub fn step(&mut self, driver: Jet) -> usize {
        self.path.curves[0] = Curve::Input {
            position: driver.value,
            velocity: 0.0,
            acceleration: 0.0,
            jump: self.solver.pose().drivers[0] - driver.value,
        };
        let progress = self
            .solver
            .track(&self.path)
            .expect("nothing is in the way");
        self.solver
            .solve_rates(|_| driver, &mut self.rates)
            .expect("the pose is regular");
        progress.iterations as usize
    }
}
