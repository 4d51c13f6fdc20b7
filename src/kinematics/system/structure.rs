//! The structure of the equations: the blocks in the order of solution, found without numbers.
//!
//! A maximum matching pairs equations with unknowns. If all are matched, the strongly connected
//! components of the paired graph are the blocks that must be solved together, in block lower
//! triangular order (Dulmage–Mendelsohn). If some stay unmatched, numbers decide which rows are
//! redundant and which unknowns are free to move: see `redundancy`.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, OnceLock};

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::{EquationTarget, System};
use crate::kinematics::constraint;
use crate::kinematics::constraint::Incidence;
use crate::mechanism::{
    Coordinate, DriverId, Expression, MarkerId, Mechanism, ParameterId, PrescribedMotion,
};

/// The block lower triangular structure of a system.
#[derive(Clone, Debug)]
pub struct Structure {
    mechanism: Arc<Mechanism>,
    blocks: Vec<Block>,
    /// Block of each unknown.
    block_of: Vec<usize>,
    parameters_of_play: Vec<ParameterId>,
    /// Dependencies of each block's unknowns, through it and the blocks before it; computed on
    /// demand, as only an export needs them and in a chain they grow with every link.
    dependencies: OnceLock<Vec<Dependencies>>,
}

/// Equations and unknowns that have to be solved together.
#[derive(Clone, Debug)]
pub struct Block {
    /// Rows of Phi, as many as unknowns.
    pub rows: Vec<usize>,
    /// Indices in q, `rows[k]` matched with `columns[k]`.
    pub columns: Vec<usize>,
    /// The blocks before it whose unknowns its rows contain, ascending.
    pub reads: Vec<usize>,
    /// The drivers in its rows.
    drivers: Vec<DriverId>,
    /// The parameters in its rows, as the expressions name them.
    parameters: Vec<ParameterId>,
}

/// The drivers and parameters that a quantity depends on, structurally exact.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dependencies {
    /// Drivers, both inputs and prescribed motions.
    pub drivers: BTreeSet<DriverId>,
    /// Parameters that can be set; a derived one counts as those that it is derived from.
    pub parameters: BTreeSet<ParameterId>,
}

impl Dependencies {
    /// Adds the dependencies of another quantity.
    pub fn extend(&mut self, other: &Self) {
        self.drivers.extend(&other.drivers);
        self.parameters.extend(&other.parameters);
    }

    /// Adds the parameters of an expression of the mechanism.
    pub fn add_expression(&mut self, mechanism: &Mechanism, expression: &Expression) {
        for parameter in expression.parameters() {
            self.add_parameter(mechanism, parameter);
        }
    }

    /// Adds the parameters of a prescribed motion.
    pub fn add_motion(&mut self, mechanism: &Mechanism, motion: &PrescribedMotion) {
        for parameter in motion.parameters() {
            self.add_parameter(mechanism, parameter);
        }
    }

    /// Adds a parameter, or the parameters that it is derived from.
    pub fn add_parameter(&mut self, mechanism: &Mechanism, parameter: ParameterId) {
        let definition = &mechanism.parameters[parameter.index()];
        if definition.derived {
            // Derivations have no cycles; the reader refuses them.
            self.add_expression(mechanism, &definition.expression);
        } else {
            self.parameters.insert(parameter);
        }
    }
}

impl Structure {
    /// Analyses a system without the rows `set_aside`, which are ascending. Returns `None` unless
    /// rows and unknowns can be paired without a rest.
    ///
    /// Dependencies go through the rows that are left: parameters in the others decide whether the
    /// mechanism closes, not where it is.
    pub(in crate::kinematics) fn new(system: &System, set_aside: &[usize]) -> Option<Self> {
        let rows = 0..system.equations().len();
        let incidences: Vec<_> = rows.clone().map(|row| system.incidence(row)).collect();
        let kept = rows.filter(|row| set_aside.binary_search(row).is_err());
        let matching = Matching::new(&incidences, system.unknowns(), kept);
        if !matching.is_perfect() {
            return None;
        }
        let mut structure = Self::of_nothing(system);
        for rows in matching.components(&incidences) {
            let columns: Vec<_> = rows
                .iter()
                .map(|&row| matching.column_of[row].expect("only paired rows are in components"))
                .collect();
            for &column in &columns {
                structure.block_of[column] = structure.blocks.len();
            }
            let block = structure.block(system, &incidences, rows, columns);
            structure.blocks.push(block);
        }
        Some(structure)
    }

