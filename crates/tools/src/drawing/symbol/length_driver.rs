//! Drivers of lengths: cylinders between two points, and dimension lines.

use super::*;
use biela::mechanism::Driver;

/// A driver of a length.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthDriver {
    /// The driver's name.
    pub name: String,
    /// Marker i.
    pub from: Anchor,
    /// Marker j.
    pub to: Anchor,
    /// The axis along which the length is measured, `None` for the distance.
    pub axis: Option<Anchor>,
    /// Length of the barrel of a cylinder between the two points \[m\]; `None` for a dimension line
    /// beside them, where something else is between them.
    pub barrel: Option<f64>,
    /// Whether it is a freedom, whose arrows are open.
    pub is_free: bool,
}

/// Length of a line without room for two arrows.
const SHORT: f64 = 18.0;
/// Distance of a dimension line from its points.
const BESIDE: f64 = 21.0;
/// Length of an extension line beyond the dimension line, and its gap from the point.
const EXTENSION: f64 = 4.0;
const EXTENSION_GAP: f64 = PIN + 2.0;

/// Composes the driver of a length between two points; `guided` if a joint lies between them.
pub(super) fn compose(
    composer: &mut Composer,
    driver: &Driver,
    [from, to]: [Anchor; 2],
    axis: Option<Anchor>,
    guided: bool,
) {
    let is_cylinder = !guided && axis.is_none();
    let barrel = is_cylinder.then(|| cylinder::barrel(composer, [from, to], driver.min));
    if is_cylinder {
        for end in [from, to] {
            pin::compose(composer, [end, end]);
        }
    }
    composer.add(LengthDriver {
        name: driver.name.clone(),
        from,
        to,
        axis,
        barrel,
        is_free: driver.is_free(),
    });
}

impl Shape for LengthDriver {
    fn draw(&self, pen: &mut Pen) {
        let mut line = Line {
            points: [self.from, self.to],
            axis: self.axis,
            offset: 0.0,
            shortest: SHORT,
            radii: [0.0; 2],
        };
        let ([from, to], along) = line.on_sheet(pen.q, pen.scale);
        let aside = pen.away(across(along), 0.5 * (from + to));
        let width = if let Some(barrel) = self.barrel {
            cylinder::draw(pen, Layer::Driver, line, barrel, Colour::DRIVER);
            cylinder::HALF
        } else {
            line.offset = BESIDE * aside.dot(&across(along));
            let is_short = (to - from).dot(&along).abs() < SHORT;
            pen.open_arrows = self.is_free;
            draw_dimension(pen, line, pen.moving || !is_short);
            pen.open_arrows = false;
            0.0
        };
        let ends = line.ends(pen.q, pen.scale);
        let parts = [(0.5, 0.0), (0.35, 1.0), (0.65, 1.0), (0.2, 3.0), (0.8, 3.0)];
        let sides = [(aside, 0.0), (-aside, 1.0)];
        let gaps = [(width + 5.0, 0.0), (width + 14.0, 5.0)];
        let mut candidates = Candidate::beside(ends, &parts, &sides, &gaps);
        candidates.extend(ends.into_iter().flat_map(|tip| Candidate::around(tip, 5.0)));
        pen.attach(Attachment::Point(self.to));
        pen.label(Named::Driver, &self.name, Colour::DRIVER.shade(0.8), candidates);
    }

    fn extent(&self) -> Vec<Disc> {
        [self.from, self.to].map(Disc::from).to_vec()
    }
}

/// Draws a line with arrows at both ends, and the lines from the points to it.
fn draw_dimension(pen: &mut Pen, line: Line, has_extensions: bool) {
    if has_extensions {
        draw_extensions(pen, line);
    }
    let [start, end] = line.ends(pen.q, pen.scale);
    let forth = unit(end - start);
    let [first, second] = [End::First, End::Second].map(|end| Attachment::Line { line, end });
    pen.attach(first);
    let shaft = vec![
        [Point::new(IN_ARROW, 0.0), Point::zeros()],
        [Point::new(-IN_ARROW, 0.0), Point::x()],
    ];
    pen.elastic(
        Layer::Driver,
        Measure::Length(line),
        shaft,
        Colour::DRIVER,
        LINE,
    );
    pen.attach(second);
    pen.tip(Layer::Driver, end, forth, Colour::DRIVER);
    pen.attach(first);
    pen.tip(Layer::Driver, start, -forth, Colour::DRIVER);
}

/// Draws the lines from both points to the dimension line and a little beyond.
fn draw_extensions(pen: &mut Pen, line: Line) {
    let line = Line {
        shortest: 0.0,
        ..line
    };
    let ([_, to], _) = line.on_sheet(pen.q, pen.scale);
    let [first, second] = [End::First, End::Second].map(|end| Attachment::Line { line, end });
    // The first point is beside the line by a length that changes.
    let beside = Measure::Beside(line);
    let sign = beside.value(pen.q, pen.scale).signum();
    let points = vec![
        [Point::new(0.0, -sign * EXTENSION_GAP), Point::y()],
        [Point::new(0.0, -sign * EXTENSION), Point::zeros()],
    ];
    pen.attach(first);
    pen.elastic(Layer::Driver, beside, points, Colour::DRIVER, THIN);
    let end = line.ends(pen.q, pen.scale)[1];
    let away = unit(end - to);
    let extension = Outline::line(&[to + EXTENSION_GAP * away, end + EXTENSION * away]);
    pen.attach(second);
    pen.line(Layer::Driver, extension, Colour::DRIVER, THIN);
}
