//! The motion from a known pose to the values at the start of a run.
//!
//! Parameters and drivers move straight and together. Whole turns of a driver are taken off first
//! and follow at the end: once some of them bring the mechanism back to its pose, whole turns of
//! its bodies apart, all further ones do, and are added without being followed.

use std::f64::consts::TAU;
use std::sync::Arc;

pub(super) mod initial_pose;

use crate::kinematics::continuation::{Blocked, PathTracker, Progress, most_substeps};
use crate::kinematics::error::Error;
use crate::kinematics::path::{DriverPath, Path};
use crate::kinematics::plan::Crossing;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::{Pose, State};
use crate::kinematics::system::Values;
use crate::mechanism::{DriverId, Parameter, Unit, shown};
pub use initial_pose::Assembly;
use initial_pose::assemble;

/// Ratio of the residual of a row to the estimate of its rounding error, up to which the row holds:
/// the estimate counts each number once, turns of bodies and drivers are each rounded twice.
const ROW_ROUNDINGS: f64 = 4.0;
/// Largest relative difference of the velocities of one motion at a change point that is found
/// twice: those of the two motions there differ by more than their errors.
const SAME_VELOCITY: f64 = 1e-6;
/// Most whole turns of a driver: beyond them the rounding of an angle is as large as a turn.
const MOST_TURNS: i64 = 1 << 50;

/// Moves from `home` to the end of `path`, which starts there.
///
/// # Errors
///
/// [`Error::NoWay`] if no continuous motion was found, and those of [`assemble`] if the mechanism does
/// not close at the end.
pub(super) fn start(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    tracker: &mut PathTracker,
    home: &Pose,
    path: &Path,
) -> Result<Progress, Error> {
    let goal = path.drivers_at_end(compiled.system.mechanism());
    let each = whole_turns(compiled, home, &goal);
    let mut ways = vec![each.clone()];
    ways.extend(common_turns(&each));
    let mut journey = Journey {
        compiled,
        state,
        tracker,
        home,
        path,
        goal,
        progress: Progress::default(),
        crossed: Vec::new(),
    };
    let mut stop = None;
    for turns in ways {
        match journey.go(&turns) {
            Ok(()) => return Ok(journey.arrive()),
            Err(blocked) => stop = stop.or_else(|| Some(journey.describe(&blocked))),
        }
    }
    // Motions are followed forwards in time only.
    let follows = path.has_motions() && path.duration > 0.0;
    let may_follow = path.duration >= 0.0 || !path.has_motions();
    let turns = each.iter().any(|turns| *turns != 0);
    if follows || turns && may_follow {
        state.restore(compiled, home);
        if let Ok(progress) = tracker.track(compiled, state, path, false) {
            return Ok(progress);
        }
    }
    match assemble(compiled, state, path) {
        // Near there the rows may have another rank, which says nothing of the way.
        Ok(_) | Err(Error::Structure { .. }) => Err(stop.expect("the first way was tried")),
        Err(unclosed) => Err(unclosed),
    }
}

/// Returns the whole turns from a pose to the values `goal` of the drivers; those of lengths are
/// zero.
fn whole_turns(compiled: &CompiledMechanism, home: &Pose, goal: &[f64]) -> Vec<i64> {
    let drivers = compiled.system.mechanism().drivers.iter();
    let values = home.drivers.iter().zip(goal);
    let turns = drivers.zip(values).map(|(driver, (from, to))| {
        // A saturating cast, towards zero; zero for a value that is not a number.
        let turns = ((to - from) / TAU) as i64;
        let counts = driver.coordinate.kind.is_angle();
        if counts {
            turns.clamp(-MOST_TURNS, MOST_TURNS)
        } else {
            0
        }
    });
    turns.collect()
}

/// Returns the turns that all drivers with whole turns have in common, if these turn the same way
/// and not as often as each other.
fn common_turns(each: &[i64]) -> Option<Vec<i64>> {
    let turning = || each.iter().copied().filter(|turns| *turns != 0);
    let fewest = turning().min_by_key(|turns| turns.abs())?;
    let is_common = turning().all(|turns| turns.signum() == fewest.signum());
    let differs = turning().any(|turns| turns != fewest);
    let common = each
        .iter()
        .map(|turns| if *turns == 0 { 0 } else { fewest });
    (is_common && differs).then(|| common.collect())
}

