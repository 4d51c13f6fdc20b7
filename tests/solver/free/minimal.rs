//! Lagrange's equations in minimal coordinates, from closed-form positions of the masses.
//!
//! With x(z, t) the places of all masses, M = Σ m xᵀ_z x_z and z̈ = M⁻¹ (Q − Σ m xᵀ_z b), where b is
//! the second derivative of x along z + ż t and Q the sum of forces times ∂(their coordinate)/∂z.

use std::convert::Infallible;

use biela::dynamics::integrator::{ErrorControl, Failure, Integrator, Method, System};
use nalgebra::{DMatrix, DVector};

use super::taylor::Taylor;

/// A body: its mass, its inertia about the centre of mass, x and y of that and its angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mass {
    pub(super) mass: f64,
    pub(super) inertia: f64,
    pub(super) at: [Taylor; 3],
}

/// All masses for the coordinates z at a time.
type Masses = fn(&[Taylor], Taylor) -> Vec<Mass>;
/// Coordinates along which forces act, with the forces.
type Loads = fn(&[Taylor], Taylor) -> Vec<(Taylor, f64)>;

/// A mechanism in minimal coordinates.
#[derive(Clone, Copy)]
pub(super) struct Minimal {
    pub(super) gravity: [f64; 2],
    pub(super) masses: Masses,
    pub(super) loads: Loads,
}

impl Minimal {
    /// The accelerations z̈.
    pub(super) fn accelerations(&self, t: f64, z: &[f64], rates: &[f64]) -> Vec<f64> {
        let moving = motion(z, rates);
        let now = Taylor::new(t, 1.0, 0.0);
        let masses = (self.masses)(&moving, now);
        let loads = (self.loads)(&moving, now);
        let count = z.len();
        let along: Vec<_> = (0..count)
            .map(|k| {
                let direction: Vec<_> = (0..count).map(|j| f64::from(u8::from(j == k))).collect();
                let z = motion(z, &direction);
                let held = Taylor::from(t);
                ((self.masses)(&z, held), (self.loads)(&z, held))
            })
            .collect();
        let mut matrix = DMatrix::zeros(count, count);
        let mut right = DVector::zeros(count);
        for row in 0..count {
            let (parts, efforts) = &along[row];
            for (part, mass) in parts.iter().zip(&masses) {
                let weights = [mass.mass, mass.mass, mass.inertia];
                let pull = [self.gravity[0], self.gravity[1], 0.0];
                for c in 0..3 {
                    let force = weights[c] * (pull[c] - mass.at[c].second);
                    right[row] += part.at[c].first * force;
                }
            }
            for ((coordinate, _), (_, force)) in efforts.iter().zip(&loads) {
                right[row] += coordinate.first * force;
            }
            for column in 0..count {
                for (a, b) in parts.iter().zip(&along[column].0) {
                    let weights = [a.mass, a.mass, a.inertia];
                    for ((weight, a), b) in weights.iter().zip(&a.at).zip(&b.at) {
                        matrix[(row, column)] += weight * a.first * b.first;
                    }
                }
            }
        }
        let solved = matrix.cholesky().expect("every coordinate moves a mass");
        solved.solve(&right).as_slice().to_vec()
    }

    /// The kinetic energy.
    pub(super) fn kinetic_energy(&self, t: f64, z: &[f64], rates: &[f64]) -> f64 {
        let masses = (self.masses)(&motion(z, rates), Taylor::new(t, 1.0, 0.0));
        let of = |mass: &Mass| {
            let [x, y, phi] = mass.at.map(|c| c.first * c.first);
            0.5 * (mass.mass * (x + y) + mass.inertia * phi)
        };
        masses.iter().map(of).sum()
    }

    /// Values and velocities at each of some rising times, from those at the first one.
    pub(super) fn motion(&self, start: &[f64], times: &[f64]) -> Vec<Vec<f64>> {
        let control = ErrorControl::new(1e-13, vec![1.0; start.len()]).expect("valid options");
        let mut integrator =
            Integrator::new(Method::Explicit, control, times[0], start.to_vec()).expect("valid");
        let mut system = *self;
        let states = times.iter().map(|time| {
            while integrator.state().t.to_bits() != time.to_bits() {
                integrator.advance(&mut system, *time).expect("a step");
            }
            integrator.state().x.clone()
        });
        states.collect()
    }
}

impl System for Minimal {
    type Cause = Infallible;

    fn derivatives(
        &mut self,
        t: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<Infallible>> {
        let (z, rates) = x.split_at(x.len() / 2);
        let (dz, rates_of_rates) = dx.split_at_mut(x.len() / 2);
        dz.copy_from_slice(rates);
        rates_of_rates.copy_from_slice(&self.accelerations(t, z, rates));
        Ok(())
    }
}

/// Coordinates that move at constant rates.
fn motion(z: &[f64], rates: &[f64]) -> Vec<Taylor> {
    let pairs = z.iter().zip(rates);
    pairs.map(|(z, rate)| Taylor::new(*z, *rate, 0.0)).collect()
}

/// No forces but gravity.
pub(super) fn unloaded(_: &[Taylor], _: Taylor) -> Vec<(Taylor, f64)> {
    Vec::new()
}

/// A point at a distance from another in the direction of an angle.
pub(super) fn from(origin: [Taylor; 2], distance: f64, angle: Taylor) -> [Taylor; 2] {
    [
        origin[0] + distance * angle.cos(),
        origin[1] + distance * angle.sin(),
    ]
}

/// A body with this frame and centre of mass in it.
pub(super) fn body(mass: f64, inertia: f64, frame: [Taylor; 3], center: [f64; 2]) -> Mass {
    let [x, y, phi] = frame;
    let (sin, cos) = (phi.sin(), phi.cos());
    Mass {
        mass,
        inertia,
        at: [
            x + center[0] * cos - center[1] * sin,
            y + center[0] * sin + center[1] * cos,
            phi,
        ],
    }
}
