//! The integrator.

use super::control::ErrorControl;
use super::dense::DenseOutput;
use super::dormand_prince::{self, DormandPrince};
use super::error::{Error, Invalid, Reason, Refusal};
use super::first_step::Start;
use super::rosenbrock::{self, Rosenbrock};
use super::state::{LEAST_MEMORY, State};
use super::step_length::{self, fitted};
use super::system::{System, Trial, evaluate};

/// Ratio of a probing step of the stiff method to the step of the explicit one. The stiff method
/// needs a Jacobian and a factorisation in each step.
const PROBE: f64 = 3.0;

/// The choice of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The explicit method, the stiff one while the equations are found to be stiff.
    #[default]
    Automatic,
    /// Dormand and Prince 8(5,3).
    Explicit,
    /// Rodas5P.
    Stiff,
}

/// An accepted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time of its start \[s\].
    pub start: f64,
    /// Time of its end \[s\].
    pub end: f64,
}

/// Integrates a [`System`] one accepted step at a time, forwards or backwards in time. It
/// allocates nothing after construction, apart from the default of [`System::jacobian`].
///
/// ```
/// use biela::dynamics::integrator::{ErrorControl, Failure, Integrator, Method, System};
///
/// struct Decay;
///
/// impl System for Decay {
///     type Cause = &'static str;
///
///     fn derivatives(&mut self, _: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failure<Self::Cause>> {
///         dx[0] = -x[0];
///         Ok(())
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let control = ErrorControl::new(1e-8, vec![1.0])?;
/// let mut integrator = Integrator::new(Method::Automatic, control, 0.0, vec![1.0])?;
/// while integrator.state().t < 2.0 {
///     integrator.advance(&mut Decay, 2.0)?;
/// }
/// assert!((integrator.state().x[0] - (-2.0_f64).exp()).abs() < 1e-8);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Integrator {
    method: Method,
    control: ErrorControl,
    state: State,
    /// The solution and its derivative at the end of a trial step.
    end: [Vec<f64>; 2],
    explicit: DormandPrince,
    stiff: Rosenbrock,
    dense: DenseOutput,
    /// Whether the stiff method made the last step; none before a step.
    last_stiff: Option<bool>,
}

impl Integrator {
    /// Makes an integrator at x(t), whose first step is chosen by the equations.
    ///
    /// # Errors
    ///
    /// [`Invalid::Length`] if `x` has not one component per scale, [`Invalid::Number`] if a number
    /// is not finite.
    pub fn new(
        method: Method,
        control: ErrorControl,
        t: f64,
        x: Vec<f64>,
    ) -> Result<Self, Invalid> {
        let order = control.order();
        let state = State::new(t, x);
        state.check(order)?;
        Ok(Self {
            method,
            control,
            state,
            end: [vec![0.0; order], vec![0.0; order]],
            explicit: DormandPrince::new(order),
            stiff: Rosenbrock::new(order),
            dense: DenseOutput::new(order),
            last_stiff: None,
        })
    }

    /// Returns the state at the end of the last accepted step.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Replaces tolerance and scales.
    ///
    /// # Errors
    ///
    /// [`Invalid::Length`] for another number of components; nothing is changed then.
    pub fn set_control(&mut self, control: ErrorControl) -> Result<(), Invalid> {
        let [given, expected] = [control.order(), self.control.order()];
        if given != expected {
            return Err(Invalid::Length { given, expected });
        }
        self.control = control;
        Ok(())
    }

    /// Replaces the state by one of an integrator with the same options.
    ///
    /// # Errors
    ///
    /// Those of [`State::check`]; the state is then unchanged.
    pub fn restore(&mut self, state: &State) -> Result<(), Invalid> {
        state.check(self.control.order())?;
        self.state.copy_from(state);
        self.stiff.forget();
        self.last_stiff = None;
        Ok(())
    }

