//! Instant centres of bodies and ground.

use super::*;
use biela::kinematics::InstantCentre;
use biela::mechanism::{DisplayUnit, rounded, shown};

/// The instant centre of bodies that share it.
#[derive(Clone, Debug, PartialEq)]
pub struct InstantCentreMark {
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// The point, on ground.
    pub at: Anchor,
}

/// Half the size of the mark.
const HALF: f64 = 5.5;
/// Room for instant centres around a mechanism, as a part of its size: a farther one would make the
/// mechanism too small to see.
const ROOM: f64 = 1.0;

/// Composes the instant centres of bodies, in their order, about the symbols of a mechanism at q.
/// Returns sentences about those that are not drawn.
pub(in crate::drawing) fn compose(
    symbols: &[Symbol],
    bodies: &[String],
    centres: &[InstantCentre],
    q: &[f64],
    unit: Option<DisplayUnit>,
) -> (Vec<Symbol>, Vec<String>) {
    let Bounds { low, high } = bounds(symbols, q);
    let size = (high - low).max();
    let room = Point::repeat(ROOM * size);
    let [low, high] = [low - room, high + room];
    let mut marks: Vec<InstantCentreMark> = Vec::new();
    let mut notes = Vec::new();
    let (mut translating, mut resting) = (Vec::new(), Vec::new());
    for (name, centre) in bodies.iter().zip(centres) {
        let at = match *centre {
            InstantCentre::At(at) => at,
            InstantCentre::AtInfinity => {
                translating.push(name.as_str());
                continue;
            }
            InstantCentre::AtRest => {
                resting.push(name.as_str());
                continue;
            }
        };
        let point = Point::from(at);
        if low.inf(&point) != low || high.sup(&point) != high {
            let (factor, unit) = unit.map_or((1.0, DisplayUnit::METRE.name), |unit| (unit.factor, unit.name));
            let [x, y] = at.map(|value| shown(rounded(value * factor, 5)));
            notes.push(format!(
                "instant centre of {name} outside the picture, at ({x}, {y}) {unit}"
            ));
            continue;
        }
        let near = |mark: &&mut InstantCentreMark| {
            (Point::from(mark.at.position) - point).norm() <= 1e-6 * size
        };
        match marks.iter_mut().find(near) {
            Some(mark) => mark.bodies.push(name.clone()),
            None => marks.push(InstantCentreMark {
                bodies: vec![name.clone()],
                at: Anchor::origin(None).moved_to(at),
            }),
        }
    }
    if !translating.is_empty() {
        let names = translating.join(", ");
        notes.push(format!("instant centre at infinity (translation): {names}"));
    }
    if !resting.is_empty() {
        notes.push(format!("at rest: {}", resting.join(", ")));
    }
    (marks.into_iter().map(Into::into).collect(), notes)
}

impl Shape for InstantCentreMark {
    fn draw(&self, pen: &mut Pen) {
        let (center, ..) = pen.on(self.at);
        let mut cross = Outline::default();
        for sign in [1.0, -1.0] {
            let arm = HALF * Point::new(1.0, sign);
            cross.add_line(&[center - arm, center + arm]);
        }
        pen.line(Layer::Point, cross, Colour::INK, LINE);
        let name = format!("I {}", self.bodies.join(", "));
        let places = Candidate::around(center, HALF);
        pen.label(Named::Point, &name, Colour::INK, places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
