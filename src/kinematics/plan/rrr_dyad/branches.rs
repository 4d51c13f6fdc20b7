//! The branches of the block, and its nearest pose where it has none.

use nalgebra::Vector2;

use super::{RrrDyad, Side};
use crate::kinematics::constraint::configuration::{BodyPose, on_nearest_turn, perp, rotate};
use crate::kinematics::plan::reach::ClosureGap;
use crate::kinematics::plan::step::BlockState;

impl Side {
    /// Returns the angle at which its link points along `direction`, on the turn nearest to
    /// `guess`.
    fn turned_along(&self, direction: Vector2<f64>, guess: f64) -> f64 {
        let angle = direction.y.atan2(direction.x) - self.l.y.atan2(self.l.x);
        on_nearest_turn(angle, guess)
    }
}

impl RrrDyad {
    /// Returns the two pairs of angles at which the loop closes: the minima of Eq. 3.6.9 for r → ∞,
    /// where two circles intersect; the pair nearest the estimates first.
    ///
    /// # Errors
    ///
    /// [`ClosureGap`] if the circles do not meet.
    pub(super) fn angles(
        &self,
        state: &BlockState<'_>,
        estimate: &[f64],
    ) -> Result<[[f64; 2]; 2], ClosureGap> {
        let reach = self.reach(state);
        let gap = ClosureGap::new(reach.gap(), reach.distance + reach.longest);
        if gap.certain {
            return Err(gap);
        }
        let size = state.at.size();
        let mut branches = [(0.0, [0.0; 2]); 2];
        for (branch, side) in branches.iter_mut().zip([1.0, -1.0]) {
            let Some(links) = self.meet(state, estimate, side) else {
                return Err(gap);
            };
            for (k, side) in self.sides.iter().enumerate() {
                let column = 3 * side.body as usize;
                let guess = &estimate[column..column + 3];
                let scale = state.system.column_scale(column, size);
                let phi = side.turned_along(links[k], guess[2]);
                let point = side.anchor.point(state.at.frames());
                let (sin, cos) = phi.sin_cos();
                let origin = point - rotate(cos, sin, side.s);
                branch.0 += ((origin.x - guess[0]) / scale).powi(2)
                    + ((origin.y - guess[1]) / scale).powi(2)
                    + (phi - guess[2]).powi(2);
                branch.1[k] = phi;
            }
        }
        // The first of two that are equally far.
        if branches[1].0 < branches[0].0 * (1.0 - 1e-9) {
            branches.swap(0, 1);
        }
        Ok(branches.map(|(_, phi)| phi))
    }

    /// Puts links that do not reach each other in line, where the gap is least, with all of the
    /// gap in the joint declared last.
    pub(super) fn put_in_line(&self, state: &mut BlockState<'_>, estimate: &[f64]) {
        let [a, b] = &self.sides;
        let frames = state.at.frames_mut();
        let (point_a, point_b) = (a.anchor.point(frames), b.anchor.point(frames));
        let span = point_b - point_a;
        let distance = span.norm();
        let e = if distance > 0.0 {
            span / distance
        } else {
            let (sin, cos) = estimate[3 * a.body as usize + 2].sin_cos();
            Vector2::new(cos, sin)
        };
        // Both links span too large a distance; in too small a one the longer link overshoots.
        let (along_a, along_b) = if distance > a.length + b.length {
            (e, -e)
        } else if a.length > b.length {
            (e, e)
        } else {
            (-e, -e)
        };
        let turned = |side: &Side, along| {
            let guess = estimate[3 * side.body as usize + 2];
            BodyPose::turned(side.turned_along(along, guess))
        };
        let (frame_a, frame_b) = (turned(a, along_a), turned(b, along_b));
        let rows = &self.parts.rows;
        let last = (0..6).max_by_key(|&k| rows[k]).map_or(0, |k| k / 2);
        let (end_a, end_b) = (frame_a.rotate(a.l), frame_b.rotate(b.l));
        let outer_a = if last == 0 {
            point_b + end_b - end_a
        } else {
            point_a
        };
        let outer_b = if last == 1 {
            point_a + end_a - end_b
        } else {
            point_b
        };
        frames[a.body as usize] = BodyPose {
            origin: outer_a - frame_a.rotate(a.s),
            ..frame_a
        };
        frames[b.body as usize] = BodyPose {
            origin: outer_b - frame_b.rotate(b.s),
            ..frame_b
        };
    }

    /// Returns d_a and d_b where the links meet, on one side of the line between the anchors.
    fn meet(
        &self,
        state: &BlockState<'_>,
        estimate: &[f64],
        side: f64,
    ) -> Option<[Vector2<f64>; 2]> {
        let [a, b] = &self.sides;
        let frames = state.at.frames();
        let span = b
            .anchor
            .split_point(frames)
            .from(a.anchor.split_point(frames));
        let distance = span.norm();
        let along = 0.5 * (distance + (a.length - b.length) * (a.length + b.length) / distance);
        // Negative where the links miss by rounding; the corrections decide.
        let across = (a.length - along) * (a.length + along);
        let link = if distance > 0.0 {
            let e = span / distance;
            e * along + perp(e) * (side * across.max(0.0).sqrt())
        } else {
            // Any direction will do where the anchors coincide.
            let (sin, cos) = estimate[3 * a.body as usize + 2].sin_cos();
            rotate(cos, sin, a.l)
        };
        let links = [link, link - span];
        links.iter().all(|l| l.sum().is_finite()).then_some(links)
    }
}
