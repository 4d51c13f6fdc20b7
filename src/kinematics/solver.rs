//! A mechanism at one pose, with the work space to move it.

use std::sync::Arc;

use super::block::{Crossing, Plan, Work};
use super::certificate::Tubes;
use super::configuration::Configuration;
use super::constraint::{Constraint, Gradient, of_coordinate, point_acceleration, point_velocity};
use super::newton::Rejected;
use super::path::Motions;
use super::path::Rates;
use super::redundancy::SetAside;
use super::structure::Structure;
use super::system::{System, Targets};
use super::{Error, Path};
use crate::mechanism::{DriverId, Jet, MarkerId, Mechanism};

/// Everything that decides where a mechanism is and how it goes on from there.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Time \[s\].
    pub time: f64,
    /// All parameters, derived ones included \[SI\].
    pub parameters: Vec<f64>,
    /// The values u of all drivers \[m or rad\].
    pub drivers: Vec<f64>,
    /// Generalized coordinates, \[m, m, rad\] for each body.
    pub q: Vec<f64>,
    /// Whole turns of the angle rows, one a row of the system.
    pub turns: Vec<i32>,
    /// The change points next to which the mechanism is, none as a rule.
    pub crossings: Vec<Arc<Crossing>>,
}

impl Pose {
    fn copy_from(&mut self, other: &Self) {
        self.crossings.clone_from(&other.crossings);
        self.copy_place(other);
    }

    /// All but the crossings.
    fn copy_place(&mut self, other: &Self) {
        self.time = other.time;
        self.parameters.copy_from_slice(&other.parameters);
        self.drivers.copy_from_slice(&other.drivers);
        self.q.copy_from_slice(&other.q);
        self.turns.copy_from_slice(&other.turns);
    }
}

/// Solves position, velocity and acceleration of one mechanism.
///
/// A solver always stands at a pose. [`assemble`](Self::assemble) finds the first one,
/// [`follow`](Self::follow) moves it continuously, [`restore`](Self::restore) puts it back to a
/// saved one. All storage is made in [`new`](Self::new).
///
/// ```
/// use biela::kinematics::{Path, Solver};
/// use biela::mechanism::{Mechanism, Source};
///
/// let text = include_str!("../../mechanisms/four_bar.toml");
/// let (mechanism, _) = Mechanism::parse(&Source::new("four_bar.toml", text)).unwrap();
/// let mut solver = Solver::new(mechanism.into()).unwrap();
/// let path = Path::new(solver.mechanism());
/// solver.assemble(&path).unwrap();
/// let rocker = solver.mechanism().body_id("rocker").unwrap();
/// let phi = solver.pose().q[3 * rocker.index() + 2];
/// // By the law of cosines.
/// assert!((phi.to_degrees() - 122.824_780).abs() < 1e-6);
/// ```
#[derive(Debug)]
pub struct Solver {
    pub(super) system: System,
    pub(super) structure: Structure,
    /// Redundant rows.
    pub(super) set_aside: SetAside,
    pub(super) measures: Vec<Box<dyn Constraint>>,
    pub(super) plan: Plan,
    pub(super) pose: Pose,
    /// The bodies at the pose, outside of the calls that look for another one.
    pub(super) at: Configuration,
    pub(super) targets: Targets,
    /// Whether `at`, `targets` and the plan are those of the pose's parameters.
    parameters_taken: bool,
    /// Whether the plan has the pivots of its sparse matrices.
    pivots_chosen: bool,
    /// Whether the plan is factorised at the pose, and, with a single driver, `flow` belongs to
    /// the pose.
    pub(super) factorised: bool,
    /// Rates of q: with a single driver the derivatives with respect to its value, from which
    /// all others follow; else those along a path.
    pub(super) flow: Rates,
    /// The prescribed motions for the pose's parameters.
    pub(super) motions: Motions,
    /// Prescribed motions, parameters and drivers along a path on which parameters move.
    pub(super) path_motions: Motions,
    pub(super) path_parameters: Vec<Jet>,
    /// Whether they differ between the ends of the path that is followed.
    pub(super) parameters_move: bool,
    /// Time and parameters where a sub-step starts.
    pub(super) origin_time: f64,
    pub(super) origin_parameters: Vec<f64>,
    pub(super) path_drivers: Vec<Jet>,
    /// The drivers where a sub-step starts.
    pub(super) origin_drivers: Vec<Jet>,
    /// The values of all drivers that a step goes to.
    pub(super) next_drivers: Vec<f64>,
    /// Where everything stays in a sub-step.
    pub(super) tubes: Tubes,
    /// Rates of the drivers that the host gives.
    host_drivers: Vec<Jet>,
    /// The least regularity of all kernels at the pose, when they are factorised there.
    pub(super) regularity: f64,
    /// The change points passed on the path followed last.
    pub(super) crossed: Vec<Arc<Crossing>>,
}

