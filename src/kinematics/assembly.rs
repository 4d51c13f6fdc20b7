//! The first pose, from the estimates in the file (Ec. 3.6.9), and what stays open without one.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::constraint::{Dimension, Incidence, TurnEffect};
use super::error::OpenJoint;
use super::newton::{Outcome, SINGULAR};
use super::solver::{Pose, Solver};
use super::stepping::Progress;
use super::{Element, Error, Path};

/// How the pose for the first values was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// By continuous motion: the assembly mode is the one of the pose started from.
    Continuous(Progress),
    /// From the estimates, because something was in the way; possibly in another assembly mode.
    Reassembled(Assembly),
}

/// How an assembly went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembly {
    /// Newton corrections after the minimisation.
    pub iterations: u32,
    /// The largest distance of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// The weights r of Ec. 3.6.9, from one where the estimates count as much as the constraints to
/// one where the minimum is within Newton's reach.
const WEIGHTS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];
/// Minimisation steps for each weight; Newton follows, so that none needs to converge.
const STEPS_PER_WEIGHT: usize = 20;
/// Minimisation steps towards the nearest pose of a mechanism that does not close.
const STEPS_TO_NEAREST: usize = 200;
/// Newton from the minimum; it also has to creep into nearly singular positions.
const MAX_ITERATIONS: u32 = 30;
/// The estimates themselves, and this many less one deterministic shifts of them: estimates of
/// zero often lie on a symmetry from which no minimisation can choose a side.
const STARTS: usize = 8;
/// A scaled residual below this is no gap that anyone could measure: the mechanism closes, and
/// Newton failed because the position is singular.
const CLOSED: f64 = 1e-7;
/// How much more than a joint left open all others count when the gap is gathered in it.
const HOLD_CLOSED: f64 = 1e3;

impl Solver {
    /// Finds the pose at the end of `path` that is near the file's estimates: minimises
    /// (q − q⁰)ᵀ(q − q⁰) + r PhiᵀPhi for growing r (Ec. 3.6.9), then applies Newton–Raphson.
    ///
    /// Angles and lengths are scaled by the mechanism's size. An assembled angle is the
    /// representative nearest its estimate, unless an angle driver says which turn it is.
    ///
    /// # Errors
    ///
    /// [`Error::NotAssembled`] with what stays open; [`Error::Singular`] if the mechanism closes
    /// in a singular position; [`Error::NotFinite`] and [`Error::NotPositive`] for values that
    /// make no mechanism. The solver is then without a valid pose until it is assembled or
    /// [restored](Self::restore).
    pub fn assemble(&mut self, path: &Path) -> Result<Assembly, Error> {
        self.pose.parameters.copy_from_slice(&path.to);
        self.take_over_parameters()?;
        self.set_path(path, 1.0)?;
        let estimate = self.estimate()?;
        self.pose.q.copy_from_slice(estimate.as_slice());
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
        self.fix_turns();

        let mut nearest = (f64::INFINITY, self.pose.q.clone());
        let mut outcome = None;
        for attempt in 0..STARTS {
            for (k, q) in self.pose.q.iter_mut().enumerate() {
                *q = estimate[k] + shift(attempt, k) * self.system.column_scale(k, self.at.size());
            }
            self.estimate_joint_unknowns();
            let attempted = self.minimise_and_correct();
            if attempted.converged {
                outcome = Some(attempted);
                break;
            }
            self.minimise(None, |_| 1.0, STEPS_TO_NEAREST);
            let gap = self.residual_norm();
            if gap < nearest.0 {
                nearest = (gap, self.pose.q.clone());
            }
        }
        let Some(outcome) = outcome else {
            self.pose.q.copy_from_slice(&nearest.1);
            return Err(self.explain_failure());
        };
        self.choose_turns(&estimate);
        self.refresh()?;
        let rcond = self.lu.rcond();
        if rcond < SINGULAR {
            return Err(Error::Singular { rcond });
        }
        Ok(Assembly {
            iterations: outcome.iterations,
            distance: self.scaled_distance(&estimate),
        })
    }

    /// Minimises Ec. 3.6.9 for growing r from the present q, then applies Newton–Raphson.
    fn minimise_and_correct(&mut self) -> Outcome {
        let start = DVector::from_column_slice(&self.pose.q);
        for weight in WEIGHTS {
            self.minimise(Some((&start, weight.recip())), |_| 1.0, STEPS_PER_WEIGHT);
        }
        self.correct(MAX_ITERATIONS)
    }

    /// Finds the pose at the end of `path`: moves there continuously from `home`, which is at its
    /// start, or, if something is in the way, assembles there from the estimates.
    ///
    /// # Errors
    ///
    /// Those of [`assemble`](Self::assemble).
    pub fn start(&mut self, home: &Pose, path: &Path) -> Result<Start, Error> {
        self.restore(home);
        match self.follow(path) {
            Ok(progress) => Ok(Start::Continuous(progress)),
            Err(_) => self.assemble(path).map(Start::Reassembled),
        }
    }

