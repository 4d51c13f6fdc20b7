//! What is said of a mechanism whose kernels do not all close: the pose that comes nearest, what
//! stays open there, and whether there is a proof.

use super::branches::{Effort, Ways};
use super::search::{Deadlock, Nearest};
use crate::kinematics::assembly::least_squares::{
    LARGEST_PART, MAX_ITERATIONS, Part, SMALL_PART, STARTS,
};
use crate::kinematics::block::Kernel;
use crate::kinematics::constraint::Dimension;
use crate::kinematics::{Element, Error, OpenJoint, Proof, Solver, Verdict};

/// Minimisation steps towards the nearest pose of a mechanism that does not close.
const STEPS_TO_NEAREST: usize = 200;
/// A scaled residual below this is no gap that anyone could measure: the mechanism closes, and
/// Newton failed because the position is singular.
const CLOSED: f64 = 1e-7;
/// What has no value where lengths are too large for their squares to be numbers.
const AN_EQUATION: &str = "an equation of the mechanism";
/// How much more than a joint left open all others count when the gap is gathered in it.
const HOLD_CLOSED: f64 = 1e4;

impl Solver {
    /// Assembles a mechanism as a whole, after a kernel did not close behind the others in any way
    /// that was found.
    ///
    /// # Errors
    ///
    /// The verdict.
    pub(in crate::kinematics) fn search_at_once(
        &mut self,
        mut deadlock: Deadlock,
        estimate: &[f64],
    ) -> Result<u32, Error> {
        let rows: Vec<_> = (0..self.system.equations().len()).collect();
        let columns: Vec<_> = (0..self.system.unknowns()).collect();
        let nearest = deadlock.nearest.take();
        if columns.len() > SMALL_PART {
            return match nearest {
                Some(nearest) => Err(self.explain_miss(&deadlock, &nearest, estimate)),
                None => self.search_sparsely(deadlock, &rows, estimate),
            };
        }
        let whole = Part::new(&rows, &columns);
        if !deadlock.proved || nearest.is_none() {
            if let Some(iterations) = self.minimise_from_all(&whole, deadlock.proved, estimate) {
                return Ok(iterations);
            }
            deadlock.starts += STARTS;
        }
        Err(match nearest {
            Some(nearest) => self.explain_miss(&deadlock, &nearest, estimate),
            None => self.explain_failure(&deadlock, &whole),
        })
    }

    /// Minimises a mechanism of any size as a whole and closes it from there.
    ///
    /// # Errors
    ///
    /// The verdict on the nearest pose.
    fn search_sparsely(
        &mut self,
        mut deadlock: Deadlock,
        rows: &[usize],
        estimate: &[f64],
    ) -> Result<u32, Error> {
        let gap = self.close_on(rows, estimate);
        deadlock.starts += 1;
        self.at.copy_pose(&mut self.pose.q);
        if gap.is_none()
            && let Some(iterations) = self.close()
        {
            return Ok(iterations);
        }
        self.stand_at_pose();
        let largest = self.residual();
        if !largest.is_finite() {
            return Err(Error::NotFinite {
                what: AN_EQUATION.to_owned(),
            });
        }
        if !deadlock.proved && largest <= CLOSED {
            return Err(Error::Singular {
                rcond: self.rcond(),
                bodies: Vec::new(),
            });
        }
        let proof = self.proof(&deadlock, deadlock.kernel);
        let open = self.open_joints(rows, largest);
        Err(self.not_assembled(&deadlock, proof, open))
    }

