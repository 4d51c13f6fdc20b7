//! The linearisation: the scaled rows of Phi with their gradients.
//!
//! Metres and radians compare: rows in metres are divided by the size of their part of the
//! mechanism, columns multiplied by [`System::column_scale`].

use nalgebra::{DMatrix, DVector};

use super::{System, Targets};
use crate::kinematics::configuration::Configuration;
use crate::kinematics::constraint::Gradient;
use crate::kinematics::linear::Row;

/// The numbers in the equations at one pose.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Values<'a> {
    pub(in crate::kinematics) at: &'a Configuration,
    pub(in crate::kinematics) targets: &'a Targets,
    /// The values u of all drivers.
    pub(in crate::kinematics) drivers: &'a [f64],
}

/// One entry of Phi, scaled, with its rounding error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct RowValue {
    pub(in crate::kinematics) value: f64,
    /// Estimated rounding error of the value.
    pub(in crate::kinematics) rounding: f64,
}

impl System {
    /// Evaluates a row of Phi and its gradient, scaled. `entry(column, value)` is called for each
    /// entry of the row of the Jacobian (Eq. 3.6.4); two calls for the same column add up.
    #[inline]
    pub(in crate::kinematics) fn evaluate_row(
        &self,
        row: usize,
        values: Values<'_>,
        mut entry: impl FnMut(usize, f64),
    ) -> RowValue {
        let Values {
            at,
            targets,
            drivers,
        } = values;
        let equation = &self.equations[row];
        let size = at.size();
        let row_scale = equation.row_scale(at);
        let target = self.target(row, targets, drivers);
        // To first order each coordinate's own rounding moves the value by gradient times
        // q eps; the sines and products inside add some eps of the size.
        let mut magnitude = target.abs() * row_scale + 1.0;
        let mut gradient = Gradient::new();
        let value = equation.constraint.value_and_gradient(at, &mut gradient);
        let value = (value - target) * row_scale;
        for (column, partial) in gradient.entries() {
            magnitude += (partial * at.coordinate(column)).abs() * row_scale;
            entry(
                column,
                partial * row_scale * self.column_scale(column, size),
            );
        }
        RowValue {
            value,
            rounding: magnitude * f64::EPSILON,
        }
    }

    /// Evaluates a row of Phi and writes the entries of its gradient, each column once.
    pub(in crate::kinematics) fn sparse_row(
        &self,
        row: usize,
        values: Values<'_>,
        entries: &mut Row,
    ) -> RowValue {
        entries.clear();
        self.evaluate_row(row, values, |column, value| {
            match entries.iter_mut().find(|(c, _)| *c == column) {
                Some((_, sum)) => *sum += value,
                None if value != 0.0 => entries.push((column, value)),
                None => {}
            }
        })
    }

    /// Evaluates rows of Phi and their Jacobian in `order` unknowns, of which `place` returns the
    /// index.
    pub(in crate::kinematics) fn dense_rows(
        &self,
        rows: &[usize],
        order: usize,
        place: impl Fn(usize) -> Option<usize>,
        values: Values<'_>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let mut residual = DVector::zeros(rows.len());
        let mut jacobian = DMatrix::zeros(rows.len(), order);
        for (local, &row) in rows.iter().enumerate() {
            let value = self.evaluate_row(row, values, |column, value| {
                if let Some(column) = place(column) {
                    jacobian[(local, column)] += value;
                }
            });
            residual[local] = value.value;
        }
        (residual, jacobian)
    }
}
