//! The rows of a block with their Jacobian, and how they bend.

use std::sync::Arc;

use crate::kinematics::block::Work;
use crate::kinematics::certificate::Tubes;
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::linear::{Factors, Lu};
use crate::kinematics::system::RowValue;

/// The entries of a row at the most: of three bodies and of an unknown of its own.
pub(super) const ENTRIES: usize = 10;

/// Where an unknown is found: the kernel, and its place among the unknowns of that kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::kinematics::block) struct Place {
    pub(in crate::kinematics::block) kernel: usize,
    pub(in crate::kinematics::block) local: usize,
}

/// The rows that have to be solved together, and the unknowns that they are solved for.
#[derive(Debug)]
pub(super) struct Block {
    /// Which kernel of the plan this is.
    index: usize,
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    places: Arc<[Place]>,
}

/// The gradients of a block's rows, scaled as [`System::evaluate_row`] has them.
///
/// [`System::evaluate_row`]: crate::kinematics::system::System::evaluate_row
#[derive(Debug)]
pub(super) struct Jacobian {
    /// At the block's own unknowns, or the factors of that.
    pub(super) lu: Lu,
    /// Entries at unknowns found before: row of the block, column, value.
    pub(super) upstream: Vec<(usize, usize, f64)>,
}

/// How far a row bends in a region, scaled as the row is.
pub(super) struct Bend {
    /// Its second derivative along the chord, at the most.
    pub(super) along: f64,
    /// What the row is multiplied by.
    pub(super) row_scale: f64,
    change: Gradient,
}

impl Block {
    pub(super) fn new(
        index: usize,
        rows: Vec<usize>,
        columns: Vec<usize>,
        places: Arc<[Place]>,
    ) -> Self {
        Self {
            index,
            rows,
            columns,
            places,
        }
    }

    /// The place of an unknown of the block among its own; none if it was found before.
    pub(super) fn own(&self, column: usize) -> Option<usize> {
        let place = self.places[column];
        (place.kernel == self.index).then_some(place.local)
    }

    /// Evaluates the rows at the pose in `work`, each going to `found`, and their Jacobian, not yet
    /// factorised.
    pub(super) fn evaluate(
        &self,
        work: &Work<'_>,
        jacobian: &mut Jacobian,
        mut found: impl FnMut(usize, RowValue),
    ) {
        let Jacobian { lu, upstream } = jacobian;
        lu.clear();
        upstream.clear();
        for local in 0..self.rows.len() {
            let value = self.evaluate_row(local, work, |column, value| match self.own(column) {
                Some(own) => lu.add(local, own, value),
                None if value != 0.0 => upstream.push((local, column, value)),
                None => {}
            });
            found(local, value);
        }
    }

    /// Evaluates one row, the entries of its gradient going to `entry`: column and value.
    pub(super) fn evaluate_row(
        &self,
        local: usize,
        work: &Work<'_>,
        entry: impl FnMut(usize, f64),
    ) -> RowValue {
        let row = self.rows[local];
        work.system
            .evaluate_row(row, work.at, work.targets, work.drivers, entry)
    }

    /// Bounds how far a row of the block bends in the region of `tubes` around the pose in `work`,
    /// and along their chord ([`Constraint::bend`]). `None` if it is not smooth there.
    ///
    /// [`Constraint::bend`]: crate::kinematics::constraint::Constraint::bend
    pub(super) fn bend(&self, local: usize, work: &Work<'_>, tubes: &Tubes) -> Option<Bend> {
        let equation = &work.system.equations()[self.rows[local]];
        let row_scale = equation.row_scale(work.at);
        let region = Region {
            radii: &tubes.region,
        };
        let mut change = Gradient::new();
        let along = equation
            .constraint
            .bend(work.at, &region, &tubes.chord, &mut change)?;
        Some(Bend {
            along: along * row_scale,
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

    /// Writes down the inverse by rows; `unit` is work space.
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

    /// The product of one value a row with the gradients at an unknown found before.
    pub(super) fn turned(&self, rows: &[f64], column: usize) -> f64 {
        let entries = self.upstream.iter().filter(|entry| entry.1 == column);
        entries.map(|(local, _, value)| rows[*local] * value).sum()
    }
}

impl Bend {
    /// By how much the entries of its gradient may change: column and value, the columns in
    /// radians and metres.
    pub(super) fn changes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let entries = self.change.entries();
        entries.map(|(column, value)| (column, value * self.row_scale))
    }
}
