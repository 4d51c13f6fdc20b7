//! Lengths of bodies, and of ground, between their joints, and offsets of guides.

use super::joint_letter::{JointPlace, are_one};
use super::*;
use biela::mechanism::{DisplayUnit, rounded, shown};

/// The length between two points of a body, or of ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// The points; those of a link without mass, and of the line of a guide, are on two bodies.
    pub ends: [Anchor; 2],
    /// The length in the file's unit, empty for a line alone.
    pub text: String,
    /// The body, `None` for ground and for links without mass.
    pub body: Option<BodyId>,
}

/// Composes the lengths of all bodies and of ground. Returns the note on their unit.
pub(super) fn compose(composer: &mut Composer, places: &[JointPlace]) -> Vec<String> {
    let unit = composer.mechanism.length_display();
    let bodies = (0..composer.mechanism.bodies.len()).map(|body| Some(BodyId(body)));
    let mut lengths: Vec<Dimension> = Vec::new();
    for body in std::iter::once(None).chain(bodies) {
        let outputs = composer.mechanism.outputs.markers.iter();
        let outputs = outputs.map(|marker| composer.anchor(*marker));
        let joints = places.iter().flat_map(|place| place.points.iter().copied());
        let mut points: Vec<Anchor> = Vec::new();
        for point in joints.chain(outputs).filter(|point| point.body == body) {
            if !points.iter().any(|known| are_one(known, &point)) {
                points.push(point);
            }
        }
        let at: Vec<Point> = points.iter().map(|p| Point::from(p.position)).collect();
        lengths.extend(triangulation(&at).into_iter().map(|[a, b]| Dimension {
            ends: [points[a], points[b]],
            text: told((at[a] - at[b]).norm(), unit),
            body,
        }));
    }
    for joint in &composer.mechanism.joints {
        let ends = [joint.from, joint.to].map(|marker| composer.anchor(marker));
        if let Some(length) = joint.rod() {
            lengths.push(Dimension {
                ends,
                text: told(composer.value(length), unit),
                body: None,
            });
        }
        if let Some(guide) = joint.guide() {
            let aside = guide.aside.map_or(0.0, |aside| composer.value(aside));
            lengths.extend(offset(composer, places, ends, aside));
        }
    }
    if lengths.is_empty() {
        return Vec::new();
    }
    composer.symbols.extend(lengths.into_iter().map(Into::into));
    vec![format!("lengths in {}", unit.unwrap_or(DisplayUnit::METRE).name)]
}

/// Returns the distance of a guide's line, `aside` of its x-axis, from the nearest joint of its body,
/// and this line as far as the point that slides; nothing if the line passes through the joint.
fn offset(
    composer: &Composer,
    places: &[JointPlace],
    [guide, sliding]: [Anchor; 2],
    aside: f64,
) -> Vec<Dimension> {
    let normal = across(direction(guide.angle));
    let line = guide.moved_to((guide.on_axis(0.0) + aside * normal).into());
    let points = places.iter().flat_map(|place| &place.points);
    let nearest = (points.filter(|point| point.body == guide.body))
        .map(|point| line.coordinates(point.position.into()))
        .min_by(|[_, a], [_, b]| a.abs().total_cmp(&b.abs()));
    // Far more than rounding, far less than any length of a part.
    let is_offset = |&[along, away]: &[f64; 2]| away.abs() > 1e-6 * along.hypot(aside);
    let Some([along, away]) = nearest.filter(is_offset) else {
        return Vec::new();
    };
    let foot = line.moved_to(line.on_axis(along).into());
    let joint = line.moved_to((line.on_axis(along) + away * normal).into());
    vec![
        Dimension {
            ends: [joint, foot],
            text: told(away.abs(), composer.mechanism.length_display()),
            body: guide.body,
        },
        Dimension {
            ends: [foot, sliding],
            text: String::new(),
            body: None,
        },
    ]
}

/// Returns a length with five digits in a unit.
pub(super) fn told(length: f64, unit: Option<DisplayUnit>) -> String {
    shown(rounded(length * unit.map_or(1.0, |unit| unit.factor), 5))
}