    /// Pairs as many of these rows as possible, earlier ones first. Returns the rows of the system
    /// that are then left, ascending; `None` if an unknown is left.
    pub(in crate::kinematics) fn left_over(
        system: &System,
        rows: impl Iterator<Item = usize>,
    ) -> Option<Vec<usize>> {
        let all = 0..system.equations().len();
        let incidences: Vec<_> = all.clone().map(|row| system.incidence(row)).collect();
        let matching = Matching::new(&incidences, system.unknowns(), rows);
        let complete = matching.row_of.iter().all(Option::is_some);
        let unpaired = all.filter(|&row| matching.column_of[row].is_none());
        complete.then(|| unpaired.collect())
    }

    /// Returns the structure of a system that is not analysed yet.
    pub(in crate::kinematics) fn of_nothing(system: &System) -> Self {
        Self {
            mechanism: Arc::clone(system.mechanism()),
            blocks: Vec::new(),
            block_of: vec![usize::MAX; system.unknowns()],
            parameters_of_play: system.parameters_of_play().collect(),
            dependencies: OnceLock::new(),
        }
    }

    /// Returns the parameters on which the forces in joints with play depend, besides those of markers.
    #[must_use]
    pub fn parameters_of_play(&self) -> &[ParameterId] {
        &self.parameters_of_play
    }

    /// Returns the blocks, each after those that it depends on.
    #[must_use]
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Returns the dependencies of the unknown q\[column\].
    #[must_use]
    pub fn dependencies(&self, column: usize) -> &Dependencies {
        &self.all_dependencies()[self.block_of[column]]
    }

    /// Returns the block of the unknown q\[column\].
    #[must_use]
    pub fn block_of(&self, column: usize) -> usize {
        self.block_of[column]
    }

    /// Returns the dependencies of a coordinate.
    #[must_use]
    pub fn coordinate_dependencies(
        &self,
        mechanism: &Mechanism,
        coordinate: &Coordinate,
    ) -> Dependencies {
        let mut incidence = Incidence::default();
        constraint::of_coordinate(coordinate).incidence(mechanism, &mut incidence);
        self.through(mechanism, &incidence)
    }

    /// Returns the dependencies of the global x (component 0) or y (1) of a marker.
    #[must_use]
    pub fn point_dependencies(
        &self,
        mechanism: &Mechanism,
        marker: MarkerId,
        component: usize,
    ) -> Dependencies {
        let mut incidence = Incidence::default();
        incidence.point(mechanism, marker, [component == 0, component == 1]);
        self.through(mechanism, &incidence)
    }

    /// Returns the dependencies of a function of these unknowns and parameters.
    fn through(&self, mechanism: &Mechanism, incidence: &Incidence) -> Dependencies {
        let mut dependencies = Dependencies::default();
        for &parameter in &incidence.parameters {
            dependencies.add_parameter(mechanism, parameter);
        }
        for &unknown in &incidence.unknowns {
            dependencies.extend(self.dependencies(unknown));
        }
        dependencies
    }

    /// Makes the block of these rows and columns; those before it are known.
    fn block(
        &self,
        system: &System,
        incidences: &[Incidence],
        rows: Vec<usize>,
        columns: Vec<usize>,
    ) -> Block {
        let mechanism = system.mechanism();
        let mut block = Block {
            rows,
            columns,
            reads: Vec::new(),
            drivers: Vec::new(),
            parameters: Vec::new(),
        };
        for &row in &block.rows {
            match &system.equations()[row].target {
                EquationTarget::Constant(expression) => {
                    block.parameters.extend(expression.parameters())
                }
                EquationTarget::Driver(driver) => {
                    block.drivers.push(*driver);
                    if let Some(motion) = mechanism.drivers[driver.index()].motion() {
                        block.parameters.extend(motion.parameters());
                    }
                }
            }
            block.parameters.extend(&incidences[row].parameters);
            let equation = &system.equations()[row];
            block.parameters.extend(&equation.parameters);
            let unknowns = &incidences[row].unknowns;
            let owners = unknowns.iter().map(|&unknown| self.block_of[unknown]);
            block
                .reads
                .extend(owners.filter(|&owner| owner != self.blocks.len()));
        }
        block.reads.sort_unstable();
        block.reads.dedup();
        block
    }

