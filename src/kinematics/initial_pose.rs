//! The first pose, from the estimates in the file (Ec. 3.6.9).
//!
//! Kernels are assembled one behind the other, each in the way that is nearest the estimates. One
//! that does not close sends the search back to another way of those it depends on. Where all
//! ways are excluded, by closed forms or by bounds over intervals, the mechanism is proved
//! impossible; else it was just not found to close.

use super::continuation::Progress;
use super::newton::SINGULAR;
use super::solver::{Pose, Solver};
use super::{Error, Path};

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
    /// The largest move of a body from its estimate, in radians and characteristic lengths.
    pub distance: f64,
}

/// How far a body is from its estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Of its origin \[m\].
    pub length: f64,
    /// Of its angle \[rad\].
    pub angle: f64,
}

impl Solver {
    /// Finds the pose at the end of `path` that is near the file's estimates: minimises
    /// (q − q⁰)ᵀ(q − q⁰) + r PhiᵀPhi for growing r (Ec. 3.6.9), then applies Newton–Raphson.
    ///
    /// Angles and lengths are scaled by the mechanism's size. An assembled angle is the
    /// representative nearest its estimate, unless an angle driver says which turn it is.
    ///
    /// # Errors
    ///
    /// [`Error::NotAssembled`] with what stays open, and whether there is a proof that the
    /// mechanism cannot close; [`Error::Singular`] if the mechanism closes
    /// in a singular position; [`Error::NotFinite`] and [`Error::NotPositive`] for values that
    /// make no mechanism. The solver is then without a valid pose until it is assembled or
    /// [restored](Self::restore); after the first of these it stands at the nearest one.
    pub fn assemble(&mut self, path: &Path) -> Result<Assembly, Error> {
        match self.assemble_rows(path, !self.set_aside.is_empty()) {
            // Or redundant in a way that only numbers tell.
            Err(Error::Singular { .. }) => {
                self.choose_rows(path)?;
                self.assemble_rows(path, true)
            }
            assembled => assembled,
        }
    }

    /// Assembles with the rows chosen so far, with an eye on all if some are redundant.
    fn assemble_rows(&mut self, path: &Path, on_all: bool) -> Result<Assembly, Error> {
        let estimate = self.go_to_estimate(path)?;
        let iterations = if on_all {
            self.assemble_on_all(&estimate)?
        } else {
            match self.search(&estimate) {
                Ok(iterations) => iterations,
                Err(deadlock) => self.search_at_once(deadlock, &estimate)?,
            }
        };
        self.choose_turns(&estimate);
        self.refresh()?;
        let rcond = self.plan.rcond();
        if rcond < SINGULAR {
            return Err(Error::Singular {
                rcond,
                bodies: Vec::new(),
            });
        }
        self.settle();
        Ok(Assembly {
            iterations,
            distance: self.distance_from(&estimate),
        })
    }

    /// Takes all values from the end of `path`, and puts the bodies at the estimates, which are
    /// returned.
    pub(super) fn go_to_estimate(&mut self, path: &Path) -> Result<Vec<f64>, Error> {
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
        Ok(estimate)
    }

    /// The largest move of a body from its estimate, in radians and characteristic lengths.
    pub(super) fn distance_from(&self, estimate: &[f64]) -> f64 {
        let size = self.at.size();
        let moves = self.moves_from(estimate);
        let scaled = moves.map(|moved| (moved.length / size).max(moved.angle));
        scaled.fold(0.0, f64::max)
    }

    /// How far each body is from its estimate, where the solver stands.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] for estimates that have no value with the parameters in force.
    pub fn moves(&self) -> Result<Vec<Move>, Error> {
        Ok(self.moves_from(&self.estimate()?).collect())
    }

    fn moves_from<'a>(&'a self, estimate: &'a [f64]) -> impl Iterator<Item = Move> + 'a {
        let bodies = self.system.mechanism().bodies.len();
        let poses = self.pose.q[..3 * bodies].chunks_exact(3);
        let moved = poses.zip(estimate.chunks_exact(3));
        moved.map(|(q, guess)| Move {
            length: (q[0] - guess[0]).hypot(q[1] - guess[1]),
            angle: (q[2] - guess[2]).abs(),
        })
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
    pub(super) fn estimate(&self) -> Result<Vec<f64>, Error> {
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
}
