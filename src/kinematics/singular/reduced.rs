//! The reduced equation: the equations of one block near a singular position as one function of two
//! numbers.
//!
//! Let F(z, p(τ)) = 0 be the block's equations, z its unknowns, and p the unknowns that it reads,
//! which run with the parameter τ of a line. Where the Jacobian J = ∂F/∂z has lost one rank,
//!
//! F(z, p(τ)) + ε b = 0, c · (z − z⁰) = α
//!
//! still determines z and ε for given α and τ (Lyapunov and Schmidt): bordered by b and c the
//! Jacobian is regular. The mechanism's poses are where ε(α, τ) = 0, so that the first and second
//! derivatives of ε describe the singular position. With ψᵀJ ∥ cᵀ, ψ · b = 1 and the tangents
//! V₁ = (∂z/∂α, 0), V₂ = (∂z/∂τ, p′)
//!
//! ε_αα = −ψᵀF″\[V₁, V₁\], ε_ατ = −ψᵀF″\[V₁, V₂\], ε_ττ = −ψᵀ(F″\[V₂, V₂\] + F_p p″).

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::kinematics::block::{BlockPlan, BlockSolver, BlockState};
use crate::kinematics::configuration::Configuration;
use crate::kinematics::constraint::Gradient;
use crate::kinematics::model::Model;
use crate::kinematics::newton::Limits;
use crate::kinematics::path::{Motions, Path, Rates};
use crate::kinematics::state::State;
use crate::kinematics::system::{System, Targets, Values};
use crate::mechanism::{DriverId, Jet};

/// The line along which the drivers run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Line<'a> {
    /// The values of one driver, all others being held; τ is its value.
    Driver(DriverId),
    /// A path on which no parameter moves; τ is s.
    Path(&'a Path),
}

impl Line<'_> {
    /// Writes the drivers at τ with their derivatives in it; `held` are their present values.
    fn drivers(self, tau: f64, held: &[f64], motions: &Motions, out: &mut [Jet]) {
        match self {
            Self::Path(path) => path.drivers(tau, motions, out),
            Self::Driver(driver) => {
                for (out, value) in out.iter_mut().zip(held) {
                    *out = Jet::constant(*value);
                }
                out[driver.index()] = Jet::variable(tau);
            }
        }
    }
}

/// Most Newton corrections of a block from a near place.
const MAX_CORRECTIONS: usize = 20;
/// Largest correction, in radians and characteristic lengths; a larger one has left the
/// neighbourhood.
const LARGEST_STEP: f64 = 0.5;

/// Vectors over all unknowns that the reduced equations of several blocks take in turn. Only the
/// entries of the unknowns of a block and of those that it reads are set for its equation.
pub(super) struct Workspace {
    at: Configuration,
    /// Rates along the line of the unknowns of the blocks moved: at the last place and at the start.
    tangent: Rates,
    origin_tangent: Rates,
    /// Rates of one combination of motions.
    combined: Vec<f64>,
    /// Index of each unknown in its block.
    place_of: Vec<Option<usize>>,
}

impl Workspace {
    pub(super) fn new(state: &State) -> Self {
        let unknowns = state.pose.q.len();
        Self {
            at: state.at.clone(),
            tangent: Rates::new(unknowns),
            origin_tangent: Rates::new(unknowns),
            combined: vec![0.0; unknowns],
            place_of: vec![None; unknowns],
        }
    }
}

/// The reduced equation of a block.
pub(super) struct ReducedEquation<'a> {
    system: &'a System,
    targets: &'a Targets,
    motions: &'a Motions,
    line: Line<'a>,
    /// The block's index in the plan, the blocks before it, and the blocks that each block reads.
    block: usize,
    before: &'a mut [BlockSolver],
    reads: &'a [Vec<usize>],
    /// The blocks before it that were moved to the last place, ascending.
    moved: BTreeSet<usize>,
    rows: Vec<usize>,
    /// The unknowns that the rows read, of the blocks before it.
    read_columns: Vec<usize>,
    pub(super) columns: Vec<usize>,
    /// Scale factor of each unknown \[m or rad\].
    scales: Vec<f64>,
    work: &'a mut Workspace,
    held: &'a [f64],
    jets: Vec<Jet>,
    drivers: Vec<f64>,
    /// The start: τ and the pose there.
    pub(super) start: f64,
    origin: &'a [f64],
    /// z⁰, and the bordering vectors, all scaled.
    b: DVector<f64>,
    c: DVector<f64>,
    /// ε at the last place.
    epsilon: f64,
    /// The largest scaled rate with τ at the start, of the unknowns before the block, too.
    pub(super) speed: f64,
}

