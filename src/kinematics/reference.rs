//! The reference: the formulas of the source text on all equations at once, by dense matrices.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

#[path = "../../tests/common/generated.rs"]
#[allow(dead_code, reason = "also used by `crates/benches`")]
pub(super) mod generated;

use super::constraint::Gradient;
use super::system::EquationTarget;
use super::{DriverPath, Path, Rates, Solver};
use crate::mechanism::{Jet, Mechanism, Source};
use proptest::prelude::*;

/// Returns Phi and Phi_q at the solver's pose, not scaled.
fn equations(solver: &Solver) -> (DVector<f64>, DMatrix<f64>) {
    let equations = solver.system().equations();
    let order = equations.len();
    let mut phi = DVector::zeros(order);
    let mut phi_q = DMatrix::zeros(order, order);
    for (row, equation) in equations.iter().enumerate() {
        let target = solver
            .system()
            .target(row, &solver.state.targets, &solver.pose().drivers);
        phi[row] = equation.constraint.value(&solver.state.at) - target;
        let mut gradient = Gradient::new();
        equation
            .constraint
            .gradient(&solver.state.at, &mut gradient);
        for (column, value) in gradient.entries() {
            phi_q[(row, column)] += value;
        }
    }
    (phi, phi_q)
}

/// Asserts that q is within rounding of the root that Newton–Raphson on all equations finds from
/// there, and that the rates solve Eq. 3.6.10 and 3.6.11. Returns the reciprocal condition.
fn check(solver: &mut Solver, drivers: &[Jet], what: &str) -> f64 {
    let mut rates = Rates::new(solver.pose().q.len());
    solver
        .solve_rates(|driver| drivers[driver.index()], &mut rates)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    let (phi, phi_q) = equations(solver);
    let singular = phi_q.singular_values();
    let rcond = singular.min() / singular.max();
    let lu = phi_q.full_piv_lu();
    let solve = |side: &DVector<f64>| lu.solve(side).expect("the pose is regular");
    let largest = |v: &[f64]| v.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    // Both sides have errors of some eps times the magnitudes, multiplied by the inverse once for
    // q, and once more for each order of the rates.
    let rounding = 100.0 * f64::EPSILON / rcond;

    let off = solve(&phi);
    let size = largest(&solver.pose().q);
    assert!(off.amax() <= rounding * size, "{what}: q {:e}", off.amax());

    let equations = solver.system().equations();
    let driver = |row: usize| match equations[row].target {
        EquationTarget::Constant(_) => Jet::constant(0.0),
        EquationTarget::Driver(driver) => drivers[driver.index()],
    };
    let order = equations.len();
    let nu = DVector::from_fn(order, |row, _| driver(row).first());
    let velocity = DVector::from_column_slice(rates.velocity());
    let off = (solve(&nu) - &velocity).amax();
    let size = largest(rates.velocity());
    assert!(off <= rounding * size, "{what}: velocity {off:e}");

    let gamma = DVector::from_fn(order, |row, _| {
        let quadratic = equations[row]
            .constraint
            .quadratic(&solver.state.at, rates.velocity());
        driver(row).second() - quadratic
    });
    let acceleration = DVector::from_column_slice(rates.acceleration());
    let off = (solve(&gamma) - &acceleration).amax();
    let size = largest(rates.acceleration()).max(size * size);
    assert!(off <= rounding * size, "{what}: acceleration {off:e}");
    rcond
}

/// Returns the text of a shipped mechanism.
pub(super) fn shipped(name: &str) -> Source {
    let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Source::open(name, path.as_ref()).expect("it is shipped")
}

pub(super) fn assembled(source: &Source) -> (Solver, Path) {
    let what = source.name();
    let (mechanism, _) =
        Mechanism::parse(source).unwrap_or_else(|diagnostics| panic!("{what}: {diagnostics:#?}"));
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
    solver
        .assemble(&path)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    (solver, path)
}

/// Moves each driver by its part of `by`, as far as the motion goes.
fn move_on(solver: &mut Solver, path: &mut Path, by: f64) {
    path.start = solver.pose().time;
    path.from.copy_from_slice(&solver.pose().parameters);
    path.to.copy_from_slice(&solver.pose().parameters);
    path.duration = by.abs();
    for (k, (driver_path, now)) in path
        .driver_paths
        .iter_mut()
        .zip(&solver.pose().drivers)
        .enumerate()
    {
        if let DriverPath::Input { position, jump, .. } = driver_path {
            *position = now + by / (k + 1) as f64;
            *jump = now - *position;
        }
    }
    // A dead point may stop the motion; the pose in front of it serves as well.
    let _ = solver.track(path);
}

#[test]
fn every_shipped_mechanism_agrees() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("it is shipped") {
        let file = entry.expect("it can be read").path();
        if file.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let name = file.display().to_string();
        let source = Source::open(name.clone(), &file).expect("it can be read");
        let (mut solver, mut path) = assembled(&source);
        let drivers: Vec<_> = (0..solver.pose().drivers.len())
            .map(|k| Jet::new(0.0, [1.0 + 0.5 * k as f64, 0.3 - k as f64]))
            .collect();
        for _ in 0..10 {
            let rcond = check(&mut solver, &drivers, &name);
            assert!(rcond > 0.0);
            move_on(&mut solver, &mut path, 0.003);
        }
        seen += 1;
    }
    assert!(seen > 20);
}

