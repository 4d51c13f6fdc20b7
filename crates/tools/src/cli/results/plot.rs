//! A run as a chart.

use std::path::PathBuf;

use super::column::{Output, Source};
use super::picture::Format;
use super::recorder::Recorder;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::drawing::{Axis, COLOURS, Line, LineChart, Panel, Sheet};
use biela::dynamics::{Event, Motion};
use biela::mechanism::{BodyId, Dimension, Mechanism, Order, Signal, Unit};

/// Largest number of bodies whose lines can be told apart.
pub(in crate::cli) const MOST_BODIES: usize = 8;

/// Values of a run for a chart, and the picture to write.
pub(in crate::cli) struct Plot {
    path: PathBuf,
    format: Format,
    columns: Vec<Output>,
    /// Whether a note says which bodies are left out: the user has named none.
    notes_omission: bool,
    /// The quantity on the x-axis with its values, `None` for time.
    over: Option<(Output, Vec<f64>)>,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Plot {
    pub(in crate::cli) fn new(
        path: PathBuf,
        format: Format,
        columns: Vec<Output>,
        notes_omission: bool,
        over: Option<Output>,
    ) -> Self {
        Self {
            path,
            format,
            notes_omission,
            over: over.map(|column| (column, Vec::new())),
            times: Vec::new(),
            values: vec![Vec::new(); columns.len()],
            columns,
        }
    }

    /// Removes the coordinates of bodies that stay constant, and all but the first few of the
    /// bodies that move. Returns how many it keeps, and how many move, if these are more.
    fn leave_out(&mut self) -> Option<[usize; 2]> {
        let mut moving: Vec<Signal> = Vec::new();
        let mut bodies: Vec<BodyId> = Vec::new();
        for (column, values) in self.columns.iter().zip(&self.values) {
            if let Source::Signal(signal @ Signal::Body(body, _), Order::Position) = column.source
                && varies(values)
            {
                moving.push(signal);
                if !bodies.contains(&body) {
                    bodies.push(body);
                }
            }
        }
        let shown = &bodies[..bodies.len().min(MOST_BODIES)];
        let is_kept = |source: Source| match source {
            Source::Signal(signal @ Signal::Body(body, _), _) if !bodies.is_empty() => {
                shown.contains(&body) && moving.contains(&signal)
            }
            _ => true,
        };
        self.retain(|column, _| is_kept(column.source));
        (shown.len() < bodies.len()).then_some([shown.len(), bodies.len()])
    }

    /// Removes all that stays constant, and what the x-axis shows, unless nothing else is there.
    fn leave_out_constants(&mut self) {
        let over = self.over.as_ref().map(|(column, _)| column.source);
        let is_kept =
            |column: &Output, values: &[f64]| varies(values) && Some(column.source) != over;
        let mut all = self.columns.iter().zip(&self.values);
        if !all.any(|(column, values)| is_kept(column, values)) {
            return;
        }
        self.retain(is_kept);
    }

    /// Removes the other columns with their values.
    fn retain(&mut self, is_kept: impl Fn(&Output, &[f64]) -> bool) {
        let columns = std::mem::take(&mut self.columns).into_iter();
        let all = columns.zip(std::mem::take(&mut self.values));
        let kept = all.filter(|(column, values)| is_kept(column, values));
        (self.columns, self.values) = kept.unzip();
    }

    /// Returns the chart: one panel per unit, positions first and forces last; angles in degrees.
    /// Drivers have panels of their own, where their ramps leave the results their scale.
    fn chart(self, mechanism: &Mechanism, events: &[Event]) -> LineChart {
        let times = events.iter().map(|event| event.time).collect();
        let looks = looks(&self.columns, mechanism);
        let mut panels: Vec<((Unit, bool), Panel)> = Vec::new();
        let lines = self.columns.into_iter().zip(self.values).zip(looks);
        for ((column, values), look) in lines {
            let is_driver = matches!(column.source, Source::Signal(Signal::Motion(_), _));
            let key = (column.unit, is_driver);
            panel(&mut panels, key, column.unit).lines.push(Line {
                name: column.name,
                look,
                values: displayed(values, column.unit),
                marks: Vec::new(),
            });
        }
        panels.sort_by_key(|((unit, is_driver), _)| {
            let dimension = unit.dimension;
            (dimension.kg, -dimension.s, dimension.rad, !is_driver)
        });
        let (x, at, instants) = match self.over {
            Some((column, values)) => {
                let Axis { unit, .. } = axis(column.unit);
                let label = column.name.trim_end_matches(".position").to_owned();
                let values = displayed(values, column.unit);
                (Axis { label, unit }, values, Vec::new())
            }
            None => {
                let [label, unit] = ["time", "s"].map(str::to_owned);
                (Axis { label, unit }, self.times, times)
            }
        };
        LineChart {
            title: mechanism.name.clone(),
            description: mechanism.description.clone(),
            x,
            at,
            instants,
            panels: panels.into_iter().map(|(_, panel)| panel).collect(),
        }
    }
}

/// Returns the panel of a key, a new one with the axis of a unit if there is none.
pub(in crate::cli) fn panel<K: PartialEq>(
    panels: &mut Vec<(K, Panel)>,
    key: K,
    unit: Unit,
) -> &mut Panel {
    let known = panels.iter().position(|(known, _)| *known == key);
    let index = known.unwrap_or_else(|| {
        let (y, lines) = (axis(unit), Vec::new());
        panels.push((key, Panel { y, lines }));
        panels.len() - 1
    });
    &mut panels[index].1
}

/// Returns values in the unit for display.
fn displayed(values: Vec<f64>, unit: Unit) -> Vec<f64> {
    let factor = unit.display_factor();
    values.into_iter().map(|value| factor * value).collect()
}

/// Returns the look of each column. What belongs to a body has its colour in the drawing; several
/// such signals of one kind differ in their dashes. Others have the colours that are left.
fn looks(columns: &[Output], mechanism: &Mechanism) -> Vec<usize> {
    let body = |column: &Output| match column.source {
        Source::Signal(Signal::Body(body, _), _) => Some(body),
        Source::Signal(Signal::Marker(marker, _), _) => mechanism.markers[marker.index()].body,
        _ => None,
    };
    let mut known: Vec<(&Output, usize)> = Vec::new();
    let (of_bodies, others): (Vec<&Output>, Vec<&Output>) =
        columns.iter().partition(|column| body(column).is_some());
    for column in of_bodies.into_iter().chain(others) {
        let akin = known
            .iter()
            .find(|(other, _)| other.source.is_akin(column.source));
        let look = akin.map(|(_, look)| *look);
        // Looks are apart within a panel.
        let is_free = |look: &usize| {
            let same =
                |(other, taken): &(&Output, usize)| taken == look && other.unit == column.unit;
            !known.iter().any(same)
        };
        let look = look.or_else(|| match body(column) {
            Some(body) => (body.index()..).step_by(COLOURS).find(is_free),
            None => (0..).find(is_free),
        });
        known.push((column, look.unwrap_or(0)));
    }
    let look = |column: &Output| {
        let same = known.iter().find(|(other, _)| std::ptr::eq(*other, column));
        same.map_or(0, |(_, look)| *look)
    };
    columns.iter().map(look).collect()
}

impl Recorder for Plot {
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        self.times.push(motion.pose().time);
        if let Some((column, values)) = &mut self.over {
            values.push(motion.value(column));
        }
        for (values, column) in self.values.iter_mut().zip(&self.columns) {
            values.push(motion.value(column));
        }
        Ok(())
    }

