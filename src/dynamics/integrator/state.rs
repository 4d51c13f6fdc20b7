//! The numbers on which further steps depend.

use super::error::Invalid;
use super::stiffness::Stiffness;

/// Smallest error that the step control remembers, as in `dop853.f`.
pub(super) const LEAST_MEMORY: f64 = 1e-4;

/// Counts of work since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub accepted: u64,
    /// Trial steps with too large an error.
    pub rejected: u64,
    /// Trial steps at which the system failed, or the result was not finite.
    pub failed: u64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
    /// Factorisations of a matrix.
    pub factorisations: u64,
}

/// All numbers on which further steps depend: an integrator with the same options that is given
/// them goes on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time \[s\].
    pub t: f64,
    /// The solution x(t).
    pub x: Vec<f64>,
    /// The derivative f(t, x), if [`has_derivative`](Self::has_derivative).
    pub dx: Vec<f64>,
    /// Whether `dx` belongs to t and x.
    pub has_derivative: bool,
    /// Time of the start \[s\].
    pub origin: f64,
    /// Proposed length of the next step \[s\], not negative; 0 before the first.
    pub h: f64,
    /// Error estimate of the last step of full length, at least 1e-4.
    pub memory: f64,
    /// Counters of the stiffness detection.
    pub stiffness: Stiffness,
    /// Counts of work.
    pub statistics: Statistics,
}

impl State {
    /// Makes the state at a start.
    pub(super) fn new(t: f64, x: Vec<f64>) -> Self {
        Self {
            t,
            dx: vec![0.0; x.len()],
            x,
            has_derivative: false,
            origin: t,
            h: 0.0,
            memory: LEAST_MEMORY,
            stiffness: Stiffness::default(),
            statistics: Statistics::default(),
        }
    }

    /// Copies another state. Allocates nothing if both have the same size.
    pub fn copy_from(&mut self, other: &Self) {
        let Self { x, dx, .. } = self;
        let (mut x, mut dx) = (std::mem::take(x), std::mem::take(dx));
        x.clone_from(&other.x);
        dx.clone_from(&other.dx);
        *self = Self { x, dx, ..*other };
    }

    /// Visits all numbers as 64-bit words, in the same order for every state of the same size: a
    /// writer copies each word, a reader replaces it. The number of components is not among them.
    ///
    /// # Errors
    ///
    /// The first error of `word`.
    pub fn visit<E>(&mut self, mut word: impl FnMut(&mut u64) -> Result<(), E>) -> Result<(), E> {
        let reals = [&mut self.t, &mut self.origin, &mut self.h, &mut self.memory];
        for real in reals.into_iter().chain(&mut self.x).chain(&mut self.dx) {
            let mut bits = real.to_bits();
            word(&mut bits)?;
            *real = f64::from_bits(bits);
        }
        for flag in [&mut self.has_derivative, &mut self.stiffness.stiff] {
            let mut bits = u64::from(*flag);
            word(&mut bits)?;
            *flag = bits != 0;
        }
        let (stiffness, counts) = (&mut self.stiffness, &mut self.statistics);
        [
            &mut stiffness.against,
            &mut stiffness.agreeing,
            &mut stiffness.patience,
            &mut counts.accepted,
            &mut counts.rejected,
            &mut counts.failed,
            &mut counts.evaluations,
            &mut counts.jacobians,
            &mut counts.factorisations,
        ]
        .into_iter()
        .try_for_each(word)
    }

    /// Checks a state for an integrator of this `order`.
    ///
    /// # Errors
    ///
    /// [`Invalid::Length`], [`Invalid::Number`].
    pub fn check(&self, order: usize) -> Result<(), Invalid> {
        let given = self.x.len();
        if given != order || self.dx.len() != order {
            return Err(Invalid::Length {
                given,
                expected: order,
            });
        }
        let reals = [self.t, self.origin, self.h, self.memory];
        let mut reals = reals.iter().chain(&self.x).chain(&self.dx);
        if reals.any(|real| !real.is_finite())
            || self.h < 0.0
            || self.memory < LEAST_MEMORY
            || !self.stiffness.is_possible()
        {
            return Err(Invalid::Number);
        }
        Ok(())
    }
}