    /// q⁰, with the parameter values in force.
    fn estimate(&self) -> Result<DVector<f64>, Error> {
        let parameters = &self.pose.parameters;
        let bodies = &self.system.mechanism().bodies;
        let mut estimate = DVector::zeros(self.system.unknowns());
        for (body, q) in bodies
            .iter()
            .zip(estimate.as_mut_slice().chunks_exact_mut(3))
        {
            for (q, expression) in q.iter_mut().zip(&body.estimate) {
                *q = expression.evaluate(&|p| parameters[p.index()], 0.0);
                if !q.is_finite() {
                    return Err(Error::NotFinite {
                        what: format!("the estimate of body `{}`", body.name),
                    });
                }
            }
        }
        Ok(estimate)
    }

    /// Gives the joints' own unknowns their estimates, for bodies where q has them.
    fn estimate_joint_unknowns(&mut self) {
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
        let bodies = self.system.mechanism().bodies.len();
        let unknowns = self.pose.q[3 * bodies..].iter_mut();
        for (q, estimate) in unknowns.zip(self.system.estimate_joint_unknowns(&self.at)) {
            *q = estimate;
        }
    }

    fn fix_turns(&mut self) {
        self.system.fix_turns(&self.at, &mut self.targets);
        self.pose.turns.copy_from_slice(&self.targets.turns);
    }

    /// The largest distance of a body from its estimate.
    fn scaled_distance(&self, estimate: &DVector<f64>) -> f64 {
        let bodies = self.system.mechanism().bodies.len();
        self.pose.q[..3 * bodies]
            .iter()
            .zip(estimate)
            .enumerate()
            .map(|(k, (q, e))| (q - e).abs() / self.system.column_scale(k, self.at.size()))
            .fold(0.0, f64::max)
    }

    /// Levenberg–Marquardt on pull · ‖q − q⁰‖² + Σ (weight(row) Phi_row)², scaled, from the
    /// present q.
    fn minimise(
        &mut self,
        pull: Option<(&DVector<f64>, f64)>,
        weight: impl Fn(usize) -> f64,
        steps: usize,
    ) {
        let order = self.system.unknowns();
        let scale = DVector::from_fn(order, |k, _| self.system.column_scale(k, self.at.size()));
        let weights = DVector::from_fn(order, |row, _| weight(row));
        let mut damping = 1e-6;
        let (mut residual, mut jacobian) = self.weighted_equations(&weights);
        let mut cost = self.cost(pull, &scale, &residual);
        for _ in 0..steps {
            let mut gradient = jacobian.tr_mul(&residual);
            let mut normal = jacobian.tr_mul(&jacobian);
            if let Some((estimate, strength)) = pull {
                for k in 0..order {
                    gradient[k] += strength * (self.pose.q[k] - estimate[k]) / scale[k];
                    normal[(k, k)] += strength;
                }
            }
            let before = self.pose.q.clone();
            let improved = loop {
                let mut damped = normal.clone();
                for k in 0..order {
                    damped[(k, k)] += damping;
                }
                if let Some(factor) = damped.cholesky() {
                    let step = factor.solve(&gradient);
                    for k in 0..order {
                        self.pose.q[k] = before[k] - step[k] * scale[k];
                    }
                    let (new_residual, new_jacobian) = self.weighted_equations(&weights);
                    let new_cost = self.cost(pull, &scale, &new_residual);
                    if new_cost < cost {
                        let gain = (cost - new_cost) / cost;
                        (residual, jacobian, cost) = (new_residual, new_jacobian, new_cost);
                        damping = (damping * 0.1).max(1e-15);
                        break gain > 1e-12;
                    }
                }
                damping *= 10.0;
                if damping > 1e12 {
                    self.pose.q.copy_from_slice(&before);
                    break false;
                }
            };
            if !improved {
                break;
            }
        }
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
    }

    fn cost(
        &self,
        pull: Option<(&DVector<f64>, f64)>,
        scale: &DVector<f64>,
        residual: &DVector<f64>,
    ) -> f64 {
        let distance = pull.map_or(0.0, |(estimate, strength)| {
            let squares = (0..scale.len())
                .map(|k| ((self.pose.q[k] - estimate[k]) / scale[k]).powi(2))
                .sum::<f64>();
            strength * squares
        });
        distance + residual.norm_squared()
    }

    /// Phi and Phi_q at the present q, scaled, each row times its weight.
    fn weighted_equations(&mut self, weights: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let order = self.system.unknowns();
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
        let mut jacobian = DMatrix::zeros(order, order);
        self.system.evaluate(
            &self.at,
            &self.pose.q,
            &self.targets,
            &self.pose.drivers,
            &mut self.residual,
            |row, column, value| jacobian[(row, column)] += value * weights[row],
        );
        (self.residual.value.component_mul(weights), jacobian)
    }

    /// The norm of Phi at the present q, scaled.
    fn residual_norm(&mut self) -> f64 {
        self.evaluate();
        self.residual.value.norm()
    }

