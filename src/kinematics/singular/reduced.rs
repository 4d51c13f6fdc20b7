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

use nalgebra::DVector;

use super::upstream::{Line, Upstream, Workspace};
use crate::kinematics::linear::{DenseLu, Factors, nan_or_larger};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockPlan, BlockSolver};
use crate::kinematics::state::State;
use crate::mechanism::Jet;

/// Most Newton corrections of a block from a near place.
const MAX_CORRECTIONS: usize = 20;
/// Largest correction, in radians and characteristic lengths; a larger one has left the
/// neighbourhood.
const LARGEST_STEP: f64 = 0.5;

/// The reduced equation of a block.
pub(super) struct ReducedEquation<'a> {
    upstream: Upstream<'a>,
    own: &'a mut BlockSolver,
    /// The redundant rows set aside.
    pub(super) set_aside: &'a [usize],
    rows: Vec<usize>,
    row_scales: Vec<f64>,
    /// The unknowns that the rows read, of the blocks before it.
    read_columns: Vec<usize>,
    columns: Vec<usize>,
    /// Scale factor of each unknown \[m or rad\].
    pub(super) scales: Vec<f64>,
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
pub(super) struct BlockOnLine {
    pub(super) tau: f64,
    pub(super) unknowns: Vec<Jet>,
}

