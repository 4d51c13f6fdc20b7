//! Fixtures that hold pivots on ground.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

use super::composer::bits;
use super::*;

/// The fixture of a pivot on ground; it lies in the direction of the anchor's x-axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixture {
    /// The pivot, on ground.
    pub at: Anchor,
}

/// Directions of a fixture, best first: below its pivot, above, left, right.
const DIRECTIONS: [f64; 4] = [-FRAC_PI_2, FRAC_PI_2, PI, 0.0];
/// Cosine of 60°: a body at this angle or more from a fixture's direction leaves it room.
const ROOM: f64 = 0.5;
/// Height and half the base of the triangle.
const TRIANGLE: [f64; 2] = [17.0, 11.0];
/// Length of the hatched line beyond the triangle.
const BEYOND: f64 = 6.0;

/// Composes one fixture per point of ground that holds a body, where the bodies leave room.
pub(super) fn compose(composer: &mut Composer) {
    let mut index_at = HashMap::new();
    let mut pivots: Vec<(Anchor, Vec<BodyId>)> = Vec::new();
    for (at, body) in std::mem::take(&mut composer.pivots) {
        let index = *index_at.entry(bits(at.position)).or_insert(pivots.len());
        if index == pivots.len() {
            pivots.push((at, Vec::new()));
        }
        pivots[index].1.extend(body);
    }
    for (at, held) in pivots {
        let leaving: Vec<f64> = held
            .into_iter()
            .flat_map(|body| directions_from(composer, at, body))
            .collect();
        let crowded = |fixture: f64| {
            let nearest = leaving.iter().map(|leaving| (leaving - fixture).cos());
            nearest.fold(-1.0, f64::max)
        };
        let mut best = DIRECTIONS[0];
        for direction in DIRECTIONS {
            // Rounding decides between none of the four.
            if crowded(best) > ROOM && crowded(direction) < crowded(best) - 1e-6 {
                best = direction;
            }
        }
        let at = at.turned_to(best);
        composer.symbols.push(Fixture { at }.into());
    }
}

/// Returns the directions in which a body reaches away from a point on ground.
fn directions_from(composer: &Composer, at: Anchor, body: BodyId) -> Vec<f64> {
    let points = composer.showing(body).find_map(|symbol| match symbol {
        Symbol::Link(link) => Some(&link.points),
        _ => None,
    });
    let offsets = points.into_iter().flatten().map(|&position| {
        let point = Anchor::on_body(body, position).placed(composer.q).point;
        point - Point::from(at.position)
    });
    let offsets: Vec<Point> = offsets.collect();
    let largest = offsets.iter().fold(0.0, |l: f64, o| l.max(o.norm()));
    let away = |offset: &&Point| offset.norm() > 1e-6 * largest;
    offsets.iter().filter(away).map(|o| angle(*o)).collect()
}

impl Shape for Fixture {
    fn draw(&self, pen: &mut Pen) {
        let (pivot, down, _) = pen.on(self.at);
        let [height, half] = TRIANGLE;
        let (foot, aside) = (pivot + height * down, across(down));
        let corners = [pivot, foot + half * aside, foot - half * aside];
        pen.area(
            Layer::Ground,
            Outline::polygon(&corners),
            (Colour::GROUND.tint(0.15), 1.0),
            Some(Colour::GROUND),
        );
        let reach = (half + BEYOND) * aside;
        pen.hatched([foot - reach, foot + reach], down);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
