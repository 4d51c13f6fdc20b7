//! A body that is pulled: the drivers follow until the grip is as near to the hand as they can
//! bring it.

use nalgebra::{DMatrix, DVector, Vector2};

use super::outcome::{Obstacle, Outcome};
use super::session::Session;
use biela::kinematics::{DriverPath, Rates};
use biela::mechanism::{BodyId, DriverId, Jet, PrescribedMotion};

/// Most steps towards the hand per call.
const MOST_STEPS: usize = 60;
/// Most halvings of a step that leads away from the hand.
const MOST_HALVINGS: usize = 24;
/// Largest step of an angle \[rad\]; a longer way takes several.
const LARGEST_ANGLE: f64 = 0.35;
/// Largest step of a length or of time, as a part of its range.
const LARGEST_PART: f64 = 0.1;
/// A step below this part of the largest is the last one: Newton's method doubles its digits.
const LAST: f64 = 1e-7;
/// Part of the largest step that is tried where there is no tangent, at a dead point.
const FEELER: f64 = 1e-3;
/// Largest angle between the hand and the way of the grip that still counts as across \[rad\].
const ACROSS: f64 = 1e-12;

/// A variable that the hand moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handle {
    Driver(DriverId),
    Time,
}

/// The grip and its derivatives by the handles.
struct Grip {
    point: Vector2<f64>,
    first: Vec<Vector2<f64>>,
    second: Vec<Vector2<f64>>,
}

impl Session {
    /// Returns the point of a body, in its frame \[m\], that is now at a global point.
    #[must_use]
    pub fn grip(&self, body: BodyId, at: [f64; 2]) -> [f64; 2] {
        let [x, y, phi] = self.place_of(body);
        let (sin, cos) = phi.sin_cos();
        let [dx, dy] = [at[0] - x, at[1] - y];
        [cos * dx + sin * dy, cos * dy - sin * dx]
    }

    /// Pulls the point `grip` of a body, in its frame, towards a global point: the drivers that are
    /// inputs and the freedoms take the values nearby at which it is nearest; freedoms rest there. If
    /// all drivers are prescribed motions, time runs instead.
    ///
    /// The limits of the drivers hold; a dead point on the way stops the mechanism there.
    pub fn drag(&mut self, body: BodyId, grip: [f64; 2], target: [f64; 2]) -> Outcome {
        let handles = self.handles();
        let is_known = body.index() < self.mechanism().bodies.len();
        if handles.is_empty() || !is_known || !target.iter().all(|x| x.is_finite()) {
            return Outcome::Refused(Obstacle::new("nothing moves this body"));
        }
        self.take();
        let outcome = self.pull(&handles, body, grip, Vector2::from(target));
        self.release_moved(true);
        outcome
    }

    fn pull(
        &mut self,
        handles: &[Handle],
        body: BodyId,
        grip: [f64; 2],
        target: Vector2<f64>,
    ) -> Outcome {
        let mut stop = None;
        for _ in 0..MOST_STEPS {
            let Some(now) = self.grip_motion(handles, body, grip) else {
                return match self.feel(handles, body, grip, target) {
                    Some(obstacle) => Outcome::Stopped(obstacle),
                    None => continue,
                };
            };
            let away = target - now.point;
            let reach: f64 = now.first.iter().map(Vector2::norm).sum();
            if reach == 0.0 {
                return Outcome::Refused(Obstacle::new("no driver moves this point"));
            }
            let Some(mut step) = newton_step(&now, away) else {
                break;
            };
            let largest: Vec<f64> = handles.iter().map(|handle| self.largest(*handle)).collect();
            let relative = |step: &[f64]| {
                let parts = step
                    .iter()
                    .zip(&largest)
                    .map(|(step, most)| step.abs() / most);
                parts.fold(0.0, f64::max)
            };
            let size = relative(&step);
            if size > 1.0 {
                step.iter_mut().for_each(|step| *step /= size);
            }
            let limit = self.keep_to_limits(handles, &mut step);
            let size = relative(&step);
            if size < 1e-15 {
                return limit.map_or(Outcome::Reached, Outcome::Stopped);
            }
            let before = self.pose().clone();
            let mut nearer = false;
            for _ in 0..MOST_HALVINGS {
                let outcome = self.move_handles(handles, &step);
                let point = self.point(body, grip);
                nearer = (target - point).norm() < away.norm();
                match outcome {
                    Outcome::Reached if nearer || relative(&step) < LAST => {
                        nearer = true;
                        break;
                    }
                    // At the dead point, and nearer to the hand than before.
                    Outcome::Stopped(obstacle) if nearer => return Outcome::Stopped(obstacle),
                    Outcome::Stopped(obstacle) => stop = Some(obstacle),
                    _ => {}
                }
                self.motion.solver.restore(&before);
                step.iter_mut().for_each(|step| *step *= 0.5);
            }
            if !nearer {
                self.motion.solver.restore(&before);
                break;
            }
            if size < LAST {
                return Outcome::Reached;
            }
        }
        stop.map_or(Outcome::Reached, Outcome::Stopped)
    }

