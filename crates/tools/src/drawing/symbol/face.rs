//! Faces of flat-faced cam followers.

use super::*;

/// The face of a flat-faced follower along the x-axis of an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Origin and axis.
    pub along: Anchor,
    /// The part of the axis that is used \[m\].
    pub range: [f64; 2],
    /// Whether the cam is on the side of the anchor's y-axis.
    pub above: bool,
}

/// Length of the face beyond the contact, as a part of the length over which contact moves.
const END: f64 = 0.25;
/// Thickness of the follower, and of the line that is its face.
const DEPTH: [f64; 2] = [10.0, 3.0];

/// Composes the face of a follower.
pub(super) fn compose(
    composer: &mut Composer,
    follower: Anchor,
    cam: Anchor,
    contour: &[[f64; 2]],
) {
    let [_, aside] = composer.coordinates(follower, cam);
    let above = aside > 0.0;
    composer.add(Face {
        along: follower,
        range: range(composer, follower, cam, above, contour),
        above,
    });
}

/// Returns the part of a face that is used: where the contour reaches farthest towards it over
/// the motion, and the markers of its body on it \[m\].
fn range(
    composer: &Composer,
    face: Anchor,
    cam: Anchor,
    above: bool,
    contour: &[[f64; 2]],
) -> [f64; 2] {
    let contacts = composer.poses().filter_map(|q| {
        let (face, cam) = (face.placed(q), Anchor::origin(cam.body).placed(q));
        // The axes of the face in the cam's frame.
        let axis = direction(face.angle - cam.angle);
        let outwards = across(axis) * if above { -1.0 } else { 1.0 };
        let points = contour.iter().map(|&p| Point::from(p));
        let contact = points.max_by(|a, b| outwards.dot(a).total_cmp(&outwards.dot(b)))?;
        let origin = direction(face.angle).dot(&(face.point - cam.point));
        Some(axis.dot(&contact) - origin)
    });
    let [low, high] = extremes(contacts);
    let end = END * (high - low);
    composer.with_markers(face, [low - end, high + end])
}

/// Returns the points of a flat-faced follower besides its face: its points off the face, its
/// pivots on the face, and the point where the face carries these.
pub(super) fn behind(composer: &Composer, face: &Face, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let Face { along, range, .. } = *face;
    let is_pivot = |position: &[f64; 2]| {
        let point = along.moved_to(*position);
        composer.mechanism.joints.iter().any(|joint| {
            let ends = [joint.from, joint.to].map(|marker| composer.anchor(marker));
            (joint.is_pin() || joint.rod().is_some())
                && ends
                    .iter()
                    .any(|end| end.body == along.body && end.is_at(&point))
        })
    };
    let on_face = |point: &[f64; 2]| along.has_on_axis(range, Point::from(*point));
    let (on, behind): (Vec<[f64; 2]>, Vec<[f64; 2]>) = points.iter().partition(|p| on_face(p));
    let mut kept: Vec<_> = on.into_iter().filter(is_pivot).collect();
    if !behind.is_empty() {
        let sum: Point = behind.iter().map(|&p| Point::from(p)).sum();
        let [s, _] = along.coordinates(sum / behind.len() as f64);
        kept.push(along.on_axis(s.clamp(range[0], range[1])).into());
        kept.extend(behind);
    }
    kept
}

impl Face {
    /// Returns the direction on the sheet from the face into the follower, away from the cam.
    fn back(&self, pen: &Pen) -> Point {
        let (_, axis) = pen.place(self.along);
        // On the sheet y points down.
        if self.above {
            across(axis)
        } else {
            -across(axis)
        }
    }
}

impl Shape for Face {
    fn draw(&self, pen: &mut Pen) {
        let (_, axis, colour) = pen.on(self.along);
        let [start, end] = pen.ends(self.along, self.range);
        let [start, end] = [start - BAR * axis, end + BAR * axis];
        let back = self.back(pen);
        let depth = DEPTH[0] * back;
        let outline = Outline::polygon(&[start, end, end + depth, start + depth]);
        pen.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
        let face = Outline::line(&[start, end]);
        pen.line(Layer::Slot, face, colour.shade(0.8), DEPTH[1]);
        pen.offer_beside(self.along.body, [start + depth, end + depth], back);
    }

    fn extent(&self) -> Vec<Disc> {
        self.along.part(self.range).map(Disc::from).to_vec()
    }

    fn shows(&self) -> Option<BodyId> {
        self.along.body
    }

    fn covers(&self, point: Point) -> bool {
        self.along.has_on_axis(self.range, point)
    }

    fn fitted(&self) -> Option<BodyId> {
        self.along.body
    }

    /// Moves the corners of the body that are on the face to the back of the face. A body that is
    /// only a pivot there stays around it.
    fn fit(&self, pen: &Pen, corners: &mut Vec<Point>) -> Option<f64> {
        if corners.len() > 1 {
            let (origin, _) = pen.place(self.along);
            let back = self.back(pen);
            for corner in corners {
                // Far less than can be seen, far more than rounding.
                if back.dot(&(*corner - origin)).abs() < 1e-3 {
                    *corner += DEPTH[0] * back;
                }
            }
        }
        None
    }
}
