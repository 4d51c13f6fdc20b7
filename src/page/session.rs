//! A mechanism at one pose, and its moves.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde_json::{Value, json};

use super::edit::{EditError, Place, edit};
use super::outcome::{Obstacle, Outcome};
use super::quantity::{Moment, Quantity, shown_in};
use crate::drawing::animation::MovingPicture;
use crate::drawing::{Scene, Sheet, svg};
use crate::kinematics::{
    Curve, End, ForceParts, Forces, KnownMotion, Path, Pose, RangeSettings, Rates, Solver,
};
use crate::mechanism::{
    DisplayUnit, DriverId, Jet, Mechanism, Motion, ParameterId, Severity, Source, Unit,
};

/// Resolution and extent of the ranges of drivers: steps of three degrees, one turn, lengths up to
/// the size of the mechanism.
const RANGE: RangeSettings = RangeSettings {
    samples: 120,
    turns: 1,
    lengths: 1.0,
    bounds: [None; 2],
};
/// Time that a driver takes for a turn, or from one end of its range to the other \[s\].
const PERIOD: [f64; 2] = [4.0, 2.0];
/// Most states that can be undone.
const MOST_KEPT: usize = 200;

/// A mechanism that its reader moves by hand.
pub struct Session {
    source: Source,
    /// Warnings about the file, one line each.
    warnings: Vec<String>,
    pub(super) solver: Solver,
    /// The pose at the start of the simulation, from which times are reached.
    start: Pose,
    pub(super) rates: Rates,
    /// Rates of the drivers; those of inputs are the reader's.
    pub(super) driver_rates: Vec<Jet>,
    /// Whether the rates belong to the pose, where they exist.
    pub(super) has_rates: bool,
    pub(super) forces: Option<Box<Forces>>,
    force_inputs: Vec<f64>,
    pub(super) picture: MovingPicture,
    pub(super) quantities: Vec<Quantity>,
    pub(super) length: Option<DisplayUnit>,
    pub(super) ranges: Vec<Option<DriverRange>>,
    path: Path,
    home: Kept,
    undone: Vec<Kept>,
    kept: Vec<Kept>,
    /// The assembly modes listed last, with their bodies.
    pub(super) modes: Vec<Vec<f64>>,
}

/// The range of a driver that is an input.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DriverRange {
    /// The ends \[m or rad\]; of a driver that turns fully, one turn.
    pub(super) ends: [f64; 2],
    /// Whether the driver turns fully.
    pub(super) turns: bool,
}

/// A state to which the reader can return.
#[derive(Clone)]
struct Kept {
    mechanism: Arc<Mechanism>,
    pose: Pose,
    start: Pose,
}

impl Session {
    /// Reads a mechanism and assembles it.
    ///
    /// # Errors
    ///
    /// The problems of the file, one line each, or the reason why the mechanism does not assemble.
    pub fn open(source: Source) -> Result<Self, Vec<String>> {
        let (mechanism, diagnostics) = Mechanism::parse(&source).map_err(|diagnostics| {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            errors.map(|d| d.one_line(&source)).collect::<Vec<_>>()
        })?;
        let warnings = diagnostics.iter().map(|d| d.one_line(&source)).collect();
        let refuse = |error: crate::kinematics::Error| vec![error.to_string()];
        let mechanism = Arc::new(mechanism);
        let path = Path::new(&mechanism);
        let mut solver = Solver::new(Arc::clone(&mechanism)).map_err(refuse)?;
        solver.assemble(&path).map_err(refuse)?;
        let pose = solver.pose().clone();
        let forces = mechanism.has_dynamics().then(|| Box::new(solver.forces()));
        let (ranges, reached) = ranges(&mut solver);
        let driver_rates = speeds(&mechanism, &ranges);
        let home = Kept {
            mechanism: Arc::clone(&mechanism),
            start: pose.clone(),
            pose,
        };
        let mut session = Self {
            warnings,
            start: home.start.clone(),
            rates: Rates::new(home.pose.q.len()),
            driver_rates,
            has_rates: false,
            force_inputs: vec![0.0; forces.as_ref().map_or(0, |forces| forces.inputs())],
            forces,
            picture: MovingPicture::new(&mut solver, &reached, None),
            quantities: Quantity::all(&mechanism),
            length: mechanism.length_display(),
            ranges,
            path,
            home,
            undone: Vec::new(),
            kept: Vec::new(),
            modes: Vec::new(),
            solver,
            source,
        };
        session.refresh();
        Ok(session)
    }

