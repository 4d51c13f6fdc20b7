//! A run as a chart.

use std::path::PathBuf;

use super::column::{Column, Source};
use super::error::Error;
use super::message::Message;
use super::motion::Motion;
use super::picture::Format;
use super::recorder::Recorder;
use crate::drawing::{Axis, Chart, Line, Panel, Sheet};
use crate::fmi::{Order, Signal};
use crate::mechanism::{BodyId, Mechanism, Unit};

/// Largest number of bodies whose lines can be told apart.
pub(super) const MOST_BODIES: usize = 8;

/// Values of a run for a chart, and the picture to write.
pub(super) struct Plot {
    path: PathBuf,
    format: Format,
    columns: Vec<Column>,
    /// Whether a note says which bodies are left out: the user has named none.
    notes_omission: bool,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Plot {
    pub(super) fn new(
        path: PathBuf,
        format: Format,
        columns: Vec<Column>,
        notes_omission: bool,
    ) -> Self {
        Self {
            path,
            format,
            notes_omission,
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
        let columns = std::mem::take(&mut self.columns).into_iter();
        let all = columns.zip(std::mem::take(&mut self.values));
        let kept = all.filter(|(column, _)| is_kept(column.source));
        (self.columns, self.values) = kept.unzip();
        (shown.len() < bodies.len()).then_some([shown.len(), bodies.len()])
    }

    /// Returns the chart: one panel per unit, positions first and forces last; angles in degrees.
    fn chart(self, mechanism: &Mechanism) -> Chart {
        let mut sources: Vec<Source> = Vec::new();
        let mut panels: Vec<(Unit, Panel)> = Vec::new();
        for (column, mut values) in self.columns.into_iter().zip(self.values) {
            let look = sources
                .iter()
                .position(|known| known.is_akin(column.source));
            let look = look.unwrap_or_else(|| {
                sources.push(column.source);
                sources.len() - 1
            });
            if let Some(display) = column.unit.display {
                values.iter_mut().for_each(|value| *value *= display.factor);
            }
            let panel = panels.iter().position(|(unit, _)| *unit == column.unit);
            let panel = panel.unwrap_or_else(|| {
                let (y, lines) = (axis(column.unit), Vec::new());
                panels.push((column.unit, Panel { y, lines }));
                panels.len() - 1
            });
            panels[panel].1.lines.push(Line {
                name: column.name,
                look,
                values,
            });
        }
        panels.sort_by_key(|(unit, _)| {
            let dimension = unit.dimension;
            (dimension.kg, -dimension.s, dimension.rad)
        });
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

impl Recorder for Plot {
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        self.times.push(motion.solver.pose().time);
        for (values, column) in self.values.iter_mut().zip(&self.columns) {
            values.push(column.read(motion));
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, motion: &Motion) -> Result<(), Error> {
        if self.notes_omission
            && let Some([shown, moving]) = self.leave_out()
        {
            let note = format!(
                "the plot shows {shown} of {moving} bodies that move; --variables names others"
            );
            Message::Note(note).show();
        }
        let (path, format) = (self.path.clone(), self.format);
        let sheet = Sheet::chart(&self.chart(motion.solver.mechanism()));
        format.write_chart(&path, &sheet)
    }
}

/// Returns whether a quantity changes by more than rounding.
pub(super) fn varies(values: &[f64]) -> bool {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = (values.iter()).fold(none, |[low, high], v| [low.min(*v), high.max(*v)]);
    high - low > 1e-9 * high.abs().max(low.abs()).max(1.0)
}

/// Returns the axis for quantities of a unit, with its display unit.
pub(super) fn axis(unit: Unit) -> Axis {
    let label = match (unit.dimension.rad, unit.dimension.s) {
        _ if unit == Unit::NEWTON => "force",
        _ if unit == Unit::NEWTON_METRE => "torque",
        _ if unit == Unit::WATT => "power",
        _ if unit == Unit::JOULE => "energy",
        _ if unit.dimension.kg > 0 => "inertia",
        (0, 0) => "position",
        (0, -1) => "velocity",
        (0, _) => "acceleration",
        (_, 0) => "angle",
        (_, -1) => "angular velocity",
        _ => "angular acceleration",
    };
    let shown = unit.display.map_or(unit.name, |display| display.name);
    Axis {
        label: label.to_owned(),
        unit: shown.replace('2', "²"),
    }
}
