//! Masses, and the forces that they demand for a motion.

use super::results::DriverForces;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::error::Error;
use crate::mechanism::{BodyId, Expression, Mechanism, Number, ParameterId};

/// The masses of a mechanism with the parameters in force.
#[derive(Clone, Debug)]
pub(super) struct Masses<N> {
    /// Per body; zero for a body without mass.
    pub(super) bodies: Vec<MassProperties<N>>,
    /// Acceleration of gravity \[m/s²\].
    pub(super) gravity: [N; 2],
}

/// Mass of one body and its distribution. Motions and forces are about the body's origin, in ground
/// axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassProperties<N> {
    mass: N,
    /// About the centre of mass.
    inertia: N,
    /// Centre of mass in the body's frame.
    center: [N; 2],
    /// From the body's origin to the centre of mass.
    arm: [N; 2],
}

/// The drivers, and the forces on them that are sought.
pub(super) struct DriverLoads<'a> {
    /// ∂q/∂u by body: that of the first body for each driver, that of the second, …
    pub(super) units: &'a [[f64; 3]],
    /// Per driver: the acceleration of an input, zero for a prescribed motion.
    pub(super) free: &'a [f64],
    /// Forces of each driver, to which is added.
    pub(super) forces: &'a mut [DriverForces],
}

impl<N: Number> Masses<N> {
    /// Evaluates the masses of a mechanism, of bodies that have not been [turned](MassProperties::turn).
    pub(super) fn new(mechanism: &Mechanism, parameter: &impl Fn(ParameterId) -> N) -> Self {
        let zero = N::constant(0.0);
        let massless = MassProperties {
            mass: zero,
            inertia: zero,
            center: [zero; 2],
            arm: [zero; 2],
        };
        let mut masses = Self {
            bodies: vec![massless; mechanism.bodies.len()],
            gravity: [zero; 2],
        };
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
        self.gravity = mechanism.simulation.gravity.each_ref().map(value);
        for (of_body, id) in self.bodies.iter_mut().zip((0..).map(BodyId)) {
            let Some(weight) = mechanism.weight(id, parameter) else {
                continue;
            };
            of_body.mass = weight.mass;
            of_body.inertia = weight.inertia;
            of_body.center = weight.center;
        }
    }
}

impl Masses<f64> {
    /// Turns the bodies, adds M q̈ − Q_v to w (`demand`), and adds their energies. `coasting` holds
    /// q̈ without the accelerations of inputs. The bias of each driver is the power of w for
    /// `coasting`; w then also receives the accelerations of inputs, and gives the efforts.
    // Inlined, the sums of a single driver stay in registers.
    #[inline(always)]
    pub(super) fn load(
        &mut self,
        at: &Configuration,
        velocities: &[f64],
        coasting: impl Iterator<Item = [f64; 3]>,
        drivers: DriverLoads<'_>,
        demand: &mut [f64],
        energies: &mut [f64; 2],
    ) {
        let DriverLoads {
            mut units,
            free,
            forces,
        } = drivers;
        let gravity = self.gravity;
        let motions = by_body(velocities).iter().zip(coasting);
        let places = at.frames().iter().zip(demand.as_chunks_mut().0);
        let bodies = self.bodies.iter_mut().zip(places).zip(motions);
        for ((of_body, (frame, demand)), (velocity, acceleration)) in bodies {
            of_body.turn([frame.cos, frame.sin]);
            let own = of_body.energies(frame.origin.into(), *velocity, gravity);
            *energies = [energies[0] + own[0], energies[1] + own[1]];
            let mut sum = of_body.demand(velocity[2], acceleration, gravity);
            add(&mut sum, *demand);
            let coasting = sum;
            let (own_units, others) = units.split_at(free.len());
            units = others;
            for ((forces, unit), free) in forces.iter_mut().zip(own_units).zip(free) {
                let momentum = of_body.momentum(*unit);
                forces.bias += power(*unit, coasting);
                forces.inertia += power(*unit, momentum);
                add(&mut sum, momentum.map(|momentum| momentum * free));
            }
            for (forces, unit) in forces.iter_mut().zip(own_units) {
                forces.effort += power(*unit, sum);
            }
            *demand = sum;
        }
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
        let bodies = self.bodies.iter().zip(&mechanism.bodies);
        for (of_body, body) in bodies.filter(|(_, body)| body.has_mass()) {
            let name = &body.name;
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
    /// Returns the numbers that the file gives.
    pub(super) fn numbers(&self) -> [N; 4] {
        [self.mass, self.inertia, self.center[0], self.center[1]]
    }

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
    pub(super) fn demand(&self, omega: N, acceleration: [N; 3], gravity: [N; 2]) -> [N; 3] {
        self.momentum(self.felt(omega, acceleration, gravity))
    }

    /// Returns q̈ without the acceleration of gravity, and with the centre's centripetal one.
    #[inline]
    pub(super) fn felt(&self, omega: N, [ax, ay, alpha]: [N; 3], [gx, gy]: [N; 2]) -> [N; 3] {
        let [x, y] = self.arm;
        let square = omega * omega;
        [ax - gx - square * x, ay - gy - square * y, alpha]
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

impl MassProperties<f64> {
    /// Returns the kinetic energies at 1 m/s without turning, and at 1 rad/s about the centre of mass.
    #[inline]
    pub(super) fn at_unit_speeds(&self) -> [f64; 2] {
        [0.5 * self.mass, 0.5 * self.inertia]
    }

    /// Returns √M v, for the root of M that belongs to the centre of mass: the product of two of them is
    /// that of one with the momentum of the other.
    #[inline]
    pub(super) fn weighted(&self, [vx, vy, omega]: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.arm;
        let mass = self.mass.sqrt();
        [
            mass * (vx - omega * y),
            mass * (vy + omega * x),
            self.inertia.sqrt() * omega,
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

/// Returns the power of a force and a torque in a motion.
#[inline]
pub(super) fn power(motion: [f64; 3], force: [f64; 3]) -> f64 {
    motion[0] * force[0] + motion[1] * force[1] + motion[2] * force[2]
}
