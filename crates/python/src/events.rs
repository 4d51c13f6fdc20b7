//! Events of free motions as columns.

use biela::dynamics::{Event, EventKind};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

/// Events as columns: the variant, the time \[s\], the place of the kind in `biela.parts.KINDS`, the
/// index of the force, the speed before an impact \[m/s or rad/s\], not a number for other kinds.
pub(crate) type EventColumns<'py> = (
    Bound<'py, PyArray1<usize>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<usize>>,
    Bound<'py, PyArray1<usize>>,
    Bound<'py, PyArray1<f64>>,
);

/// Returns the events of variants as columns.
pub(crate) fn event_columns<'py>(py: Python<'py>, events: &[(usize, Event)]) -> EventColumns<'py> {
    let column = |value: fn(&Event) -> usize| -> Vec<usize> {
        events.iter().map(|(_, event)| value(event)).collect()
    };
    let number = |value: fn(&Event) -> f64| -> Vec<f64> {
        events.iter().map(|(_, event)| value(event)).collect()
    };
    let variants: Vec<usize> = events.iter().map(|(variant, _)| *variant).collect();
    (
        variants.into_pyarray(py),
        number(|event| event.time).into_pyarray(py),
        column(|event| place(event.kind)).into_pyarray(py),
        column(|event| event.force).into_pyarray(py),
        number(|event| match event.kind {
            EventKind::Impact { speed } => speed,
            _ => f64::NAN,
        })
        .into_pyarray(py),
    )
}

/// Returns the place of a kind among those of the package.
fn place(kind: EventKind) -> usize {
    match kind {
        EventKind::Impact { .. } => 0,
        EventKind::Rests => 1,
        EventKind::Leaves => 2,
        EventKind::Sticks => 3,
        EventKind::Slides => 4,
    }
}
