//! The table of variables of a mechanism's FMU: getters, setters and `modelDescription.xml` all
//! read it.

use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable};
use crate::kinematics::{Dependencies, Rates, Solver, Structure};
use crate::mechanism::{
    BodyId, Coordinate, CoordinateKind, DriverId, DriverSource, Jet, MarkerId, Mechanism,
    ParameterId, Unit,
};

/// Goes into the GUID: raised whenever the table below changes for the same mechanism.
pub const TABLE_VERSION: u32 = 1;

/// What a variable stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Value (order 0), velocity (1) or acceleration (2) of a driver that is an input.
    Input(DriverId, Order),
    /// A parameter of the mechanism.
    Parameter(ParameterId),
    /// The choice where driver rates come from.
    RateSource,
    /// The choice how inputs go on during a step.
    Extrapolation,
    /// A generalized coordinate (component 0: x, 1: y, 2: phi) or a rate of it.
    Body(BodyId, usize, Order),
    /// A marker's global x (component 0) or y (1), or a rate of it.
    Marker(MarkerId, usize, Order),
    /// A measure: index into [`Mechanism::measures`].
    Measure(usize, Order),
    /// A driver with a prescribed motion.
    Motion(DriverId, Order),
    /// Largest scaled residual of the constraint equations.
    Residual,
    /// Scaled reciprocal condition of the Jacobian.
    Rcond,
    /// Newton iterations of the last step.
    Iterations,
    /// Sub-steps of the last step.
    Substeps,
    /// Time.
    Time,
}

impl Quantity {
    /// Which derivative with respect to time an output is; `None` for what is no output.
    #[must_use]
    pub fn order(self) -> Option<Order> {
        match self {
            Self::Body(_, _, order)
            | Self::Marker(_, _, order)
            | Self::Measure(_, order)
            | Self::Motion(_, order) => Some(order),
            _ => None,
        }
    }

    /// The value of an output: of a body, a marker, a measure or a prescribed motion. Rates
    /// count only where the output is one. Allocates nothing.
    ///
    /// # Panics
    ///
    /// If the quantity is another.
    #[inline]
    #[must_use]
    pub fn read(self, solver: &Solver, rates: &Rates, driver_rates: &[Jet]) -> f64 {
        match self {
            Self::Body(body, component, order) => {
                let column = 3 * body.index() + component;
                match order {
                    Order::Position => solver.pose().q[column],
                    Order::Velocity => rates.velocity()[column],
                    Order::Acceleration => rates.acceleration()[column],
                }
            }
            Self::Marker(marker, component, order) => {
                order.of(solver.marker(marker, rates)[component])
            }
            Self::Measure(measure, order) => order.of(solver.measure(measure, rates)),
            Self::Motion(driver, Order::Position) => solver.pose().drivers[driver.index()],
            Self::Motion(driver, order) => order.of(driver_rates[driver.index()]),
            _ => panic!("{self:?} is no output"),
        }
    }

    /// The quantity that this one is a derivative of, or itself.
    #[must_use]
    pub fn position(self) -> Self {
        match self {
            Self::Input(driver, _) => Self::Input(driver, Order::Position),
            Self::Body(body, component, _) => Self::Body(body, component, Order::Position),
            Self::Marker(marker, component, _) => Self::Marker(marker, component, Order::Position),
            Self::Measure(measure, _) => Self::Measure(measure, Order::Position),
            Self::Motion(driver, _) => Self::Motion(driver, Order::Position),
            _ => self,
        }
    }

    /// The derivative of an output of this order with respect to time, as far as there is one:
    /// of positions the first and the second, of velocities the first.
    pub(super) fn derivative(self, order: usize) -> Option<Self> {
        let raised = |own: Order| Order::ALL.get(own as usize + order).copied();
        Some(match self {
            Self::Body(body, component, own) => Self::Body(body, component, raised(own)?),
            Self::Marker(marker, component, own) => Self::Marker(marker, component, raised(own)?),
            Self::Measure(measure, own) => Self::Measure(measure, raised(own)?),
            Self::Motion(driver, own) => Self::Motion(driver, raised(own)?),
            _ => return None,
        })
    }
}

