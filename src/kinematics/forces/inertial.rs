//! Masses, and the forces that they demand for a motion.

use crate::kinematics::error::Error;
use crate::mechanism::{Expression, Mechanism, Number, ParameterId};

/// The masses of a mechanism with the parameters in force.
#[derive(Clone, Debug)]
pub(super) struct Masses<N> {
    /// Bodies with a mass, ascending.
    pub(super) bodies: Vec<MassProperties<N>>,
    /// Acceleration of gravity \[m/s²\].
    pub(super) gravity: [N; 2],
}

/// Mass of one body and its distribution. Motions and forces are about the body's origin, in ground
/// axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassProperties<N> {
    /// Index of the body.
    pub(super) body: usize,
    mass: N,
    /// About the centre of mass.
    inertia: N,
    /// Centre of mass in the body's frame.
    center: [N; 2],
    /// From the body's origin to the centre of mass.
    arm: [N; 2],
}

impl<N: Number> Masses<N> {
    /// Evaluates the masses of a mechanism, of bodies that have not been [turned](MassProperties::turn).
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
                    arm: [zero; 2],
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
            let body = &mechanism.bodies[of_body.body];
            of_body.mass = optional(&body.mass);
            of_body.inertia = optional(&body.inertia);
            let center = body
                .center
                .as_ref()
                .map(|center| center.each_ref().map(value));
            of_body.center = center.unwrap_or([N::constant(0.0); 2]);
        }
    }
}

impl Masses<f64> {
    /// Adds to what bodies demand that for an acceleration of a driver, along which they move by
    /// `unit`. Returns the inertia that the driver feels.
    #[inline]
    pub(super) fn load(&self, unit: &[f64], acceleration: f64, demand: &mut [f64]) -> f64 {
        let (units, (demand, _)) = (by_body(unit), demand.as_chunks_mut());
        let mut inertia = [0.0; 3];
        for of_body in &self.bodies {
            let unit = units[of_body.body];
            let momentum = of_body.momentum(unit);
            add(&mut inertia, [0, 1, 2].map(|k| unit[k] * momentum[k]));
            let force = momentum.map(|momentum| momentum * acceleration);
            add(&mut demand[of_body.body], force);
        }
        inertia[0] + inertia[1] + inertia[2]
    }

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
    /// Turns the body to the cosine and sine of phi.
    #[inline]
    pub(super) fn turn(&mut self, [cos, sin]: [N; 2]) {
        let [x, y] = self.center;
        self.arm = [cos * x - sin * y, sin * x + cos * y];
    }

    /// Returns M v: momentum, and angular momentum.
    #[inline]
    pub(super) fn momentum(&self, [vx, vy, omega]: [N; 3]) -> [N; 3] {
        let [x, y] = self.arm;
        let px = self.mass * (vx - omega * y);
        let py = self.mass * (vy + omega * x);
        [px, py, self.inertia * omega + x * py - y * px]
    }

    /// Returns M q̈ − Q_v − Q of gravity for these accelerations: force and torque. With the arm s
    /// the force is m (a − g) with a = r̈ + alpha perp(s) − omega² s, the torque
    /// J alpha + s × m (a − g).
    #[inline]
    pub(super) fn demand(&self, omega: N, [ax, ay, alpha]: [N; 3], [gx, gy]: [N; 2]) -> [N; 3] {
        let [x, y] = self.arm;
        let square = omega * omega;
        self.momentum([ax - gx - square * x, ay - gy - square * y, alpha])
    }

    /// Returns the kinetic energy, and the potential energy of gravity, zero at ground's origin.
    #[inline]
    pub(super) fn energies(&self, [px, py]: [N; 2], velocity: [N; 3], [gx, gy]: [N; 2]) -> [N; 2] {
        let [x, y] = self.arm;
        let momentum = self.momentum(velocity);
        let product =
            momentum[0] * velocity[0] + momentum[1] * velocity[1] + momentum[2] * velocity[2];
        [
            product * 0.5,
            -(self.mass * (gx * (px + x) + gy * (py + y))),
        ]
    }
}

/// Returns a list with an entry per unknown by body, without the unknowns that are no body's.
#[inline]
pub(super) fn by_body(list: &[f64]) -> &[[f64; 3]] {
    list.as_chunks().0
}

/// Adds a force and a torque.
#[inline]
pub(super) fn add(to: &mut [f64; 3], force: [f64; 3]) {
    for (to, force) in to.iter_mut().zip(force) {
        *to += force;
    }
}

/// Returns the power of forces on bodies in a motion, with an entry per unknown each.
#[inline]
pub(super) fn virtual_power(motion: &[f64], forces: &[f64]) -> f64 {
    // A sum for each coordinate: none waits for another.
    let mut sums = [0.0; 3];
    for (motion, force) in by_body(motion).iter().zip(by_body(forces)) {
        add(&mut sums, [0, 1, 2].map(|k| motion[k] * force[k]));
    }
    sums[0] + sums[1] + sums[2]
}
