//! Constraints that say nothing new, contradict each other, or leave too much or too little to
//! drive.

mod common;

use std::sync::Arc;

use biela::kinematics::{Error, Path, Solver};
use biela::mechanism::Mechanism;
use common::parse;

fn solve(text: &str) -> Result<Solver, Error> {
    let mechanism: Arc<Mechanism> = parse(text);
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism)?;
    solver.assemble(&path)?;
    Ok(solver)
}

/// Cranks of 0.1 m at these angles, all with a coupler of 0.4 m.
fn parallelogram(third: Option<[f64; 2]>, start: f64, driver: bool) -> String {
    let (sin, cos) = start.to_radians().sin_cos();
    let (x, y) = (0.1 * cos, 0.1 * sin);
    let mut text = format!(
        r#"
        format = 1
        name = "parallelogram"
        [ground.markers]
        O2 = [0, 0]
        O4 = [0.4, 0]
        [bodies.crank]
        markers = {{ O = [0, 0], A = [0.1, 0] }}
        estimate = [0, 0, "{start}*deg"]
        [bodies.coupler]
        markers = {{ A = [0, 0], B = [0.4, 0] }}
        estimate = [{x}, {y}, 0]
        [bodies.rocker]
        markers = {{ O = [0, 0], B = [0.1, 0] }}
        estimate = [0.4, 0, "{start}*deg"]
        [joints]
        O2 = {{ type = "revolute", markers = ["ground.O2", "crank.O"] }}
        A = {{ type = "revolute", markers = ["crank.A", "coupler.A"] }}
        B = {{ type = "revolute", markers = ["coupler.B", "rocker.B"] }}
        O4 = {{ type = "revolute", markers = ["ground.O4", "rocker.O"] }}
        "#
    );
    if let Some([cx, cy]) = third {
        text = text
            .replace("O4 = [0.4, 0]", &format!("O4 = [0.4, 0]\nO5 = [{cx}, {cy}]"))
            .replace("B = [0.4, 0] }", &format!("B = [0.4, 0], C = [{cx}, {cy}] }}"))
            .replace(
                "[joints]",
                &format!(
                    "[bodies.third]\nmarkers = {{ O = [0, 0], C = [0.1, 0] }}\n\
                     estimate = [{cx}, {cy}, \"{start}*deg\"]\n[joints]"
                ),
            );
        text += r#"
        C = { type = "revolute", markers = ["coupler.C", "third.C"] }
        O5 = { type = "revolute", markers = ["ground.O5", "third.O"] }
        "#;
    }
    if driver {
        text += &format!(
            "[drivers]\ncrank_angle = {{ coordinate = \"angle\", \
             markers = [\"ground.O2\", \"crank.O\"], start = \"{start}*deg\" }}\n"
        );
    }
    text
}

#[test]
fn try_it() {
    for (third, start, driver) in [
        (Some([0.2, 0.0]), 60.0, true),
        (Some([0.2, 0.1]), 60.0, true),
        (Some([0.2, 0.1]), 0.0, true),
        (Some([0.2, 0.0]), 0.0, true),
        (None, 0.0, true),
        (Some([0.2, 0.1]), 60.0, false),
        (None, 60.0, false),
    ] {
        match solve(&parallelogram(third, start, driver)) {
            Ok(solver) => {
                let names: Vec<_> = solver.redundancies().iter().map(|r| r.to_string()).collect();
                println!("{third:?} {start} {driver}: ok {names:?} {:e}", solver.residual());
            }
            Err(error) => println!("{third:?} {start} {driver}: {error}"),
        }
    }
}
