//! Static equilibrium on contacts and with friction.
//!
//! At rest the freedoms u feel the forces Q of all that acts on the bodies but contacts, whose gaps are g,
//! and dry friction. At a stable equilibrium contacts push with λ so that
//!
//! > Q + Aᵀ λ = 0, g ≥ 0, λ ≥ 0, λ g = 0, A = ∂g/∂u
//!
//! and K = −∂(Q + Aᵀ λ)/∂u has no negative eigenvalue on the motions that leave these contacts closed. The
//! mechanism comes down in steps that solve the conditions for Q and g linearised at the pose (sequential
//! quadratic programming).

use nalgebra::DVector;

use super::error::Error;
use super::given::Given;
use super::held::Held;
use super::motion::FreeMotion;
use super::passive::Mode;
use super::statics::{Side, Statics, longest};
use crate::kinematics::{Blocked, DriverPath, Path, Rates, Reason, Solution, Solver};
use crate::mechanism::{DriverId, Order, Signal};

/// Longest change of an angle \[rad\] or of a length, in sizes of the mechanism, in one step. Sines are
/// straight to 5 % over it. Halved, a long way down takes twice the steps; doubled, steps may lead over
/// a hill into the next valley.
pub(super) const LONGEST: f64 = 0.3;
/// Halvings of a step in front of an obstacle, to a millionth. With half as many a stiff elastic stop
/// would be overrun; more make no difference.
const MOST_HALVINGS: usize = 20;

/// A stable equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// The values of all drivers and freedoms of the file \[m or rad\].
    pub drivers: Vec<f64>,
    /// x, y and φ of each body, then the other unknowns.
    pub q: Vec<f64>,
    /// Contacts that push, and friction that holds.
    pub held: Vec<Held>,
    /// Forces of friction, by their index in the mechanism, that are left out: they do not suffice on the
    /// way.
    pub left_out: Vec<usize>,
}

impl FreeMotion {
    /// Moves the mechanism, with all inputs held, from the solver's pose to a stable equilibrium, downhill
    /// without a swing. The freedoms are at rest there. Near a dead point of the coordinates in use it
    /// goes on in others, and returns to those of the file if they are coordinates there.
    ///
    /// Friction that sticks at the start holds while its force suffices. What gives way is left out from
    /// then on: the equilibrium is that of all other forces.
    ///
    /// # Errors
    ///
    /// [`Error::NoEquilibrium`] if none is found.
    pub fn balance(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
    ) -> Result<Equilibrium, Error> {
        let passive = &self.equations.passive;
        let is_friction = |k: &usize| passive.list[*k].cause.friction().is_some();
        let frictions = (0..passive.list.len()).filter(is_friction).collect();
        self.balance_with(solver, solution, given, frictions)
    }

    /// Moves the mechanism to a stable equilibrium, while some friction holds as long as it suffices.
    pub(super) fn balance_with(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        mut sticking: Vec<usize>,
    ) -> Result<Equilibrium, Error> {
        let pushes = loop {
            let pushes = self.come_down(solver, solution, given, &sticking)?;
            self.begin_at_rest(solver, given)?;
            let before = sticking.len();
            sticking.retain(|k| self.rests(*k));
            if sticking.len() == before {
                break pushes;
            }
        };
        if self.return_to_own(solver, solution)? {
            self.begin_at_rest(solver, given)?;
        }
        self.tell(solution);
        Ok(self.equilibrium(solver, &sticking, &pushes))
    }

    /// Begins at rest at the solver's pose, which is no start: nothing is told of it.
    fn begin_at_rest(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        self.restart(solver, given, |_| 0.0)?;
        self.overlaps().for_each(drop);
        Ok(())
    }

    /// Returns whether friction holds its coordinate at rest at the accepted point: it sticks, or exerts what it
    /// can and others hold the rest.
    fn rests(&self, friction: usize) -> bool {
        let at = &self.equations.accepted.passive[friction];
        let is_still = at.coordinate.second().abs() <= at.slow(Order::Acceleration);
        self.equations.passive.modes[friction] == Mode::Sticking || is_still && at.force != 0.0
    }