    /// Minimises the whole from all starts and goes to the nearest pose, or closes the mechanism
    /// from one of them, unless that is `proved` not to be. Returns the most corrections that a
    /// kernel needed for that.
    fn minimise_from_all(&mut self, whole: &Part, proved: bool, estimate: &[f64]) -> Option<u32> {
        let mut nearest: Option<(f64, Vec<f64>)> = None;
        for attempt in 0..STARTS {
            let (_, mut work) = self.work();
            whole.start(&mut work, estimate, attempt);
            whole.minimise_growing(&mut work);
            if !proved {
                self.at.copy_pose(&mut self.pose.q);
                if let Some(iterations) = self.close() {
                    return Some(iterations);
                }
                self.stand_at_pose();
            }
            let (_, mut work) = self.work();
            whole.minimise(&mut work, None, |_| 1.0, STEPS_TO_NEAREST);
            let gap = whole.equations(&work).0.norm();
            if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
                self.at.copy_pose(&mut self.pose.q);
                nearest = Some((gap, self.pose.q.clone()));
            }
        }
        if let Some((_, q)) = nearest {
            self.pose.q.copy_from_slice(&q);
        }
        self.stand_at_pose();
        None
    }

    /// Newton–Raphson, kernel by kernel, from where the bodies are. Returns the most corrections
    /// that one needed; `None` leaves the pose as it was.
    pub(in crate::kinematics) fn close(&mut self) -> Option<u32> {
        let (plan, mut work) = self.work();
        let mut iterations = 0;
        for kernel in &mut plan.kernels {
            let correction = kernel.close(&mut work, MAX_ITERATIONS).ok()?;
            iterations = iterations.max(correction.iterations);
        }
        self.at.copy_pose(&mut self.pose.q);
        Some(iterations)
    }

    /// The verdict where a kernel in closed form misses by least: the others behind it close as
    /// well as they can.
    fn explain_miss(&mut self, deadlock: &Deadlock, nearest: &Nearest, estimate: &[f64]) -> Error {
        self.pose.q.copy_from_slice(&nearest.q);
        self.stand_at_pose();
        let proof = self.proof(deadlock, nearest.kernel);
        let (plan, mut work) = self.work();
        for (index, kernel) in plan.kernels.iter_mut().enumerate().skip(nearest.kernel) {
            let mut ways = Ways::new(kernel, &mut work, estimate, Effort::Near);
            if index > nearest.kernel && ways.next(kernel, &mut work, estimate).is_some() {
                continue;
            }
            match kernel {
                Kernel::Pinned(kernel) => kernel.locate(&mut work),
                Kernel::RrrDyad(kernel) => kernel.stretch(&mut work, estimate),
                Kernel::RrpDyad(kernel) => kernel.stretch(&mut work, estimate),
                // None is in force where bodies are at their estimates.
                Kernel::Interpolated(_) => {}
                Kernel::Coupled(kernel) => {
                    let part = Part::new(kernel.rows(), kernel.columns());
                    part.start(&mut work, estimate, 0);
                    if part.unknowns() <= LARGEST_PART {
                        part.minimise(&mut work, None, |_| 1.0, STEPS_TO_NEAREST);
                    }
                }
            }
        }
        self.at.copy_pose(&mut self.pose.q);
        self.stand_at_pose();
        let largest = self.residual();
        if !largest.is_finite() {
            return Error::NotFinite {
                what: AN_EQUATION.to_owned(),
            };
        }
        if !deadlock.proved && largest <= CLOSED {
            let rcond = self.rcond();
            return Error::Singular {
                rcond,
                bodies: Vec::new(),
            };
        }
        let rows: Vec<_> = (0..self.system.equations().len()).collect();
        let open = self.open_joints(&rows, largest);
        self.not_assembled(deadlock, proof, open)
    }

    /// Why a kernel that does not close does not, where those before it are at the pose.
    fn proof(&mut self, deadlock: &Deadlock, kernel: usize) -> Proof {
        let mechanism = std::sync::Arc::clone(self.system.mechanism());
        let name = |body: usize| mechanism.bodies[body].name.clone();
        let (plan, work) = self.work();
        match &plan.kernels[kernel] {
            Kernel::RrrDyad(kernel) => {
                let reach = kernel.reach(&work);
                let mut ends = kernel.ends();
                ends.sort_unstable_by_key(|(body, _)| *body);
                Proof::Reach {
                    bodies: ends.map(|(body, _)| name(body)),
                    points: ends.map(|(_, anchor)| mechanism.marker_path(anchor)),
                    distance: reach.distance,
                    span: [reach.shortest, reach.longest],
                }
            }
            Kernel::RrpDyad(kernel) => Proof::Line {
                body: name(kernel.body()),
            },
            kernel => {
                let mut bodies: Vec<_> = kernel.columns().iter().map(|k| k / 3).collect();
                // What joints bring with them comes behind the bodies.
                bodies.retain(|&body| body < mechanism.bodies.len());
                bodies.sort_unstable();
                bodies.dedup();
                Proof::Excluded {
                    bodies: bodies.into_iter().map(name).collect(),
                    boxes: deadlock.boxes,
                }
            }
        }
    }

    fn not_assembled(
        &self,
        deadlock: &Deadlock,
        proof: Proof,
        open: Vec<(Element, OpenJoint)>,
    ) -> Error {
        let verdict = if deadlock.proved {
            Verdict::Impossible {
                proof: Box::new(proof),
                ways: deadlock.dead_ends,
            }
        } else {
            Verdict::NotFound {
                starts: deadlock.starts,
            }
        };
        Error::NotAssembled {
            verdict,
            open: open.into_iter().map(|(_, joint)| joint).collect(),
            nearest: self.pose.q.clone(),
        }
    }

    /// The verdict on a mechanism whose nearest pose, at which the solver stands, leaves gaps.
    fn explain_failure(&mut self, deadlock: &Deadlock, whole: &Part) -> Error {
        let (residual, jacobian) = whole.equations(&self.work().1);
        // Lengths whose squares overflow leave nothing to look at.
        let beyond_numbers = || Error::NotFinite {
            what: AN_EQUATION.to_owned(),
        };
        let mut numbers = residual.iter().chain(jacobian.iter());
        if !numbers.all(|x| x.is_finite()) {
            return beyond_numbers();
        }
        if !deadlock.proved && residual.amax() <= CLOSED {
            let singular = jacobian.singular_values();
            return Error::Singular {
                rcond: singular.min() / singular.max(),
                bodies: Vec::new(),
            };
        }
        let spread = self.open_joints(&whole.rows, residual.amax());
        if spread.is_empty() {
            return beyond_numbers();
        }
        let proof = self.proof(deadlock, deadlock.kernel);
        let Some((joint, q)) = self.gather(whole, &spread) else {
            return self.not_assembled(deadlock, proof, spread);
        };
        self.pose.q.copy_from_slice(&q);
        self.stand_at_pose();
        self.not_assembled(deadlock, proof, vec![joint])
    }

    /// The minimum spreads the gap over all joints of a loop. People look for one joint that
    /// does not meet: gathers it where it is smallest, in the joint declared last on a tie.
    /// Returns that joint, and q with the others closed.
    fn gather(
        &mut self,
        part: &Part,
        spread: &[(Element, OpenJoint)],
    ) -> Option<((Element, OpenJoint), Vec<f64>)> {
        let mut best: Option<(f64, (Element, OpenJoint), Vec<f64>)> = None;
        for (element, _) in spread {
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
            let largest = part.equations(&work).0.amax();
            if let [joint] = &self.open_joints(&part.rows, largest)[..]
                && joint.0 == *element
                && let gap = (joint.1.gap / self.at.size()).max(joint.1.angle)
                && best
                    .as_ref()
                    .is_none_or(|(smallest, ..)| gap <= smallest * (1.0 + 1e-3))
            {
                let mut q = self.pose.q.clone();
                self.at.copy_pose(&mut q);
                best = Some((gap, joint.clone(), q));
            }
        }
        self.stand_at_pose();
        best.map(|(_, joint, q)| (joint, q))
    }

    /// Joints, constraints and drivers with a noticeable part of the largest scaled residual.
    pub(in crate::kinematics) fn open_joints(
        &self,
        rows: &[usize],
        largest: f64,
    ) -> Vec<(Element, OpenJoint)> {
        let least = 0.01 * largest;
        let mut open: Vec<(Element, OpenJoint)> = Vec::new();
        for &row in rows {
            let equation = &self.system.equations()[row];
            let target = self.system.target(row, &self.targets, &self.pose.drivers);
            let error = (equation.constraint.value(&self.at) - target).abs();
            let (gap, angle) = match equation.constraint.dimension() {
                Dimension::Length => (error, 0.0),
                Dimension::Angle if error > least => (0.0, error),
                Dimension::Angle => continue,
            };
            match open.last_mut() {
                Some((element, joint)) if *element == equation.element => {
                    joint.gap = joint.gap.hypot(gap);
                    joint.angle = joint.angle.max(angle);
                }
                _ => open.push((
                    equation.element,
                    OpenJoint {
                        element: String::new(),
                        gap,
                        angle,
                    },
                )),
            }
        }
        open.retain_mut(|(element, joint)| {
            if joint.gap <= least * self.at.size() {
                joint.gap = 0.0;
            }
            let kept = joint.gap.max(joint.angle) > 0.0;
            if kept {
                joint.element = element.describe(self.system.mechanism());
            }
            kept
        });
        open
    }
}
