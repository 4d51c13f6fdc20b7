//! A sparse matrix and its LU factorisation with fixed pivots.
//!
//! The pivots are chosen once, by Markowitz' count among entries that are large enough, which
//! fixes the pattern of the factors. Then each factorisation runs over fixed lists, as long as its
//! pivots stay large enough; otherwise they are chosen again.

use std::collections::BTreeSet;

use super::factors::{Factors, Singular};

/// Least magnitude of a new pivot, as part of the largest entry of its row.
const CHOOSE: f64 = 0.1;
/// Least magnitude of a kept pivot, as part of the largest entry of its row.
const KEEP: f64 = 1e-3;

/// A sparse matrix of fixed pattern and its factors.
///
/// Fill with [`clear`](Self::clear) and [`add`](Self::add), then [`factorise`](Self::factorise),
/// then solve any number of times.
#[derive(Clone, Debug)]
pub struct SparseLu {
    /// The matrix by rows.
    matrix: Rows,
    /// The factors in the order in use, `None` before pivots are chosen.
    factors: Option<Triangles>,
    diagonal: Vec<f64>,
    /// A row while it is eliminated; zero otherwise.
    work: Vec<f64>,
    norm: f64,
}

/// Entries by rows: those of row k are at `start[k]..start[k + 1]`.
#[derive(Clone, Debug, Default)]
struct Rows {
    start: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

/// The order of pivots: the row and the column of each.
#[derive(Debug, Default, PartialEq)]
pub struct PivotOrder {
    /// Row of each pivot.
    pub rows: Vec<usize>,
    /// Column of each pivot.
    pub columns: Vec<usize>,
}

/// An order of pivots, and the factors in it.
#[derive(Clone, Debug)]
struct Triangles {
    order: PivotOrder,
    /// The pivot of each column.
    place: Vec<usize>,
    /// L without its unit diagonal and U without its diagonal, by rows in the order of pivots;
    /// columns are numbered likewise.
    lower: Rows,
    upper: Rows,
}

impl Clone for PivotOrder {
    fn clone(&self) -> Self {
        Self {
            rows: self.rows.clone(),
            columns: self.columns.clone(),
        }
    }

    /// Copies without allocation where the lengths agree.
    fn clone_from(&mut self, source: &Self) {
        self.rows.clone_from(&source.rows);
        self.columns.clone_from(&source.columns);
    }
}

impl PivotOrder {
    /// Returns whether it has each of the first `order` rows and columns once.
    fn is_complete(&self, order: usize) -> bool {
        let is_permutation = |list: &[usize]| {
            let mut seen = vec![false; order];
            let mut fresh = list.iter().map(|&k| {
                let seen = seen.get_mut(k);
                seen.is_some_and(|seen| !std::mem::replace(seen, true))
            });
            list.len() == order && fresh.all(|fresh| fresh)
        };
        is_permutation(&self.rows) && is_permutation(&self.columns)
    }
}

impl Triangles {
    /// Finds the pattern of the factors of a matrix in this order of pivots.
    fn new(matrix: &Rows, order: PivotOrder) -> Self {
        let mut place = vec![0; order.columns.len()];
        for (k, &column) in order.columns.iter().enumerate() {
            place[column] = k;
        }
        let mut lower: Vec<Vec<usize>> = Vec::with_capacity(place.len());
        let mut upper: Vec<Vec<usize>> = Vec::with_capacity(place.len());
        for (k, &row) in order.rows.iter().enumerate() {
            let (columns, _) = matrix.row(row);
            let mut entries: BTreeSet<_> = columns.iter().map(|&column| place[column]).collect();
            let mut before = Vec::new();
            // Each row that is subtracted adds its entries, all behind its own pivot.
            while let Some(first) = entries.first().copied().filter(|&first| first < k) {
                entries.remove(&first);
                before.push(first);
                entries.extend(&upper[first]);
            }
            entries.remove(&k);
            lower.push(before);
            upper.push(entries.into_iter().collect());
        }
        Self {
            order,
            place,
            lower: Rows::new(lower.into_iter()),
            upper: Rows::new(upper.into_iter()),
        }
    }
}

impl Rows {
    fn new(rows: impl Iterator<Item = Vec<usize>>) -> Self {
        let mut all = Self {
            start: vec![0],
            ..Self::default()
        };
        for mut row in rows {
            row.sort_unstable();
            all.columns.append(&mut row);
            all.start.push(all.columns.len());
        }
        all.values = vec![0.0; all.columns.len()];
        all
    }