    /// Goes on from another point: after an event, or in other coordinates. The proposed step and
    /// the method stay.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); the state is then unchanged.
    pub fn restart_at(&mut self, t: f64, x: &[f64]) -> Result<(), Invalid> {
        if x.len() != self.control.order() {
            return Err(Invalid::Length {
                given: x.len(),
                expected: self.control.order(),
            });
        }
        if !(t.is_finite() && x.iter().all(|x| x.is_finite())) {
            return Err(Invalid::Number);
        }
        self.state.t = t;
        self.state.x.copy_from_slice(x);
        self.renew();
        Ok(())
    }

    /// Takes note that the right-hand side has changed at the present point: an input has jumped.
    /// The proposed step and the method stay.
    pub fn renew(&mut self) {
        self.state.has_derivative = false;
        self.state.memory = LEAST_MEMORY;
        self.stiff.forget();
    }

    /// Makes one accepted step that ends at or before `until`, and at `until` to the bit if it is
    /// near. Makes none if the time is `until` already.
    ///
    /// A step that `until` makes shorter leaves the proposed step as it was, so that many calls
    /// with near times cost no accuracy and no search for the step.
    ///
    /// # Errors
    ///
    /// [`Error`]; the state is then that of the last accepted step, and the proposed step short.
    pub fn advance<S: System>(
        &mut self,
        system: &mut S,
        until: f64,
    ) -> Result<Step, Error<S::Cause>> {
        let start = self.state.t;
        let gap = until - start;
        if !gap.is_finite() {
            return Err(Error::Until { until });
        }
        if gap == 0.0 {
            return Ok(Step { start, end: start });
        }
        self.last_stiff = None;
        self.prepare(system, gap)
            .map_err(|refusal| refusal.at(start))?;
        let mut trials = 0;
        let (mut until, mut gap) = (until, gap);
        loop {
            let length = fitted(&self.state, gap.abs());
            let end = if length < gap.abs() {
                start + gap.signum() * length
            } else {
                until
            };
            let refusal = match self.attempt(system, end) {
                Ok(error) => {
                    self.commit(end, length, error, trials > 0);
                    return Ok(Step { start, end });
                }
                Err(Refusal::Cut(time)) => {
                    (until, gap) = (time, time - start);
                    continue;
                }
                Err(refusal) => refusal,
            };
            trials += 1;
            let order = self.order();
            step_length::shorten(&mut self.state, length, order, refusal, trials)?;
        }
    }

    /// Returns the solution in the last accepted step, of order 7 after three more evaluations, or
    /// of order 4 without any in a stiff step. The evaluations are trials behind the accepted
    /// point. Valid until the next call of [`advance`](Self::advance).
    ///
    /// # Errors
    ///
    /// [`Error::NoStep`] before a step, after a failed one and after
    /// [`restore`](Self::restore); [`Error::NoDerivatives`] or [`Error::Stopped`] if the system
    /// fails.
    pub fn dense_output<S: System>(
        &mut self,
        system: &mut S,
    ) -> Result<&DenseOutput, Error<S::Cause>> {
        let Self { dense, state, .. } = self;
        if self.last_stiff.ok_or(Error::NoStep)? {
            self.stiff.interpolate(dense);
        } else {
            self.explicit
                .interpolate(system, dense, &self.end[1], &mut state.statistics)
                .map_err(|refusal| refusal.at(state.t))?;
        }
        Ok(dense)
    }

    /// Evaluates the derivative at the start if it is not known, chooses a first step and the
    /// method.
    fn prepare<S: System>(&mut self, system: &mut S, gap: f64) -> Result<(), Refusal<S::Cause>> {
        let order = self.order();
        let state = &mut self.state;
        let (t, x, dx, statistics) = (state.t, &state.x, &mut state.dx, &mut state.statistics);
        if !state.has_derivative {
            evaluate(system, t, x, dx, statistics)?;
            state.has_derivative = true;
        }
        if state.h == 0.0 {
            let from = Start { t, x, dx, gap };
            state.h = from.step(system, &self.control, order, &mut self.end, statistics)?;
        }
        if self.method == Method::Automatic && self.state.stiffness.is_due() {
            self.choose_method(system, gap)?;
        }
        Ok(())
    }

