//! Jumps of generated mechanisms against the same motions in tiny steps, and against themselves
//! written down in other ways.
//!
//! Each case draws a mechanism, a jump of its drivers and perhaps of some lengths, which may have
//! corners as functions of what jumps, and expects:
//! - one jump ends where tiny steps end: at the same pose, or at the same position that stops the
//!   motion; a jump that the solver gives up for its number of sub-steps ends where tiny steps to
//!   the same place end, as that number is a limit per call and tiny steps come farther with it;
//! - the jump back ends at the start, unless it is given up so;
//! - a motion stops at a singular pose only;
//! - drivers that are evenly accelerated, by inputs or by prescribed motions, lead to the same places;
//! - lengths times a thousand or a thousandth, other names, another order of bodies and joints, and
//!   another place in the plane change nothing: the same verdict, the same pose, sub-steps within a
//!   factor of two;
//! - the extremes of measures over the range of a driver are those of a dense scan; see [`try_extremes`];
//! - a start many turns away, with parameters at other values, ends where tiny steps on the same way
//!   end, or is refused where these are blocked;
//! - no call takes more than [`MOST_SUBSTEPS`] sub-steps.
//!
//! [`change_points`] has forces at change points, [`free`] motions that are free.

mod change_points;
mod extremes;
mod far;
mod free;
mod kinds;
mod text;

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

use biela::kinematics::{Blocked, DriverPath, Error, Path, Progress, Reason, Solver};
use biela::mechanism::{Mechanism, Source};

use crate::mutation::Chance;
use text::{Law, Text, View};

pub use change_points::{FORCE_KINDS, force_case, run_forces};
pub use text::Variant;

pub use extremes::try_extremes;
pub use free::{FREE_KINDS, FreeCounts, free_case, free_events, run_free};
pub use kinds::{Draw, KINDS};

/// Most sub-steps of a call.
pub const MOST_SUBSTEPS: u32 = 100_000;
/// The number of tiny steps in a jump.
const TINY: u32 = 400;
/// Largest difference of poses, in radians and parts of the scale: rounding next to positions that
/// are nearly singular.
const SAME: f64 = 1e-7;
/// The same far from the origin, where coordinates have the rounding of the distance.
const SAME_FAR: f64 = 1e-4;
/// Largest difference of the places where a motion stops, as part of the jump: tiny steps end in
/// front of a dead point to the root of the rounding.
const SAME_STOP: f64 = 1e-5;
/// The same far from the origin: a proof, whose bounds of rounding are a hundred times larger than
/// rounding mostly is, ends earlier in front of a dead point.
const SAME_STOP_FAR: f64 = 1e-2;
/// Least reciprocal condition of a pose that is not singular: a motion that stops has come as near
/// to a dead point as the root of the smallest sub-step.
const REGULAR: f64 = 1e-3;
/// Distance of a mechanism that is far from the origin, in parts of its scale.
const FAR: f64 = 1000.0;
/// A mechanism that stops with a coordinate beyond this, in radians and parts of the scale, runs to
/// infinity there, as between guides that become parallel.
const INFINITE: f64 = 1e4;
/// A call that takes longer is slow.
const SLOW: Duration = Duration::from_secs(1);

/// A mechanism of a kind and a jump of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The mechanism file.
    pub text: String,
    /// The value of each driver after the jump \[m or rad\].
    pub drivers: Vec<f64>,
    /// Names and values of the parameters that jump.
    pub parameters: Vec<(String, f64)>,
}

/// The end of a jump.
#[derive(Clone, Debug)]
struct End {
    /// The part of the jump that was possible.
    reached: f64,
    /// q there and at the start, as it is in the view that changes nothing.
    q: Vec<f64>,
    start: Vec<f64>,
    substeps: u32,
    message: String,
    /// Whether the motion was given up for its number of sub-steps, at no particular place.
    given_up: bool,
    /// Reciprocal condition of the pose, if the motion stops there because it is singular.
    stop: Option<f64>,
    /// The jump back.
    back: Option<Back>,
    slowest: Duration,
    /// Whether the mechanism has redundant constraints.
    is_redundant: bool,
}

impl End {
    /// Describes the end in a line.
    fn describe(&self) -> String {
        let Self {
            reached,
            substeps,
            message,
            ..
        } = self;
        let mut words = format!("reaches {reached} in {substeps} sub-steps");
        if let Some(rcond) = self.stop {
            let _ = write!(words, ", rcond {rcond:.1e}");
        }
        if !message.is_empty() {
            let _ = write!(words, ", {message:.150}");
        }
        if let Some(Back { off, message, .. }) = &self.back {
            let _ = write!(words, ", back to {off:.1e} {message:.150}");
        }
        words
    }
}

