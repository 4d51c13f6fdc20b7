//! Friction along coordinates and in joints.
//!
//! Along a coordinate it follows from the rate alone. In a joint it grows with the joint's reaction, and
//! this depends on it: the reactions are affine in the friction f of the joints that slide,
//! R = A + B f, so that
//!
//! > f_k = −s_k μ_k p_k(R_k) − d_k ċ_k, R_k = A_k + Σ B_kj f_j
//!
//! with s for the direction in which a joint slides, μ for its coefficient and the norm p for its
//! [pressure](crate::mechanism::Bearing::pressure). There is one solution where the matrix μ_k p_k(B_kj)
//! has eigenvalues below one: f is the fixed point of a contraction then.

use super::sensitivity::ForceSensitivity;
use crate::kinematics::error::Error;
use crate::kinematics::linear::{DenseLu, Factors};
use crate::kinematics::state::SINGULAR_HERE;
use crate::mechanism::{Dual, FrictionLaw, Mechanism, Number, ParameterId};

/// Newton steps, far more than the nearly linear equations take.
const MOST_STEPS: usize = 50;

/// All friction of a mechanism that sticks or slides, in the order of the file: each at its place.
#[derive(Debug, Default)]
pub struct Friction {
    list: Vec<Pair>,
    /// f.
    forces: Vec<f64>,
    /// R, of those in joints.
    reactions: Vec<[f64; 3]>,
    /// A.
    unloaded: Vec<[f64; 3]>,
    /// B, row by row.
    columns: Vec<[f64; 3]>,
    /// I − ∂f/∂R B of the friction that slides.
    factors: Option<DenseLu>,
    side: Vec<f64>,
    parameters: Vec<f64>,
    /// Whether redundant constraints may leave reactions open.
    is_open: bool,
    is_frozen: bool,
}

/// Friction between two bodies.
#[derive(Debug)]
struct Pair {
    name: String,
    law: Box<FrictionLaw>,
    /// Rate of its coordinate, and the direction in which it slides: zero where it rests.
    rate: f64,
    sign: f64,
}

impl Pair {
    /// Returns the force for a reaction of the joint, if it is in one.
    fn along<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        reaction: [N; 3],
        rate: N,
    ) -> N {
        let pressure = self.pressure(parameter, reaction);
        self.law.along(parameter, pressure, rate, self.sign)
    }

    /// Returns the largest force while it sticks, for a reaction of the joint, if it is in one.
    fn limit<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, reaction: [N; 3]) -> N {
        self.law.sticking(parameter) * self.pressure(parameter, reaction)
    }

    /// Returns the factor of its coefficients, for a reaction of the joint, if it is in one.
    fn pressure<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, reaction: [N; 3]) -> N {
        let bearing = self.law.bearing.as_ref();
        bearing.map_or(N::constant(1.0), |bearing| {
            bearing.pressure(parameter, reaction)
        })
    }

    /// Returns whether it slides in a joint.
    fn slides_in_joint(&self) -> bool {
        self.sign != 0.0 && self.law.bearing.is_some()
    }

    /// Returns the derivative of the force as the reaction changes.
    fn derivative(
        &self,
        value: &impl Fn(ParameterId) -> f64,
        reaction: [f64; 3],
        by: [f64; 3],
    ) -> f64 {
        if self.law.bearing.is_none() {
            return 0.0;
        }
        let parameter = |id: ParameterId| Dual::constant(value(id));
        let reaction = [0, 1, 2].map(|k| Dual::new(reaction[k], [by[k]]));
        let change = self
            .along(&parameter, reaction, Dual::constant(self.rate))
            .first();
        // A joint without a load begins to bear one: any slope of the norm leads on.
        if change.is_nan() { 0.0 } else { change }
    }

    /// Returns the error for a reason.
    fn fault(&self, reason: &'static str) -> Error {
        Error::NoForce {
            force: self.name.clone(),
            reason,
        }
    }
}

impl Friction {
    /// Makes the storage; redundant constraints leave the reactions `open`.
    pub(in crate::kinematics) fn new(mechanism: &Mechanism, open: bool) -> Self {
        let list = mechanism.forces.iter().filter_map(|force| {
            Some(Pair {
                name: force.name.clone(),
                law: Box::new(force.load.friction()?.clone()),
                rate: 0.0,
                sign: 0.0,
            })
        });
        let list: Vec<_> = list.collect();
        let count = list.len();
        Self {
            forces: vec![0.0; count],
            reactions: vec![[0.0; 3]; count],
            unloaded: vec![[0.0; 3]; count],
            columns: vec![[0.0; 3]; count * count],
            factors: (count > 0).then(|| DenseLu::new(count, 0)),
            side: vec![0.0; count],
            parameters: mechanism.default_parameters(),
            is_open: open,
            is_frozen: false,
            list,
        }
    }

