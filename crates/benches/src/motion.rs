//! The same motion for biela and for the yardsticks.

use std::f64::consts::{FRAC_PI_3, TAU};
use std::sync::Arc;

use biela::kinematics::{DriverPath, ForceParts, Forces, KnownMotion, Path, Rates, Solver};
use biela::mechanism::{Jet, Mechanism, Source};

use crate::generated::{BAR, BAR_ANGLE};

/// A driver that goes there and back again, for ever, in equal steps.
#[derive(Clone, Debug)]
pub struct Sweep {
    from: f64,
    step: f64,
    steps: u32,
    speed: f64,
    at: u32,
}

impl Sweep {
    /// Sweeps from one value to another in a number of steps, at a speed without sign.
    #[must_use]
    pub fn between(from: f64, to: f64, steps: u32, speed: f64) -> Self {
        Self {
            from,
            step: (to - from) / f64::from(steps),
            steps,
            speed: speed.copysign(to - from),
            at: 0,
        }
    }

    /// Turns a crank once from 60° on at 10 rad/s.
    #[must_use]
    pub fn turn(steps: u32) -> Self {
        Self::between(FRAC_PI_3, FRAC_PI_3 + TAU, steps, 10.0)
    }

    /// Raises a scissor lift from 30° to 60° at 1 m/s.
    #[must_use]
    pub fn lift(cells: usize, steps: u32) -> Self {
        let height = |angle: f64| cells as f64 * BAR * angle.sin();
        Self::between(height(BAR_ANGLE), height(2.0 * BAR_ANGLE), steps, 1.0)
    }

    /// Returns the driver's next value and its rates.
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

/// A mechanism that moves in steps.
pub trait Stepper {
    /// Moves the drivers to their values and computes pose, velocity and acceleration of all
    /// bodies for the drivers' rates.
    fn step(&mut self, drivers: &[Jet]);

    /// Coordinates of the last step, their first and their second rates: x, y, phi of all bodies,
    /// then the contacts of cams.
    fn state(&self) -> [Vec<f64>; 3];
}

/// Sorts outputs by order: positions, velocities, accelerations. `outputs` holds nine numbers per
/// body, then three for a contact.
#[must_use]
pub fn by_order(outputs: &[f64]) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|order| {
        let part = |each: &[f64]| {
            let size = each.len() / 3;
            each[size * order..][..size].to_vec()
        };
        outputs.chunks(9).flat_map(part).collect()
    })
}

/// Reads a mechanism.
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

/// Returns a solver at its first pose, and a path on which nothing moves from there.
///
/// # Panics
///
/// If the mechanism does not close.
#[must_use]
pub fn set_up(text: &str) -> (Solver, Path) {
    let mechanism = parse(text);
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism).expect("the drivers match");
    solver.assemble(&path).expect("the mechanism closes");
    (solver, path)
}

/// A mechanism that biela moves.
#[derive(Debug)]
pub struct Moving {
    /// The solver at the last pose.
    pub solver: Solver,
    rates: Rates,
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
}

impl Stepper for Moving {
    fn step(&mut self, drivers: &[Jet]) {
        let now = &self.solver.pose().drivers;
        for ((driver_path, driver), now) in self.path.driver_paths.iter_mut().zip(drivers).zip(now)
        {
            *driver_path = DriverPath::Input {
                position: driver.value,
                velocity: 0.0,
                acceleration: 0.0,
                jump: now - driver.value,
            };
        }
        self.solver
            .track(&self.path)
            .expect("nothing is in the way");
        self.solver
            .solve_rates(|driver| drivers[driver.index()], &mut self.rates)
            .expect("the pose is regular");
    }

    fn state(&self) -> [Vec<f64>; 3] {
        [
            &self.solver.pose().q,
            self.rates.velocity(),
            self.rates.acceleration(),
        ]
        .map(<[f64]>::to_vec)
    }
}

/// Returns the text of a mechanism whose bodies, in the file's order, have masses: mass, inertia and
/// centre of each.
///
/// # Panics
///
/// If the text has another number of bodies.
#[must_use]
pub fn with_masses(text: &str, masses: &[[f64; 4]]) -> String {
    let mut masses = masses.iter();
    let mut loaded = String::new();
    for line in text.lines() {
        loaded += line;
        loaded.push('\n');
        if line.starts_with("[bodies.") {
            let [mass, inertia, x, y] = masses.next().expect("a mass for each body");
            loaded += &format!("mass = {mass}\ninertia = {inertia}\ncenter = [{x}, {y}]\n");
        }
    }
    assert!(masses.next().is_none(), "a body for each mass");
    loaded
}

/// A mechanism that biela moves and of which it solves all forces.
#[derive(Debug)]
pub struct Loaded {
    /// The mechanism.
    pub moving: Moving,
    /// Forces of the last step.
    pub forces: Forces,
}

impl Loaded {
    /// Assembles it.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let moving = Moving::new(text);
        Self {
            forces: moving.solver.forces(),
            moving,
        }
    }
}

impl Stepper for Loaded {
    fn step(&mut self, drivers: &[Jet]) {
        self.moving.step(drivers);
        let Moving { solver, rates, .. } = &mut self.moving;
        let motion = KnownMotion {
            rates,
            driver_rates: drivers,
            inputs: &[],
        };
        solver
            .solve_forces(motion, ForceParts::ALL, &mut self.forces)
            .expect("the pose is regular");
    }

    fn state(&self) -> [Vec<f64>; 3] {
        self.moving.state()
    }
}
