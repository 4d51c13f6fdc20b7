//! The mechanism as the integrator sees it: a system of differential equations on trial steps.

use nalgebra::DMatrix;

use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::integrator::{Failure, System};
use super::watch::Verdict;
use crate::kinematics::Solver;

/// A mechanism on a trial step.
pub(super) struct Trials<'a, G> {
    pub(super) solver: &'a mut Solver,
    pub(super) equations: &'a mut Equations,
    pub(super) given: &'a G,
    /// Relative tolerance of the motion.
    pub(super) tolerance: f64,
    /// Whether the step is one of the stiff method, the only one that asks for a Jacobian.
    pub(super) is_stiff: bool,
}

impl<G: Given> System for Trials<'_, G> {
    type Cause = Error;

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failure<Error>> {
        let Self {
            solver,
            equations,
            given,
            ..
        } = self;
        equations.set_drivers(solver, *given, t, x);
        equations.go(solver, t, None).map_err(refused)?;
        let written = equations.write(solver, dx);
        if written.is_ok() {
            equations.note(t);
        }
        let written = written.and_then(|()| equations.vary(solver, x, dx));
        written.map_err(refused)
    }

    fn jacobian(
        &mut self,
        t: f64,
        x: &[f64],
        _: &[f64],
        jacobian: &mut DMatrix<f64>,
        dx_dt: &mut [f64],
    ) -> Result<(), Failure<Error>> {
        let Self {
            solver,
            equations,
            given,
            ..
        } = self;
        self.is_stiff = true;
        let differentiated = equations.differentiate(solver, *given, (t, x), jacobian, dx_dt);
        differentiated.map_err(refused)
    }

    fn project(&mut self, t: f64, x: &mut [f64]) -> Result<(), Failure<Error>> {
        let projected = self.equations.project(self.solver, self.given, t, x);
        projected.map_err(refused)
    }

    fn accept(&mut self, _: f64, _: &[f64], _: &[f64]) -> Result<(), Failure<Error>> {
        match self.equations.judge(self.solver) {
            Verdict::Lasts => {}
            Verdict::Ends(time) => return Err(Failure::Cut(time)),
            Verdict::Unclear => return Err(Failure::Unclear),
        }
        let balances = self
            .equations
            .balance(self.solver, self.tolerance, self.is_stiff);
        balances.map_err(Failure::Trial)?;
        let proved = self.equations.prove(self.solver, self.given);
        let closes = proved.map_err(|error| match error {
            // The time of a stop is known: no shorter steps have to find it.
            Error::Stop { .. } => Failure::Hard(error),
            _ => refused(error),
        })?;
        if let Some(time) = closes {
            return Err(Failure::Cut(time));
        }
        self.equations.accept(self.solver);
        Ok(())
    }
}

/// Returns the failure of a trial.
fn refused(error: Error) -> Failure<Error> {
    match error {
        // No shorter step finds a mass, or what is spent.
        Error::NoInertia { .. } | Error::Spent { .. } => Failure::Hard(error),
        _ => Failure::Trial(error),
    }
}