    /// Returns the equilibrium at the accepted point, with these pushes of contacts if no friction holds:
    /// what is left out would share the load.
    fn equilibrium(&self, solver: &Solver, sticking: &[usize], pushes: &[f64]) -> Equilibrium {
        let drivers = (0..solver.mechanism().drivers.len()).map(DriverId);
        let still = Rates::new(solver.pose().q.len());
        let drivers = drivers.map(|id| {
            let value = solver.signal(Signal::Motion(id), &still, self.drivers());
            value.value
        });
        let (passive, points) = (&self.equations.passive, &self.equations.accepted.passive);
        // Friction without a limit, as a viscous one, never holds.
        let left_out = (0..points.len()).filter(|k| {
            passive.list[*k].cause.friction().is_some()
                && self.equations.moves(*k)
                && !sticking.contains(k)
                && points[*k].bounds[1] > 0.0
        });
        let left_out: Vec<usize> = left_out.map(|k| passive.list[k].index).collect();
        let held = (0..points.len()).filter_map(|k| {
            let cause = &passive.list[k].cause;
            let takes_pushes = sticking.is_empty() && cause.is_contact();
            let (acts, size) = match cause.friction() {
                Some(_) => (
                    sticking.contains(&k) && self.equations.moves(k),
                    points[k].force,
                ),
                None if takes_pushes => (pushes[k] != 0.0, pushes[k]),
                None => {
                    let pushes = matches!(passive.modes[k], Mode::AtMin | Mode::AtMax);
                    (pushes, points[k].force)
                }
            };
            acts.then(|| self.holding(k, size))
        });
        Equilibrium {
            drivers: drivers.collect(),
            q: solver.pose().q.clone(),
            held: held.collect(),
            left_out,
        }
    }