    fn row(&self, k: usize) -> (&[usize], &[f64]) {
        let range = self.start[k]..self.start[k + 1];
        (&self.columns[range.clone()], &self.values[range])
    }
}

impl SparseLu {
    /// Makes a matrix with entries at the given columns of each row.
    #[must_use]
    pub fn new(pattern: Vec<Vec<usize>>) -> Self {
        let order = pattern.len();
        Self {
            matrix: Rows::new(pattern.into_iter()),
            factors: None,
            diagonal: vec![0.0; order],
            work: vec![0.0; order],
            norm: 0.0,
        }
    }

    /// Sets the matrix to zero.
    pub fn clear(&mut self) {
        self.matrix.values.fill(0.0);
    }

    /// Adds to an entry; one outside the pattern is left out.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let range = self.matrix.start[row]..self.matrix.start[row + 1];
        let place = self.matrix.columns[range.clone()]
            .iter()
            .position(|&c| c == column);
        if let Some(place) = place {
            self.matrix.values[range.start + place] += value;
        }
    }

    /// Returns the entries of this matrix minus those of another one of the same pattern: row,
    /// column, value.
    pub fn differences<'a>(
        &'a self,
        other: &'a Self,
    ) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
        let own = &self.matrix;
        let entries = own.columns.iter().zip(&own.values);
        let entries = entries.zip(&other.matrix.values);
        let mut row = 0;
        entries.enumerate().map(move |(place, ((&column, a), b))| {
            while own.start[row + 1] <= place {
                row += 1;
            }
            (row, column, a - b)
        })
    }

    /// Computes the factors. The norm counts as at least `least_norm`. Allocates when pivots are
    /// chosen: the first time, and when they have become too small.
    ///
    /// # Errors
    ///
    /// [`Singular`] on a pivot that is zero or not finite.
    pub fn factorise(&mut self, least_norm: f64) -> Result<(), Singular> {
        self.work.fill(0.0);
        let entries = self.matrix.columns.iter().zip(&self.matrix.values);
        for (&column, value) in entries {
            self.work[column] += value.abs();
        }
        self.norm = self.work.iter().copied().fold(least_norm, f64::max);
        self.work.fill(0.0);
        if !self.norm.is_finite() {
            return Err(Singular);
        }
        if self.factors.is_some() && self.eliminate(KEEP) {
            return Ok(());
        }
        self.factors = Some(Triangles::new(&self.matrix, self.choose()?));
        if self.eliminate(0.0) {
            Ok(())
        } else {
            self.factors = None;
            Err(Singular)
        }
    }

    /// Lets the next factorisation choose its pivots.
    pub fn forget_pivots(&mut self) {
        self.factors = None;
    }

    /// Copies the pivots in use to `order`, which is empty if there are none.
    pub fn copy_pivots(&self, order: &mut PivotOrder) {
        match &self.factors {
            Some(factors) => order.clone_from(&factors.order),
            None => {
                order.rows.clear();
                order.columns.clear();
            }
        }
    }

    /// Uses these pivots from the next factorisation on; an empty order lets it choose them.
    /// Returns false if they do not fit the matrix.
    pub fn use_pivots(&mut self, order: &PivotOrder) -> bool {
        if *order == PivotOrder::default() {
            self.factors = None;
            return true;
        }
        let is_used = |factors: &Triangles| factors.order == *order;
        if self.factors.as_ref().is_some_and(is_used) {
            return true;
        }
        let fits = order.is_complete(self.diagonal.len());
        if fits {
            self.factors = Some(Triangles::new(&self.matrix, order.clone()));
        }
        fits
    }

    /// Runs the elimination in the chosen order. Returns false if a pivot is not above `keep` times
    /// the largest entry of its row.
    fn eliminate(&mut self, keep: f64) -> bool {
        let Some(Triangles {
            order,
            place,
            lower,
            upper,
        }) = &mut self.factors
        else {
            return false;
        };
        let mut kept = true;
        for (k, &row) in order.rows.iter().enumerate() {
            let work = &mut self.work;
            let (columns, values) = self.matrix.row(row);
            for (&column, &value) in columns.iter().zip(values) {
                work[place[column]] = value;
            }
            for entry in lower.start[k]..lower.start[k + 1] {
                let before = lower.columns[entry];
                let factor = work[before] / self.diagonal[before];
                work[before] = 0.0;
                lower.values[entry] = factor;
                let (columns, values) = upper.row(before);
                for (&column, &value) in columns.iter().zip(values) {
                    work[column] -= factor * value;
                }
            }
            let pivot = std::mem::take(&mut work[k]);
            self.diagonal[k] = pivot;
            let mut largest = pivot.abs();
            for entry in upper.start[k]..upper.start[k + 1] {
                let value = std::mem::take(&mut work[upper.columns[entry]]);
                upper.values[entry] = value;
                largest = largest.max(value.abs());
            }
            // False for a pivot that is no number.
            kept &= pivot.abs() > keep * largest && largest.is_finite();
        }
        kept
    }

    /// Chooses the pivots for the present values: the entry with the fewest others in its row
    /// and column (Markowitz) among those that are large enough.
    fn choose(&self) -> Result<PivotOrder, Singular> {
        let order = self.diagonal.len();
        let mut rows: Vec<Vec<(usize, f64)>> = (0..order)
            .map(|k| {
                let (columns, values) = self.matrix.row(k);
                columns
                    .iter()
                    .copied()
                    .zip(values.iter().copied())
                    .collect()
            })
            .collect();
        let mut rows_with: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); order];
        for (row, entries) in rows.iter().enumerate() {
            for &(column, _) in entries {
                rows_with[column].insert(row);
            }
        }
        let mut by_length: BTreeSet<_> = (0..order).map(|row| (rows[row].len(), row)).collect();
        let mut pivots: Vec<(usize, usize)> = Vec::with_capacity(order);
        for _ in 0..order {
            let (row, column) = pick(&rows, &rows_with, &by_length).ok_or(Singular)?;
            let pivot_row = std::mem::take(&mut rows[row]);
            by_length.remove(&(pivot_row.len(), row));
            for &(other, _) in &pivot_row {
                rows_with[other].remove(&row);
            }
            let pivot = value_at(&pivot_row, column);
            for below in std::mem::take(&mut rows_with[column]) {
                let target = &mut rows[below];
                by_length.remove(&(target.len(), below));
                let factor = value_at(target, column) / pivot;
                target.retain(|(other, _)| *other != column);
                for &(other, value) in pivot_row.iter().filter(|(other, _)| *other != column) {
                    match target.iter_mut().find(|(c, _)| *c == other) {
                        Some((_, entry)) => *entry -= factor * value,
                        None => {
                            target.push((other, -factor * value));
                            rows_with[other].insert(below);
                        }
                    }
                }
                by_length.insert((target.len(), below));
            }
            pivots.push((row, column));
        }
        let (rows, columns) = pivots.into_iter().unzip();
        Ok(PivotOrder { rows, columns })
    }

    /// Returns the magnitudes of the smallest and the largest pivot.
    #[must_use]
    pub fn pivot_range(&self) -> (f64, f64) {
        let pivots = self.diagonal.iter().map(|pivot| pivot.abs());
        pivots.fold((f64::INFINITY, 0.0_f64), |(low, high), pivot| {
            (low.min(pivot), high.max(pivot))
        })
    }
}

