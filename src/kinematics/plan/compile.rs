//! Compiles the plan from the equations and their structure.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::coupled::{CoupledBlock, column_owners};
use super::elimination::EliminationOrder;
use super::explicit::ExplicitUnknown;
use super::pinned::{self, PinnedBody};
use super::revolute::Revolute;
use super::revolute_graph::RevoluteGraph;
use super::rrp_dyad::{self, RrpDyad, SecondParts};
use super::rrr_dyad::{self, RrrDyad, SideParts};
use super::{BlockPlan, BlockSolver};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::{Axis, Relation};
use crate::kinematics::system::structure::{Block, Structure};
use crate::kinematics::system::{EquationTarget, System};
use crate::mechanism::{MarkerId, Mechanism};

/// Blocks of the structure that one block solver takes together.
struct Group {
    /// Ascending.
    blocks: Vec<usize>,
    recipe: Recipe,
}

/// The block solver of a group, and its parts.
enum Recipe {
    PinnedBody(pinned::Parts),
    RrrDyad(rrr_dyad::Parts),
    RrpDyad(rrp_dyad::Parts),
    ExplicitUnknown { row: usize, column: usize },
    CoupledBlock,
}

/// The search for groups of blocks that a special solver knows.
struct Search<'a> {
    system: &'a System,
    structure: &'a Structure,
    mechanism: &'a Mechanism,
    /// The revolute that each row is part of.
    revolutes: Vec<Option<Revolute>>,
    /// The group that has taken each block.
    group_of: Vec<Option<usize>>,
    groups: Vec<Group>,
}

impl BlockPlan {
    /// Compiles the plan. Each block of the structure that a special solver knows, alone or with
    /// others of the same bodies, goes to it; the rest is left to [`CoupledBlock`].
    pub(in crate::kinematics) fn new(system: &System, structure: &Structure) -> Self {
        let mut search = Search {
            system,
            structure,
            mechanism: system.mechanism(),
            revolutes: revolutes(system),
            group_of: vec![None; structure.blocks().len()],
            groups: Vec::new(),
        };
        search.find();
        let (order, reads) = search.order();
        Self {
            blocks: search.solvers(&order),
            reads,
            pivots: Pivots::new(system.mechanism().bodies.len()),
            has_pivots: false,
        }
    }
}

/// Tells for each group whether it is part of a knot: a group that reads it, directly or through
/// others, is one that it reads.
fn knots(reads: &[Vec<usize>]) -> Vec<bool> {
    let mut graph = DiGraph::<(), (), usize>::with_capacity(reads.len(), reads.len());
    for _ in reads {
        graph.add_node(());
    }
    for (group, reads) in reads.iter().enumerate() {
        for &read in reads {
            graph.add_edge(NodeIndex::new(group), NodeIndex::new(read), ());
        }
    }
    let mut knots = vec![false; reads.len()];
    for component in kosaraju_scc(&graph) {
        for group in component.iter().filter(|_| component.len() > 1) {
            knots[group.index()] = true;
        }
    }
    knots
}

/// Pairs the rows that hold two points together.
fn revolutes(system: &System) -> Vec<Option<Revolute>> {
    let equations = system.equations();
    let point = |row: usize| {
        let equation = equations.get(row)?;
        let at_zero = matches!(&equation.target, EquationTarget::Constant(value) if value.literal() == Some(0.0));
        match Relation::of(&*equation.constraint) {
            Relation::Coincidence(c) if at_zero => Some(c),
            _ => None,
        }
    };
    let mut revolutes = vec![None; equations.len()];
    for row in 0..equations.len() {
        if let (Some(x), Some(y)) = (point(row), point(row + 1))
            && (x.axis, y.axis) == (Axis::X, Axis::Y)
            && (x.from, x.to) == (y.from, y.to)
        {
            let revolute = Revolute {
                rows: [row, row + 1],
                from: x.from,
                to: x.to,
            };
            revolutes[row] = Some(revolute);
            revolutes[row + 1] = Some(revolute);
        }
    }
    revolutes
}

