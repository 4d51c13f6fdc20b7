//! Bodies: discs, bars and plates.

use std::collections::HashSet;

use super::composer::bits;
use super::*;
use biela::mechanism::MarkerId;

/// A body that spans points of its frame. One point is a small disc, two are a bar, more a plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The body.
    pub body: BodyId,
    /// The points \[m\].
    pub points: Vec<[f64; 2]>,
}

/// Composes a body from its markers and the ends of its ways and slots, unless other symbols show
/// all of it.
pub(super) fn compose(composer: &mut Composer, body: BodyId) {
    let spans = std::mem::take(&mut composer.spans[body.index()]);
    let Some(mut points) = outside_plates(composer, body) else {
        return;
    };
    points.extend(spans);
    let mut seen = HashSet::new();
    points.retain(|point| seen.insert(bits(*point)));
    let faces: Vec<_> = (composer.showing(body))
        .filter_map(|symbol| match symbol {
            Symbol::Face(face) => Some(*face),
            _ => None,
        })
        .collect();
    for face in &faces {
        points = face::behind(composer, face, &points);
    }
    let is_shown = composer.showing(body).next().is_some();
    if !is_shown && points.len() <= 1 && !points.contains(&[0.0; 2]) {
        points.push([0.0; 2]);
    }
    let covered = |point: &[f64; 2]| {
        let point = Point::from(*point);
        (composer.showing(body)).any(|symbol| symbol.shape().covers(point))
    };
    let drawn = if faces.is_empty() {
        // A single point of a body with another symbol needs no link.
        !is_shown || points.len() > 1 && !points.iter().all(covered)
    } else {
        !points.is_empty()
    };
    if drawn {
        composer.shown_by[body.index()].push(composer.symbols.len());
        composer.symbols.push(Link { body, points }.into());
    }
}

/// Returns the markers that a link joins; `None` for a body whose plates show all of it. Corners of plates
/// are no joints.
fn outside_plates(composer: &Composer, body: BodyId) -> Option<Vec<[f64; 2]>> {
    let (mechanism, parameters) = (composer.mechanism, composer.parameters());
    let plates = mechanism.shapes_of(Some(body)).map(|(_, shape)| shape);
    let plates: Vec<_> = plates.filter(|shape| shape.is_plate()).collect();
    if plates.is_empty() {
        return Some(composer.positions(Some(body)));
    }
    let markers = mechanism.bodies[body.index()].markers.iter();
    let is_corner = |id: &MarkerId| {
        let outlines = plates.iter().filter(|plate| plate.word() == "outline");
        outlines.flat_map(|plate| plate.markers()).any(|own| own == *id)
    };
    let joints: Vec<MarkerId> = markers.copied().filter(|id| !is_corner(id)).collect();
    let points: Vec<[f64; 2]> = joints.iter().map(|id| composer.anchor(*id).position).collect();
    let covered = |(id, point): (&MarkerId, &[f64; 2])| {
        plates.iter().any(|plate| {
            plate.markers().any(|own| own == *id) || mechanism.covers(plate, *point, parameters)
        })
    };
    (!joints.iter().zip(&points).all(covered)).then_some(points)
}

impl Link {
    /// Returns the corners of the points' convex hull, counter-clockwise \[m\].
    #[must_use]
    pub fn hull(&self) -> Vec<[f64; 2]> {
        let points: Vec<Point> = self.points.iter().map(|&p| p.into()).collect();
        convex_hull(&points).into_iter().map(Into::into).collect()
    }
}

impl Shape for Link {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::Body(self.body));
        let colour = Colour::of_body(self.body.index());
        let mut corners: Vec<Point> = self
            .points
            .iter()
            .map(|&position| pen.place(Anchor::on_body(self.body, position)).0)
            .collect();
        let mut half = BAR;
        let is_fitted = |shape: &&&dyn Shape| shape.fitted() == Some(self.body);
        for shape in pen.fitting.iter().filter(is_fitted) {
            half = shape.fit(pen, &mut corners).unwrap_or(half);
        }
        let hull = convex_hull(&corners);
        let (layer, opacity) = if hull.len() > 2 {
            (Layer::Plate, 0.25)
        } else {
            (Layer::Bar, 0.45)
        };
        let outline = Outline::around(&hull, half);
        pen.area(layer, outline, (colour, opacity), Some(colour));
        pen.offer(Some(self.body), places(&hull));
    }

    fn extent(&self) -> Vec<Disc> {
        let points = self.points.iter();
        points
            .map(|&p| Anchor::on_body(self.body, p).into())
            .collect()
    }

    fn shows(&self) -> Option<BodyId> {
        Some(self.body)
    }
}

/// Returns places for a body's name along the edges of its hull, and inside a large one.
pub(super) fn places(hull: &[Point]) -> Vec<Candidate> {
    let center = hull.iter().sum::<Point>() / hull.len() as f64;
    if hull.len() == 1 {
        return Candidate::around(center, BAR).collect();
    }
    let mut places = Vec::new();
    if hull.len() > 2 {
        places.push(Candidate {
            anchor: center,
            side: None,
            gap: 0.0,
            cost: 0.0,
        });
    }
    for corner in hull {
        // Several bodies meet there: the name could be the name of any of them.
        places.extend(Candidate::around(*corner, BAR + 1.0).map(|place| place.costlier(10.0)));
    }
    let parts = [
        (0.5, 1.0),
        (0.38, 2.0),
        (0.62, 2.0),
        (0.26, 3.0),
        (0.74, 3.0),
        (0.14, 5.0),
        (0.86, 5.0),
    ];
    let gaps = [(5.0, 0.0), (13.0, 5.0), (24.0, 12.0)].map(|(gap, cost)| (BAR + gap, cost));
    for (index, start) in hull.iter().enumerate() {
        let end = hull[(index + 1) % hull.len()];
        let normal = across(unit(end - start));
        // Outside: away from the middle of the hull. A bar has both sides, one of them as its
        // edge back.
        let middle = 0.5 * (start + end);
        let out = if hull.len() > 2 && normal.dot(&(middle - center)) < 0.0 {
            -normal
        } else {
            normal
        };
        places.extend(Candidate::beside(
            [*start, end],
            &parts,
            &[(out, 0.0)],
            &gaps,
        ));
    }
    places
}
