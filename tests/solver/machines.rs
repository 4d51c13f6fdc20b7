//! Machines as a workshop has them, over their range, against closed forms.

use std::f64::consts::PI;

use biela::kinematics::{DriverPath, Path, Solver};

use crate::common::{assembled, parse};

/// Rounding of some closed loops after another, with condition numbers up to ten.
const TOLERANCE: f64 = 1e-12;

/// A machine that is moved.
struct Machine {
    solver: Solver,
    path: Path,
}

impl Machine {
    fn new(text: &str) -> Self {
        let (solver, path) = assembled(&parse(text));
        Self { solver, path }
    }

    /// Moves the drivers to values.
    fn drive(&mut self, values: &[f64]) {
        self.solver.pose().set_path(&mut self.path);
        for (index, value) in values.iter().enumerate() {
            let from = self.solver.pose().drivers[index];
            self.path.driver_paths[index] = DriverPath::held(*value, from);
        }
        self.solver
            .track(&self.path)
            .expect("nothing is in the way");
    }

    /// Returns x, y and angle of a body.
    fn body(&self, name: &str) -> [f64; 3] {
        let body = self.solver.mechanism().body_id(name).expect("it has one");
        let first = 3 * body.index();
        [0, 1, 2].map(|k| self.solver.pose().q[first + k])
    }

    /// Checks place and angle of a body, whole turns apart.
    fn check(&self, name: &str, [x, y, phi]: [f64; 3]) {
        let is = self.body(name);
        let turned = (is[2] - phi + PI).rem_euclid(2.0 * PI) - PI;
        for off in [is[0] - x, is[1] - y, turned] {
            assert!(
                off.abs() < TOLERANCE,
                "{name}: {is:?}, not {:?}",
                [x, y, phi]
            );
        }
    }
}

/// Returns values spread evenly from one end to the other.
fn spread([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    const COUNT: u32 = 60;
    (0..=COUNT).map(move |k| from + (to - from) * f64::from(k) / f64::from(COUNT))
}

/// Returns the angle between the sides of a triangle that are not the third one.
fn angle_between(a: f64, b: f64, third: f64) -> f64 {
    ((a * a + b * b - third * third) / (2.0 * a * b)).acos()
}

fn at([x, y]: [f64; 2], length: f64, angle: f64) -> [f64; 2] {
    [x + length * angle.cos(), y + length * angle.sin()]
}

fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    f64::atan2(to[1] - from[1], to[0] - from[0])
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    f64::hypot(b[0] - a[0], b[1] - a[1])
}

/// Returns the point at distances from two points, on the left of the way from the first to the
/// second.
fn corner(a: [f64; 2], from_a: f64, b: [f64; 2], from_b: f64) -> [f64; 2] {
    at(
        a,
        from_a,
        direction(a, b) + angle_between(from_a, apart(a, b), from_b),
    )
}

#[test]
fn a_derailleur_keeps_its_cage_upright() {
    let mut machine = Machine::new(include_str!("machines/derailleur.toml"));
    let stop = [0.038, -0.006];
    for cable in spread([0.030, 0.046]) {
        machine.drive(&[cable]);
        // Pivot, stop and clamp, which is below the line to the stop.
        let angle = direction([0.0; 2], stop) - angle_between(0.012, apart([0.0; 2], stop), cable);
        let [x, y] = at([0.0; 2], 0.042, angle);
        machine.check("inner", [0.0, 0.0, angle]);
        machine.check("cage", [x, y, 0.0]);
    }
}

#[test]
fn a_desk_lamp_keeps_its_head_level() {
    let mut machine = Machine::new(include_str!("machines/desk_lamp.toml"));
    for part in spread([0.0, 1.0]) {
        let [shoulder, elbow] = [110.0 - 60.0 * part, 20.0 - 70.0 * part].map(f64::to_radians);
        machine.drive(&[shoulder, elbow]);
        let [x, y] = at([0.0; 2], 0.40, shoulder);
        machine.check("elbow", [x, y, 0.0]);
        let [x, y] = at([x, y], 0.35, elbow);
        machine.check("head", [x, y, 0.0]);
    }
}

#[test]
fn a_hospital_bed_lifts_back_and_knee() {
    let mut machine = Machine::new(include_str!("machines/hospital_bed.toml"));
    for part in spread([0.0, 1.0]) {
        let [back, leg] = [0.40 + 0.30 * part, 0.60 + 0.10 * part];
        machine.drive(&[back, leg]);
        // Hip, foot of the actuator and lug; the lug stands off the section's own axis.
        let lug = [-0.45, -0.05];
        let foot = [-0.20, -0.25];
        let [to_lug, to_foot] = [lug, foot].map(|point| apart([0.0; 2], point));
        let angle = direction([0.0; 2], foot)
            - angle_between(to_lug, to_foot, back)
            - direction([0.0; 2], lug);
        machine.check("backrest", [0.0, 0.0, angle]);
        let (lug, foot) = ([0.20, -0.05], [0.75, -0.25]);
        let [to_lug, to_foot] = [lug, foot].map(|point| apart([0.0; 2], point));
        let angle = direction([0.0; 2], foot) + angle_between(to_lug, to_foot, leg)
            - direction([0.0; 2], lug);
        machine.check("thigh", [0.0, 0.0, angle]);
        // A slider–crank.
        let [x, y] = at([0.0; 2], 0.40, angle);
        let heel = x + (0.60_f64.powi(2) - y * y).sqrt();
        machine.check("calf", [x, y, direction([x, y], [heel, 0.0])]);
        machine.check("roller", [heel, 0.0, 0.0]);
    }
}

#[test]
fn a_klann_linkage_makes_its_step() {
    let mut machine = Machine::new(include_str!("machines/klann.toml"));
    let (lower, upper) = ([-0.590, -0.176], [-0.233, 0.616]);
    for crank in spread([PI, 3.0 * PI]) {
        machine.drive(&[crank]);
        let pin = at([0.0; 2], 0.268, crank);
        let c = corner(lower, 0.317, pin, 0.590);
        let rod = direction(pin, c);
        machine.check("rod", [pin[0], pin[1], rod]);
        machine.check("lower_rocker", [lower[0], lower[1], direction(lower, c)]);
        let bend = direction([0.0; 2], [1.099, -0.116]);
        let d = at(pin, f64::hypot(1.099, 0.116), rod + bend);
        let f = corner(d, 0.897, upper, 0.516);
        machine.check("leg", [f[0], f[1], direction(f, d)]);
    }
}

#[test]
fn a_rhombic_drive_moves_its_yokes_straight() {
    let mut machine = Machine::new(include_str!("machines/rhombic_drive.toml"));
    for part in spread([0.0, 1.0]) {
        let angle = 70.0_f64.to_radians() + 2.0 * PI * part;
        machine.drive(&[angle]);
        let aside = 0.03 + 0.012 * angle.cos() - 0.01;
        let (pin, rod) = (
            0.012 * angle.sin(),
            (0.05_f64.powi(2) - aside * aside).sqrt(),
        );
        machine.check("right_gear", [0.03, 0.0, angle]);
        machine.check("left_gear", [-0.03, 0.0, -angle]);
        machine.check("piston", [0.0, pin + rod, 0.0]);
        machine.check("displacer", [0.0, pin - rod, 0.0]);
    }
}
