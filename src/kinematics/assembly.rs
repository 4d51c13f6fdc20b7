//! The first pose, from the estimates in the file (Ec. 3.6.9), and what stays open without one.

use std::f64::consts::TAU;

use super::constraint::{Dimension, Incidence, TurnEffect};
use super::error::OpenJoint;
use super::minimise::{MAX_ITERATIONS, Part, SMALL_PART, STARTS};
use super::newton::SINGULAR;
use super::plan::Kernel;
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

/// Minimisation steps towards the nearest pose of a mechanism that does not close.
const STEPS_TO_NEAREST: usize = 200;
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
        self.release_crossings();
        self.pose.parameters.copy_from_slice(&path.to);
        self.take_over_parameters()?;
        self.parameters_move = path.moves_parameters();
        self.set_path(path, 1.0)?;
        self.pose.drivers.copy_from_slice(&self.next_drivers);
        let estimate = self.estimate()?;
        self.pose.q.copy_from_slice(&estimate);
        self.stand_at_pose();
        self.fix_turns();

        let iterations = match self.assemble_in_order(&estimate) {
            Ok(iterations) => iterations,
            Err(kernel) => self.assemble_at_once(kernel, &estimate)?,
        };
        self.choose_turns(&estimate);
        self.refresh()?;
        let rcond = self.plan.rcond();
        if rcond < SINGULAR {
            return Err(Error::Singular { rcond });
        }
        self.settle();
        Ok(Assembly {
            iterations,
            distance: self.scaled_distance(&estimate),
        })
    }

    /// Assembles kernel by kernel, each behind those before it. Returns the most corrections
    /// that one needed.
    ///
    /// # Errors
    ///
    /// The kernel that does not close.
    fn assemble_in_order(&mut self, estimate: &[f64]) -> Result<u32, usize> {
        let (plan, mut work) = self.work();
        let mut iterations = 0;
        for (index, kernel) in plan.kernels.iter_mut().enumerate() {
            let assembled = match kernel {
                Kernel::Pinned(_) | Kernel::Bridged(_) => kernel.close(&mut work, MAX_ITERATIONS),
                Kernel::Dyad(kernel) => kernel.assemble(&mut work, estimate),
                Kernel::Slide(kernel) => kernel.assemble(&mut work, estimate),
                Kernel::Coupled(kernel) => Part::new(kernel.rows(), kernel.columns()).assemble(
                    &mut work,
                    estimate,
                    |work, most| kernel.correct(work, most),
                ),
            };
            let correction = assembled.map_err(|_| index)?;
            iterations = iterations.max(correction.iterations);
        }
        self.at.copy_pose(&mut self.pose.q);
        Ok(iterations)
    }

    /// Assembles a small mechanism as a whole, after a kernel did not close behind the others:
    /// they may have to close in another mode.
    ///
    /// # Errors
    ///
    /// What stays open in the nearest pose found; in a large mechanism that of the kernel's
    /// part alone.
    fn assemble_at_once(&mut self, kernel: usize, estimate: &[f64]) -> Result<u32, Error> {
        let whole = self.system.unknowns() <= SMALL_PART;
        let part = if whole {
            let all: Vec<_> = (0..self.system.unknowns()).collect();
            Part::new(&all, &all)
        } else {
            let kernel = &self.plan.kernels[kernel];
            Part::new(kernel.rows(), kernel.columns())
        };
        let mut nearest: Option<(f64, Vec<f64>)> = None;
        for attempt in 0..STARTS {
            let (_, mut work) = self.work();
            part.start(&mut work, estimate, attempt);
            part.minimise_growing(&mut work);
            if whole {
                self.at.copy_pose(&mut self.pose.q);
                if let Some(iterations) = self.close() {
                    return Ok(iterations);
                }
                self.stand_at_pose();
            }
            let (_, mut work) = self.work();
            part.minimise(&mut work, None, |_| 1.0, STEPS_TO_NEAREST);
            let gap = part.equations(&work).0.norm();
            if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
                self.at.copy_pose(&mut self.pose.q);
                nearest = Some((gap, self.pose.q.clone()));
            }
        }
        if let Some((_, q)) = nearest {
            self.pose.q.copy_from_slice(&q);
        }
        self.stand_at_pose();
        Err(self.explain_failure(&part))
    }

    /// Newton–Raphson, kernel by kernel, from where the bodies are. Returns the most corrections
    /// that one needed; `None` leaves the pose as it was.
    fn close(&mut self) -> Option<u32> {
        let (plan, mut work) = self.work();
        let mut iterations = 0;
        for kernel in &mut plan.kernels {
            let correction = kernel.close(&mut work, MAX_ITERATIONS).ok()?;
            iterations = iterations.max(correction.iterations);
        }
        self.at.copy_pose(&mut self.pose.q);
        Some(iterations)
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
    fn estimate(&self) -> Result<Vec<f64>, Error> {
        let parameters = &self.pose.parameters;
        let bodies = &self.system.mechanism().bodies;
        let mut estimate = vec![0.0; self.system.unknowns()];
        for (body, q) in bodies.iter().zip(estimate.chunks_exact_mut(3)) {
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

    fn fix_turns(&mut self) {
        self.system.fix_turns(&self.at, &mut self.targets);
        self.pose.turns.copy_from_slice(&self.targets.turns);
    }

    /// The largest distance of a body from its estimate.
    fn scaled_distance(&self, estimate: &[f64]) -> f64 {
        let bodies = self.system.mechanism().bodies.len();
        self.pose.q[..3 * bodies]
            .iter()
            .zip(estimate)
            .enumerate()
            .map(|(k, (q, e))| (q - e).abs() / self.system.column_scale(k, self.at.size()))
            .fold(0.0, f64::max)
    }

    /// Adds whole turns to the bodies so that each angle is nearest its estimate. Bodies whose
    /// angles a driver ties together turn together, those it ties to ground not at all, nor do
    /// those whose turns a gear counts.
    fn choose_turns(&mut self, estimate: &[f64]) {
        let bodies = self.system.mechanism().bodies.len();
        let ground = bodies;
        // Each body points to a later one that turns with it, the last of them to itself.
        let mut group: Vec<usize> = (0..=bodies).collect();
        let last_of = |group: &mut [usize], mut body: usize| {
            while group[body] != body {
                group[body] = group[group[body]];
                body = group[body];
            }
            body
        };
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
            for body in &mut tied {
                *body = last_of(&mut group, *body);
            }
            let keep = tied.iter().copied().max().unwrap_or(ground);
            for body in tied {
                group[body] = keep;
            }
        }
        let mut turns = vec![None; bodies + 1];
        turns[last_of(&mut group, ground)] = Some(0.0);
        for body in 0..bodies {
            let phi = 3 * body + 2;
            let away = ((estimate[phi] - self.pose.q[phi]) / TAU).round();
            let last = last_of(&mut group, body);
            self.pose.q[phi] += TAU * *turns[last].get_or_insert(away);
        }
        self.stand_at_pose();
        self.fix_turns();
    }

    /// The verdict on a part whose nearest pose, at which the solver stands, leaves gaps.
    fn explain_failure(&mut self, part: &Part) -> Error {
        let (residual, jacobian) = part.equations(&self.work().1);
        // Lengths whose squares overflow leave nothing to look at.
        let beyond_numbers = || Error::NotFinite {
            what: "an equation of the mechanism".to_owned(),
        };
        if !residual
            .iter()
            .chain(jacobian.iter())
            .all(|x| x.is_finite())
        {
            return beyond_numbers();
        }
        if residual.amax() <= CLOSED {
            let singular = jacobian.singular_values();
            return Error::Singular {
                rcond: singular.min() / singular.max(),
            };
        }
        let spread = self.open_joints(part, residual.amax());
        if spread.is_empty() {
            return beyond_numbers();
        }
        // The minimum spreads the gap over all joints of a loop. People look for one joint that
        // does not meet: gather it where it is smallest, in the joint declared last on a tie.
        let mut best: Option<(f64, OpenJoint)> = None;
        for (element, _) in &spread {
            self.stand_at_pose();
            let (_, mut work) = self.work();
            let equations = work.system.equations();
            let weight = |row: usize| {
                if equations[row].element == *element {
                    1.0
                } else {
                    HOLD_CLOSED
                }
            };
            part.minimise(&mut work, None, weight, STEPS_TO_NEAREST);
            let gap = part.equations(&work).0.amax();
            if let [(only, joint)] = &self.open_joints(part, gap)[..]
                && only == element
                && best
                    .as_ref()
                    .is_none_or(|(smallest, _)| gap <= smallest * (1.0 + 1e-3))
            {
                best = Some((gap, joint.clone()));
            }
        }
        self.stand_at_pose();
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
    fn open_joints(&self, part: &Part, largest: f64) -> Vec<(Element, OpenJoint)> {
        let mut open: Vec<(Element, OpenJoint)> = Vec::new();
        for &row in &part.rows {
            let equation = &self.system.equations()[row];
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
