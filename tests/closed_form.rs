//! Position, velocity and acceleration of every body against closed forms.

mod common;
#[path = "common/generated.rs"]
#[allow(dead_code, reason = "also used by `benches/`")]
mod generated;

use biela::kinematics::{Curve, Rates};
use biela::mechanism::Jet;
use common::{EXACT, Errors, assembled, parse, shipped, straight_to};
use generated::{Ground, chain};

/// The solution is right to the rounding of the equations (some eps of the size) times the
/// condition of the Jacobian, which stays above 0.02 over these motions: 1e-14 for positions;
/// velocity and acceleration each pass through the Jacobian once more.
const LIMITS: [f64; 3] = [1e-14, 1e-13, 1e-12];

#[test]
fn the_four_systems_move_as_their_closed_forms_say() {
    for exact in EXACT {
        let mechanism = shipped(exact.file);
        let (mut solver, mut path) = assembled(&mechanism);
        let (from, to) = exact.range;
        straight_to(&solver, &mut path, from);
        solver.track(&path).expect("the start can be reached");
        let mut rates = Rates::new(solver.pose().q.len());
        let mut errors = Errors::default();
        // From rest with a constant acceleration, over one second.
        let acceleration = 2.0 * (to - from);
        let steps = 500;
        let h = 1.0 / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            path.start = t;
            path.duration = h;
            path.curves[0] = Curve::Input {
                position: from + 0.5 * acceleration * t * t,
                velocity: acceleration * t,
                acceleration,
                jump: 0.0,
            };
            let progress = solver.track(&path).expect("nothing is in the way");
            assert_eq!(progress.substeps, 1, "{}: an ordinary step", exact.file);
            let driver = Jet::new(
                solver.pose().drivers[0],
                [acceleration * (t + h), acceleration],
            );
            solver
                .solve_rates(|_| driver, &mut rates)
                .expect("the pose is regular");
            errors.collect(&solver, &rates, &exact.solution(&mechanism, driver));
        }
        let relative = errors.relative();
        println!("{}: {relative:?}", exact.file);
        for order in 0..3 {
            assert!(
                relative[order] <= LIMITS[order],
                "{}, order {order}: {relative:?}",
                exact.file
            );
        }
    }
}

/// Every rocker of a chain turns like the first, whether the chain stays where it is or goes away
/// 250 m. Rounding adds up from loop to loop, each passing on what it got and some eps of its
/// own: 1e-13 for each of a thousand loops at the most.
#[test]
fn a_long_chain_moves_as_its_first_loop() {
    const LOOPS: usize = 1000;
    for ground in [Ground::Zigzag, Ground::Straight] {
        let mechanism = parse(&chain(LOOPS, ground));
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(solver.pose().q.len());
        for _ in 0..20 {
            let now = solver.pose().drivers[0];
            straight_to(&solver, &mut path, now + 0.05);
            let progress = solver.track(&path).expect("the crank turns fully");
            assert_eq!(progress.substeps, 1);
            let driver = Jet::new(0.0, [10.0, 3.0]);
            solver
                .solve_rates(|_| driver, &mut rates)
                .expect("the pose is regular");
            for values in [&solver.pose().q[..], rates.velocity(), rates.acceleration()] {
                let first = values[8];
                for loop_ in 1..LOOPS {
                    let off = (values[6 * loop_ + 8] - first).abs();
                    assert!(
                        off <= 1e-10 * first.abs(),
                        "loop {loop_}: {off:e} of {first}"
                    );
                }
            }
        }
    }
}