    fn finish(self: Box<Self>, motion: &Motion, events: &[Event]) -> Result<(), Error> {
        let (path, format) = (self.path.clone(), self.format);
        format.write_chart(&path, &self.sheet(motion.mechanism(), events))
    }
}

impl Plot {
    /// Returns the picture of the rows. What stays constant is left out, if the user has named nothing.
    pub(in crate::cli) fn sheet(mut self, mechanism: &Mechanism, events: &[Event]) -> Sheet {
        if self.notes_omission {
            if let Some([shown, moving]) = self.leave_out() {
                let note = format!(
                    "the plot shows {shown} of {moving} bodies that move; --variables names others"
                );
                Message::Note(note).show();
            }
            self.leave_out_constants();
        }
        Sheet::chart(&self.chart(mechanism, events))
    }
}

/// Returns whether a quantity changes by more than rounding.
pub(in crate::cli) fn varies(values: &[f64]) -> bool {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = (values.iter()).fold(none, |[low, high], v| [low.min(*v), high.max(*v)]);
    high - low > 1e-9 * high.abs().max(low.abs()).max(1.0)
}

/// Returns the axis for quantities of a unit, with its display unit.
pub(in crate::cli) fn axis(unit: Unit) -> Axis {
    let Dimension {
        kg,
        m,
        s,
        rad,
        a,
        k,
    } = unit.dimension;
    let label = match (kg, m, s, rad) {
        _ if [a, k] != [0; 2] => "value",
        _ if unit == Unit::NEWTON => "force",
        _ if unit == Unit::NEWTON_METRE => "torque",
        _ if unit == Unit::WATT => "power",
        _ if unit == Unit::JOULE => "energy",
        (1, _, 0, _) => "inertia",
        (0, 1, 0, 0) => "position",
        (0, 1, -1, 0) => "velocity",
        (0, 1, -2, 0) => "acceleration",
        (0, 0, 0, 1) => "angle",
        (0, 0, -1, 1) => "angular velocity",
        (0, 0, -2, 1) => "angular acceleration",
        // A computed measure, such as a ratio.
        _ => "value",
    };
    Axis {
        label: label.to_owned(),
        unit: unit.display_name().replace('2', "²"),
    }
}
