//! The rank of a sparse matrix, found row by row.
//!
//! Each row is reduced by the pivots of the rows kept before it, and kept if something is left of
//! it. The last of several dependent rows is left out. The pivot of a row is one of its
//! large entries, as partial pivoting does by columns, which keeps the multipliers small; of these
//! the one in the column that the fewest later rows contain, which keeps the factors sparse: a long
//! chain costs as much per link as a short one.

use std::collections::BTreeSet;

/// A pivot is at least this part of the largest entry that is left of its row.
const LARGE: f64 = 0.1;

/// Entries of a row: column and value, each column once.
pub(in crate::kinematics) type Row = Vec<(usize, f64)>;

/// The rows kept so far, as a product L U of a unit lower triangle and rows in echelon form.
#[derive(Clone, Debug)]
pub(in crate::kinematics) struct Echelon {
    kept: Vec<ReducedRow>,
    /// The kept row that has its pivot in each column.
    pivot_in: Vec<Option<usize>>,
    /// Number of later rows that contain each column.
    to_come: Vec<usize>,
    /// A row while it is reduced; zero otherwise.
    work: Vec<f64>,
}

/// A row after reduction.
#[derive(Clone, Debug)]
pub(in crate::kinematics) struct ReducedRow {
    /// Index of the row.
    pub(in crate::kinematics) row: usize,
    /// The largest entry that is left of it.
    pub(in crate::kinematics) remainder: f64,
    pivot: usize,
    /// The entries that are left.
    upper: Row,
    /// The multiples of kept rows' remainders that were subtracted.
    lower: Vec<(usize, f64)>,
}

impl Echelon {
    /// Begins with no rows kept; `rows` are all that will be offered.
    pub(in crate::kinematics) fn new<'a>(
        columns: usize,
        rows: impl IntoIterator<Item = &'a Row>,
    ) -> Self {
        let mut to_come = vec![0; columns];
        for &(column, _) in rows.into_iter().flatten() {
            to_come[column] += 1;
        }
        Self {
            kept: Vec::new(),
            pivot_in: vec![None; columns],
            to_come,
            work: vec![0.0; columns],
        }
    }

    /// Returns the rows kept, in the order of the offers.
    pub(in crate::kinematics) fn kept(&self) -> &[ReducedRow] {
        &self.kept
    }

    /// Returns the logarithm of the magnitude of the determinant of the rows kept, in the columns of
    /// their pivots.
    pub(in crate::kinematics) fn log_determinant(&self) -> f64 {
        let pivots = self.kept.iter().map(|row| value_at(&row.upper, row.pivot));
        pivots.map(|pivot| pivot.abs().ln()).sum()
    }

    /// Keeps a row if more than `at_least` is left of it, otherwise returns it reduced.
    pub(in crate::kinematics) fn offer(
        &mut self,
        row: usize,
        entries: &Row,
        at_least: f64,
    ) -> Option<ReducedRow> {
        for &(column, _) in entries {
            self.to_come[column] = self.to_come[column].saturating_sub(1);
        }
        let reduced = self.reduce(row, entries);
        // A remainder that is no number is not kept.
        if reduced.remainder > at_least {
            self.pivot_in[reduced.pivot] = Some(self.kept.len());
            self.kept.push(reduced);
            None
        } else {
            Some(reduced)
        }
    }

    /// Reduces a row by the rows kept.
    pub(in crate::kinematics) fn reduce(&mut self, row: usize, entries: &Row) -> ReducedRow {
        let work = &mut self.work;
        let mut touched: BTreeSet<usize> = BTreeSet::new();
        let mut pending: BTreeSet<usize> = BTreeSet::new();
        for &(column, value) in entries {
            work[column] = value;
            touched.insert(column);
            pending.extend(self.pivot_in[column]);
        }
        let mut lower = Vec::new();
        // A kept row has no entries at the pivots of those before it.
        while let Some(before) = pending.pop_first() {
            let ReducedRow { pivot, upper, .. } = &self.kept[before];
            let factor = work[*pivot] / value_at(upper, *pivot);
            if factor == 0.0 {
                continue;
            }
            lower.push((before, factor));
            for &(column, value) in upper {
                work[column] -= factor * value;
                if touched.insert(column) {
                    pending.extend(self.pivot_in[column]);
                }
            }
            work[*pivot] = 0.0;
        }
        let mut upper: Row = Vec::new();
        for column in touched {
            let value = std::mem::take(&mut work[column]);
            if value != 0.0 && self.pivot_in[column].is_none() {
                upper.push((column, value));
            }
        }
        let largest = |most: f64, (_, value): &(usize, f64)| most.max(value.abs());
        let remainder = upper.iter().fold(0.0, largest);
        let large = upper.iter().filter(|(_, v)| v.abs() >= LARGE * remainder);
        let pivot = large.min_by(|(a, x), (b, y)| {
            let fewer = self.to_come[*a].cmp(&self.to_come[*b]);
            fewer.then(y.abs().total_cmp(&x.abs()))
        });
        ReducedRow {
            row,
            remainder,
            pivot: pivot.map_or(usize::MAX, |(column, _)| *column),
            upper,
            lower,
        }
    }

    /// Returns the rows of which a dependent one is a combination, with their factors; those below
    /// `least` times the largest are rounding.
    pub(in crate::kinematics) fn combination(
        &self,
        dependent: &ReducedRow,
        least: f64,
    ) -> Vec<(usize, f64)> {
        // Row k of the matrix is U_k + Σ L_ki U_i, the dependent one Σ l_k U_k: λ L = l.
        let mut factors = vec![0.0; self.kept.len()];
        for &(k, l) in &dependent.lower {
            factors[k] = l;
        }
        for k in (0..factors.len()).rev() {
            if factors[k] != 0.0 {
                for &(before, l) in &self.kept[k].lower {
                    factors[before] -= factors[k] * l;
                }
            }
        }
        let largest = factors.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        let factors = self.kept.iter().zip(factors);
        factors
            .map(|(kept, factor)| (kept.row, factor))
            .filter(|(_, factor)| factor.abs() > least * largest)
            .collect()
    }

    /// Returns the columns without a pivot.
    pub(in crate::kinematics) fn free(&self) -> Vec<usize> {
        let columns = 0..self.pivot_in.len();
        columns.filter(|&k| self.pivot_in[k].is_none()).collect()
    }

    /// Returns the vector that all rows kept map to zero and that has these entries in free
    /// columns, scaled so that its largest entry is one.
    pub(in crate::kinematics) fn null_vector(&self, free: &[(usize, f64)]) -> Vec<f64> {
        let mut vector = vec![0.0; self.pivot_in.len()];
        for &(column, value) in free {
            vector[column] = value;
        }
        for ReducedRow { pivot, upper, .. } in self.kept.iter().rev() {
            let others = upper.iter().filter(|(column, _)| column != pivot);
            let sum: f64 = others.map(|(column, value)| value * vector[*column]).sum();
            vector[*pivot] = -sum / value_at(upper, *pivot);
        }
        let largest = vector.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        if largest > 0.0 {
            vector.iter_mut().for_each(|value| *value /= largest);
        }
        vector
    }
}

