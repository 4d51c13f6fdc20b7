//! The numbers of the block that follow from the parameters.

use nalgebra::Vector2;

use super::{Line, Point, RrpDyad, Second};
use crate::kinematics::certificate::Pivots;
use crate::kinematics::constraint::configuration::{self, BodyPose, Configuration, perp};
use crate::kinematics::constraint::{Axis, Projection};
use crate::kinematics::system::Targets;

impl RrpDyad {
    /// Takes over all that depends on the parameters alone.
    pub(super) fn take_over_parameters(
        &mut self,
        at: &Configuration,
        targets: &Targets,
        pivots: &mut Pivots,
    ) {
        let parts = &self.parts;
        self.anchor.set_parameters(at, pivots, parts.anchor);
        self.s = at.local(parts.pin).0;
        pivots.set(parts.body, self.s);
        let mut between = BodyPose::turned(0.0);
        let mut inner = Vector2::zeros();
        if let Some(b) = &parts.second {
            let offset = at.local(b.reference).1 - at.local(b.angle).1;
            inner = at.local(b.pin).0;
            pivots.set(b.body, inner);
            match &mut self.second {
                Second::None => {}
                Second::Carried { zero, l, s, .. } => {
                    *zero = offset;
                    *l = at.local(b.partner).0 - self.s;
                    *s = inner;
                }
                Second::Parallel {
                    anchor, zero, s, ..
                } => {
                    anchor.set_parameters(at, pivots, b.partner);
                    *zero = offset;
                    *s = inner;
                    // Without whole turns: they do not belong to the parameters.
                    between = BodyPose::turned(offset + b.sense * targets.constant(b.row));
                }
            }
        }
        let Projection {
            from,
            to,
            axes,
            axis,
        } = parts.projection;
        for (point, marker) in self.points.iter_mut().zip([from, to]) {
            let s = at.local(marker).0;
            match point {
                Point::Known(anchor) => anchor.set_parameters(at, pivots, marker),
                Point::First(arm) => *arm = s - self.s,
                Point::Carried(arm) => *arm = s - inner,
                Point::Parallel(arm) => *arm = between.rotate(s - inner),
            }
        }
        let u = configuration::axis(at.local(axes).1);
        let direction = match axis {
            Axis::X => u,
            Axis::Y => perp(u),
        };
        let on_second = parts.second.as_ref().is_some_and(|b| {
            at.marker(axes)
                .body
                .is_some_and(|body| body.index() == b.body)
        });
        match &mut self.axis {
            Line::Known(_, e) | Line::Carried(e) => *e = direction,
            Line::Turning(e) if on_second => *e = between.rotate(direction),
            Line::Turning(e) => *e = direction,
        }
    }
}
