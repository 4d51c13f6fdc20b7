//! Changes of a mechanism that leave its forces as they are, or change them by a known rule: moved
//! as a whole, with the markers of its joints exchanged, enlarged, backwards in time.

use std::sync::Arc;

use biela::kinematics::{DriverPath, ForceParts, ForceQuantity, KnownMotion, Origin, Path, Solver};
use biela::mechanism::{
    CoordinateKind, DriverId, DriverSource, Expression, ForceLaw, Jet, JointKind, Load, Marker,
    MarkerId, Mechanism, ShapeForm,
};
use nalgebra::{Rotation2, Vector2};
use proptest::prelude::*;

use crate::common::stems;
use crate::forces::loaded::{Loaded, loaded, spread};

/// Rounding errors of a sum of forces, relative to the largest one: those of a few terms per body.
const ROUNDING: f64 = 1e-14;

/// A pose and rates of all drivers, relative to a mechanism's own.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    shift: f64,
    speed: f64,
    acceleration: f64,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    (-1.0..1.0, -2.0..2.0, -3.0..3.0).prop_map(|(shift, speed, acceleration)| Drawn {
        shift,
        speed,
        acceleration,
    })
}

/// Factors of lengths, masses and times.
#[derive(Clone, Copy, Debug)]
struct Scale {
    length: f64,
    mass: f64,
    time: f64,
}

const SAME: Scale = Scale {
    length: 1.0,
    mass: 1.0,
    time: 1.0,
};

impl Scale {
    fn force(self) -> f64 {
        self.mass * self.length / self.time.powi(2)
    }

    /// Returns the factor of a coordinate.
    fn coordinate(self, kind: CoordinateKind) -> f64 {
        if kind.is_angle() { 1.0 } else { self.length }
    }

    /// Returns the factor of the effort along a coordinate: effort times coordinate is work.
    fn effort(self, kind: CoordinateKind) -> f64 {
        self.force() * self.length / self.coordinate(kind)
    }
}

/// Returns a shipped mechanism with loads whose sizes are numbers, and with inputs as drivers.
fn base(name: &str) -> Mechanism {
    let mut mechanism = loaded(name);
    // Forces that a file prescribes by a formula do not follow the rules of this file.
    mechanism
        .forces
        .retain(|force| force.name.starts_with("load_"));
    mechanism.inputs.clear();
    let mut solver = Solver::new(Arc::new(mechanism.clone())).expect("the drivers match");
    solver
        .assemble(&Path::new(&mechanism))
        .expect("it assembles");
    for (driver, &start) in mechanism.drivers.iter_mut().zip(&solver.pose().drivers) {
        driver.source = DriverSource::Input { start };
    }
    mechanism
}

/// Changes an expression over the default parameters to a number.
fn change(expression: &mut Expression, to: impl Fn(f64) -> f64, parameters: &[f64]) {
    let value = expression.evaluate(&|p| parameters[p.index()], 0.0);
    *expression = Expression::constant(to(value));
}

/// Moves a mechanism as drawn, and solves its forces; nothing if the way there is blocked.
fn solve(mechanism: Mechanism, drawn: Drawn, scale: Scale, inputs: &[f64]) -> Option<Loaded> {
    let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
    let mechanism = Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    solver.assemble(&path).expect("it assembles");
    let mut driver_rates = Vec::new();
    for (index, driver) in mechanism.drivers.iter().enumerate() {
        let kind = driver.coordinate.kind;
        let most = if kind.is_angle() { 0.2 } else { 0.004 };
        let factor = scale.coordinate(kind);
        let now = solver.pose().drivers[index];
        path.driver_paths[index] = DriverPath::held(now + most * factor * drawn.shift, now);
        let unlike = 0.5 + spread(index);
        driver_rates.push(Jet::new(
            0.0,
            [
                unlike * drawn.speed * factor / scale.time,
                unlike * drawn.acceleration * factor / scale.time.powi(2),
            ],
        ));
    }
    solver.track(&path).ok()?;
    Some(Loaded::solved(solver, driver_rates, inputs.to_vec()))
}

fn inputs(mechanism: &Mechanism) -> Vec<f64> {
    let count = mechanism.force_inputs().len();
    (0..count).map(|k| 5.0 * spread(k) - 2.0).collect()
}

