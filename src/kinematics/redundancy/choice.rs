//! Which rows of Phi the solver works with, where not every row says something new.
//!
//! An ordinary mechanism has as many equations as unknowns, each with something to say, and pays
//! nothing here. Where equations and unknowns cannot be paired, or the Jacobian is singular where
//! the mechanism closes, numbers decide: the mechanism is closed on *all* rows, and the rank of
//! the constraints' Jacobian is found there and a little way along the motion that it leaves,
//! closed on all constraints again. What depends in all these places is redundant, what depends
//! at the first only makes a singular position.
//!
//! The rows of redundant equations are set aside: of rows that depend on each other the one
//! declared last, and never a driver's. Set aside does not mean forgotten: a step after which
//! they do not hold is refused. Which rows of a dependent set are fit to be solved depends on the
//! pose (a parallelogram laid flat needs its third crank); where those in use become nearly
//! dependent while all together are not, others are taken.

use std::fmt;

use super::closing::{Closing, evaluate_row, holds};
use super::rank::{DEPENDENT, mixture};
use super::set_aside::SetAside;
use crate::kinematics::assembly::least_squares::{Part, SMALL_PART, STARTS};
use crate::kinematics::assembly::search::Deadlock;
use crate::kinematics::block::Plan;
use crate::kinematics::error::OpenJoint;
use crate::kinematics::linear::{Echelon, Row};
use crate::kinematics::newton::SINGULAR;
use crate::kinematics::solver::Solver;
use crate::kinematics::structure::Structure;
use crate::kinematics::system::Target;
use crate::kinematics::{Element, Error, Path};

/// A part with a smaller scaled residual is closed well enough to look for superfluous rows; rows
/// in a singular part are found so to the square root of it.
const CLOSED: f64 = 1e-6;
/// A row of which this is left is fit to be solved, and those declared after it need not be.
const FIT: f64 = 1e-2;
/// Where too few rows are fit, those count of which this part of it is left.
const LESS_FIT: f64 = 0.1;
/// When rows are chosen again, only what is nearly independent counts as fit.
const FITTER: f64 = 0.1;
/// Rows are changed for others with this much more left.
const WORTH: f64 = 4.0;

/// A joint or constraint with equations that follow from the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Redundancy {
    /// Kind and name.
    pub element: String,
    /// How many of its equations are redundant.
    pub redundant: usize,
    /// How many it has.
    pub equations: usize,
}

impl fmt::Display for Redundancy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            element,
            redundant,
            equations,
        } = self;
        let set_aside = if *redundant == 1 {
            "follows from the others; it is"
        } else {
            "follow from the others; they are"
        };
        write!(
            f,
            "constraint equations of {element} are redundant: {redundant} of its {equations} \
             {set_aside} set aside and watched"
        )
    }
}

/// A choice among all rows at one pose.
struct Choice {
    set_aside: Vec<usize>,
    /// The least that is left of a row kept.
    weakest: f64,
}

impl Solver {
    /// The joints and constraints with redundant equations, known once the solver is
    /// [assembled](Self::assemble). The mechanism moves without these equations; whether they
    /// hold is watched, and a step after which they do not is refused.
    #[must_use]
    pub fn redundancies(&self) -> Vec<Redundancy> {
        let equations = self.system.equations();
        let mut found: Vec<(Element, usize)> = Vec::new();
        for &row in &self.set_aside.redundant {
            let element = equations[row].element;
            match found.last_mut() {
                Some((last, count)) if *last == element => *count += 1,
                _ => found.push((element, 1)),
            }
        }
        let describe = |(element, redundant): (Element, usize)| Redundancy {
            element: element.describe(self.system.mechanism()),
            redundant,
            equations: equations.iter().filter(|e| e.element == element).count(),
        };
        found.into_iter().map(describe).collect()
    }

