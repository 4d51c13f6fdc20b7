//! The equations of one block near a singular position, reduced to one function of two numbers.
//!
//! Let F(z, p(τ)) = 0 be the block's equations, z its unknowns, p what it reads, which runs with
//! the parameter τ of a line. Where the Jacobian J = ∂F/∂z has lost one rank,
//!
//! F(z, p(τ)) + ε b = 0, c · (z − z⁰) = α
//!
//! still determines z and ε for given α and τ (Lyapunov and Schmidt): bordered by b and c the
//! Jacobian is regular. The mechanism's poses are where ε(α, τ) = 0, so that all there is to know
//! of the singular position is in the first derivatives of ε and in the second, which are those of
//! the solver notes with the opposite sign: with ψᵀJ ∥ cᵀ, ψ · b = 1 and the tangents
//! V₁ = (∂z/∂α, 0), V₂ = (∂z/∂τ, p′)
//!
//! ε_αα = −ψᵀF″\[V₁, V₁\], ε_ατ = −ψᵀF″\[V₁, V₂\], ε_ττ = −ψᵀ(F″\[V₂, V₂\] + F_p p″).

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::kinematics::block::{Kernel, Work};
use crate::kinematics::configuration::Configuration;
use crate::kinematics::constraint::Gradient;
use crate::kinematics::newton::MAX_ITERATIONS;
use crate::kinematics::path::Motions;
use crate::kinematics::path::Rates;
use crate::kinematics::system::{System, Target, Targets};
use crate::kinematics::{Path, Pose};
use crate::mechanism::{DriverId, Jet};

/// What the drivers run along.
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

/// Newton's corrections on a block from a place that is near.
const MAX_CORRECTIONS: usize = 20;
/// A correction this large, in radians and characteristic lengths, has left the neighbourhood.
const LARGEST_STEP: f64 = 0.5;

/// A block with all that it reads.
pub(super) struct Reduced<'a> {
    system: &'a System,
    targets: &'a Targets,
    motions: &'a Motions,
    line: Line<'a>,
    /// What finds the unknowns that the block reads.
    before: &'a mut [Kernel],
    rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    /// Place of each unknown of the mechanism in the block.
    place_of: Vec<Option<usize>>,
    /// Metres or radians that a scaled unknown of one stands for.
    scales: Vec<f64>,
    at: Configuration,
    /// Rates along the line of what the block reads; elsewhere zero.
    flow: Rates,
    held: Vec<f64>,
    jets: Vec<Jet>,
    drivers: Vec<f64>,
    /// Where it started: τ, the pose there, and its rates along the line.
    pub(super) start: f64,
    origin: Vec<f64>,
    origin_flow: Rates,
    /// z⁰, and the bordering vectors, all scaled.
    b: DVector<f64>,
    c: DVector<f64>,
    /// The present ε, from which the next one is found.
    epsilon: f64,
    /// How fast scaled unknowns run with τ at the start, those that the block reads included.
    pub(super) speed: f64,
}

/// The reduced equation at one place.
pub(super) struct Sheet {
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
    /// Rows of the block: F_p p″ along the line.
    bend: DVector<f64>,
    bordered: LU<f64, Dyn, Dyn>,
}

/// The parts of a solver that the reduction works with.
pub(super) struct Ground<'a> {
    pub(super) system: &'a System,
    pub(super) targets: &'a Targets,
    pub(super) motions: &'a Motions,
    pub(super) at: &'a Configuration,
    pub(super) pose: &'a Pose,
    /// The kernels up to and including that of the block.
    pub(super) kernels: &'a mut [Kernel],
}

impl<'a> Reduced<'a> {
    /// The block of the last of `ground.kernels`, from the pose, which is at `start` of the line.
    /// `None` where the block is regular beyond doubt or nothing can be said.
    pub(super) fn new(ground: Ground<'a>, line: Line<'a>, start: f64) -> Option<Self> {
        let Ground {
            system,
            targets,
            motions,
            at,
            pose,
            kernels,
        } = ground;
        let (block, before) = kernels.split_last_mut()?;
        let columns = block.columns().to_vec();
        let mut place_of = vec![None; system.unknowns()];
        for (place, &column) in columns.iter().enumerate() {
            place_of[column] = Some(place);
        }
        let size = at.size();
        let order = columns.len();
        let mut reduced = Self {
            system,
            targets,
            motions,
            line,
            before,
            rows: block.rows().to_vec(),
            scales: columns
                .iter()
                .map(|&column| system.column_scale(column, size))
                .collect(),
            columns,
            place_of,
            at: at.clone(),
            flow: Rates::new(system.unknowns()),
            held: pose.drivers.clone(),
            jets: vec![Jet::constant(0.0); pose.drivers.len()],
            drivers: pose.drivers.clone(),
            start,
            origin: pose.q.clone(),
            origin_flow: Rates::new(system.unknowns()),
            b: DVector::zeros(order),
            c: DVector::zeros(order),
            epsilon: 0.0,
            speed: 0.0,
        };
        reduced.stand_before(start)?;
        reduced.origin_flow = reduced.flow.clone();
        reduced.border()?;
        let sheet = reduced.sheet(0.0, start)?;
        reduced.speed = reduced.scaled_speed(&sheet.tangents[1]);
        (reduced.speed > 0.0 && reduced.speed.is_finite()).then_some(reduced)
    }