/// A scalar result, and the factor that a scale gives it.
fn scalars(mechanism: &Mechanism, scale: Scale) -> Vec<(ForceQuantity, f64)> {
    let mut all = Vec::new();
    let work = scale.force() * scale.length;
    for (index, driver) in mechanism.drivers.iter().enumerate() {
        let (id, kind) = (DriverId(index), driver.coordinate.kind);
        let effort = scale.effort(kind);
        let acceleration = scale.coordinate(kind) / scale.time.powi(2);
        all.extend([
            (ForceQuantity::Effort(id), effort),
            (ForceQuantity::Bias(id), effort),
            (ForceQuantity::Inertia(id), effort / acceleration),
            (ForceQuantity::Power(id), work / scale.time),
        ]);
    }
    for (index, held) in mechanism.constraints.iter().enumerate() {
        let factor = scale.effort(held.coordinate.kind);
        all.push((ForceQuantity::Held(index), factor));
    }
    for (index, force) in mechanism.forces.iter().enumerate() {
        let applied = |k| ForceQuantity::Applied(index, k);
        match &force.load {
            Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                all.push((applied(0), scale.effort(coordinate.kind)));
            }
            Load::Marker { .. } => {
                all.extend([(applied(0), scale.force()), (applied(1), scale.force())]);
                all.push((applied(2), work));
            }
        }
    }
    all.extend([
        (ForceQuantity::KineticEnergy, work),
        (ForceQuantity::PotentialEnergy, work),
    ]);
    all
}

/// Compares two solutions.
struct Comparison {
    base: Loaded,
    other: Loaded,
    /// Joints and constraints whose reactions redundant constraints leave open.
    open: Vec<Origin>,
    /// Result, value and expected value.
    rows: Vec<(String, f64, f64)>,
}

impl Comparison {
    fn new(mut base: Loaded, other: Loaded) -> Self {
        let open = base.solver.indeterminate();
        Self {
            base,
            other,
            open,
            rows: Vec::new(),
        }
    }

    fn mechanism(&self) -> Arc<Mechanism> {
        Arc::clone(self.base.solver.mechanism())
    }

    /// Expects scalar results times their factors, those left open excepted.
    fn scalars(&mut self, scale: Scale, rule: impl Fn(ForceQuantity, f64) -> f64) {
        for (quantity, factor) in scalars(&self.mechanism(), scale) {
            if let ForceQuantity::Held(index) = quantity
                && self.open.contains(&Origin::Constraint(index))
            {
                continue;
            }
            let expected = rule(quantity, self.base.forces.value(quantity));
            let found = self.other.forces.value(quantity) / factor;
            self.rows.push((format!("{quantity:?}"), found, expected));
        }
    }

    /// Expects the reactions that `rule` makes of force and torque of each joint; those found are
    /// divided by the scale's factors.
    fn reactions(
        &mut self,
        scale: Scale,
        rule: impl Fn(usize, Vector2<f64>, f64) -> (Vector2<f64>, f64),
    ) {
        for (index, joint) in self.mechanism().joints.iter().enumerate() {
            if self.open.contains(&Origin::Joint(index)) {
                continue;
            }
            let of = |loaded: &Loaded| {
                [0, 1, 2].map(|k| loaded.forces.value(ForceQuantity::Reaction(index, k)))
            };
            let [x, y, torque] = of(&self.base);
            let force = Vector2::new(x, y);
            let (force, torque) = match joint.kind {
                // A tension has no direction.
                JointKind::Rope(_) => (force, torque),
                _ => rule(index, force, torque),
            };
            let found = of(&self.other);
            let factors = [scale.force(), scale.force(), scale.force() * scale.length];
            for (k, expected) in [force.x, force.y, torque].into_iter().enumerate() {
                let label = format!("{}, component {k}", joint.name);
                self.rows.push((label, found[k] / factors[k], expected));
            }
        }
    }

