//! The rows of a block, their Jacobian and the bounds of their bend.

use std::sync::Arc;

use crate::kinematics::certificate::{ParameterBounds, StepBounds};
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::linear::{Factors, Lu};
use crate::kinematics::plan::elimination::EliminationOrder;
use crate::kinematics::plan::step::BlockState;
use crate::kinematics::system::{RowValue, System};
use crate::mechanism::Interval;

/// Most entries of a row: of three bodies and one joint unknown.
pub(super) const ENTRIES: usize = 10;

/// Block that solves an unknown, index of the unknown in that block, and its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics::plan) struct ColumnOwner {
    pub(super) block: usize,
    local: usize,
    /// [Part](System::column_part) of the mechanism's size by which the unknown is scaled.
    part: Option<f64>,
}

/// Returns the owner of each unknown; `orders` has the index and the order of each block.
pub(in crate::kinematics::plan) fn column_owners<'a>(
    system: &System,
    orders: impl Iterator<Item = (usize, &'a EliminationOrder)>,
) -> Arc<[ColumnOwner]> {
    let unowned = |column| ColumnOwner {
        block: usize::MAX,
        local: 0,
        part: system.column_part(column),
    };
    let mut owners: Vec<_> = (0..system.unknowns()).map(unowned).collect();
    for (block, order) in orders {
        for (local, &column) in order.columns.iter().enumerate() {
            let owner = &mut owners[column];
            (owner.block, owner.local) = (block, local);
        }
    }
    owners.into()
}

/// The rows that have to be solved together, and the unknowns that they are solved for.
#[derive(Debug)]
pub(super) struct BlockEquations {
    /// Index of the block in the order of solution.
    index: usize,
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    owners: Arc<[ColumnOwner]>,
    /// Scale factors of rows and unknowns for the size in force.
    pub(super) row_scales: Vec<f64>,
    pub(super) column_scales: Vec<f64>,
}

/// The gradients of a block's rows, scaled by [`System::evaluate_row`].
///
/// [`System::evaluate_row`]: crate::kinematics::system::System::evaluate_row
#[derive(Debug)]
pub(super) struct Jacobian {
    /// The matrix of the block's own unknowns, or its factors.
    pub(super) lu: Lu,
    /// Entries at unknowns of earlier blocks.
    pub(super) upstream: Vec<UpstreamEntry>,
}

/// An entry of the Jacobian at an unknown of an earlier block.
#[derive(Clone, Copy, Debug)]
pub(super) struct UpstreamEntry {
    /// Row of the block.
    pub(super) row: usize,
    pub(super) column: usize,
    /// The value, scaled by row and column, and by its row alone.
    pub(super) value: f64,
    pub(super) by_row: f64,
}

/// The bend of a row in a region, scaled as the row is.
pub(super) struct Bend {
    /// Bound of its second derivative along the chord.
    pub(super) along: f64,
    /// Scale factor of the row.
    pub(super) row_scale: f64,
    change: Gradient,
}

impl BlockEquations {
    pub(super) fn new(index: usize, order: EliminationOrder, owners: Arc<[ColumnOwner]>) -> Self {
        let EliminationOrder { rows, columns, .. } = order;
        Self {
            index,
            row_scales: vec![1.0; rows.len()],
            column_scales: vec![1.0; columns.len()],
            rows,
            columns,
            owners,
        }
    }

    /// Takes over the size of the mechanism. Allocates nothing.
    pub(super) fn set_size(&mut self, system: &System, at: &Configuration) {
        for (scale, &row) in self.row_scales.iter_mut().zip(&self.rows) {
            *scale = system.equations()[row].row_scale(at);
        }
        for (scale, &column) in self.column_scales.iter_mut().zip(&self.columns) {
            *scale = system.column_scale(column, at.size());
        }
    }

    /// Returns the index of an unknown in the block; `None` if an earlier block finds it.
    pub(super) fn own(&self, column: usize) -> Option<usize> {
        let owner = self.owners[column];
        (owner.block == self.index).then_some(owner.local)
    }

    /// Returns the unknowns with their scale factors.
    pub(super) fn scaled_columns(&self) -> impl Iterator<Item = (&usize, f64)> {
        self.columns.iter().zip(self.column_scales.iter().copied())
    }

