//! Stops: hatched lines that the moving body meets at the limits of a coordinate.

use std::f64::consts::FRAC_PI_2;

use super::*;
use biela::mechanism::{CoordinateKind, Stop};

/// The limits of a coordinate between two markers.
#[derive(Clone, Debug, PartialEq)]
pub struct EndStop {
    /// Marker i, about which an angle turns.
    pub from: Anchor,
    /// Marker j.
    pub to: Anchor,
    /// Axis along which a length is measured, `None` for an angle.
    pub axis: Option<Anchor>,
    /// Least and largest value \[m or rad\], with the point of the body of j that meets the stop.
    pub limits: [Option<(f64, Anchor)>; 2],
}

/// Distances of the ends of a line at the limit of an angle from its point, beyond the arrow of a driver.
const RADII: [f64; 2] = [30.0, 50.0];
/// Half the length of a line at the limit of a length.
const HALF: f64 = 14.0;

/// Composes a stop of an angle or of a length along an axis: a distance turns, and shapes show their
/// contact.
pub(super) fn compose(composer: &mut Composer, stop: &Stop) {
    let coordinate = &stop.coordinate;
    let axis = composer.axis(coordinate);
    if axis.is_none() && coordinate.kind != CoordinateKind::Angle {
        return;
    }
    let [from, to] = [coordinate.from, coordinate.to].map(|marker| composer.anchor(marker));
    let origin = from.placed(composer.q).point;
    let limit = |limit: &Option<Expression>, outwards: f64| {
        // The marker that is farthest ahead, or farthest from the point about which its body turns.
        let ahead = |point: &Anchor| {
            let from_origin = point.placed(composer.q).point - origin;
            axis.map_or_else(
                || from_origin.norm(),
                |axis| outwards * direction(axis.placed(composer.q).angle).dot(&from_origin),
            )
        };
        let points = composer.positions(to.body).into_iter();
        let points = points.map(|position| to.moved_to(position));
        let front = points.fold(to, |most, point| {
            if ahead(&point) > ahead(&most) { point } else { most }
        });
        limit.as_ref().map(|limit| (composer.value(limit), front))
    };
    let limits = [limit(&stop.min, -1.0), limit(&stop.max, 1.0)];
    composer.add(EndStop {
        from,
        to,
        axis,
        limits,
    });
}

impl Shape for EndStop {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::of(self.from));
        let [from, to] = [self.from, self.to].map(|marker| marker.placed(pen.q));
        let origin = pen.on_sheet(from.point);
        for (limit, outwards) in self.limits.into_iter().zip([-1.0, 1.0]) {
            let Some((limit, front)) = limit else {
                continue;
            };
            let front = front.placed(pen.q).point;
            if let Some(axis) = self.axis {
                let along = direction(axis.placed(pen.q).angle);
                let way = limit - along.dot(&(to.point - from.point));
                let foot = pen.on_sheet(front + way * along);
                let (_, along) = pen.place(axis);
                let side = HALF * across(along);
                pen.hatched([foot - side, foot + side], outwards * along);
            } else {
                let arm = front - from.point;
                let towards = if arm.norm() > 0.0 { angle(arm) } else { to.angle };
                let limit = towards + limit - (to.angle - from.angle);
                let along = on_sheet_direction(limit);
                let away = on_sheet_direction(limit + outwards * FRAC_PI_2);
                pen.hatched(RADII.map(|radius| origin + radius * along), away);
            }
        }
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.from.into()]
    }
}
