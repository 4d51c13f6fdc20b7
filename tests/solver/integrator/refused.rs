//! Trials that fail, and states and options that are refused.

use biela::dynamics::integrator::{
    Error, ErrorControl, Failure, Integrator, Invalid, Method, Reason, State, Statistics, System,
};

use super::{METHODS, Smooth, error, integrator, pendulum, pendulum_at, run};

/// Returns the first error on the way to 5 s.
fn first_error<S: System>(integrator: &mut Integrator, system: &mut S) -> Error<S::Cause> {
    loop {
        if let Err(error) = integrator.advance(system, 5.0) {
            return error;
        }
    }
}

/// A pendulum that cannot be evaluated beyond a wall, or refuses the first two trials of every
/// tenth step.
struct Failing {
    wall: f64,
    refusing: bool,
    hard: bool,
    calls: u32,
}

impl System for Failing {
    type Cause = &'static str;

    fn derivatives(
        &mut self,
        t: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<&'static str>> {
        if x[0] > self.wall {
            let cause = "beyond the wall";
            return Err(if self.hard {
                Failure::Hard(cause)
            } else {
                Failure::Trial(cause)
            });
        }
        pendulum()
            .derivatives(t, x, dx)
            .map_err(|_| Failure::Hard("not finite"))
    }

    fn accept(&mut self, _: f64, _: &[f64], _: &[f64]) -> Result<(), Failure<&'static str>> {
        self.calls += 1;
        if self.refusing && self.calls % 12 < 2 {
            Err(Failure::Trial("not certified"))
        } else {
            Ok(())
        }
    }
}

#[test]
fn a_wall_stops_with_the_cause_after_a_finite_number_of_trials() {
    for method in METHODS {
        let mut system = Failing {
            wall: 1.0,
            refusing: false,
            hard: false,
            calls: 0,
        };
        let mut swing = integrator(method, 1e-8, 0.0, &pendulum_at(0.0, 2.0));
        let error = first_error(&mut swing, &mut system);
        let Error::Stuck { t, h, reason, .. } = error else {
            panic!("{error}");
        };
        assert_eq!(reason, Reason::Failed("beyond the wall"));
        // The default Jacobian of the stiff method looks ahead by 1.5e-8 of the angle.
        let gap = 1.0 - swing.state().x[0];
        assert!(
            (0.0..3e-8).contains(&gap) && h < 1e-9 && t > 0.1,
            "{gap:e}, {h:e}"
        );
        assert!(swing.state().statistics.failed < 300);
        system.hard = true;
        let error = first_error(&mut swing, &mut system);
        assert!(matches!(
            error,
            Error::Stopped {
                cause: "beyond the wall",
                ..
            }
        ));
    }
}

#[test]
fn refused_steps_become_shorter_and_keep_the_accuracy() {
    for method in METHODS {
        let mut system = Failing {
            wall: f64::INFINITY,
            refusing: true,
            hard: false,
            calls: 0,
        };
        let mut swing = integrator(method, 1e-7, 0.0, &pendulum_at(0.0, 2.0));
        run(&mut swing, &mut system, 1.0);
        assert!(error(&swing.state().x, &pendulum_at(1.0, 2.0)) < 1e-7);
        let Statistics {
            accepted, failed, ..
        } = swing.state().statistics;
        assert_eq!(accepted + failed, u64::from(system.calls));
        assert!(failed > 1);
    }
}

#[test]
fn derivatives_that_are_not_finite_are_failed_trials() {
    for value in [f64::NAN, f64::INFINITY] {
        for method in METHODS {
            let mut system = Smooth(|t: f64, _: &[f64], dx: &mut [f64]| {
                dx[0] = if t > 1.0 { value } else { 1.0 };
            });
            let mut integrator = integrator(method, 1e-6, 0.0, &[0.0]);
            let error = first_error(&mut integrator, &mut system);
            assert!(matches!(
                error,
                Error::Stuck {
                    reason: Reason::NotFinite,
                    ..
                }
            ));
            // The default Jacobian looks a little ahead in time.
            assert!(
                (integrator.state().t - 1.0).abs() < 1e-7,
                "{}",
                integrator.state().t
            );
        }
    }
}

#[test]
fn impossible_states_are_refused() {
    let mut integrator = integrator(Method::Automatic, 1e-6, 0.0, &[1.0, 2.0]);
    let good = integrator.state().clone();
    let refuse = |integrator: &mut Integrator, change: &dyn Fn(&mut State), why: Invalid| {
        let mut state = good.clone();
        change(&mut state);
        assert_eq!(integrator.restore(&state), Err(why));
        assert_eq!(integrator.state(), &good);
    };
    refuse(
        &mut integrator,
        &|state| state.t = f64::NAN,
        Invalid::Number,
    );
    refuse(&mut integrator, &|state| state.h = -1.0, Invalid::Number);
    refuse(
        &mut integrator,
        &|state| state.stiffness.patience = 0,
        Invalid::Number,
    );
    let length = Invalid::Length {
        given: 3,
        expected: 2,
    };
    refuse(&mut integrator, &|state| state.x.push(0.0), length);
    assert_eq!(integrator.restart_at(0.0, &[1.0; 3]), Err(length));
    assert_eq!(
        integrator.restart_at(0.0, &[f64::NAN; 2]),
        Err(Invalid::Number)
    );
    assert!(integrator.advance(&mut pendulum(), f64::NAN).is_err());
    assert!(matches!(
        integrator.dense_output(&mut pendulum()),
        Err(Error::NoStep)
    ));
    for tolerance in [0.0, -1.0, 1.0, f64::NAN] {
        assert!(ErrorControl::new(tolerance, vec![1.0]).is_err());
    }
    for scale in [0.0, -1.0, f64::NAN] {
        assert!(ErrorControl::new(1e-6, vec![scale]).is_err());
    }
}
