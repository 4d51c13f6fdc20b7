//! Assembly modes: all the ways in which a mechanism closes for the same values of its drivers.

use crate::kinematics::assembly::branches::{Effort, Ways};
use crate::kinematics::assembly::least_squares::is_same;
use crate::kinematics::{Error, Solver};

/// The ways in which a mechanism closes besides the one in which it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// Those found, nearest the estimates first.
    pub others: Vec<Mode>,
    /// From how many starts each part was assembled of which not all ways are known, for each way
    /// of the parts before it; zero if there is no such part.
    pub starts: usize,
    /// Whether there are no others: all parts were assembled in every way that closed forms give
    /// them, or bounds over intervals, which leave no other.
    pub complete: bool,
}

/// One way in which a mechanism closes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Generalized coordinates, \[m, m, rad\] for each body, then the joints' own unknowns. Each
    /// angle is the representative nearest its estimate.
    pub q: Vec<f64>,
    /// Scaled reciprocal condition of the Jacobian there.
    pub rcond: f64,
    /// The largest move of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// From so many starts a part is assembled of which not all ways are known.
const STARTS: usize = 60;
/// So many modes are listed at the most: independent parts multiply theirs.
const MOST_MODES: usize = 64;
/// So many times kernels are put in another way at the most.
const MOST_STEPS: usize = 20_000;

impl Solver {
    /// Finds the other ways in which the mechanism closes with the parameters and driver values
    /// of the present pose: goes through both ways of each dyad and slide, through those of other
    /// parts of few angles that bounds over intervals find, which are all there are, and through
    /// those that minimisation finds for the rest from several starts, which are always the same.
    /// The solver stays where it is.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
    pub fn modes(&mut self) -> Result<Modes, Error> {
        let estimate = self.estimate()?;
        let home = self.pose().clone();
        self.release_crossings();
        let mut modes = Modes {
            others: Vec::new(),
            starts: 0,
            complete: true,
        };
        for q in self.close_in_all_ways(&estimate, &mut modes) {
            self.pose.q.copy_from_slice(&q);
            self.choose_turns(&estimate);
            if self.opened().is_some() {
                continue;
            }
            let known = std::iter::once(&home.q).chain(modes.others.iter().map(|mode| &mode.q));
            if known.into_iter().any(|known| self.is_at(known)) {
                continue;
            }
            modes.others.push(Mode {
                rcond: self.rcond(),
                distance: self.distance_from(&estimate),
                q: self.pose.q.clone(),
            });
        }
        let others = &mut modes.others;
        others.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        self.restore(&home);
        Ok(modes)
    }

    /// q of each mode; notes in `modes` how they were looked for.
    fn close_in_all_ways(&mut self, estimate: &[f64], modes: &mut Modes) -> Vec<Vec<f64>> {
        let unknowns = self.system.unknowns();
        let (plan, mut work) = self.work();
        let kernels = &mut plan.kernels;
        let mut levels: Vec<Ways> = Vec::with_capacity(kernels.len());
        let mut poses = Vec::new();
        let most_steps = MOST_STEPS + 2 * kernels.len();
        for _ in 0..most_steps {
            // Forward while kernels close, back to the last one that has another way.
            if let Some(kernel) = kernels.get(levels.len()) {
                let effort = Effort::Anywhere(STARTS);
                levels.push(Ways::new(kernel, &mut work, estimate, effort));
            } else {
                let mut q = vec![0.0; unknowns];
                work.at.copy_pose(&mut q);
                poses.push(q);
                if poses.len() >= MOST_MODES {
                    break;
                }
            }
            while let Some((ways, kernel)) = levels.len().checked_sub(1).and_then(|last| {
                let ways = levels.get_mut(last)?;
                Some((ways, &mut kernels[last]))
            }) {
                if ways.next(kernel, &mut work, estimate).is_some() {
                    break;
                }
                if !ways.is_complete() {
                    modes.complete = false;
                    modes.starts = modes.starts.max(ways.starts);
                }
                levels.pop();
            }
            if levels.is_empty() {
                return poses;
            }
        }
        modes.complete = false;
        poses
    }

    /// Whether the pose is the same as another, whole turns of the angles apart.
    fn is_at(&self, other: &[f64]) -> bool {
        let size = self.at.size();
        let mut pairs = self.pose.q.iter().zip(other).enumerate();
        pairs.all(|(column, (&a, &b))| is_same(&self.system, size, column, a, b))
    }
}