/// Rates were asked for where there are none.
pub(super) const SINGULAR_HERE: Error = Error::Singular {
    rcond: 0.0,
    bodies: Vec::new(),
};

/// The rates of a single driver with respect to its own value.
pub(super) const UNIT: [Jet; 1] = [Jet::new(0.0, [1.0, 0.0])];

impl Solver {
    /// Writes down the equations, analyses their structure and makes all storage.
    ///
    /// # Errors
    ///
    /// [`Error::Structure`] if the drivers do not match the degrees of freedom. Where equations and
    /// unknowns do not pair up, the mechanism is looked at in numbers, at the file's own values;
    /// then also those of [`assemble`](Self::assemble).
    pub fn new(mechanism: Arc<Mechanism>) -> Result<Self, Error> {
        let path = Path::new(&mechanism);
        let system = System::new(Arc::clone(&mechanism));
        let structure = Structure::new(&system, &[]);
        let pairs_up = structure.is_some();
        let structure = structure.unwrap_or_else(|| Structure::of_nothing(&system));
        let order = system.unknowns();
        let drivers = mechanism.drivers.len();
        let pose = Pose {
            time: path.start,
            parameters: path.from,
            drivers: vec![0.0; drivers],
            q: vec![0.0; order],
            turns: vec![0; system.equations().len()],
            crossings: Vec::new(),
        };
        let motions = Motions::new(&mechanism);
        let measures = mechanism.measures.iter();
        let mut solver = Self {
            plan: Plan::new(&system, &structure),
            structure,
            set_aside: SetAside::default(),
            measures: measures
                .map(|measure| of_coordinate(&measure.coordinate))
                .collect(),
            targets: system.targets(),
            parameters_taken: false,
            pivots_chosen: false,
            path_motions: motions.clone(),
            motions,
            path_parameters: vec![Jet::constant(0.0); pose.parameters.len()],
            parameters_move: false,
            origin_time: pose.time,
            origin_parameters: pose.parameters.clone(),
            path_drivers: vec![Jet::constant(0.0); drivers],
            origin_drivers: vec![Jet::constant(0.0); drivers],
            next_drivers: vec![0.0; drivers],
            tubes: Tubes::new(&system),
            host_drivers: vec![Jet::constant(0.0); drivers],
            pose,
            at: system.configuration(),
            regularity: 0.0,
            crossed: Vec::new(),
            factorised: false,
            flow: Rates::new(order),
            system,
        };
        if !pairs_up {
            solver.choose_rows(&Path::new(&mechanism))?;
        }
        Ok(solver)
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        self.system.mechanism()
    }

    /// Its equations.
    #[must_use]
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Which equations determine which unknowns; redundant ones take no part.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Where the mechanism is.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Puts the mechanism back to a pose that this solver, or one of the same mechanism, was at.
    /// Allocates nothing, unless the choice among redundant rows has to change.
    ///
    /// # Panics
    ///
    /// If the pose belongs to another mechanism.
    pub fn restore(&mut self, pose: &Pose) {
        self.parameters_taken &= self.pose.parameters == pose.parameters;
        self.release_crossings();
        self.pose.copy_place(pose);
        if !self.parameters_taken {
            self.take_over_parameters()
                .expect("the parameters of a pose were valid when it was solved");
        }
        self.targets.turns.copy_from_slice(&self.pose.turns);
        if !pose.crossings.is_empty() {
            self.return_to_first_rows();
        }
        self.bridge_all(&pose.crossings);
        self.plan.forget_boxes();
        self.stand_at_pose();
    }

    /// Lets go of what the way to the present pose has left behind, the pivots of sparse
    /// matrices, proofs that hold for several steps and the choice among redundant rows: from here
    /// on everything depends on the pose alone, to the last bit.
    pub fn forget_way(&mut self) {
        self.plan.forget_pivots();
        self.plan.forget_boxes();
        self.stand_at_pose();
        // Where no choice of rows is regular, whoever goes on from here is told.
        let _ = self.stand_on_fit_rows();
    }

    /// Copies the present pose into `pose`, which belongs to the same mechanism. Allocates
    /// nothing.
    pub fn save(&self, pose: &mut Pose) {
        pose.copy_from(&self.pose);
    }

