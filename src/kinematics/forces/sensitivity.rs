//! Derivatives of forces along a direction, by dual numbers and the factors at hand.
//!
//! Along a direction Phi_qᵀ δλ = δw − (δPhi_qᵀ) λ and, for the inertias, Phi_q δ(∂q/∂u) =
//! −(δPhi_q) ∂q/∂u. The entry of a row at q_k is the rate ċ for q̇ = e_k, so that the change of the
//! relation's rate is the change of its gradient.

use nalgebra::{DMatrix, DVector};

use super::applied::{ActsAt, Circumstances, about_origin, is_at_zero};
use super::inertial::Masses;
use super::results::shares;
use super::solve::{ForceParts, Forces, KnownMotion, Loads};
use super::wrench::Wrench;
use crate::kinematics::analysis::{Direction, Sensitivity};
use crate::kinematics::constraint::moving_configuration::{
    Bodies, CurvesAlong, Varied, VariedConfiguration, VariedMechanism,
};
use crate::kinematics::constraint::{Constraint, Gradient, of_coordinate, partial};
use crate::kinematics::error::{Error, NoLimit};
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::singular::{Kind, near_point};
use crate::kinematics::state::{SINGULAR_HERE, State};
use crate::kinematics::system::System;
use crate::mechanism::{
    BodyId, Coordinate, CoordinateKind, DriverId, Dual, ForceQuantity, Load, Mechanism, Number,
    ParameterId, Reported,
};

/// The derivatives of all forces along a direction.
#[derive(Debug)]
pub struct ForceSensitivity {
    /// Effort, power, inertia and bias of each driver, then the other parts in their order.
    values: Vec<f64>,
    places: Places,
    /// The cause of derivatives that are not numbers.
    fault: Error,
    /// Largest scaled change of the motion.
    change: f64,
}

/// Index of the first number of each part.
#[derive(Clone, Debug)]
struct Places {
    reactions: usize,
    held: usize,
    /// Per joint.
    shares: Vec<usize>,
    sizes: usize,
    energies: usize,
}

impl Places {
    fn new(mechanism: &Mechanism) -> Self {
        let reactions = 4 * mechanism.drivers.len();
        let held = reactions + 3 * mechanism.joints.len();
        let mut sizes = held + mechanism.constraints.len();
        let shares = shares(mechanism).into_iter();
        let shares = shares.map(|own| {
            sizes += own.len();
            sizes - own.len()
        });
        let shares = shares.collect();
        Self {
            reactions,
            held,
            shares,
            sizes,
            energies: sizes + 3 * mechanism.forces.len(),
        }
    }

    /// Returns the index of a quantity.
    fn of(&self, quantity: ForceQuantity) -> usize {
        match quantity {
            ForceQuantity::Effort(driver) => 4 * driver.index(),
            ForceQuantity::Power(driver) => 4 * driver.index() + 1,
            ForceQuantity::Inertia(driver) => 4 * driver.index() + 2,
            ForceQuantity::Bias(driver) => 4 * driver.index() + 3,
            ForceQuantity::Reaction(joint, component) => self.reactions + 3 * joint + component,
            ForceQuantity::Held(constraint) => self.held + constraint,
            ForceQuantity::Share(joint, place) => self.shares[joint] + place,
            ForceQuantity::Applied(force, component) => self.sizes + 3 * force + component,
            ForceQuantity::Pushes(..) => unreachable!("a sum has no index"),
            ForceQuantity::KineticEnergy => self.energies,
            ForceQuantity::PotentialEnergy => self.energies + 1,
        }
    }

    /// Returns the kind of a number next to a change point. Potential energies and sizes of forces
    /// depend on positions, kinetic energies and inertias on velocities, efforts on accelerations,
    /// and reactions have a pole more.
    fn kind(&self, index: usize) -> Kind {
        let level = match index {
            _ if index == self.energies => 1,
            _ if index >= self.sizes => 0,
            _ if index >= self.reactions => 3,
            _ if index % 4 == 2 => 1,
            _ => 2,
        };
        Kind { group: 0, level }
    }
}

/// Entries of a row of the Jacobian.
type Entries = Vec<(usize, Dual)>;