    /// Moves the mechanism to a stable equilibrium while some friction holds, and returns the pushes of
    /// contacts along their coordinates there, zero if friction lets nothing move.
    fn come_down(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        sticking: &[usize],
    ) -> Result<Vec<f64>, Error> {
        /// Steps far beyond those of any mechanism that has an equilibrium.
        const MOST_STEPS: usize = 200;
        /// A step below this is rounding, some hundred of a place. Halved, most mechanisms end by the
        /// rule below; doubled, places are as much less exact.
        const AT_REST: f64 = 1e-13;
        /// A step below this that is not much shorter than the one before is the rounding of forces
        /// on soft springs. Steps that converge are shorter by far.
        const NEARLY_AT_REST: f64 = 1e-9;
        /// Part of the scales by which the mechanism leaves an unstable equilibrium: forces there are
        /// far above rounding, and the next valley is as good as on the way.
        const ASIDE: f64 = 0.01;
        let mut pushes = vec![0.0; self.equations.passive.list.len()];
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            self.stand(solver, given)?;
            let better = self.charts.better(solver, self.equations.motion());
            if let Some(coordinates) = better
                && self.change_chart(solver, solution, coordinates)?
            {
                self.stand(solver, given)?;
            }
            let scales = self.scales();
            let statics = self.statics(solver, sticking, &pushes)?;
            if statics.is_held() {
                return Ok(pushes);
            }
            let (changes, found) = statics.step(&pushes, &scales);
            pushes = found;
            let length = longest(&changes, &scales);
            let is_rounding = length <= NEARLY_AT_REST && length > 0.5 * before;
            before = length;
            // A contact that pushes has to be closed, to be seen.
            let are_closed = statics.are_closed(&pushes);
            if are_closed && (length <= AT_REST || is_rounding) {
                let Some(way) = statics.way_down(&pushes) else {
                    return Ok(pushes);
                };
                let way = &way * (ASIDE / longest(&way, &scales));
                let gone = self.go_by(solver, &way, false);
                gone.map_err(|error| blocked(solver, &error))?;
                continue;
            }
            let part = (LONGEST / length).min(1.0);
            self.go_down(solver, given, &statics, &pushes, changes * part)?;
        }
        Err(Error::NoEquilibrium)
    }

    /// Moves the mechanism by these changes, or by as large a part of them as leads downhill.
    fn go_down(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        statics: &Statics,
        pushes: &[f64],
        mut changes: DVector<f64>,
    ) -> Result<(), Error> {
        /// Part of the force along a step with which it may push back at the end of the step. Zero would
        /// halve each last step, which ends on either side; one would let steps alternate.
        const OVERSHOOT: f64 = 0.5;
        /// Part of a gap, of a radian or of the mechanism's size by which a step may lead beyond a
        /// contact: the next one leads back. A step of the longest size along a round stop leads beyond
        /// by half of that.
        const BEYOND: f64 = 0.1;
        let start = solver.pose().clone();
        // The tracker would not let a coordinate slide along a stop that is not straight.
        let watches_stops = !statics.sides.iter().any(Side::is_closed);
        let force = self.forces_at_rest(solver, pushes)?.0;
        let scales = self.scales();
        for halvings in 0.. {
            let is_last = halvings == MOST_HALVINGS;
            match self.go_by(solver, &changes, watches_stops) {
                Ok(()) => {
                    self.stand(solver, given)?;
                    let sides = self.sides(solver);
                    let is_beyond = |before: &Side| {
                        let side = sides.iter().find(|side| before.is_same(side));
                        side.is_none_or(|side| side.gap < -BEYOND * (before.gap + side.scale))
                    };
                    let (end, _) = self.forces_at_rest(solver, pushes)?;
                    let overshoots = end.dot(&changes) < -OVERSHOOT * force.dot(&changes).max(0.0);
                    if is_last || !overshoots && !statics.sides.iter().any(is_beyond) {
                        break;
                    }
                }
                Err(Blocked {
                    reason: Reason::Stop(_),
                    s,
                    ..
                }) if watches_stops && s * longest(&changes, &scales) > 0.0 => break,
                Err(error) if is_last => return Err(blocked(solver, &error)),
                Err(_) => {}
            }
            solver.restore(&start);
            changes *= 0.5;
        }
        Ok(())
    }

    /// Moves the mechanism by changes of the freedoms' values, to the first stop or through stops.
    pub(super) fn go_by(
        &self,
        solver: &mut Solver,
        changes: &DVector<f64>,
        watches_stops: bool,
    ) -> Result<(), Blocked> {
        let mut path = Path::new(solver.mechanism());
        let pose = solver.pose();
        path.start = pose.time;
        path.from.copy_from_slice(&pose.parameters);
        path.to.copy_from_slice(&pose.parameters);
        for (driver_path, now) in path.driver_paths.iter_mut().zip(&pose.drivers) {
            *driver_path = DriverPath::held(*now, *now);
        }
        for (freedom, change) in self.freedoms().iter().zip(changes) {
            let now = pose.drivers[freedom.index()];
            path.driver_paths[freedom.index()] = DriverPath::held(now + change, now);
        }
        let tracked = if watches_stops {
            solver.track(&path)
        } else {
            solver.track_past_stops(&path, None)
        };
        tracked.map(|_| ())
    }

    /// Goes on in other coordinates, at rest or with the velocities of the equations. Returns false if
    /// they are none of the mechanism.
    pub(super) fn change_chart(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        coordinates: Vec<usize>,
    ) -> Result<bool, Error> {
        let Self {
            equations,
            charts,
            x,
            ..
        } = self;
        let changes = charts.exchange(solver, equations, solution, coordinates, x)?;
        if changes {
            self.renew_control()?;
            self.equations.accept(solver);
        }
        Ok(changes)
    }

    /// Returns to the freedoms of the file, unless their coordinates are at a dead point. Returns whether
    /// the coordinates are others then.
    fn return_to_own(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
    ) -> Result<bool, Error> {
        let own: Vec<usize> = (0..self.freedoms().len()).collect();
        if self.charts.current() == own || !self.charts.own_is_fit(solver, self.equations.motion())
        {
            return Ok(false);
        }
        self.x[own.len()..].fill(0.0);
        self.change_chart(solver, solution, own)
    }
}

/// Returns the error of a way that ends.
fn blocked(solver: &Solver, blocked: &Blocked) -> Error {
    Error::Blocked(blocked.describe(solver.mechanism(), solver.pose(), None, |_| true))
}