    /// Decides which rows to work with at the end of `path`, by numbers, and compiles the plan
    /// for them.
    ///
    /// # Errors
    ///
    /// [`Error::Structure`] if something is free to move or more is driven than is free,
    /// [`Error::Contradiction`] and [`Error::NotAssembled`] if the mechanism does not close,
    /// [`Error::Singular`] if it closes in a singular position; those of values that make no
    /// mechanism.
    pub(in crate::kinematics) fn choose_rows(&mut self, path: &Path) -> Result<(), Error> {
        let estimate = self.go_to_estimate(path)?;
        // Should there be no choice, what was known of other values stays.
        let before = (
            self.set_aside.clone(),
            std::mem::replace(&mut self.structure, Structure::of_nothing(&self.system)),
            std::mem::take(&mut self.plan),
        );
        let chosen = self.choose_rows_near(&estimate);
        if chosen.is_err() {
            (self.set_aside, self.structure, self.plan) = before;
            self.factorised = false;
        }
        chosen
    }

    fn choose_rows_near(&mut self, estimate: &[f64]) -> Result<(), Error> {
        let all: Vec<_> = (0..self.system.equations().len()).collect();
        if let Some(gap) = self.close_on_all(estimate) {
            return Err(self.explain_open(gap, estimate));
        }
        let redundant = self.find_freedom()?;
        let choice = self.choose_here(FIT);
        let kept = all.len() - choice.set_aside.len();
        if kept < self.system.unknowns() {
            return Err(self.singular_position());
        }
        let first = match std::mem::take(&mut self.set_aside.first) {
            // Crossings of change points know of these rows.
            first if first.len() == choice.set_aside.len() => first,
            _ => choice.set_aside.clone(),
        };
        self.set_aside = SetAside {
            redundant,
            first,
            now: choice.set_aside,
        };
        self.compile();
        let (plan, mut work) = self.work();
        if plan.factorise(&mut work).is_err() || plan.rcond() < SINGULAR {
            return Err(self.singular_position());
        }
        Ok(())
    }

    /// Assembles a mechanism with rows set aside: closes it on all rows, then brings the kernels'
    /// rows to rounding. Returns the most corrections that a kernel needed.
    ///
    /// # Errors
    ///
    /// Those of [`choose_rows`](Self::choose_rows).
    pub(in crate::kinematics) fn assemble_on_all(
        &mut self,
        estimate: &[f64],
    ) -> Result<u32, Error> {
        if let Some(gap) = self.close_on_all(estimate) {
            return Err(self.explain_open(gap, estimate));
        }
        self.at.copy_pose(&mut self.pose.q);
        self.stand_on_fit_rows()?;
        let iterations = self.close().ok_or_else(|| self.singular_position())?;
        self.stand_at_pose();
        Ok(iterations)
    }

    /// Returns to the rows of the first pose, or, where these are not fit, to those that the
    /// present pose alone determines.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] if the rows all together lose rank here.
    pub(in crate::kinematics) fn stand_on_fit_rows(&mut self) -> Result<(), Error> {
        if self.set_aside.is_empty() || !self.pose.crossings.is_empty() {
            return Ok(());
        }
        let first = self.set_aside.first.clone();
        let set_aside = if self.weakest_without(&first) > FIT * FITTER {
            first
        } else {
            let choice = self.choose_here(FITTER);
            if choice.set_aside.len() > first.len() {
                return Err(self.singular_position());
            }
            choice.set_aside
        };
        if set_aside != self.set_aside.now {
            self.set_aside.now = set_aside;
            self.compile();
        }
        self.stand_at_pose();
        Ok(())
    }

    /// Takes other rows if those in use are much nearer to dependence here than others would be;
    /// true if so. Allocates, but only where redundant rows leave a choice.
    pub(in crate::kinematics) fn change_rows(&mut self) -> bool {
        let choice = self.fitter_rows();
        let better = choice.is_some();
        if let Some(choice) = choice {
            self.set_aside.now = choice.set_aside;
            self.compile();
        }
        better
    }