    /// Returns whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the places of the friction in joints, each with the index of its joint.
    pub fn joints(&self) -> impl Iterator<Item = (usize, usize)> {
        let all = self.list.iter().enumerate();
        all.filter_map(|(place, own)| Some((place, own.law.bearing.as_ref()?.joint)))
    }

    /// Has friction in joints follow from the reactions of the last solution, which stay, or again from
    /// its own.
    pub fn freeze(&mut self, freeze: bool) {
        self.is_frozen = freeze;
    }

    /// Sets the parameters, before the motion.
    pub fn set_parameters(&mut self, parameters: &[f64]) {
        if !self.list.is_empty() {
            self.parameters.copy_from_slice(parameters);
        }
    }

    /// Returns whether a joint with friction slides.
    #[must_use]
    pub fn slides_in_joints(&self) -> bool {
        self.list.iter().any(Pair::slides_in_joint)
    }

    /// Sets the motion at a place: the rate of the coordinate, and the direction in which it slides, 1
    /// or −1, or zero where it rests.
    pub fn set_motion(&mut self, place: usize, rate: f64, sign: f64) {
        let own = &mut self.list[place];
        (own.rate, own.sign) = (rate, sign);
    }

    /// Returns the largest friction at a place while it sticks, in a joint for the reactions of the last
    /// solution \[N or N m\].
    #[must_use]
    pub fn limit(&self, place: usize) -> f64 {
        let value = |id: ParameterId| self.parameters[id.index()];
        self.list[place].limit(&value, self.reactions[place])
    }

    /// Returns the change of the [limit](Self::limit) at a place along a direction, from those of the
    /// parameters and of the forces.
    #[must_use]
    pub fn limit_change(
        &self,
        place: usize,
        parameter: &impl Fn(ParameterId) -> Dual,
        forces: &ForceSensitivity,
    ) -> f64 {
        let own = &self.list[place];
        let bearing = own.law.bearing.as_ref();
        let by = bearing.map_or([0.0; 3], |bearing| forces.reaction(bearing.joint));
        let reaction = [0, 1, 2].map(|k| Dual::new(self.reactions[place][k], [by[k]]));
        own.limit(parameter, reaction).first()
    }

    /// Solves all friction that slides. `respond` solves the reactions of [joints](Self::joints) for
    /// friction of these sizes, its last call for the solution. Allocates nothing unless it fails.
    ///
    /// # Errors
    ///
    /// Those of `respond`, and [`Error::NoForce`] where there is no single solution.
    pub fn solve<E: From<Error>>(
        &mut self,
        mut respond: impl FnMut(&[f64], &mut [[f64; 3]]) -> Result<(), E>,
    ) -> Result<(), E> {
        let in_joint = |own: &&Pair| own.law.bearing.is_some();
        if let (true, Some(own)) = (self.is_open, self.list.iter().find(in_joint)) {
            let fault = own.fault(
                "follows from reactions that redundant constraints leave indeterminate: \
                 `indeterminate = \"minimum_norm\"` in `[outputs]` chooses some",
            );
            return Err(fault.into());
        }
        let count = self.list.len();
        let value = |id: ParameterId| self.parameters[id.index()];
        let reactions = self.list.iter().zip(&self.reactions);
        for (force, (own, reaction)) in self.forces.iter_mut().zip(reactions) {
            *force = match own.law.bearing {
                Some(_) if !self.is_frozen => 0.0,
                _ => own.along(&value, *reaction, own.rate),
            };
        }
        respond(&self.forces, &mut self.unloaded)?;
        if self.is_frozen {
            return Ok(());
        }
        self.reactions.copy_from_slice(&self.unloaded);
        if !self.slides_in_joints() {
            return Ok(());
        }
        self.columns.fill([0.0; 3]);
        for column in 0..count {
            let own = &self.list[column];
            if !own.slides_in_joint() {
                continue;
            }
            // As large as friction is, so that rounding stays that of the reactions.
            let value = |id: ParameterId| self.parameters[id.index()];
            let size = own.along(&value, self.unloaded[column], own.rate).abs();
            let size = if size > 0.0 { size } else { 1.0 };
            self.forces[column] = size;
            respond(&self.forces, &mut self.reactions)?;
            self.forces[column] = 0.0;
            for (row, (with, without)) in self.reactions.iter().zip(&self.unloaded).enumerate() {
                self.columns[row * count + column] =
                    [0, 1, 2].map(|k| (with[k] - without[k]) / size);
            }
        }
        if !self.is_contraction() || !self.find() {
            let mut sliding = self.list.iter().filter(|own| own.slides_in_joint());
            let fault = sliding.next().map_or(SINGULAR_HERE, |own| {
                own.fault("jams here: the reaction that it makes has it grow without end")
            });
            return Err(fault.into());
        }
        let Self {
            forces, reactions, ..
        } = self;
        respond(forces, reactions)
    }

