//! Masses, and the forces that they demand for a motion.

use crate::kinematics::error::Error;
use crate::mechanism::{Body, Expression, Mechanism, Number, ParameterId};

/// The masses of a mechanism with the parameters in force.
#[derive(Clone, Debug)]
pub(super) struct Masses<N> {
    /// Bodies with a mass, ascending.
    pub(super) bodies: Vec<MassProperties<N>>,
    /// Acceleration of gravity \[m/s²\].
    pub(super) gravity: [N; 2],
}

/// Mass of one body and its distribution.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassProperties<N> {
    /// Index of the body.
    pub(super) body: usize,
    mass: N,
    /// About the centre of mass.
    inertia: N,
    /// Centre of mass in the body's frame.
    center: [N; 2],
}

/// Motion of one body.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyMotion<N> {
    /// x, y \[m\] and phi \[rad\].
    pub(super) position: [N; 3],
    /// Cosine and sine of phi.
    pub(super) direction: [N; 2],
    pub(super) velocity: [N; 3],
}

impl<N: Number> Masses<N> {
    /// Evaluates the masses of a mechanism.
    pub(super) fn new(mechanism: &Mechanism, parameter: &impl Fn(ParameterId) -> N) -> Self {
        let zero = N::constant(0.0);
        let mut masses = Self {
            bodies: Vec::new(),
            gravity: [zero; 2],
        };
        for (body, definition) in mechanism.bodies.iter().enumerate() {
            if definition.mass.is_some() {
                masses.bodies.push(MassProperties {
                    body,
                    mass: zero,
                    inertia: zero,
                    center: [zero; 2],
                });
            }
        }
        masses.set_parameters(mechanism, parameter);
        masses
    }

    /// Evaluates the masses for other parameters. Allocates nothing.
    pub(super) fn set_parameters(
        &mut self,
        mechanism: &Mechanism,
        parameter: &impl Fn(ParameterId) -> N,
    ) {
        let value = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        let optional =
            |expression: &Option<Expression>| expression.as_ref().map_or(N::constant(0.0), value);
        self.gravity = mechanism.simulation.gravity.each_ref().map(value);
        for of_body in &mut self.bodies {
            let Body {
                mass,
                inertia,
                center,
                ..
            } = &mechanism.bodies[of_body.body];
            of_body.mass = optional(mass);
            of_body.inertia = optional(inertia);
            let center = center.as_ref().map(|center| center.each_ref().map(value));
            of_body.center = center.unwrap_or([N::constant(0.0); 2]);
        }
    }
}

impl Masses<f64> {
    /// Checks that gravity and masses have values that they can have.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::Mass`].
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<(), Error> {
        if !self.gravity.iter().all(|g| g.is_finite()) {
            return Err(Error::NotFinite {
                what: "`gravity`".to_owned(),
            });
        }
        for of_body in &self.bodies {
            let name = &mechanism.bodies[of_body.body].name;
            let values = [of_body.mass, of_body.inertia]
                .into_iter()
                .chain(of_body.center);
            if !values.fold(0.0, |sum, value| sum + value).is_finite() {
                return Err(Error::NotFinite {
                    what: format!("the mass, inertia or center of body `{name}`"),
                });
            }
            for (quantity, value, holds, demand) in [
                ("mass", of_body.mass, of_body.mass > 0.0, "be positive"),
                (
                    "inertia",
                    of_body.inertia,
                    of_body.inertia >= 0.0,
                    "not be negative",
                ),
            ] {
                if !holds {
                    return Err(Error::Mass {
                        what: format!("the {quantity} of body `{name}`"),
                        value,
                        demand,
                    });
                }
            }
        }
        Ok(())
    }
}

impl<N: Number> MassProperties<N> {
    /// Returns the vector from the body's origin to the centre of mass, in ground axes.
    fn arm(&self, [cos, sin]: [N; 2]) -> [N; 2] {
        let [x, y] = self.center;
        [cos * x - sin * y, sin * x + cos * y]
    }

    /// Returns M q̈ − Q_v − Q of gravity for these accelerations: force, and torque about the
    /// body's origin. With the arm s to the centre of mass the force is m (a − g) with
    /// a = r̈ + alpha perp(s) − omega² s, the torque J alpha + s × m (a − g).
    pub(super) fn demand(
        &self,
        direction: [N; 2],
        omega: N,
        [ax, ay, alpha]: [N; 3],
        [gx, gy]: [N; 2],
    ) -> [N; 3] {
        let [x, y] = self.arm(direction);
        let square = omega * omega;
        let fx = self.mass * (ax - gx - alpha * y - square * x);
        let fy = self.mass * (ay - gy + alpha * x - square * y);
        [fx, fy, self.inertia * alpha + x * fy - y * fx]
    }

    /// Returns M v.
    pub(super) fn momentum(&self, direction: [N; 2], velocity: [N; 3]) -> [N; 3] {
        let zero = N::constant(0.0);
        self.demand(direction, zero, velocity, [zero; 2])
    }

    /// Returns the kinetic energy, and the potential energy of gravity, zero at ground's origin.
    pub(super) fn energies(&self, motion: BodyMotion<N>, [gx, gy]: [N; 2]) -> [N; 2] {
        let [x, y] = self.arm(motion.direction);
        let [px, py, _] = motion.position;
        let momentum = self.momentum(motion.direction, motion.velocity);
        let product = momentum[0] * motion.velocity[0]
            + momentum[1] * motion.velocity[1]
            + momentum[2] * motion.velocity[2];
        [
            product * 0.5,
            -(self.mass * (gx * (px + x) + gy * (py + y))),
        ]
    }
}