/// The end of the jump back.
#[derive(Clone, Debug)]
struct Back {
    /// Why it does not end.
    message: String,
    /// Whether it was given up for its number of sub-steps.
    given_up: bool,
    /// Largest difference from the start, in radians and parts of the scale.
    off: f64,
}

/// The result of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// All as expected.
    Agrees,
    /// The mechanism does not close from its estimates.
    NotAssembled,
    /// A difference, in words.
    Differs(String),
}

/// The counts of a kind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Cases that agree.
    pub agree: u32,
    /// Jumps among them that end before their end.
    pub stopped: u32,
    /// Jumps among them that are given up for their number of sub-steps.
    pub given_up: u32,
    /// Cases that did not close.
    pub not_assembled: u32,
    /// Cases that differ.
    pub differ: u32,
    /// Cases with a call of more than a second.
    pub slow: u32,
    /// The most sub-steps of a call.
    pub substeps: u32,
}

impl Counts {
    /// Counts a finding, and reports a difference.
    fn note(&mut self, finding: Finding, found: impl FnOnce(&str)) {
        match finding {
            Finding::Agrees => self.agree += 1,
            Finding::NotAssembled => self.not_assembled += 1,
            Finding::Differs(words) => {
                self.differ += 1;
                found(&words);
            }
        }
    }
}

/// A kind of mechanisms, as its place in [`KINDS`], in one of the variants.
pub type Kind = (usize, Variant);

/// Runs a number of cases of a kind, and reports each difference to `found`, with the seed of its case.
pub fn run(kind: Kind, seed: u64, cases: u64, mut found: impl FnMut(u64, &str)) -> Counts {
    let mut counts = Counts::default();
    for case in seed..seed + cases {
        let (finding, jump) = try_case(kind, case);
        if let Some(jump) = jump {
            counts.substeps = counts.substeps.max(jump.substeps);
            counts.given_up += u32::from(jump.given_up);
            counts.stopped += u32::from(jump.stop.is_some());
            counts.slow += u32::from(jump.slowest > SLOW);
        }
        counts.note(finding, |words| found(case, words));
    }
    counts
}

/// Runs a number of cases of [`try_extremes`], and reports each difference to `found`, with the seed of
/// its case.
pub fn run_extremes(kind: Kind, seed: u64, cases: u64, mut found: impl FnMut(u64, &str)) -> Counts {
    let mut counts = Counts::default();
    for case in seed..seed + cases {
        counts.note(try_extremes(kind, case), |words| found(case, words));
    }
    counts
}

/// Returns a case as it is written down in a view.
fn case((kind, variant): Kind, seed: u64, view: View<'_>) -> Case {
    // Neighbouring seeds shall have nothing in common.
    let mut chance = Chance::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (KINDS[kind].1)(&mut chance, Text::new(view, variant))
}

/// Returns the mechanism file of a case, and the jump.
#[must_use]
pub fn plain_case(kind: Kind, seed: u64) -> Case {
    case(kind, seed, View::default())
}

/// Tries a case. Returns the end of the jump, too, if the mechanism closes.
#[must_use]
fn try_case(kind: Kind, seed: u64) -> (Finding, Option<End>) {
    let plain = plain_case(kind, seed);
    let Ok(jump) = end(&plain, View::default(), 1, 1.0) else {
        return (Finding::NotAssembled, None);
    };
    let finding = differences(kind, seed, &plain, &jump);
    let finding = finding.map_or_else(Finding::Differs, |()| Finding::Agrees);
    (finding, Some(jump))
}

