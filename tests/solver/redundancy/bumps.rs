//! Equations set aside that hold where steps end and not between: each contradiction is named where it
//! begins.

use std::sync::Arc;

use biela::kinematics::{End, RangeSettings, Reason};
use biela::mechanism::{DriverId, Mechanism};

use crate::common::{assembled, parse, straight_to};

/// Two arms, the second of which follows two equations of the first one's angle `a`.
fn arms(equations: [&str; 2]) -> Arc<Mechanism> {
    let [first, second] = equations;
    parse(&format!(
        "format = 1\nname = 'arms'\n[ground.markers]\nA = [0, 0]\nB = [1, 0]\n[bodies.first]\n\
         markers = {{ A = [0, 0] }}\n[bodies.second]\nmarkers = {{ B = [0, 0] }}\n\
         estimate = [1, 0, 0]\n[joints]\n\
         A = {{ type = 'revolute', markers = ['ground.A', 'first.A'] }}\n\
         B = {{ type = 'revolute', markers = ['ground.B', 'second.B'] }}\n\
         one = {{ type = 'coupling', equation = '{first}' }}\n\
         two = {{ type = 'coupling', equation = '{second}' }}\n[measures]\n\
         b = {{ coordinate = 'angle', markers = ['ground.B', 'second.B'] }}\n[drivers]\n\
         a = {{ coordinate = 'angle', markers = ['ground.A', 'first.A'], start = 0 }}\n"
    ))
}

/// A bump of 0.1 rad at a = 1, which is zero to rounding at both ends of each step.
const BUMP: &str = "b = 2*a + 0.1*exp(-((a - 1)/WIDTH)^2)";

/// The bump is 1e-9, which a row set aside may be open by at the end of a sub-step, at 4.29 widths from
/// its middle, and 1e-4, which it may be between the ends, at 2.63.
#[test]
fn a_bump_of_an_equation_is_no_redundancy() {
    for width in [0.05, 0.01, 0.001] {
        let bump = BUMP.replace("WIDTH", &width.to_string());
        // Whichever of both is set aside.
        for equations in [["b = 2*a", &bump], [&bump, "b = 2*a"]] {
            for step in [1.7, 0.6, 0.05] {
                let (mut solver, mut path) = assembled(&arms(equations));
                let mut blocked = None;
                let mut steps = 0.0;
                while blocked.is_none() && steps * step < 1.7 {
                    steps += 1.0;
                    straight_to(&solver, &mut path, steps * step);
                    blocked = solver.track(&path).err();
                }
                let blocked = blocked.unwrap_or_else(|| panic!("{equations:?}, {step} passes"));
                let is_named = matches!(blocked.reason, Reason::Contradiction(_));
                assert!(is_named, "{equations:?}, {step}: {blocked:?}");
                let widths = (1.0 - solver.pose().drivers[0]) / width;
                assert!(
                    (2.63..4.4).contains(&widths),
                    "{equations:?}, {step}: {widths}"
                );
            }
        }
    }
}

#[test]
fn a_range_ends_at_a_bump() {
    for width in [0.05, 0.001] {
        let bump = BUMP.replace("WIDTH", &width.to_string());
        let (mut solver, _) = assembled(&arms(["b = 2*a", &bump]));
        let range = solver.range(DriverId(0), &RangeSettings::default());
        let End::Blocked { value, reason } = range.upper else {
            panic!("{:?}", range.upper)
        };
        assert!(matches!(reason, Reason::Contradiction(_)), "{reason:?}");
        let widths = (1.0 - value) / width;
        assert!((2.63..4.4).contains(&widths), "{widths}");
    }
}

/// A corner is no bump, but an equation with one holds on its one side only.
#[test]
fn an_equation_that_parts_at_a_corner_is_no_redundancy() {
    let (mut solver, mut path) =
        assembled(&arms(["b = 2*a", "b = 2*a + max(0, 0.2 - abs(a - 1))"]));
    straight_to(&solver, &mut path, 1.7);
    let blocked = solver.track(&path).expect_err("it is open by 0.2 at 1");
    assert!(
        matches!(blocked.reason, Reason::Contradiction(_)),
        "{blocked:?}"
    );
    assert!((solver.pose().drivers[0] - 0.8).abs() < 1e-3);
}

/// An equation that agrees costs √(b/8e-4) sub-steps per radian: sin a bends by 1, and 2 b deviates by
/// as much, 50 for b = 2; and some that are too long.
#[test]
fn equations_that_agree_are_passed_in_few_sub_steps() {
    let equations = ["b = 0.5*sin(a)", "sin(a) = 2*b"];
    let (mut solver, mut path) = assembled(&arms(equations));
    straight_to(&solver, &mut path, 1.7);
    let progress = solver.track(&path).expect("they are one equation");
    assert_eq!(progress.checked, 0);
    assert!(progress.substeps < 100, "{progress:?}");
    assert!((solver.pose().q[5] - 0.5 * 1.7_f64.sin()).abs() < 1e-15);
    // As a machine steps, a degree at a time, it costs nothing.
    straight_to(&solver, &mut path, 1.7 + 0.017);
    let progress = solver.track(&path).expect("they are one equation");
    assert_eq!(progress.substeps, 1);
}
