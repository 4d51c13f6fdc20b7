//! The model of a mechanism: its equations, their structure, and the plan that solves them.

use std::sync::Arc;

use super::block::BlockPlan;
use super::configuration::Configuration;
use super::constraint::{Constraint, of_coordinate};
use super::structure::Structure;
use super::system::{System, Target, Targets};
use crate::mechanism::{DriverId, Mechanism};

/// The equations of a mechanism and the way in which they are solved.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) system: System,
    pub(super) structure: Structure,
    pub(super) plan: BlockPlan,
    pub(super) redundant: RedundantRows,
    pub(super) measures: Vec<Box<dyn Constraint>>,
}

/// The rows of Phi that are redundant, and those set aside instead of them.
#[derive(Clone, Debug, Default)]
pub(super) struct RedundantRows {
    /// Rows that follow from the others, of equals the ones declared last; ascending.
    pub(super) all: Vec<usize>,
    /// The rows set aside at the first pose, as many; ascending.
    pub(super) first: Vec<usize>,
    /// The rows set aside at present, as many; ascending.
    pub(super) now: Vec<usize>,
}

impl RedundantRows {
    /// Returns whether no row is set aside.
    pub(super) fn is_empty(&self) -> bool {
        self.now.is_empty()
    }

    /// Sets the rows of the first pose aside again. Returns whether others were.
    pub(super) fn return_to_first(&mut self) -> bool {
        let changes = self.now != self.first;
        if changes {
            self.now.clone_from(&self.first);
        }
        changes
    }
}

impl Model {
    /// Writes down the equations and analyses their structure. Also returns whether equations and
    /// unknowns pair up; otherwise the plan is empty.
    pub(super) fn new(mechanism: Arc<Mechanism>) -> (Self, bool) {
        let measures = mechanism.measures.iter();
        let measures = measures.map(|measure| of_coordinate(&measure.coordinate));
        let measures = measures.collect();
        let system = System::new(mechanism);
        let structure = Structure::new(&system, &[]);
        let pairs_up = structure.is_some();
        let structure = structure.unwrap_or_else(|| Structure::of_nothing(&system));
        let model = Self {
            plan: BlockPlan::new(&system, &structure),
            structure,
            redundant: RedundantRows::default(),
            measures,
            system,
        };
        (model, pairs_up)
    }

    /// Compiles structure and plan for all rows but those set aside.
    pub(super) fn compile(&mut self, at: &Configuration, targets: &Targets) {
        let structure = Structure::new(&self.system, &self.redundant.now);
        self.structure = structure.expect("independent rows can be paired with unknowns");
        self.plan = BlockPlan::new(&self.system, &self.structure);
        self.plan.set_parameters(&self.system, at, targets);
    }

    /// Returns the one driver that moves a block and all that it reads; `None` if there are more or
    /// none.
    pub(super) fn only_driver(&self, block: usize) -> Option<DriverId> {
        let blocks = self.structure.blocks();
        let mut seen = vec![false; blocks.len()];
        let columns = self.plan.blocks[block].columns().iter();
        let mut open: Vec<_> = columns.map(|&c| self.structure.block_of(c)).collect();
        let mut only = None;
        while let Some(block) = open.pop() {
            if std::mem::replace(&mut seen[block], true) {
                continue;
            }
            for &row in &blocks[block].rows {
                if let Target::Driver(driver) = self.system.equations()[row].target
                    && only.replace(driver).is_some_and(|other| other != driver)
                {
                    return None;
                }
            }
            open.extend(&blocks[block].reads);
        }
        only
    }
}
