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

use nalgebra::DVector;

use crate::kinematics::block::{BlockPlan, BlockSolver, BlockState};
use crate::kinematics::configuration::Configuration;
use crate::kinematics::linear::{DenseLu, Factors, nan_or_larger};
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

    /// Returns the mechanism at the last place as block solvers see it.
    fn block_state<'b>(
        &'b mut self,
        system: &'b System,
        targets: &'b Targets,
        drivers: &'b [f64],
    ) -> BlockState<'b> {
        BlockState {
            system,
            targets,
            drivers,
            at: &mut self.at,
            tangent: &mut self.tangent,
        }
    }
}

/// The reduced equation of a block.
pub(super) struct ReducedEquation<'a> {
    system: &'a System,
    /// The redundant rows set aside.
    pub(super) set_aside: &'a [usize],
    targets: &'a Targets,
    motions: &'a Motions,
    line: Line<'a>,
    /// The block's index in the plan, the block itself, those before it, and the blocks that each
    /// block reads.
    block: usize,
    own: &'a mut BlockSolver,
    before: &'a mut [BlockSolver],
    reads: &'a [Vec<usize>],
    /// The blocks before it that it reads, directly or through others, ascending; and those of them
    /// that were moved to the last place.
    read_blocks: Vec<usize>,
    moved: Vec<usize>,
    /// Whether one of them comes from a crossing.
    pub(super) reads_crossings: bool,
    rows: Vec<usize>,
    row_scales: Vec<f64>,
    /// The unknowns that the rows read, of the blocks before it.
    read_columns: Vec<usize>,
    columns: Vec<usize>,
    /// Scale factor of each unknown \[m or rad\].
    pub(super) scales: Vec<f64>,
    work: &'a mut Workspace,
    held: &'a [f64],
    jets: Vec<Jet>,
    drivers: Vec<f64>,
    /// The start: τ and the pose there.
    pub(super) start: f64,
    origin: &'a [f64],
    /// The bordering vectors, scaled.
    b: DVector<f64>,
    c: DVector<f64>,
    /// F at the last place, then F_p p′ and F_p p″, scaled.
    residual: Vec<f64>,
    read_rates: [Vec<f64>; 2],
    /// The bordered Jacobian there, or its factors.
    bordered: DenseLu,
    /// Sides of the bordered equations.
    side: Vec<f64>,
    psi: Vec<f64>,
    /// The largest scaled rate with τ at the start, of the unknowns before the block, too.
    pub(super) speed: f64,
}

/// The motion of a block at one place of the line: its unknowns with their derivatives in τ.
pub(super) struct Place {
    pub(super) tau: f64,
    pub(super) unknowns: Vec<Jet>,
}

/// The reduced equation at one place.
#[derive(Clone)]
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
    /// Ratio of the extreme pivots of the bordered Jacobian.
    pub(super) pivot_ratio: f64,
}

impl<'a> ReducedEquation<'a> {
    /// Reduces the equations of a block from the pose, which is at `start` of the line. Returns them
    /// with their point there; `None` where they have no bordered solution.
    pub(super) fn new(
        model: &'a mut Model,
        state: &'a State,
        block: usize,
        line: Line<'a>,
        start: f64,
        work: &'a mut Workspace,
    ) -> Option<(Self, ReducedPoint)> {
        let State {
            pose,
            targets,
            motions,
            ..
        } = state;
        let Model {
            system,
            plan,
            redundant,
            ..
        } = model;
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
        let read_blocks = read_through(block, reads, |_| false);
        let mut read = read_blocks.iter().map(|&block| &before[block]);
        let reads_crossings = read.any(|block| matches!(block, BlockSolver::InterpolatedBlock(_)));
        let size = work.at.size();
        let order = columns.len();
        let at_start = ReducedPoint {
            alpha: 0.0,
            tau: start,
            epsilon: 0.0,
            first: [0.0; 2],
            second: [0.0; 3],
            tangents: [DVector::zeros(order), DVector::zeros(order)],
            z: columns.iter().map(|&column| pose.q[column]).collect(),
            pivot_ratio: 0.0,
        };
        let mut reduced = Self {
            system,
            set_aside: &redundant.now,
            targets,
            motions,
            line,
            block,
            read_columns: read_columns.collect(),
            rows: own.rows().to_vec(),
            row_scales: own
                .rows()
                .iter()
                .map(|&row| system.equations()[row].row_scale(&work.at))
                .collect(),
            scales: columns
                .iter()
                .map(|&column| system.column_scale(column, size))
                .collect(),
            columns,
            own,
            before,
            reads,
            moved: read_blocks.clone(),
            read_blocks,
            reads_crossings,
            work,
            held: &pose.drivers,
            jets: vec![Jet::constant(0.0); pose.drivers.len()],
            drivers: pose.drivers.clone(),
            start,
            origin: &pose.q,
            b: DVector::zeros(order),
            c: DVector::zeros(order),
            residual: vec![0.0; order],
            read_rates: [vec![0.0; order], vec![0.0; order]],
            bordered: DenseLu::new(order + 1, 0),
            side: vec![0.0; order + 1],
            psi: vec![0.0; order + 1],
            speed: 0.0,
        };
        reduced.move_all_before(start)?;
        reduced.keep_tangent();
        reduced.border()?;
        let at_start = reduced.correct(at_start)?;
        reduced.speed = reduced.scaled_speed(&at_start.tangents[1]);
        (reduced.speed > 0.0 && reduced.speed.is_finite()).then_some((reduced, at_start))
    }

