//! Extremes of measures over the range of a driver, against dense scans.
//!
//! Each case draws a mechanism and measures x, y and the angle of a marker. The driver is followed to
//! both ends of its range in many small steps, denser towards limits, where bodies run as the root of
//! the distance. Expected are:
//! - no value of a scan is beyond the extremes that the range tells;
//! - the mechanism has that value at the place that the range tells;
//! - without cams, whose contact may jam by itself, the transmission angle is zero at limits that are
//!   located.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Arc;

use biela::kinematics::{DriverPath, End, Path, Pose, RangeSettings, Rates, Sample, Solver};
use biela::mechanism::{DriverId, Mechanism, Source};

use super::{Finding, Kind, View, case};
use crate::mutation::Chance;

/// Places of a scan in each direction.
const PLACES: u32 = 1000;
/// Largest part of a measure's range by which a scan may be beyond the extremes: two of them that lie
/// within one interval of the samples differ by less.
const BEYOND: f64 = 1e-7;
/// Least part of the way to a limit at which the driver can be put again.
const NEAR_LIMIT: f64 = 1e-6;
/// Largest difference of a measure from the extreme at its place, as part of its range.
const SAME: f64 = 1e-7;
/// Least range of a measure that the others are compared with \[m or rad\]: next to a fold a measure
/// that is constant has the rounding 1e-10.
const LEAST_RANGE: f64 = 1e-2;
/// Largest transmission angle at a limit \[rad\]: the root of rounding, in mechanisms of some size.
const ZERO: f64 = 1e-5;
/// Least reciprocal condition of a sample from which the driver can go on.
const REGULAR: f64 = 1e-10;
/// Turns of a scan.
const MOST_TURNS: u32 = 4;

/// Tries a case.
#[must_use]
pub fn try_extremes(kind: Kind, seed: u64) -> Finding {
    let text = with_measures(&case(kind, seed, View::default()).text, seed);
    let source = Source::new("attack.toml", text.as_str());
    let mechanism = match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(problems) => panic!("{problems:#?}\n{text}"),
    };
    let Ok(mut solver) = Solver::new(Arc::clone(&mechanism)) else {
        return Finding::NotAssembled;
    };
    if solver.assemble(&Path::new(&mechanism)).is_err() {
        return Finding::NotAssembled;
    }
    match differences(&mut solver) {
        Ok(()) => Finding::Agrees,
        Err(words) => Finding::Differs(words),
    }
}

/// Returns a mechanism file with measures of a marker.
fn with_measures(text: &str, seed: u64) -> String {
    let source = Source::new("attack.toml", text);
    let (mechanism, _) = match Mechanism::parse(&source) {
        Ok(parsed) => parsed,
        Err(problems) => panic!("{problems:#?}\n{text}"),
    };
    let mut chance = Chance::new(seed.wrapping_mul(0xa076_1d64_78bd_642f));
    let markers = mechanism.markers.iter().enumerate();
    let (moving, resting): (Vec<_>, Vec<_>) = markers.partition(|(_, m)| m.body.is_some());
    let mut any = |of: &[(usize, _)]| {
        let index = chance.between(0.0, of.len() as f64) as usize;
        mechanism.marker_path(biela::mechanism::MarkerId(of[index.min(of.len() - 1)].0))
    };
    let mut text = text.to_owned();
    for (name, kind) in [("m0", "x"), ("m1", "y"), ("m2", "angle")] {
        let (from, to) = (any(&resting), any(&moving));
        let _ = writeln!(
            text,
            "{name} = {{ coordinate = '{kind}', markers = ['{from}', '{to}'] }}"
        );
    }
    text
}

