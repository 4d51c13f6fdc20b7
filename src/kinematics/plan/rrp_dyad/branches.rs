//! The branches of the block, and its nearest pose where it has none.

use std::f64::consts::PI;

use super::RrpDyad;
use crate::kinematics::constraint::configuration::{BodyPose, on_nearest_turn};
use crate::kinematics::plan::reach::ClosureGap;
use crate::kinematics::plan::step::BlockState;

impl RrpDyad {
    /// Returns the two angles of body a at which the block closes, nearest the estimates first: the
    /// minima of Eq. 3.6.9 for r → ∞, where a circle intersects a line. Moves the bodies.
    ///
    /// # Errors
    ///
    /// [`ClosureGap`] if circle and line do not meet.
    pub(super) fn angles(
        &self,
        state: &mut BlockState<'_>,
        estimate: &[f64],
    ) -> Result<[f64; 2], ClosureGap> {
        let known = self.known(state);
        let scale = known.w.norm() * known.g.norm();
        let gap = ClosureGap::new(known.kappa.abs() - scale, known.reach + scale);
        let ratio = -known.kappa / scale;
        if gap.certain || ratio.is_nan() {
            return Err(gap);
        }
        let size = state.at.size();
        let middle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x);
        // A gap within rounding is left to the corrections.
        let away = ratio.clamp(-1.0, 1.0).acos();
        let guess = estimate[3 * self.body as usize + 2];
        let branches = [middle + away, middle - away].map(|angle| {
            let phi = on_nearest_turn(angle, guess);
            self.put(state.at.frames_mut(), &known, BodyPose::turned(phi));
            let columns = self.parts.columns.iter();
            let distance = columns
                .map(|&column| {
                    let off = state.at.coordinate(column) - estimate[column];
                    (off / state.system.column_scale(column, size)).powi(2)
                })
                .sum::<f64>();
            (distance, phi)
        });
        // The first of two that are equally far.
        let [first, second] = branches;
        if second.0 < first.0 * (1.0 - 1e-9) {
            Ok([second.1, first.1])
        } else {
            Ok([first.1, second.1])
        }
    }

    /// Puts the bodies where the gap is least, if the point does not reach its line.
    pub(super) fn stretch_to_line(&self, state: &mut BlockState<'_>, estimate: &[f64]) {
        let known = self.known(state);
        let away = if known.kappa > 0.0 { PI } else { 0.0 };
        let angle = known.w.y.atan2(known.w.x) - known.g.y.atan2(known.g.x) + away;
        let guess = estimate[3 * self.body as usize + 2];
        let phi = on_nearest_turn(angle, guess);
        self.put(state.at.frames_mut(), &known, BodyPose::turned(phi));
    }
}