/// Number of rows, the shortest ones, among which a pivot is chosen.
const LOOK_AT: usize = 4;

/// Returns the row and the column of the next pivot.
fn pick(
    rows: &[Vec<(usize, f64)>],
    rows_with: &[BTreeSet<usize>],
    by_length: &BTreeSet<(usize, usize)>,
) -> Option<(usize, usize)> {
    let mut best: Option<(usize, f64, usize, usize)> = None;
    for &(length, row) in by_length.iter().take(LOOK_AT) {
        let largest = rows[row].iter().fold(0.0, |m: f64, (_, v)| m.max(v.abs()));
        for &(column, value) in &rows[row] {
            let size = value.abs();
            if size > 0.0 && size >= CHOOSE * largest {
                let count = (length - 1) * (rows_with[column].len() - 1);
                let better = best.is_none_or(|(least, magnitude, ..)| {
                    count < least || (count == least && size > magnitude)
                });
                if better {
                    best = Some((count, size, row, column));
                }
            }
        }
    }
    best.map(|(_, _, row, column)| (row, column))
}

fn value_at(row: &[(usize, f64)], column: usize) -> f64 {
    let entry = row.iter().find(|(c, _)| *c == column);
    entry.map_or(0.0, |(_, value)| *value)
}

impl Factors for SparseLu {
    fn order(&self) -> usize {
        self.diagonal.len()
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    fn solve(&mut self, b: &mut [f64]) {
        let Some(factors) = &self.factors else {
            return;
        };
        let x = &mut self.work;
        for (k, &row) in factors.order.rows.iter().enumerate() {
            let (columns, values) = factors.lower.row(k);
            let known = columns.iter().zip(values).map(|(&c, l)| l * x[c]);
            x[k] = b[row] - known.sum::<f64>();
        }
        for k in (0..x.len()).rev() {
            let (columns, values) = factors.upper.row(k);
            let known = columns.iter().zip(values).map(|(&c, u)| u * x[c]);
            x[k] = (x[k] - known.sum::<f64>()) / self.diagonal[k];
        }
        for (x, &column) in x.iter_mut().zip(&factors.order.columns) {
            b[column] = std::mem::take(x);
        }
    }

    fn solve_transposed(&mut self, b: &mut [f64]) {
        let Some(factors) = &self.factors else {
            return;
        };
        let x = &mut self.work;
        for (x, &column) in x.iter_mut().zip(&factors.order.columns) {
            *x = b[column];
        }
        for k in 0..x.len() {
            let value = x[k] / self.diagonal[k];
            x[k] = value;
            let (columns, values) = factors.upper.row(k);
            for (&column, u) in columns.iter().zip(values) {
                x[column] -= u * value;
            }
        }
        for k in (0..x.len()).rev() {
            let value = x[k];
            let (columns, values) = factors.lower.row(k);
            for (&column, l) in columns.iter().zip(values) {
                x[column] -= l * value;
            }
        }
        for (x, &row) in x.iter_mut().zip(&factors.order.rows) {
            b[row] = std::mem::take(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::linear::{Condition, DenseLu};
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    /// Fills both kinds of matrix with the same entries.
    fn fill(entries: &[(usize, usize, f64)], sparse: &mut SparseLu, dense: &mut DenseLu) {
        sparse.clear();
        dense.clear();
        for &(row, column, value) in entries {
            sparse.add(row, column, value);
            dense.add(row, column, value);
        }
    }

    proptest! {
        /// Compares with the dense factorisation. The second set of values is factorised in the
        /// order chosen for the first, or in another one if its pivots are too small.
        #[test]
        fn agrees_with_dense(
            order in 1_usize..20,
            places in prop::collection::vec((0_usize..20, 0_usize..20), 60),
            values in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 80),
            b in prop::collection::vec(-1.0..1.0_f64, 20),
        ) {
            // A diagonal, shifted by one, makes most of them regular.
            let shifted = (0..order).map(|k| (k, (k + 1) % order));
            let inside = places.into_iter().filter(|(r, c)| *r < order && *c < order);
            let mut places: Vec<_> = shifted.chain(inside).collect();
            places.sort_unstable();
            places.dedup();
            let mut pattern = vec![Vec::new(); order];
            places.iter().for_each(|&(row, column)| pattern[row].push(column));
            let (mut sparse, mut dense) = (SparseLu::new(pattern), DenseLu::new(order, 0));
            for second in [false, true] {
                let entries: Vec<_> = places
                    .iter()
                    .zip(values.iter().cycle())
                    .map(|(&(r, c), v)| (r, c, if second { v.1 } else { v.0 }))
                    .collect();
                fill(&entries, &mut sparse, &mut dense);
                let regular = dense.factorise(0.0).is_ok();
                prop_assume!(regular);
                let mut condition = Condition::new(order);
                let rcond = condition.rcond(&mut dense);
                prop_assume!(rcond > 1e-6);
                sparse.factorise(0.0).unwrap();
                // Both solves are backward stable. The sparse one admits pivots of a thousandth
                // of their row, so that entries may grow by 1e3 at some of the pivots.
                let tolerance = 1e5 * f64::EPSILON / rcond;
                for transposed in [false, true] {
                    let (mut x, mut y) = (b[..order].to_vec(), b[..order].to_vec());
                    if transposed {
                        sparse.solve_transposed(&mut x);
                        dense.solve_transposed(&mut y);
                    } else {
                        sparse.solve(&mut x);
                        dense.solve(&mut y);
                    }
                    let size = y.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
                    for (x, y) in x.iter().zip(&y) {
                        prop_assert!((x - y).abs() <= tolerance * size, "{x} {y} {rcond:e}");
                    }
                }
                // An estimate of the condition is never below the true value.
                let mut matrix = DMatrix::zeros(order, order);
                entries.iter().for_each(|&(row, column, value)| matrix[(row, column)] = value);
                let norm = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
                let inverse = matrix.clone().try_inverse().expect("it is regular");
                let truth = 1.0 / (norm(&matrix) * norm(&inverse));
                prop_assert!(condition.rcond(&mut sparse) >= truth * (1.0 - 1e-6));
            }
        }
    }

    /// The diagonal vanishes, then all entries: vanished pivots are replaced while others remain.
    #[test]
    fn a_vanishing_pivot_is_chosen_again() {
        let mut lu = SparseLu::new(vec![vec![0, 1], vec![0, 1]]);
        for (e, f) in [(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)] {
            lu.clear();
            for (row, column, value) in [(0, 0, e), (0, 1, f), (1, 0, f), (1, 1, e)] {
                lu.add(row, column, value);
            }
            let expected = if e + f == 0.0 { Err(Singular) } else { Ok(()) };
            assert_eq!(lu.factorise(0.0), expected);
            if expected.is_ok() {
                let mut x = [2.0, 3.0];
                lu.solve(&mut x);
                let [first, second] = if e > f { [2, 3] } else { [3, 2] };
                assert_eq!(x.map(|x| x as i32), [first, second]);
            }
        }
    }
}