    /// Tries a small step each way where there is no tangent. Returns the obstacle if none leads
    /// nearer to the hand.
    fn feel(
        &mut self,
        handles: &[Handle],
        body: BodyId,
        grip: [f64; 2],
        target: Vector2<f64>,
    ) -> Option<Obstacle> {
        let before = self.pose().clone();
        let away = (target - self.point(body, grip)).norm();
        let mut stop = Obstacle::new("the mechanism is at a dead point");
        for index in 0..handles.len() {
            for sign in [1.0, -1.0] {
                let mut step = vec![0.0; handles.len()];
                step[index] = sign * FEELER * self.largest(handles[index]);
                let outcome = self.move_handles(handles, &step);
                if (target - self.point(body, grip)).norm() < away && outcome == Outcome::Reached {
                    return None;
                }
                if let Outcome::Stopped(obstacle) = outcome {
                    stop = obstacle;
                }
                self.motion.solver.restore(&before);
            }
        }
        Some(stop)
    }

    /// Returns what the hand moves: the drivers that are inputs, or time.
    fn handles(&self) -> Vec<Handle> {
        let drivers = self.mechanism().drivers.iter().enumerate();
        let inputs = drivers.filter(|(_, driver)| driver.motion().is_none());
        let inputs: Vec<Handle> = inputs
            .map(|(index, _)| Handle::Driver(DriverId(index)))
            .collect();
        if inputs.is_empty() && self.mechanism().uses_time() {
            return vec![Handle::Time];
        }
        inputs
    }

    fn largest(&self, handle: Handle) -> f64 {
        match handle {
            Handle::Time => {
                let simulation = &self.mechanism().simulation;
                LARGEST_PART * LARGEST_PART * (simulation.stop - simulation.start)
            }
            Handle::Driver(driver) => {
                let own = &self.mechanism().drivers[driver.index()];
                let range = &self.ranges[driver.index()];
                let width = range.as_ref().map_or_else(
                    || self.motion.solver.size(),
                    |range| range.ends[1] - range.ends[0],
                );
                if own.coordinate.kind.is_angle() {
                    LARGEST_ANGLE
                } else if width > 0.0 {
                    LARGEST_PART * width
                } else {
                    LARGEST_PART
                }
            }
        }
    }

    /// Shortens steps that lead beyond the limits of drivers or of time. Returns the limit.
    fn keep_to_limits(&self, handles: &[Handle], step: &mut [f64]) -> Option<Obstacle> {
        let mechanism = self.mechanism();
        let mut met = None;
        for (handle, step) in handles.iter().zip(step) {
            let (now, [low, high], name) = match handle {
                Handle::Time => {
                    let simulation = &mechanism.simulation;
                    let ends = [simulation.start, simulation.stop];
                    (self.pose().time, ends.map(Some), "time")
                }
                Handle::Driver(driver) => {
                    let own = &mechanism.drivers[driver.index()];
                    (
                        self.pose().drivers[driver.index()],
                        [own.min, own.max],
                        &*own.name,
                    )
                }
            };
            // A value beyond its limits may stay there, and may return.
            let low = low.map_or(f64::NEG_INFINITY, |low| low.min(now));
            let high = high.map_or(f64::INFINITY, |high| high.max(now));
            let to = now + *step;
            if !(low..=high).contains(&to) {
                *step = to.clamp(low, high) - now;
                met = Some(Obstacle::new(format!("`{name}` is at its limit")));
            }
        }
        met
    }

