//! The quantities of a run: as columns of a CSV and as lines of a chart.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use super::error::Error;
use super::motion::Motion;
use crate::drawing::{Axis, Chart, Line, Panel};
use crate::fmi::{Kind, Order, Quantity, Signal, variables};
use crate::mechanism::{BodyId, MarkerId, Mechanism, Unit, help};

/// The lines of more bodies than this cannot be told apart.
pub(super) const MOST_BODIES: usize = 8;

/// Whether a quantity is not always the same, but for rounding.
pub(super) fn moves(values: &[f64]) -> bool {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = (values.iter()).fold(none, |[low, high], v| [low.min(*v), high.max(*v)]);
    high - low > 1e-9 * high.abs().max(low.abs()).max(1.0)
}

/// One quantity of a run.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// As the FMU's variable.
    pub(super) name: String,
    pub(super) signal: Signal,
    pub(super) order: Order,
    pub(super) unit: Unit,
}

impl Column {
    /// Value, velocity and acceleration of every driver, then all outputs of the FMU.
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let variables = variables(mechanism);
        let of_kind = |wanted: fn(Quantity) -> Option<(Signal, Order)>| {
            variables.iter().filter_map(move |variable| {
                let Kind::Real { unit, .. } = variable.kind else {
                    return None;
                };
                let (signal, order) = wanted(variable.quantity)?;
                Some(Self {
                    name: variable.name.clone(),
                    signal,
                    order,
                    unit: unit.unwrap_or(Unit::ONE),
                })
            })
        };
        // An input's value counts as that of the motion which it is in a run.
        let drivers = of_kind(|quantity| match quantity {
            Quantity::Input(driver, order) | Quantity::Output(Signal::Motion(driver), order) => {
                Some((Signal::Motion(driver), order))
            }
            _ => None,
        });
        let mut columns: Vec<Self> = drivers.collect();
        columns.sort_by_key(|column| match column.signal {
            Signal::Motion(driver) => driver.index(),
            _ => 0,
        });
        columns.extend(of_kind(|quantity| match quantity {
            Quantity::Output(Signal::Motion(_), _) => None,
            Quantity::Output(signal, order) => Some((signal, order)),
            _ => None,
        }));
        columns
    }

    /// Those that have one of the names, or belong to what has it: `crank` stands for all
    /// variables of that body, `coupler.P` for those of that marker.
    pub(super) fn named(
        columns: &[Self],
        names: &[String],
        mechanism: &Mechanism,
    ) -> Result<Vec<Self>, Error> {
        let names = names.iter().map(|name| name.trim());
        let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
        if names.is_empty() {
            return Err(Error::Usage("--variables: no variable is named".to_owned()));
        }
        let belongs = |name| columns.iter().any(|column| column.belongs_to(name));
        if let Some(name) = names.iter().find(|name| !belongs(name)) {
            let why = no_output(name, mechanism)
                .unwrap_or_else(|| format!("there is no `{name}`{}", suggestion(name, columns)));
            return Err(Error::Usage(format!("--variables: {why}")));
        }
        let chosen = columns
            .iter()
            .filter(|column| names.iter().any(|name| column.belongs_to(name)));
        Ok(chosen.cloned().collect())
    }

    /// What a chart shows if nothing else is asked for: drivers and measures, or points of
    /// interest where there is no measure, or bodies where there is neither.
    pub(super) fn of_interest(columns: &[Self]) -> Vec<Self> {
        let of = |wanted: fn(&Signal) -> bool| {
            let chosen = columns.iter().filter(move |column| wanted(&column.signal));
            chosen.cloned().collect::<Vec<_>>()
        };
        let mut chosen = of(|signal| matches!(signal, Signal::Motion(_)));
        for wanted in [
            |signal: &Signal| matches!(signal, Signal::Measure(_)),
            |signal: &Signal| matches!(signal, Signal::Marker(..)),
            |signal: &Signal| matches!(signal, Signal::Body(..)),
        ] {
            let more = of(wanted);
            if !more.is_empty() {
                chosen.extend(more);
                break;
            }
        }
        chosen
    }

    fn belongs_to(&self, name: &str) -> bool {
        is_of(&self.name, name)
    }

    pub(super) fn read(&self, motion: &Motion) -> f64 {
        let Motion {
            solver,
            rates,
            driver_rates,
            ..
        } = motion;
        self.order.of(self.signal.jet(solver, rates, driver_rates))
    }
}

/// Whether a variable has the name of its owner, or that and more: `crank.phi` is of `crank`.
fn is_of(name: &str, owner: &str) -> bool {
    let rest = name.strip_prefix(owner);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Says that what would have a variable of this name exists, but is no output.
fn no_output(name: &str, mechanism: &Mechanism) -> Option<String> {
    let outputs = &mechanism.outputs;
    let markers = (0..mechanism.markers.len()).map(MarkerId);
    let markers = markers
        .filter(|id| !outputs.markers.contains(id))
        .map(|id| ("marker", mechanism.marker_path(id), "markers"));
    let bodies = (0..mechanism.bodies.len()).map(BodyId);
    let bodies = bodies
        .filter(|id| !outputs.bodies.contains(id))
        .map(|id| ("body", mechanism.bodies[id.index()].name.clone(), "bodies"));
    let mut silent = markers.chain(bodies);
    let (what, owner, list) = silent.find(|(_, owner, _)| is_of(name, owner))?;
    Some(format!(
        "{what} `{owner}` is no output; list it in `{list}` of `[outputs]`"
    ))
}

/// The column, or what has columns, that may be meant by a name that is none.
fn suggestion(name: &str, columns: &[Column]) -> String {
    let names = || columns.iter().map(|column| column.name.as_str());
    let mut owners = Vec::new();
    for (owner, _) in names().filter_map(|name| name.split_once('.')) {
        if !owners.contains(&owner) {
            owners.push(owner);
        }
    }
    let markers = names().filter_map(|name| Some(name.rsplit_once('.')?.0));
    let mut further: Vec<&str> = markers.chain(names()).collect();
    further.dedup();
    help(name, &owners, &further).map_or_else(String::new, |help| format!("; {help}"))
}

/// The CSV: one column a quantity.
pub(super) struct Table<'a> {
    out: BufWriter<Box<dyn Write>>,
    path: PathBuf,
    columns: &'a [Column],
}

