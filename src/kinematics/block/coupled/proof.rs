//! Storage and limits of the certificate of a block.

use super::block::{ENTRIES, Jacobian, Place};
use crate::kinematics::block::elimination::Order;
use crate::kinematics::block::work::Work;
use crate::kinematics::configuration::BodyPose;
use crate::kinematics::constraint::Incidence;
use crate::kinematics::linear::{Condition, Lu};
use crate::kinematics::system::{System, Target};

/// The most unknowns, once x and y of bodies are eliminated, of which an inverse is written down.
pub(super) const MOST_TORN: usize = 32;
/// Safety factor on the next trial radii, where those tried were too small.
pub(super) const ROOM: f64 = 1.25;
/// Most radii that are tried.
pub(super) const MOST_TRIES: u32 = 3;
/// The norm of K above which no larger radii are tried. K grows with the sub-step.
pub(super) const LARGEST_CONTRACTION: f64 = 0.9;
/// η + K r stays below this part of r: the rounding of A changes it by less than the rest.
pub(super) const STRICTLY: f64 = 0.999;

/// What the certificate of a block needs.
#[derive(Debug)]
pub(super) struct Proof {
    /// Unknowns found before that the rows contain.
    pub(super) known: Vec<usize>,
    /// The drivers that rows of the block are held at.
    pub(super) drivers: Vec<usize>,
    /// The bodies of these and of the block's own unknowns, with their frames at the end.
    pub(super) bodies: Vec<usize>,
    pub(super) ends: Vec<BodyPose>,
    /// The joints' own unknowns among them, likewise.
    pub(super) joint_unknowns: Vec<usize>,
    pub(super) joint_ends: Vec<f64>,
    /// The Jacobian in the middle.
    pub(super) middle: Jacobian,
    /// A by rows, empty where it is too large.
    pub(super) inverse: Vec<f64>,
    /// For where it is.
    pub(super) estimate: Estimate,
    pub(super) condition: Condition,
    /// What the rows are open by on the way, and what of it comes from moving parameters.
    pub(super) open: Vec<f64>,
    pub(super) slack: Vec<f64>,
    /// How far entries of the block's Jacobian may change: row, column, scaled value.
    pub(super) changes: Vec<(usize, usize, f64)>,
    /// Scaled radii: of what is known, those tried, what η + K r makes of them.
    pub(super) known_radii: Vec<f64>,
    pub(super) radii: Vec<f64>,
    pub(super) eta: Vec<f64>,
    pub(super) next: Vec<f64>,
    /// Work space.
    pub(super) row: Vec<f64>,
}

impl Proof {
    pub(super) fn new(
        system: &System,
        order: &Order,
        lu: &Lu,
        places: &[Place],
        kernel: usize,
    ) -> Self {
        let n = order.rows.len();
        let mut incidence = Incidence::default();
        for &row in &order.rows {
            let constraint = &system.equations()[row].constraint;
            constraint.incidence(system.mechanism(), &mut incidence);
        }
        let mut known = incidence.unknowns;
        known.retain(|&column| places[column].kernel != kernel);
        known.sort_unstable();
        known.dedup();
        let of_bodies = 3 * system.mechanism().bodies.len();
        let moving = || order.columns.iter().chain(&known).copied();
        let mut bodies: Vec<_> = moving().filter(|&k| k < of_bodies).map(|k| k / 3).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let joint_unknowns: Vec<_> = moving().filter(|&k| k >= of_bodies).collect();
        let drivers = order.rows.iter();
        let drivers = drivers.filter_map(|&row| match system.equations()[row].target {
            Target::Driver(driver) => Some(driver.index()),
            Target::Constant(_) => None,
        });
        let (inverse, estimate) = if order.torn() <= MOST_TORN {
            (n * n, Estimate::default())
        } else {
            (0, Estimate::new(n, ENTRIES * n))
        };
        Self {
            known_radii: vec![0.0; known.len()],
            known,
            drivers: drivers.collect(),
            ends: Vec::with_capacity(bodies.len()),
            bodies,
            joint_ends: vec![0.0; joint_unknowns.len()],
            joint_unknowns,
            middle: Jacobian::new(lu.clone()),
            inverse: vec![0.0; inverse],
            estimate,
            condition: Condition::new(n),
            open: vec![0.0; n],
            slack: vec![0.0; n],
            changes: Vec::with_capacity(ENTRIES * n),
            radii: vec![0.0; n],
            eta: vec![0.0; n],
            next: vec![0.0; n],
            row: vec![0.0; n],
        }
    }

    pub(super) fn forget_pivots(&mut self) {
        self.middle.lu.forget_pivots();
    }

    /// Takes over the pivots of the block's own matrix.
    pub(super) fn choose_pivots(&mut self, lu: &Lu) {
        self.middle.lu.clone_from(lu);
    }

    /// Notes where the bodies end.
    pub(super) fn note_ends(&mut self, work: &Work<'_>) {
        let frames = work.at.frames();
        self.ends.clear();
        self.ends
            .extend(self.bodies.iter().map(|&body| frames[body]));
        for (end, &column) in self.joint_ends.iter_mut().zip(&self.joint_unknowns) {
            *end = work.at.coordinate(column);
        }
    }

    /// Puts the bodies back there.
    pub(super) fn put_back(&self, work: &mut Work<'_>) {
        for (&body, &end) in self.bodies.iter().zip(&self.ends) {
            work.at.frames_mut()[body] = end;
        }
        for (&column, &end) in self.joint_unknowns.iter().zip(&self.joint_ends) {
            work.at.set_coordinate(column, end);
        }
    }

    /// |A| b, b ≥ 0 being one value a row, added to `sum`.
    pub(super) fn apply(&self, b: &[f64], sum: &mut [f64]) {
        let rows = self.inverse.chunks_exact(b.len());
        for (sum, row) in sum.iter_mut().zip(rows) {
            let parts = row.iter().zip(b).map(|(a, b)| a.abs() * b);
            *sum += parts.sum::<f64>();
        }
    }
}

/// What the estimate of a block needs besides.
#[derive(Debug, Default)]
pub(super) struct Estimate {
    /// J where the rows were evaluated last minus J where the block is factorised: row, column,
    /// value.
    pub(super) drift: Vec<(usize, usize, f64)>,
    /// F where the rows were evaluated last.
    pub(super) gap: Vec<f64>,
}

impl Estimate {
    pub(super) fn new(order: usize, entries: usize) -> Self {
        Self {
            drift: Vec::with_capacity(entries),
            gap: vec![0.0; order],
        }
    }
}