    fn move_handles(&mut self, handles: &[Handle], step: &[f64]) -> Outcome {
        let path = self.path_here();
        for (handle, step) in handles.iter().zip(step) {
            match handle {
                Handle::Time if *step < 0.0 => {
                    let to = path.start + step;
                    return self.go_to(to);
                }
                Handle::Time => path.duration = *step,
                Handle::Driver(driver) => {
                    let driver_path = &mut path.driver_paths[driver.index()];
                    if let DriverPath::Input { position, .. } = *driver_path {
                        *driver_path = DriverPath::held(position + step, position);
                    }
                }
            }
        }
        let moves = |id| handles.contains(&Handle::Driver(id)) || handles.contains(&Handle::Time);
        self.follow(moves)
    }

    pub(super) fn place_of(&self, body: BodyId) -> [f64; 3] {
        [0, 1, 2].map(|k| self.pose().q[3 * body.index() + k])
    }

    /// Returns the global place of a point of a body.
    pub(super) fn point(&self, body: BodyId, grip: [f64; 2]) -> Vector2<f64> {
        let [x, y, phi] = self.place_of(body);
        let (sin, cos) = phi.sin_cos();
        let [u, v] = grip;
        Vector2::new(x + cos * u - sin * v, y + sin * u + cos * v)
    }

    /// Returns a point of a body with its derivatives by each handle; nothing at a dead point.
    fn grip_motion(&mut self, handles: &[Handle], body: BodyId, grip: [f64; 2]) -> Option<Grip> {
        let point = self.point(body, grip);
        let [x, y, _] = self.place_of(body);
        let arm = point - Vector2::new(x, y);
        let across = Vector2::new(-arm.y, arm.x);
        let mut rates = Rates::new(self.pose().q.len());
        let mut motion = Grip {
            point,
            first: Vec::new(),
            second: Vec::new(),
        };
        for handle in handles {
            let jets: Vec<Jet> = (0..self.mechanism().drivers.len())
                .map(|index| match handle {
                    Handle::Time => match self.mechanism().drivers[index].motion() {
                        Some(PrescribedMotion::Expression(_) | PrescribedMotion::Table(_)) => {
                            self.motion.solver.motion(DriverId(index), self.pose().time)
                        }
                        None => Jet::constant(0.0),
                    },
                    Handle::Driver(driver) => {
                        let unit = f64::from(u8::from(driver.index() == index));
                        Jet::new(0.0, [unit, 0.0])
                    }
                })
                .collect();
            (self.motion.solver)
                .solve_rates(|driver| jets[driver.index()], &mut rates)
                .ok()?;
            let of_body = |values: &[f64]| [0, 1, 2].map(|k| values[3 * body.index() + k]);
            let [vx, vy, omega] = of_body(rates.velocity());
            let [ax, ay, alpha] = of_body(rates.acceleration());
            motion.first.push(Vector2::new(vx, vy) + omega * across);
            let second = Vector2::new(ax, ay) + alpha * across - omega * omega * arm;
            motion.second.push(second);
        }
        Some(motion)
    }
}

/// Returns the step of the handles towards the place nearest to the hand, `away` from the grip. By
/// Newton's method where the distance curves upwards along the way of the grip, otherwise as far as
/// the tangent leads. `None` where no step leads nearer.
fn newton_step(grip: &Grip, away: Vector2<f64>) -> Option<Vec<f64>> {
    if let ([first], [second]) = (&grip.first[..], &grip.second[..]) {
        let slope = first.dot(&away);
        if slope.abs() <= ACROSS * first.norm() * away.norm() {
            return None;
        }
        let square = first.norm_squared();
        let curvature = square - away.dot(second);
        let curvature = if curvature > 0.1 * square {
            curvature
        } else {
            square
        };
        return Some(vec![slope / curvature]);
    }
    // Least squares, with as little motion as the hand demands where handles are many.
    let count = grip.first.len();
    let square = DMatrix::from_fn(count, count, |i, j| grip.first[i].dot(&grip.first[j]));
    let slope = DVector::from_fn(count, |i, _| grip.first[i].dot(&away));
    let damping = 1e-9 * square.trace();
    let damped = square + DMatrix::identity(count, count) * damping;
    let step = damped.lu().solve(&slope)?;
    Some(step.iter().copied().collect())
}
