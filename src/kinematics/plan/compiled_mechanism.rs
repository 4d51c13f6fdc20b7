//! A compiled mechanism: its equations, their structure, and the plan that solves them.

use std::sync::Arc;

use super::BlockPlan;
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::constraint::{Constraint, Incidence, OnCurve, of_coordinate};
use crate::kinematics::stop_limit::StopLimit;
use crate::kinematics::system::structure::{Block, Structure};
use crate::kinematics::system::{EquationTarget, System, Targets};
use crate::mechanism::{DriverId, DriverSource, Mechanism, Stop};

/// The equations of a mechanism and the way in which they are solved.
#[derive(Debug)]
pub(in crate::kinematics) struct CompiledMechanism {
    pub(in crate::kinematics) system: System,
    pub(in crate::kinematics) structure: Structure,
    pub(in crate::kinematics) plan: BlockPlan,
    pub(in crate::kinematics) redundant: RedundantRows,
    pub(in crate::kinematics) measures: Vec<Box<dyn Constraint>>,
    pub(in crate::kinematics) stops: Vec<StopRelation>,
    /// Per driver: the file's own coordinate of a freedom that is integrated in another one.
    pub(in crate::kinematics) named: Vec<Option<Box<dyn Constraint>>>,
}

/// The coordinate of a stop, or the place on an open curve.
#[derive(Debug)]
pub(in crate::kinematics) struct StopRelation {
    pub(in crate::kinematics) relation: Box<dyn Constraint>,
    /// The unknowns in it, each once.
    pub(in crate::kinematics) columns: Vec<usize>,
    /// The part of the mechanism's size that scales it, `None` for an angle or a place on a curve.
    pub(in crate::kinematics) part: Option<f64>,
    pub(in crate::kinematics) owner: LimitOwner,
}

/// The owner of limits.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum LimitOwner {
    /// A stop, by its index.
    Stop(usize),
    /// A joint with an open curve, by its index, and the place at the curve's last end.
    Curve(usize, f64),
}

impl StopRelation {
    fn of_stop(system: &System, (index, stop): (usize, &Stop)) -> Self {
        let relation = of_coordinate(&stop.coordinate);
        let mut incidence = Incidence::default();
        relation.incidence(system.mechanism(), &mut incidence);
        let mut columns = incidence.unknowns;
        columns.sort_unstable();
        columns.dedup();
        let parts = columns
            .iter()
            .filter_map(|column| system.column_part(*column));
        let part = parts.reduce(f64::max).unwrap_or(1.0);
        Self {
            relation,
            part: (!stop.coordinate.kind.is_angle()).then_some(part),
            columns,
            owner: LimitOwner::Stop(index),
        }
    }

    fn of_curve(system: &System, (joint, curve): (usize, &OnCurve)) -> Option<Self> {
        let relation = curve.place();
        let mut incidence = Incidence::default();
        relation.incidence(system.mechanism(), &mut incidence);
        Some(Self {
            relation: Box::new(relation),
            columns: incidence.unknowns,
            part: None,
            owner: LimitOwner::Curve(joint, curve.last_end()?),
        })
    }

    /// Returns least and largest value for these parameters, infinite without a limit. Allocates
    /// nothing.
    pub(in crate::kinematics) fn limits(
        &self,
        mechanism: &Mechanism,
        parameters: &[f64],
    ) -> [f64; 2] {
        match self.owner {
            LimitOwner::Stop(stop) => mechanism.stops[stop].limits(&|id| parameters[id.index()]),
            LimitOwner::Curve(_, last) => [0.0, last],
        }
    }

    /// Returns one of the limits for messages, with the value that it has.
    pub(in crate::kinematics) fn describe(
        &self,
        mechanism: &Mechanism,
        is_max: bool,
        value: f64,
    ) -> Box<StopLimit> {
        Box::new(match self.owner {
            LimitOwner::Stop(stop) => {
                StopLimit::new(mechanism, &mechanism.stops[stop], is_max, value)
            }
            LimitOwner::Curve(joint, _) => {
                StopLimit::of_curve(&mechanism.joints[joint].name, is_max, value)
            }
        })
    }

    /// Returns the scale factor of the coordinate \[m or rad\], for this size of the mechanism.
    pub(in crate::kinematics) fn scale(&self, size: f64) -> f64 {
        self.part.map_or(1.0, |part| size * part)
    }
}

/// The rows of Phi that are redundant, and those set aside instead of them.
#[derive(Clone, Debug, Default)]
pub(in crate::kinematics) struct RedundantRows {
    /// Rows that follow from the others, of equals the ones declared last; ascending.
    pub(in crate::kinematics) all: Vec<usize>,
    /// The rows set aside at the first pose, as many; ascending. Assembly returns to them.
    pub(in crate::kinematics) first: Vec<usize>,
    /// The rows set aside at present, as many; ascending.
    pub(in crate::kinematics) now: Vec<usize>,
    /// Those of them that depend on a function of the file.
    pub(in crate::kinematics) function_rows: Vec<FunctionRow>,
}

