//! The blocks that one block reads, directly or through others, moved along a line.

use std::collections::BTreeSet;

use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::newton::Limits;
use crate::kinematics::path::{Motions, Path, Rates};
use crate::kinematics::plan::{BlockSolver, BlockState};
use crate::kinematics::state::State;
use crate::kinematics::system::{System, Targets, Values};
use crate::mechanism::{DriverId, Jet};

/// The line along which the drivers run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Line<'a> {
    /// The values of one driver, all others being held; τ is its value.
    Driver(DriverId),
    /// A path on which no parameter moves; τ is s.
    Path(&'a Path),
}

impl Line<'_> {
    /// Writes the drivers at τ with their derivatives in it; `held` are their present values.
    fn drivers(self, tau: f64, held: &[f64], motions: &Motions, out: &mut [Jet]) {
        match self {
            Self::Path(path) => path.drivers(tau, motions, out),
            Self::Driver(driver) => {
                for (out, value) in out.iter_mut().zip(held) {
                    *out = Jet::constant(*value);
                }
                out[driver.index()] = Jet::variable(tau);
            }
        }
    }
}

/// Vectors over all unknowns that the reduced equations of several blocks take in turn. Only the
/// entries of the unknowns of a block and of those that it reads are set for its equation.
pub(super) struct Workspace {
    pub(super) at: Configuration,
    /// Rates along the line of the unknowns of the blocks moved: at the last place and at the start.
    pub(super) tangent: Rates,
    origin_tangent: Rates,
    /// Rates of one combination of motions.
    pub(super) combined: Vec<f64>,
    /// Index of each unknown in its block.
    pub(super) place_of: Vec<Option<usize>>,
}

impl Workspace {
    pub(super) fn new(state: &State) -> Self {
        let unknowns = state.pose.q.len();
        Self {
            at: state.at.clone(),
            tangent: Rates::new(unknowns),
            origin_tangent: Rates::new(unknowns),
            combined: vec![0.0; unknowns],
            place_of: vec![None; unknowns],
        }
    }

    /// Returns the mechanism at the last place as block solvers see it.
    fn block_state<'b>(
        &'b mut self,
        system: &'b System,
        targets: &'b Targets,
        drivers: &'b [f64],
    ) -> BlockState<'b> {
        BlockState {
            system,
            targets,
            drivers,
            at: &mut self.at,
            tangent: &mut self.tangent,
        }
    }
}

/// A block of less regularity is singular.
const LEAST_REGULARITY: f64 = 1e-6;

/// The blocks that one block reads, at one place of a line.
pub(super) struct Upstream<'a> {
    pub(super) system: &'a System,
    targets: &'a Targets,
    motions: &'a Motions,
    line: Line<'a>,
    /// The block's index in the plan, the blocks before it, and the blocks that each block reads.
    block: usize,
    before: &'a mut [BlockSolver],
    reads: &'a [Vec<usize>],
    /// The blocks that it reads, ascending; and those of them that were moved to the last place.
    all: Vec<usize>,
    moved: Vec<usize>,
    /// Whether one of them comes from a crossing.
    pub(super) has_crossings: bool,
    pub(super) work: &'a mut Workspace,
    held: &'a [f64],
    jets: Vec<Jet>,
    /// The drivers' values at the last place.
    pub(super) drivers: Vec<f64>,
    /// The start: τ and the pose there.
    pub(super) start: f64,
    pub(super) origin: &'a [f64],
}

impl<'a> Upstream<'a> {
    /// Takes the blocks that the block with this index reads, of those `before` it, from the pose,
    /// which is at `start` of the line.
    pub(super) fn new(
        (block, before, reads): (usize, &'a mut [BlockSolver], &'a [Vec<usize>]),
        system: &'a System,
        state: &'a State,
        (line, start): (Line<'a>, f64),
        work: &'a mut Workspace,
    ) -> Self {
        let State {
            pose,
            targets,
            motions,
            ..
        } = state;
        let all = read_through(block, reads, |_| false);
        let mut read = all.iter().map(|&block| &before[block]);
        Self {
            has_crossings: read.any(|block| matches!(block, BlockSolver::InterpolatedBlock(_))),
            system,
            targets,
            motions,
            line,
            block,
            before,
            reads,
            moved: all.clone(),
            all,
            work,
            held: &pose.drivers,
            jets: vec![Jet::constant(0.0); pose.drivers.len()],
            drivers: pose.drivers.clone(),
            start,
            origin: &pose.q,
        }
    }

    /// Returns the unknowns of the blocks moved to the last place.
    pub(super) fn moved_columns(&self) -> impl Iterator<Item = usize> {
        let moved = self.moved.iter();
        moved
            .flat_map(|&block| self.before[block].columns())
            .copied()
    }

    /// Returns whether one of the blocks moved is singular at the last place; no block is where it
    /// follows a crossing.
    pub(super) fn is_singular(&self) -> bool {
        let mut moved = self.moved.iter().map(|&block| &self.before[block]);
        moved.any(|block| {
            let solver = match block {
                BlockSolver::InterpolatedBlock(on) if !on.is_within(&self.drivers) => &on.block,
                block => block,
            };
            solver.regularity() < LEAST_REGULARITY
        })
    }

    /// Returns the driver of a row at the last place, with its derivatives in τ.
    pub(super) fn driver(&self, row: usize) -> Jet {
        self.system.equations()[row].target_rates(&self.jets)
    }

    /// Returns the numbers in the equations at the last place.
    pub(super) fn values(&self) -> Values<'_> {
        Values {
            at: &self.work.at,
            targets: self.targets,
            drivers: &self.drivers,
        }
    }