/// Which derivative with respect to time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Order {
    /// The quantity itself.
    Position,
    /// Its first derivative.
    Velocity,
    /// Its second derivative.
    Acceleration,
}

impl Order {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Acceleration];

    /// The derivative of this order.
    pub(super) fn of(self, jet: Jet) -> f64 {
        match self {
            Self::Position => jet.value,
            Self::Velocity => jet.first(),
            Self::Acceleration => jet.second(),
        }
    }

    /// The last part of the name of a driver's or measure's variable.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}

/// Where the velocity and acceleration of driver inputs come from.
pub static RATE_SOURCES: Enumeration = Enumeration {
    name: "Rates",
    items: &[
        (
            "auto",
            "input derivatives if given, else the rate inputs once one was set to other than \
             zero, else estimated",
        ),
        ("inputs", "input derivatives if given, else the rate inputs"),
        (
            "estimated",
            "from the last three values of the position input",
        ),
    ],
};

/// How inputs without input derivatives go on during a step.
pub static EXTRAPOLATIONS: Enumeration = Enumeration {
    name: "Extrapolation",
    items: &[
        ("hold", "held: outputs lag the inputs by one step"),
        ("taylor", "carried along by velocity and acceleration"),
    ],
};

/// The variables of a mechanism's FMU, in the order of their value references: inputs,
/// parameters, settings, bodies, markers, measures and motions, solver, time; in file order
/// within each.
#[must_use]
pub fn variables(mechanism: &Mechanism) -> Vec<Variable<Quantity>> {
    let mut table = Table::default();
    table.add_inputs(mechanism);
    table.add_parameters(mechanism);
    if has_inputs(mechanism) {
        table.add_settings();
    }
    table.add_bodies(mechanism);
    table.add_markers(mechanism);
    table.add_measures(mechanism);
    table.add_solver();
    table.add(
        "time",
        "",
        Quantity::Time,
        (Causality::Independent, Variability::Continuous),
        Kind::real(Some(Unit::SECOND), None),
    );
    table.list
}

#[derive(Default)]
struct Table {
    list: Vec<Variable<Quantity>>,
}

impl Table {
    fn add(
        &mut self,
        name: impl Into<String>,
        description: impl Into<String>,
        quantity: Quantity,
        (causality, variability): (Causality, Variability),
        kind: Kind,
    ) {
        self.list.push(Variable {
            name: name.into(),
            description: description.into(),
            quantity,
            causality,
            variability,
            kind,
        });
    }