    /// Returns to the rows of the first pose, of which crossings of change points are made.
    /// Allocates where other rows are in use.
    pub(in crate::kinematics) fn return_to_first_rows(&mut self) {
        if self.set_aside.now != self.set_aside.first {
            self.set_aside.now.clone_from(&self.set_aside.first);
            self.compile();
        }
    }

    /// Whether a change point of the rows in use is one of the mechanism, as far as rows can tell:
    /// they are those of the first pose, and others are no better here.
    pub(in crate::kinematics) fn may_cross(&mut self) -> bool {
        self.set_aside.now == self.set_aside.first && self.fitter_rows().is_none()
    }

    /// Whether the rows all together are nearly dependent where the mechanism is.
    pub(in crate::kinematics) fn is_nearly_singular(&mut self) -> bool {
        self.choose_here(FITTER).weakest < FIT
    }

    /// A choice of rows that are much farther from dependence here than those in use, if these
    /// are near to it.
    fn fitter_rows(&mut self) -> Option<Choice> {
        if self.set_aside.is_empty() || !self.pose.crossings.is_empty() {
            return None;
        }
        let now = self.set_aside.now.clone();
        let weakest = self.weakest_without(&now);
        if weakest > FITTER {
            return None;
        }
        let choice = self.choose_here(FITTER);
        let better = choice.set_aside.len() == now.len() && choice.weakest > WORTH * weakest;
        better.then_some(choice)
    }

    /// The joint or constraint that the rows set aside say is open by more than rounding.
    /// Allocates nothing if there is none.
    pub(in crate::kinematics) fn opened(&self) -> Option<OpenJoint> {
        let Self {
            system,
            targets,
            pose,
            at,
            set_aside,
            ..
        } = self;
        let open = |row: &&usize| {
            let value = system.evaluate_row(**row, at, targets, &pose.drivers, |_, _| {});
            !holds(value)
        };
        let first = set_aside.now.iter().find(open)?;
        let element = system.equations()[*first].element;
        let rows = 0..system.equations().len();
        let rows: Vec<_> = rows
            .filter(|&row| system.equations()[row].element == element)
            .collect();
        let mut open = self.open_joints(&rows, 0.0);
        open.pop().map(|(_, joint)| joint)
    }

    /// Structure and plan for all rows but those set aside.
    fn compile(&mut self) {
        let structure = Structure::new(&self.system, &self.set_aside.now);
        self.structure = structure.expect("independent rows can be paired with unknowns");
        self.plan = Plan::new(&self.system, &self.structure);
        self.plan
            .set_parameters(&self.at, &self.targets, &mut self.tubes);
        self.plan
            .choose_pivots(&self.system, &self.at, &self.targets);
        self.factorised = false;
    }

    /// Closes the mechanism on all rows. `None` if they are satisfied; else the largest scaled
    /// residual of the nearest pose found, where the mechanism then is.
    fn close_on_all(&mut self, estimate: &[f64]) -> Option<f64> {
        let all: Vec<_> = (0..self.system.equations().len()).collect();
        if !self.is_small() {
            // Too many unknowns for a minimisation to go far: most kernels close by themselves.
            self.find_start(estimate);
            Closing::new(&self.system, &all).close(&mut self.work().1)?;
        }
        self.close_on(&all, estimate)
    }

    pub(super) fn is_small(&self) -> bool {
        self.system.unknowns() <= SMALL_PART
    }

