//! The certificate of any block; see [`crate::kinematics::certificate`].
//!
//! A is the inverse of the Jacobian in the middle of the chord. Each relation bounds, over the
//! region that chord and radii reach from there, its second derivative along the chord and the
//! change of its gradient ([`Constraint::bend`]): the first divided by eight is what the chord
//! leaves its row open by, the second makes K. Unknowns found before are part of chord and
//! region; their radii open the rows by the gradient in the middle, whose effect on the block's
//! unknowns adds up with its signs, and by the gradient's change.
//!
//! Rows and unknowns are scaled as for Newton–Raphson. The inverse is written down for blocks of
//! up to [`MOST_TORN`](super::proof::MOST_TORN) torn unknowns; beyond, an [estimate](super::estimate) takes the place of the
//! proof, and the sub-step is *checked*. So it is while parameters move: how far they change each
//! row is then looked at where the sub-step starts only.
//!
//! [`Constraint::bend`]: crate::kinematics::constraint::Constraint::bend

use super::Coupled;
use super::proof::{LARGEST_CONTRACTION, MOST_TRIES, Proof, ROOM, STRICTLY};
use crate::kinematics::block::work::{Substep, Work};
use crate::kinematics::newton::{Rejected, STALLED};
use crate::kinematics::system::Target;

/// Radii tried first, as a part of the largest move of an unknown: a motion that turns by φ is
/// off its chord by φ²/8 in radians, and rarely by several times that.
const FIRST_RADIUS: f64 = 0.1;
/// The norm of K that the next sub-step aims at.
const GOOD_CONTRACTION: f64 = 0.6;

impl Coupled {
    /// Notes how the bodies stand where the sub-step starts, and what moving parameters leave open
    /// of the rows there. The block's unknowns are there, those found before at their ends.
    pub(super) fn note_start(&mut self, work: &mut Work<'_>, substep: &mut Substep<'_>) {
        let bodies = 3 * work.system.mechanism().bodies.len();
        for &column in &self.block.columns {
            if column < bodies && column % 3 == 2 {
                let frame = &work.at.frames()[column / 3];
                let tube = substep.tubes.body_mut(column / 3);
                (tube.cos, tube.sin) = (frame.cos, frame.sin);
            }
        }
        if substep.tubes.slips().is_none() {
            self.proof.slack.fill(0.0);
            return;
        }
        substep.tubes.checked = true;
        self.proof.note_ends(work);
        for &column in &self.proof.known {
            work.at.set_coordinate(column, substep.from[column]);
        }
        for (slack, &row) in self.proof.slack.iter_mut().zip(&self.block.rows) {
            let equation = &work.system.equations()[row];
            let target = match equation.target {
                Target::Constant(_) => work.system.target(row, work.targets, work.drivers),
                // Drivers have chords of their own.
                Target::Driver(_) => {
                    *slack = 0.0;
                    continue;
                }
            };
            let open = equation.constraint.value(work.at) - target;
            *slack = 2.0 * open.abs() * equation.row_scale(work.at);
        }
        self.proof.put_back(work);
    }