    /// Checks all rows. The condition loses digits of the pose, and once more of the forces there;
    /// both solutions have rounding errors.
    fn check(mut self, name: &str) -> Result<(), TestCaseError> {
        let largest = self
            .rows
            .iter()
            .fold(0.0, |most: f64, (_, _, v)| most.max(v.abs()));
        let bodies = self.mechanism().bodies.len() as f64;
        let limit = 2.0 * ROUNDING / self.base.solver.rcond().powi(2) * largest * (1.0 + bodies);
        for (what, found, expected) in &self.rows {
            prop_assert!(
                (found - expected).abs() <= limit,
                "{name}: {what}: {found}, not {expected}, of {largest}"
            );
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3))]

    /// The whole mechanism is turned and moved, and gravity turned with it: what drivers exert is
    /// the same, reactions turn, and the potential energy changes by the weight's way.
    #[test]
    fn forces_turn_with_the_mechanism(
        drawn in drawn(),
        angle in -3.0..3.0_f64,
        way in [-1.0..1.0_f64, -1.0..1.0_f64],
    ) {
        let turn = Rotation2::new(angle);
        for name in stems("mechanisms", "toml") {
            let base = base(&name);
            let parameters = base.default_parameters();
            let number = |e: &Expression| e.evaluate(&|p| parameters[p.index()], 0.0);
            let lengths = base.markers.iter().flat_map(|marker| &marker.position);
            let size = lengths.map(|x| number(x).abs()).fold(0.0, f64::max);
            let way = Vector2::from(way) * size;
            let mut moved = base.clone();
            let place = |[x, y]: [&mut Expression; 2]| {
                let at = turn * Vector2::new(number(x), number(y)) + way;
                (*x, *y) = (Expression::constant(at.x), Expression::constant(at.y));
            };
            for marker in moved.markers.iter_mut().filter(|marker| marker.body.is_none()) {
                let [x, y] = &mut marker.position;
                place([x, y]);
                change(&mut marker.angle, |own| own + angle, &parameters);
            }
            for body in &mut moved.bodies {
                let [x, y, phi] = &mut body.estimate;
                place([x, y]);
                change(phi, |phi| phi + angle, &parameters);
            }
            let gravity = Vector2::from(base.simulation.gravity.each_ref().map(number));
            let turned = turn * gravity;
            moved.simulation.gravity = [turned.x, turned.y].map(Expression::constant);
            // Forces along the axes of ground turn with them.
            let axes = MarkerId(moved.markers.len());
            moved.markers.push(Marker {
                name: "turned_axes".to_owned(),
                body: None,
                position: [0.0, 0.0].map(Expression::constant),
                angle: Expression::constant(angle),
            });
            for force in &mut moved.forces {
                if let Load::Marker { axes: none @ None, .. } = &mut force.load {
                    *none = Some(axes);
                }
            }
            for index in 0..moved.joints.len() {
                if let Some(ratio) = ratio_on_ground(&moved.joints[index].kind, &number) {
                    // Wheels on ground count angles from ground's own axis, which does not turn:
                    // θ_j + angle = ratio (θ_i + angle) with another phase of the second wheel.
                    let mut phased = moved.markers[moved.joints[index].to.index()].clone();
                    change(&mut phased.angle, |own| own + (ratio - 1.0) * angle, &parameters);
                    moved.joints[index].to = MarkerId(moved.markers.len());
                    moved.markers.push(phased);
                }
            }
            let masses = base.bodies.iter().map(|body| body.mass.as_ref().map_or(0.0, number));
            let weight: f64 = masses.sum();
            let inputs = inputs(&base);
            let solved = solve(base, drawn, SAME, &inputs).zip(solve(moved, drawn, SAME, &inputs));
            let Some((base, moved)) = solved else { continue };
            let mut comparison = Comparison::new(base, moved);
            comparison.scalars(SAME, |quantity, value| match quantity {
                ForceQuantity::PotentialEnergy => value - weight * turned.dot(&way),
                _ => value,
            });
            comparison.reactions(SAME, |_, force, torque| (turn * force, torque));
            comparison.check(&name)?;
        }
    }

    /// The other body of a joint bears the opposite: force, and moment about the point at which it
    /// is given.
    #[test]
    fn exchanged_markers_turn_the_signs_of_reactions(drawn in drawn()) {
        for name in stems("mechanisms", "toml") {
            let base = base(&name);
            let is_symmetric = |kind: &JointKind| {
                matches!(
                    kind,
                    JointKind::Revolute
                        | JointKind::Translational
                        | JointKind::Link { .. }
                        | JointKind::Weld
                )
            };
            let mut exchanged = base.clone();
            for joint in exchanged.joints.iter_mut().filter(|joint| is_symmetric(&joint.kind)) {
                std::mem::swap(&mut joint.from, &mut joint.to);
            }
            let inputs = inputs(&base);
            let solved =
                solve(base, drawn, SAME, &inputs).zip(solve(exchanged, drawn, SAME, &inputs));
            let Some((base, exchanged)) = solved else { continue };
            let mechanism = Arc::clone(base.solver.mechanism());
            let arms: Vec<Vector2<f64>> = (mechanism.joints.iter())
                .map(|joint| {
                    let [from, to] = [joint.from, joint.to].map(|marker| {
                        let [x, y] = base.solver.marker(marker, &base.rates);
                        Vector2::new(x.value, y.value)
                    });
                    to - from
                })
                .collect();
            let mut comparison = Comparison::new(base, exchanged);
            comparison.scalars(SAME, |_, value| value);
            comparison.reactions(SAME, |index, force, torque| {
                if is_symmetric(&mechanism.joints[index].kind) {
                    (-force, -(torque + arms[index].perp(&force)))
                } else {
                    (force, torque)
                }
            });
            comparison.check(&name)?;
        }
    }

    /// Lengths, masses and times in other units.
    #[test]
    fn forces_have_their_dimensions(
        drawn in drawn(),
        [length, mass, time] in [0.05..20.0_f64, 0.05..20.0_f64, 0.05..20.0_f64],
    ) {
        let scale = Scale { length, mass, time };
        for name in stems("mechanisms", "toml") {
            let base = base(&name);
            let mut scaled = base.clone();
            let Some(()) = enlarge(&mut scaled, scale) else { continue };
            let given = inputs(&base);
            let mut units = base.forces.iter().filter(|force| force.load.is_input());
            let factors = units.by_ref().flat_map(|force| match &force.load {
                Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                    vec![scale.effort(coordinate.kind)]
                }
                Load::Marker { .. } => vec![scale.force(), scale.force(), scale.force() * length],
            });
            let larger: Vec<f64> = given.iter().zip(factors).map(|(u, factor)| u * factor).collect();
            let solved =
                solve(base, drawn, SAME, &given).zip(solve(scaled, drawn, scale, &larger));
            let Some((base, scaled)) = solved else { continue };
            let mut comparison = Comparison::new(base, scaled);
            comparison.scalars(scale, |_, value| value);
            comparison.reactions(scale, |_, force, torque| (force, torque));
            comparison.check(&name)?;
        }
    }

    /// With all velocities reversed, and dampers that feed what they took, forces are the same and
    /// powers reversed.
    #[test]
    fn forces_are_the_same_backwards_in_time(drawn in drawn()) {
        for name in stems("mechanisms", "toml") {
            let base = base(&name);
            let parameters = base.default_parameters();
            let mut reversed = base.clone();
            for force in &mut reversed.forces {
                if let Load::Coordinate { law: Some(law), .. } = &mut force.load {
                    law.damping
                        .iter_mut()
                        .for_each(|damping| change(damping, |d| -d, &parameters));
                }
            }
            let inputs = inputs(&base);
            let back = Drawn { speed: -drawn.speed, ..drawn };
            let solved = solve(base, drawn, SAME, &inputs).zip(solve(reversed, back, SAME, &inputs));
            let Some((base, reversed)) = solved else { continue };
            let mut comparison = Comparison::new(base, reversed);
            comparison.scalars(SAME, |quantity, value| match quantity {
                ForceQuantity::Power(_) => -value,
                _ => value,
            });
            comparison.reactions(SAME, |_, force, torque| (force, torque));
            comparison.check(&name)?;
        }
    }
}