/// A row that depends on a function of the file, its own or one that moves its bodies.
#[derive(Clone, Debug)]
pub(in crate::kinematics) struct FunctionRow {
    pub(in crate::kinematics) row: usize,
    /// The unknowns in it.
    pub(in crate::kinematics) columns: Vec<usize>,
}

impl RedundantRows {
    /// Returns whether no row is set aside.
    pub(in crate::kinematics) fn is_empty(&self) -> bool {
        self.now.is_empty()
    }
}

impl CompiledMechanism {
    /// Writes down the equations and analyses their structure. Also returns whether equations and
    /// unknowns pair up; otherwise the plan is empty.
    pub(in crate::kinematics) fn new(mechanism: Arc<Mechanism>) -> (Self, bool) {
        let measures = mechanism.measures.iter();
        let measures = measures.map(|measure| of_coordinate(&measure.coordinate));
        let measures = measures.collect();
        let named = mechanism.drivers.iter();
        let named = named.map(|driver| match &driver.source {
            DriverSource::Free { named, .. } => named.as_ref().map(of_coordinate),
            _ => None,
        });
        let named = named.collect();
        let system = System::new(mechanism);
        let stops = system.mechanism().stops.iter().enumerate();
        let stops = stops.filter(|(_, stop)| stop.is_rigid());
        let stops = stops.map(|stop| StopRelation::of_stop(&system, stop));
        let curves = system.curves();
        let curves = curves.filter_map(|curve| StopRelation::of_curve(&system, curve));
        let stops = stops.chain(curves).collect();
        let structure = Structure::new(&system, &[]);
        let pairs_up = structure.is_some();
        let structure = structure.unwrap_or_else(|| Structure::of_nothing(&system));
        let compiled = Self {
            plan: BlockPlan::new(&system, &structure),
            structure,
            redundant: RedundantRows::default(),
            measures,
            stops,
            named,
            system,
        };
        (compiled, pairs_up)
    }

    /// Returns whether points move on open curves.
    pub(in crate::kinematics) fn has_ends_of_curves(&self) -> bool {
        let owners = self.stops.iter().map(|watched| watched.owner);
        owners
            .into_iter()
            .any(|owner| matches!(owner, LimitOwner::Curve(..)))
    }

    /// Compiles structure and plan for all rows but those set aside.
    pub(in crate::kinematics) fn compile(&mut self, at: &Configuration, targets: &Targets) {
        let structure = Structure::new(&self.system, &self.redundant.now);
        self.structure = structure.expect("independent rows can be paired with unknowns");
        self.redundant.function_rows = self.function_rows();
        self.plan = BlockPlan::new(&self.system, &self.structure);
        self.plan.set_parameters(&self.system, at, targets);
    }

    /// Sets other rows aside, as many. Returns false, and changes nothing, if the rest cannot be
    /// paired with unknowns. The plan has to be compiled then.
    pub(in crate::kinematics) fn set_aside(&mut self, rows: &[usize]) -> bool {
        let now = &mut self.redundant.now;
        let fits = rows.len() == now.len()
            && rows.is_sorted_by(|a, b| a < b)
            && Structure::new(&self.system, rows).is_some();
        if fits {
            now.copy_from_slice(rows);
        }
        fits
    }

    /// Returns the rows set aside that depend on a function of the file.
    fn function_rows(&self) -> Vec<FunctionRow> {
        let equations = self.system.equations();
        let has_given_function = |row: &usize| equations[*row].constraint.has_given_function();
        if !(0..equations.len()).any(|row| has_given_function(&row)) {
            return Vec::new();
        }
        let rows = self.redundant.now.iter().map(|&row| FunctionRow {
            row,
            columns: self.system.incidence(row).unknowns,
        });
        let depends = |FunctionRow { row, columns }: &FunctionRow| {
            let mut rows = self
                .blocks_behind(columns)
                .into_iter()
                .flat_map(|b| &b.rows);
            has_given_function(row) || rows.any(has_given_function)
        };
        rows.filter(depends).collect()
    }

    /// Returns the blocks that find these unknowns, and all that they read.
    pub(in crate::kinematics) fn blocks_behind(&self, columns: &[usize]) -> Vec<&Block> {
        let blocks = self.structure.blocks();
        let mut seen = vec![false; blocks.len()];
        let mut open: Vec<_> = columns
            .iter()
            .map(|&c| self.structure.block_of(c))
            .collect();
        let mut found = Vec::new();
        while let Some(block) = open.pop() {
            if !std::mem::replace(&mut seen[block], true) {
                found.push(&blocks[block]);
                open.extend(&blocks[block].reads);
            }
        }
        found
    }

    /// Returns the one driver that moves a block and all that it reads; `None` if there are more or
    /// none.
    pub(in crate::kinematics) fn only_driver(&self, block: usize) -> Option<DriverId> {
        let mut only = None;
        for block in self.blocks_behind(self.plan.blocks[block].columns()) {
            for &row in &block.rows {
                if let EquationTarget::Driver(driver) = self.system.equations()[row].target
                    && only.replace(driver).is_some_and(|other| other != driver)
                {
                    return None;
                }
            }
        }
        only
    }
}
