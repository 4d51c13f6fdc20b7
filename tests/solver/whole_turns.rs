//! Sums of parts that jump together, at whole turns and next to them, against their closed forms.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::common::{assembled, parse, straight_to};
use biela::kinematics::{Path, Solver};
use biela::mechanism::Mechanism;

/// A sum of parts that jump: its expression of `x`, its closed form, and the distance of its jumps,
/// one of which is at zero.
struct Sum(&'static str, fn(f64) -> f64, f64);

/// Returns the phase of x in a period, 0 and 1 to rounding being one.
fn phase(x: f64, period: f64) -> f64 {
    let turns = x / period;
    let phase = turns - (turns + 1e-13).floor();
    phase.max(0.0)
}

/// Returns the number of periods before x.
fn count(x: f64, period: f64) -> f64 {
    (x / period + 1e-13).floor()
}

/// Sums whose parts have the same argument, and ones whose arguments differ by rounding.
const SUMS: [Sum; 17] = [
    Sum("2*pi*floor(x/(2*pi)) + mod(x, 2*pi)", |x| x, TAU),
    Sum("2*pi*(floor(x/2/pi) + mod(x, 2*pi)/(2*pi))", |x| x, TAU),
    Sum(
        "pi*floor(x/pi - 1/2) + mod(x - pi/2, pi) + pi/2",
        |x| x,
        PI / 2.0,
    ),
    Sum(
        "2*pi/3*floor(3*x/(2*pi)) + mod(x, 2*pi/3)",
        |x| x,
        TAU / 3.0,
    ),
    Sum("0.1*floor(10*x) + mod(x, 0.1)", |x| x, 0.1),
    Sum("floor(x) + mod(x, 1)", |x| x, 1.0),
    Sum("ceil(x) - mod(-x, 1)", |x| x, 1.0),
    Sum(
        "deg*ceil(x/deg) + mod(x, deg) - deg*(ceil(x/deg) - floor(x/deg))",
        |x| x,
        PI / 180.0,
    ),
    Sum("sin(mod(x, 2*pi))", f64::sin, TAU),
    Sum(
        "abs(mod(x, 2) - 1)",
        |x| (2.0 * phase(x, 2.0) - 1.0).abs(),
        2.0,
    ),
    Sum(
        "min(mod(x, 1), 1 - mod(x, 1))",
        |x| phase(x, 1.0).min(1.0 - phase(x, 1.0)),
        1.0,
    ),
    Sum(
        "floor(x) + mod(x, 1)^2",
        |x| count(x, 1.0) + phase(x, 1.0).powi(2),
        1.0,
    ),
    // A dwell over half of each turn, and one that begins smoothly.
    Sum(
        "pi*(floor(x/(2*pi)) + min(1, mod(x, 2*pi)/pi))",
        |x| PI * (count(x, TAU) + (2.0 * phase(x, TAU)).min(1.0)),
        TAU,
    ),
    Sum(
        "floor(x/pi) + (1 - cos(mod(x, pi)))/2",
        |x| count(x, PI) + (1.0 - (PI * phase(x, PI)).cos()) / 2.0,
        PI,
    ),
    Sum("sign(x)*x", f64::abs, 1.0),
    Sum("max(x, 0) + min(x, 0)*sign(1 + x^2)", |x| x, 1.0),
    Sum(
        "floor(x)*(1 - max(0, sign(x))) + mod(x, 1)*(1 - max(0, sign(x))) + x*max(0, sign(x))",
        |x| x,
        1.0,
    ),
];

/// Errors of a sum: those of its parts, some roundings of x and of the number of periods each.
fn rounding(x: f64) -> f64 {
    1e-14 * x.abs().max(1.0)
}

/// Numbers of periods at which a sum is looked at.
const PERIODS: [f64; 8] = [0.0, 1.0, -1.0, 2.0, 3.0, -5.0, 7.0, 75.0];

/// Returns a jump of the parts with its neighbours.
fn around(x: f64) -> [f64; 5] {
    let (up, down) = (x.next_up(), x.next_down());
    [x, up, down, up.next_up(), down.next_down()]
}

/// Two arms: the second follows an equation, the first a driver.
fn arms(more: &str, driver: &str) -> Arc<Mechanism> {
    parse(&format!(
        "format = 1\nname = 'arms'\n[parameters]\nn = {{ value = 0.25, tunable = true }}\n\
         [ground.markers]\nA = [0, 0]\nB = [1, 0]\n[bodies.first]\nmarkers = {{ A = [0, 0] }}\n\
         [bodies.second]\nmarkers = {{ B = [0, 0] }}\nestimate = [1, 0, 0]\n[joints]\n\
         A = {{ type = 'revolute', markers = ['ground.A', 'first.A'] }}\n\
         B = {{ type = 'revolute', markers = ['ground.B', 'second.B'] }}\n{more}\n[measures]\n\
         b = {{ coordinate = 'angle', markers = ['ground.B', 'second.B'] }}\n[drivers]\n\
         a = {{ coordinate = 'angle', markers = ['ground.A', 'first.A'], {driver} }}\n"
    ))
}

/// Returns the sum of `variable`.
fn of(sum: &str, variable: &str) -> String {
    // The only names with an x are `max` and the variable.
    sum.replace('x', variable)
        .replace(&format!("ma{variable}("), "max(")
}

fn tie(sum: &str) -> String {
    format!(
        "tie = {{ type = 'coupling', equation = 'b = {}' }}",
        of(sum, "a")
    )
}

/// Moves the driver to a value in one step, and stays there for another.
fn go_and_stay(solver: &mut Solver, path: &mut Path, a: f64, what: &str) {
    for how in ["goes", "stays"] {
        straight_to(solver, path, a);
        if let Err(blocked) = solver.track(path) {
            panic!("{what} = {a:?} {how}: {blocked:?}");
        }
    }
}

#[test]
fn an_equation_is_its_closed_form_at_jumps_of_its_parts() {
    for Sum(sum, closed, period) in SUMS {
        let (mut solver, mut path) = assembled(&arms(&tie(sum), "start = 0.25"));
        for periods in PERIODS {
            for a in around(periods * period) {
                go_and_stay(&mut solver, &mut path, a, sum);
                let off = solver.pose().q[5] - closed(a);
                assert!(off.abs() <= rounding(a), "{sum} at {a:?}: {off:e}");
            }
        }
    }
}

#[test]
fn a_mechanism_starts_at_jumps_of_parts() {
    for Sum(sum, closed, period) in SUMS {
        for periods in PERIODS {
            for a in around(periods * period) {
                let mechanism = arms(&tie(sum), &format!("start = {a:?}"));
                let (mut solver, mut path) = assembled(&mechanism);
                go_and_stay(&mut solver, &mut path, a, sum);
                let off = solver.pose().q[5] - closed(a);
                assert!(off.abs() <= rounding(a), "{sum} at {a:?}: {off:e}");
            }
        }
    }
}

/// A motion that is such a sum passes its jumps, begins and ends at them, and is there in two rows.
#[test]
fn a_motion_is_its_closed_form_at_jumps_of_its_parts() {
    for Sum(sum, closed, period) in SUMS {
        let mechanism = arms(&tie("x"), &format!("motion = '{}'", of(sum, "t")));
        for periods in PERIODS {
            for time in around(periods * period) {
                let (mut solver, mut path) = assembled(&mechanism);
                path.start = time - 1.5 * period;
                path.duration = 0.0;
                solver.assemble(&path).expect("any angle has a pose");
                for (to, rows) in [(time, 2), (time + 0.6 * period, 1)] {
                    for _ in 0..rows {
                        path.duration = to - path.start;
                        let tracked = solver.track(&path);
                        if let Err(blocked) = tracked {
                            panic!("{sum} from {:?} to {to:?}: {blocked:?}", path.start);
                        }
                        let off = solver.pose().q[5] - closed(to);
                        assert!(off.abs() <= rounding(to), "{sum} at {to:?}: {off:e}");
                        path.start = to;
                    }
                }
            }
        }
    }
}

/// A held angle that is such a sum of a parameter which moves over its jumps.
#[test]
fn a_number_is_its_closed_form_at_jumps_of_its_parts() {
    for Sum(sum, closed, period) in SUMS {
        let held = format!(
            "\n[constraints]\nheld = {{ coordinate = 'angle', markers = ['ground.B', 'second.B'], \
             value = '{}' }}",
            of(sum, "n")
        );
        let (mut solver, mut path) = assembled(&arms(&held, "start = 0.25"));
        for periods in PERIODS {
            // The way is as long as that of a parameter in a step.
            for n in around(periods * period)
                .into_iter()
                .chain([periods * period + 0.3 * period])
            {
                path.from.clone_from(&solver.pose().parameters);
                path.to[0] = n;
                if let Err(blocked) = solver.track(&path) {
                    panic!("{sum} to {n:?}: {blocked:?}");
                }
                let off = solver.pose().q[5] - closed(n);
                assert!(off.abs() <= rounding(n), "{sum} at {n:?}: {off:e}");
            }
        }
    }
}

/// Sums that jump are refused where they do, in equations and in motions.
#[test]
fn a_sum_that_jumps_is_no_sum_of_these() {
    let jumping = [
        "pi*floor(x/(2*pi)) + mod(x, 2*pi)",
        "floor(x/(2*pi)) - mod(x, 2*pi)",
    ];
    for sum in jumping {
        let (mut solver, mut path) = assembled(&arms(&tie(sum), "start = 0.25"));
        straight_to(&solver, &mut path, 7.0);
        solver.track(&path).expect_err(sum);
        assert!((solver.pose().drivers[0] - TAU).abs() < 1e-6, "{sum}");
        let motion = format!("motion = '{}'", of(sum, "t"));
        let (mut solver, mut path) = assembled(&arms(&tie("x"), &motion));
        path.duration = 7.0;
        let blocked = solver.track(&path).expect_err(sum);
        assert!((7.0 * blocked.s - TAU).abs() < 1e-6, "{sum}: {blocked:?}");
    }
}
