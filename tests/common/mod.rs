//! Mechanisms together with their exact solutions.

#![allow(dead_code, reason = "each test file uses a part of this")]

pub(crate) mod log;

use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;

use biela::fmi::{Category, Interface, MechanismModel, MechanismState, Quantity, Sink, Status};
use biela::kinematics::{Curve, Path, Rates, Solver};
use biela::mechanism::{Expression, Jet, Mechanism, Source, Variable};

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

/// Returns the value references of the variables whose quantities `which` selects.
pub(crate) fn references(instance: &Instance, which: impl Fn(Quantity) -> bool) -> Vec<u32> {
    (1..)
        .zip(instance.variables())
        .filter(|(_, variable)| which(variable.quantity))
        .map(|(reference, _)| reference)
        .collect()
}

/// A shipped mechanism with one driver, and each of its generalized coordinates as a formula in
/// the driver's value `t`.
pub(crate) struct Exact {
    pub(crate) file: &'static str,
    /// Body, then x, y and phi. What stands in braces is replaced by the formula of that name.
    pub(crate) bodies: &'static [(&'static str, [&'static str; 3])],
    /// Formulas used by others, later ones using earlier ones.
    pub(crate) formulas: &'static [(&'static str, &'static str)],
    /// The driver's value goes from the first to the second over the motion.
    pub(crate) range: (f64, f64),
}

/// The angle of a dyad that closes a triangle comes from the law of cosines; the sign is the one
/// of the assembly mode of the file's estimates.
pub(crate) const EXACT: [Exact; 5] = [
    Exact {
        file: "pendulum",
        bodies: &[("rod", ["length/2*sin(t)", "-length/2*cos(t)", "t - pi/2"])],
        formulas: &[],
        range: (-2.0, 2.0),
    },
    Exact {
        file: "slider_crank",
        bodies: &[
            ("crank", ["0", "0", "t"]),
            (
                "connecting_rod",
                [
                    "{ax} + rod_length/2*cos({phi})",
                    "{ay} + rod_length/2*sin({phi})",
                    "{phi}",
                ],
            ),
            ("slider", ["{ax} + rod_length*cos({phi})", "offset", "0"]),
        ],
        formulas: &[
            ("ax", "crank_length*cos(t)"),
            ("ay", "crank_length*sin(t)"),
            ("phi", "asin((offset - {ay})/rod_length)"),
        ],
        range: (-1.0, 8.0),
    },
    Exact {
        file: "four_bar",
        bodies: &[
            ("crank", ["0", "0", "t"]),
            ("coupler", ["{ax}", "{ay}", "{coupler}"]),
            ("rocker", ["base", "0", "{rocker}"]),
        ],
        formulas: &[
            ("ax", "crank_length*cos(t)"),
            ("ay", "crank_length*sin(t)"),
            // The diagonal from the crank's pin to the rocker's pivot.
            ("d", "hypot(base - {ax}, {ay})"),
            ("delta", "atan2(-{ay}, base - {ax})"),
            (
                "coupler",
                "{delta} + acos(({d}^2 + coupler_length^2 - rocker_length^2)/(2*{d}*coupler_length))",
            ),
            (
                "rocker",
                "{delta} + pi - acos(({d}^2 + rocker_length^2 - coupler_length^2)/(2*{d}*rocker_length))",
            ),
        ],
        range: (0.5, 7.5),
    },
    Exact {
        file: "tlv",
        bodies: &[
            ("arm", ["0", "0", "{arm}"]),
            ("barrel", ["base", "0", "{barrel}"]),
            (
                "rod",
                ["arm_length*cos({arm})", "arm_length*sin({arm})", "{barrel}"],
            ),
        ],
        formulas: &[
            (
                "arm",
                "acos((base^2 + arm_length^2 - t^2)/(2*base*arm_length))",
            ),
            (
                "barrel",
                "atan2(arm_length*sin({arm}), arm_length*cos({arm}) - base)",
            ),
        ],
        range: (0.2, 0.6),
    },
    Exact {
        file: "tlv_crank",
        bodies: &[
            ("arm", ["0", "0", "t"]),
            ("barrel", ["base", "0", "{barrel}"]),
            (
                "rod",
                ["arm_length*cos(t)", "arm_length*sin(t)", "{barrel}"],
            ),
        ],
        // The barrel points to the left all the time; pi plus what it leans is continuous.
        formulas: &[(
            "barrel",
            "pi - atan2(arm_length*sin(t), base - arm_length*cos(t))",
        )],
        range: (-3.0, 9.0),
    },
];

/// A folder of the project.
pub(crate) fn folder(name: &str) -> PathBuf {
    FilePath::new(env!("CARGO_MANIFEST_DIR")).join(name)
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
    let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let source = Source::open(name, path.as_ref()).expect("shipped mechanisms can be read");
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
    path.curves[0] = Curve::Input {
        position: target,
        velocity: 0.0,
        acceleration: 0.0,
        jump: now - target,
    };
}

impl Exact {
    /// q, q̇ and q̈ for the driver's value, velocity and acceleration.
    pub(crate) fn solution(&self, mechanism: &Mechanism, driver: Jet) -> Vec<Jet> {
        let parameters = mechanism.default_parameters();
        self.bodies
            .iter()
            .flat_map(|(_, formulas)| formulas)
            .map(|formula| {
                let expression = mechanism
                    .parse_expression(&self.expand(formula), Some(Variable::Time))
                    .expect("the formula is right");
                expression.evaluate(&|p| Jet::constant(parameters[p.index()]), driver)
            })
            .collect()
    }

    fn expand(&self, formula: &str) -> String {
        let mut text = formula.to_owned();
        for (name, meaning) in self.formulas.iter().rev() {
            text = text.replace(&format!("{{{name}}}"), &format!("({meaning})"));
        }
        text
    }
}

/// Largest error of q, q̇ and q̈ at the solver's pose, and the largest magnitude of each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    pub(crate) error: [f64; 3],
    pub(crate) magnitude: [f64; 3],
}

impl Errors {
    pub(crate) fn collect(&mut self, solver: &Solver, rates: &Rates, exact: &[Jet]) {
        let q = &solver.pose().q;
        assert_eq!(q.len(), exact.len());
        for (k, exact) in exact.iter().enumerate() {
            let found = [q[k], rates.velocity()[k], rates.acceleration()[k]];
            let truth = [exact.value, exact.first(), exact.second()];
            for order in 0..3 {
                self.error[order] = self.error[order].max((found[order] - truth[order]).abs());
                self.magnitude[order] = self.magnitude[order].max(truth[order].abs());
            }
        }
    }

    pub(crate) fn relative(&self) -> [f64; 3] {
        [0, 1, 2].map(|order| self.error[order] / self.magnitude[order])
    }
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