/// The reduced equation at one place.
pub(super) struct ReducedPoint {
    pub(super) alpha: f64,
    pub(super) tau: f64,
    /// ε, its first derivatives in α and τ, and its second in αα, ατ, ττ.
    pub(super) epsilon: f64,
    pub(super) first: [f64; 2],
    pub(super) second: [f64; 3],
    /// ∂z/∂α and ∂z/∂τ, scaled.
    pub(super) tangents: [DVector<f64>; 2],
    /// The block's unknowns.
    pub(super) z: Vec<f64>,
    /// F_p p″ along the line, one entry per row of the block.
    bend: DVector<f64>,
    bordered: LU<f64, Dyn, Dyn>,
}

impl<'a> ReducedEquation<'a> {
    /// Reduces the equations of a block from the pose, which is at `start` of the line. `None`
    /// where the block is regular beyond doubt or has no bordered solution.
    pub(super) fn new(
        model: &'a mut Model,
        state: &'a State,
        block: usize,
        line: Line<'a>,
        start: f64,
        work: &'a mut Workspace,
    ) -> Option<Self> {
        let State {
            pose,
            targets,
            motions,
            ..
        } = state;
        let Model { system, plan, .. } = model;
        let system = &*system;
        let BlockPlan { blocks, reads, .. } = plan;
        let (own, before) = blocks[..=block].split_last_mut()?;
        let columns = own.columns().to_vec();
        let read = reads[block].iter();
        let read_columns = read.flat_map(|&read| before[read].columns()).copied();
        work.place_of.fill(None);
        for (place, &column) in columns.iter().enumerate() {
            work.place_of[column] = Some(place);
            work.at.set_coordinate(column, pose.q[column]);
        }
        let size = work.at.size();
        let order = columns.len();
        let mut reduced = Self {
            system,
            targets,
            motions,
            line,
            block,
            read_columns: read_columns.collect(),
            before,
            reads,
            moved: BTreeSet::new(),
            rows: own.rows().to_vec(),
            scales: columns
                .iter()
                .map(|&column| system.column_scale(column, size))
                .collect(),
            columns,
            work,
            held: &pose.drivers,
            jets: vec![Jet::constant(0.0); pose.drivers.len()],
            drivers: pose.drivers.clone(),
            start,
            origin: &pose.q,
            b: DVector::zeros(order),
            c: DVector::zeros(order),
            epsilon: 0.0,
            speed: 0.0,
        };
        reduced.move_all_before(start)?;
        reduced.keep_tangent();
        reduced.border()?;
        let point = reduced.solve(0.0, start)?;
        reduced.speed = reduced.scaled_speed(&point.tangents[1]);
        (reduced.speed > 0.0 && reduced.speed.is_finite()).then_some(reduced)
    }

    /// Returns the largest scaled rate of the unknowns of the blocks moved and of these of its own.
    pub(super) fn scaled_speed(&self, own: &DVector<f64>) -> f64 {
        let size = self.work.at.size();
        let moved = self.moved.iter();
        let read = moved.flat_map(|&block| self.before[block].columns());
        let read = read.map(|&column| {
            (self.work.tangent.velocity()[column] / self.system.column_scale(column, size)).abs()
        });
        let driven = self.rows.iter().map(|&row| {
            let scale = self.system.equations()[row].row_scale(&self.work.at);
            (self.driver(row).first() * scale).abs()
        });
        read.chain(driven).fold(own.amax(), f64::max)
    }

    /// Keeps the rates of all blocks moved, at the start.
    fn keep_tangent(&mut self) {
        let Workspace {
            tangent,
            origin_tangent,
            ..
        } = &mut *self.work;
        let (velocity, acceleration) = origin_tangent.both_mut();
        let moved = self.moved.iter();
        for &column in moved.flat_map(|&block| self.before[block].columns()) {
            velocity[column] = tangent.velocity()[column];
            acceleration[column] = tangent.acceleration()[column];
        }
    }

