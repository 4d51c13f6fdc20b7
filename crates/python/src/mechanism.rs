//! The class `Mechanism`: a mechanism file, and what can be asked of it.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use biela::dynamics::Motion;
use biela::kinematics::{
    AssemblyMode, Direction, Output, Path, Pose, Solver, SolverChoices, offer_start,
};
use biela::mechanism::{Diagnostic, DriverId, Mechanism as Model, Order, ParameterId, Source};
use biela_tools::cli::{self, ArchiveOptions};
use biela_tools::drawing::{Diagram, Followed, ForcePlace, svg, usual_driver};
use biela_tools::exchange::WorkshopDrawing;
use biela_tools::page::{PosePart, edit};
use pyo3::prelude::*;

use crate::attempt::Attempt;
use crate::call::{Cores, apart};
use crate::error::{Failure, exception};
use crate::fit::Targets;
use crate::follower::{Fit, WantedValues};
use crate::rows::{
    DriverRow, EquilibriumRow, InputRow, LinearRow, NamedRow, ParameterRow, Problem, RangeRow,
    driver_row, equilibrium_row, forces, inputs, linear_row, measures, parameter_row, problems,
    range_row,
};
use crate::run::{Run, run};
use crate::runner::Runner;
use crate::scenario::{Drive, Home, Scenario, Value, parameter, parameters, take_starts};
use crate::sweep::{Quantity, Sweep, Variants};
use crate::timing::FreeDriver;

/// Values of parameters, and of motions and sizes of forces with their derivatives, by their names.
type Swept = (Vec<(String, Vec<f64>)>, Vec<(String, [Vec<f64>; 3])>);

/// File of a picture, its width in pixels, and whether its ground is transparent.
type Picture = (Option<PathBuf>, Option<u32>, bool);

/// Assembly modes: the coordinates of the bodies and the reciprocal condition of each, and whether
/// these are all.
type ModesRow = (Vec<(Vec<f64>, f64)>, bool);
/// Times, and motions of drivers.
type Motions = (Vec<f64>, Vec<(String, Drive)>);

/// A target of a fit: number of poses, driver whose values are free and whether they are in order,
/// columns, values wanted by column, then by pose, and the factor of its residuals.
type TargetRow = (usize, Option<(String, bool)>, Vec<usize>, Vec<f64>, f64);

/// Contents of a drawing: traces, number of poses, driver that moves, dimensions, instant centres,
/// forces, contacts.
type Contents = (bool, usize, Option<String>, bool, bool, bool, bool);

/// A text, and what is worth knowing of it.
type Told = (String, Vec<String>);

/// A drawing as SVG, the bytes of a file, and remarks on it.
type DrawingRow = (String, Option<Vec<u8>>, Vec<String>);

/// A mechanism file that has no errors.
#[pyclass(frozen)]
pub(crate) struct Mechanism {
    source: Source,
    model: Arc<Model>,
    warnings: Vec<Diagnostic>,
    /// The pose of the file's own values, once it was asked for.
    home: OnceLock<Arc<Home>>,
    /// The columns of a run, once they were asked for.
    columns: OnceLock<Vec<Output>>,
}

#[pymethods]
impl Mechanism {
    /// Reads a text, or the file at `path`. The tables of a text are those of the mechanism `shipped`
    /// that comes with biela, or beside the file.
    #[new]
    #[pyo3(signature = (name, text=None, path=None, shipped=None))]
    fn new(
        py: Python<'_>,
        name: String,
        text: Option<String>,
        path: Option<PathBuf>,
        shipped: Option<&str>,
    ) -> PyResult<Self> {
        let mut source = source(&name, text, path)?;
        if let Some(shipped) = shipped {
            let (_, tables) = cli::shipped_text(shipped).map_err(Failure::Usage)?;
            source = source.with_files(tables);
        }
        match apart(py, || Ok(Model::parse(&source)))? {
            Ok((model, warnings)) => Ok(Self {
                source,
                model: Arc::new(model),
                warnings,
                home: OnceLock::new(),
                columns: OnceLock::new(),
            }),
            Err(errors) => {
                let text = cli::render::render(&source, &errors, false);
                Err(exception(
                    py,
                    "MechanismError",
                    (text, problems(&source, &errors)),
                ))
            }
        }
    }