    /// Adds whole turns to the bodies so that each angle is nearest its estimate. Bodies whose
    /// angles a driver ties together turn together, those it ties to ground not at all, nor do
    /// those whose turns a gear counts.
    fn choose_turns(&mut self, estimate: &DVector<f64>) {
        let bodies = self.system.mechanism().bodies.len();
        let ground = bodies;
        let mut group: Vec<usize> = (0..=bodies).collect();
        for equation in self.system.equations() {
            let effect = equation.constraint.turn_effect();
            if effect == TurnEffect::None || equation.holds_any_turn() {
                continue;
            }
            let mut incidence = Incidence::default();
            equation
                .constraint
                .incidence(self.system.mechanism(), &mut incidence);
            let mut tied: Vec<_> = incidence
                .unknowns
                .iter()
                .map(|k| (k / 3).min(ground))
                .collect();
            // An angle between two bodies leaves both free to turn together.
            if effect == TurnEffect::Proportional || tied.len() < 2 {
                tied.push(ground);
            }
            let tied: Vec<_> = tied.into_iter().map(|body| group[body]).collect();
            let keep = tied.iter().copied().max().unwrap_or(ground);
            for g in &mut group {
                if tied.contains(g) {
                    *g = keep;
                }
            }
        }
        let mut turns = vec![None; bodies + 1];
        turns[group[ground]] = Some(0.0);
        for body in 0..bodies {
            let phi = 3 * body + 2;
            let away = ((estimate[phi] - self.pose.q[phi]) / TAU).round();
            self.pose.q[phi] += TAU * *turns[group[body]].get_or_insert(away);
        }
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
        self.fix_turns();
    }

    /// The verdict on a mechanism whose nearest pose, at which the solver stands, leaves gaps.
    fn explain_failure(&mut self) -> Error {
        let order = self.system.unknowns();
        let ones = DVector::repeat(order, 1.0);
        let (residual, jacobian) = self.weighted_equations(&ones);
        if residual.amax() <= CLOSED {
            let singular = jacobian.singular_values();
            return Error::Singular {
                rcond: singular.min() / singular.max(),
            };
        }
        let nearest = self.pose.q.clone();
        let spread = self.open_joints(residual.amax());
        // The minimum spreads the gap over all joints of a loop. People look for one joint that
        // does not meet: gather it where it is smallest, in the joint declared last on a tie.
        let mut best: Option<(f64, OpenJoint)> = None;
        for (element, _) in &spread {
            self.pose.q.copy_from_slice(&nearest);
            let open = |row: usize| self.system.equations()[row].element == *element;
            let weights: Vec<_> = (0..order)
                .map(|row| if open(row) { 1.0 } else { HOLD_CLOSED })
                .collect();
            self.minimise(None, |row| weights[row], STEPS_TO_NEAREST);
            let (residual, _) = self.weighted_equations(&ones);
            let gap = residual.amax();
            if let [(only, joint)] = &self.open_joints(gap)[..]
                && only == element
                && best
                    .as_ref()
                    .is_none_or(|(smallest, _)| gap <= smallest * (1.0 + 1e-3))
            {
                best = Some((gap, joint.clone()));
            }
        }
        self.pose.q.copy_from_slice(&nearest);
        let open = match best {
            Some((_, joint)) => vec![joint],
            None => spread.into_iter().map(|(_, joint)| joint).collect(),
        };
        Error::NotAssembled {
            open,
            starts: STARTS,
        }
    }

    /// Joints, constraints and drivers with a noticeable part of the largest scaled residual.
    fn open_joints(&self, largest: f64) -> Vec<(Element, OpenJoint)> {
        let mut open: Vec<(Element, OpenJoint)> = Vec::new();
        for (row, equation) in self.system.equations().iter().enumerate() {
            let target = self.system.target(row, &self.targets, &self.pose.drivers);
            let error = (equation.constraint.value(&self.at) - target).abs();
            let (gap, angle) = match equation.constraint.dimension() {
                Dimension::Length if error / self.at.size() > 0.01 * largest => (error, 0.0),
                Dimension::Angle if error > 0.01 * largest => (0.0, error),
                _ => continue,
            };
            match open.last_mut() {
                Some((element, joint)) if *element == equation.element => {
                    joint.gap = joint.gap.hypot(gap);
                    joint.angle = joint.angle.max(angle);
                }
                _ => open.push((
                    equation.element,
                    OpenJoint {
                        element: equation.element.describe(self.system.mechanism()),
                        gap,
                        angle,
                    },
                )),
            }
        }
        open
    }
}

/// By how much start `attempt` differs from the estimates in coordinate k, scaled: nothing the
/// first time, then up to half a length or radian, spread evenly by the golden ratio.
fn shift(attempt: usize, k: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if attempt == 0 {
        0.0
    } else {
        (GOLDEN * (attempt * (k + 1)) as f64).fract() - 0.5
    }
}
