//! Forces and stiffness at rest, with the contacts that they meet.
//!
//! They are written in coordinates y with u = L⁻ᵀ y, J = L Lᵀ, in which the inertia is one: steps in y
//! do not depend on the choice of freedoms.

use nalgebra::{DMatrix, DVector};

use super::bounded;
use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::motion::{FreeMotion, write_start};
use super::passive::TOUCHED;
use super::triangular::ascend;
use crate::kinematics::{Direction, ForceParts, ForceQuantity, KnownMotion, Rates, Solver};
use crate::mechanism::{DriverId, Jet};

/// A stiffness of this part of the largest is rounding: the equilibrium is neutral.
const NEUTRAL: f64 = 1e-9;

/// The parts of the forces that are zero in equilibrium.
const EFFORTS: ForceParts = ForceParts {
    efforts: true,
    reactions: false,
};

/// One side of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Index of the passive force.
    force: usize,
    /// The direction in which it pushes.
    sign: f64,
    pub(super) gap: f64,
    /// Gap up to which it is closed.
    rounding: f64,
    /// A radian, or the mechanism's size \[m\].
    pub(super) scale: f64,
}

/// Forces at rest, in coordinates y without what friction holds.
pub(super) struct Statics {
    /// ∂u/∂y.
    frame: DMatrix<f64>,
    /// Q + Aᵀ λ, for the pushes given; what is rounding is zero.
    force: DVector<f64>,
    /// −∂(Q + Aᵀ λ)/∂y.
    stiffness: DMatrix<f64>,
    pub(super) sides: Vec<Side>,
    /// ∂gap/∂y, by columns.
    rows: DMatrix<f64>,
}

impl FreeMotion {
    /// Evaluates the equations at the solver's pose, at rest, with nothing held.
    pub(super) fn stand(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        let still = vec![0.0; self.freedoms().len()];
        self.place(solver, given, &still)
    }

    /// Evaluates the equations at the solver's pose, with these velocities and nothing held.
    pub(super) fn place(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        velocities: &[f64],
    ) -> Result<(), Error> {
        let count = self.freedoms().len();
        write_start(&self.equations.freedoms, solver.pose(), &mut self.x);
        self.x[count..2 * count].copy_from_slice(velocities);
        self.equations.passive.reset();
        self.equations.accept(solver);
        let time = solver.pose().time;
        self.equations.evaluate(solver, given, time, &self.x)
    }

    /// Returns all sides of contacts that have a limit, where the equations are.
    pub(super) fn sides(&self, solver: &Solver) -> Vec<Side> {
        let (passive, point) = (&self.equations.passive, &self.equations.point);
        let contacts = passive.list.iter().zip(&point.passive).enumerate();
        let contacts = contacts
            .filter(|(force, (own, _))| own.cause.is_contact() && self.equations.moves(*force));
        let sides = contacts.flat_map(|(force, (own, at))| {
            let is_angle = own.coordinate.kind.is_angle();
            let scale = if is_angle { 1.0 } else { solver.size() };
            let signs = [1.0, -1.0].into_iter().zip(at.gaps());
            signs.map(move |(sign, gap)| Side {
                force,
                sign,
                gap,
                scale,
                rounding: TOUCHED * at.gap_rounding(),
            })
        });
        sides.filter(|side| side.gap.is_finite()).collect()
    }

    /// Returns Q + Aᵀ λ of the freedoms for these pushes along the coordinates of contacts, and the
    /// rounding in it, where the equations are.
    pub(super) fn forces_at_rest(
        &mut self,
        solver: &mut Solver,
        pushes: &[f64],
    ) -> Result<(DVector<f64>, DVector<f64>), Error> {
        let rest = self.rest(solver, pushes)?;
        let forces = &mut self.equations.forces;
        solver.solve_forces(rest.motion(), EFFORTS, forces)?;
        let freedoms = &self.equations.freedoms;
        let of_freedoms = |of: &dyn Fn(DriverId) -> f64| {
            DVector::from_iterator(freedoms.len(), freedoms.iter().map(|id| of(*id)))
        };
        let force = of_freedoms(&|id| -forces.value(ForceQuantity::Effort(id)));
        let rounding = of_freedoms(&|id| solver.effort_rounding(&rest.rates, id, forces));
        Ok((force, rounding))
    }

    /// Returns the rates of all at the solver's pose where no freedom accelerates, with these pushes.
    fn rest(&self, solver: &mut Solver, pushes: &[f64]) -> Result<Rest, Error> {
        let point = &self.equations.point;
        let mut drivers = point.drivers.clone();
        for freedom in self.freedoms() {
            drivers[freedom.index()].derivatives[1] = 0.0;
        }
        let mut rates = Rates::new(solver.pose().q.len());
        solver.solve_rates(|driver| drivers[driver.index()], &mut rates)?;
        let mut loads = point.loads.clone();
        for (load, push) in loads[self.equations.inputs()..].iter_mut().zip(pushes) {
            *load += push;
        }
        Ok(Rest {
            rates,
            drivers,
            loads,
        })
    }