    /// Takes for b and c the singular vectors of the Jacobian at the start, by two steps of
    /// inverse iteration, the first of them from a vector that is not likely to be at right
    /// angles to anything.
    fn border(&mut self) -> Option<()> {
        let (_, jacobian) = self.equations();
        let order = jacobian.nrows();
        let transposed = jacobian.transpose().lu();
        let lu = jacobian.lu();
        let any = DVector::from_fn(order, |k, _| 1.0 + 0.618 * (k % 3) as f64);
        let mut right = lu.solve(&any)?.try_normalize(0.0)?;
        let mut left = right.clone();
        for _ in 0..3 {
            left = transposed.solve(&right)?.try_normalize(0.0)?;
            right = lu.solve(&left)?.try_normalize(0.0)?;
        }
        self.b = left;
        self.c = right;
        Some(())
    }

    /// Moves the blocks that it reads to τ. One on a crossing depends on its driver alone: what it
    /// reads itself stays where it is.
    fn move_before(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        self.moved = self.behind(|block| match block {
            BlockSolver::InterpolatedBlock(interpolated) => interpolated.is_within(&self.drivers),
            _ => false,
        });
        self.move_blocks(tau)
    }

    /// Moves all blocks to τ that it reads, directly or through others.
    fn move_all_before(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        self.moved = self.behind(|_| false);
        self.move_blocks(tau)
    }

    /// Returns the blocks that it reads, directly or through others, but not through those at which
    /// the search `stops`.
    fn behind(&self, stops: impl Fn(&BlockSolver) -> bool) -> BTreeSet<usize> {
        let mut found = BTreeSet::new();
        let mut open = self.reads[self.block].clone();
        while let Some(block) = open.pop() {
            if found.insert(block) && !stops(&self.before[block]) {
                open.extend(&self.reads[block]);
            }
        }
        found
    }

    fn move_drivers(&mut self, tau: f64) {
        self.line
            .drivers(tau, self.held, self.motions, &mut self.jets);
        for (value, jet) in self.drivers.iter_mut().zip(&self.jets) {
            *value = jet.value;
        }
    }

    /// Moves blocks to τ, where the drivers are: along tangent and curvature from the start, then by
    /// Newton–Raphson. A block on a crossing follows it, and goes on beyond its end.
    fn move_blocks(&mut self, tau: f64) -> Option<()> {
        let off = tau - self.start;
        let Workspace {
            at,
            tangent,
            origin_tangent,
            ..
        } = &mut *self.work;
        let (velocity, acceleration) = (origin_tangent.velocity(), origin_tangent.acceleration());
        let mut state = BlockState {
            system: self.system,
            targets: self.targets,
            drivers: &self.drivers,
            at,
            tangent,
        };
        for &index in &self.moved {
            let block = &mut self.before[index];
            for &column in block.columns() {
                let ahead = off * (velocity[column] + 0.5 * off * acceleration[column]);
                let predicted = self.origin[column] + ahead;
                state.at.set_coordinate(column, predicted);
            }
            let block = match block {
                BlockSolver::InterpolatedBlock(on) if on.start_beyond(&mut state) => &mut on.block,
                block => block,
            };
            block.close(&mut state, Limits::STEP).ok()?;
            block.factorise(&mut state).ok()?;
            block.solve_rates(&mut state, &self.jets);
            let [velocity, acceleration] = [state.tangent.velocity(), state.tangent.acceleration()];
            let mut columns = block.columns().iter();
            if !columns.all(|&column| (velocity[column] + acceleration[column]).is_finite()) {
                return None;
            }
        }
        Some(())
    }

    fn driver(&self, row: usize) -> Jet {
        self.system.equations()[row].target_rates(&self.jets)
    }

    /// Returns F and J, scaled.
    fn equations(&self) -> (DVector<f64>, DMatrix<f64>) {
        let values = Values {
            at: &self.work.at,
            targets: self.targets,
            drivers: &self.drivers,
        };
        let place = |column: usize| self.work.place_of[column];
        let order = self.columns.len();
        self.system.dense_rows(&self.rows, order, place, values)
    }

