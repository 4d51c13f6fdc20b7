//! A mechanism at places in the range of a driver, moving there at a constant speed.

use std::sync::Arc;

use biela::kinematics::{DriverPath, Error, Path, Pose, Range, Sample, Solution, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism, shown};

/// Reciprocal condition of a limit that is located to rounding. A pose in front of one, where the
/// tracker stops, has the root of it.
const SINGULAR: f64 = 1e-10;

/// A solver that visits places in the range of a driver; the others are at rest.
pub(super) struct Follower<'a> {
    pub(super) solver: &'a mut Solver,
    pub(super) mechanism: Arc<Mechanism>,
    driver: DriverId,
    pub(super) solution: Solution,
    /// The samples of the range without its ends, where two motions may meet.
    samples: &'a [Sample],
    home: Pose,
    path: Path,
}

impl<'a> Follower<'a> {
    /// Makes a follower of a driver that moves at a speed \[m/s or rad/s\] in its range from the
    /// solver's pose.
    pub(super) fn new(
        solver: &'a mut Solver,
        driver: DriverId,
        range: &'a Range,
        speed: f64,
    ) -> Self {
        let mechanism = Arc::clone(solver.mechanism());
        let home = solver.pose().clone();
        let mut solution = Solution::new(solver);
        solution.driver_rates[driver.index()] = Jet::linear(0.0, speed);
        let mut path = Path::new(&mechanism);
        home.set_path(&mut path);
        let values = path.driver_paths.iter_mut().zip(&home.drivers);
        values.for_each(|(driver_path, value)| *driver_path = DriverPath::held(*value, *value));
        Self {
            solver,
            mechanism,
            driver,
            solution,
            samples: inner(&range.samples),
            home,
            path,
        }
    }

    /// Moves to a sample of the range.
    ///
    /// # Errors
    ///
    /// The mechanism has no velocities there, as at a limit, or no forces where they are sought.
    pub(super) fn visit(&mut self, sample: &Sample) -> Result<(), Error> {
        self.solver.restore(&sample.pose);
        if sample.rcond < SINGULAR && sample.pose.crossings.is_empty() {
            return Err(Error::Singular {
                rcond: sample.rcond,
                bodies: Vec::new(),
                aside: None,
            });
        }
        self.solution.solve(self.solver)
    }

    /// Follows the driver to a value in its range, from where it is or a pose known nearer by.
    /// Returns `None` where it cannot go, or without rates or forces there. Where it cannot go it
    /// returns to the known pose: two motions may meet where it stopped.
    pub(super) fn follow(&mut self, value: f64) -> Option<()> {
        let index = self.driver.index();
        let distance = |pose: &Pose| (pose.drivers[index] - value).abs();
        let poses = self.samples.iter().map(|sample| &sample.pose);
        let nearest = poses.fold(&self.home, |nearest, pose| {
            if distance(pose) < distance(nearest) {
                pose
            } else {
                nearest
            }
        });
        if distance(nearest) < distance(self.solver.pose()) {
            self.solver.restore(nearest);
        }
        self.path.driver_paths[index] = DriverPath::held(value, self.solver.pose().drivers[index]);
        if self.solver.track(&self.path).is_err() {
            self.solver.restore(nearest);
            return None;
        }
        self.solution.solve(self.solver).ok()
    }

    /// Returns to the pose at the start.
    pub(super) fn restore(&mut self) {
        self.solver.restore(&self.home);
    }
}

impl Drop for Follower<'_> {
    fn drop(&mut self) {
        self.restore();
    }
}

/// Returns the samples between the first and the last one.
fn inner(samples: &[Sample]) -> &[Sample] {
    match samples {
        [_, inner @ .., _] => inner,
        _ => &[],
    }
}

/// Says how fast the driver moves.
pub(super) fn at_speed(mechanism: &Mechanism, driver: DriverId, speed: f64) -> String {
    if speed == 0.0 {
        return "at rest".to_owned();
    }
    let kind = mechanism.drivers[driver.index()].coordinate.kind;
    let unit = if kind.is_angle() { "rad/s" } else { "m/s" };
    format!("at {} {unit}", shown(speed))
}

/// Says at which samples a quantity has no value: "at 0 deg", "at 3 of 361 poses, first at 0 deg".
pub(super) fn without_value(
    missing: &[f64],
    samples: usize,
    place: impl Fn(f64) -> String,
) -> String {
    match missing {
        [only] => format!("at {}", place(*only)),
        [first, ..] => {
            let count = missing.len();
            format!("at {count} of {samples} poses, first at {}", place(*first))
        }
        [] => String::new(),
    }
}