    /// Returns the report of `biela check --format json` on a text, or on the file at `path`.
    #[staticmethod]
    #[pyo3(signature = (name, text=None, path=None, modes=false))]
    fn check(
        py: Python<'_>,
        name: String,
        text: Option<String>,
        path: Option<PathBuf>,
        modes: bool,
    ) -> Result<String, Failure> {
        let source = source(&name, text, path)?;
        apart(py, || Ok(cli::check(&source, modes).to_string()))
    }

    /// Returns the report of `biela check --format json`.
    fn report(&self, py: Python<'_>, modes: bool) -> Result<String, Failure> {
        apart(py, || Ok(cli::check(&self.source, modes).to_string()))
    }

    /// Returns whether the file names tables, which are beside it.
    #[getter]
    fn has_tables(&self) -> bool {
        !self.model.table_files.is_empty()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    #[getter]
    fn description(&self) -> &str {
        &self.model.description
    }

    #[getter]
    fn text(&self) -> &str {
        self.source.text()
    }

    #[getter]
    fn warnings(&self) -> Vec<Problem> {
        problems(&self.source, &self.warnings)
    }

    /// Returns the warnings as the program shows them.
    #[getter]
    fn warnings_text(&self) -> String {
        cli::render::render(&self.source, &self.warnings, false)
    }

    #[getter]
    fn parameters(&self) -> Vec<ParameterRow> {
        self.model.parameters.iter().map(parameter_row).collect()
    }

    /// Returns the drivers and the freedoms.
    #[getter]
    fn drivers(&self) -> Vec<DriverRow> {
        self.model.drivers.iter().map(driver_row).collect()
    }

    #[getter]
    fn inputs(&self) -> Vec<InputRow> {
        inputs(&self.model)
    }

    #[getter]
    fn forces(&self) -> Vec<NamedRow> {
        forces(&self.model)
    }

    #[getter]
    fn measures(&self) -> Vec<NamedRow> {
        measures(&self.model)
    }

    /// Returns the names of all forces, by their index in events.
    #[getter]
    fn force_names(&self) -> Vec<String> {
        let forces = self.model.forces.iter();
        forces.map(|force| force.name.clone()).collect()
    }

    #[getter]
    fn bodies(&self) -> Vec<String> {
        let bodies = self.model.bodies.iter();
        bodies.map(|body| body.name.clone()).collect()
    }

    /// Returns the names and units of the columns of a run.
    #[getter]
    fn columns(&self, py: Python<'_>) -> Result<Vec<(String, String)>, Failure> {
        let columns = apart(py, || Ok(self.all_columns()))?.iter();
        let columns = columns.map(|column| (column.name.clone(), column.unit.name.to_string()));
        Ok(columns.collect())
    }

    /// Returns start, stop and step of the file \[s\].
    #[getter]
    fn simulation(&self) -> (f64, f64, f64) {
        let simulation = &self.model.simulation;
        (simulation.start, simulation.stop, simulation.step)
    }

    /// Returns the values of all parameters and of the starts of freedoms \[SI\] where some are set.
    fn values(&self, mut set: Vec<(String, Value)>) -> Result<Vec<(String, f64)>, Failure> {
        let starts = take_starts(&self.model, &mut set)?;
        let parameters = parameters(&self.model, set)?;
        let names = self.model.parameters.iter().map(|p| p.name.clone());
        let freedoms = self.model.starts_of_freedoms().into_iter();
        let freedoms = freedoms.map(|(name, freedom, order)| {
            let set = starts
                .iter()
                .find(|start| (start.0, start.1) == (freedom, order));
            let driver = &self.model.drivers[freedom.index()];
            let own = match order {
                Order::Position => driver.start().unwrap_or(f64::NAN),
                Order::Velocity | Order::Acceleration => driver.start_velocity(),
            };
            (name, set.map_or(own, |start| start.2))
        });
        Ok(names.zip(parameters).chain(freedoms).collect())
    }

    /// Runs the mechanism; `columns` are indices, `by` names of parameters. Without a film it has no page.
    fn run(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        columns: Vec<usize>,
        by: Vec<String>,
        film: bool,
    ) -> Result<Run, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let by = by.iter().map(|name| self.direction(name));
            let by: Vec<_> = by.collect::<Result<_, _>>()?;
            let told = self.all_columns().iter().filter(|column| column.is_told());
            let told = film.then(|| told.cloned().collect());
            run(&scenario, &parameters, &self.chosen(&columns), &by, told)
        })
    }

    /// Runs variants of the mechanism; each swept parameter has one value per variant, each swept motion
    /// of a driver, or size of a force, that of each variant one after the other.
    fn sweep(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        swept: Swept,
        variants: usize,
        columns: Vec<usize>,
    ) -> Result<Sweep, Failure> {
        let cores = Cores::of_process(py)?;
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let (swept, courses) = swept;
            let swept = swept.into_iter();
            let swept = swept.map(|(name, values)| Ok((self.quantity(&name)?, values)));
            let swept: Vec<_> = swept.collect::<Result<_, Failure>>()?;
            let courses = courses.into_iter();
            let courses = courses.filter_map(|(name, orders)| {
                let place = scenario.place(&name)?;
                Some((place, orders))
            });
            let variants = Variants {
                scenario: &scenario,
                parameters: &parameters,
                swept: &swept,
                courses: &courses.collect::<Vec<_>>(),
                count: variants,
                columns: &self.chosen(&columns),
            };
            cores.run(|stop| variants.run(stop))
        })
    }

    /// Prepares a fit of the parameters `free`. The rows of the motion are those of the targets, one
    /// after the other; the driver `turns` shall turn fully.
    fn targets(
        &self,
        py: Python<'_>,
        motions: Motions,
        targets: Vec<TargetRow>,
        free: Vec<String>,
        turns: Option<String>,
    ) -> Result<Targets, Failure> {
        apart(py, || {
            let mut rows = 0;
            let targets = targets.into_iter();
            let targets = targets.map(|(poses, free_driver, columns, wanted, weight)| {
                let free_driver = free_driver.map(|(name, in_order)| {
                    FreeDriver::new(&self.model, self.driver_named(&name)?, in_order)
                });
                rows += poses;
                Ok(WantedValues {
                    rows: rows - poses..rows,
                    free_driver: free_driver.transpose()?,
                    columns: self.chosen(&columns),
                    wanted,
                    weight,
                    // The fit sets both.
                    residuals: 0..0,
                    unknowns: 0..0,
                })
            });
            let targets = targets.collect::<Result<Vec<_>, Failure>>()?;
            let scenario = self.scenario(motions)?;
            let timed = |id| {
                let drivers = targets
                    .iter()
                    .filter_map(|target| target.free_driver.as_ref());
                drivers.map(|free| free.driver).any(|driver| driver == id)
            };
            let mut drivers = scenario.driven.drivers.iter().enumerate();
            let moves_freely =
                drivers.find(|(index, driver)| driver.is_free() && !timed(DriverId(*index)));
            if let Some((_, freedom)) = moves_freely {
                return Err(Failure::Usage(format!(
                    "drive: a fit needs to know how freedom `{}` moves",
                    freedom.name
                )));
            }
            let free = free.iter().map(|name| self.free(name));
            Ok(Targets::new(Fit::new(
                scenario,
                targets,
                free.collect::<Result<_, _>>()?,
                turns.map(|name| self.driver_named(&name)).transpose()?,
            )))
        })
    }

    /// Returns the text of the file with the parameters of these names at their values in an
    /// attempt, and its pose as estimates.
    fn fitted(
        &self,
        py: Python<'_>,
        attempt: &Attempt,
        names: Vec<String>,
    ) -> Result<String, Failure> {
        apart(py, || self.text_at(&names, (&attempt.home(), |_| None)))
    }

    /// Finds the range of a driver from the start of a motion, between bounds if there are some.
    fn range<'py>(
        &self,
        py: Python<'py>,
        driver: &str,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        bounds: [Option<Value>; 2],
        speed: Option<f64>,
    ) -> Result<RangeRow<'py>, Failure> {
        let (id, range) = apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let id = self.driver_named(driver)?;
            let bounds = self.bounds(bounds, &parameters)?;
            let mut runner = Runner::new(&scenario, &[])?;
            runner.start(&parameters)?;
            let names = ["between[0]", "between[1]", "speed"];
            let range = cli::range(&mut runner.motion.solver, id, bounds, speed, names)?;
            Ok((id, range))
        })?;
        Ok(range_row(py, &self.model, id, &range))
    }

    /// Finds the other assembly modes at the start of a motion.
    fn modes(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
    ) -> Result<ModesRow, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let mut runner = Runner::new(&scenario, &[])?;
            runner.start(&parameters)?;
            let modes = runner.motion.solver.modes()?;
            let count = 3 * self.model.bodies.len();
            let others = modes.others.into_iter();
            let others = others.map(|AssemblyMode { q, rcond, .. }| (q[..count].to_vec(), rcond));
            Ok((others.collect(), modes.complete))
        })
    }

    /// Linearizes the free motion at the start of a motion, or at the equilibrium downhill from it.
    fn linearize(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        columns: Vec<usize>,
        balance: bool,
    ) -> Result<LinearRow, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let outputs = self.chosen(&columns);
            let mut runner = Runner::new(&scenario, &outputs)?;
            runner.start(&parameters)?;
            let space = runner.linearize(&outputs, balance)?;
            Ok(linear_row(space, runner.motion.pose(), &self.model))
        })
    }

    /// Finds the equilibrium downhill from the start of a motion, or with `all` those downhill from
    /// places all over the range of the freedoms.
    fn balance(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        all: bool,
    ) -> Result<Vec<EquilibriumRow>, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let mut runner = Runner::new(&scenario, &[])?;
            runner.start(&parameters)?;
            let found = runner.balance(all)?.into_iter();
            Ok(found
                .map(|equilibrium| equilibrium_row(equilibrium, &self.model))
                .collect())
        })
    }

    /// Draws the mechanism at the start of a motion, as SVG, and as the file `path` in the format of its
    /// extension; returns contours that it leaves out too.
    fn draw(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        contents: Contents,
        bounds: [Option<Value>; 2],
        picture: Picture,
    ) -> Result<DrawingRow, Failure> {
        let (traces, poses, driver, dimensions, instant_centres, forces, contacts) = contents;
        let (path, width, transparent) = picture;
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let columns = self.all_columns().iter();
            let columns: Vec<Output> = columns
                .filter(|c| forces && c.is_force())
                .cloned()
                .collect();
            if forces && columns.is_empty() {
                let message = "forces: the mechanism has no forces; \
                               give bodies a `mass` or add `[forces]`";
                return Err(Failure::Usage(message.to_owned()));
            }
            if contacts && !self.model.has_contacts() {
                let message = "contacts: the mechanism has no contacts; add `[contacts]`";
                return Err(Failure::Usage(message.to_owned()));
            }
            let mut runner = Runner::new(&scenario, &columns)?;
            runner.start(&parameters)?;
            let bounds = self.bounds(bounds, &parameters)?;
            cli::check_order(bounds, ["between[0]", "between[1]"])?;
            let driver = driver.map(|name| self.driver_named(&name)).transpose()?;
            let is_bounded = bounds.iter().any(Option::is_some);
            let usual = || usual_driver(&self.model).filter(|_| is_bounded);
            let followed = driver.or_else(usual);
            if is_bounded && followed.is_none() {
                let message = "between: the mechanism has no driver".to_owned();
                return Err(Failure::Usage(message));
            }
            let followed = followed.map(|driver| Followed { driver, bounds });
            let Motion {
                solver, solution, ..
            } = &mut runner.motion;
            let places = ForcePlace::sought(solver, solution);
            let values = ForcePlace::values(&places, solver, solution);
            let diagram = Diagram {
                traces,
                followed,
                poses,
                dimensions,
                instant_centres,
                contacts,
                forces: places.into_iter().zip(values).collect(),
            };
            let sheet = diagram.sheet(&mut runner.motion.solver)?;
            let own = svg::write(&sheet, width.unwrap_or(sheet.width()), transparent);
            let is_dxf = |path: &PathBuf| {
                path.extension()
                    .is_some_and(|e| e.eq_ignore_ascii_case("dxf"))
            };
            let (file, notes) = match path {
                None => (None, Vec::new()),
                Some(path) if is_dxf(&path) => {
                    let scene = diagram.scene(&mut runner.motion.solver);
                    let drawing = WorkshopDrawing::new(&scene, &runner.motion.solver);
                    (Some(drawing.text.into_bytes()), drawing.notes)
                }
                Some(path) => {
                    let picture = cli::picture(&path, &sheet, width, transparent)?;
                    (Some(picture), Vec::new())
                }
            };
            let notes = notes.iter().map(ToString::to_string).collect();
            Ok((own, file, notes))
        })
    }

    /// Returns the file for another program at the start of a motion, and remarks.
    fn convert(
        &self,
        py: Python<'_>,
        to: &str,
        motions: Motions,
        parameters: Vec<(String, Value)>,
    ) -> Result<Told, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let mut runner = Runner::new(&scenario, &[])?;
            runner.start(&parameters)?;
            Ok(cli::convert(to, &runner.motion.solver)?)
        })
    }

    /// Returns the page of `biela report` at the start of a motion, and warnings.
    fn page_of_report(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
    ) -> Result<Told, Failure> {
        apart(py, || {
            let (scenario, parameters) = self.set(motions, parameters)?;
            let driven = &scenario.driven;
            Ok(cli::report(&self.source, &self.model, driven, &parameters)?)
        })
    }

    /// Returns the files of `biela page`, each with its path.
    fn page(
        &self,
        py: Python<'_>,
        path: PathBuf,
        share: Option<&str>,
        solver: Option<PathBuf>,
        studio: Option<&str>,
    ) -> Result<Vec<(PathBuf, String)>, Failure> {
        apart(py, || {
            let (source, model, solver) = (&self.source, &self.model, solver.as_deref());
            Ok(cli::page(source, model, (&path, share), solver, studio)?)
        })
    }

    /// Returns the text of the file with these parameters, the start values of a motion, and its
    /// pose there as estimates; with `estimates`, which are by body, the text with those alone.
    fn edited(
        &self,
        py: Python<'_>,
        motions: Motions,
        parameters: Vec<(String, Value)>,
        estimates: Option<Vec<f64>>,
    ) -> Result<String, Failure> {
        apart(py, || {
            let names: Vec<String> = parameters.iter().map(|(name, _)| name.clone()).collect();
            let (scenario, parameters) = self.set(motions, parameters)?;
            let mut pose = scenario.home.0.clone();
            match estimates {
                Some(q) => pose.q[..q.len()].copy_from_slice(&q),
                None => {
                    let mut runner = Runner::new(&scenario, &[])?;
                    runner.start(&parameters)?;
                    pose = runner.motion.pose().clone();
                }
            }
            let velocity = |freedom: DriverId| {
                let [own, set] = [&self.model, &scenario.driven]
                    .map(|model| model.drivers[freedom.index()].start_velocity());
                (own.to_bits() != set.to_bits()).then_some(set)
            };
            self.text_at(&names, (&pose, velocity))
        })
    }

    /// Returns the bytes of the FMU, without its page if `no_page`, in a system of SSP if `ssp`.
    fn fmu(
        &self,
        py: Python<'_>,
        fmi: &str,
        parts: [bool; 3],
        runtime: Option<PathBuf>,
        platforms: Vec<String>,
    ) -> Result<Vec<u8>, Failure> {
        let [terminals, no_page, ssp] = parts;
        let options = ArchiveOptions {
            fmi,
            terminals,
            runtime: runtime.as_deref(),
            platforms: platforms.iter().map(String::as_str).collect(),
            no_page,
            ssp,
        };
        apart(py, || {
            cli::archive(&self.source, &self.model, &options).map_err(Failure::File)
        })
    }

    /// Returns the modelDescription.xml of the FMU.
    fn model_description(&self, py: Python<'_>, fmi: &str) -> Result<Vec<u8>, Failure> {
        apart(py, || {
            Ok(cli::model_description_of(&self.source, &self.model, fmi)?)
        })
    }
}