    /// Returns forces and stiffness where the equations are, while some friction holds.
    pub(super) fn statics(
        &mut self,
        solver: &mut Solver,
        sticking: &[usize],
        pushes: &[f64],
    ) -> Result<Statics, Error> {
        let frame = self.frame(sticking);
        let (force, rounding) = self.forces_at_rest(solver, pushes)?;
        let mut force = frame.tr_mul(&force);
        let rounding = frame.abs().tr_mul(&rounding);
        for (force, rounding) in force.iter_mut().zip(&rounding) {
            if force.abs() <= *rounding {
                *force = 0.0;
            }
        }
        let count = self.freedoms().len();
        let mut stiffness = DMatrix::zeros(count, count);
        let rest = self.rest(solver, pushes)?;
        let Equations {
            forces, freedoms, ..
        } = &mut self.equations;
        for (column, along) in freedoms.iter().enumerate() {
            let mut direction = Direction::zero(solver.mechanism());
            direction.drivers[along.index()].value = 1.0;
            let changes = solver.force_sensitivity(rest.motion(), &direction, forces)?;
            for (row, freedom) in freedoms.iter().enumerate() {
                stiffness[(row, column)] = changes.change(ForceQuantity::Effort(*freedom))?;
            }
        }
        let stiffness = frame.tr_mul(&(stiffness * &frame));
        let sides = self.sides(solver);
        let rows = DMatrix::from_fn(count, sides.len(), |row, column| {
            let Side { force, sign, .. } = sides[column];
            sign * self.equations.passive.rows[(force, self.freedoms()[row].index())]
        });
        Ok(Statics {
            rows: frame.tr_mul(&rows),
            stiffness: 0.5 * (&stiffness + stiffness.transpose()),
            force,
            frame,
            sides,
        })
    }

    /// Returns ∂u/∂y: L⁻ᵀ times an orthonormal basis of the motions that these frictions leave.
    fn frame(&self, sticking: &[usize]) -> DMatrix<f64> {
        let Equations {
            passive,
            freedoms,
            factor,
            ..
        } = &self.equations;
        let mut frame = complement(&passive.columns(sticking, freedoms, factor));
        for mut column in frame.column_iter_mut() {
            ascend(factor, column.as_mut_slice());
        }
        frame
    }
}

/// A mechanism at rest, as far as its drivers let it.
struct Rest {
    rates: Rates,
    drivers: Vec<Jet>,
    loads: Vec<f64>,
}

impl Rest {
    fn motion(&self) -> KnownMotion<'_> {
        KnownMotion {
            rates: &self.rates,
            driver_rates: &self.drivers,
            inputs: &self.loads,
        }
    }
}

impl Side {
    /// Returns whether it pushes, among these forces along the coordinates of contacts.
    fn pushes(&self, pushes: &[f64]) -> bool {
        self.sign * pushes[self.force] > 0.0
    }

    pub(super) fn is_closed(&self) -> bool {
        self.gap <= self.rounding
    }

    /// Returns whether both are the same side of the same contact.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.force == other.force && self.sign.to_bits() == other.sign.to_bits()
    }
}

impl Statics {
    /// Returns whether friction lets nothing move.
    pub(super) fn is_held(&self) -> bool {
        self.frame.is_empty()
    }

    /// Returns whether all sides that push are closed.
    pub(super) fn are_closed(&self, pushes: &[f64]) -> bool {
        let mut pushing = self.sides.iter().filter(|side| side.pushes(pushes));
        pushing.all(Side::is_closed)
    }