/// # Errors
///
/// The first difference, in words.
fn differences(solver: &mut Solver) -> Result<(), String> {
    let driver = DriverId(0);
    let settings = RangeSettings {
        turns: MOST_TURNS,
        lengths: 10.0,
        ..RangeSettings::default()
    };
    let range = solver.range(driver, &settings);
    let mut joints = solver.mechanism().joints.iter();
    let has_cams = joints.any(|joint| joint.cam().is_some());
    let home = solver.pose().clone();
    let mut scan = Scan::new(solver, driver);
    let ends = [&range.lower, &range.upper].map(|end| value_of(end, driver, home.drivers[0]));
    for end in ends {
        scan.follow(&home, end);
    }
    let Scan { extremes, .. } = scan;
    for (measure, (found, scanned)) in range.measures.iter().zip(&extremes).enumerate() {
        let [least, greatest] = found.each_ref().map(|extreme| extreme.value);
        let size = (greatest - least).abs() + LEAST_RANGE;
        let beyond = [least - scanned[0].0, scanned[1].0 - greatest];
        for (beyond, scanned) in beyond.into_iter().zip(scanned) {
            if beyond > BEYOND * size {
                return Err(format!(
                    "m{measure}: a scan has {} at {}, {:.1e} of the range beyond [{least}, {greatest}]",
                    scanned.0,
                    scanned.1,
                    beyond / size
                ));
            }
        }
        let limits = ends.map(|end| end.unwrap_or(f64::INFINITY));
        for extreme in found {
            let way =
                |limit: &f64| (extreme.driver - limit).abs() > NEAR_LIMIT * (1.0 + limit.abs());
            if !limits.iter().all(way) {
                continue;
            }
            // Not from the start, from which another sub-step may lead there.
            let regular = |sample: &&Sample| sample.rcond > REGULAR;
            let samples = range.samples.iter().filter(regular);
            let samples = samples.map(|sample| &sample.pose);
            let near = samples.min_by(|a, b| {
                let off = |pose: &Pose| (pose.drivers[0] - extreme.driver).abs();
                off(a).total_cmp(&off(b))
            });
            let mut again = Scan::new(solver, driver);
            again.solver.restore(near.expect("there are samples"));
            // Next to a limit that is not located it may not arrive again.
            if !again.go_to(extreme.driver) {
                continue;
            }
            let value = again.solver.measure(measure, &again.rates).value;
            if (value - extreme.value).abs() > SAME * size {
                return Err(format!(
                    "m{measure}: {extreme:?}, but the mechanism has {value} there"
                ));
            }
        }
    }
    let singular = [&range.lower, &range.upper].map(|end| matches!(end, End::Singular(_)));
    let last = [range.samples.first(), range.samples.last()];
    for (is_singular, sample) in singular.into_iter().zip(last) {
        let angle = sample.and_then(|sample| sample.transmission);
        let jams = is_singular && !has_cams;
        if let Some(angle) = angle.filter(|angle| jams && *angle > ZERO) {
            return Err(format!("the transmission angle is {angle} rad at a limit"));
        }
    }
    Ok(())
}

/// Returns the driver's value at an end; `None` where the driver turns on.
fn value_of(end: &End, driver: DriverId, start: f64) -> Option<f64> {
    match end {
        End::Turns(turns) => Some(start + f64::from(*turns) * TAU),
        End::Singular(point) => Some(point.drivers[driver.index()]),
        End::Stop { value, .. }
        | End::Blocked { value, .. }
        | End::Bound { value }
        | End::NotFound { value } => Some(*value),
    }
}

/// A mechanism on its way through the range, and the values that its measures have taken with their
/// places.
struct Scan<'a> {
    solver: &'a mut Solver,
    driver: DriverId,
    path: Path,
    rates: Rates,
    extremes: Vec<[(f64, f64); 2]>,
}

impl<'a> Scan<'a> {
    fn new(solver: &'a mut Solver, driver: DriverId) -> Self {
        let mechanism = Arc::clone(solver.mechanism());
        let none = [(f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0)];
        Self {
            path: Path::new(&mechanism),
            rates: Rates::new(solver.pose().q.len()),
            extremes: vec![none; mechanism.measures.len()],
            solver,
            driver,
        }
    }

    /// Goes from the start to an end of the range.
    fn follow(&mut self, home: &Pose, end: Option<f64>) {
        self.solver.restore(home);
        let start = home.drivers[self.driver.index()];
        let way = end.map_or(0.0, |end| end - start);
        for place in 0..=PLACES {
            let left = 1.0 - f64::from(place) / f64::from(PLACES);
            if !self.go_to(start + way * (1.0 - left * left)) {
                break;
            }
            self.note();
        }
        self.solver.restore(home);
    }

    /// Moves the driver. Returns whether it arrives.
    fn go_to(&mut self, value: f64) -> bool {
        let pose = self.solver.pose();
        let path = &mut self.path;
        pose.set_path(path);
        for (driver_path, here) in path.driver_paths.iter_mut().zip(&pose.drivers) {
            *driver_path = DriverPath::held(*here, *here);
        }
        let index = self.driver.index();
        path.driver_paths[index] = DriverPath::held(value, pose.drivers[index]);
        self.solver.track(path).is_ok()
    }

    fn note(&mut self) {
        let at = self.solver.pose().drivers[self.driver.index()];
        for (measure, [least, greatest]) in self.extremes.iter_mut().enumerate() {
            let value = self.solver.measure(measure, &self.rates).value;
            if value < least.0 {
                *least = (value, at);
            }
            if value > greatest.0 {
                *greatest = (value, at);
            }
        }
    }
}