impl Mechanism {
    /// Returns the bounds of a driver as numbers \[m or rad\].
    fn bounds(
        &self,
        bounds: [Option<Value>; 2],
        parameters: &[f64],
    ) -> Result<[Option<f64>; 2], Failure> {
        let mut numbers = [None; 2];
        for (number, bound) in numbers.iter_mut().zip(bounds) {
            *number = match bound {
                None => continue,
                Some(Value::Number(value)) => Some(value),
                Some(Value::Text(text)) => {
                    let expression = self.model.parse_expression(&text, None);
                    let refuse = |why| Failure::Usage(format!("between: {why}\n  {text}"));
                    let value = expression.map_err(|error| refuse(error.message))?;
                    Some(value.value(parameters))
                        .filter(|value| value.is_finite())
                        .ok_or_else(|| refuse("the value is not finite".to_owned()))
                        .map(Some)?
                }
            };
        }
        Ok(numbers)
    }

    fn driver_named(&self, name: &str) -> Result<DriverId, Failure> {
        self.model.driver_id(name).ok_or_else(|| {
            let names = self.model.drivers.iter().map(|d| d.name.as_str());
            let names: Vec<&str> = names.collect();
            Failure::Usage(cli::unknown_name("driver", name, &names))
        })
    }

    fn scenario(&self, (times, drives): Motions) -> Result<Scenario, Failure> {
        Scenario::new(&self.model, &self.home()?, times, drives)
    }