    fn all_dependencies(&self) -> &[Dependencies] {
        self.dependencies.get_or_init(|| {
            let mut all: Vec<Dependencies> = Vec::with_capacity(self.blocks.len());
            for block in &self.blocks {
                let mut dependencies = Dependencies::default();
                dependencies.drivers.extend(&block.drivers);
                for &parameter in &block.parameters {
                    dependencies.add_parameter(&self.mechanism, parameter);
                }
                for &before in &block.reads {
                    dependencies.extend(&all[before]);
                }
                all.push(dependencies);
            }
            all
        })
    }
}

/// A maximum matching of equations with unknowns.
struct Matching {
    column_of: Vec<Option<usize>>,
    row_of: Vec<Option<usize>>,
    /// Whether each row has an unknown.
    pairs_all_rows: bool,
}

impl Matching {
    /// Matches row by row along alternating paths, breadth first.
    fn new(incidences: &[Incidence], unknowns: usize, rows: impl Iterator<Item = usize>) -> Self {
        let mut matching = Self {
            column_of: vec![None; incidences.len()],
            row_of: vec![None; unknowns],
            pairs_all_rows: true,
        };
        let mut reached_from = vec![None; unknowns];
        for row in rows {
            // Most rows contain a free unknown.
            let free = incidences[row]
                .unknowns
                .iter()
                .copied()
                .find(|&column| matching.row_of[column].is_none());
            if let Some(column) = free {
                matching.pair(row, column);
            } else {
                matching.augment(incidences, row, &mut reached_from);
            }
            matching.pairs_all_rows &= matching.column_of[row].is_some();
        }
        matching
    }

    fn pair(&mut self, row: usize, column: usize) {
        self.column_of[row] = Some(column);
        self.row_of[column] = Some(row);
    }

    fn augment(
        &mut self,
        incidences: &[Incidence],
        start: usize,
        reached_from: &mut [Option<usize>],
    ) {
        let mut queue = VecDeque::from([start]);
        let mut reached = Vec::new();
        let mut end = None;
        'search: while let Some(row) = queue.pop_front() {
            for &column in &incidences[row].unknowns {
                if reached_from[column].is_some() {
                    continue;
                }
                reached_from[column] = Some(row);
                reached.push(column);
                match self.row_of[column] {
                    Some(next) => queue.push_back(next),
                    None => {
                        end = Some(column);
                        break 'search;
                    }
                }
            }
        }
        while let Some(column) = end {
            let row = reached_from[column].expect("the path was walked forward");
            let previous = self.column_of[row];
            self.pair(row, column);
            end = if row == start { None } else { previous };
        }
        for column in reached {
            reached_from[column] = None;
        }
    }

    fn is_perfect(&self) -> bool {
        self.pairs_all_rows && self.row_of.iter().all(Option::is_some)
    }

    /// Returns the strongly connected components of the paired rows, in an order in which each
    /// comes after those whose unknowns it uses.
    fn components(&self, incidences: &[Incidence]) -> Vec<Vec<usize>> {
        let mut graph =
            DiGraph::<(), (), usize>::with_capacity(incidences.len(), 3 * incidences.len());
        for _ in incidences {
            graph.add_node(());
        }
        let paired = |row: usize| self.column_of[row].is_some();
        for (row, incidence) in incidences
            .iter()
            .enumerate()
            .filter(|(row, _)| paired(*row))
        {
            for &column in &incidence.unknowns {
                let owner = self.row_of[column].expect("the matching is perfect");
                if owner != row {
                    graph.add_edge(NodeIndex::new(row), NodeIndex::new(owner), ());
                }
            }
        }
        // Kosaraju's order has a component after all those that its edges lead to. Unlike
        // petgraph's Tarjan it does not recurse as deep as a chain is long.
        kosaraju_scc(&graph)
            .into_iter()
            .map(|component| {
                let mut rows: Vec<_> = component.into_iter().map(NodeIndex::index).collect();
                rows.sort_unstable();
                rows
            })
            .filter(|rows| paired(rows[0]))
            .collect()
    }
}
