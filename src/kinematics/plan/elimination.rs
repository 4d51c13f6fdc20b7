//! The order in which the rows and unknowns of a block are eliminated.
//!
//! Two rows hold two points together: x_j + (A_j s_j)_x = x_i + (A_i s_i)_x, and the same in y.
//! Over all pairs that share unknowns these rows make a graph of the bodies; along each of its
//! trees they eliminate x and y with pivots of ±1, whatever the pose, and leave the angles.

use crate::kinematics::constraint::{Axis, Relation};
use crate::kinematics::linear::{DenseLu, Lu, SparseLu};
use crate::kinematics::system::System;
use crate::kinematics::system::structure::Block;
use crate::mechanism::MarkerId;

/// Most torn unknowns for which a dense matrix is quicker than a sparse one.
const DENSE: usize = 4;

/// Rows and unknowns of a block in the order of elimination.
pub(super) struct EliminationOrder {
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    /// Number of leading pivots that are ±1.
    fixed: usize,
}

impl EliminationOrder {
    pub(super) fn new(system: &System, block: &Block) -> Self {
        let mut order = Self {
            rows: Vec::with_capacity(block.rows.len()),
            columns: Vec::with_capacity(block.rows.len()),
            fixed: 0,
        };
        for axis in [Axis::X, Axis::Y] {
            order.along(system, block, axis);
        }
        order.fixed = order.rows.len();
        let rest = |all: &[usize], taken: &[usize]| {
            let mut taken = taken.to_vec();
            taken.sort_unstable();
            let free = |index: &usize| taken.binary_search(index).is_err();
            all.iter().copied().filter(free).collect::<Vec<_>>()
        };
        let (rows, columns) = (
            rest(&block.rows, &order.rows),
            rest(&block.columns, &order.columns),
        );
        order.rows.extend(rows);
        order.columns.extend(columns);
        order
    }

    /// Eliminates the x or y of bodies along a forest of the rows in that direction: leaves
    /// first, so that a row of the forest meets only unknowns that come later.
    fn along(&mut self, system: &System, block: &Block, axis: Axis) {
        let mechanism = system.mechanism();
        let component = usize::from(axis == Axis::Y);
        let mut columns: Vec<usize> = block.columns.clone();
        columns.sort_unstable();
        // Nodes are the block's unknowns in this direction; the last node is all that is known.
        let bodies = 3 * mechanism.bodies.len();
        columns.retain(|column| *column < bodies && column % 3 == component);
        let known = columns.len();
        let node = |marker: MarkerId| {
            let body = mechanism.markers[marker.index()].body;
            body.and_then(|body| columns.binary_search(&(3 * body.index() + component)).ok())
                .unwrap_or(known)
        };
        let mut edges: Vec<Vec<(usize, usize)>> = vec![Vec::new(); known + 1];
        for &row in &block.rows {
            if let Relation::Coincidence(c) = Relation::of(&*system.equations()[row].constraint)
                && c.axis == axis
            {
                let (from, to) = (node(c.from), node(c.to));
                if from != to {
                    edges[from].push((to, row));
                    edges[to].push((from, row));
                }
            }
        }
        // Breadth first from the known node, then from each body that this does not reach.
        let mut reached = vec![false; known + 1];
        let mut forest = Vec::new();
        for root in std::iter::once(known).chain(0..known) {
            if std::mem::replace(&mut reached[root], true) {
                continue;
            }
            let mut queue = std::collections::VecDeque::from([root]);
            while let Some(from) = queue.pop_front() {
                for &(to, row) in &edges[from] {
                    if !std::mem::replace(&mut reached[to], true) {
                        forest.push((row, columns[to]));
                        queue.push_back(to);
                    }
                }
            }
        }
        for (row, column) in forest.into_iter().rev() {
            self.rows.push(row);
            self.columns.push(column);
        }
    }

    /// Returns the number of torn unknowns: those left once the pivots of ±1 are eliminated.
    pub(super) fn torn(&self) -> usize {
        self.rows.len() - self.fixed
    }

    /// Makes an empty matrix for rows and columns in this order.
    pub(super) fn matrix(&self, system: &System) -> Lu {
        if self.torn() <= DENSE {
            return Lu::Dense(DenseLu::new(self.rows.len(), self.fixed));
        }
        let mut places: Vec<_> = (0..self.columns.len()).collect();
        places.sort_unstable_by_key(|&place| self.columns[place]);
        let place = |column: &usize| {
            let found = places.binary_search_by_key(column, |&place| self.columns[place]);
            found.ok().map(|index| places[index])
        };
        let pattern = self.rows.iter().map(|&row| {
            let unknowns = system.incidence(row).unknowns;
            let mut entries: Vec<_> = unknowns.iter().filter_map(place).collect();
            entries.sort_unstable();
            entries
        });
        Lu::Sparse(Box::new(SparseLu::new(pattern.collect())))
    }
}