impl ForceSensitivity {
    /// Returns the derivative of a quantity, not a number where it has none.
    pub(in crate::kinematics) fn raw_change(&self, quantity: ForceQuantity) -> f64 {
        match quantity {
            ForceQuantity::Pushes(first, end) => {
                let pushes = (first..end).map(|k| ForceQuantity::Applied(k, 0));
                pushes.map(|push| self.raw_change(push)).sum()
            }
            quantity => self.values[self.places.of(quantity)],
        }
    }

    /// Returns the changes of force and torque that a joint exerts at its second marker.
    #[must_use]
    pub fn reaction(&self, joint: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| self.raw_change(ForceQuantity::Reaction(joint, k)))
    }

    /// Returns the derivative of a quantity.
    ///
    /// # Errors
    ///
    /// [`Error::NoDerivative`] where an expression has none, [`Error::ChangePoint`] where it has no
    /// limit at a change point.
    pub fn change(&self, quantity: ForceQuantity) -> Result<f64, Error> {
        let value = self.raw_change(quantity);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.fault.clone())
        }
    }
}

/// The mechanism at rest along the direction.
struct Probe<'a> {
    at: VariedConfiguration,
    curves: &'a CurvesAlong,
    gradient: Gradient,
}

impl Probe<'_> {
    /// Returns the gradient of a relation with its change.
    fn entries(&mut self, relation: &dyn Constraint, state: &State) -> Entries {
        self.gradient.clear();
        relation.gradient(&state.at, &mut self.gradient);
        let columns: Vec<usize> = self.gradient.entries().map(|(column, _)| column).collect();
        let entry = |column| (column, partial(relation, &mut self.at, self.curves, column));
        columns.into_iter().map(entry).collect()
    }
}

impl Forces {
    /// Returns the derivatives of all forces along a direction.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](Self::solve) apart from [`Error::ChangePoint`], and [`Error::Singular`]
    /// where reactions of least norm do not exist.
    pub(in crate::kinematics) fn sensitivity(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
        direction: &Direction,
    ) -> Result<ForceSensitivity, Error> {
        let Some(point) = near_point(compiled, state) else {
            return self.solved_sensitivity(compiled, state, motion, direction);
        };
        let efforts = ForceParts {
            efforts: true,
            reactions: false,
        };
        self.solve(compiled, state, motion, efforts)?;
        let places = Places::new(&self.mechanism);
        let mut loads = Loads::new(motion.inputs, &self.results.demand);
        // Numbers that are zero are rounding of the loads: with one more number, a part of these as far
        // as the bodies turn, they do not compare with rounding.
        const PART_OF_LOADS: f64 = 1e-3;
        let found = point.interpolate(
            compiled,
            state,
            motion.driver_rates,
            |index| places.kind(index),
            |compiled, state, place, values| {
                let motion = loads.motion(place);
                let along = self.solved_sensitivity(compiled, state, motion, direction)?;
                values.extend(along.values);
                values.push(PART_OF_LOADS * loads.natural() * along.change);
                Ok(())
            },
        );
        let mut solved = ForceSensitivity {
            values: vec![f64::NAN; places.energies + 2],
            places,
            fault: point.no_limit(compiled, NoLimit::Derivatives),
            change: 0.0,
        };
        let is_complete = |found: &Vec<f64>| !found.iter().any(|value| value.is_nan());
        if !point.is_at && !found.as_ref().is_some_and(is_complete) {
            solved = self.solved_sensitivity(compiled, state, motion, direction)?;
        }
        for (value, found) in solved.values.iter_mut().zip(found.iter().flatten()) {
            if !found.is_nan() {
                *value = *found;
            }
        }
        Ok(solved)
    }

    /// Returns the derivatives by the Jacobian at the pose.
    fn solved_sensitivity(
        &mut self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        motion: KnownMotion<'_>,
        direction: &Direction,
    ) -> Result<ForceSensitivity, Error> {
        self.solve_directly(compiled, state, motion, ForceParts::ALL)?;
        let along = state.sensitivity(compiled, motion.rates, motion.driver_rates, direction)?;
        let along = Along {
            motion: &along,
            time: direction.time,
            inputs: &direction.loads,
        };
        self.sensitivity_along(compiled, state, motion, &along)
    }