    /// Returns the mechanism; its estimates may be those of another assembly mode than the file's.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        self.solver.mechanism()
    }

    /// Returns the pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        self.solver.pose()
    }

    /// Returns what a page shows once: names, units, limits.
    #[must_use]
    pub fn description(&self) -> Value {
        let mechanism = self.mechanism();
        let pose = self.pose();
        let inputs_move = |driver: &crate::mechanism::Driver| driver.motion().is_none();
        let drivers = mechanism
            .drivers
            .iter()
            .zip(&pose.drivers)
            .zip(&self.driver_rates);
        let drivers: Vec<Value> = drivers
            .map(|((driver, value), rates)| {
                let kind = driver.coordinate.kind;
                let (unit, factor) = shown_in(kind.unit(), self.length);
                json!({
                    "name": driver.name,
                    "description": driver.description,
                    "is_angle": kind.is_angle(),
                    "is_input": inputs_move(driver),
                    "value": value,
                    "velocity": rates.first(),
                    "unit": unit,
                    "factor": factor,
                })
            })
            .collect();
        let parameters: Vec<Value> = (mechanism.parameters.iter().zip(&pose.parameters))
            .map(|(parameter, value)| {
                let (unit, factor) = shown_in(parameter.unit.unwrap_or(Unit::ONE), None);
                json!({
                    "name": parameter.name,
                    "description": parameter.description,
                    "is_derived": parameter.derived,
                    "value": value,
                    "default": parameter.default,
                    "min": parameter.min,
                    "max": parameter.max,
                    "slider": slider(parameter),
                    "unit": unit,
                    "factor": factor,
                })
            })
            .collect();
        let variables: Vec<Value> = (self.quantities.iter())
            .map(|quantity| {
                let (unit, factor) = quantity.shown_in(self.length);
                json!({
                    "name": quantity.name,
                    "unit": unit,
                    "factor": factor,
                    "is_told": quantity.is_told,
                })
            })
            .collect();
        let uses_time = self.uses_time();
        json!({
            "name": mechanism.name,
            "description": mechanism.description,
            "warnings": self.warnings,
            "drivers": drivers,
            "parameters": parameters,
            "variables": variables,
            "uses_time": uses_time,
            "start": mechanism.simulation.start,
            "stop": mechanism.simulation.stop,
            "has_forces": self.forces.is_some(),
            "places": self.layout(),
            "ranges": self.ranges(),
        })
    }

    /// Returns the ranges of the drivers: ends and whether the driver turns fully, `null` for
    /// prescribed motions.
    #[must_use]
    pub fn ranges(&self) -> Value {
        let ranges = self.ranges.iter().map(|range| {
            range.as_ref().map(|range| {
                json!({ "low": range.ends[0], "high": range.ends[1], "turns": range.turns })
            })
        });
        json!(ranges.collect::<Vec<_>>())
    }

    /// Whether a prescribed motion depends on time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        let drivers = &self.mechanism().drivers;
        drivers
            .iter()
            .any(|d| d.motion().is_some_and(Motion::uses_time))
    }

    // -- moves -------------------------------------------------------------------------------

    /// Moves a driver that is an input to a value \[m or rad\].
    pub fn drive(&mut self, driver: DriverId, value: f64) -> Outcome {
        let path = self.path_here();
        let Some(Curve::Input { position, .. }) = path.curves.get(driver.index()).copied() else {
            return Outcome::Refused(Obstacle::new("no driver that is an input"));
        };
        if !value.is_finite() {
            return Outcome::Refused(Obstacle::new("the value is no finite number"));
        }
        path.curves[driver.index()] = Curve::held(value, position);
        let outcome = self.follow(|id| id == driver);
        self.refresh();
        outcome
    }

    /// Moves to a time \[s\], with parameters and inputs as they are.
    pub fn go_to(&mut self, time: f64) -> Outcome {
        if !time.is_finite() {
            return Outcome::Refused(Obstacle::new("the time is no finite number"));
        }
        if time < self.pose().time
            && let Err(obstacle) = self.return_to_start()
        {
            return Outcome::Refused(obstacle);
        }
        let path = self.path_here();
        path.duration = time - path.start;
        let outcome = self.follow(|_| true);
        self.refresh();
        outcome
    }

    /// Changes a parameter to a value \[SI\]; the mechanism follows on its assembly mode. With
    /// `anew` it is assembled there if no continuous motion leads there.
    pub fn set(&mut self, parameter: ParameterId, value: f64, anew: bool) -> Outcome {
        let mechanism = Arc::clone(self.mechanism());
        let Some(own) = mechanism.parameters.get(parameter.index()) else {
            return Outcome::Refused(Obstacle::new("no such parameter"));
        };
        if let Some(message) = unfit(own, value) {
            return Outcome::Refused(Obstacle::new(message));
        }
        let before = self.pose().clone();
        let mut values = before.parameters.clone();
        values[parameter.index()] = value;
        mechanism.derive_parameters(&mut values);
        let path = self.path_here();
        path.to.clone_from(&values);
        let Err(blocked) = self.solver.track(&self.path) else {
            self.refresh();
            return Outcome::Reached;
        };
        let mut obstacle = Obstacle::of_stop(&blocked, &self.solver, |_| false);
        let way = before.parameters[parameter.index()];
        let limit = way + blocked.s * (value - way);
        self.solver.restore(&before);
        let mut path = self.path_here().clone();
        path.from.clone_from(&values);
        path.to.clone_from(&values);
        match Self::assembled(&mechanism, &path) {
            Ok(pose) if anew => {
                self.solver.restore(&pose);
                self.start = pose;
                self.refresh();
                return Outcome::Reached;
            }
            Ok(_) => {
                let (unit, factor) = shown_in(own.unit.unwrap_or(Unit::ONE), None);
                let limit = crate::mechanism::shown(limit * factor);
                obstacle.message = format!(
                    "no continuous motion leads past `{}` = {limit} {unit}; the mechanism closes \
                     beyond in another position",
                    own.name
                );
                obstacle.assembles = true;
            }
            Err(error) => {
                obstacle = Obstacle::of_assembly(&error, &self.solver);
            }
        }
        self.refresh();
        Outcome::Refused(obstacle)
    }

    /// Returns the pose in which a mechanism assembles at the end of a path.
    fn assembled(
        mechanism: &Arc<Mechanism>,
        path: &Path,
    ) -> Result<Pose, crate::kinematics::Error> {
        let mut solver = Solver::new(Arc::clone(mechanism))?;
        solver.assemble(path)?;
        Ok(solver.pose().clone())
    }

    /// Sets the rates of a driver that is an input \[m/s or rad/s, m/s² or rad/s²\].
    pub fn set_speed(&mut self, driver: DriverId, velocity: f64, acceleration: f64) {
        let rates = [velocity, acceleration];
        if let Some(jet) = self.driver_rates.get_mut(driver.index())
            && rates.iter().all(|rate| rate.is_finite())
        {
            *jet = Jet::new(0.0, rates);
            self.refresh();
        }
    }

    /// Prepares the path on which nothing moves, at the pose.
    pub(super) fn path_here(&mut self) -> &mut Path {
        let pose = self.solver.pose();
        let path = &mut self.path;
        path.start = pose.time;
        path.duration = 0.0;
        path.from.clone_from(&pose.parameters);
        path.to.clone_from(&pose.parameters);
        for (curve, value) in path.curves.iter_mut().zip(&pose.drivers) {
            if let Curve::Input { .. } = curve {
                *curve = Curve::held(*value, *value);
            }
        }
        path
    }

    /// Follows the path that was prepared; `moves` tells which drivers move.
    pub(super) fn follow(&mut self, moves: impl Fn(DriverId) -> bool) -> Outcome {
        match self.solver.track(&self.path) {
            Ok(_) => Outcome::Reached,
            Err(blocked) => Outcome::Stopped(Obstacle::of_stop(&blocked, &self.solver, moves)),
        }
    }

    /// Goes to the start of the simulation, with parameters and inputs as they are. A failure
    /// leaves the pose.
    pub(super) fn return_to_start(&mut self) -> Result<(), Obstacle> {
        let here = self.pose().clone();
        self.solver.restore(&self.start);
        let path = self.path_here();
        path.to.clone_from(&here.parameters);
        for (curve, value) in path.curves.iter_mut().zip(&here.drivers) {
            if let Curve::Input { position, .. } = *curve {
                *curve = Curve::held(*value, position);
            }
        }
        if let Outcome::Stopped(obstacle) = self.follow(|_| true) {
            self.solver.restore(&here);
            return Err(obstacle);
        }
        self.start = self.pose().clone();
        Ok(())
    }

    /// Solves rates and forces at the pose.
    pub(super) fn refresh(&mut self) {
        let time = self.pose().time;
        for index in 0..self.driver_rates.len() {
            let driver = DriverId(index);
            if self.mechanism().drivers[index].motion().is_some() {
                self.driver_rates[index] = self.solver.motion(driver, time);
            }
        }
        let Self {
            solver,
            rates,
            driver_rates,
            forces,
            force_inputs,
            ..
        } = self;
        let solved = solver.solve_rates(|driver| driver_rates[driver.index()], rates);
        self.has_rates = solved.is_ok()
            && forces.as_deref_mut().is_none_or(|forces| {
                let motion = KnownMotion {
                    rates,
                    driver_rates,
                    inputs: force_inputs,
                };
                solver.solve_forces(motion, ForceParts::ALL, forces).is_ok()
            });
    }

    /// Returns what values of variables are read from.
    pub(super) fn moment(&self) -> Moment<'_> {
        Moment {
            solver: &self.solver,
            rates: &self.rates,
            driver_rates: &self.driver_rates,
            forces: self.forces.as_deref().filter(|_| self.has_rates),
            has_rates: self.has_rates,
        }
    }

    // -- pictures and files ------------------------------------------------------------------

    /// Draws the moving picture anew, as changed parameters demand: with `keep` at the same scale,
    /// otherwise with the ranges of the drivers, which are found anew, and at the scale that fits.
    pub fn redraw(&mut self, keep: bool) {
        self.picture = if keep {
            let scale = self.picture.scale();
            MovingPicture::new(&mut self.solver, &[], Some(scale))
        } else {
            let (ranges, reached) = ranges(&mut self.solver);
            self.ranges = ranges;
            MovingPicture::new(&mut self.solver, &reached, None)
        };
        self.refresh();
    }

    /// Returns the moving picture's parts.
    #[must_use]
    pub fn picture(&self) -> Value {
        self.picture.description()
    }

    /// Returns the diagram of the pose, as `biela draw` writes it.
    pub fn diagram(&mut self) -> String {
        let scene = Scene::new(&mut self.solver, true);
        let sheet = Sheet::new(&scene, &self.solver.pose().q);
        self.refresh();
        svg::write(&sheet, sheet.width(), false)
    }

    /// Returns the mechanism's file with the parameters as they are, and with start values and
    /// estimates so that it assembles at the pose.
    ///
    /// # Errors
    ///
    /// Those of [`edit`], which a file that was read does not have.
    pub fn text(&self) -> Result<String, EditError> {
        let moved = self.pose() != &self.home.pose;
        let place = if moved { Place::Whole } else { Place::Keep };
        self.edited(place)
    }

    /// Returns the mechanism's file with the parameters as they are, and nothing else changed.
    ///
    /// # Errors
    ///
    /// Those of [`edit`], which a file that was read does not have.
    pub fn text_with_parameters(&self) -> Result<String, EditError> {
        self.edited(Place::Keep)
    }

    fn edited(&self, place: Place) -> Result<String, EditError> {
        let pose = self.pose();
        let parameters = self.mechanism().parameters.iter().zip(&pose.parameters);
        let changed =
            parameters.filter(|(p, value)| !p.derived && p.default.to_bits() != value.to_bits());
        let names: Vec<String> = changed.map(|(p, _)| p.name.clone()).collect();
        edit(self.source.text(), self.mechanism(), &names, pose, place)
    }

    // -- undo --------------------------------------------------------------------------------

    /// Keeps the present state, to which [`undo`](Self::undo) returns.
    pub fn keep(&mut self) {
        let now = self.now();
        if self.kept.last().is_none_or(|kept| kept.pose != now.pose) {
            if self.kept.len() == MOST_KEPT {
                self.kept.remove(0);
            }
            self.kept.push(now);
            self.undone.clear();
        }
    }

    /// Returns to the state kept last; false if there is none.
    pub fn undo(&mut self) -> bool {
        while let Some(kept) = self.kept.pop() {
            if kept.pose != *self.pose() {
                let now = self.now();
                self.undone.push(now);
                self.go_back(kept);
                return true;
            }
        }
        false
    }

    /// Returns to the state that [`undo`](Self::undo) left; false if there is none.
    pub fn redo(&mut self) -> bool {
        let Some(undone) = self.undone.pop() else {
            return false;
        };
        let now = self.now();
        self.kept.push(now);
        self.go_back(undone);
        true
    }

    /// Returns to the file's own values and pose.
    pub fn reset(&mut self) {
        self.keep();
        self.go_back(self.home.clone());
        let mechanism = Arc::clone(self.mechanism());
        self.driver_rates = speeds(&mechanism, &self.ranges);
        self.refresh();
    }

    fn now(&self) -> Kept {
        Kept {
            mechanism: Arc::clone(self.mechanism()),
            pose: self.pose().clone(),
            start: self.start.clone(),
        }
    }

    fn go_back(&mut self, kept: Kept) {
        if !Arc::ptr_eq(&kept.mechanism, self.mechanism())
            && let Ok(mut solver) = Solver::new(kept.mechanism)
        {
            // It has been assembled before, which chooses the rows that are solved.
            let _ = solver.assemble(&Path::new(solver.mechanism()));
            self.solver = solver;
        }
        self.solver.restore(&kept.pose);
        self.start = kept.start;
        self.refresh();
    }

    /// Takes over a solver of the same mechanism with other estimates, at its pose.
    pub(super) fn adopt(&mut self, solver: Solver) {
        self.keep();
        self.solver = solver;
        self.start = self.pose().clone();
        self.refresh();
    }
}