/// The motion of a block as a function of α: its unknowns and τ, and their derivatives in α.
pub(super) struct Along {
    pub(super) alpha: f64,
    pub(super) tau: f64,
    pub(super) z: Vec<f64>,
    /// dτ/dα.
    pub(super) slope: f64,
    /// dz/dα, scaled.
    pub(super) tangent: Vec<f64>,
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
        compiled: &'a mut CompiledMechanism,
        state: &'a State,
        block: usize,
        line: Line<'a>,
        start: f64,
        work: &'a mut Workspace,
    ) -> Option<(Self, ReducedPoint)> {
        let CompiledMechanism {
            system,
            plan,
            redundant,
            ..
        } = compiled;
        let system = &*system;
        let BlockPlan { blocks, reads, .. } = plan;
        let (own, before) = blocks[..=block].split_last_mut()?;
        let q = &state.pose.q;
        let columns = own.columns().to_vec();
        let read = reads[block].iter();
        let read_columns = read.flat_map(|&read| before[read].columns()).copied();
        let read_columns = read_columns.collect();
        work.place_of.fill(None);
        for (place, &column) in columns.iter().enumerate() {
            work.place_of[column] = Some(place);
            work.at.set_coordinate(column, q[column]);
        }
        let rows = own.rows().to_vec();
        let row_scale = |&row: &usize| system.equations()[row].row_scale(&work.at);
        let row_scales = rows.iter().map(row_scale).collect();
        let size = work.at.size();
        let scale = |&column: &usize| system.column_scale(column, size);
        let scales = columns.iter().map(scale).collect();
        let order = columns.len();
        let at_start = ReducedPoint {
            alpha: 0.0,
            tau: start,
            epsilon: 0.0,
            first: [0.0; 2],
            second: [0.0; 3],
            tangents: [DVector::zeros(order), DVector::zeros(order)],
            z: columns.iter().map(|&column| q[column]).collect(),
            pivot_ratio: 0.0,
        };
        let blocks = (block, before, &reads[..]);
        let mut reduced = Self {
            upstream: Upstream::new(blocks, system, state, (line, start), work),
            own,
            set_aside: &redundant.now,
            rows,
            row_scales,
            read_columns,
            columns,
            scales,
            b: DVector::zeros(order),
            c: DVector::zeros(order),
            residual: vec![0.0; order],
            read_rates: [vec![0.0; order], vec![0.0; order]],
            bordered: DenseLu::new(order + 1, 0),
            side: vec![0.0; order + 1],
            psi: vec![0.0; order + 1],
            speed: 0.0,
        };
        reduced.upstream.move_all_to(start)?;
        reduced.upstream.keep_tangent();
        reduced.border()?;
        let at_start = reduced.correct(at_start)?;
        reduced.speed = reduced.scaled_speed(&at_start.tangents[1]);
        (reduced.speed > 0.0 && reduced.speed.is_finite()).then_some((reduced, at_start))
    }

    /// Returns τ at the start.
    pub(super) fn start(&self) -> f64 {
        self.upstream.start
    }

    /// Returns whether the block reads one that comes from a crossing.
    pub(super) fn reads_crossings(&self) -> bool {
        self.upstream.has_crossings
    }

    /// Returns whether a block that it reads is singular at the last place, and not on a crossing.
    pub(super) fn reads_singular(&self) -> bool {
        self.upstream.is_singular()
    }

    /// Returns the largest scaled rate of the unknowns of the blocks moved and of these of its own.
    pub(super) fn scaled_speed(&self, own: &DVector<f64>) -> f64 {
        let Upstream { system, work, .. } = &self.upstream;
        let size = work.at.size();
        let velocity = work.tangent.velocity();
        let read = self.upstream.moved_columns();
        let read = read.map(|column| (velocity[column] / system.column_scale(column, size)).abs());
        let rows = self.rows.iter().zip(&self.row_scales);
        let driver = |row: usize| self.upstream.driver(row).first();
        let driven = rows.map(|(&row, scale)| (driver(row) * scale).abs());
        read.chain(driven).fold(own.amax(), f64::max)
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

    /// Follows the motion of the block from a place to τ, by its own solver.
    pub(super) fn follow(&mut self, from: &BlockOnLine, tau: f64) -> Option<BlockOnLine> {
        self.upstream.move_to(tau)?;
        let off = tau - from.tau;
        for (&column, z) in self.columns.iter().zip(&from.unknowns) {
            let ahead = off * (z.first() + 0.5 * off * z.second());
            let at = &mut self.upstream.work.at;
            at.set_coordinate(column, z.value + ahead);
        }
        self.upstream.close(self.own)?;
        let Workspace { at, tangent, .. } = &*self.upstream.work;
        let unknowns = self.columns.iter().map(|&column| {
            let rates = [tangent.velocity()[column], tangent.acceleration()[column]];
            Jet::new(at.coordinate(column), rates)
        });
        Some(BlockOnLine {
            tau,
            unknowns: unknowns.collect(),
        })
    }

    /// Evaluates F, F_p p′ and F_p p″ where the bodies are, and J, whose border stays empty.
    fn evaluate(&mut self) {
        let upstream = &self.upstream;
        let Workspace {
            tangent, place_of, ..
        } = &*upstream.work;
        let values = upstream.values();
        let (velocity, acceleration) = (tangent.velocity(), tangent.acceleration());
        self.bordered.clear();
        for (local, (&row, &row_scale)) in self.rows.iter().zip(&self.row_scales).enumerate() {
            let driver = upstream.driver(row);
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
            let system = upstream.system;
            let found = system.evaluate_scaled_row(row, row_scale, values, entry);
            self.residual[local] = found.value;
            self.read_rates[0][local] = first;
            self.read_rates[1][local] = second;
        }
    }

    /// Returns ψᵀF″\[V, V\] for V = x V₁ + y V₂, ψ being the one solved last.
    fn bend(&mut self, [along_alpha, along_tau]: &[DVector<f64>; 2], [x, y]: [f64; 2]) -> f64 {
        let Upstream { system, work, .. } = &mut self.upstream;
        let Workspace {
            at,
            tangent,
            combined: rates,
            ..
        } = &mut **work;
        for &column in &self.read_columns {
            rates[column] = y * tangent.velocity()[column];
        }
        for (k, (&column, scale)) in self.columns.iter().zip(&self.scales).enumerate() {
            rates[column] = scale * (x * along_alpha[k] + y * along_tau[k]);
        }
        let rows = self.rows.iter().zip(&self.row_scales).zip(&self.psi);
        let terms = rows.map(|((&row, scale), psi)| {
            let constraint = &system.equations()[row].constraint;
            psi * (scale * constraint.quadratic(at, rates))
        });
        terms.sum()
    }

    /// Solves the bordered equations for z and ε at a distance (α, τ) from a point. Returns the
    /// derivatives of ε there, too.
    pub(super) fn solve(&mut self, from: ReducedPoint, by: [f64; 2]) -> Option<ReducedPoint> {
        let point = self.extrapolate(from, by);
        self.upstream.move_to(point.tau)?;
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
                self.upstream.work.at.set_coordinate(column, *z);
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

    /// Finds the motion at a value of α from a place near there, as z and τ of F = 0 with
    /// c · (z − z⁰) = α: unlike its own solver this does not mind that the motion turns back.
    pub(super) fn at_alpha(&mut self, near: &Along, alpha: f64) -> Option<Along> {
        let order = self.rows.len();
        let off = alpha - near.alpha;
        let mut tau = near.tau + off * near.slope;
        let unknowns = near.z.iter().zip(&self.scales).zip(&near.tangent);
        let ahead = unknowns.map(|((z, scale), tangent)| z + off * tangent * scale);
        let mut z: Vec<_> = ahead.collect();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_CORRECTIONS {
            self.upstream.move_to(tau)?;
            for (&column, z) in self.columns.iter().zip(&z) {
                self.upstream.work.at.set_coordinate(column, *z);
            }
            self.evaluate();
            for k in 0..order {
                self.bordered.add(k, order, self.read_rates[0][k]);
                self.bordered.add(order, k, self.c[k]);
                self.side[k] = -self.residual[k];
            }
            self.side[order] = alpha - self.alpha(z.iter().copied());
            self.bordered.factorise(0.0).ok()?;
            self.bordered.solve(&mut self.side);
            let length = self.side[..order]
                .iter()
                .fold(0.0, |most, step| nan_or_larger(most, step.abs()));
            if length.is_nan() || length > LARGEST_STEP {
                return None;
            }
            let is_last = length < 1e-9 && length >= 0.5 * last;
            last = length;
            if is_last {
                self.side.fill(0.0);
                self.side[order] = 1.0;
                self.bordered.solve(&mut self.side);
                return Some(Along {
                    alpha,
                    tau,
                    z,
                    slope: self.side[order],
                    tangent: self.side[..order].to_vec(),
                });
            }
            tau += self.side[order];
            for ((z, scale), step) in z.iter_mut().zip(&self.scales).zip(&self.side) {
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
        let moved =
            unknowns.map(|((&column, scale), z)| (z - self.upstream.origin[column]) / scale);
        moved.zip(self.c.iter()).map(|(moved, c)| moved * c).sum()
    }

    /// Returns α at a place of the motion, with its first derivative.
    pub(super) fn alpha_along(&self, place: &BlockOnLine) -> [f64; 2] {
        let rates = place.unknowns.iter().map(Jet::first).zip(&self.scales);
        let scaled = rates
            .zip(self.c.iter())
            .map(|((rate, scale), c)| rate / scale * c);
        let values = place.unknowns.iter().map(|jet| jet.value);
        [self.alpha(values), scaled.sum()]
    }

    /// Returns the singular values of the Jacobian at the last place, descending.
    pub(super) fn singular_values(&self) -> DVector<f64> {
        let Upstream { system, work, .. } = &self.upstream;
        let place = |column: usize| work.place_of[column];
        let (order, values) = (self.columns.len(), self.upstream.values());
        let (_, jacobian) = system.dense_rows(&self.rows, order, place, values);
        jacobian.singular_values()
    }

    /// Returns the largest distance of the block's bodies from the origin, scaled, at least one:
    /// rounding is some eps of it.
    pub(super) fn extent(&self) -> f64 {
        let Upstream { system, work, .. } = &self.upstream;
        let origin = self.columns.iter().zip(&self.scales);
        origin
            .filter(|(column, _)| !system.is_angle(**column))
            .map(|(&column, scale)| (work.at.coordinate(column) / scale).abs())
            .fold(1.0, f64::max)
    }

    /// Returns q at a point; unknowns that the block does not read are those of the start.
    pub(super) fn pose(&mut self, point: &ReducedPoint) -> Vec<f64> {
        // A block before it may be singular at this place.
        let _ = self.upstream.move_all_to(point.tau);
        let mut q = self.upstream.origin.to_vec();
        for column in self.upstream.moved_columns() {
            q[column] = self.upstream.work.at.coordinate(column);
        }
        for (&column, z) in self.columns.iter().zip(&point.z) {
            q[column] = *z;
        }
        q
    }

    /// Returns the drivers' values at the last place.
    pub(super) fn drivers(&self) -> &[f64] {
        &self.upstream.drivers
    }
}