    fn add_inputs(&mut self, mechanism: &Mechanism) {
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let DriverSource::Input { start } = driver.source else {
                continue;
            };
            for order in Order::ALL {
                let what = describe_coordinate(mechanism, &driver.coordinate);
                let start = if order == Order::Position { start } else { 0.0 };
                self.add(
                    format!("{}.{}", driver.name, order.suffix()),
                    describe(&driver.description, order, &what),
                    Quantity::Input(DriverId(index), order),
                    (Causality::Input, Variability::Continuous),
                    Kind::real(
                        Some(coordinate_unit(&driver.coordinate, order)),
                        Some(start),
                    ),
                );
            }
        }
    }

    fn add_parameters(&mut self, mechanism: &Mechanism) {
        for (index, parameter) in mechanism.parameters.iter().enumerate() {
            let causality = if parameter.derived {
                Causality::CalculatedParameter
            } else {
                Causality::Parameter
            };
            let tunable = if parameter.derived {
                derived_from_tunable(mechanism, ParameterId(index))
            } else {
                parameter.tunable
            };
            let variability = if tunable {
                Variability::Tunable
            } else {
                Variability::Fixed
            };
            self.add(
                parameter.name.clone(),
                parameter.description.clone(),
                Quantity::Parameter(ParameterId(index)),
                (causality, variability),
                Kind::Real {
                    unit: parameter.unit,
                    start: (!parameter.derived).then_some(parameter.default),
                    min: parameter.min,
                    max: parameter.max,
                },
            );
        }
    }

    fn add_settings(&mut self) {
        self.add(
            "rates",
            "where velocity and acceleration of the inputs come from",
            Quantity::RateSource,
            (Causality::Parameter, Variability::Fixed),
            Kind::Enumeration(&RATE_SOURCES),
        );
        self.add(
            "extrapolation",
            "how inputs without input derivatives go on during a step",
            Quantity::Extrapolation,
            (Causality::Parameter, Variability::Fixed),
            Kind::Enumeration(&EXTRAPOLATIONS),
        );
    }

    fn add_output(&mut self, name: String, description: String, quantity: Quantity, unit: Unit) {
        self.add(
            name,
            description,
            quantity,
            (Causality::Output, Variability::Continuous),
            Kind::real(Some(unit), None),
        );
    }

    fn add_bodies(&mut self, mechanism: &Mechanism) {
        const NAMES: [[&str; 3]; 3] = [
            ["x", "y", "phi"],
            ["vx", "vy", "omega"],
            ["ax", "ay", "alpha"],
        ];
        for &id in &mechanism.outputs.bodies {
            let body = &mechanism.bodies[id.index()].name;
            for order in Order::ALL {
                for component in 0..3 {
                    let (what, unit) = if component == 2 {
                        (format!("the angle of `{body}`"), angle_unit(order))
                    } else {
                        let axis = ["x", "y"][component];
                        (
                            format!("{axis} of the origin of `{body}`"),
                            length_unit(order),
                        )
                    };
                    self.add_output(
                        format!("{body}.{}", NAMES[order as usize][component]),
                        describe("", order, &what),
                        Quantity::Body(id, component, order),
                        unit,
                    );
                }
            }
        }
    }

    fn add_markers(&mut self, mechanism: &Mechanism) {
        const NAMES: [[&str; 2]; 3] = [["x", "y"], ["vx", "vy"], ["ax", "ay"]];
        for &id in &mechanism.outputs.markers {
            let marker = mechanism.marker_path(id);
            for order in Order::ALL {
                for component in 0..2 {
                    let what = format!("{} of marker `{marker}`", ["x", "y"][component]);
                    self.add_output(
                        format!("{marker}.{}", NAMES[order as usize][component]),
                        describe("", order, &what),
                        Quantity::Marker(id, component, order),
                        length_unit(order),
                    );
                }
            }
        }
    }

    fn add_measures(&mut self, mechanism: &Mechanism) {
        let measures = mechanism
            .measures
            .iter()
            .enumerate()
            .map(|(index, measure)| {
                let quantity: Box<dyn Fn(Order) -> Quantity> =
                    Box::new(move |order| Quantity::Measure(index, order));
                (
                    &measure.name,
                    &measure.description,
                    &measure.coordinate,
                    quantity,
                )
            });
        let motions = mechanism
            .drivers
            .iter()
            .enumerate()
            .filter(|(_, driver)| driver.motion().is_some())
            .map(|(index, driver)| {
                let quantity: Box<dyn Fn(Order) -> Quantity> =
                    Box::new(move |order| Quantity::Motion(DriverId(index), order));
                (
                    &driver.name,
                    &driver.description,
                    &driver.coordinate,
                    quantity,
                )
            });
        for (name, description, coordinate, quantity) in measures.chain(motions) {
            let what = describe_coordinate(mechanism, coordinate);
            for order in Order::ALL {
                self.add_output(
                    format!("{name}.{}", order.suffix()),
                    describe(description, order, &what),
                    quantity(order),
                    coordinate_unit(coordinate, order),
                );
            }
        }
    }

    fn add_solver(&mut self) {
        let local = (Causality::Local, Variability::Continuous);
        let counted = (Causality::Local, Variability::Discrete);
        self.add(
            "solver.residual",
            "largest residual of the constraint equations, in characteristic lengths and radians",
            Quantity::Residual,
            local,
            Kind::real(Some(Unit::ONE), None),
        );
        self.add(
            "solver.rcond",
            "scaled reciprocal condition of the Jacobian: 1 is best, 0 a singular position",
            Quantity::Rcond,
            local,
            Kind::real(Some(Unit::ONE), None),
        );
        self.add(
            "solver.iterations",
            "Newton iterations of the last step",
            Quantity::Iterations,
            counted,
            Kind::Integer,
        );
        self.add(
            "solver.substeps",
            "sub-steps of the last step, 1 for an ordinary one",
            Quantity::Substeps,
            counted,
            Kind::Integer,
        );
    }
}