fn value_at(row: &Row, column: usize) -> f64 {
    let found = row.iter().find(|(c, _)| *c == column);
    found.map_or(0.0, |(_, value)| *value)
}

#[cfg(test)]
mod tests {
    use super::{Echelon, Row};
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    fn rows(matrix: &DMatrix<f64>) -> Vec<Row> {
        let row = |k: usize| {
            let entries = matrix
                .row(k)
                .iter()
                .copied()
                .enumerate()
                .collect::<Vec<_>>();
            entries.into_iter().filter(|(_, v)| *v != 0.0).collect()
        };
        (0..matrix.nrows()).map(row).collect()
    }

    proptest! {
        /// Compares rank with singular values, and null vectors and combinations with their
        /// definition, for matrices of sparse rows of which some are sums of earlier ones.
        #[test]
        fn rank_null_vectors_and_combinations(
            entries in prop::collection::vec((-3_i32..4, 0.0..1.0_f64), 9 * 8),
            sums in prop::collection::vec(0_usize..6, 3),
        ) {
            let mut matrix = DMatrix::from_fn(9, 8, |r, c| {
                let (value, chance) = entries[8 * r + c];
                if chance < 0.4 { f64::from(value) } else { 0.0 }
            });
            for (k, &first) in sums.iter().enumerate() {
                let sum = matrix.row(first) + matrix.row(k) * 2.0;
                matrix.set_row(6 + k, &sum);
            }
            let rows = rows(&matrix);
            let mut echelon = Echelon::new(8, &rows);
            let mut dependent = Vec::new();
            for (k, row) in rows.iter().enumerate() {
                dependent.extend(echelon.offer(k, row, 1e-9));
            }
            prop_assert_eq!(echelon.kept().len(), matrix.rank(1e-9));
            let kept: Vec<_> = echelon.kept().iter().map(|kept| kept.row).collect();
            for left_out in &dependent {
                let before: Vec<_> = kept.iter().copied().filter(|&k| k < left_out.row).collect();
                let others = matrix.select_rows(&before);
                let mut with = before.clone();
                with.push(left_out.row);
                // nalgebra has no rank for a matrix without rows.
                let rank = if before.is_empty() { 0 } else { others.rank(1e-9) };
                prop_assert_eq!(rank, matrix.select_rows(&with).rank(1e-9));
                let mut sum = matrix.row(left_out.row).clone_owned();
                for (row, factor) in echelon.combination(left_out, 0.0) {
                    sum -= matrix.row(row) * factor;
                }
                prop_assert!(sum.amax() < 1e-9, "{}", sum);
            }
            let free = echelon.free();
            let pivots: Vec<_> = (0..8).filter(|column| !free.contains(column)).collect();
            if !pivots.is_empty() {
                let square = matrix.select_rows(&kept).select_columns(&pivots);
                let determinant = square.determinant().abs();
                prop_assert!((echelon.log_determinant() - determinant.ln()).abs() < 1e-9);
            }
            for column in free {
                let vector = echelon.null_vector(&[(column, 1.0)]);
                let vector = nalgebra::DVector::from_vec(vector);
                prop_assert!((vector.amax() - 1.0).abs() < 1e-12);
                prop_assert!((&matrix * vector).amax() < 1e-9);
            }
        }
    }
}
