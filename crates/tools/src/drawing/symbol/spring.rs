//! Springs and dampers along a length, and cylinders of other forces between two points.

use super::*;

/// A spring, a damper, both side by side, or a cylinder, between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Markers i and j.
    pub ends: [Anchor; 2],
    /// The axis along which the length is measured, `None` for the distance.
    pub axis: Option<Anchor>,
    /// Whether the force has a stiffness.
    pub is_elastic: bool,
    /// Whether the force has a damping.
    pub is_damped: bool,
    /// Length of the barrel of a force with neither: a gas spring or an actuator \[m\].
    pub barrel: f64,
}

/// Shortest length of a symbol.
const SHORT: f64 = 24.0;
/// Straight ends of a spring.
const LEAD: f64 = 6.0;
/// Turns of a spring, and half its width.
const COILS: usize = 6;
const HALF: f64 = 5.0;
/// Distance of spring and damper from the line between the points, if there are both.
const ASIDE: f64 = 8.0;

/// Composes the symbol of a force between two points.
pub(super) fn compose(
    composer: &mut Composer,
    ends: [Anchor; 2],
    axis: Option<Anchor>,
    [is_elastic, is_damped]: [bool; 2],
) {
    if axis.is_none() {
        for end in ends {
            pin::compose(composer, [end, end]);
        }
    }
    let barrel = cylinder::barrel(composer, ends, None);
    composer.add(Spring {
        ends,
        axis,
        barrel,
        is_elastic,
        is_damped,
    });
}

/// Returns a point at a fixed place and a part of the length, `aside` of the line.
fn at(fixed: f64, part: f64, aside: f64) -> [Point; 2] {
    [Point::new(fixed, aside), Point::new(part, 0.0)]
}

/// Returns the coils of a spring.
fn coils() -> Vec<[Point; 2]> {
    let between = |part: f64, aside: f64| at(LEAD * (1.0 - 2.0 * part), part, aside);
    let mut points = vec![at(0.0, 0.0, 0.0), at(LEAD, 0.0, 0.0)];
    for coil in 0..COILS {
        for (quarter, aside) in [(0.25, HALF), (0.75, -HALF)] {
            points.push(between((coil as f64 + quarter) / COILS as f64, aside));
        }
    }
    points.extend([at(-LEAD, 1.0, 0.0), at(0.0, 1.0, 0.0)]);
    points
}

/// Returns the lines of a dashpot: the rod with its cup, and the rod with its piston.
fn dashpot() -> [Vec<[Point; 2]>; 4] {
    [
        vec![at(0.0, 0.0, 0.0), at(0.0, 0.35, 0.0)],
        vec![
            at(0.0, 0.65, HALF),
            at(0.0, 0.35, HALF),
            at(0.0, 0.35, -HALF),
            at(0.0, 0.65, -HALF),
        ],
        vec![at(0.0, 0.5, 0.7 * HALF), at(0.0, 0.5, -0.7 * HALF)],
        vec![at(0.0, 0.5, 0.0), at(0.0, 1.0, 0.0)],
    ]
}

impl Shape for Spring {
    fn draw(&self, pen: &mut Pen) {
        let both = self.is_elastic && self.is_damped;
        let mut draw = |lines: &[Vec<[Point; 2]>], offset: f64| {
            let line = Line {
                points: self.ends,
                axis: self.axis,
                offset: if both { offset } else { 0.0 },
                shortest: SHORT,
                radii: [0.0; 2],
            };
            pen.attach(Attachment::Line {
                line,
                end: End::First,
            });
            for points in lines {
                let length = Measure::Length(line);
                pen.elastic(Layer::Joint, length, points.clone(), Colour::INK, THIN);
            }
        };
        if self.is_elastic {
            draw(&[coils()], ASIDE);
        }
        if self.is_damped {
            draw(&dashpot(), -ASIDE);
        }
        if !self.is_elastic && !self.is_damped {
            let line = Line {
                points: self.ends,
                axis: self.axis,
                offset: 0.0,
                shortest: SHORT,
                radii: [0.0; 2],
            };
            cylinder::draw(pen, Layer::Joint, line, self.barrel, Colour::INK);
        }
    }

    fn extent(&self) -> Vec<Disc> {
        self.ends.map(Disc::from).to_vec()
    }
}
