//! The ways in which a slide closes, and how near it comes where it does not.

use std::f64::consts::{PI, TAU};

use super::RrpDyad;
use crate::kinematics::block::Work;
use crate::kinematics::block::reach::Miss;
use crate::kinematics::configuration::BodyPose;

impl RrpDyad {
    /// The angles of body a at which it closes, nearest the estimates first: the minima of
    /// Ec. 3.6.9 for r → ∞, which a circle and a line have in two places. Leaves the bodies
    /// anywhere.
    ///
    /// # Errors
    ///
    /// [`Miss`] if they do not reach each other.
    pub(in crate::kinematics) fn ways(
        &self,
        work: &mut Work<'_>,
        estimate: &[f64],
    ) -> Result<[f64; 2], Miss> {
        let known = self.known(work);
        let scale = known.w.norm() * known.g.norm();
        let miss = Miss::new(known.kappa.abs() - scale, known.reach + scale);
        let ratio = -known.kappa / scale;
        if miss.certain || ratio.is_nan() {
            return Err(miss);
        }
        let size = work.at.size();
        let middle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x);
        // A gap that no one could measure is left to the corrections.
        let away = ratio.clamp(-1.0, 1.0).acos();
        let guess = estimate[3 * self.place as usize + 2];
        let ways = [middle + away, middle - away].map(|angle| {
            let phi = angle + TAU * ((guess - angle) / TAU).round();
            self.put(work.at.frames_mut(), &known, BodyPose::turned(phi));
            let columns = self.parts.columns.iter();
            let distance = columns
                .map(|&column| {
                    let off = work.at.coordinate(column) - estimate[column];
                    (off / work.system.column_scale(column, size)).powi(2)
                })
                .sum::<f64>();
            (distance, phi)
        });
        // The first of two that are equally far.
        let [first, second] = ways;
        if second.0 < first.0 * (1.0 - 1e-9) {
            Ok([second.1, first.1])
        } else {
            Ok([first.1, second.1])
        }
    }

    /// Puts the bodies as near to closing as they come, where the point does not reach its line.
    pub(in crate::kinematics) fn stretch(&self, work: &mut Work<'_>, estimate: &[f64]) {
        let known = self.known(work);
        let away = if known.kappa > 0.0 { PI } else { 0.0 };
        let angle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x) + away;
        let guess = estimate[3 * self.place as usize + 2];
        let phi = angle + TAU * ((guess - angle) / TAU).round();
        self.put(work.at.frames_mut(), &known, BodyPose::turned(phi));
    }
}