    /// Returns F_p times first and second derivatives along the line of the unknowns before the
    /// block, scaled.
    fn read_rates(&self) -> [DVector<f64>; 2] {
        let rate = |rates: &[f64], order: fn(Jet) -> f64| {
            DVector::from_iterator(
                self.rows.len(),
                self.rows.iter().map(|&row| {
                    let equation = &self.system.equations()[row];
                    let mut gradient = Gradient::new();
                    equation.constraint.gradient(&self.work.at, &mut gradient);
                    let read = gradient
                        .entries()
                        .filter(|(column, _)| self.work.place_of[*column].is_none());
                    let sum: f64 = read.map(|(column, value)| value * rates[column]).sum();
                    (sum - order(self.driver(row))) * equation.row_scale(&self.work.at)
                }),
            )
        };
        [
            rate(self.work.tangent.velocity(), |jet| jet.first()),
            rate(self.work.tangent.acceleration(), |jet| jet.second()),
        ]
    }

    /// Returns F″\[V, V\], one entry per row, for V = (v, w p′).
    fn quadratic(&mut self, v: &DVector<f64>, w: f64) -> DVector<f64> {
        let Workspace {
            at,
            tangent,
            combined: rates,
            ..
        } = &mut *self.work;
        for &column in &self.read_columns {
            rates[column] = w * tangent.velocity()[column];
        }
        for ((&column, scale), v) in self.columns.iter().zip(&self.scales).zip(v.iter()) {
            rates[column] = scale * v;
        }
        let (at, rates) = (&*at, &*rates);
        DVector::from_iterator(
            self.rows.len(),
            self.rows.iter().map(|&row| {
                let equation = &self.system.equations()[row];
                equation.constraint.quadratic(at, rates) * equation.row_scale(at)
            }),
        )
    }

    /// Solves the bordered equations for z and ε at (α, τ), from the last place. Returns the
    /// derivatives of ε there, too.
    pub(super) fn solve(&mut self, alpha: f64, tau: f64) -> Option<ReducedPoint> {
        self.move_before(tau)?;
        let order = self.rows.len();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_CORRECTIONS {
            let (residual, jacobian) = self.equations();
            let bordered = self.bordered(&jacobian);
            let lu = bordered.clone().lu();
            let mut step = DVector::zeros(order + 1);
            step.rows_mut(0, order)
                .copy_from(&-(residual + self.epsilon * &self.b));
            step[order] = alpha - self.alpha();
            if !lu.solve_mut(&mut step) {
                return None;
            }
            let length = step.amax();
            if length.is_nan() || length > LARGEST_STEP {
                return None;
            }
            let largest = (self.columns.iter().zip(&self.scales))
                .map(|(&column, scale)| (self.work.at.coordinate(column) / scale).abs())
                .fold(1.0, f64::max);
            self.epsilon += step[order];
            // Rounding limits the unknowns before it limits ε, which to first order does not change
            // with them.
            if length <= 4.0 * f64::EPSILON * largest || (length < 1e-9 && length >= 0.5 * last) {
                return Some(self.derivatives(alpha, tau, &bordered, lu));
            }
            last = length;
            for (k, &column) in self.columns.iter().enumerate() {
                let value = self.work.at.coordinate(column) + step[k] * self.scales[k];
                self.work.at.set_coordinate(column, value);
            }
        }
        None
    }

    /// Puts the block's unknowns back to the start.
    pub(super) fn return_to_start(&mut self) {
        for &column in &self.columns {
            self.work.at.set_coordinate(column, self.origin[column]);
        }
        self.epsilon = 0.0;
    }

    /// Returns α = c · (z − z⁰).
    fn alpha(&self) -> f64 {
        let moved = self.columns.iter().zip(&self.scales).zip(self.c.iter());
        moved
            .map(|((&column, scale), c)| {
                c * (self.work.at.coordinate(column) - self.origin[column]) / scale
            })
            .sum()
    }

    fn bordered(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let order = self.rows.len();
        let mut bordered = DMatrix::zeros(order + 1, order + 1);
        bordered
            .view_mut((0, 0), (order, order))
            .copy_from(jacobian);
        bordered.view_mut((0, order), (order, 1)).copy_from(&self.b);
        bordered
            .view_mut((order, 0), (1, order))
            .copy_from(&self.c.transpose());
        bordered
    }