    /// Proves that one motion joins the two ends of a sub-step, and writes its tube.
    ///
    /// # Errors
    ///
    /// There is no such proof.
    pub(super) fn certify(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<(), Rejected> {
        let kept = substep.tubes.boxes
            && (self.certify_in_box(work, substep) || self.certify_in_corridor(work, substep));
        if kept {
            self.write_tubes(work, substep);
            return Ok(());
        }
        self.proof.note_ends(work);
        let tried = if self.proof.inverse.is_empty() {
            self.estimate_radii(work, substep)
        } else {
            self.find_radii(work, substep)
        };
        self.proof.put_back(work);
        for &column in self.block.columns.iter().chain(&self.proof.known) {
            substep.tubes.region[column] = 0.0;
            substep.tubes.chord[column] = 0.0;
        }
        let contraction = match tried {
            Ok(contraction) => contraction,
            Err(None) => return Err(substep.tubes.break_off()),
            Err(Some(contraction)) => {
                let load = (contraction / GOOD_CONTRACTION).powi(2);
                // At least so much that it is no longer borne.
                let refused = substep.tubes.bear(load.max(1.5));
                debug_assert!(refused.is_err());
                return Err(Rejected);
            }
        };
        self.write_tubes(work, substep);
        if substep.tubes.boxes {
            if self.proof.inverse.is_empty() {
                self.lay_corridor(work, substep, contraction);
            } else {
                self.make_box(work, substep, contraction);
            }
        }
        let load = (contraction / GOOD_CONTRACTION).powi(2);
        substep.tubes.bear(load.min(1.0))
    }

    /// Writes chords and the radii of what is known, and goes to the middle. Returns the radii to
    /// be tried first, scaled.
    pub(super) fn lay_chord(&mut self, work: &mut Work<'_>, substep: &mut Substep<'_>) -> f64 {
        let Substep { from, tubes, .. } = substep;
        let size = work.at.size();
        let (mut largest, mut uncertain) = (0.0_f64, 0.0_f64);
        let known = self.proof.known.iter().zip(&mut self.proof.known_radii);
        for (&column, radius) in known {
            let scale = work.system.column_scale(column, size);
            *radius = tubes.radius(column) / scale;
            uncertain = uncertain.max(*radius);
        }
        for &column in self.block.columns.iter().chain(&self.proof.known) {
            let end = work.at.coordinate(column);
            let chord = end - from[column];
            tubes.chord[column] = chord;
            largest = largest.max(chord.abs() / work.system.column_scale(column, size));
        }
        for &column in self.block.columns.iter().chain(&self.proof.known) {
            let middle = from[column] + 0.5 * tubes.chord[column];
            work.at.set_coordinate(column, middle);
        }
        FIRST_RADIUS * largest + 2.0 * uncertain + f64::EPSILON
    }

    /// Looks for radii that pass the test; leaves them as small as they can be had in `next`.
    /// Returns the norm of K for them.
    ///
    /// # Errors
    ///
    /// There are none; with the norm of K, if it is known.
    fn find_radii(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<f64, Option<f64>> {
        let first = self.lay_chord(work, substep);
        self.proof.radii.fill(first);
        self.factorise_middle(work).map_err(|Rejected| None)?;
        let mut last = None;
        for _ in 0..MOST_TRIES {
            self.bend_rows(work, substep).ok_or(last)?;
            self.open_rows();
            let contraction = self.contract(true);
            if contraction.is_nan() {
                return Err(None);
            }
            let proof = &mut self.proof;
            let pairs = || proof.radii.iter().zip(&proof.next);
            if pairs().all(|(radius, next)| *next <= STRICTLY * radius) {
                // What maps a box into a smaller one has its root in the smaller one.
                self.contract(false);
                return Ok(contraction);
            }
            if contraction >= LARGEST_CONTRACTION {
                return Err(Some(contraction));
            }
            last = Some(contraction);
            for (radius, next) in proof.radii.iter_mut().zip(&proof.next) {
                *radius = radius.max(ROOM * next / (1.0 - contraction));
            }
        }
        Err(Some(1.0))
    }

    /// Makes A.
    fn factorise_middle(&mut self, work: &Work<'_>) -> Result<(), Rejected> {
        let Self { block, proof, .. } = self;
        let Proof {
            middle,
            inverse,
            open,
            slack,
            row: unit,
            ..
        } = &mut **proof;
        block.evaluate(work, middle, |local, value| {
            // What rounding left of the rows at both ends.
            open[local] = 2.0 * STALLED * value.rounding;
        });
        for (slack, open) in slack.iter_mut().zip(&*open) {
            *slack += open;
        }
        middle.lu.factorise(0.0).map_err(|_| Rejected)?;
        if !inverse.is_empty() {
            middle.invert(inverse, unit);
        }
        Ok(())
    }

    /// Bounds how the rows bend in the region that the chord and the radii reach.
    fn bend_rows(&mut self, work: &Work<'_>, substep: &mut Substep<'_>) -> Option<()> {
        let Self { block, proof, .. } = self;
        let tubes = &mut *substep.tubes;
        let size = work.at.size();
        let scale = |column: usize| work.system.column_scale(column, size);
        let own = block.columns.iter().zip(&proof.radii);
        let known = proof.known.iter().zip(&proof.known_radii);
        for (&column, radius) in own.chain(known) {
            tubes.region[column] = 0.5 * tubes.chord[column].abs() + radius * scale(column);
        }
        proof.changes.clear();
        for (local, &row) in block.rows.iter().enumerate() {
            let bend = block.bend(local, work, tubes)?;
            let mut open = 0.125 * bend.along;
            if let Target::Driver(driver) = work.system.equations()[row].target {
                open += tubes.drivers[driver.index()] * bend.row_scale;
            }
            for (column, value) in bend.changes() {
                let value = value * scale(column);
                if value == 0.0 {
                } else if let Some(own) = block.own(column) {
                    proof.changes.push((local, own, value));
                } else if let Ok(place) = proof.known.binary_search(&column) {
                    open += value * proof.known_radii[place];
                }
            }
            proof.open[local] = open + proof.slack[local];
        }
        Some(())
    }

    /// η: |A| times what the rows are open by, and what comes from radii of what is known.
    fn open_rows(&mut self) {
        let proof = &mut *self.proof;
        let order = self.block.rows.len();
        let mut eta = std::mem::take(&mut proof.eta);
        eta.fill(0.0);
        proof.apply(&proof.open, &mut eta);
        for (&column, radius) in proof.known.iter().zip(&proof.known_radii) {
            for (eta, a) in eta.iter_mut().zip(proof.inverse.chunks_exact(order)) {
                *eta += proof.middle.turned(a, column).abs() * radius;
            }
        }
        proof.eta = eta;
    }

    /// Writes η + K r to `next`, r being the radii tried or else `next` itself. Returns the norm
    /// of K, weighted by the radii.
    fn contract(&mut self, tried: bool) -> f64 {
        let proof = &mut *self.proof;
        let mut row = std::mem::take(&mut proof.row);
        row.fill(0.0);
        let radii = if tried { &proof.radii } else { &proof.next };
        for &(local, column, value) in &proof.changes {
            row[local] += value * radii[column];
        }
        let mut next = std::mem::take(&mut proof.next);
        next.fill(0.0);
        proof.apply(&row, &mut next);
        let mut contraction = 0.0;
        for ((next, eta), radius) in next.iter_mut().zip(&proof.eta).zip(&proof.radii) {
            let part = *next / radius;
            if part > contraction || part.is_nan() {
                contraction = part;
            }
            *next += eta;
        }
        proof.next = next;
        proof.row = row;
        contraction
    }

    /// Writes the tubes of the block's unknowns. The bodies are back at their ends.
    fn write_tubes(&mut self, work: &Work<'_>, substep: &mut Substep<'_>) {
        let Substep { from, tubes, .. } = substep;
        let bodies = 3 * work.system.mechanism().bodies.len();
        let size = work.at.size();
        for (&column, radius) in self.block.columns.iter().zip(&self.proof.next) {
            let radius = radius * work.system.column_scale(column, size);
            if column >= bodies {
                tubes.set_joint_unknown(column, radius);
                continue;
            }
            match column % 3 {
                2 => {
                    let turn = work.at.coordinate(column) - from[column];
                    let tube = tubes.body_mut(column / 3);
                    (tube.radius, tube.turn) = (radius, turn);
                }
                component => tubes.set_component(column / 3, component, radius),
            }
        }
    }
}