    /// The largest scaled rate of what the block reads and of these rates of its own.
    pub(super) fn scaled_speed(&self, own: &DVector<f64>) -> f64 {
        let size = self.at.size();
        let read = self.before.iter().flat_map(|kernel| kernel.columns());
        let read = read.map(|&column| {
            (self.flow.velocity()[column] / self.system.column_scale(column, size)).abs()
        });
        let driven = self.rows.iter().map(|&row| {
            let scale = self.system.equations()[row].row_scale(&self.at);
            (self.driver(row).first() * scale).abs()
        });
        read.chain(driven).fold(own.amax(), f64::max)
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

    fn work(&mut self) -> (&mut [Kernel], Work<'_>) {
        let work = Work {
            system: self.system,
            targets: self.targets,
            drivers: &self.drivers,
            at: &mut self.at,
            flow: &mut self.flow,
        };
        (self.before, work)
    }

    /// Brings all that the block reads to τ: from the pose at the start along tangent and
    /// curvature there, then corrected.
    fn stand_before(&mut self, tau: f64) -> Option<()> {
        self.line
            .drivers(tau, &self.held, self.motions, &mut self.jets);
        for (value, jet) in self.drivers.iter_mut().zip(&self.jets) {
            *value = jet.value;
        }
        let off = tau - self.start;
        let Self {
            before,
            at,
            origin,
            origin_flow,
            ..
        } = self;
        for &column in before.iter().flat_map(|kernel| kernel.columns()) {
            let ahead = off
                * (origin_flow.velocity()[column] + 0.5 * off * origin_flow.acceleration()[column]);
            at.set_coordinate(column, origin[column] + ahead);
        }
        let jets = std::mem::take(&mut self.jets);
        let (before, mut work) = self.work();
        let stands = before.iter_mut().all(|kernel| {
            let closed = kernel.close(&mut work, MAX_ITERATIONS).is_ok()
                && kernel.factorise(&mut work).is_ok();
            if closed {
                kernel.solve_rates(&mut work, &jets);
            }
            closed
        });
        self.jets = jets;
        (stands && self.flow.is_finite()).then_some(())
    }

    fn driver(&self, row: usize) -> Jet {
        match self.system.equations()[row].target {
            Target::Constant(_) => Jet::constant(0.0),
            Target::Driver(driver) => self.jets[driver.index()],
        }
    }

    /// F and J, scaled.
    fn equations(&self) -> (DVector<f64>, DMatrix<f64>) {
        let order = self.rows.len();
        let mut residual = DVector::zeros(order);
        let mut jacobian = DMatrix::zeros(order, order);
        for (place, &row) in self.rows.iter().enumerate() {
            let value = self.system.evaluate_row(
                row,
                &self.at,
                self.targets,
                &self.drivers,
                |column, value| {
                    if let Some(column) = self.place_of[column] {
                        jacobian[(place, column)] += value;
                    }
                },
            );
            residual[place] = value.value;
        }
        (residual, jacobian)
    }

    /// F_p times first and second derivatives along the line of what the block reads, scaled.
    fn read_rates(&self) -> [DVector<f64>; 2] {
        let rate = |rates: &[f64], order: fn(Jet) -> f64| {
            DVector::from_iterator(
                self.rows.len(),
                self.rows.iter().map(|&row| {
                    let equation = &self.system.equations()[row];
                    let mut gradient = Gradient::new();
                    equation.constraint.gradient(&self.at, &mut gradient);
                    let read = gradient
                        .entries()
                        .filter(|(column, _)| self.place_of[*column].is_none());
                    let sum: f64 = read.map(|(column, value)| value * rates[column]).sum();
                    (sum - order(self.driver(row))) * equation.row_scale(&self.at)
                }),
            )
        };
        [
            rate(self.flow.velocity(), |jet| jet.first()),
            rate(self.flow.acceleration(), |jet| jet.second()),
        ]
    }

    /// F″\[V, V\], row by row, for V = (v, w p′).
    fn quadratic(&self, v: &DVector<f64>, w: f64) -> DVector<f64> {
        let mut rates: Vec<f64> = self.flow.velocity().iter().map(|rate| w * rate).collect();
        for ((&column, scale), v) in self.columns.iter().zip(&self.scales).zip(v.iter()) {
            rates[column] = scale * v;
        }
        DVector::from_iterator(
            self.rows.len(),
            self.rows.iter().map(|&row| {
                let equation = &self.system.equations()[row];
                equation.constraint.quadratic(&self.at, &rates) * equation.row_scale(&self.at)
            }),
        )
    }

    /// Solves the bordered equations for z and ε at (α, τ), from where the block is, and gives
    /// the derivatives of ε there.
    pub(super) fn sheet(&mut self, alpha: f64, tau: f64) -> Option<Sheet> {
        self.stand_before(tau)?;
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
                .map(|(&column, scale)| (self.at.coordinate(column) / scale).abs())
                .fold(1.0, f64::max);
            self.epsilon += step[order];
            // Where the unknowns cannot follow any more, ε still does: to first order it does
            // not change with them.
            if length <= 4.0 * f64::EPSILON * largest || (length < 1e-9 && length >= 0.5 * last) {
                return Some(self.derivatives(alpha, tau, &bordered, lu));
            }
            last = length;
            for (k, &column) in self.columns.iter().enumerate() {
                let value = self.at.coordinate(column) + step[k] * self.scales[k];
                self.at.set_coordinate(column, value);
            }
        }
        None
    }