/// A motion from a pose to the end of a path.
struct Journey<'a> {
    compiled: &'a mut CompiledMechanism,
    state: &'a mut State,
    tracker: &'a mut PathTracker,
    home: &'a Pose,
    path: &'a Path,
    /// The values of the drivers at the end.
    goal: Vec<f64>,
    progress: Progress,
    /// The change points passed.
    crossed: Vec<Arc<Crossing>>,
}

impl Journey<'_> {
    /// Goes from home to the end: straight to the values there but for whole turns of the drivers,
    /// then these turns. Drivers that turn as often turn together.
    ///
    /// # Errors
    ///
    /// The cause of a stop; the pose is the last one reached.
    fn go(&mut self, turns: &[i64]) -> Result<(), Blocked> {
        self.state.restore(self.compiled, self.home);
        self.progress = Progress::default();
        self.crossed.clear();
        let mut missing = turns.to_vec();
        let goals = self.goal.iter().zip(turns);
        let without = goals.map(|(goal, turns)| goal - TAU * *turns as f64);
        self.move_to(&without.collect::<Vec<_>>())?;
        while let Some(&turns) = missing.iter().find(|turns| **turns != 0) {
            let together: Vec<bool> = missing.iter().map(|missing| *missing == turns).collect();
            self.turn(turns, &together)?;
            let turned = missing.iter_mut().zip(&together);
            turned
                .filter(|(_, is)| **is)
                .for_each(|(missing, _)| *missing = 0);
        }
        Ok(())
    }

    /// Makes all change points passed those of the last path. Returns the work spent.
    fn arrive(self) -> Progress {
        self.tracker.set_crossed(self.crossed);
        self.progress
    }

    /// Moves parameters and drivers straight to these values.
    fn move_to(&mut self, drivers: &[f64]) -> Result<Progress, Blocked> {
        let pose = &self.state.pose;
        let values = drivers.iter().zip(&pose.drivers);
        let path = Path {
            // No driver runs along its motion.
            start: self.path.time(1.0),
            duration: 0.0,
            from: pose.parameters.clone(),
            to: self.path.to.clone(),
            driver_paths: values
                .map(|(to, from)| DriverPath::held(*to, *from))
                .collect(),
        };
        let tracked = self.tracker.track(self.compiled, self.state, &path, false);
        let progress = match &tracked {
            Ok(progress) => progress,
            Err(blocked) => &blocked.progress,
        };
        self.progress.add(progress);
        self.crossed.extend(self.tracker.crossed().iter().cloned());
        tracked
    }

    /// Turns the drivers marked in `together`, and no other, by these turns, to their values at the
    /// end.
    fn turn(&mut self, turns: i64, together: &[bool]) -> Result<(), Blocked> {
        let from = self.state.pose.drivers.clone();
        // Counted from the start of the turns: near the end of very many, angles are rounded.
        let after = |done: i64| -> Vec<f64> {
            let turned = TAU * (turns.signum() * done) as f64;
            let drivers = from.iter().zip(together);
            drivers
                .map(|(from, is)| if *is { from + turned } else { *from })
                .collect()
        };
        let most = most_substeps(self.compiled.plan.work(), None);
        let (mut before, mut begun) = (self.state.pose.clone(), 0);
        let (mut done, mut left, mut stride) = (0, turns.abs(), 1_i64);
        let (mut repeated, mut is_linear) = (None, true);
        while left > 0 {
            // After many sub-steps the tracker judges the whole rest of the way.
            let few = f64::from(self.progress.substeps) < most;
            let next = if few { stride.min(left) } else { left };
            (done, left) = (done + next, left - next);
            let progress = self.move_to(&after(done))?;
            // Linear relations take one sub-step, however long it is.
            is_linear &= progress.substeps == 1;
            stride = if is_linear {
                stride.saturating_mul(2)
            } else {
                1
            };
            if self.state.pose.crossings.len() != before.crossings.len() {
                // A change point counts once it is approached on the turn.
                (before, begun) = (self.state.pose.clone(), done);
                continue;
            }
            let period = done - begun;
            let times = left / period;
            if repeated.is_none() && times > 0 {
                repeated = self.repeat(&before, times, &after(done + times * period));
                if repeated.is_some() {
                    left -= times * period;
                }
            }
        }
        let goals = self.goal.iter().zip(&from).zip(together);
        let there: Vec<f64> = goals
            .map(|((goal, from), is)| if *is { *goal } else { *from })
            .collect();
        if let Some(turns) = repeated {
            self.add_turns(&turns, &there);
        }
        // Newton–Raphson at the rounded angles.
        self.move_to(&there).map(|_| ())
    }

    /// Returns the turns of all unknowns when the motion from the pose `before` to the present one is
    /// repeated that many `times`, with the drivers at the values `there` then. `None` unless the
    /// motion ends where it began, whole turns apart, and all equations hold after the turns:
    /// then the same motion leads on from there.
    fn repeat(&self, before: &Pose, times: i64, there: &[f64]) -> Option<Vec<f64>> {
        let Self {
            compiled: CompiledMechanism { system, .. },
            state,
            ..
        } = self;
        let once: Vec<f64> = state
            .whole_turns_since(system, before)
            .collect::<Option<_>>()?;
        if !self.crosses_alike(before) {
            return None;
        }
        let turns: Vec<f64> = once.iter().map(|turns| times as f64 * turns).collect();
        let mut at = state.at.clone();
        at.set_pose(system.mechanism(), &turned(&state.pose.q, &turns));
        let now = state.values();
        let then = Values {
            at: &at,
            targets: now.targets,
            drivers: there,
        };
        let holds = |row: usize| {
            let now = system.evaluate_row(row, now, |_, _| ());
            let then = system.evaluate_row(row, then, |_, _| ());
            then.value.abs() <= now.value.abs() + ROW_ROUNDINGS * then.rounding
        };
        let mut rows = 0..system.equations().len();
        rows.all(holds).then_some(turns)
    }

    /// Returns whether the pose goes on through the same change points as the pose `before`: at a
    /// change point itself two motions have the same pose.
    fn crosses_alike(&self, before: &Pose) -> bool {
        let size = self.state.at.size();
        let crossings = self.state.pose.crossings.iter().zip(&before.crossings);
        self.state.pose.crossings.len() == before.crossings.len()
            && crossings.into_iter().all(|(now, then)| {
                let columns = self.compiled.plan.blocks[now.block].columns();
                let mut unknowns = columns.iter().enumerate();
                now.block == then.block
                    && unknowns.all(|(local, column)| {
                        let [now, then] = [now, then].map(|c| c.evaluate(local, c.center)[1]);
                        let scale = self.compiled.system.column_scale(*column, size);
                        (now - then).abs() <= SAME_VELOCITY * (scale + now.abs())
                    })
            })
    }

    /// Adds whole turns to the unknowns, which brings the drivers to the values `there`.
    fn add_turns(&mut self, turns: &[f64], there: &[f64]) {
        let mut pose = self.state.pose.clone();
        pose.q = turned(&pose.q, turns);
        for crossing in &mut pose.crossings {
            let driver = crossing.driver.index();
            let columns = self.compiled.plan.blocks[crossing.block].columns();
            let turned = crossing.turned(
                there[driver] - pose.drivers[driver],
                columns.iter().map(|column| TAU * turns[*column]),
            );
            *crossing = Arc::new(turned);
        }
        pose.drivers.copy_from_slice(there);
        self.state.restore(self.compiled, &pose);
    }

    /// Describes a stop at the pose.
    fn describe(&self, blocked: &Blocked) -> Error {
        let mechanism = self.compiled.system.mechanism();
        let pose = &self.state.pose;
        let drivers = (0..).map(DriverId).zip(&mechanism.drivers);
        let ends = self.home.drivers.iter().zip(&self.goal);
        let moves = |(from, to): (&f64, &f64)| (from - to).abs() > 0.0;
        let moving = drivers.zip(ends).filter(|(_, ends)| moves(*ends));
        let limits = blocked.drivers(pose);
        let mut values: Vec<String> = moving
            .map(|((id, driver), _)| {
                let value = driver.coordinate.kind.show(limits[id.index()]);
                format!("driver `{}` at {value}", driver.name)
            })
            .collect();
        let parameters = mechanism.parameters.iter().zip(&pose.parameters);
        let ends = self.path.from.iter().zip(&self.path.to);
        let set = |own: &Parameter, ends| !own.derived && moves(ends);
        let set = parameters
            .zip(ends)
            .filter(|((own, _), ends)| set(own, *ends));
        values.extend(set.map(|((own, value), _)| {
            let unit = own.unit.map_or_else(String::new, Unit::suffix);
            format!("parameter `{}` at {}{unit}", own.name, shown(*value))
        }));
        Error::NoWay {
            reason: blocked.reason_in_words(mechanism),
            values,
        }
    }
}

/// Returns values with whole turns added.
fn turned(q: &[f64], turns: &[f64]) -> Vec<f64> {
    q.iter()
        .zip(turns)
        .map(|(q, turns)| q + TAU * turns)
        .collect()
}