    fn derivatives(
        &mut self,
        alpha: f64,
        tau: f64,
        bordered: &DMatrix<f64>,
        lu: LU<f64, Dyn, Dyn>,
    ) -> ReducedPoint {
        let order = self.rows.len();
        let [read, bend] = self.read_rates();
        let solve = |mut side: DVector<f64>| {
            // Regular: it has just been solved with.
            lu.solve_mut(&mut side);
            side
        };
        let mut side = DVector::zeros(order + 1);
        side[order] = 1.0;
        let psi = bordered
            .transpose()
            .lu()
            .solve(&side)
            .unwrap_or_else(|| DVector::repeat(order + 1, f64::NAN));
        let psi = psi.rows(0, order).into_owned();
        let by_alpha = solve(side);
        let mut side = DVector::zeros(order + 1);
        side.rows_mut(0, order).copy_from(&-read);
        let by_tau = solve(side);
        let tangents = [&by_alpha, &by_tau].map(|v| v.rows(0, order).into_owned());
        let along = self.quadratic(&tangents[0], 0.0);
        let across = self.quadratic(&tangents[1], 1.0);
        let both = self.quadratic(&(&tangents[0] + &tangents[1]), 1.0);
        let mixed = 0.5 * (both - &along - &across);
        ReducedPoint {
            alpha,
            tau,
            epsilon: self.epsilon,
            first: [by_alpha[order], by_tau[order]],
            second: [
                -psi.dot(&along),
                -psi.dot(&mixed),
                -psi.dot(&(across + &bend)),
            ],
            tangents,
            z: self
                .columns
                .iter()
                .map(|&column| self.work.at.coordinate(column))
                .collect(),
            bend,
            bordered: lu,
        }
    }

    /// Returns the first and second derivative of z along the line on the motion through the
    /// regular pose `point`, where the block is, unscaled.
    pub(super) fn rates(&mut self, point: &ReducedPoint) -> [Vec<f64>; 2] {
        let order = self.rows.len();
        let slope = -point.first[1] / point.first[0];
        let velocity = &point.tangents[1] + slope * &point.tangents[0];
        // J z″ = −F″[T, T] − F_p p″ in the bordered form; a step along ∂z/∂α removes the rest in ε.
        let mut side = DVector::zeros(order + 1);
        side.rows_mut(0, order)
            .copy_from(&-(self.quadratic(&velocity, 1.0) + &point.bend));
        point.bordered.solve_mut(&mut side);
        let bend = -side[order] / point.first[0];
        let acceleration = side.rows(0, order) + bend * &point.tangents[0];
        [velocity, acceleration].map(|rates| self.unscaled(&rates))
    }

    /// Returns scaled values of the block's unknowns in metres and radians.
    pub(super) fn unscaled(&self, scaled: &DVector<f64>) -> Vec<f64> {
        let unknowns = scaled.iter().zip(&self.scales);
        unknowns.map(|(value, scale)| value * scale).collect()
    }

    /// Returns the singular values of the Jacobian at the last place, descending.
    pub(super) fn singular_values(&self) -> DVector<f64> {
        self.equations().1.singular_values()
    }

    /// Returns whether a block before it comes from a crossing.
    pub(super) fn reads_crossings(&self) -> bool {
        let mut blocks = self.moved.iter().map(|&block| &self.before[block]);
        blocks.any(|block| matches!(block, BlockSolver::InterpolatedBlock(_)))
    }

    /// Returns the largest distance of the block's bodies from the origin, scaled, at least one:
    /// rounding is some eps of it.
    pub(super) fn extent(&self) -> f64 {
        let origin = self.columns.iter().zip(&self.scales);
        origin
            .filter(|(column, _)| !self.system.is_angle(**column))
            .map(|(&column, scale)| (self.work.at.coordinate(column) / scale).abs())
            .fold(1.0, f64::max)
    }

    /// Returns q at τ, the last place; unknowns that it does not read are those of the start.
    pub(super) fn pose(&mut self, tau: f64) -> Vec<f64> {
        // The block itself stays there. A block before it may be singular at this place.
        let _ = self.move_all_before(tau);
        let mut q = self.origin.to_vec();
        let moved = self.moved.iter();
        let moved = moved.flat_map(|&block| self.before[block].columns());
        for &column in self.columns.iter().chain(moved) {
            q[column] = self.work.at.coordinate(column);
        }
        q
    }

    /// Returns the drivers' values at the last place.
    pub(super) fn drivers(&self) -> &[f64] {
        &self.drivers
    }
}
