//! Mechanisms, solvers and instances of them.

#![allow(dead_code, reason = "each test file uses a part of this")]

pub(crate) mod exact;
pub(crate) mod log;
pub(crate) mod mechanisms;

use std::path::PathBuf;
use std::sync::Arc;

use biela::fmi::{Category, Interface, MechanismModel, MechanismState, Quantity, Sink, Status};
use biela::kinematics::{DriverPath, Error, Path, Solver};
use biela::mechanism::{Expression, Mechanism, Source};

pub(crate) type Instance = biela::fmi::Instance<MechanismModel>;
pub(crate) type FmuState = biela::fmi::FmuState<MechanismState>;

/// A log that nobody reads.
struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, _: &str) {}
}

/// A new instance of a mechanism that assembles.
pub(crate) fn instance_of(mechanism: Arc<Mechanism>, interface: Interface) -> Instance {
    let model = MechanismModel::new(mechanism, interface).expect("the mechanism assembles");
    Instance::new(model, Box::new(Silent), true)
}

/// A new instance of a shipped mechanism for co-simulation.
pub(crate) fn co_simulation(name: &str) -> Instance {
    instance_of(shipped(name), Interface::CoSimulation)
}

/// Returns the value references of the variables whose quantities `which` selects.
pub(crate) fn references(instance: &Instance, which: impl Fn(Quantity) -> bool) -> Vec<u32> {
    (1..)
        .zip(instance.variables())
        .filter(|(_, variable)| which(variable.quantity))
        .map(|(reference, _)| reference)
        .collect()
}

/// A folder of the project.
pub(crate) fn folder(name: &str) -> PathBuf {
    set_up::root().join(name)
}

/// The text of a file of the project.
pub(crate) fn text(name: &str) -> String {
    std::fs::read_to_string(folder(name)).expect("the file is part of the project")
}

/// The names, without their extension, of the files of a folder that have it, in order.
pub(crate) fn stems(name: &str, extension: &str) -> Vec<String> {
    let mut stems: Vec<_> = std::fs::read_dir(folder(name))
        .expect("the folder is part of the project")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .map(|path| {
            let stem = path.file_stem().expect("files have names");
            stem.to_str().expect("names are ASCII").to_owned()
        })
        .collect();
    stems.sort();
    stems
}

/// Reads a shipped mechanism.
pub(crate) fn shipped(name: &str) -> Arc<Mechanism> {
    let path = folder("mechanisms").join(format!("{name}.toml"));
    let source = Source::open(name, &path).expect("shipped mechanisms can be read");
    read(&source)
}

/// Reads a mechanism that has no errors.
pub(crate) fn parse(text: &str) -> Arc<Mechanism> {
    read(&Source::new("test.toml", text))
}

fn read(source: &Source) -> Arc<Mechanism> {
    match Mechanism::parse(source) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(diagnostics) => panic!("{diagnostics:#?}"),
    }
}

/// A solver at the file's own pose, and a path on which nothing moves from there.
pub(crate) fn assembled(mechanism: &Arc<Mechanism>) -> (Solver, Path) {
    let path = Path::new(mechanism);
    let mut solver = Solver::new(Arc::clone(mechanism)).expect("the drivers match");
    solver.assemble(&path).expect("the mechanism closes");
    (solver, path)
}

/// Assembles a mechanism; returns its solver, or why it cannot.
pub(crate) fn solve(text: &str) -> Result<Solver, Error> {
    let mechanism = parse(text);
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism)?;
    solver.assemble(&path)?;
    Ok(solver)
}

/// The text of a mechanism file with other estimates: `estimates` has, one after the other, the
/// header of each body's table and its line.
pub(crate) fn pasted(text: &str, estimates: &str) -> String {
    let mut out = text.to_owned();
    let mut lines = estimates.lines().filter(|line| !line.is_empty());
    while let (Some(header), Some(estimate)) = (lines.next(), lines.next()) {
        let start = out.find(header).expect("the body has a table");
        let start = start + out[start..].find('\n').expect("the table is not empty") + 1;
        let table = &out[start..];
        let end = start + table.find("\n[").map_or(table.len(), |end| end + 1);
        let old = out[start..end].lines();
        let others: String = old
            .filter(|line| !line.starts_with("estimate"))
            .flat_map(|line| [line, "\n"])
            .collect();
        out.replace_range(start..end, &format!("{estimate}\n{others}"));
    }
    out
}

/// Lays a path for the first driver, an input, to `target` in a straight line.
pub(crate) fn straight_to(solver: &Solver, path: &mut Path, target: f64) {
    let now = solver.pose().drivers[0];
    path.start = solver.pose().time;
    path.duration = 0.0;
    path.driver_paths[0] = DriverPath::Input {
        position: target,
        velocity: 0.0,
        acceleration: 0.0,
        jump: now - target,
    };
}

/// The mechanism with ground turned by `turn` and moved to `to`.
pub(crate) fn moved(mechanism: &Mechanism, turn: f64, to: [f64; 2]) -> Arc<Mechanism> {
    let mut moved = mechanism.clone();
    let parameters = mechanism.default_parameters();
    let value = |e: &Expression| e.evaluate(&|p| parameters[p.index()], 0.0_f64);
    let place = |[x, y]: [f64; 2]| {
        let (sin, cos) = turn.sin_cos();
        [cos * x - sin * y + to[0], sin * x + cos * y + to[1]].map(Expression::constant)
    };
    for marker in moved.markers.iter_mut().filter(|m| m.body.is_none()) {
        marker.position = place(marker.position.each_ref().map(value));
        marker.angle = Expression::constant(value(&marker.angle) + turn);
    }
    for body in &mut moved.bodies {
        let [x, y, phi] = body.estimate.each_ref().map(value);
        let [x, y] = place([x, y]);
        body.estimate = [x, y, Expression::constant(phi + turn)];
    }
    Arc::new(moved)
}