    /// Returns whether the matrix C_kj = μ_k p_k(B_kj), which has no negative entry, has eigenvalues below
    /// one: (I − C) y = 1 has a positive solution then, and only then. Uses the factors.
    fn is_contraction(&mut self) -> bool {
        let value = |id: ParameterId| self.parameters[id.index()];
        let count = self.list.len();
        let factors = self.factors.as_mut().expect("there is friction");
        factors.clear();
        for (row, own) in self.list.iter().enumerate() {
            factors.add(row, row, 1.0);
            let Some(bearing) = &own.law.bearing else {
                continue;
            };
            for column in 0..count {
                let pressure = bearing.pressure(&value, self.columns[row * count + column]);
                let coefficient = own.law.dry(&value, own.rate) * own.sign.abs();
                factors.add(row, column, -coefficient * pressure);
            }
        }
        self.side.fill(1.0);
        if factors.factorise(0.0).is_err() {
            return false;
        }
        factors.solve(&mut self.side);
        self.side.iter().all(|y| *y > 0.0)
    }

    /// Finds f by Newton–Raphson, with its factors at the solution. Returns whether it has come to an
    /// end.
    fn find(&mut self) -> bool {
        /// Part of the largest friction at which a change is rounding.
        const NO_STEP: f64 = 16.0 * f64::EPSILON;
        let value = |id: ParameterId| self.parameters[id.index()];
        let count = self.list.len();
        for _ in 0..MOST_STEPS {
            for (row, reaction) in self.reactions.iter_mut().enumerate() {
                *reaction = self.unloaded[row];
                let columns = &self.columns[row * count..][..count];
                for (column, force) in columns.iter().zip(&self.forces) {
                    for (reaction, column) in reaction.iter_mut().zip(column) {
                        *reaction += column * force;
                    }
                }
            }
            let factors = self.factors.as_mut().expect("there is friction");
            factors.clear();
            for (row, own) in self.list.iter().enumerate() {
                let reaction = self.reactions[row];
                self.side[row] = own.along(&value, reaction, own.rate) - self.forces[row];
                factors.add(row, row, 1.0);
                for column in 0..count {
                    let by = self.columns[row * count + column];
                    factors.add(row, column, -own.derivative(&value, reaction, by));
                }
            }
            if factors.factorise(0.0).is_err() {
                return false;
            }
            factors.solve(&mut self.side);
            let mut largest = 0.0_f64;
            let mut change = 0.0_f64;
            for (force, by) in self.forces.iter_mut().zip(&self.side) {
                *force += by;
                largest = largest.max(force.abs());
                change = change.max(by.abs());
            }
            if !largest.is_finite() {
                return false;
            }
            if change <= NO_STEP * largest {
                return true;
            }
        }
        false
    }

    /// Returns the changes of all friction along a direction, from the changes of the parameters and of the
    /// rates of the coordinates, and of that in joints from those of the forces where it stays as it is:
    /// without these it does. Belongs to the last solution.
    pub fn changes(
        &mut self,
        parameter: &impl Fn(ParameterId) -> Dual,
        rates: &[Dual],
        forces: Option<&ForceSensitivity>,
    ) -> &[f64] {
        for (row, own) in self.list.iter().enumerate() {
            let by = match (&own.law.bearing, forces) {
                _ if own.sign == 0.0 => None,
                (None, _) => Some([0.0; 3]),
                (Some(bearing), forces) => forces.map(|forces| forces.reaction(bearing.joint)),
            };
            self.side[row] = by.map_or(0.0, |by| {
                let reaction = [0, 1, 2].map(|k| Dual::new(self.reactions[row][k], [by[k]]));
                own.along(parameter, reaction, rates[row]).first()
            });
        }
        if forces.is_some() && self.slides_in_joints() {
            let factors = self.factors.as_mut().expect("there is friction");
            factors.solve(&mut self.side);
        }
        &self.side
    }
}