impl<'a> Table<'a> {
    pub(super) fn new(columns: &'a [Column], out: Box<dyn Write>, path: PathBuf) -> Self {
        Self {
            out: BufWriter::new(out),
            path,
            columns,
        }
    }

    pub(super) fn write_header(&mut self) -> Result<(), Error> {
        let names = self.columns.iter().map(|column| column.name.as_str());
        let line: Vec<_> = std::iter::once("time").chain(names).collect();
        writeln!(self.out, "{}", line.join(",")).map_err(|source| self.error(source))
    }

    pub(super) fn write_row(&mut self, motion: &Motion) -> Result<(), Error> {
        self.try_write_row(motion)
            .map_err(|source| self.error(source))
    }

    /// Numbers are written so that reading them gives the same bits.
    fn try_write_row(&mut self, motion: &Motion) -> io::Result<()> {
        write!(self.out, "{:?}", motion.solver.pose().time)?;
        for column in self.columns {
            write!(self.out, ",{:?}", column.read(motion))?;
        }
        writeln!(self.out)
    }

    pub(super) fn finish(&mut self) -> Result<(), Error> {
        self.out.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: io::Error) -> Error {
        Error::Write {
            path: self.path.clone(),
            source,
        }
    }
}

/// Values of a run for a chart.
pub(super) struct Record {
    columns: Vec<Column>,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Record {
    pub(super) fn new(columns: Vec<Column>) -> Self {
        Self {
            times: Vec::new(),
            values: vec![Vec::new(); columns.len()],
            columns,
        }
    }

    pub(super) fn add(&mut self, motion: &Motion) {
        self.times.push(motion.solver.pose().time);
        for (values, column) in self.values.iter_mut().zip(&self.columns) {
            values.push(column.read(motion));
        }
    }

    /// Leaves out the coordinates of bodies that stay what they are, and of the bodies that move
    /// all but the first few. Says how many there are then, and how many move, if these are more.
    pub(super) fn leave_out(&mut self) -> Option<[usize; 2]> {
        let mut moving: Vec<Signal> = Vec::new();
        let mut bodies: Vec<BodyId> = Vec::new();
        for (column, values) in self.columns.iter().zip(&self.values) {
            if let (Signal::Body(body, _), Order::Position) = (column.signal, column.order)
                && moves(values)
            {
                moving.push(column.signal);
                if !bodies.contains(&body) {
                    bodies.push(body);
                }
            }
        }
        let shown = &bodies[..bodies.len().min(MOST_BODIES)];
        let keep = |signal: &Signal| match signal {
            Signal::Body(body, _) if !bodies.is_empty() => {
                shown.contains(body) && moving.contains(signal)
            }
            _ => true,
        };
        let columns = std::mem::take(&mut self.columns);
        let values = std::mem::take(&mut self.values);
        let kept = columns.into_iter().zip(values);
        (self.columns, self.values) = kept.filter(|(column, _)| keep(&column.signal)).unzip();
        (shown.len() < bodies.len()).then_some([shown.len(), bodies.len()])
    }

    /// Positions, velocities and accelerations, lengths and angles each in a panel of their own;
    /// angles in degrees.
    pub(super) fn chart(self, mechanism: &Mechanism) -> Chart {
        let mut looks: Vec<Signal> = Vec::new();
        let mut panels: Vec<(Unit, Panel)> = Vec::new();
        for (column, mut values) in self.columns.into_iter().zip(self.values) {
            let look = looks.iter().position(|known| *known == column.signal);
            let look = look.unwrap_or_else(|| {
                looks.push(column.signal);
                looks.len() - 1
            });
            if let Some(display) = column.unit.display {
                values.iter_mut().for_each(|value| *value *= display.factor);
            }
            let line = Line {
                name: column.name,
                look,
                values,
            };
            match panels.iter_mut().find(|(unit, _)| *unit == column.unit) {
                Some((_, panel)) => panel.lines.push(line),
                None => panels.push((
                    column.unit,
                    Panel {
                        y: axis(column.unit),
                        lines: vec![line],
                    },
                )),
            }
        }
        panels.sort_by_key(|(unit, _)| (-unit.dimension.s, unit.dimension.rad));
        Chart {
            title: mechanism.name.clone(),
            description: mechanism.description.clone(),
            x: Axis {
                label: "time".to_owned(),
                unit: "s".to_owned(),
            },
            at: self.times,
            panels: panels.into_iter().map(|(_, panel)| panel).collect(),
        }
    }
}

/// What has this unit, and how it is shown.
pub(super) fn axis(unit: Unit) -> Axis {
    let what = match (unit.dimension.rad, unit.dimension.s) {
        (0, 0) => "position",
        (0, -1) => "velocity",
        (0, _) => "acceleration",
        (_, 0) => "angle",
        (_, -1) => "angular velocity",
        _ => "angular acceleration",
    };
    let shown = unit.display.map_or(unit.name, |display| display.name);
    Axis {
        label: what.to_owned(),
        unit: shown.replace('2', "²"),
    }
}