    /// Changes the method if the other is better: from the stiff to the explicit one at once, to
    /// the stiff one if it passes a step that is [`PROBE`] times as long.
    fn choose_method<S: System>(
        &mut self,
        system: &mut S,
        gap: f64,
    ) -> Result<(), Refusal<S::Cause>> {
        let state = &mut self.state;
        let length = PROBE * state.h;
        if !state.stiffness.stiff {
            if length > gap.abs() {
                return Ok(());
            }
            let (trial, statistics) = (
                Trial {
                    start: state.t,
                    end: state.t + gap.signum() * length,
                    x: &state.x,
                    dx: &state.dx,
                },
                &mut state.statistics,
            );
            let [end, _] = &mut self.end;
            let passed = match self
                .stiff
                .step(system, &trial, &self.control, end, statistics)
            {
                Err(Refusal::Retry(_)) => false,
                error => error? <= 1.0,
            };
            if !passed {
                state.stiffness.conclude(false);
                return Ok(());
            }
            state.h = length;
        }
        state.stiffness.conclude(true);
        state.memory = LEAST_MEMORY;
        Ok(())
    }

    /// Returns whether the stiff method makes the next step.
    fn is_stiff(&self) -> bool {
        match self.method {
            Method::Automatic => self.state.stiffness.stiff,
            Method::Explicit => false,
            Method::Stiff => true,
        }
    }

    /// Returns the order of the method of the next step.
    fn order(&self) -> f64 {
        if self.is_stiff() {
            rosenbrock::ORDER
        } else {
            dormand_prince::ORDER
        }
    }

    /// Tries a step and returns the norm of its error, at most 1.
    fn attempt<S: System>(&mut self, system: &mut S, end: f64) -> Result<f64, Refusal<S::Cause>> {
        let is_stiff = self.is_stiff();
        let (control, [x, dx]) = (&self.control, &mut self.end);
        let statistics = &mut self.state.statistics;
        let trial = Trial {
            start: self.state.t,
            end,
            x: &self.state.x,
            dx: &self.state.dx,
        };
        let error = if is_stiff {
            self.stiff.step(system, &trial, control, x, statistics)?
        } else {
            self.explicit.step(system, &trial, control, x, statistics)?
        };
        if !error.is_finite() {
            return Err(Refusal::Retry(Reason::NotFinite));
        }
        if error > 1.0 {
            return Err(Refusal::Retry(Reason::Inaccurate(error)));
        }
        system.project(end, x)?;
        evaluate(system, end, x, dx, statistics)?;
        system.accept(end, x, dx)?;
        Ok(error)
    }

    /// Makes the end of an accepted step the present state and proposes the next step.
    fn commit(&mut self, end: f64, length: f64, error: f64, shortened: bool) {
        let (order, is_stiff) = (self.order(), self.is_stiff());
        let [x, dx] = &self.end;
        let state = &mut self.state;
        self.dense.set_ends([state.t, end], [&state.x, x]);
        step_length::lengthen(state, length, order, error, shortened);
        state.t = end;
        state.x.copy_from_slice(x);
        state.dx.copy_from_slice(dx);
        state.statistics.accepted += 1;
        self.last_stiff = Some(is_stiff);
        self.detect_stiffness(length);
        self.stiff.forget();
    }

    /// Counts the step in the stiffness detection.
    fn detect_stiffness(&mut self, length: f64) {
        if self.method != Method::Automatic {
            return;
        }
        let [x, dx] = &self.end;
        let constant = if self.is_stiff() {
            self.stiff.spectral_radius(&self.control, x)
        } else {
            self.explicit.lipschitz(&self.control, [x, dx])
        };
        self.state.stiffness.count(length * constant);
    }
}