    /// Puts the block's unknowns back to where they were at the start.
    pub(super) fn return_to_start(&mut self) {
        for &column in &self.columns {
            self.at.set_coordinate(column, self.origin[column]);
        }
        self.epsilon = 0.0;
    }

    /// c · (z − z⁰).
    fn alpha(&self) -> f64 {
        let moved = self.columns.iter().zip(&self.scales).zip(self.c.iter());
        moved
            .map(|((&column, scale), c)| {
                c * (self.at.coordinate(column) - self.origin[column]) / scale
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
        &self,
        alpha: f64,
        tau: f64,
        bordered: &DMatrix<f64>,
        lu: LU<f64, Dyn, Dyn>,
    ) -> Sheet {
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
        Sheet {
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
                .map(|&column| self.at.coordinate(column))
                .collect(),
            bend,
            bordered: lu,
        }
    }

    /// First and second derivative of z along the line on the motion through a regular pose, which
    /// `sheet` is at and the block stands at, unscaled.
    pub(super) fn rates(&self, sheet: &Sheet) -> [Vec<f64>; 2] {
        let order = self.rows.len();
        let slope = -sheet.first[1] / sheet.first[0];
        let velocity = &sheet.tangents[1] + slope * &sheet.tangents[0];
        // J z″ = −F″[T, T] − F_p p″, in the bordered form: what is left over in ε is made up for
        // along ∂z/∂α.
        let mut side = DVector::zeros(order + 1);
        side.rows_mut(0, order)
            .copy_from(&-(self.quadratic(&velocity, 1.0) + &sheet.bend));
        sheet.bordered.solve_mut(&mut side);
        let bend = -side[order] / sheet.first[0];
        let acceleration = side.rows(0, order) + bend * &sheet.tangents[0];
        [velocity, acceleration].map(|rates| self.unscaled(&rates))
    }

    /// Scaled values of the block's unknowns in metres and radians.
    pub(super) fn unscaled(&self, scaled: &DVector<f64>) -> Vec<f64> {
        let unknowns = scaled.iter().zip(&self.scales);
        unknowns.map(|(value, scale)| value * scale).collect()
    }

    /// Singular values of the Jacobian where the block stands, descending.
    pub(super) fn singular_values(&self) -> DVector<f64> {
        self.equations().1.singular_values()
    }

    /// Whether something that the block reads comes from a crossing.
    pub(super) fn reads_crossings(&self) -> bool {
        let mut kernels = self.before.iter();
        kernels.any(|kernel| matches!(kernel, Kernel::Interpolated(_)))
    }

    /// The largest distance from the origin of a coordinate of the block, scaled, and of what its
    /// angles read: rounding is this many eps.
    pub(super) fn extent(&self) -> f64 {
        let origin = self.columns.iter().zip(&self.scales);
        origin
            .filter(|(column, _)| !self.system.is_angle(**column))
            .map(|(&column, scale)| (self.at.coordinate(column) / scale).abs())
            .fold(1.0, f64::max)
    }

    /// q where the block and what it reads stand; the other unknowns as they were at the start.
    pub(super) fn pose(&self) -> Vec<f64> {
        let mut q = self.origin.clone();
        self.at.copy_pose(&mut q);
        q
    }

    /// The drivers' values at the present τ.
    pub(super) fn drivers(&self) -> &[f64] {
        &self.drivers
    }
}