    /// Returns the derivatives of all forces along a direction; all are up to date.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where reactions of least norm do not exist.
    fn sensitivity_along(
        &mut self,
        compiled: &CompiledMechanism,
        state: &State,
        motion: KnownMotion<'_>,
        sensitivity: &Along<'_>,
    ) -> Result<ForceSensitivity, Error> {
        let system = &compiled.system;
        let mechanism = std::sync::Arc::clone(&self.mechanism);
        let at = sensitivity.motion.mechanism();
        let mut probe = sensitivity.probe();
        let Demand {
            demand,
            sizes,
            energies: [kinetic, potential],
            masses,
        } = self.varied_demand(state, motion, sensitivity, &mut probe);

        let equations = system.equations().iter();
        let rows: Vec<Entries> = equations
            .map(|equation| probe.entries(&*equation.constraint, state))
            .collect();
        self.factors
            .factorise(system, &state.at)
            .map_err(|Rejected| SINGULAR_HERE)?;
        let multipliers = self.varied_multipliers(system, state, at.bodies, &rows, &demand)?;
        let drivers = self.varied_drivers(system, state, sensitivity, &masses, &rows, &multipliers);
        let more = self.rows.more.iter().map(|all| {
            let own = all.iter();
            own.map(|own| (probe.entries(&*own.relation, state), own.force))
                .collect::<Vec<_>>()
        });
        let more: Vec<_> = more.collect();
        let joints = 0..mechanism.joints.len();
        let reactions = joints.map(|joint| {
            let own = self.rows.joints[joint].iter();
            let own = own.map(|&row| (&*rows[row], multipliers[row]));
            let more = more[joint].iter();
            let more = more.map(|(entries, force)| (&**entries, sizes[*force][0]));
            self.varied_reaction(at.bodies, joint, own.chain(more))
                .map(|value| value.first())
        });
        let held = self.rows.constraints.iter();
        let mut values: Vec<f64> = drivers.into_iter().flatten().collect();
        values.extend(reactions.flatten());
        values.extend(held.map(|&row| multipliers[row].first()));
        values.extend(self.varied_shares(system, sensitivity, &multipliers, &sizes));
        values.extend(sizes.iter().flatten().map(Dual::first));
        values.extend([kinetic.first(), potential.first()]);
        let missing = self.missing_derivative(sensitivity.motion, &masses, &sizes);
        Ok(ForceSensitivity {
            values,
            places: Places::new(&mechanism),
            fault: missing.unwrap_or_else(|| sensitivity.motion.fault()),
            change: sensitivity.motion.largest_change(state.at.size()),
        })
    }

    /// Returns the forces that the bodies demand of joints and drivers along a direction.
    fn varied_demand(
        &self,
        state: &State,
        motion: KnownMotion<'_>,
        sensitivity: &Along<'_>,
        probe: &mut Probe<'_>,
    ) -> Demand {
        let at = sensitivity.motion.mechanism();
        let parameter = |p: ParameterId| sensitivity.motion.parameter_value(p);
        let mut masses = Masses::<Dual>::new(&self.mechanism, &parameter);
        for (body, of_body) in masses.bodies.iter_mut().enumerate() {
            let phi = at.coordinate(3 * body + 2).value;
            of_body.turn([phi.cos(), phi.sin()]);
        }
        let (mut demand, sizes, mut potential) =
            self.varied_loads(state, motion, sensitivity, probe);
        let mut kinetic = Dual::constant(0.0);
        for (body, of_body) in masses.bodies.iter().enumerate() {
            let q = [0, 1, 2].map(|component| at.coordinate(3 * body + component));
            let velocity = q.map(|q| q.first());
            let own = of_body.demand(velocity[2], q.map(|q| q.second()), masses.gravity);
            for (k, own) in own.into_iter().enumerate() {
                demand[3 * body + k] += own;
            }
            let position = [q[0].value, q[1].value];
            let [own_kinetic, own_potential] = of_body.energies(position, velocity, masses.gravity);
            kinetic += own_kinetic;
            potential += own_potential;
        }
        Demand {
            demand,
            sizes,
            energies: [kinetic, potential],
            masses,
        }
    }