/// # Errors
///
/// The first difference, in words.
fn differences(kind: Kind, seed: u64, plain: &Case, jump: &End) -> Result<(), String> {
    let differs = |what: &str, other: &End| {
        let [jump, other] = [jump, other].map(End::describe);
        Err(format!("{what}: jump {jump}; other {other}"))
    };
    if jump.substeps > MOST_SUBSTEPS {
        return differs("too many sub-steps", jump);
    }
    let part = if jump.given_up { jump.reached } else { 1.0 };
    let tiny = end(plain, View::default(), TINY, part)?;
    if let Some(what) = difference(jump, &tiny, [SAME, SAME_STOP]) {
        return differs(&what, &tiny);
    }
    if jump.stop.is_some_and(|rcond| rcond > REGULAR) {
        return differs("stops at a regular pose", &tiny);
    }
    let leads_elsewhere = |back: &Back| !(back.given_up || back.off <= SAME);
    if jump.back.as_ref().is_some_and(leads_elsewhere) {
        return differs("the way back leads elsewhere", &tiny);
    }
    let mut chance = Chance::new(seed.wrapping_mul(0xd1b5_4a32_d192_ed03));
    far::difference(plain, &mut chance)?;
    let turn = text::angle(&mut chance);
    let away = text::angle(&mut chance);
    let [x, y] = text::end([0.0; 2], FAR, away);
    let plain = View::default();
    let views = [
        View {
            scale: 1e-3,
            ..plain
        },
        View {
            scale: 1e3,
            ..plain
        },
        View {
            prefix: "other_",
            reversed: true,
            ..plain
        },
        View {
            place: [0.1, -0.2, turn],
            ..plain
        },
        View {
            place: [x, y, turn],
            ..plain
        },
    ];
    let laws = [Law::FromRest, Law::Prescribed].map(|law| View { law, ..plain });
    // Parameters do not wait for accelerated drivers.
    let moves = matches!(kind.1, Variant::Moving | Variant::Cornered);
    let laws = laws.into_iter().filter(|_| !moves);
    for view in views.into_iter().chain(laws) {
        let there = match end(&case(kind, seed, view), view, 1, 1.0) {
            // From estimates that are far off the search may end before it finds a pose: its starts
            // depend on order and axes.
            Err(error) if !keeps_axes(view) && error.contains("no proof") => continue,
            there => there.map_err(|error| format!("closes, but not in {view:?}: {error}"))?,
        };
        let is_far = view.place[0].hypot(view.place[1]) > 1.0;
        let off = distance(&jump.start, &there.start);
        if off > if is_far { SAME_FAR } else { SAME } {
            return differs(&format!("in {view:?}: begins {off:.1e} away"), &there);
        }
        // The limit of sub-steps stands at no particular place.
        if jump.given_up || there.given_up {
            continue;
        }
        // Boxes round a motion are larger along some directions than along others.
        let most_ratio = if view.place[2] == 0.0 { 2 } else { 6 };
        let same = if is_far {
            [SAME_FAR, SAME_STOP_FAR]
        } else {
            [SAME, SAME_STOP]
        };
        if let Some(what) = difference(jump, &there, same) {
            return differs(&format!("in {view:?}: {what}"), &there);
        }
        let fewer = jump.substeps.min(there.substeps);
        let more = jump.substeps.max(there.substeps);
        // Another order or place may choose other ones of redundant constraints.
        let is_alike = view.law == Law::Jump && (keeps_axes(view) || !jump.is_redundant);
        // In front of a stop the number of sub-steps is that of halvings.
        if is_alike && jump.reached >= 1.0 && more > most_ratio * fewer + 1 {
            return differs(&format!("other sub-steps in {view:?}"), &there);
        }
    }
    Ok(())
}

/// Returns whether a view keeps the order of bodies and joints, and the directions of the axes.
fn keeps_axes(view: View<'_>) -> bool {
    view.place[2] == 0.0 && !view.reversed
}

/// Returns the difference of two ends of a jump, larger than those of poses and of places where the
/// motion stops.
fn difference(a: &End, b: &End, [same, same_stop]: [f64; 2]) -> Option<String> {
    if (a.reached - b.reached).abs() > same_stop {
        let when = ["later", "earlier"][usize::from(a.reached < b.reached)];
        return Some(format!("stops {when}"));
    }
    let most = distance(&a.q, &b.q);
    // In front of an asymptote a motion comes as far as rounding lets it.
    let is_at_infinity = |end: &End| end.q.iter().any(|q| q.abs() > INFINITE);
    if a.reached < 1.0 && is_at_infinity(a) && is_at_infinity(b) {
        return None;
    }
    // A motion that stops at a dead point has come to the root of the rounding of its place.
    let same = match (a.reached < 1.0, same_stop > SAME_STOP) {
        (true, true) => 0.5,
        (true, false) => 0.02,
        (false, _) => same,
    };
    (most.is_nan() || most > same).then(|| format!("another pose, {most:.1e} away"))
}

/// Returns the largest difference of coordinates.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    off.fold(0.0, |most, off| {
        if off > most || off.is_nan() {
            off
        } else {
            most
        }
    })
}

/// A mechanism on its way from the start to the end of a jump.
struct Jump {
    solver: Solver,
    path: Path,
    law: Law,
    from: [Vec<f64>; 2],
    to: [Vec<f64>; 2],
}

