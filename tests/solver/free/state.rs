//! A saved state goes on to the same bits.

use biela::dynamics::FreeMotion;
use biela::kinematics::SolverChoices;

use super::dead_points::swing;
use super::lagrange::torque_input;
use super::run::{Fed, Run};
use crate::common::{assembled, parse, shipped};

#[test]
fn a_motion_goes_on_from_its_state_in_another_solver() {
    // Its height has its dead point at 0.728 s.
    let swing = swing(
        r#"coordinate = "y", markers = ["ground.O", "seat.A"], start = -1.6"#,
        [1.2, -1.6],
    );
    let mechanisms = [
        ("pendulum_free", Fed::default(), 2.0),
        ("double_pendulum", Fed::default(), 2.0),
        ("engine_free", torque_input(), 0.5),
        ("five_bar_free", Fed::default(), 2.0),
        ("four_bar_chain", Fed::default(), 2.0),
        ("four_bar_free", torque_input(), 1.0),
        ("slider_crank_motor", torque_input(), 1.0),
        ("swinging_tip", Fed::default(), 2.0),
        ("cart_pole", torque_input(), 2.0),
        ("andrews_free", Fed::default(), 0.03),
    ]
    .map(|(name, fed, until)| (name, shipped(name), fed, until));
    let swing = ("swing", parse(&swing), Fed::default(), 2.0);
    for (name, mechanism, fed, until) in mechanisms.into_iter().chain([swing]) {
        let mut run = Run::new(&mechanism, 1e-8, fed);
        // Between the integrator's own steps, and at the start.
        for part in [0.0, 0.37, 0.3701, 0.8] {
            run.to(part * until);
            let state = run.free.state();
            let (solver, _) = assembled(&mechanism);
            let free = FreeMotion::new(&solver, 1e-8).expect("a valid tolerance");
            let free = free.expect("it has freedoms");
            let mut choices = SolverChoices::default();
            run.solver.copy_choices(&mut choices);
            let mut other = Run::of(solver, free, fed);
            let Run {
                solver,
                solution,
                free,
                ..
            } = &mut other;
            free.select(solver, solution, &state)
                .expect("its coordinates");
            assert!(solver.resume(run.solver.pose(), &choices));
            free.resume(solver, &state)
                .expect("a state of the same mechanism");
            // And the first one goes on as if nobody had looked.
            let mut straight = Run::new(&mechanism, 1e-8, fed);
            for earlier in [0.0, 0.37, 0.3701, 0.8] {
                if earlier <= part {
                    straight.to(earlier * until);
                }
            }
            for run in [&mut other, &mut straight] {
                for later in [0.9, 1.0] {
                    run.to(later * until);
                }
            }
            assert_eq!(other.free.state(), straight.free.state(), "{name} {part}");
            assert_eq!(other.solver.pose(), straight.solver.pose(), "{name} {part}");
        }
    }
}