impl Search<'_> {
    /// Groups blocks for the special solvers, then leaves each other block to itself.
    fn find(&mut self) {
        for block in 0..self.structure.blocks().len() {
            if self.group_of[block].is_some() {
                continue;
            }
            let bodies = self.turning(block);
            let group = match bodies[..] {
                [body] => self.pinned(body).or_else(|| self.rrp_dyad_in(block, body)),
                [a, b] => self
                    .rrr_dyad(a, b)
                    .or_else(|| self.rrp_dyad(a, Some(b)))
                    .or_else(|| self.rrp_dyad(b, Some(a))),
                _ => None,
            };
            if let Some(group) = group {
                for &block in &group.blocks {
                    self.group_of[block] = Some(self.groups.len());
                }
                self.groups.push(group);
            }
        }
        self.leave_rest();
    }

    fn leave_rest(&mut self) {
        for block in 0..self.group_of.len() {
            if self.group_of[block].is_none() {
                self.group_of[block] = Some(self.groups.len());
                let Block { rows, columns, .. } = &self.structure.blocks()[block];
                let is_linear = |row: usize| {
                    let constraint = &self.system.equations()[row].constraint;
                    constraint.is_linear(self.mechanism)
                };
                let recipe = match (&rows[..], &columns[..]) {
                    (&[row], &[column]) if is_linear(row) => {
                        Recipe::ExplicitUnknown { row, column }
                    }
                    _ => Recipe::CoupledBlock,
                };
                self.groups.push(Group {
                    blocks: vec![block],
                    recipe,
                });
            }
        }
    }

    /// Returns the bodies whose angles a block determines.
    fn turning(&self, block: usize) -> Vec<usize> {
        let bodies = self.mechanism.bodies.len();
        let columns = self.structure.blocks()[block].columns.iter();
        let angles = columns.filter(|&&column| column % 3 == 2 && column < 3 * bodies);
        angles.map(|column| column / 3).collect()
    }

    /// Returns the blocks that determine these bodies and nothing else, and their rows.
    fn determining(&self, bodies: &[usize]) -> Option<(Vec<usize>, Vec<usize>)> {
        let columns = || {
            bodies
                .iter()
                .flat_map(|body| (0..3).map(move |k| 3 * body + k))
        };
        let mut blocks: Vec<_> = columns()
            .map(|column| self.structure.block_of(column))
            .collect();
        blocks.sort_unstable();
        blocks.dedup();
        let own = blocks.iter().all(|&block| {
            let columns = &self.structure.blocks()[block].columns;
            self.group_of[block].is_none()
                && columns.iter().all(|column| bodies.contains(&(column / 3)))
        });
        let rows = |block: &usize| self.structure.blocks()[*block].rows.clone();
        own.then(|| {
            let mut rows: Vec<_> = blocks.iter().flat_map(rows).collect();
            rows.sort_unstable();
            (blocks, rows)
        })
    }

    fn body_of(&self, marker: MarkerId) -> Option<usize> {
        let body = self.mechanism.markers[marker.index()].body;
        body.map(|body| body.index())
    }

    /// Recognises a body with a revolute to a point found before, its angle held or driven.
    fn pinned(&self, body: usize) -> Option<Group> {
        let (blocks, rows) = self.determining(&[body])?;
        let [first, second, third] = rows[..] else {
            return None;
        };
        let (revolute, angle) = match (self.revolutes[first], self.revolutes[second]) {
            (Some(revolute), _) if revolute.rows == [first, second] => (revolute, third),
            (_, Some(revolute)) if revolute.rows == [second, third] => (revolute, first),
            _ => return None,
        };
        let Relation::Angle(measured) = Relation::of(&*self.system.equations()[angle].constraint)
        else {
            return None;
        };
        let mine = |marker| self.body_of(marker) == Some(body);
        let (pin, anchor) = self.own_first(revolute, body)?;
        let (angle_marker, reference, sense) = match (mine(measured.from), mine(measured.to)) {
            (false, true) => (measured.to, measured.from, 1.0),
            (true, false) => (measured.from, measured.to, -1.0),
            _ => return None,
        };
        Some(Group {
            blocks,
            recipe: Recipe::PinnedBody(pinned::Parts {
                rows: [revolute.rows[0], revolute.rows[1], angle],
                body,
                pin,
                anchor,
                angle: angle_marker,
                reference,
                sense,
                pin_sense: revolute.sense_to(pin),
            }),
        })
    }

    /// Returns the marker of a revolute on `body`, then the other one, which is on another body.
    fn own_first(&self, revolute: Revolute, body: usize) -> Option<(MarkerId, MarkerId)> {
        let mine = |marker| self.body_of(marker) == Some(body);
        match (mine(revolute.from), mine(revolute.to)) {
            (true, false) => Some((revolute.from, revolute.to)),
            (false, true) => Some((revolute.to, revolute.from)),
            _ => None,
        }
    }

    /// Recognises two bodies with a revolute between them and one each to points found before.
    fn rrr_dyad(&self, a: usize, b: usize) -> Option<Group> {
        let (blocks, rows) = self.determining(&[a, b])?;
        let mut revolutes = Vec::with_capacity(3);
        for pair in rows.chunks(2) {
            let revolute = self.revolutes[pair[0]]?;
            if revolute.rows[..] != *pair {
                return None;
            }
            revolutes.push(revolute);
        }
        let bodies = |revolute: &Revolute| [revolute.from, revolute.to].map(|m| self.body_of(m));
        let joins = |revolute: &&Revolute, x: usize| bodies(revolute).contains(&Some(x));
        let inner = revolutes.iter().find(|r| joins(r, a) && joins(r, b))?;
        let (inner_a, inner_b) = self.own_first(*inner, a)?;
        let side = |body: usize, other: usize, inner: MarkerId| {
            let outer = revolutes
                .iter()
                .find(|r| joins(r, body) && !joins(r, other))?;
            let (own, anchor) = self.own_first(*outer, body)?;
            Some((
                *outer,
                SideParts {
                    body,
                    outer: own,
                    anchor,
                    inner,
                },
            ))
        };
        let (outer_a, side_a) = side(a, b, inner_a)?;
        let (outer_b, side_b) = side(b, a, inner_b)?;
        let senses = [
            outer_a.sense_to(side_a.outer),
            outer_b.sense_to(side_b.outer),
            inner.sense_to(inner_a),
        ];
        let [r0, r1] = outer_a.rows;
        let [r2, r3] = outer_b.rows;
        let [r4, r5] = inner.rows;
        Some(Group {
            blocks,
            recipe: Recipe::RrrDyad(rrr_dyad::Parts {
                rows: [r0, r1, r2, r3, r4, r5],
                columns: [3 * a, 3 * a + 1, 3 * a + 2, 3 * b, 3 * b + 1, 3 * b + 2],
                sides: [side_a, side_b],
                senses,
            }),
        })
    }

    /// Recognises an RRP dyad whose unknown is the angle of body `a`: with a body that shares a row
    /// of the block with it, or alone.
    fn rrp_dyad_in(&self, block: usize, a: usize) -> Option<Group> {
        let rows = &self.structure.blocks()[block].rows;
        let met = rows.iter().flat_map(|&row| {
            let markers = match Relation::of(&*self.system.equations()[row].constraint) {
                Relation::Coincidence(c) => [Some(c.from), Some(c.to), None],
                Relation::Projection(p) => [Some(p.from), Some(p.to), Some(p.axes)],
                Relation::Angle(_) | Relation::Distance(_) | Relation::Other => [None; 3],
            };
            markers.into_iter().flatten()
        });
        met.filter_map(|marker| self.body_of(marker))
            .filter(|&b| b != a)
            .find_map(|b| self.rrp_dyad(a, Some(b)))
            .or_else(|| self.rrp_dyad(a, None))
    }

    /// Recognises body `a` with a revolute to a point found before and a point on a line, and `b`,
    /// if any, that slides along with it.
    fn rrp_dyad(&self, a: usize, b: Option<usize>) -> Option<Group> {
        let bodies: Vec<_> = std::iter::once(a).chain(b).collect();
        let (blocks, rows) = self.determining(&bodies)?;
        let mut revolutes: Vec<Revolute> = Vec::new();
        let (mut angle, mut projection) = (None, None);
        for &row in &rows {
            match (
                self.revolutes[row],
                Relation::of(&*self.system.equations()[row].constraint),
            ) {
                (Some(revolute), _)
                    if rows.contains(&revolute.rows[1]) && revolute.rows[0] == row =>
                {
                    revolutes.push(revolute);
                }
                (Some(revolute), _) => {
                    revolutes.last().filter(|r| r.rows == revolute.rows)?;
                }
                (None, Relation::Angle(measured)) if angle.is_none() => {
                    angle = Some((row, measured));
                }
                (None, Relation::Projection(measured)) if projection.is_none() => {
                    projection = Some((row, measured));
                }
                _ => return None,
            }
        }
        if revolutes.len() != bodies.len() || angle.is_some() != b.is_some() {
            return None;
        }
        let own = |marker| self.body_of(marker).filter(|body| bodies.contains(body));
        let outer = revolutes.iter().find(|r| {
            let ends = [own(r.from), own(r.to)];
            ends == [Some(a), None] || ends == [None, Some(a)]
        })?;
        let (pin, anchor) = self.own_first(*outer, a)?;
        let second = match b {
            None => None,
            Some(b) => {
                let other = revolutes.iter().find(|r| r.rows != outer.rows)?;
                let (pin, partner) = self.own_first(*other, b)?;
                let (row, measured) = angle?;
                let (marker, reference, sense) = match (own(measured.from), own(measured.to)) {
                    (from, Some(to)) if to == b && from != Some(b) => {
                        (measured.to, measured.from, 1.0)
                    }
                    (Some(from), to) if from == b && to != Some(b) => {
                        (measured.from, measured.to, -1.0)
                    }
                    _ => return None,
                };
                let carried = own(partner) == Some(a);
                let held = matches!(
                    self.system.equations()[row].target,
                    EquationTarget::Constant(_)
                );
                let fits = if carried {
                    own(reference).is_none()
                } else {
                    own(partner).is_none() && own(reference) == Some(a) && held
                };
                if !fits {
                    return None;
                }
                Some(SecondParts {
                    body: b,
                    carried,
                    pin,
                    partner,
                    revolute: *other,
                    row,
                    angle: marker,
                    reference,
                    sense,
                })
            }
        };
        let (row, projection) = projection?;
        Some(Group {
            recipe: Recipe::RrpDyad(rrp_dyad::Parts {
                columns: bodies
                    .iter()
                    .flat_map(|body| (0..3).map(move |k| 3 * body + k))
                    .collect(),
                rows,
                body: a,
                pin,
                anchor,
                outer: *outer,
                second,
                row,
                projection,
                part: self.system.equations()[row].part(),
            }),
            blocks,
        })
    }

    /// Returns an order of the groups in which each comes after those it reads, close to the order
    /// of the blocks, and the places in it of the groups that each one reads. Where grouping has tied
    /// a knot, two groups that read parts of each other, such groups are taken apart again.
    fn order(&mut self) -> (Vec<usize>, Vec<Vec<usize>>) {
        loop {
            let reads = self.reads();
            let knots = knots(&reads);
            if knots.iter().all(|knot| !knot) {
                let order = self.sorted(&reads);
                let mut place_of = vec![0; order.len()];
                for (place, &group) in order.iter().enumerate() {
                    place_of[group] = place;
                }
                let places =
                    |group: &usize| reads[*group].iter().map(|&read| place_of[read]).collect();
                let reads = order.iter().map(places).collect();
                return (order, reads);
            }
            let groups = std::mem::take(&mut self.groups).into_iter().zip(knots);
            self.groups = groups
                .filter_map(|(group, knot)| (!knot).then_some(group))
                .collect();
            self.group_of.fill(None);
            for (index, group) in self.groups.iter().enumerate() {
                for &block in &group.blocks {
                    self.group_of[block] = Some(index);
                }
            }
            self.leave_rest();
        }
    }

    /// Returns the groups that each group reads.
    fn reads(&self) -> Vec<Vec<usize>> {
        let groups = self.groups.iter().enumerate();
        groups
            .map(|(index, group)| {
                let blocks = group.blocks.iter();
                let reads = blocks.flat_map(|&block| &self.structure.blocks()[block].reads);
                let groups = reads.filter_map(|&block| self.group_of[block]);
                let others: BTreeSet<_> = groups.filter(|&read| read != index).collect();
                others.into_iter().collect()
            })
            .collect()
    }

    fn sorted(&self, reads: &[Vec<usize>]) -> Vec<usize> {
        let mut waits_for: Vec<_> = reads.iter().map(Vec::len).collect();
        let mut read_by = vec![Vec::new(); reads.len()];
        for (index, reads) in reads.iter().enumerate() {
            for &read in reads {
                read_by[read].push(index);
            }
        }
        let last = |group: usize| self.groups[group].blocks.last().copied();
        let free = (0..reads.len()).filter(|&group| waits_for[group] == 0);
        let mut ready: BinaryHeap<_> = free.map(|group| Reverse((last(group), group))).collect();
        let mut order = Vec::with_capacity(reads.len());
        while let Some(Reverse((_, group))) = ready.pop() {
            order.push(group);
            for &reader in &read_by[group] {
                waits_for[reader] -= 1;
                if waits_for[reader] == 0 {
                    ready.push(Reverse((last(reader), reader)));
                }
            }
        }
        order
    }

    /// Makes the block solvers in this order of their groups.
    fn solvers(self, order: &[usize]) -> Vec<BlockSolver> {
        let mut groups: Vec<_> = self.groups.into_iter().map(Some).collect();
        let groups = order.iter().filter_map(|&group| groups[group].take());
        // The orders of elimination of coupled blocks, by index in the plan.
        let mut orders = Vec::new();
        let mut recipes = Vec::with_capacity(order.len());
        // The ways between the anchors of dyads, over revolutes of earlier groups.
        let mut graph = RevoluteGraph::new(self.mechanism);
        let mut is_found = vec![false; self.system.equations().len()];
        let mut spread_is_read = vec![false; order.len()];
        // The groups in whose second bodies later ones of this kind have points.
        let mut slide_is_read = vec![false; order.len()];
        let mut slides_in = vec![None; self.mechanism.bodies.len()];
        let mut paths = Vec::new();
        for (index, group) in groups.enumerate() {
            match &group.recipe {
                Recipe::CoupledBlock => {
                    let block = &self.structure.blocks()[group.blocks[0]];
                    orders.push((index, EliminationOrder::new(self.system, block)));
                }
                Recipe::RrrDyad(parts) => {
                    let [a, b] = &parts.sides;
                    paths.push(graph.path([a.anchor, b.anchor], &mut spread_is_read));
                    graph.add_dyad(index, [a.body, b.body]);
                }
                Recipe::RrpDyad(parts) => {
                    let (i, j) = (parts.projection.from, parts.projection.to);
                    for marker in [parts.anchor, i, j] {
                        let body = self.mechanism.markers[marker.index()].body;
                        if let Some(group) = body.and_then(|body| slides_in[body.index()]) {
                            slide_is_read[group] = true;
                        }
                    }
                    if let Some(second) = &parts.second {
                        slides_in[second.body] = Some(index);
                    }
                }
                Recipe::PinnedBody(_) | Recipe::ExplicitUnknown { .. } => {}
            }
            let blocks = group.blocks.iter();
            for &row in blocks.flat_map(|&block| &self.structure.blocks()[block].rows) {
                is_found[row] = true;
                if let Some(Revolute { rows, from, to }) = self.revolutes[row]
                    && rows.iter().all(|&row| is_found[row])
                {
                    graph.add(from, to);
                }
            }
            recipes.push(group.recipe);
        }
        let mut paths = paths.into_iter();
        let owners = column_owners(
            self.system,
            orders.iter().map(|(index, order)| (*index, order)),
        );
        let mut coupled = orders.into_iter().map(|(index, order)| {
            BlockSolver::CoupledBlock(Box::new(CoupledBlock::new(
                index,
                order,
                self.system,
                &owners,
            )))
        });
        let is_read = spread_is_read.into_iter().zip(slide_is_read);
        let recipes = recipes.into_iter().zip(is_read);
        let solvers = recipes.map(|(recipe, (spread_is_read, slide_is_read))| match recipe {
            Recipe::PinnedBody(parts) => {
                BlockSolver::PinnedBody(Box::new(PinnedBody::new(self.mechanism, parts)))
            }
            Recipe::RrrDyad(parts) => {
                let path = paths.next().expect("each dyad has its path");
                let dyad = RrrDyad::new(self.mechanism, parts, path, spread_is_read);
                BlockSolver::RrrDyad(dyad)
            }
            Recipe::RrpDyad(parts) => {
                BlockSolver::RrpDyad(Box::new(RrpDyad::new(self.mechanism, parts, slide_is_read)))
            }
            Recipe::ExplicitUnknown { row, column } => {
                BlockSolver::ExplicitUnknown(ExplicitUnknown::new(self.system, row, column))
            }
            Recipe::CoupledBlock => coupled.next().expect("each coupled group has its order"),
        });
        solvers.collect()
    }
}