/// Returns the pairs of points whose distances are told: the shortest first, none across a shorter
/// one, nor along a line that another point divides. Of three points in a triangle these are all.
fn triangulation(points: &[Point]) -> Vec<[usize; 2]> {
    let length = |[a, b]: [usize; 2]| (points[b] - points[a]).norm();
    let mut pairs: Vec<[usize; 2]> = (0..points.len())
        .flat_map(|b| (0..b).map(move |a| [a, b]))
        .collect();
    pairs.sort_by(|p, q| length(*p).total_cmp(&length(*q)));
    let mut chosen: Vec<[usize; 2]> = Vec::new();
    for pair in pairs {
        let [a, b] = pair.map(|k| points[k]);
        let along = unit(b - a);
        let near = 1e-6 * length(pair);
        let divides = |p: &Point| {
            let (s, aside) = ((p - a).dot(&along), (p - a).perp(&along));
            aside.abs() <= near && s > near && s < length(pair) - near
        };
        let crosses = |other: &[usize; 2]| {
            let [c, d] = other.map(|k| points[k]);
            let side = |p: Point| (p - a).perp(&along);
            let other_side = |p: Point| (p - c).perp(&unit(d - c));
            let is_apart = |s: f64, t: f64| s.abs() > near && t.abs() > near && s * t < 0.0;
            is_apart(side(c), side(d)) && is_apart(other_side(a), other_side(b))
        };
        if !points.iter().any(divides) && !chosen.iter().any(crosses) {
            chosen.push(pair);
        }
    }
    chosen
}

impl Shape for Dimension {
    fn draw(&self, pen: &mut Pen) {
        let ends = self.ends.map(|end| pen.place(end).0);
        pen.attach(Attachment::between(self.ends));
        let colour = colour_of(self.body).shade(0.7);
        let line = Outline::line(&ends);
        // A body has its own outline; ground has none.
        let dashes = if self.body.is_none() { DASH_DOTS } else { &[] };
        pen.dashed(Layer::Dimension, line, colour, THIN, dashes);
        let parts = [
            (0.5, 0.0),
            (0.4, 1.0),
            (0.6, 1.0),
            (0.3, 2.0),
            (0.7, 2.0),
            (0.2, 4.0),
            (0.8, 4.0),
        ];
        let normal = across(unit(ends[1] - ends[0]));
        let sides = [(normal, 0.0), (-normal, 0.0)];
        let gaps = [
            (3.0, 0.0),
            (BAR + 3.0, 1.0),
            (BAR + 12.0, 5.0),
            (BAR + 24.0, 12.0),
        ];
        let places = Candidate::beside(ends, &parts, &sides, &gaps);
        if !self.text.is_empty() {
            let colour = colour_of(self.body).shade(NAME);
            pen.label(Named::Length, &self.text, colour, places);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        self.ends.map(Disc::from).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_whole_and_lines_are_divided() {
        let of = |points: &[[f64; 2]]| {
            let points: Vec<Point> = points.iter().map(|&p| p.into()).collect();
            let mut pairs = triangulation(&points);
            pairs.sort_unstable();
            pairs
        };
        assert!(of(&[]).is_empty() && of(&[[1.0, 2.0]]).is_empty());
        assert_eq!(of(&[[0.0, 0.0], [3.0, 4.0]]), [[0, 1]]);
        let triangle = [[0.0, 0.0], [4.0, 0.0], [1.0, 2.0]];
        assert_eq!(of(&triangle), [[0, 1], [0, 2], [1, 2]]);
        // The middle point divides the line of the others.
        assert_eq!(of(&[[0.0, 0.0], [4.0, 2.0], [2.0, 1.0]]), [[0, 2], [1, 2]]);
        // The shorter diagonal of a quadrilateral stays: 2 n - 3 lengths fix n points.
        let kite = [[0.0, 0.0], [5.0, -1.0], [9.0, 0.0], [5.0, 1.0]];
        assert_eq!(of(&kite), [[0, 1], [0, 3], [1, 2], [1, 3], [2, 3]]);
    }
}
