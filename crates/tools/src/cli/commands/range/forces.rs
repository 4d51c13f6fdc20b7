//! The largest effort and reaction over the range of a driver.

use std::fmt::Write as _;

use super::about;
use super::follower::{Follower, at_speed, without_value};
use super::search::{Largest, Measured, largest};
use biela::kinematics::{Error, ForceQuantity, Origin, Range, Reported, Solver};
use biela::mechanism::{DriverId, shown};

/// Largest reaction that is rounding, as a part of the largest effort: that of a pin beside the one
/// that a spring and its driver load.
const NO_REACTION: f64 = 1e-12;

/// Forces at places in the range of a driver.
struct Loads<'a> {
    follower: Follower<'a>,
    driver: DriverId,
    /// Joints with determinate forces.
    joints: Vec<usize>,
}

impl<'a> Loads<'a> {
    fn new(solver: &'a mut Solver, driver: DriverId, range: &'a Range, speed: f64) -> Self {
        let open = solver.indeterminate();
        let mut follower = Follower::new(solver, driver, range, speed);
        follower.solution.seek_forces(follower.solver);
        let joints = follower.mechanism.joints.iter().enumerate();
        let joints = joints
            .filter(|(_, joint)| Reported::of(&joint.kind).has(0))
            .map(|(index, _)| index)
            .filter(|joint| !open.contains(&Origin::Joint(*joint)));
        Self {
            joints: joints.collect(),
            follower,
            driver,
        }
    }

    /// Returns the size of the effort, and the effort; zero for what is rounding.
    fn effort(&self) -> Measured<f64> {
        let Follower {
            solver, solution, ..
        } = &self.follower;
        let effort = solution.force(ForceQuantity::Effort(self.driver));
        if effort.abs() <= solution.effort_rounding(solver, self.driver) {
            return (0.0, 0.0);
        }
        (effort.abs(), effort)
    }

    /// Returns the largest force in a joint, and the joint.
    fn reaction(&self) -> Option<Measured<usize>> {
        let force = |quantity| self.follower.solution.force(quantity);
        let reactions = self.joints.iter().map(|&joint| {
            let [x, y] = [0, 1].map(|k| force(ForceQuantity::Reaction(joint, k)));
            (x.hypot(y), joint)
        });
        reactions.reduce(|most, next| if next.0 > most.0 { next } else { most })
    }
}

/// Adds the largest effort of a driver that moves at a constant speed \[m/s or rad/s\] over its
/// range, the largest force in a joint, and where forces have no value. The pose is restored. Dead
/// points and change points, which have no forces, are told with the range.
pub(super) fn describe_largest(
    text: &mut String,
    solver: &mut Solver,
    driver: DriverId,
    range: &Range,
    speed: f64,
) {
    let mut loads = Loads::new(solver, driver, range, speed);
    let (mut efforts, mut reactions) = (Vec::new(), Vec::new());
    let (mut missing, mut reason) = (Vec::new(), None);
    for sample in &range.samples {
        let solved = loads.follower.visit(sample);
        let exists = solved.is_ok();
        efforts.push((sample.driver, exists.then(|| loads.effort())));
        let reaction = exists.then(|| loads.reaction()).flatten();
        reactions.push((sample.driver, reaction));
        if let Err(error) = solved
            && !matches!(error, Error::Singular { .. })
        {
            missing.push(sample.driver);
            reason.get_or_insert(error);
        }
    }
    loads.follower.restore();
    let effort = largest(&efforts, |at| {
        loads.follower.follow(at).map(|()| loads.effort())
    });
    loads.follower.restore();
    let reaction = largest(&reactions, |at| {
        loads.follower.follow(at).and_then(|()| loads.reaction())
    });
    let mechanism = &loads.follower.mechanism;
    let kind = mechanism.drivers[driver.index()].coordinate.kind;
    let moving = at_speed(mechanism, driver, speed);
    let mut tell = |words: &str| {
        let _ = writeln!(text, "  {moving}, {words}");
    };
    let mut most = 0.0;
    match effort {
        Some(Largest::Value((size, effort), at)) => {
            most = size;
            let (effort, unit) = (shown(effort), kind.effort_unit().name);
            let at = about(kind, at);
            tell(&format!("largest effort {effort} {unit}, at {at}"));
        }
        Some(Largest::Unbounded(at)) => {
            tell(&format!(
                "effort grows without bound at {}",
                about(kind, at)
            ));
        }
        None => {}
    }
    match reaction {
        Some(Largest::Value((force, joint), at)) if force > NO_REACTION * most => {
            let (force, at) = (shown(force), about(kind, at));
            let joint = &mechanism.joints[joint].name;
            tell(&format!(
                "largest force in joint `{joint}` {force} N, at {at}"
            ));
        }
        Some(Largest::Unbounded(at)) => {
            let at = about(kind, at);
            tell(&format!("forces in joints grow without bound at {at}"));
        }
        _ => {}
    }
    if let Some(reason) = reason {
        let place = without_value(&missing, range.samples.len(), |at| about(kind, at));
        tell(&format!("no forces {place}: {reason}"));
    }
}
