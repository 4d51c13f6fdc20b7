//! One joint too many in a long chain.

use std::f64::consts::TAU;

use crate::common::{assembled, parse, straight_to};
use crate::generated::{Ground, chain};
use crate::redundancy::mechanisms::{joint, with_joints};

/// Chains of loops with one joint too many: at the end, in the middle, and declared before all
/// others where the pattern of the equations does not tell that it is too many.
fn long_chains(loops: usize) -> [(&'static str, String, String); 3] {
    let text = chain(loops, Ground::Zigzag);
    let middle = loops / 2;
    let pivot = joint(
        "again",
        "revolute",
        &format!("ground.O{loops}"),
        &format!("rocker_{loops}.O"),
    );
    let rod = format!(
        "again = {{ type = \"link\", markers = [\"rocker_{}.B\", \"rocker_{middle}.B\"], \
         length = 0.25 }}\n",
        middle - 1
    );
    let pin = joint(
        "pin",
        "revolute",
        &format!("coupler_{middle}.B"),
        &format!("rocker_{middle}.B"),
    );
    let first = text.replacen("[joints]\n", &format!("[joints]\n{pin}"), 1);
    [
        (
            "at the end",
            with_joints(&text, &pivot),
            "joint `again`".to_owned(),
        ),
        (
            "beside a coupler",
            with_joints(&text, &rod),
            "joint `again`".to_owned(),
        ),
        ("declared first", first, format!("joint `B{middle}`")),
    ]
}

/// A long chain is looked at loop by loop: with one dense matrix of this size the test would
/// take minutes.
#[test]
fn one_joint_too_many_in_a_long_chain_is_found() {
    for (what, text, name) in long_chains(45) {
        let (mut solver, mut path) = assembled(&parse(&text));
        let redundancies = solver.redundancies();
        assert_eq!(redundancies.len(), 1, "{what}");
        assert_eq!(redundancies[0].origin, name, "{what}");
        let angle = TAU / 6.0 + 0.1;
        straight_to(&solver, &mut path, angle);
        solver
            .track(&path)
            .unwrap_or_else(|blocked| panic!("{what}: {blocked:?}"));
        // Every rocker turns like the first.
        let phi = |k: usize| {
            let rocker = solver.mechanism().body_id(&format!("rocker_{k}"));
            solver.pose().q[3 * rocker.expect("it has it").index() + 2]
        };
        for k in 2..=45 {
            assert!(
                (phi(k) - phi(1)).abs() < 1e-12,
                "{what}: {k} {}",
                phi(k) - phi(1)
            );
        }
    }
}