    /// Keeps the rates of all blocks moved, at the start.
    pub(super) fn keep_tangent(&mut self) {
        let Workspace {
            tangent,
            origin_tangent,
            ..
        } = &mut *self.work;
        let (velocity, acceleration) = origin_tangent.both_mut();
        let moved = self.moved.iter();
        for &column in moved.flat_map(|&block| self.before[block].columns()) {
            velocity[column] = tangent.velocity()[column];
            acceleration[column] = tangent.acceleration()[column];
        }
    }

    /// Moves the blocks to τ. One on a crossing depends on its driver alone: what it reads itself
    /// stays where it is.
    pub(super) fn move_to(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        if self.has_crossings {
            self.moved = read_through(self.block, self.reads, |block| match &self.before[block] {
                BlockSolver::InterpolatedBlock(block) => block.is_within(&self.drivers),
                _ => false,
            });
        }
        self.move_blocks(tau)
    }

    /// Moves all blocks to τ.
    pub(super) fn move_all_to(&mut self, tau: f64) -> Option<()> {
        self.move_drivers(tau);
        self.moved.clone_from(&self.all);
        self.move_blocks(tau)
    }

    fn move_drivers(&mut self, tau: f64) {
        self.line
            .drivers(tau, self.held, self.motions, &mut self.jets);
        for (value, jet) in self.drivers.iter_mut().zip(&self.jets) {
            *value = jet.value;
        }
    }

    /// Moves blocks to τ, where the drivers are: along tangent and curvature from the start, then by
    /// Newton–Raphson. A block on a crossing follows it, and goes on beyond its end.
    fn move_blocks(&mut self, tau: f64) -> Option<()> {
        let off = tau - self.start;
        let Workspace {
            at, origin_tangent, ..
        } = &mut *self.work;
        let (velocity, acceleration) = (origin_tangent.velocity(), origin_tangent.acceleration());
        for &block in &self.moved {
            for &column in self.before[block].columns() {
                let ahead = off * (velocity[column] + 0.5 * off * acceleration[column]);
                at.set_coordinate(column, self.origin[column] + ahead);
            }
        }
        let mut state = (self.work).block_state(self.system, self.targets, &self.drivers);
        for &block in &self.moved {
            let block = match &mut self.before[block] {
                BlockSolver::InterpolatedBlock(on) if on.start_beyond(&mut state) => &mut on.block,
                block => block,
            };
            close(block, &mut state, Limits::STEP, &self.jets)?;
        }
        Some(())
    }

    /// Solves the block that reads these and its rates by its own solver, from where its bodies
    /// are, to the last bit.
    pub(super) fn close(&mut self, own: &mut BlockSolver) -> Option<()> {
        let mut state = (self.work).block_state(self.system, self.targets, &self.drivers);
        close(own, &mut state, Limits::TO_THE_LAST_BIT, &self.jets)
    }
}

/// Returns the blocks that a block reads, directly or through others, ascending, but not through
/// those at which the search `stops`.
fn read_through(block: usize, reads: &[Vec<usize>], stops: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut found = BTreeSet::new();
    let mut open = reads[block].clone();
    while let Some(block) = open.pop() {
        if found.insert(block) && !stops(block) {
            open.extend(&reads[block]);
        }
    }
    found.into_iter().collect()
}

/// Solves a block and its rates by its own solver from where its bodies are.
fn close(
    block: &mut BlockSolver,
    state: &mut BlockState<'_>,
    limits: Limits,
    drivers: &[Jet],
) -> Option<()> {
    block.close(state, limits).ok()?;
    block.factorise(state).ok()?;
    block.solve_rates(state, drivers);
    let [velocity, acceleration] = [state.tangent.velocity(), state.tangent.acceleration()];
    let mut columns = block.columns().iter();
    let finite = columns.all(|&column| (velocity[column] + acceleration[column]).is_finite());
    finite.then_some(())
}