impl Jump {
    /// Tracks the path from the pose to a part of the jump.
    fn track(&mut self, s: f64) -> Result<Progress, Blocked> {
        let between = |from: f64, to: f64| from + s * (to - from);
        let pose = self.solver.pose().clone();
        let path = &mut self.path;
        path.start = pose.time;
        path.duration = match self.law {
            Law::Jump => 0.0,
            Law::FromRest => 1.0,
            Law::Prescribed => s - pose.time,
        };
        path.from.clone_from(&pose.parameters);
        for (k, value) in path.to.iter_mut().enumerate() {
            *value = between(self.from[0][k], self.to[0][k]);
        }
        for (k, driver_path) in path.driver_paths.iter_mut().enumerate() {
            let (here, there) = (pose.drivers[k], between(self.from[1][k], self.to[1][k]));
            let (position, jump, acceleration) = match self.law {
                Law::Jump => (there, here - there, 0.0),
                Law::FromRest => (here, 0.0, 2.0 * (there - here)),
                Law::Prescribed => continue,
            };
            *driver_path = DriverPath::Input {
                position,
                velocity: 0.0,
                acceleration,
                jump,
            };
        }
        self.solver.track(path)
    }

    /// Returns the part of the way to the end at a place on the path.
    fn part(&self, s: f64) -> f64 {
        match self.law {
            Law::Jump => s,
            Law::FromRest | Law::Prescribed => s * s,
        }
    }
}

/// Returns whether a motion was given up for its number of sub-steps, perhaps in front of a dead
/// point that is still ahead.
fn is_given_up(blocked: &Blocked) -> bool {
    match &blocked.reason {
        Reason::TooLong | Reason::NearSingular => true,
        Reason::Singular(point) => point.s - blocked.s > SAME_STOP,
        _ => false,
    }
}

/// Moves along the first `part` of the jump in a number of steps, and back if it is one.
///
/// # Errors
///
/// Why the mechanism does not close.
fn end(case: &Case, view: View<'_>, steps: u32, part: f64) -> Result<End, String> {
    let source = Source::new("attack.toml", case.text.as_str());
    let mechanism = match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(problems) => panic!("{problems:#?}\n{}", case.text),
    };
    let path = Path::new(&mechanism);
    let error = |error: Error| error.to_string();
    let mut solver = Solver::new(Arc::clone(&mechanism)).map_err(error)?;
    solver.assemble(&path).map_err(error)?;
    let is_redundant = !solver.redundancies().is_empty();
    let start = solver.pose().clone();
    let mut to = start.parameters.clone();
    for (name, value) in &case.parameters {
        let parameters = &mechanism.parameters;
        let index = parameters.iter().position(|p| p.name == *name);
        let index = index.expect("the case names its own parameters");
        to[index] = *value;
    }
    let bodies = 3 * mechanism.bodies.len();
    let mut jump = Jump {
        solver,
        path,
        law: view.law,
        from: [start.parameters.clone(), start.drivers.clone()],
        to: [to, case.drivers.clone()],
    };
    let mut end = End {
        reached: 0.0,
        q: Vec::new(),
        start: view.undo(&start.q[..bodies]),
        substeps: 0,
        message: String::new(),
        given_up: false,
        stop: None,
        back: None,
        slowest: Duration::ZERO,
        is_redundant,
    };
    for step in 1..=steps {
        let s = part * f64::from(step) / f64::from(steps);
        let begin = Instant::now();
        let tracked = jump.track(s);
        end.slowest = end.slowest.max(begin.elapsed());
        match tracked {
            Ok(progress) => {
                end.substeps = end.substeps.max(progress.substeps);
                end.reached = s;
            }
            Err(blocked) => {
                end.substeps = end.substeps.max(blocked.progress.substeps);
                let here = jump.part(blocked.s);
                end.reached = part * (f64::from(step - 1) + here) / f64::from(steps);
                end.given_up = is_given_up(&blocked);
                if matches!(blocked.reason, Reason::Singular(_) | Reason::Lost) {
                    end.stop = Some(jump.solver.rcond());
                }
                end.message = format!("{:?}", blocked.reason);
                break;
            }
        }
    }
    end.q = view.undo(&jump.solver.pose().q[..bodies]);
    if steps == 1 && end.reached >= 1.0 && view.law == Law::Jump {
        let tracked = jump.track(0.0);
        let given_up = tracked.as_ref().err().is_some_and(is_given_up);
        let message = tracked.map_or_else(|blocked| format!("{blocked:?}"), |_| String::new());
        let off = distance(&view.undo(&jump.solver.pose().q[..bodies]), &end.start);
        let off = if message.is_empty() {
            off
        } else {
            f64::INFINITY
        };
        end.back = Some(Back {
            message,
            given_up,
            off,
        });
    }
    Ok(end)
}