    /// Returns the largest scaled rate of the unknowns of the blocks moved and of these of its own.
    pub(super) fn scaled_speed(&self, own: &DVector<f64>) -> f64 {
        let size = self.work.at.size();
        let moved = self.moved.iter();
        let read = moved.flat_map(|&block| self.before[block].columns());
        let read = read.map(|&column| {
            (self.work.tangent.velocity()[column] / self.system.column_scale(column, size)).abs()
        });
        let rows = self.rows.iter().zip(&self.row_scales);
        let driven = rows.map(|(&row, scale)| (self.driver(row).first() * scale).abs());
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
        let order = self.rows.len();
        self.evaluate();
        // Solves with the Jacobian alone, for sides that end with a zero.
        let lu = &mut self.bordered;
        lu.add(order, order, 1.0);
        lu.factorise(0.0).ok()?;
        let any = |k| {
            if k < order {
                1.0 + 0.618 * (k % 3) as f64
            } else {
                0.0
            }
        };
        let mut right = DVector::from_fn(order + 1, |k, _| any(k));
        lu.solve(right.as_mut_slice());
        right.try_normalize_mut(0.0)?;
        let mut left = right.clone();
        for _ in 0..3 {
            left.copy_from(&right);
            lu.solve_transposed(left.as_mut_slice());
            left.try_normalize_mut(0.0)?;
            right.copy_from(&left);
            lu.solve(right.as_mut_slice());
            right.try_normalize_mut(0.0)?;
        }
        self.b.copy_from(&left.rows(0, order));
        self.c.copy_from(&right.rows(0, order));
        Some(())
    }

    /// Moves the blocks that it reads to τ. One on a crossing depends on its driver alone: what it
    /// reads itself stays where it is.
    fn move_before(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        if self.reads_crossings {
            self.moved = read_through(self.block, self.reads, |block| match &self.before[block] {
                BlockSolver::InterpolatedBlock(block) => block.is_within(&self.drivers),
                _ => false,
            });
        }
        self.move_blocks(tau)
    }