/// Whether any driver is an FMI input.
#[must_use]
pub fn has_inputs(mechanism: &Mechanism) -> bool {
    mechanism
        .drivers
        .iter()
        .any(|driver| driver.motion().is_none())
}

/// The drivers and parameters that an output or calculated parameter depends on, structurally
/// exact; nothing for other variables.
#[must_use]
pub fn dependencies(
    mechanism: &Mechanism,
    structure: &Structure,
    quantity: Quantity,
) -> Dependencies {
    let mut dependencies = Dependencies::default();
    let mut relation = |coordinate: &Coordinate| {
        dependencies.extend(&structure.coordinate_dependencies(mechanism, coordinate));
    };
    match quantity {
        Quantity::Body(body, component, _) => {
            dependencies.extend(structure.dependencies(3 * body.index() + component));
        }
        Quantity::Marker(marker, component, _) => {
            dependencies.extend(&structure.point_dependencies(mechanism, marker, component));
        }
        Quantity::Measure(index, _) => relation(&mechanism.measures[index].coordinate),
        Quantity::Motion(driver, _) => {
            dependencies.drivers.insert(driver);
            if let Some(motion) = mechanism.drivers[driver.index()].motion() {
                dependencies.add_motion(mechanism, motion);
            }
        }
        Quantity::Parameter(parameter) => dependencies.add_parameter(mechanism, parameter),
        Quantity::Input(..)
        | Quantity::RateSource
        | Quantity::Extrapolation
        | Quantity::Residual
        | Quantity::Rcond
        | Quantity::Iterations
        | Quantity::Substeps
        | Quantity::Time => {}
    }
    dependencies
}

fn derived_from_tunable(mechanism: &Mechanism, parameter: ParameterId) -> bool {
    let mut roots = Dependencies::default();
    roots.add_parameter(mechanism, parameter);
    roots
        .parameters
        .iter()
        .any(|root| mechanism.parameters[root.index()].tunable)
}

fn length_unit(order: Order) -> Unit {
    match order {
        Order::Position => Unit::METRE,
        Order::Velocity => Unit::METRE_PER_SECOND,
        Order::Acceleration => Unit::METRE_PER_SECOND_SQUARED,
    }
}

fn angle_unit(order: Order) -> Unit {
    match order {
        Order::Position => Unit::RADIAN,
        Order::Velocity => Unit::RADIAN_PER_SECOND,
        Order::Acceleration => Unit::RADIAN_PER_SECOND_SQUARED,
    }
}

fn coordinate_unit(coordinate: &Coordinate, order: Order) -> Unit {
    match coordinate.kind {
        CoordinateKind::Angle => angle_unit(order),
        CoordinateKind::X | CoordinateKind::Y | CoordinateKind::Distance => length_unit(order),
    }
}

/// What a coordinate measures, in words.
fn describe_coordinate(mechanism: &Mechanism, coordinate: &Coordinate) -> String {
    let [from, to, axes] =
        [coordinate.from, coordinate.to, coordinate.axes].map(|id| mechanism.marker_path(id));
    let on_axes = if axes == from {
        String::new()
    } else {
        format!(" on the axes of `{axes}`")
    };
    match coordinate.kind {
        CoordinateKind::Angle => format!("the angle from `{from}` to `{to}`"),
        CoordinateKind::X => format!("x from `{from}` to `{to}`{on_axes}"),
        CoordinateKind::Y => format!("y from `{from}` to `{to}`{on_axes}"),
        CoordinateKind::Distance => format!("the distance from `{from}` to `{to}`"),
    }
}

/// The file's own description if it has one, else what is measured; and which rate of it.
fn describe(own: &str, order: Order, what: &str) -> String {
    let what = if own.is_empty() { what } else { own };
    match order {
        Order::Position => what.to_owned(),
        Order::Velocity => format!("velocity: {what}"),
        Order::Acceleration => format!("acceleration: {what}"),
    }
}