    /// Returns the step to the equilibrium of the linearised forces and gaps, no longer than some scales.
    ///
    /// Against the direction of a negative stiffness it leads downhill too. Where contacts push, that of
    /// motions which open or cross them is of no account: a large one takes its place.
    pub(super) fn step(&self, pushes: &[f64], scales: &[f64]) -> (DVector<f64>, Vec<f64>) {
        /// Stiffness of contacts that push, in that of the mechanism: the directions along them are
        /// known to its reciprocal, with which the steps converge.
        const OF_CONTACTS: f64 = 1e6;
        /// Compliance of contacts that yield, in that of all.
        const YIELDING: f64 = 1e-3;
        let Self {
            frame,
            force,
            stiffness,
            sides,
            rows,
        } = self;
        // Q alone, as the step finds pushes anew.
        let (mut free, mut bent) = (force.clone(), stiffness.clone());
        let contacts = rows.column_iter().zip(sides);
        for (row, side) in contacts.filter(|(_, side)| side.pushes(pushes)) {
            free.axpy(-side.sign * pushes[side.force], &row, 1.0);
            let size = row.norm_squared();
            if size > 0.0 {
                bent += row * row.transpose() * (OF_CONTACTS * stiffness.amax() / size);
            }
        }
        let eigen = bent.symmetric_eigen();
        let vectors = &eigen.eigenvectors;
        let along = vectors.tr_mul(&free);
        let ways = frame * vectors;
        // A direction in which the stiffness would let the step lead farther than the scales is as stiff
        // as that.
        let mut bends = DVector::from_fn(along.len(), |k, _| {
            let reach = longest(&ways.column(k).into_owned(), scales);
            eigen.eigenvalues[k].abs().max(along[k].abs() * reach)
        });
        let floor = NEUTRAL * bends.amax();
        let floor = if floor > 0.0 { floor } else { 1.0 };
        bends.apply(|bend| *bend = 1.0 / bend.max(floor));
        let inverse = vectors * DMatrix::from_diagonal(&bends) * vectors.transpose();
        let way = &inverse * free;
        let responses = &inverse * rows;
        let gaps = DVector::from_iterator(sides.len(), sides.iter().map(|side| side.gap));
        let predicted = rows.tr_mul(&way) + gaps;
        let bounds = vec![[0.0, f64::INFINITY]; sides.len()];
        let noise: Vec<f64> = sides.iter().map(|side| side.rounding).collect();
        let mut compliance = rows.tr_mul(&responses);
        let solve =
            |w: &DMatrix<f64>| bounded::solve(w, predicted.as_slice(), &bounds, &noise).ok();
        let found = solve(&compliance).unwrap_or_else(|| {
            // No step closes all gaps that are linear: contacts that yield a little share the rest.
            let yields = YIELDING * compliance.trace();
            compliance += DMatrix::identity(sides.len(), sides.len()) * yields;
            solve(&compliance).unwrap_or_else(|| DVector::zeros(sides.len()))
        });
        let mut along_coordinates = vec![0.0; pushes.len()];
        for (side, push) in sides.iter().zip(&found) {
            along_coordinates[side.force] += side.sign * push;
        }
        (frame * (way + responses * found), along_coordinates)
    }

    /// Returns the changes of the freedoms by which the equilibrium is left downhill, if it is not stable.
    pub(super) fn way_down(&self, pushes: &[f64]) -> Option<DVector<f64>> {
        let Self {
            frame,
            stiffness,
            sides,
            rows,
            ..
        } = self;
        let (pushing, others): (Vec<usize>, Vec<usize>) =
            (0..sides.len()).partition(|k| sides[*k].pushes(pushes));
        let tangents = complement(&rows.select_columns(&pushing));
        let along = tangents.tr_mul(&(stiffness * &tangents));
        if along.is_empty() {
            return None;
        }
        let eigen = along.symmetric_eigen();
        let (least, value) = eigen.eigenvalues.argmin();
        if value >= -NEUTRAL * stiffness.amax() {
            return None;
        }
        let way = &tangents * eigen.eigenvectors.column(least);
        let closes = |way: &DVector<f64>| {
            let mut closed = others.iter().filter(|k| sides[**k].is_closed());
            closed.any(|&k| rows.column(k).dot(way) < 0.0)
        };
        let ways = [way.clone(), -way];
        let way = ways.into_iter().find(|way| !closes(way))?;
        Some(frame * way)
    }
}

/// Returns an orthonormal basis of what is at right angles to all columns of a matrix.
fn complement(columns: &DMatrix<f64>) -> DMatrix<f64> {
    /// Part of a column that is left of it when those before it are taken out, at which it depends on
    /// them: far above rounding, far below what moves.
    const DEPENDENT: f64 = 1e-9;
    let count = columns.nrows();
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let add = |column: DVector<f64>, basis: &mut Vec<DVector<f64>>| {
        let size = column.norm();
        let mut rest = column;
        // The second time takes out the rounding of the first.
        for _ in 0..2 {
            for other in &*basis {
                rest.axpy(-other.dot(&rest), other, 1.0);
            }
        }
        let left = rest.norm();
        if basis.len() < count && left > DEPENDENT * size {
            basis.push(rest / left);
        }
    };
    for column in columns.column_iter() {
        add(column.into_owned(), &mut basis);
    }
    let taken = basis.len();
    for k in 0..count {
        add(
            DVector::from_fn(count, |row, _| f64::from(row == k)),
            &mut basis,
        );
    }
    DMatrix::from_fn(count, basis.len() - taken, |row, column| {
        basis[taken + column][row]
    })
}

/// Returns the longest of these changes, in scales.
pub(super) fn longest(changes: &DVector<f64>, scales: &[f64]) -> f64 {
    let parts = changes.iter().zip(scales);
    parts.fold(0.0, |longest, (change, scale)| {
        longest.max((change / scale).abs())
    })
}