/// Chains, and lifts whose loops are one block with a dense or a sparse matrix.
#[test]
fn generated_mechanisms_agree() {
    use generated::{Ground, chain, scissor_lift};
    let texts = [
        chain(10, Ground::Straight),
        scissor_lift(1),
        scissor_lift(3),
        scissor_lift(6),
        scissor_lift(12),
    ];
    for (index, text) in texts.iter().enumerate() {
        let name = format!("mechanism {index}");
        let (mut solver, mut path) = assembled(&Source::new(name.clone(), text));
        let driver = Jet::new(0.0, [1.3, -0.7]);
        for _ in 0..10 {
            check(&mut solver, &[driver], &name);
            move_on(&mut solver, &mut path, 0.05);
        }
    }
}

/// Returns the text of a mechanism that grows part by part on points that already move.
pub(super) fn grown(parts: &[Part]) -> String {
    use std::fmt::Write as _;
    let mut bodies = String::new();
    let mut joints = String::new();
    let mut ground = String::from("O = [0, 0]\n");
    bodies += "[bodies.crank]\nmarkers = { O = [0.02, -0.01], A = [0.12, 0] }\n\
               estimate = [-0.02, 0.01, 0.3]\n";
    joints += "O = { type = \"revolute\", markers = [\"ground.O\", \"crank.O\"] }\n";
    let mut tip = "crank.A".to_owned();
    for (k, part) in parts.iter().enumerate() {
        let pivot = 0.35 + 0.3 * k as f64;
        let Part { kind, size, frame } = part;
        let _ = writeln!(ground, "P{k} = [{pivot}, 0.02]");
        // A body whose points lie `frame` away from its origin, `length` apart.
        let mut body = |name: &str, length: f64, estimate: &str| {
            let _ = writeln!(
                bodies,
                "[bodies.{name}{k}]\nmarkers = {{ A = [{frame}, 0.01], B = [{}, 0.01] }}\n\
                 estimate = {estimate}",
                frame + length
            );
        };
        let mut joint = |name: &str, kind: &str, from: &str, to: &str| {
            let _ = writeln!(
                joints,
                "{name}{k} = {{ type = \"{kind}\", markers = [\"{from}\", \"{to}\"] }}"
            );
        };
        let (a, b) = (format!("a{k}"), format!("b{k}"));
        let estimate = format!("[{}, 0.1, 0.5]", pivot - 0.3);
        match kind {
            // An RRR dyad whose links are long enough to turn.
            0 => {
                body("a", 0.32 + 0.1 * size, &estimate);
                body("b", 0.34, &format!("[{pivot}, 0.0, 1.8]"));
                joint("ra", "revolute", &tip, &format!("{a}.A"));
                joint("rb", "revolute", &format!("{b}.B"), &format!("{a}.B"));
                joint("rc", "revolute", &format!("ground.P{k}"), &format!("{b}.A"));
                tip = format!("{b}.B");
            }
            // A rod to a slider.
            1 => {
                body("a", 0.6 + 0.2 * size, &estimate);
                body("b", 0.1, &format!("[{}, 0.02, 0]", pivot + 0.3));
                joint("ra", "revolute", &tip, &format!("{a}.A"));
                joint("rb", "revolute", &format!("{a}.B"), &format!("{b}.A"));
                joint(
                    "t",
                    "translational",
                    &format!("ground.P{k}"),
                    &format!("{b}.A"),
                );
                tip = format!("{b}.B");
            }
            // A rod that slides through a swivel on ground.
            2 => {
                body("a", 0.9, &estimate);
                body("b", 0.1, &format!("[{pivot}, 0.0, 0]"));
                joint("ra", "revolute", &tip, &format!("{a}.A"));
                joint("rb", "revolute", &format!("ground.P{k}"), &format!("{b}.A"));
                joint("t", "translational", &format!("{a}.A"), &format!("{b}.A"));
                tip = format!("{b}.B");
            }
            // A wheel on the crank's body, geared to a wheel that is pinned to ground.
            _ => {
                body("a", 0.2, &format!("[{pivot}, 0, 0]"));
                joint("ra", "revolute", &format!("ground.P{k}"), &format!("{a}.A"));
                let _ = writeln!(
                    joints,
                    "g{k} = {{ type = \"belt\", markers = [\"{tip}\", \"{a}.A\"], radii = [0.1, {}] }}",
                    0.1 + 0.1 * size
                );
                tip = format!("{a}.B");
            }
        }
    }
    format!(
        "format = 1\nname = \"grown\"\n[ground.markers]\n{ground}{bodies}[joints]\n{joints}\
         [drivers]\nturn = {{ coordinate = \"angle\", markers = [\"ground.O\", \"crank.A\"], \
         start = 0.3 }}\n"
    )
}

#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) kind: u32,
    pub(super) size: f64,
    pub(super) frame: f64,
}

pub(super) fn part() -> impl Strategy<Value = Part> {
    (0..4_u32, 0.0..1.0_f64, -0.2..0.2_f64).prop_map(|(kind, size, frame)| Part {
        kind,
        size,
        frame,
    })
}

proptest! {
    #[test]
    fn random_mechanisms_agree(parts in prop::collection::vec(part(), 1..5), step in -0.4..0.4_f64) {
        let text = grown(&parts);
        let (mechanism, _) = Mechanism::parse(&Source::new("test.toml", &text))
            .unwrap_or_else(|diagnostics| panic!("{text}: {diagnostics:#?}"));
        let mut path = Path::new(&mechanism);
        let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
        // Some of them do not close.
        prop_assume!(solver.assemble(&path).is_ok());
        let driver = Jet::new(0.0, [1.3, -0.7]);
        for _ in 0..5 {
            // Near a singular position both sides are equally uncertain, and next to a change point
            // the solver is the more accurate one.
            if solver.rcond() > 1e-4 && solver.pose().crossings.is_empty() {
                check(&mut solver, &[driver], &text);
            }
            move_on(&mut solver, &mut path, step);
        }
    }
}
