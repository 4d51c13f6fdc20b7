//! Outlines that the file gives bodies and ground.

use super::*;
use biela::mechanism::{Mechanism, Piece};

/// The area of a shape with its holes, under the other symbols.
#[derive(Clone, Debug, PartialEq)]
pub struct Silhouette {
    /// The body, `None` for ground.
    pub body: Option<BodyId>,
    /// Closed lines in the body's frame \[m\]: the boundary counter-clockwise, holes clockwise.
    pub lines: Vec<Vec<Stretch>>,
}

/// Piece of a closed line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Both ends \[m\].
    pub ends: [[f64; 2]; 2],
    /// Centre \[m\], radius \[m\] and turn \[rad\] of an arc, `None` for a straight line.
    pub arc: Option<([f64; 2], f64, f64)>,
}

/// Composes the shapes of all bodies and of ground.
pub(super) fn compose(composer: &mut Composer) {
    let mechanism = composer.mechanism;
    let parameters = composer.parameters();
    let silhouettes = mechanism.shapes.iter().filter(|shape| !shape.is_hole());
    let silhouettes = silhouettes.map(|shape| {
        let mut lines = vec![line(mechanism, shape, parameters)];
        let holes = mechanism.shapes_of(shape.body).filter(|(_, hole)| hole.is_hole());
        let holes = holes.filter(|(_, hole)| mechanism.lies_in(hole, shape, parameters));
        lines.extend(holes.map(|(_, hole)| reversed(&line(mechanism, hole, parameters))));
        Silhouette {
            body: shape.body,
            lines,
        }
    });
    let silhouettes: Vec<Symbol> = silhouettes.map(Into::into).collect();
    composer.symbols.extend(silhouettes);
}

fn line(
    mechanism: &Mechanism,
    shape: &biela::mechanism::Shape,
    parameters: &[f64],
) -> Vec<Stretch> {
    let mut line = Vec::new();
    mechanism.boundary(shape, parameters, &mut |Piece { ends, arc }| {
        line.push(Stretch { ends, arc });
    });
    line
}

/// Returns a line the other way round. Areas are filled where lines wind round them.
fn reversed(line: &[Stretch]) -> Vec<Stretch> {
    let pieces = line.iter().rev().map(|piece| Stretch {
        ends: [piece.ends[1], piece.ends[0]],
        arc: piece.arc.map(|(center, radius, turn)| (center, radius, -turn)),
    });
    pieces.collect()
}

impl Shape for Silhouette {
    fn draw(&self, pen: &mut Pen) {
        const OPACITY: f64 = 0.25;
        let frame = Anchor::origin(self.body);
        let (_, _, colour) = pen.on(frame);
        let frame = frame.placed(pen.q).angle;
        let mut outline = Outline::default();
        for line in &self.lines {
            let mut is_first = true;
            for piece in line {
                let [from, to] = piece.ends.map(|end| {
                    let anchor = Anchor::origin(self.body).moved_to(end);
                    pen.place(anchor).0
                });
                if std::mem::take(&mut is_first) {
                    outline.add_line(&[from]);
                }
                match piece.arc {
                    None => outline.continue_to(to),
                    Some((center, radius, turn)) => {
                        let start = Point::from(piece.ends[0]) - Point::from(center);
                        let center = pen.place(Anchor::origin(self.body).moved_to(center)).0;
                        // On the sheet angles count clockwise.
                        let from = -(angle(start) + frame);
                        outline.add_arc(center, radius * pen.scale, from, -turn);
                    }
                }
            }
            outline.close();
        }
        let boundary = self.lines.iter().take(1).flatten();
        let corners = boundary.map(|piece| {
            let anchor = Anchor::origin(self.body).moved_to(piece.ends[0]);
            pen.place(anchor).0
        });
        let corners: Vec<Point> = corners.collect();
        pen.offer(self.body, link::places(&convex_hull(&corners)));
        pen.area(Layer::Shape, outline, (colour, OPACITY), Some(colour));
    }

    fn extent(&self) -> Vec<Disc> {
        let at = |point| Anchor::origin(self.body).moved_to(point);
        let boundary = self.lines.iter().take(1).flatten();
        let discs = boundary.map(|piece| match piece.arc {
            // An arc that bulges outwards lies in its circle, another one beside its ends.
            Some((center, radius, turn)) if turn > 0.0 => Disc::new(at(center), radius),
            _ => at(piece.ends[0]).into(),
        });
        discs.collect()
    }
}
