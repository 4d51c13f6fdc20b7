//! The linearisation: the scaled rows of Phi with their gradients.
//!
//! Metres and radians compare: rows in metres are divided by the size of their part of the
//! mechanism, columns multiplied by [`System::column_scale`].

use nalgebra::{DMatrix, DVector};

use super::{System, Targets};
use crate::kinematics::constraint::Gradient;
use crate::kinematics::constraint::configuration::Configuration;
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
    /// Evaluates a row of Phi and its gradient, scaled. `entry(column, value)` is called for the
    /// entries of the row of the Jacobian (Eq. 3.6.4) that are not zero, once for each column.
    #[inline]
    pub(in crate::kinematics) fn evaluate_row(
        &self,
        row: usize,
        values: Values<'_>,
        mut entry: impl FnMut(usize, f64),
    ) -> RowValue {
        let size = values.at.size();
        let row_scale = self.equations[row].row_scale(values.at);
        self.evaluate_scaled_row(row, row_scale, values, |column, value| {
            entry(column, value * self.column_scale(column, size));
        })
    }

    /// Evaluates a row of Phi and its gradient, both multiplied by `row_scale`: its entries that are
    /// not zero, for columns in radians and metres.
    #[inline]
    pub(in crate::kinematics) fn evaluate_scaled_row(
        &self,
        row: usize,
        row_scale: f64,
        values: Values<'_>,
        mut entry: impl FnMut(usize, f64),
    ) -> RowValue {
        let Values {
            at,
            targets,
            drivers,
        } = values;
        let target = self.target(row, targets, drivers);
        // To first order each coordinate's own rounding moves the value by gradient times
        // q eps; the sines and products inside add some eps of the size.
        let mut magnitude = target.abs() * row_scale + 1.0;
        let mut gradient = Gradient::new();
        let constraint = &self.equations[row].constraint;
        let value = constraint.value_and_gradient(at, &mut gradient);
        let mut add = |column: usize, partial: f64, coordinate: f64| {
            if partial != 0.0 {
                magnitude += (partial * coordinate).abs() * row_scale;
                entry(column, partial * row_scale);
            }
        };
        for &(body, [x, y, phi]) in gradient.bodies() {
            let frame = &at.frames()[body];
            add(3 * body, x, frame.origin.x);
            add(3 * body + 1, y, frame.origin.y);
            add(3 * body + 2, phi, frame.phi);
        }
        if let Some((column, partial)) = gradient.joint_unknown() {
            add(column, partial, at.coordinate(column));
        }
        RowValue {
            value: (value - target) * row_scale,
            rounding: magnitude * f64::EPSILON,
        }
    }

    /// Evaluates a row of Phi and writes the entries of its gradient.
    pub(in crate::kinematics) fn sparse_row(
        &self,
        row: usize,
        values: Values<'_>,
        entries: &mut Row,
    ) -> RowValue {
        entries.clear();
        self.evaluate_row(row, values, |column, value| entries.push((column, value)))
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
