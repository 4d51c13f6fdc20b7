//! Free motion: the same method for biela and for accelerations in C.

use std::convert::Infallible;

use biela::dynamics::integrator::{ErrorControl, Failure, Integrator, Method, System};
use biela::dynamics::{FreeMotion, Given};
use biela::kinematics::{Solution, Solver};
use biela::mechanism::{DriverId, Jet};

use crate::by_hand::{four_bar_acceleration, four_bar_masses, pendulum_acceleration};
use crate::motion::{set_up, with_masses};
use crate::shipped;

/// Relative tolerance of both.
const TOLERANCE: f64 = 1e-8;
/// Time between two steps of a host \[s\]; the integrator's own are about as long.
const STEP: f64 = 0.01;

/// A pendulum of 1 kg at 1 m that is let go in level position (IFToMM, benchmark A01).
const PENDULUM: &str = r#"
format = 1
name = "pendulum"
ground.markers = { O = [0, 0] }
bodies.rod = { mass = 1, center = [1, 0], markers = { O = [0, 0] } }
joints.O = { type = "revolute", markers = ["ground.O", "rod.O"] }
freedoms.swing = { coordinate = "angle", markers = ["ground.O", "rod.O"], start = 0 }
"#;

/// A motion that goes on in steps of a host.
pub trait Motion {
    /// Moves on by one step of the host.
    fn step(&mut self);

    /// Returns angle and velocity of the freedom.
    fn state(&self) -> [f64; 2];
}

/// A mechanism that biela moves by its forces.
#[derive(Debug)]
pub struct Free {
    solver: Solver,
    solution: Solution,
    motion: FreeMotion,
    steps: u32,
}

/// No inputs.
struct Nothing;

impl Given for Nothing {
    fn driver(&self, _: DriverId, _: f64) -> Jet {
        unreachable!("all drivers are freedoms")
    }

    fn loads(&self, _: f64, _: &mut [f64]) {}
}

impl Free {
    /// The pendulum.
    #[must_use]
    pub fn pendulum() -> Self {
        Self::new(PENDULUM)
    }

    /// The four-bar of `mechanisms/four_bar.toml` with masses, let go at 60°.
    #[must_use]
    pub fn four_bar() -> Self {
        let text = with_masses(shipped!("four_bar"), &four_bar_masses());
        Self::new(&text.replace("[drivers]", "[freedoms]"))
    }

    fn new(text: &str) -> Self {
        let (mut solver, _) = set_up(text);
        let motion = FreeMotion::new(&solver, TOLERANCE).expect("a tolerance");
        let mut motion = motion.expect("there is a freedom");
        motion.start(&mut solver, &Nothing).expect("it has mass");
        Self {
            solution: Solution::new(&solver),
            solver,
            motion,
            steps: 0,
        }
    }
}

impl Motion for Free {
    fn step(&mut self) {
        self.steps += 1;
        let until = STEP * f64::from(self.steps);
        let Self {
            solver,
            solution,
            motion,
            ..
        } = self;
        let moved = motion.advance(solver, solution, &Nothing, until);
        moved.expect("nothing is in the way");
    }

    fn state(&self) -> [f64; 2] {
        let driver = self.motion.drivers()[0];
        [driver.value, driver.first()]
    }
}

/// A motion whose acceleration C computes.
#[derive(Debug)]
pub struct ByHand {
    integrator: Integrator,
    acceleration: Acceleration,
    steps: u32,
}

/// The acceleration at an angle and a velocity.
#[derive(Clone, Copy, Debug)]
struct Acceleration(fn(f64, f64) -> f64);

impl System for Acceleration {
    type Cause = Infallible;

    fn derivatives(
        &mut self,
        _: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<Infallible>> {
        dx[0] = x[1];
        dx[1] = (self.0)(x[0], x[1]);
        Ok(())
    }
}

impl ByHand {
    /// The pendulum.
    #[must_use]
    pub fn pendulum() -> Self {
        Self::new(0.0, |angle, _| pendulum_acceleration(angle))
    }

    /// The four-bar.
    #[must_use]
    pub fn four_bar() -> Self {
        Self::new(60.0_f64.to_radians(), four_bar_acceleration)
    }

    fn new(angle: f64, acceleration: fn(f64, f64) -> f64) -> Self {
        let control = ErrorControl::new(TOLERANCE, vec![1.0; 2]).expect("a tolerance");
        let start = vec![angle, 0.0];
        let integrator = Integrator::new(Method::Explicit, control, 0.0, start);
        Self {
            integrator: integrator.expect("a start"),
            acceleration: Acceleration(acceleration),
            steps: 0,
        }
    }
}

impl Motion for ByHand {
    fn step(&mut self) {
        self.steps += 1;
        let until = STEP * f64::from(self.steps);
        while self.integrator.state().t.to_bits() != until.to_bits() {
            let step = self.integrator.advance(&mut self.acceleration, until);
            step.expect("it is smooth");
        }
    }

    fn state(&self) -> [f64; 2] {
        let x = &self.integrator.state().x;
        [x[0], x[1]]
    }
}