    /// Largest scaled residual of Phi at the present pose: metres over the mechanism's
    /// characteristic length, radians.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.system
            .largest_residual(&self.at, &self.targets, &self.pose.drivers)
    }

    /// Scaled reciprocal condition of the Jacobian at the present pose: 1 is best, 0 singular.
    /// It is that of the part of the mechanism that is nearest to a singular position.
    pub fn rcond(&mut self) -> f64 {
        if self.refresh().is_ok() {
            self.plan.rcond()
        } else {
            0.0
        }
    }

    /// Rates of q at the present pose for given rates of the drivers (`first` and `second` of
    /// each [`Jet`]; `value` is not read), by Ec. 3.6.10 and 3.6.11. Allocates nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular and no rates exist, [`Error::NoMotion`] for
    /// rates of a driver that are not finite.
    pub fn solve_rates(
        &mut self,
        driver: impl Fn(DriverId) -> Jet,
        rates: &mut Rates,
    ) -> Result<(), Error> {
        self.refresh()?;
        let finite = if self.has_unit() {
            let [first, second] = driver(DriverId(0)).derivatives;
            self.flow.run(first, second, rates)
        } else {
            for (index, jet) in self.host_drivers.iter_mut().enumerate() {
                *jet = driver(DriverId(index));
            }
            let mut work = Work {
                system: &self.system,
                targets: &self.targets,
                drivers: &self.pose.drivers,
                at: &mut self.at,
                flow: rates,
            };
            self.plan.solve_rates(&mut work, &self.host_drivers);
            rates.is_finite()
        };
        if finite {
            Ok(())
        } else {
            Err(self.why_no_rates(driver))
        }
    }

    /// Why there are no finite rates for these rates of the drivers.
    #[cold]
    fn why_no_rates(&self, driver: impl Fn(DriverId) -> Jet) -> Error {
        let mut drivers = (0..self.pose.drivers.len()).map(DriverId);
        let endless =
            drivers.find(|&id| !driver(id).derivatives.iter().all(|rate| rate.is_finite()));
        endless.map_or(SINGULAR_HERE, |id| Error::NoMotion {
            driver: self.system.describe_driver(id),
            quantity: "velocity or acceleration",
        })
    }

    /// Value, rate and acceleration of a measure of the mechanism at the present pose. Allocates
    /// nothing.
    #[must_use]
    pub fn measure(&self, index: usize, rates: &Rates) -> Jet {
        let measure = &self.measures[index];
        let mut gradient = Gradient::new();
        measure.gradient(&self.at, &mut gradient);
        let (q_dot, q_ddot) = (rates.velocity(), rates.acceleration());
        let acceleration = gradient.dot(q_ddot) + measure.quadratic(&self.at, q_dot);
        Jet::new(measure.value(&self.at), [gradient.dot(q_dot), acceleration])
    }

    /// Point, velocity and acceleration of a marker: the x component, then the y component.
    #[must_use]
    pub fn marker(&self, marker: MarkerId, rates: &Rates) -> [Jet; 2] {
        let marker = self.at.marker(marker);
        let velocity = point_velocity(marker, rates.velocity());
        let acceleration = point_acceleration(marker, rates.velocity(), rates.acceleration());
        [0, 1].map(|component| {
            let rates = [velocity[component], acceleration[component]];
            Jet::new(marker.point[component], rates)
        })
    }

    /// Value, velocity and acceleration of a driver with a prescribed motion at a time, for the
    /// pose's parameters. Parameters contribute nothing to velocities, even while they change.
    /// Not a number for an input. Allocates nothing.
    #[must_use]
    pub fn motion(&self, driver: DriverId, time: f64) -> Jet {
        self.motions.evaluate(driver, Jet::variable(time))
    }

    /// Recomputes all that depends on the parameters of the pose alone.
    pub(super) fn take_over_parameters(&mut self) -> Result<(), Error> {
        self.parameters_taken = false;
        self.system
            .set_parameters(&self.pose.parameters, &mut self.at, &mut self.targets)?;
        self.plan
            .set_parameters(&self.at, &self.targets, &mut self.tubes);
        if !self.pivots_chosen {
            self.plan
                .choose_pivots(&self.system, &self.at, &self.targets);
            self.pivots_chosen = true;
        }
        let parameters = &self.pose.parameters;
        self.motions
            .set_parameters(|p| Jet::constant(parameters[p.index()]));
        self.parameters_taken = true;
        Ok(())
    }

    /// The plan, and what it works on.
    pub(super) fn work(&mut self) -> (&mut Plan, Work<'_>) {
        let work = Work {
            system: &self.system,
            targets: &self.targets,
            drivers: &self.pose.drivers,
            at: &mut self.at,
            flow: &mut self.flow,
        };
        (&mut self.plan, work)
    }

    /// Whether the motion runs along the values of one driver.
    pub(super) fn has_unit(&self) -> bool {
        self.pose.drivers.len() == 1
    }

    /// Moves the bodies to the pose.
    pub(super) fn stand_at_pose(&mut self) {
        self.factorised = false;
        self.at.set_pose(self.system.mechanism(), &self.pose.q);
    }

    /// Makes sure that the plan is factorised at the pose.
    pub(super) fn refresh(&mut self) -> Result<(), Error> {
        if !self.factorised {
            let unit = self.has_unit();
            let (plan, mut work) = self.work();
            plan.factorise(&mut work)
                .map_err(|Rejected| SINGULAR_HERE)?;
            if unit {
                plan.solve_rates(&mut work, &UNIT);
            }
            self.regularity = self.plan.regularity();
            self.factorised = true;
        }
        Ok(())
    }
}