/// Returns the reason why a parameter cannot have a value.
fn unfit(parameter: &crate::mechanism::Parameter, value: f64) -> Option<String> {
    let name = &parameter.name;
    if parameter.derived {
        return Some(format!(
            "`{name}` is derived from other parameters; set those"
        ));
    }
    if !value.is_finite() {
        return Some(format!("`{name}` must be a finite number"));
    }
    let (unit, factor) = shown_in(parameter.unit.unwrap_or(Unit::ONE), None);
    let limit = |limit: f64| crate::mechanism::shown(limit * factor);
    match (parameter.min, parameter.max) {
        (Some(min), _) if value < min => {
            Some(format!("`{name}` must be at least {} {unit}", limit(min)))
        }
        (_, Some(max)) if value > max => {
            Some(format!("`{name}` must be at most {} {unit}", limit(max)))
        }
        _ => None,
    }
}

/// Returns the ends of a parameter's slider: its limits, or a range in which most mechanisms move.
fn slider(parameter: &crate::mechanism::Parameter) -> [f64; 2] {
    let value = parameter.default;
    let is_angle = parameter
        .unit
        .is_some_and(|u| u.dimension == Unit::RADIAN.dimension);
    let [low, high] = if is_angle {
        [value - 0.25 * TAU, value + 0.25 * TAU]
    } else if value == 0.0 {
        [-1.0, 1.0]
    } else {
        let ends = [0.25 * value, 2.0 * value];
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    };
    // A limit far away would make the slider coarse.
    let near = |limit: Option<f64>, end: f64, extreme: fn(f64, f64) -> f64| {
        limit.map_or(end, |limit| extreme(limit, end))
    };
    let low = near(parameter.min, low, f64::max);
    let high = near(parameter.max, high, f64::min);
    [low.min(value), high.max(value)]
}