    /// Returns the motions with the starts of freedoms among some values, and all parameters in force.
    fn set(
        &self,
        motions: Motions,
        mut set: Vec<(String, Value)>,
    ) -> Result<(Scenario, Vec<f64>), Failure> {
        let mut scenario = self.scenario(motions)?;
        scenario.set_starts(&take_starts(&self.model, &mut set)?)?;
        Ok((scenario, parameters(&self.model, set)?))
    }

    /// Returns the pose of the file's own values.
    fn home(&self) -> Result<Arc<Home>, Failure> {
        if let Some(home) = self.home.get() {
            return Ok(Arc::clone(home));
        }
        let solver = Solver::assembled(self.model.clone(), &Path::new(&self.model));
        let solver = solver.map_err(|error| offer_start(error, &self.model))?;
        let mut choices = SolverChoices::default();
        solver.copy_choices(&mut choices);
        let home = Arc::new((solver.pose().clone(), choices));
        Ok(Arc::clone(self.home.get_or_init(|| home)))
    }

    /// Returns the text of the file with parameters, start values and estimates of a pose.
    fn text_at(
        &self,
        parameters: &[String],
        start: (&Pose, impl Fn(DriverId) -> Option<f64>),
    ) -> Result<String, Failure> {
        let text = self.source.text();
        edit(text, &self.model, parameters, start, PosePart::Whole)
            .map_err(|error| Failure::File(error.to_string()))
    }

