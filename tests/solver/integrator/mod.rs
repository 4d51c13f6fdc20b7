//! The integrator against closed forms and published solutions.

mod refused;

use std::convert::Infallible;
use std::f64::consts::TAU;

use biela::dynamics::integrator::{
    ErrorControl, Failure, Integrator, Method, State, Statistics, System,
};

/// A right-hand side that cannot fail.
struct Smooth<F>(F);

impl<F: FnMut(f64, &[f64], &mut [f64])> System for Smooth<F> {
    type Cause = Infallible;

    fn derivatives(
        &mut self,
        t: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<Infallible>> {
        (self.0)(t, x, dx);
        Ok(())
    }
}

const METHODS: [Method; 3] = [Method::Automatic, Method::Explicit, Method::Stiff];

fn integrator(method: Method, tolerance: f64, t: f64, x: &[f64]) -> Integrator {
    scaled(method, tolerance, vec![1.0; x.len()], t, x)
}

fn scaled(method: Method, tolerance: f64, scales: Vec<f64>, t: f64, x: &[f64]) -> Integrator {
    let control = ErrorControl::new(tolerance, scales).expect("valid options");
    Integrator::new(method, control, t, x.to_vec()).expect("a valid start")
}

fn run<S: System>(integrator: &mut Integrator, system: &mut S, until: f64) {
    while integrator.state().t.to_bits() != until.to_bits() {
        integrator.advance(system, until).expect("a step");
    }
}

/// Largest error relative to 1 + |x|.
fn error(x: &[f64], exact: &[f64]) -> f64 {
    let errors = x
        .iter()
        .zip(exact)
        .map(|(x, exact)| (x - exact).abs() / (1.0 + exact.abs()));
    errors.fold(0.0, f64::max)
}

/// Jacobi's elliptic functions sn, cn, dn by the arithmetic-geometric mean (Abramowitz, Stegun,
/// 16.4).
fn jacobi(u: f64, k: f64) -> [f64; 3] {
    let mut means = vec![(1.0, k)];
    let mut b = (1.0 - k * k).sqrt();
    while let Some(&(a, c)) = means.last()
        && c > 1e-16
    {
        means.push((0.5 * (a + b), 0.5 * (a - b)));
        b = (a * b).sqrt();
    }
    let steps = means.len() - 1;
    let mut phi = 2.0_f64.powi(steps as i32) * means[steps].0 * u;
    let mut later = phi;
    for (a, c) in means[1..].iter().rev() {
        later = phi;
        phi = 0.5 * (phi + (c * phi.sin() / a).asin());
    }
    [phi.sin(), phi.cos(), phi.cos() / (later - phi).cos()]
}

const GRAVITY: f64 = 9.81;

fn pendulum() -> Smooth<impl FnMut(f64, &[f64], &mut [f64])> {
    Smooth(|_, x: &[f64], dx: &mut [f64]| {
        dx[0] = x[1];
        dx[1] = -GRAVITY * x[0].sin();
    })
}

/// Angle and rate of a pendulum of 1 m that starts in its lowest position and turns back at
/// `amplitude`: sin(φ/2) = k sn(ω t).
fn pendulum_at(t: f64, amplitude: f64) -> [f64; 2] {
    let (omega, k) = (GRAVITY.sqrt(), (0.5 * amplitude).sin());
    let [sn, cn, _] = jacobi(omega * t, k);
    [2.0 * (k * sn).asin(), 2.0 * k * omega * cn]
}

fn kepler() -> Smooth<impl FnMut(f64, &[f64], &mut [f64])> {
    Smooth(|_, x: &[f64], dx: &mut [f64]| {
        let cube = x[0].hypot(x[1]).powi(3);
        dx.copy_from_slice(&[x[2], x[3], -x[0] / cube, -x[1] / cube]);
    })
}

/// Position and velocity on an orbit of semi-major axis 1 with this eccentricity, by Kepler's
/// equation.
fn kepler_at(t: f64, e: f64) -> [f64; 4] {
    let mut anomaly = t;
    for _ in 0..60 {
        anomaly -= (anomaly - e * anomaly.sin() - t) / (1.0 - e * anomaly.cos());
    }
    let (sin, cos) = anomaly.sin_cos();
    let (minor, rate) = ((1.0 - e * e).sqrt(), 1.0 / (1.0 - e * cos));
    [cos - e, minor * sin, -sin * rate, minor * cos * rate]
}

/// Oscillator of 5 rad/s with damping, driven so that x = cos 3t + e^(−0.15 t) sin 5t.
fn driven() -> Smooth<impl FnMut(f64, &[f64], &mut [f64])> {
    Smooth(|t: f64, x: &[f64], dx: &mut [f64]| {
        let (sin, cos) = (3.0 * t).sin_cos();
        dx[0] = x[1];
        dx[1] = -(25.0 + 0.0225) * x[0] - 0.3 * x[1] + (25.0225 - 9.0) * cos - 0.9 * sin;
    })
}

fn driven_at(t: f64) -> [f64; 2] {
    let ((sin, cos), decay) = ((5.0 * t).sin_cos(), (-0.15 * t).exp());
    [
        (3.0 * t).cos() + decay * sin,
        -3.0 * (3.0 * t).sin() + decay * (5.0 * cos - 0.15 * sin),
    ]
}

/// x = 1 / (2 + sin t), y = e^(sin t): depends on time and on products.
fn products() -> Smooth<impl FnMut(f64, &[f64], &mut [f64])> {
    Smooth(|t: f64, x: &[f64], dx: &mut [f64]| {
        dx[0] = -t.cos() * x[0] * x[0];
        dx[1] = t.cos() * x[1] * x[0] * (2.0 + t.sin());
    })
}

fn products_at(t: f64) -> [f64; 2] {
    [1.0 / (2.0 + t.sin()), t.sin().exp()]
}

/// The accuracy that `STEP_TOLERANCE_RATIO` is chosen for.
#[test]
fn errors_after_ten_seconds_are_near_the_tolerance() {
    for tolerance in [1e-6, 1e-8, 1e-10] {
        for method in METHODS {
            let mut swing = integrator(method, tolerance, 0.0, &pendulum_at(0.0, 2.9));
            run(&mut swing, &mut pendulum(), 10.0);
            let swing = error(&swing.state().x, &pendulum_at(10.0, 2.9));
            let mut orbit = integrator(method, tolerance, 0.0, &kepler_at(0.0, 0.6));
            run(&mut orbit, &mut kepler(), 10.0);
            let orbit = error(&orbit.state().x, &kepler_at(10.0, 0.6));
            let mut forced = integrator(method, tolerance, 0.0, &driven_at(0.0));
            run(&mut forced, &mut driven(), 10.0);
            let forced = error(&forced.state().x, &driven_at(10.0));
            for error in [swing, orbit, forced] {
                assert!(
                    error < 10.0 * tolerance,
                    "{method:?}, {tolerance:e}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn a_pendulum_follows_elliptic_functions() {
    for amplitude in [0.1, 1.5, 3.0, 3.1] {
        let mut swing = integrator(Method::Automatic, 1e-10, 0.0, &pendulum_at(0.0, amplitude));
        for t in [0.3, 1.0, 2.0, 4.0] {
            run(&mut swing, &mut pendulum(), t);
            let error = error(&swing.state().x, &pendulum_at(t, amplitude));
            assert!(error < 1e-10, "{amplitude}, {t}: {error:e}");
        }
        assert!(!swing.state().stiffness.stiff);
    }
}

#[test]
fn energy_of_an_orbit_is_conserved_over_many_turns() {
    let mut orbit = integrator(Method::Explicit, 1e-9, 0.0, &kepler_at(0.0, 0.5));
    for turn in 1..=50 {
        run(&mut orbit, &mut kepler(), f64::from(turn) * TAU);
        let x = &orbit.state().x;
        let energy = 0.5 * (x[2] * x[2] + x[3] * x[3]) - 1.0 / x[0].hypot(x[1]);
        assert!((energy + 0.5).abs() < 1e-9);
    }
}

/// Errors at the end and inside of steps of one length, which is enforced by large scales.
fn fixed_step_errors(method: Method, steps: u32) -> [f64; 2] {
    let mut integrator = scaled(method, 0.5, vec![1e9; 2], 0.0, &products_at(0.0));
    integrator.advance(&mut products(), 1e-6).expect("a step");
    integrator
        .restart_at(0.0, &products_at(0.0))
        .expect("a step");
    let (mut inside, mut x) = (0.0_f64, [0.0; 2]);
    let mut system = products();
    for step in 1..=steps {
        let until = 2.0 * f64::from(step) / f64::from(steps);
        while integrator.state().t < until {
            let step = integrator.advance(&mut system, until).expect("a step");
            let t = step.start + 0.3 * (step.end - step.start);
            integrator
                .dense_output(&mut system)
                .expect("a step")
                .interpolate(t, &mut x);
            inside = inside.max(error(&x, &products_at(t)));
        }
    }
    assert_eq!(integrator.state().statistics.rejected, 0);
    [error(&integrator.state().x, &products_at(2.0)), inside]
}

#[test]
fn errors_fall_with_the_order_of_the_method_and_of_its_dense_output() {
    // The error inside of a step falls one order faster than that of the dense output alone, until
    // the error at its start is larger.
    for (method, steps, orders) in [
        (Method::Explicit, 8, [8.0, 7.0]),
        (Method::Stiff, 40, [5.0, 4.0]),
    ] {
        let coarse = fixed_step_errors(method, steps);
        let fine = fixed_step_errors(method, 2 * steps);
        for (order, (coarse, fine)) in orders.into_iter().zip(coarse.into_iter().zip(fine)) {
            let observed = (coarse / fine).log2();
            assert!(
                (order - 0.5..order + 2.0).contains(&observed),
                "{method:?}: {observed}"
            );
        }
    }
}

#[test]
fn dense_output_keeps_the_tolerance_and_meets_the_ends_of_the_step() {
    for method in METHODS {
        let mut swing = integrator(method, 1e-7, 0.0, &pendulum_at(0.0, 2.5));
        let mut x = [0.0; 2];
        while swing.state().t < 5.0 {
            let before = swing.state().x.clone();
            let step = swing.advance(&mut pendulum(), 5.0).unwrap();
            let after = swing.state().x.clone();
            let dense = swing.dense_output(&mut pendulum()).unwrap();
            for part in 1..10 {
                let t = step.start + f64::from(part) / 10.0 * (step.end - step.start);
                dense.interpolate(t, &mut x);
                assert!(error(&x, &pendulum_at(t, 2.5)) < 1e-7);
            }
            dense.interpolate(step.start, &mut x);
            assert_eq!(before, x);
            dense.interpolate(step.end, &mut x);
            assert_eq!(after, x);
        }
    }
}

#[test]
fn dense_output_alone_costs_evaluations() {
    let evaluations = |dense: bool| {
        let mut swing = integrator(Method::Explicit, 1e-8, 0.0, &[1.0, 0.0]);
        while swing.state().t < 5.0 {
            swing.advance(&mut pendulum(), 5.0).unwrap();
            if dense {
                swing.dense_output(&mut pendulum()).unwrap();
            }
        }
        let Statistics {
            accepted,
            evaluations,
            ..
        } = swing.state().statistics;
        (accepted, evaluations)
    };
    let (steps, without) = evaluations(false);
    assert_eq!(evaluations(true), (steps, without + 3 * steps));
}

#[test]
fn time_runs_backwards() {
    for method in METHODS {
        let start = pendulum_at(0.0, 2.0);
        let mut swing = integrator(method, 1e-9, 0.0, &start);
        run(&mut swing, &mut pendulum(), 5.0);
        run(&mut swing, &mut pendulum(), -3.0);
        assert!(error(&swing.state().x, &pendulum_at(-3.0, 2.0)) < 1e-8);
        run(&mut swing, &mut pendulum(), 0.0);
        assert!(error(&swing.state().x, &start) < 1e-8);
    }
}

/// x′ = −λ (x − cos t) − sin t, x = cos t (Prothero and Robinson).
fn decay(lambda: impl Fn(f64) -> f64) -> Smooth<impl FnMut(f64, &[f64], &mut [f64])> {
    Smooth(move |t: f64, x: &[f64], dx: &mut [f64]| {
        dx[0] = -lambda(t) * (x[0] - t.cos()) - t.sin();
    })
}

#[test]
fn fast_decay_takes_long_steps() {
    for method in [Method::Stiff, Method::Automatic] {
        let mut integrator = integrator(method, 1e-6, 0.0, &[2.0]);
        run(&mut integrator, &mut decay(|_| 1e6), 10.0);
        let State {
            x,
            statistics,
            stiffness,
            ..
        } = integrator.state();
        assert!(error(x, &[10.0_f64.cos()]) < 1e-6);
        assert!(statistics.accepted < 2_000, "{statistics:?}");
        assert_eq!(stiffness.stiff, method == Method::Automatic);
    }
}

#[test]
fn the_method_changes_with_the_equations() {
    let mut integrator = integrator(Method::Automatic, 1e-6, 0.0, &[1.0]);
    let mut system = decay(|t| if t < 20.0 { 1e5 } else { 0.1 });
    run(&mut integrator, &mut system, 20.0);
    assert!(integrator.state().stiffness.stiff);
    run(&mut integrator, &mut system, 40.0);
    assert!(!integrator.state().stiffness.stiff);
    assert!(error(&integrator.state().x, &[40.0_f64.cos()]) < 1e-5);
    assert!(integrator.state().statistics.accepted < 3_000);
}

/// Test Set for IVP Solvers, release 2.4: Van der Pol's equation with ε = 1e-6, reference at t = 2.
#[test]
fn van_der_pol_ends_at_the_published_point() {
    for method in [Method::Stiff, Method::Automatic] {
        let mut system = Smooth(|_, x: &[f64], dx: &mut [f64]| {
            dx[0] = x[1];
            dx[1] = ((1.0 - x[0] * x[0]) * x[1] - x[0]) / 1e-6;
        });
        let mut integrator = integrator(method, 1e-6, 0.0, &[2.0, 0.0]);
        run(&mut integrator, &mut system, 2.0);
        let State { x, statistics, .. } = integrator.state();
        let end = [0.170_616_773_217_048_3e1, -0.892_809_701_024_797_5];
        assert!(error(x, &end) < 1e-6, "{method:?}: {x:?}");
        assert!(statistics.accepted < 12_000, "{statistics:?}");
    }
}

/// Test Set for IVP Solvers, release 2.4: Robertson's reaction, reference at t = 1e11.
#[test]
fn robertson_ends_at_the_published_point() {
    for method in [Method::Stiff, Method::Automatic] {
        let mut system = Smooth(|_, x: &[f64], dx: &mut [f64]| {
            let rates = [0.04 * x[0], 1e4 * x[1] * x[2], 3e7 * x[1] * x[1]];
            dx[0] = rates[1] - rates[0];
            dx[1] = rates[0] - rates[1] - rates[2];
            dx[2] = rates[2];
        });
        let scales = vec![1e-6, 1e-10, 1.0];
        let mut integrator = scaled(method, 1e-5, scales, 0.0, &[1.0, 0.0, 0.0]);
        run(&mut integrator, &mut system, 1e11);
        let x = &integrator.state().x;
        let end = [
            0.208_334_014_970_125_5e-7,
            0.833_336_077_033_471_3e-13,
            0.999_999_979_166_505,
        ];
        for (x, end) in x.iter().zip(end) {
            assert!((x / end - 1.0).abs() < 1e-3, "{method:?}: {x:e} {end:e}");
        }
    }
}

fn bytes(state: &State) -> Vec<u8> {
    let mut bytes = Vec::new();
    let write = |word: &mut u64| -> Result<(), Infallible> {
        bytes.extend(word.to_le_bytes());
        Ok(())
    };
    state.clone().visit(write).unwrap();
    bytes
}

#[test]
fn a_restored_integrator_goes_on_with_the_same_bits() {
    for method in METHODS {
        // Stiff at first, so that the automatic method is met in both and in between.
        let system = || decay(|t| if t < 6.0 { 1e4 } else { 0.1 });
        let mut first = integrator(method, 1e-6, 0.0, &[1.5]);
        let mut second = integrator(method, 1e-6, -7.0, &[3.0]);
        let mut count = 0;
        while first.state().t < 12.0 {
            let mut state = second.state().clone();
            let saved = bytes(first.state());
            let mut words = saved.chunks_exact(8);
            let read = |word: &mut u64| {
                let chunk = words.next().ok_or("too short")?;
                *word = u64::from_le_bytes(chunk.try_into().map_err(|_| "too short")?);
                Ok::<(), &str>(())
            };
            state.visit(read).unwrap();
            assert_eq!(words.len(), 0);
            second.restore(&state).unwrap();
            for _ in 0..count % 5 {
                second.advance(&mut system(), 12.0).unwrap();
                first.advance(&mut system(), 12.0).unwrap();
            }
            assert_eq!(bytes(first.state()), bytes(second.state()));
            first.advance(&mut system(), 12.0).unwrap();
            count += 1;
        }
    }
}

#[test]
fn short_steps_of_a_host_keep_the_proposed_step_and_the_accuracy() {
    for method in METHODS {
        let mut swing = integrator(method, 1e-8, 0.0, &pendulum_at(0.0, 2.0));
        run(&mut swing, &mut pendulum(), 2.0);
        let natural = swing.state().h;
        let accepted = swing.state().statistics.accepted;
        let part = natural / 50.0;
        for step in 1..=200_u32 {
            let until = 2.0 + f64::from(step) * part;
            let step = swing.advance(&mut pendulum(), until).unwrap();
            assert_eq!(step.end.to_bits(), until.to_bits());
            assert!(swing.state().h >= natural);
        }
        swing.renew();
        assert!(swing.state().h >= natural);
        assert_eq!(swing.state().statistics.accepted, accepted + 200);
        run(&mut swing, &mut pendulum(), 10.0);
        assert!(error(&swing.state().x, &pendulum_at(10.0, 2.0)) < 1e-8);
    }
}

#[test]
fn no_short_step_remains_at_the_end() {
    let mut swing = integrator(Method::Explicit, 1e-8, 0.0, &[1.0, 0.0]);
    run(&mut swing, &mut pendulum(), 2.0);
    let natural = swing.state().h;
    for parts in [1.01, 1.3, 1.9] {
        let mut swing = swing.clone();
        let until = 2.0 + parts * natural;
        let first = swing.advance(&mut pendulum(), until).unwrap();
        let share = (first.end - first.start) / (until - 2.0);
        assert!(share > 0.499, "{parts}: {share}");
    }
}

#[test]
fn a_step_of_no_length_changes_nothing() {
    let mut swing = integrator(Method::Automatic, 1e-8, 1.0, &[1.0, 0.0]);
    let before = swing.state().clone();
    let step = swing.advance(&mut pendulum(), 1.0).unwrap();
    assert_eq!((step.start, step.end), (1.0, 1.0));
    assert_eq!(swing.state(), &before);
}

#[test]
fn a_quadrature_may_be_left_out_of_error_control() {
    for method in METHODS {
        let mut system = Smooth(|t: f64, x: &[f64], dx: &mut [f64]| {
            dx[0] = -x[0];
            dx[1] = (300.0 * t).sin();
        });
        let mut steps = |scale: f64| {
            let mut integrator = scaled(method, 1e-6, vec![1.0, scale], 0.0, &[1.0, 0.0]);
            run(&mut integrator, &mut system, 5.0);
            assert!((integrator.state().x[0] - (-5.0_f64).exp()).abs() < 1e-6);
            integrator.state().statistics.accepted
        };
        assert!(10 * steps(f64::INFINITY) < steps(1.0));
    }
}

#[test]
fn steps_at_a_large_time_have_a_length() {
    for method in METHODS {
        let start = 1e13;
        let mut integrator = integrator(method, 1e-6, start, &[0.0]);
        let mut system = Smooth(|_, _: &[f64], dx: &mut [f64]| dx[0] = 1.0);
        run(&mut integrator, &mut system, start + 1.0);
        assert!((integrator.state().x[0] - 1.0).abs() < 1e-9);
        assert!(integrator.state().statistics.accepted < 200);
    }
}
