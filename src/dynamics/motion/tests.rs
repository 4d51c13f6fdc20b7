//! A motion in coordinates that are no good.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use super::FreeMotion;
use crate::dynamics::{Error, Given};
use crate::kinematics::{Path, Solution, Solver};
use crate::mechanism::{DriverId, Jet, Mechanism, Source};

/// A platform of 1 kg on two links of 2 m, which is let go at a height: a pendulum.
const SWING: &str = r#"
format = 1
name = "swing"
[ground.markers]
O = [0, 0]
P = [1, 0]
[bodies.seat]
mass = 1
markers = { A = [0, 0], B = [1, 0] }
estimate = [1.2, -1.6, 0]
[joints]
left = { type = "link", markers = ["ground.O", "seat.A"], length = 2 }
right = { type = "link", markers = ["ground.P", "seat.B"], length = 2 }
[freedoms]
height = { coordinate = "y", markers = ["ground.O", "seat.A"], start = -1.6 }
"#;

/// Nothing is given.
struct Nothing;

impl Given for Nothing {
    fn driver(&self, _: DriverId, _: f64) -> Jet {
        unreachable!("no driver is an input")
    }

    fn loads(&self, _: f64, _: &mut [f64]) {}
}

/// The time from an amplitude to the lowest point: K(sin θ/2)/ω, by the arithmetic-geometric mean.
fn quarter(amplitude: f64, omega: f64) -> f64 {
    let (mut a, mut b) = (1.0, (0.5 * amplitude).cos());
    while a - b > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a / omega
}

/// At the lowest point the height says nothing about the motion. Where no other coordinate is taken the
/// motion stops in front of it, with its energy right up to there, rather than creep.
#[test]
fn a_motion_that_loses_energy_stops() {
    let source = Source::new("swing.toml", SWING);
    let (mechanism, _) = Mechanism::parse(&source).expect("no errors");
    let mechanism = Arc::new(mechanism);
    let lowest = quarter(f64::atan2(1.2, 1.6), (9.81_f64 / 2.0).sqrt());
    for tolerance in [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let path = Path::new(&mechanism);
        let mut solver = Solver::assembled(Arc::clone(&mechanism), &path).expect("it closes");
        let mut solution = Solution::new(&solver);
        let free = FreeMotion::new(&solver, tolerance).expect("a tolerance");
        let mut free = free.expect("it has a freedom");
        free.charts.keep_own();
        free.start(&mut solver, &Nothing).expect("it starts");
        let stopped = free.advance(&mut solver, &mut solution, &Nothing, PI);
        let Err(Error::Energy { time, change, .. }) = stopped else {
            panic!("{tolerance:e}: {stopped:?}");
        };
        // A ten-thousandth of 6 J is lost at once at the least; a thousandth is in no step before.
        let error = free.energy_error().abs();
        assert!(
            change.abs() > 1e-9 && error < 6e-3,
            "{tolerance:e}: {change:e} {error:e}"
        );
        assert!((lowest - 1e-3..=lowest + 1e-5).contains(&time), "{time}");
        assert!(solver.pose().time <= time);
    }
}