    /// Returns the parameter, or the start of a freedom, of a name.
    fn quantity(&self, name: &str) -> Result<Quantity, Failure> {
        let mut starts = self.model.starts_of_freedoms().into_iter();
        match starts.find(|(start, ..)| start == name) {
            Some((_, freedom, order)) => Ok(Quantity::Start(freedom, order)),
            None => self.free(name).map(Quantity::Parameter),
        }
    }

    /// Returns the direction in which a parameter grows, or the start of a freedom.
    fn direction(&self, name: &str) -> Result<Direction, Failure> {
        let (freedom, order) = match self.quantity(name)? {
            Quantity::Parameter(id) => return Ok(Direction::by_parameter(&self.model, id)),
            Quantity::Start(freedom, order) => (freedom, order),
        };
        let mut direction = Direction::zero(&self.model);
        let change = &mut direction.drivers[freedom.index()];
        match order {
            Order::Position => change.value = 1.0,
            _ => change.derivatives[0] = 1.0,
        }
        Ok(direction)
    }

    /// Returns a parameter that does not follow from others.
    fn free(&self, name: &str) -> Result<ParameterId, Failure> {
        let id = parameter(&self.model, name)?;
        let default = self.model.parameters[id.index()].default;
        cli::check_parameter(&self.model, id, default)
            .map_err(|error| Failure::Usage(format!("parameters: {error}")))?;
        Ok(id)
    }

    /// Returns the columns of a run; reactions that are indeterminate take an assembly to find.
    fn all_columns(&self) -> &[Output] {
        if let Some(columns) = self.columns.get() {
            return columns;
        }
        // Made before the cell is locked: a child forked meanwhile would find it locked for ever.
        let columns = Output::all(&self.model);
        self.columns.get_or_init(|| columns)
    }

    fn chosen(&self, indices: &[usize]) -> Vec<Output> {
        let columns = self.all_columns();
        indices
            .iter()
            .map(|index| columns[*index].clone())
            .collect()
    }
}

fn source(name: &str, text: Option<String>, path: Option<PathBuf>) -> Result<Source, Failure> {
    match (text, path) {
        (Some(text), None) => Ok(Source::new(name, text)),
        // The tables that the text names are beside the file.
        (Some(text), Some(path)) => {
            let folder = path.parent().map(PathBuf::from).unwrap_or_default();
            Ok(Source::new(name, text).in_folder(folder))
        }
        (None, Some(path)) => Source::open(name, &path)
            .map_err(|error| Failure::File(format!("cannot read `{name}`: {error}"))),
        (None, None) => Err(Failure::Usage("expected a text or a path".to_owned())),
    }
}
