//! The outcome of tracking a path.

use crate::kinematics::Error;
use crate::kinematics::error::OpenJoint;
use crate::kinematics::singular::SingularPoint;
use crate::kinematics::state::Pose;
use crate::kinematics::stop_limit::StopLimit;
use crate::kinematics::tolerances::SAME_PLACE_ON_PATH;
use crate::mechanism::{DriverId, Mechanism, fixed};

/// The cause of a stop before the end of a path.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The Jacobian loses rank ahead, at a dead point or at a singular position that cannot be
    /// crossed.
    Singular(Box<SingularPoint>),
    /// A coordinate is at the limit of a stop, and the motion leads out.
    Stop(Box<StopLimit>),
    /// Neither a continuous motion nor a singular position was found ahead: the block that stops
    /// is too large for a search, or parameters move it.
    Lost,
    /// The prescribed motion of this driver jumps ahead.
    Jump(DriverId),
    /// No mechanism exists for a value ahead.
    Value(Error),
    /// A constraint that was redundant so far contradicts the others ahead: the gap in it where it
    /// was first found open.
    Contradiction(OpenJoint),
    /// The path needs more sub-steps than anyone would wait for.
    TooLong,
    /// It needs as many because the mechanism stays next to a singular position.
    NearSingular,
    /// The [budget](super::Budget) of this many sub-steps is spent.
    Spent(u32),
}

/// The work spent on a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Newton corrections: the most that any block needed, summed over the accepted sub-steps.
    pub iterations: u32,
    /// Sub-steps, rejected ones included; one for an ordinary step.
    pub substeps: u32,
    /// Change points passed; [`Solver::crossed`](crate::kinematics::Solver::crossed) has them.
    pub crossings: u32,
    /// Accepted sub-steps that are *checked*, not proved: an estimate tells that one continuous
    /// motion joins their ends. It takes the place of the proof for blocks of more than 32 torn
    /// unknowns, and for redundant rows where pieces of a contour meet.
    pub checked: u32,
}

impl Progress {
    /// Adds the work spent on another part of a path.
    pub(crate) fn add(&mut self, other: &Self) {
        let Self {
            iterations,
            substeps,
            crossings,
            checked,
        } = self;
        *iterations = iterations.saturating_add(other.iterations);
        *substeps = substeps.saturating_add(other.substeps);
        *crossings = crossings.saturating_add(other.crossings);
        *checked = checked.saturating_add(other.checked);
    }
}

/// The tracker did not reach the end of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocked {
    /// The place on the path that was reached, from 0 to 1. The mechanism is there.
    pub s: f64,
    /// The cause of the stop.
    pub reason: Reason,
    /// The work spent.
    pub progress: Progress,
}

impl Blocked {
    /// Returns the place on the path at which the motion ends: that of the singular position in
    /// front of which it has stopped, which is known to rounding, otherwise the place reached.
    #[must_use]
    pub fn place(&self) -> f64 {
        match &self.reason {
            Reason::Singular(point) if (point.s - self.s).abs() <= SAME_PLACE_ON_PATH => {
                point.s.clamp(0.0, 1.0)
            }
            _ => self.s,
        }
    }

    /// Returns the values of the drivers at the place where the motion ends; `pose` is the last one
    /// reached.
    pub(in crate::kinematics) fn drivers<'a>(&'a self, pose: &'a Pose) -> &'a [f64] {
        match &self.reason {
            Reason::Singular(point) => &point.drivers,
            _ => &pose.drivers,
        }
    }

    /// Returns the cause of the stop in words.
    pub(in crate::kinematics) fn reason_in_words(&self, mechanism: &Mechanism) -> String {
        match &self.reason {
            Reason::Value(error) => error.to_string(),
            Reason::Contradiction(open) => format!("beyond, {open}, redundant up to here"),
            Reason::TooLong => "the motion needs more sub-steps than the solver takes".to_owned(),
            Reason::NearSingular => {
                "next to a singular position the motion needs more sub-steps than the solver takes"
                    .to_owned()
            }
            Reason::Spent(most) => format!("the motion takes more than {most} sub-steps"),
            Reason::Singular(point) => point.to_string(),
            Reason::Stop(limit) => limit.to_string(),
            Reason::Jump(driver) => {
                let driver = &mechanism.drivers[driver.index()];
                format!("the motion of driver `{}` jumps", driver.name)
            }
            Reason::Lost => "no continuous motion".to_owned(),
        }
    }

    /// Returns the cause of the stop, its `time` \[s\] if the motion takes time, and the values of
    /// the drivers that move; `pose` is the last one reached.
    #[must_use]
    pub fn describe(
        &self,
        mechanism: &Mechanism,
        pose: &Pose,
        time: Option<f64>,
        moves: impl Fn(DriverId) -> bool,
    ) -> String {
        let reason = self.reason_in_words(mechanism);
        let drivers = (0..).map(DriverId).zip(&mechanism.drivers);
        let drivers = drivers.zip(self.drivers(pose));
        let moving: Vec<String> = drivers
            .filter(|((id, _), _)| moves(*id))
            .map(|((_, driver), value)| {
                let value = driver.coordinate.kind.show(*value);
                format!("`{}` at {value}", driver.name)
            })
            .collect();
        let moving = if moving.is_empty() {
            String::new()
        } else {
            format!(", with {}", moving.join(", "))
        };
        let time = time.map_or_else(String::new, |time| format!(" at t = {} s", fixed(time, 9)));
        format!("{reason}{time}: the mechanism cannot go on{moving}")
    }
}