    /// Evaluates the rows at the pose in `state`, each value going to `found`, and their Jacobian,
    /// not yet factorised.
    pub(super) fn evaluate(
        &self,
        state: &BlockState<'_>,
        jacobian: &mut Jacobian,
        mut found: impl FnMut(usize, RowValue),
    ) {
        let Jacobian { lu, upstream } = jacobian;
        lu.clear();
        upstream.clear();
        let (system, values) = (state.system, state.values());
        let size = values.at.size();
        for (local, (&row, &row_scale)) in self.rows.iter().zip(&self.row_scales).enumerate() {
            let value = system.evaluate_scaled_row(row, row_scale, values, |column, by_row| {
                let owner = &self.owners[column];
                if owner.block == self.index {
                    lu.add(local, owner.local, by_row * self.column_scales[owner.local]);
                } else {
                    let scale = owner.part.map_or(1.0, |part| size * part);
                    upstream.push(UpstreamEntry {
                        row: local,
                        column,
                        value: by_row * scale,
                        by_row,
                    });
                }
            });
            found(local, value);
        }
    }

    /// Bounds the bend of a row along the chord of `bounds` ([`Constraint::bend`]). The bound holds
    /// in a region: the radii of `bounds` around the pose in `state` or, if `on_chord`, around the
    /// whole chord, of which that pose is the middle. Returns `None` if the row is not smooth
    /// there.
    ///
    /// [`Constraint::bend`]: crate::kinematics::constraint::Constraint::bend
    pub(super) fn bend(
        &self,
        local: usize,
        state: &BlockState<'_>,
        bounds: &StepBounds,
        on_chord: bool,
    ) -> Option<Bend> {
        let equation = &state.system.equations()[self.rows[local]];
        let row_scale = self.row_scales[local];
        let region = Region {
            radii: &bounds.region,
            line: on_chord.then_some(&bounds.chord),
        };
        let mut change = Gradient::new();
        let along = equation
            .constraint
            .bend(state.at, &region, &bounds.chord, &mut change)?;
        Some(Bend {
            along: along * row_scale,
            row_scale,
            change,
        })
    }

    /// Bounds the bend of a row on the chord of `bounds` and around it; the pose in `state` is in
    /// the middle of the chord. Returns `None` if the row is not smooth there.
    pub(super) fn bend_on_chord(
        &self,
        local: usize,
        state: &BlockState<'_>,
        bounds: &mut StepBounds,
    ) -> Option<Bend> {
        let row = self.rows[local];
        if !bounds.parameters.moves(row) {
            return self.bend(local, state, bounds, true);
        }
        self.enclosed_bend(local, state, &mut bounds.parameters)
    }

    /// Bounds the bend of a row while parameters move its numbers. Returns `None` if it has no
    /// enclosure.
    #[cold]
    fn enclosed_bend(
        &self,
        local: usize,
        state: &BlockState<'_>,
        parameters: &mut ParameterBounds,
    ) -> Option<Bend> {
        let row = self.rows[local];
        let equation = &state.system.equations()[row];
        let profiles = state.at.profiles();
        let row_scale = self.row_scales[local];
        let along = parameters.bend(row, equation, profiles)? * row_scale;
        let mut change = Gradient::new();
        equation.constraint.gradient(state.at, &mut change);
        change.replace(|column, value| {
            let range = parameters.partial(&*equation.constraint, profiles, column);
            (range - Interval::point(value)).magnitude()
        });
        let finite = change.entries().all(|(_, value)| value.is_finite());
        finite.then_some(Bend {
            along,
            row_scale,
            change,
        })
    }
}

impl Jacobian {
    pub(super) fn new(lu: Lu) -> Self {
        Self {
            upstream: Vec::with_capacity(ENTRIES * lu.order()),
            lu,
        }
    }

    /// Writes the inverse by rows; `unit` is work space.
    pub(super) fn invert(&mut self, inverse: &mut [f64], unit: &mut [f64]) {
        let order = unit.len();
        for column in 0..order {
            unit.fill(0.0);
            unit[column] = 1.0;
            self.lu.solve(unit);
            for (row, value) in unit.iter().enumerate() {
                inverse[row * order + column] = *value;
            }
        }
    }

    /// Returns the product of a vector, one entry per row, with the gradients at an unknown of an
    /// earlier block.
    pub(super) fn upstream_product(&self, rows: &[f64], column: usize) -> f64 {
        let entries = self.upstream.iter().filter(|entry| entry.column == column);
        entries.map(|entry| rows[entry.row] * entry.value).sum()
    }
}

impl Bend {
    /// Returns bounds of the change of the gradient's entries: column and value, the columns in
    /// radians and metres.
    pub(super) fn changes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let entries = self.change.entries();
        entries.map(|(column, value)| (column, value * self.row_scale))
    }
}