    /// Gives the changes of the efforts of some drivers along each of some directions to `each`, with
    /// the number of the direction; `inputs` returns those of the inputs of forces. The Jacobian is
    /// factorised once, and no other force is differentiated: with the effort wᵀ ∂q/∂u of a driver
    /// and Phi_q δ(∂q/∂u) = −(δPhi_q) ∂q/∂u, δeffort = δwᵀ ∂q/∂u − λᵀ (δPhi_q) ∂q/∂u. Returns whether
    /// it has done so: not next to a change point.
    ///
    /// # Errors
    ///
    /// Those of [`sensitivity`](Self::sensitivity), and those of `each`.
    pub(in crate::kinematics) fn effort_changes(
        &mut self,
        (compiled, state): (&mut CompiledMechanism, &mut State),
        motion: KnownMotion<'_>,
        drivers: &[DriverId],
        directions: &[Direction],
        mut inputs: impl FnMut(usize, &Sensitivity<'_>) -> Vec<f64>,
        mut each: impl FnMut(usize, &[f64]),
    ) -> Result<bool, Error> {
        if near_point(compiled, state).is_some() {
            return Ok(false);
        }
        self.solve_directly(compiled, state, motion, ForceParts::ALL)?;
        let units = drivers.iter().map(|driver| self.unit(state, *driver));
        let units: Vec<Vec<f64>> = units.collect();
        let (rates, driver_rates) = (motion.rates, motion.driver_rates);
        let compiled = &*compiled;
        let mut efforts = vec![0.0; drivers.len()];
        state.sensitivities_here(
            compiled,
            (rates, driver_rates),
            directions,
            |state, k, along| {
                let inputs = inputs(k, along);
                let along = Along {
                    motion: along,
                    time: directions[k].time,
                    inputs: &inputs,
                };
                let mut probe = along.probe();
                let found = self.varied_demand(state, motion, &along, &mut probe);
                for (effort, unit) in efforts.iter_mut().zip(&units) {
                    let loads = found.demand.iter().zip(unit);
                    *effort = loads.map(|(load, unit)| load.first() * unit).sum();
                    probe.at.move_at(unit);
                    let moving: VariedMechanism<'_, '_, Varied> = VariedMechanism {
                        bodies: &probe.at,
                        curves: probe.curves,
                    };
                    let equations = compiled.system.equations().iter();
                    for (equation, multiplier) in equations.zip(&self.results.multipliers) {
                        let rate = equation.constraint.along(&moving).first();
                        *effort -= multiplier * rate.first();
                    }
                }
                if efforts.iter().all(|effort| effort.is_finite()) {
                    each(k, &efforts);
                    return Ok(());
                }
                let missing = self.missing_derivative(along.motion, &found.masses, &found.sizes);
                Err(missing.unwrap_or_else(|| along.motion.fault()))
            },
        )?;
        Ok(true)
    }

    /// Returns the error of the first number of a mass or force without a finite derivative.
    fn missing_derivative(
        &self,
        along: &Sensitivity<'_>,
        masses: &Masses<Dual>,
        sizes: &[[Dual; 3]],
    ) -> Option<Error> {
        let is_missing = |numbers: &[Dual]| numbers.iter().any(|n| !n.first().is_finite());
        // Parameters and the motion come first.
        let motion_has_derivatives = matches!(along.fault(), Error::Singular { .. });
        let Mechanism {
            simulation,
            bodies,
            forces,
            ..
        } = &*self.mechanism;
        if !motion_has_derivatives {
            return None;
        }
        if is_missing(&masses.gravity) {
            return Some(along.no_derivative("`gravity`".to_owned(), simulation.gravity.iter()));
        }
        let mut of_bodies = masses.bodies.iter().zip(bodies).zip((0..).map(BodyId));
        if let Some(((_, body), id)) = of_bodies.find(|((mass, _), _)| is_missing(&mass.numbers()))
        {
            let numbers = self.mechanism.numbers_of_mass(id);
            let what = format!("the mass, inertia or center of body `{}`", body.name);
            return Some(along.no_derivative(what, numbers));
        }
        let (_, force) = sizes
            .iter()
            .zip(forces)
            .find(|(size, _)| is_missing(&size[..]))?;
        let what = format!("force `{}`", force.name);
        Some(along.no_derivative(what, force.load.expressions().into_iter()))
    }

    /// Returns −Q of the forces, their sizes and the potential energy of springs.
    fn varied_loads(
        &self,
        state: &State,
        motion: KnownMotion<'_>,
        sensitivity: &Along<'_>,
        probe: &mut Probe<'_>,
    ) -> (Vec<Dual>, Vec<[Dual; 3]>, Dual) {
        let zero = Dual::constant(0.0);
        let at = sensitivity.motion.mechanism();
        let parameter = |p: ParameterId| sensitivity.motion.parameter_value(p);
        let inputs = motion.inputs.iter().zip(sensitivity.inputs);
        let inputs: Vec<_> = inputs.map(|(&is, &by)| Dual::new(is, [by])).collect();
        let seen = self.applied.seen.iter();
        let seen_values: Vec<_> = seen
            .map(|seen| {
                let value = seen.relation.along(&at);
                [value.value, value.first()]
            })
            .collect();
        let around = Circumstances {
            parameter: &parameter,
            time: Dual::new(state.pose.time, [sensitivity.time]),
            inputs: &inputs,
            sources: &self.applied.sources,
            seen: &self.applied.seen,
            seen_values: &seen_values,
        };
        let mut demand = vec![zero; state.pose.q.len()];
        let mut sizes = Vec::new();
        let mut energy = zero;
        for (applied, definition) in self.applied.list.iter().zip(&self.mechanism.forces) {
            match (&applied.place, &definition.load) {
                (
                    ActsAt::Coordinate(_),
                    Load::Coordinate {
                        coordinate,
                        law: Some(law),
                    },
                ) if is_at_zero(&definition.load, &state.at) => {
                    // A spring of free length zero, or else there is no force: ½ k c² = ½ k (x² + y²), and
                    // its force is −k x ∂x/∂q − k y ∂y/∂q. The size k c has no derivative, and a free
                    // length that changes leaves the force without direction.
                    let spring = law.spring.as_ref().expect("it is through zero");
                    let [stiffness, shortened] = spring.evaluate(&parameter, zero);
                    let lost = if shortened.varies() {
                        Dual::unknown()
                    } else {
                        zero
                    };
                    for kind in [CoordinateKind::X, CoordinateKind::Y] {
                        let relation = of_coordinate(&Coordinate {
                            kind,
                            ..*coordinate
                        });
                        let value = relation.along(&at).value;
                        for (column, partial) in probe.entries(&*relation, state) {
                            demand[column] += (stiffness * value + lost) * partial;
                        }
                        energy += stiffness * value.square() * 0.5;
                    }
                    sizes.push([Dual::new(0.0, [f64::NAN]), zero, zero]);
                }
                (ActsAt::Coordinate(relation), Load::Coordinate { .. } | Load::Passive { .. }) => {
                    let law = definition.load.law();
                    let value = relation.along(&at);
                    let coordinate = [value.value, value.first()];
                    let [force, stored] = applied.along(law, coordinate, &around);
                    energy += stored;
                    for (column, partial) in probe.entries(&**relation, state) {
                        demand[column] -= force * partial;
                    }
                    sizes.push([force, zero, zero]);
                }
                (ActsAt::Marker(marker, axes), Load::Marker { law, .. }) => {
                    let size = applied.at_marker(law.as_ref(), &around);
                    let axis = axes.map_or([Dual::constant(1.0), zero], |axes| {
                        at.marker(axes).axis.map(|component| component.value)
                    });
                    if let Some(body) = self.mechanism.markers[marker.index()].body {
                        let k = 3 * body.index();
                        let point = at.marker(*marker).point.map(|component| component.value);
                        let arm = [0, 1].map(|c| point[c] - at.coordinate(k + c).value);
                        let force = about_origin(size, axis, arm);
                        for (component, force) in force.into_iter().enumerate() {
                            demand[k + component] -= force;
                        }
                    }
                    sizes.push(size);
                }
                _ => unreachable!("places are made of these definitions"),
            }
        }
        (demand, sizes, energy)
    }

    /// Returns λ with its change.
    fn varied_multipliers(
        &mut self,
        system: &System,
        state: &State,
        at: &VariedConfiguration,
        rows: &[Entries],
        demand: &[Dual],
    ) -> Result<Vec<Dual>, Error> {
        let values = &self.results.multipliers;
        let mut side: Vec<f64> = demand.iter().map(Dual::first).collect();
        for (entries, value) in rows.iter().zip(values) {
            for (column, partial) in entries {
                side[*column] -= partial.first() * value;
            }
        }
        let changes = if self.is_of_least_norm() {
            self.least_norm_changes(at, rows, demand, &side)?
        } else {
            let mut changes = vec![0.0; values.len()];
            self.factors
                .solve_transposed(system, &state.at, &mut side, &mut changes);
            changes
        };
        let values = self.results.multipliers.iter().zip(changes);
        Ok(values.map(|(&is, by)| Dual::new(is, [by])).collect())
    }

    /// Returns the changes of λ of least norm. With the reactions V λ, λ and further multipliers ν
    /// solve VᵀV λ + Phi_q ν = 0 and Phi_qᵀ λ = w; `side` is δw − (δPhi_qᵀ) λ.
    fn least_norm_changes(
        &self,
        at: &VariedConfiguration,
        rows: &[Entries],
        demand: &[Dual],
        side: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let (count, unknowns) = (rows.len(), demand.len());
        let mut matrix = DMatrix::zeros(count + unknowns, count + unknowns);
        let mut change = matrix.clone();
        for (row, entries) in rows.iter().enumerate() {
            for &(column, partial) in entries {
                for (i, j) in [(row, count + column), (count + column, row)] {
                    matrix[(i, j)] += partial.value;
                    change[(i, j)] += partial.first();
                }
            }
        }
        let mut add = |i: usize, j: usize, product: Dual| {
            matrix[(i, j)] += product.value;
            change[(i, j)] += product.first();
        };
        for (joint, own) in self.rows.joints.iter().enumerate() {
            let reported = Reported::of(&self.mechanism.joints[joint].kind);
            let one = Dual::constant(1.0);
            let made = own
                .iter()
                .map(|&row| self.varied_reaction(at, joint, [(&*rows[row], one)].into_iter()));
            let made: Vec<_> = made.collect();
            for (&i, of_i) in own.iter().zip(&made) {
                for (&j, of_j) in own.iter().zip(&made) {
                    for component in (0..3).filter(|&component| reported.has(component)) {
                        add(i, j, of_i[component] * of_j[component]);
                    }
                }
            }
        }
        for &row in &self.rows.constraints {
            add(row, row, Dual::constant(1.0));
        }
        let lu = matrix.lu();
        let values = demand.iter().map(|w| w.value);
        let is = DVector::from_iterator(
            count + unknowns,
            std::iter::repeat_n(0.0, count).chain(values),
        );
        let is = lu.solve(&is).ok_or(SINGULAR_HERE)?;
        let mut right = -(&change * &is);
        // The exact λ are at hand.
        right.rows_mut(count, unknowns).copy_from_slice(side);
        let by = lu.solve(&right).ok_or(SINGULAR_HERE)?;
        Ok(by.iter().copied().take(count).collect())
    }

    /// Returns the reaction of a joint for rows with these λ.
    fn varied_reaction<'a>(
        &self,
        at: &VariedConfiguration,
        joint: usize,
        rows: impl Iterator<Item = (&'a [(usize, Dual)], Dual)>,
    ) -> [Dual; 3] {
        let zero = Dual::constant(0.0);
        let joint = &self.mechanism.joints[joint];
        let reported = Reported::of(&joint.kind);
        if matches!(
            reported,
            Reported::Torque | Reported::Effort | Reported::Tension
        ) {
            let sum = rows.fold(zero, |sum, (_, multiplier)| sum + multiplier);
            return match reported {
                Reported::Tension => [-sum, zero, zero],
                _ => [zero, zero, sum],
            };
        }
        let body = self.mechanism.markers[joint.to.index()].body;
        let origin = |body: usize| [0, 1].map(|c| at.coordinate(3 * body + c).value);
        let mut wrench = Wrench::new(body);
        for (entries, multiplier) in rows {
            for &(column, partial) in entries {
                let force = multiplier * partial;
                wrench.add(column, force, self.mechanism.bodies.len(), origin);
            }
        }
        let point = at.marker(joint.to).point.map(|component| component.value);
        let origin = body.map_or([zero; 2], |body| origin(body.index()));
        wrench.about([point[0] - origin[0], point[1] - origin[1]])
    }

    /// Returns the changes of the efforts of couplings along their coordinates.
    fn varied_shares(
        &self,
        system: &System,
        sensitivity: &Along<'_>,
        multipliers: &[Dual],
        sizes: &[[Dual; 3]],
    ) -> Vec<f64> {
        let at = sensitivity.motion.mechanism();
        let held = self.rows.couplings(system);
        let held = held.map(|(joint, row, coupling)| (joint, multipliers[row], coupling));
        let open = self.rows.open_couplings();
        let open = open.map(|(joint, force, coupling)| (joint, sizes[force][0], coupling));
        let mut all: Vec<_> = held.chain(open).collect();
        all.sort_by_key(|(joint, ..)| *joint);
        let shares = all.into_iter().flat_map(|(joint, effort, coupling)| {
            let places = 0..self.results.shares[joint].len();
            let at = &at;
            places.map(move |place| effort * coupling.varied_partial(at, place))
        });
        shares.map(|share| share.first()).collect()
    }

    /// Returns the changes of effort, power, inertia and bias of each driver.
    fn varied_drivers(
        &mut self,
        system: &System,
        state: &State,
        sensitivity: &Along<'_>,
        masses: &Masses<Dual>,
        rows: &[Entries],
        multipliers: &[Dual],
    ) -> Vec<[f64; 4]> {
        let mechanism = std::sync::Arc::clone(&self.mechanism);
        let drivers = (0..mechanism.drivers.len()).map(DriverId);
        let units: Vec<Vec<Dual>> = drivers
            .clone()
            .map(|driver| self.varied_unit(system, state, driver, rows))
            .collect();
        let momenta = units.iter().map(|unit| {
            let mut momentum = vec![Dual::constant(0.0); unit.len()];
            for (body, of_body) in masses.bodies.iter().enumerate() {
                let k = 3 * body;
                let own = of_body.momentum([unit[k], unit[k + 1], unit[k + 2]]);
                momentum[k..k + 3].copy_from_slice(&own);
            }
            momentum
        });
        let momenta: Vec<Vec<Dual>> = momenta.collect();
        let inertia = |i: usize, j: usize| {
            let products = units[i].iter().zip(&momenta[j]);
            products.fold(Dual::constant(0.0), |sum, (&a, &b)| sum + a * b)
        };
        let of_driver = |driver: DriverId| {
            let index = driver.index();
            let effort = multipliers[self.rows.drivers[index]];
            let own: Varied = sensitivity.motion.driver_value(driver);
            let mut bias = effort;
            for (input, definition) in mechanism.drivers.iter().enumerate() {
                if definition.has_open_acceleration() {
                    let acceleration = sensitivity.motion.driver_value(DriverId(input)).second();
                    bias -= inertia(index, input) * acceleration;
                }
            }
            let results = [effort, effort * own.first(), inertia(index, index), bias];
            results.map(|result| result.first())
        };
        drivers.map(of_driver).collect()
    }

    /// Returns ∂q/∂u of a driver with its change.
    fn varied_unit(
        &mut self,
        system: &System,
        state: &State,
        driver: DriverId,
        rows: &[Entries],
    ) -> Vec<Dual> {
        let unit = self.unit(state, driver);
        let side = rows.iter().map(|entries| {
            let changes = entries.iter();
            -changes.fold(0.0, |sum, (column, partial)| {
                sum + partial.first() * unit[*column]
            })
        });
        let side: Vec<f64> = side.collect();
        let mut change = vec![0.0; unit.len()];
        self.factors.solve(system, &state.at, &side, &mut change);
        let unit = unit.into_iter().zip(change);
        unit.map(|(is, by)| Dual::new(is, [by])).collect()
    }
}

/// A direction: the motion along it, and the changes of the time and of the inputs of forces.
struct Along<'a> {
    motion: &'a Sensitivity<'a>,
    time: f64,
    inputs: &'a [f64],
}

impl<'a> Along<'a> {
    /// Returns the mechanism at rest.
    fn probe(&self) -> Probe<'a> {
        let at = self.motion.mechanism();
        Probe {
            at: at.bodies.at_rest(),
            curves: at.curves,
            gradient: Gradient::new(),
        }
    }
}

/// Forces that the bodies demand of joints and drivers, with their changes.
struct Demand {
    /// The generalized forces w.
    demand: Vec<Dual>,
    /// Sizes of the forces.
    sizes: Vec<[Dual; 3]>,
    /// Kinetic and potential energy.
    energies: [Dual; 2],
    masses: Masses<Dual>,
}