    /// Closes the mechanism on these rows from the estimates, or starts near them. `None` if they
    /// are satisfied; else the largest scaled residual of the nearest pose found, where the
    /// mechanism then is.
    pub(in crate::kinematics) fn close_on(
        &mut self,
        rows: &[usize],
        estimate: &[f64],
    ) -> Option<f64> {
        let unknowns: Vec<_> = (0..self.system.unknowns()).collect();
        let part = Part::new(rows, &unknowns);
        let small = self.is_small();
        let mut closing = Closing::new(&self.system, rows);
        let mut nearest: Option<(f64, Vec<f64>)> = None;
        for attempt in 0..if small { STARTS } else { 1 } {
            let (_, mut work) = self.work();
            part.start(&mut work, estimate, attempt);
            if small {
                part.minimise_growing(&mut work);
            }
            let gap = closing.close(&mut work)?;
            if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
                let mut q = vec![0.0; unknowns.len()];
                self.at.copy_pose(&mut q);
                nearest = Some((gap, q));
            }
        }
        let (gap, q) = nearest?;
        self.at.set_pose(self.system.mechanism(), &q);
        Some(gap)
    }

    /// Assembles on rows that can be paired with unknowns, the drivers' first, then in the order
    /// of declaration, kernel by kernel. In a kernel that does not close a row that the others
    /// make superfluous is left out, and others get their turn. Returns what is known if this
    /// does not lead to a pose.
    pub(super) fn find_start(&mut self, estimate: &[f64]) -> Option<Deadlock> {
        let mut left_out = Vec::new();
        loop {
            let order = self.drivers_first().into_iter();
            let order = order.filter(|row| !left_out.contains(row));
            self.set_aside.now = Structure::left_over(&self.system, order)?;
            self.compile();
            self.at.set_pose(self.system.mechanism(), estimate);
            let deadlock = self.search(estimate).err();
            let kernel = match &deadlock {
                Some(deadlock) => deadlock.kernel,
                // Rows that depend on each other may close by chance.
                None => {
                    let mut kernels = self.plan.kernels.iter_mut();
                    kernels.position(|kernel| kernel.rcond() < SINGULAR)?
                }
            };
            match self.superfluous_in(kernel, estimate) {
                Some(row) => left_out.push(row),
                None => return deadlock,
            }
        }
    }

    /// The last row of a kernel that the others make superfluous where it closes, behind those
    /// before it; `None` if there is none, or the kernel does not close or is large.
    fn superfluous_in(&mut self, kernel: usize, estimate: &[f64]) -> Option<usize> {
        let kernel = &self.plan.kernels[kernel];
        let part = Part::new(kernel.rows(), kernel.columns());
        if part.unknowns() > SMALL_PART {
            return None;
        }
        let columns = kernel.columns().to_vec();
        let (_, mut work) = self.work();
        part.start(&mut work, estimate, 0);
        part.minimise_growing(&mut work);
        if part.equations(&work).0.amax() > CLOSED {
            return None;
        }
        let mut rows = self.rows_here();
        for row in &mut rows {
            row.retain(|(column, _)| columns.contains(column));
        }
        let own = part.rows.iter().map(|&row| &rows[row]);
        let mut echelon = Echelon::new(self.system.unknowns(), own);
        let is_driver = |row: &usize| {
            let target = &self.system.equations()[*row].target;
            matches!(target, Target::Driver(_))
        };
        let (drivers, others): (Vec<_>, Vec<_>) = part.rows.iter().partition(|row| is_driver(row));
        let order = drivers.into_iter().chain(others);
        order.fold(None, |last, row| {
            let left_out = echelon.offer(row, &rows[row], CLOSED.sqrt());
            left_out.map(|left_out| left_out.row).or(last)
        })
    }

    /// Chooses rows where the mechanism is: the drivers', then those of which enough is left, in
    /// the order of declaration; as long as that does not do, those of which less is left.
    fn choose_here(&mut self, fit: f64) -> Choice {
        let rows = self.rows_here();
        let mut echelon = Echelon::new(self.system.unknowns(), &rows);
        let mut set_aside = self.drivers_first();
        let mut fit = fit;
        loop {
            set_aside.retain(|&row| echelon.offer(row, &rows[row], fit).is_some());
            let complete = echelon.kept().len() == self.system.unknowns();
            if complete || set_aside.is_empty() || fit <= DEPENDENT {
                break;
            }
            fit = (LESS_FIT * fit).max(DEPENDENT);
        }
        set_aside.sort_unstable();
        Choice {
            set_aside,
            weakest: weakest(&echelon),
        }
    }

    /// The least that is left of a row where the mechanism is, if all but these are kept.
    fn weakest_without(&mut self, set_aside: &[usize]) -> f64 {
        let rows = self.rows_here();
        let mut echelon = Echelon::new(self.system.unknowns(), &rows);
        for row in self.drivers_first() {
            if set_aside.binary_search(&row).is_err()
                && echelon.offer(row, &rows[row], DEPENDENT).is_some()
            {
                return 0.0;
            }
        }
        weakest(&echelon)
    }

    /// All rows, the drivers' first.
    fn drivers_first(&self) -> Vec<usize> {
        let equations = self.system.equations();
        let mut rows: Vec<_> = (0..equations.len()).collect();
        rows.sort_by_key(|&row| matches!(equations[row].target, Target::Constant(_)));
        rows
    }

    /// The Jacobian by rows where the mechanism is, scaled.
    pub(super) fn rows_here(&mut self) -> Vec<Row> {
        let rows = 0..self.system.equations().len();
        let (_, work) = self.work();
        rows.map(|row| {
            let mut entries = Row::new();
            evaluate_row(&work, row, &mut entries);
            entries
        })
        .collect()
    }

    /// The verdict on a pose at which the rows all together lose rank: names what can move there
    /// though no driver does.
    pub(super) fn singular_position(&mut self) -> Error {
        let rows = self.rows_here();
        let order = self.drivers_first();
        let eliminate = |least: f64| {
            let mut echelon = Echelon::new(self.system.unknowns(), &rows);
            for &row in &order {
                echelon.offer(row, &rows[row], least);
            }
            echelon
        };
        let mut echelon = eliminate(DEPENDENT);
        let mut rcond = 0.0;
        if echelon.free().is_empty() {
            // Nearly singular: without the weakest row.
            rcond = weakest(&echelon);
            echelon = eliminate(rcond);
        }
        if rows.len() <= SMALL_PART {
            let unknowns: Vec<_> = (0..self.system.unknowns()).collect();
            let part = Part::new(&order, &unknowns);
            let singular = part.equations(&self.work().1).1.singular_values();
            rcond = singular.min() / singular.max();
        }
        Error::Singular {
            rcond,
            bodies: self.moved_by(&echelon),
        }
    }

    /// What moves in the motions that the rows kept leave.
    pub(super) fn moved_by(&self, echelon: &Echelon) -> Vec<String> {
        /// A part of the largest motion that is not rounding.
        const MOVES: f64 = 1e-5;
        /// More motions than this are looked at in so many mixtures of all of them: a coincidence
        /// in which motions cancel does not come twice.
        const FEW: usize = 64;
        const MIXTURES: usize = 8;
        let free = echelon.free();
        let mixtures = if free.len() <= FEW { 0 } else { MIXTURES };
        let single = free.iter().take_while(|_| mixtures == 0);
        let single = single.map(|&column| vec![(column, 1.0)]);
        let mixed = (0..mixtures).map(|which| {
            let parts = free.iter().enumerate();
            let parts = parts.map(|(k, &column)| (column, mixture(MIXTURES * k + which)));
            parts.collect()
        });
        let mut moves = vec![false; self.system.unknowns()];
        for motion in single.chain(mixed) {
            let vector = echelon.null_vector(&motion);
            for (moves, value) in moves.iter_mut().zip(vector) {
                *moves |= value.abs() > MOVES;
            }
        }
        let columns = (0..moves.len()).filter(|&column| moves[column]);
        let mut named: Vec<_> = columns.map(|k| self.system.describe_unknown(k)).collect();
        // The unknowns of a body are next to each other.
        named.dedup();
        named
    }
}

/// The least that is left of a row kept.
fn weakest(echelon: &Echelon) -> f64 {
    let left = echelon.kept().iter().map(|kept| kept.remainder);
    left.fold(1.0, f64::min)
}