/// Returns the ratio of gears and belts whose wheels turn on ground.
fn ratio_on_ground(kind: &JointKind, number: &impl Fn(&Expression) -> f64) -> Option<f64> {
    let (sizes, same_sense) = match kind {
        JointKind::Gear {
            sizes,
            internal,
            carrier: None,
            ..
        } => (sizes, *internal),
        JointKind::Belt {
            sizes,
            crossed,
            carrier: None,
            ..
        } => (sizes, !*crossed),
        _ => return None,
    };
    let [first, second] = sizes.expressions().each_ref().map(number);
    Some(if same_sense { first } else { -first } / second)
}

/// Multiplies all lengths, masses and times; nothing for cams, couplings and curves, which are
/// formulas.
fn enlarge(mechanism: &mut Mechanism, scale: Scale) -> Option<()> {
    let parameters = mechanism.default_parameters();
    let times = |expression: &mut Expression, factor: f64| {
        change(expression, |value| value * factor, &parameters);
    };
    let Scale { length, mass, time } = scale;
    for position in mechanism.markers.iter_mut().flat_map(|m| &mut m.position) {
        times(position, length);
    }
    for body in &mut mechanism.bodies {
        let [x, y, _] = &mut body.estimate;
        [x, y].into_iter().for_each(|x| times(x, length));
        body.mass.iter_mut().for_each(|m| times(m, mass));
        let inertia = mass * length * length;
        body.inertia.iter_mut().for_each(|j| times(j, inertia));
        let center = body.center.iter_mut().flatten();
        center.for_each(|x| times(x, length));
    }
    for joint in &mut mechanism.joints {
        match &mut joint.kind {
            JointKind::Link { length: own }
            | JointKind::RevoluteTranslational { offset: own }
            | JointKind::RackAndPinion { radius: own, .. }
            | JointKind::Rolling { radius: own, .. } => times(own, length),
            // Formulas.
            JointKind::Cam { .. } | JointKind::Coupling(_) | JointKind::Curve(_) => return None,
            // A ratio.
            JointKind::Gear { .. } | JointKind::Belt { .. } => {}
            JointKind::Rope(rope) => {
                times(&mut rope.length, length);
                let pulleys = rope.points.iter_mut().filter_map(|p| p.pulley.as_mut());
                pulleys.for_each(|pulley| times(&mut pulley.radius, length));
            }
            JointKind::Revolute | JointKind::Translational | JointKind::Slot | JointKind::Weld => {}
        }
    }
    for shape in &mut mechanism.shapes {
        match &mut shape.form {
            ShapeForm::Disc { radius, .. }
            | ShapeForm::Bar { radius, .. }
            | ShapeForm::Hole { radius, .. }
            | ShapeForm::Wall { depth: radius, .. } => times(radius, length),
            ShapeForm::Outline { radius, fillet, .. } => {
                let sizes = [radius, fillet].into_iter().flatten();
                sizes.for_each(|size| times(size, length));
            }
        }
    }
    for stop in &mut mechanism.stops {
        let factor = scale.coordinate(stop.coordinate.kind);
        let limits = [&mut stop.min, &mut stop.max].into_iter().flatten();
        limits.for_each(|limit| times(limit, factor));
    }
    for held in &mut mechanism.constraints {
        times(&mut held.value, scale.coordinate(held.coordinate.kind));
    }
    for driver in &mut mechanism.drivers {
        if let DriverSource::Input { start } = &mut driver.source {
            *start *= scale.coordinate(driver.coordinate.kind);
        }
    }
    for force in &mut mechanism.forces {
        match &mut force.load {
            Load::Coordinate {
                coordinate,
                law: Some(law),
            } => {
                let ForceLaw {
                    value,
                    spring,
                    damping,
                    stop: None,
                    friction: None,
                    is_constant: _,
                } = law
                else {
                    unreachable!("no shipped mechanism has these");
                };
                let (own, effort) = (
                    scale.coordinate(coordinate.kind),
                    scale.effort(coordinate.kind),
                );
                value.iter_mut().for_each(|f| times(f, effort));
                damping
                    .iter_mut()
                    .for_each(|d| times(d, effort * time / own));
                if let Some(spring) = spring {
                    times(&mut spring.stiffness, effort / own);
                    times(&mut spring.free, own);
                }
            }
            Load::Marker {
                law: Some([x, y, torque]),
                ..
            } => {
                [x, y].into_iter().for_each(|f| times(f, scale.force()));
                times(torque, scale.force() * length);
            }
            _ => {}
        }
    }
    let acceleration = length / (time * time);
    for g in &mut mechanism.simulation.gravity {
        times(g, acceleration);
    }
    Some(())
}

/// Which results are sought together is no matter of the host's: the bits are the same.
#[test]
fn reactions_alone_have_the_bits_of_all_forces_together() {
    for name in stems("mechanisms", "toml") {
        let mut all = Loaded::new(loaded(&name));
        let quantities = (0..all.solver.mechanism().joints.len())
            .flat_map(|joint| [0, 1, 2].map(|k| ForceQuantity::Reaction(joint, k)));
        let read = |all: &Loaded| {
            let values = quantities
                .clone()
                .map(|quantity| all.forces.value(quantity));
            values.map(f64::to_bits).collect::<Vec<u64>>()
        };
        let together = read(&all);
        let Loaded {
            solver,
            rates,
            driver_rates,
            inputs,
            forces,
        } = &mut all;
        let motion = KnownMotion {
            rates,
            driver_rates,
            inputs,
        };
        let reactions = ForceParts {
            efforts: false,
            reactions: true,
        };
        let solved = solver.solve_forces(motion, reactions, forces);
        solved.expect("forces have values");
        assert_eq!(read(&all), together, "{name}");
    }
}