/// Returns the range of each driver that is an input, and poses in the ranges.
fn ranges(solver: &mut Solver) -> (Vec<Option<DriverRange>>, Vec<Vec<f64>>) {
    let mechanism = Arc::clone(solver.mechanism());
    let home = solver.pose().clone();
    let mut poses = Vec::new();
    let ranges = mechanism.drivers.iter().enumerate().map(|(index, driver)| {
        if driver.motion().is_some() {
            return None;
        }
        let range = solver.range(DriverId(index), &RANGE);
        let value = home.drivers[index];
        let is_angle = driver.coordinate.kind.is_angle();
        let end = |end: &End| match end {
            End::Turns(_) => None,
            End::Singular(point) => Some(point.drivers[index]),
            End::NotFound { .. } if is_angle => None,
            End::Blocked { value, .. } | End::Bound { value } | End::NotFound { value } => {
                Some(*value)
            }
        };
        let ends = [end(&range.lower), end(&range.upper)];
        poses.extend(range.samples.into_iter().map(|sample| sample.q));
        Some(match ends {
            [Some(low), Some(high)] => DriverRange {
                ends: [low, high],
                turns: false,
            },
            [Some(low), None] => DriverRange {
                ends: [low, low + TAU],
                turns: false,
            },
            [None, Some(high)] => DriverRange {
                ends: [high - TAU, high],
                turns: false,
            },
            [None, None] => {
                let low = TAU * (value / TAU).floor();
                DriverRange {
                    ends: [low, low + TAU],
                    turns: true,
                }
            }
        })
    });
    let ranges = ranges.collect();
    solver.restore(&home);
    (ranges, poses)
}

/// Returns rates for drivers that are inputs: a turn, or the range, in some seconds.
fn speeds(mechanism: &Mechanism, ranges: &[Option<DriverRange>]) -> Vec<Jet> {
    let drivers = mechanism.drivers.iter().zip(ranges);
    let rates = drivers.map(|(driver, range)| match range {
        Some(_) if driver.coordinate.kind.is_angle() => TAU / PERIOD[0],
        Some(range) => (range.ends[1] - range.ends[0]) / PERIOD[1],
        None => 0.0,
    });
    rates.map(|rate| Jet::new(0.0, [rate, 0.0])).collect()
}
