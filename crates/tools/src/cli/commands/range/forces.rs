//! The largest effort and reaction over the range of a driver.

use std::fmt::Write as _;

use super::about;
use super::follower::{Follower, at_speed, without_value};
use super::search::{Largest, Measured, largest};
use biela::kinematics::{Error, Extreme, ForceQuantity, Origin, Range, Reported, Solver};
use biela::mechanism::{DriverId, Mechanism, shown};

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

/// The largest forces over the range of a driver.
pub(in crate::cli) struct LargestForces {
    /// Speed of the driver \[m/s or rad/s\].
    speed: f64,
    /// Its largest effort, with the sign \[N or N m\].
    effort: Option<Largest<f64>>,
    /// The largest force in a joint \[N\], and the joint, if it is more than rounding.
    reaction: Option<Largest<usize>>,
    /// Values of the driver at samples without forces, dead points and change points apart; the cause
    /// at the first.
    missing: (Vec<f64>, Option<Error>),
    samples: usize,
}

impl LargestForces {
    /// Finds those of a driver that moves at a constant speed \[m/s or rad/s\]. The pose is restored.
    pub(in crate::cli) fn new(
        solver: &mut Solver,
        driver: DriverId,
        range: &Range,
        speed: f64,
    ) -> Self {
        let mut loads = Loads::new(solver, driver, range, speed);
        let (mut efforts, mut reactions) = (Vec::new(), Vec::new());
        let (mut missing, mut reason) = (Vec::new(), None);
        for sample in &range.samples {
            let solved = loads.follower.visit(sample);
            let exists = solved.is_ok();
            efforts.push((sample.driver, exists.then(|| loads.effort())));
            let reaction = exists.then(|| loads.reaction()).flatten();
            reactions.push((sample.driver, reaction));
            // Dead points and change points, which have no forces, are told with the range.
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
        let most = match effort {
            Some(Largest::Value((size, _), _)) => size,
            _ => 0.0,
        };
        let is_rounding = |found: &Largest<usize>| match found {
            Largest::Value((force, _), _) => *force <= NO_REACTION * most,
            Largest::Unbounded(_) => false,
        };
        Self {
            speed,
            effort,
            reaction: reaction.filter(|found| !is_rounding(found)),
            missing: (missing, reason),
            samples: range.samples.len(),
        }
    }

    /// Returns the largest effort, infinite where it grows without bound, and the driver's value there.
    pub(in crate::cli) fn effort(&self) -> Option<Extreme> {
        let extreme = |value, driver| Extreme { value, driver };
        Some(match self.effort? {
            Largest::Value((_, effort), at) => extreme(effort, at),
            Largest::Unbounded(at) => extreme(f64::INFINITY, at),
        })
    }

    /// Returns the largest force in a joint, infinite where it grows without bound, the driver's value
    /// there, and the joint.
    pub(in crate::cli) fn reaction(&self) -> Option<(Extreme, Option<usize>)> {
        let extreme = |value, driver| Extreme { value, driver };
        Some(match self.reaction? {
            Largest::Value((force, joint), at) => (extreme(force, at), Some(joint)),
            Largest::Unbounded(at) => (extreme(f64::INFINITY, at), None),
        })
    }

    /// Says where forces have no value, and why.
    pub(in crate::cli) fn without(
        &self,
        mechanism: &Mechanism,
        driver: DriverId,
    ) -> Option<String> {
        let kind = mechanism.drivers[driver.index()].coordinate.kind;
        let (missing, reason) = &self.missing;
        let place = without_value(missing, self.samples, |at| about(kind, at));
        Some(format!("no forces {place}: {}", reason.as_ref()?))
    }

    /// Adds the largest effort, the largest force in a joint, and where forces have no value.
    pub(super) fn describe(&self, text: &mut String, mechanism: &Mechanism, driver: DriverId) {
        let kind = mechanism.drivers[driver.index()].coordinate.kind;
        let moving = at_speed(mechanism, driver, self.speed);
        let mut tell = |words: &str| {
            let _ = writeln!(text, "  {moving}, {words}");
        };
        match self.effort {
            Some(Largest::Value((_, effort), at)) => {
                let (effort, unit) = (shown(effort), kind.effort_unit().name);
                let at = about(kind, at);
                tell(&format!("largest effort {effort} {unit}, at {at}"));
            }
            Some(Largest::Unbounded(at)) => {
                let at = about(kind, at);
                tell(&format!("effort grows without bound at {at}"));
            }
            None => {}
        }
        match self.reaction {
            Some(Largest::Value((force, joint), at)) => {
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
            None => {}
        }
        if let Some(without) = self.without(mechanism, driver) {
            tell(&without);
        }
    }
}