    /// Moves all blocks to τ that it reads, directly or through others.
    fn move_all_before(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        self.moved.clone_from(&self.read_blocks);
        self.move_blocks(tau)
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
            at, origin_tangent, ..
        } = &mut *self.work;
        let (velocity, acceleration) = (origin_tangent.velocity(), origin_tangent.acceleration());
        for &block in &self.moved {
            for &column in self.before[block].columns() {
                let ahead = off * (velocity[column] + 0.5 * off * acceleration[column]);
                at.set_coordinate(column, self.origin[column] + ahead);
            }
        }
        let mut state = (self.work).block_state(self.system, self.targets, &self.drivers);
        for &block in &self.moved {
            let block = match &mut self.before[block] {
                BlockSolver::InterpolatedBlock(on) if on.start_beyond(&mut state) => &mut on.block,
                block => block,
            };
            close(block, &mut state, Limits::STEP, &self.jets)?;
        }
        Some(())
    }

    /// Follows the motion of the block from a place to τ, by its own solver.
    pub(super) fn follow(&mut self, from: &Place, tau: f64) -> Option<Place> {
        self.move_before(tau)?;
        let off = tau - from.tau;
        for (&column, z) in self.columns.iter().zip(&from.unknowns) {
            let ahead = off * (z.first() + 0.5 * off * z.second());
            self.work.at.set_coordinate(column, z.value + ahead);
        }
        let mut state = (self.work).block_state(self.system, self.targets, &self.drivers);
        close(self.own, &mut state, Limits::TO_THE_LAST_BIT, &self.jets)?;
        let BlockState { at, tangent, .. } = state;
        let unknowns = self.columns.iter().map(|&column| {
            let rates = [tangent.velocity()[column], tangent.acceleration()[column]];
            Jet::new(at.coordinate(column), rates)
        });
        Some(Place {
            tau,
            unknowns: unknowns.collect(),
        })
    }

    fn driver(&self, row: usize) -> Jet {
        self.system.equations()[row].target_rates(&self.jets)
    }

    /// Evaluates F, F_p p′ and F_p p″ where the bodies are, and J, whose border stays empty.
    fn evaluate(&mut self) {
        let Workspace {
            at,
            tangent,
            place_of,
            ..
        } = &*self.work;
        let values = Values {
            at,
            targets: self.targets,
            drivers: &self.drivers,
        };
        let (velocity, acceleration) = (tangent.velocity(), tangent.acceleration());
        self.bordered.clear();
        for (local, (&row, &row_scale)) in self.rows.iter().zip(&self.row_scales).enumerate() {
            let driver = self.driver(row);
            let mut first = -driver.first() * row_scale;
            let mut second = -driver.second() * row_scale;
            let entry = |column: usize, value: f64| {
                if let Some(own) = place_of[column] {
                    self.bordered.add(local, own, value * self.scales[own]);
                } else {
                    first += value * velocity[column];
                    second += value * acceleration[column];
                }
            };
            let found = (self.system).evaluate_scaled_row(row, row_scale, values, entry);
            self.residual[local] = found.value;
            self.read_rates[0][local] = first;
            self.read_rates[1][local] = second;
        }
    }

    /// Returns ψᵀF″\[V, V\] for V = x V₁ + y V₂, ψ being the one solved last.
    fn bend(&mut self, [along_alpha, along_tau]: &[DVector<f64>; 2], [x, y]: [f64; 2]) -> f64 {
        let Workspace {
            at,
            tangent,
            combined: rates,
            ..
        } = &mut *self.work;
        for &column in &self.read_columns {
            rates[column] = y * tangent.velocity()[column];
        }
        for (k, (&column, scale)) in self.columns.iter().zip(&self.scales).enumerate() {
            rates[column] = scale * (x * along_alpha[k] + y * along_tau[k]);
        }
        let rows = self.rows.iter().zip(&self.row_scales).zip(&self.psi);
        let terms = rows.map(|((&row, scale), psi)| {
            let constraint = &self.system.equations()[row].constraint;
            psi * (scale * constraint.quadratic(at, rates))
        });
        terms.sum()
    }

    /// Solves the bordered equations for z and ε at a distance (α, τ) from a point. Returns the
    /// derivatives of ε there, too.
    pub(super) fn solve(&mut self, from: ReducedPoint, by: [f64; 2]) -> Option<ReducedPoint> {
        let point = self.extrapolate(from, by);
        self.move_before(point.tau)?;
        self.correct(point)
    }

    /// Moves a point by a distance (α, τ) along its tangents; its derivatives stay.
    pub(super) fn extrapolate(
        &self,
        mut point: ReducedPoint,
        [by_alpha, by_tau]: [f64; 2],
    ) -> ReducedPoint {
        let [along_alpha, along_tau] = &point.tangents;
        for (k, (z, scale)) in point.z.iter_mut().zip(&self.scales).enumerate() {
            *z += (by_alpha * along_alpha[k] + by_tau * along_tau[k]) * scale;
        }
        point.alpha += by_alpha;
        point.tau += by_tau;
        point.epsilon += by_alpha * point.first[0] + by_tau * point.first[1];
        point
    }

    /// Corrects z and ε of a point at its α and τ, and renews its derivatives. The blocks before are
    /// at τ.
    fn correct(&mut self, mut point: ReducedPoint) -> Option<ReducedPoint> {
        let order = self.rows.len();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_CORRECTIONS {
            for (&column, z) in self.columns.iter().zip(&point.z) {
                self.work.at.set_coordinate(column, *z);
            }
            self.evaluate();
            for (k, (b, c)) in self.b.iter().zip(self.c.iter()).enumerate() {
                self.bordered.add(k, order, *b);
                self.bordered.add(order, k, *c);
                self.side[k] = -(self.residual[k] + point.epsilon * b);
            }
            self.side[order] = point.alpha - self.alpha(point.z.iter().copied());
            self.bordered.factorise(0.0).ok()?;
            self.bordered.solve(&mut self.side);
            let step = self.side.iter().map(|part| part.abs());
            let length = step.fold(0.0, nan_or_larger);
            if length.is_nan() || length > LARGEST_STEP {
                return None;
            }
            let unknowns = point.z.iter().zip(&self.scales);
            let farthest = unknowns.fold(1.0, |most: f64, (z, scale)| most.max((z / scale).abs()));
            point.epsilon += self.side[order];
            // Rounding limits the unknowns before it limits ε, which to first order does not change
            // with them.
            if length <= 4.0 * f64::EPSILON * farthest || (length < 1e-9 && length >= 0.5 * last) {
                self.renew_derivatives(&mut point);
                return Some(point);
            }
            last = length;
            for ((z, scale), step) in point.z.iter_mut().zip(&self.scales).zip(&self.side) {
                *z += step * scale;
            }
        }
        None
    }

    /// Renews the derivatives of a point, with the bordered Jacobian factorised there.
    fn renew_derivatives(&mut self, point: &mut ReducedPoint) {
        let order = self.rows.len();
        let Self {
            bordered,
            side,
            psi,
            read_rates: [read, bend],
            ..
        } = self;
        let [along_alpha, along_tau] = &mut point.tangents;
        side.fill(0.0);
        side[order] = 1.0;
        psi.copy_from_slice(side);
        bordered.solve_transposed(psi);
        bordered.solve(side);
        along_alpha.copy_from_slice(&side[..order]);
        point.first[0] = side[order];
        for (side, read) in side.iter_mut().zip(&*read) {
            *side = -read;
        }
        side[order] = 0.0;
        bordered.solve(side);
        along_tau.copy_from_slice(&side[..order]);
        point.first[1] = side[order];
        let (low, high) = bordered.pivot_range();
        point.pivot_ratio = low / high;
        let read: f64 = psi.iter().zip(&*bend).map(|(psi, bend)| psi * bend).sum();
        let along = self.bend(&point.tangents, [1.0, 0.0]);
        let across = self.bend(&point.tangents, [0.0, 1.0]);
        let both = self.bend(&point.tangents, [1.0, 1.0]);
        point.second = [-along, -0.5 * (both - along - across), -(across + read)];
    }

    /// Returns α of unknowns of the block: c · (z − z⁰).
    fn alpha(&self, z: impl Iterator<Item = f64>) -> f64 {
        let unknowns = self.columns.iter().zip(&self.scales).zip(z);
        let moved = unknowns.map(|((&column, scale), z)| (z - self.origin[column]) / scale);
        moved.zip(self.c.iter()).map(|(moved, c)| moved * c).sum()
    }

    /// Returns α at a place of the motion, with its first derivative.
    pub(super) fn alpha_along(&self, place: &Place) -> [f64; 2] {
        let rates = place.unknowns.iter().map(Jet::first).zip(&self.scales);
        let scaled = rates
            .zip(self.c.iter())
            .map(|((rate, scale), c)| rate / scale * c);
        let values = place.unknowns.iter().map(|jet| jet.value);
        [self.alpha(values), scaled.sum()]
    }

    /// Returns the singular values of the Jacobian at the last place, descending.
    pub(super) fn singular_values(&self) -> DVector<f64> {
        let values = Values {
            at: &self.work.at,
            targets: self.targets,
            drivers: &self.drivers,
        };
        let place = |column: usize| self.work.place_of[column];
        let order = self.columns.len();
        let (_, jacobian) = self.system.dense_rows(&self.rows, order, place, values);
        jacobian.singular_values()
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

    /// Returns q at a point; unknowns that the block does not read are those of the start.
    pub(super) fn pose(&mut self, point: &ReducedPoint) -> Vec<f64> {
        // A block before it may be singular at this place.
        let _ = self.move_all_before(point.tau);
        let mut q = self.origin.to_vec();
        let moved = self.moved.iter();
        for &column in moved.flat_map(|&block| self.before[block].columns()) {
            q[column] = self.work.at.coordinate(column);
        }
        for (&column, z) in self.columns.iter().zip(&point.z) {
            q[column] = *z;
        }
        q
    }

    /// Returns the drivers' values at the last place.
    pub(super) fn drivers(&self) -> &[f64] {
        &self.drivers
    }
}

/// Returns the blocks that a block reads, directly or through others, ascending, but not through
/// those at which the search `stops`.
fn read_through(block: usize, reads: &[Vec<usize>], stops: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut found = BTreeSet::new();
    let mut open = reads[block].clone();
    while let Some(block) = open.pop() {
        if found.insert(block) && !stops(block) {
            open.extend(&reads[block]);
        }
    }
    found.into_iter().collect()
}

/// Solves a block and its rates by its own solver from where its bodies are.
fn close(
    block: &mut BlockSolver,
    state: &mut BlockState<'_>,
    limits: Limits,
    drivers: &[Jet],
) -> Option<()> {
    block.close(state, limits).ok()?;
    block.factorise(state).ok()?;
    block.solve_rates(state, drivers);
    let [velocity, acceleration] = [state.tangent.velocity(), state.tangent.acceleration()];
    let mut columns = block.columns().iter();
    let finite = columns.all(|&column| (velocity[column] + acceleration[column]).is_finite());
    finite.then_some(())
}
