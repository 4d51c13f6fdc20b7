//! The largest effort and reaction over the range of a driver.

use std::fmt::Write as _;

use super::with_unit;
use crate::kinematics::{
    Element, ForceParts, ForceQuantity, KnownMotion, Range, Rates, Reported, Solver,
};
use crate::mechanism::{DriverId, Jet, shown};

/// A largest value and the driver's value there.
type Largest = Option<(f64, f64)>;

/// Part of the largest effort that a reaction of rounding alone has at most, such as that of a pin
/// beside the one that a spring and its driver load.
const ROUNDING: f64 = 1e-12;

/// Adds the largest effort of a driver that moves at a constant speed \[m/s or rad/s\] over its
/// range, and the largest force in a joint. The pose is restored. Poses without forces, such as
/// dead points, are left out.
pub(super) fn describe_largest(
    text: &mut String,
    solver: &mut Solver,
    driver: DriverId,
    range: &Range,
    speed: f64,
) {
    let home = solver.pose().clone();
    let mechanism = std::sync::Arc::clone(solver.mechanism());
    let open = solver.indeterminate();
    let is_determinate = |joint: &usize| !open.contains(&Element::Joint(*joint));
    let pins = (0..mechanism.joints.len())
        .filter(|&joint| Reported::of(&mechanism.joints[joint].kind).has(0))
        .filter(is_determinate);
    let pins: Vec<usize> = pins.collect();
    let mut forces = solver.forces();
    let inputs = vec![0.0; forces.inputs()];
    let mut driver_rates = vec![Jet::constant(0.0); mechanism.drivers.len()];
    driver_rates[driver.index()].derivatives[0] = speed;
    let mut rates = Rates::new(home.q.len());
    let mut effort: Largest = None;
    let mut reaction: Option<(f64, f64, usize)> = None;
    let mut pose = home.clone();
    for sample in &range.samples {
        pose.q.copy_from_slice(&sample.q);
        pose.drivers[driver.index()] = sample.driver;
        solver.restore(&pose);
        let solved = solver.solve_rates(|driver| driver_rates[driver.index()], &mut rates);
        let motion = KnownMotion {
            rates: &rates,
            driver_rates: &driver_rates,
            inputs: &inputs,
        };
        let solved =
            solved.and_then(|()| solver.solve_forces(motion, ForceParts::ALL, &mut forces));
        if solved.is_err() {
            continue;
        }
        let here = forces.value(ForceQuantity::Effort(driver));
        if effort.is_none_or(|(most, _)| here.abs() > most.abs()) {
            effort = Some((here, sample.driver));
        }
        for &joint in &pins {
            let [x, y] = [0, 1].map(|k| forces.value(ForceQuantity::Reaction(joint, k)));
            let here = x.hypot(y);
            if reaction.is_none_or(|(most, ..)| here > most) {
                reaction = Some((here, sample.driver, joint));
            }
        }
    }
    solver.restore(&home);
    let kind = mechanism.drivers[driver.index()].coordinate.kind;
    let moving = if speed == 0.0 {
        "at rest".to_owned()
    } else {
        let unit = if kind.is_angle() { "rad/s" } else { "m/s" };
        format!("at {} {unit}", shown(speed))
    };
    let most = effort.map_or(0.0, |(effort, _)| effort.abs());
    if let Some((effort, at)) = effort {
        let (effort, unit) = (shown(effort), kind.effort_unit().name);
        let at = with_unit(kind, at);
        let _ = writeln!(text, "  {moving}, largest effort {effort} {unit}, at {at}");
    }
    if let Some((force, at, joint)) = reaction
        && force > ROUNDING * most
    {
        let (force, at) = (shown(force), with_unit(kind, at));
        let joint = &mechanism.joints[joint].name;
        let _ = writeln!(
            text,
            "  {moving}, largest force in joint `{joint}` {force} N, at {at}"
        );
    }
}
