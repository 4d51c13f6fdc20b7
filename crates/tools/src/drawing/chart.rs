//! Line charts over a common x-axis: one panel for each kind of quantity, one above the other.

use super::lettering;
use super::outline::{Outline, Point, finite_extremes};
use super::palette::Colour;
use super::sheet::{CAPITALS, Layer, Mark, Sheet, Stroke, Text, WIDTH};
use super::ticks::Ticks;

/// Chart: panels of lines over a common x-axis.
#[derive(Clone, Debug)]
pub struct LineChart {
    /// Title, in a word.
    pub title: String,
    /// Subtitle in one line; may be empty.
    pub description: String,
    /// Quantity on the x-axis.
    pub x: Axis,
    /// Values of x, common to all lines.
    pub at: Vec<f64>,
    /// Values of x at which something happens, such as impacts: dotted lines.
    pub instants: Vec<f64>,
    /// The panels from top to bottom.
    pub panels: Vec<Panel>,
}

/// Quantity on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity, in a word or two.
    pub label: String,
    /// The unit of the values.
    pub unit: String,
}

/// The lines that have a y-axis in common.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Quantity on the y-axis.
    pub y: Axis,
    /// The lines.
    pub lines: Vec<Line>,
}

/// A line of a panel.
#[derive(Clone, Debug)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Lines of the same number look alike in all panels: the colour is that of the body of this
    /// index, and of each [`COLOURS`]th after it, which are dashed.
    pub look: usize,
    /// One value for each point of the x-axis; where one is not finite the line has a gap.
    pub values: Vec<f64>,
    /// Points to be marked: x, value and a text, such as an extreme value.
    pub marks: Vec<(f64, f64, String)>,
}

/// Number of colours that tell lines apart.
pub const COLOURS: usize = 7;

/// Margins of the chart.
const MARGIN: f64 = 14.0;
/// From one line of text to the next.
const LINE_HEIGHT: f64 = 17.0;
/// Height of a panel, if it is the only one, if there are two, if there are more.
const HEIGHTS: [f64; 3] = [260.0, 180.0, 128.0];
/// Length of the piece of line beside a name in the legend.
const SAMPLE: f64 = 20.0;
/// From one name in the legend to the next.
const APART: f64 = 16.0;
/// A line of more points than this is thinned to what can be seen.
const THINNED: usize = 2000;
/// Steps of the sheet's unit within which lines are thinned.
const STEPS: f64 = 2.0;

/// Half the diagonal of the diamond at a marked point.
const DIAMOND: f64 = 3.2;
const CURVE: f64 = 1.5;
const FRAME: f64 = 0.9;
const INSTANTS: &[f64] = &[1.0, 2.5];
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.5], &[8.0, 2.5, 2.0, 2.5]];

impl Sheet {
    /// Draws a chart.
    #[must_use]
    pub fn chart(chart: &LineChart) -> Self {
        let scales: Vec<Scale> = chart.panels.iter().map(Scale::new).collect();
        let widest = scales.iter().map(Scale::width).fold(0.0, f64::max);
        let mut plot = Plot {
            chart,
            left: MARGIN + widest + 6.0,
            x: x_range(&chart.at),
            marks: Vec::new(),
            texts: Vec::new(),
        };
        let corner = Point::new(MARGIN, MARGIN + CAPITALS);
        plot.text(&chart.title, corner, START);
        let height = HEIGHTS[chart.panels.len().clamp(1, HEIGHTS.len()) - 1];
        let mut y = MARGIN + CAPITALS;
        for (panel, scale) in chart.panels.iter().zip(&scales) {
            y = plot.legend(panel, scale, y + 15.0);
            plot.panel(panel, scale, [y, y + height]);
            y += height;
        }
        plot.x_axis(y);
        Sheet {
            title: chart.title.clone(),
            description: chart.description.clone(),
            width: WIDTH,
            height: (y + 2.2 * LINE_HEIGHT + MARGIN).ceil(),
            marks: plot.marks,
            texts: plot.texts,
        }
    }
}

/// Returns the range of the x-axis.
fn x_range(at: &[f64]) -> [f64; 2] {
    let [low, high] = finite_extremes(at);
    if high > low {
        [low, high]
    } else {
        [low - 0.5, low + 0.5]
    }
}

/// The y-axis of a panel: its ticks are values over a power of ten that belongs to the unit.
struct Scale {
    ticks: Ticks,
    power: i32,
    header: String,
}

impl Scale {
    fn new(panel: &Panel) -> Self {
        let range = finite_extremes(panel.lines.iter().flat_map(|line| &line.values));
        let size = range[0].abs().max(range[1].abs());
        // Numbers of one to four digits before the point, or a few after it.
        let power = if size >= 1e4 || (1e-9..1e-1).contains(&size) {
            3 * ((size.log10() + 1e-9) / 3.0).floor() as i32
        } else {
            0
        };
        let Axis { label, unit } = &panel.y;
        let unit = match power {
            0 => unit.clone(),
            -3 if unit.starts_with('m') => format!("m{unit}"),
            3 => format!("1000 {unit}"),
            _ => format!("1e{power} {unit}"),
        };
        let range = range.map(|value| value * 10_f64.powi(-power));
        let in_degrees = power == 0 && unit.starts_with("deg");
        Self {
            ticks: Ticks::around(range, 4.0, in_degrees),
            power,
            header: format!("{label} [{unit}]"),
        }
    }

    /// Returns the width of its widest number.
    fn width(&self) -> f64 {
        let ticks = &self.ticks;
        let texts = ticks.values.iter().map(|value| ticks.text(*value));
        texts.map(|text| width(&text)).fold(0.0, f64::max)
    }
}

/// Part of a text to the left of its place.
const START: f64 = 0.0;
const MIDDLE: f64 = 0.5;
const END: f64 = 1.0;

/// A chart while it is drawn.
struct Plot<'a> {
    chart: &'a LineChart,
    /// Left edge of the panels.
    left: f64,
    x: [f64; 2],
    marks: Vec<Mark>,
    texts: Vec<Text>,
}

impl Plot<'_> {
    fn right(&self) -> f64 {
        WIDTH - MARGIN
    }

    fn on_x(&self, value: f64) -> f64 {
        let [low, high] = self.x;
        self.left + (value - low) / (high - low) * (self.right() - self.left)
    }

    fn text(&mut self, content: &str, at: Point, part: f64) {
        self.texts.push(Text {
            content: content.to_owned(),
            start: at - Point::new(part * width(content), 0.0),
            colour: Colour::INK,
        });
    }

    fn line(&mut self, layer: Layer, outline: Outline, stroke: Stroke) {
        self.marks.push(Mark::line(layer, outline, stroke));
    }

    /// Writes the panel's quantity and its lines' names, wrapped; returns the top of the panel.
    fn legend(&mut self, panel: &Panel, scale: &Scale, top: f64) -> f64 {
        let mut at = Point::new(MARGIN, top + CAPITALS);
        self.text(&scale.header, at, START);
        at.x += width(&scale.header) + APART;
        for line in &panel.lines {
            let needed = SAMPLE + 5.0 + width(&line.name);
            if at.x + needed > self.right() {
                at = Point::new(self.left, at.y + LINE_HEIGHT);
            }
            let middle = at - Point::new(0.0, 0.5 * CAPITALS);
            let sample = Outline::line(&[middle, middle + Point::new(SAMPLE, 0.0)]);
            self.line(Layer::Scale, sample, look(line.look));
            self.text(&line.name, at + Point::new(SAMPLE + 5.0, 0.0), START);
            at.x += needed + APART;
        }
        at.y + 12.0
    }

    fn panel(&mut self, panel: &Panel, scale: &Scale, [top, bottom]: [f64; 2]) {
        let [low, high] = scale.ticks.range();
        let on_y = |value: f64| bottom - (value - low) / (high - low) * (bottom - top);
        let (left, right) = (self.left, self.right());
        let mut grid = Outline::default();
        for &value in &scale.ticks.values {
            let y = on_y(value);
            grid.add_line(&[Point::new(left, y), Point::new(right, y)]);
            let at = Point::new(left - 6.0, y + 0.5 * CAPITALS);
            self.text(&scale.ticks.text(value), at, END);
        }
        for value in self.x_ticks().values {
            let x = self.on_x(value);
            grid.add_line(&[Point::new(x, top), Point::new(x, bottom)]);
        }
        let stroke = Stroke::solid(Colour::GROUND.tint(0.25), FRAME);
        self.line(Layer::Grid, grid, stroke);
        let mut instants = Outline::default();
        let [first, last] = self.x;
        for &value in &self.chart.instants {
            if (first..=last).contains(&value) {
                let x = self.on_x(value);
                instants.add_line(&[Point::new(x, top), Point::new(x, bottom)]);
            }
        }
        if !instants.0.is_empty() {
            let stroke = Stroke {
                dashes: INSTANTS,
                ..Stroke::solid(Colour::GROUND.tint(0.8), FRAME)
            };
            self.line(Layer::Grid, instants, stroke);
        }
        if low < 0.0 && high > 0.0 {
            let zero = [Point::new(left, on_y(0.0)), Point::new(right, on_y(0.0))];
            let stroke = Stroke::solid(Colour::GROUND.tint(0.7), FRAME);
            self.line(Layer::Grid, Outline::line(&zero), stroke);
        }
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        let frame = Outline::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let factor = 10_f64.powi(-scale.power);
        for line in &panel.lines {
            let points = self.chart.at.iter().zip(&line.values);
            let points: Vec<Point> = points
                .map(|(x, y)| Point::new(self.on_x(*x), on_y(y * factor)))
                .collect();
            let mut outline = Outline::default();
            for piece in points.split(|p| !(p.x.is_finite() && p.y.is_finite())) {
                outline.add_line(&thinned(piece));
            }
            self.line(Layer::Curve, outline, look(line.look));
            for (x, y, text) in &line.marks {
                let at = Point::new(self.on_x(*x), on_y(y * factor));
                if at.x.is_finite() && at.y.is_finite() {
                    self.mark(at, text, line.look, top);
                }
            }
        }
        self.line(Layer::Scale, frame, Stroke::solid(Colour::GROUND, FRAME));
    }

    /// Marks a point with a diamond and, where there is room, its text: above it, or below it near
    /// the top of the panel.
    fn mark(&mut self, at: Point, text: &str, number: usize, top: f64) {
        let corner = |x, y| at + Point::new(x, y);
        let diamond = Outline::polygon(&[
            corner(DIAMOND, 0.0),
            corner(0.0, DIAMOND),
            corner(-DIAMOND, 0.0),
            corner(0.0, -DIAMOND),
        ]);
        self.marks.push(Mark {
            fill: Some((look(number).colour, 1.0)),
            ..Mark::line(Layer::Scale, diamond, look(number))
        });
        let half = 0.5 * width(text);
        let x =
            at.x.clamp(self.left + half + 3.0, self.right() - half - 3.0);
        let above = at.y - 6.0;
        let y = if above - CAPITALS > top + 2.0 {
            above
        } else {
            at.y + 6.0 + CAPITALS
        };
        let is_free = self.texts.iter().all(|other| {
            let right = other.start.x + width(&other.content);
            let beside = right < x - half - 2.0 || other.start.x > x + half + 2.0;
            beside || (other.start.y - y).abs() > CAPITALS + 2.0
        });
        if is_free {
            self.text(text, Point::new(x, y), MIDDLE);
        }
    }

    fn x_ticks(&self) -> Ticks {
        Ticks::within(self.x, 10.0, self.chart.x.unit.starts_with("deg"))
    }

    fn x_axis(&mut self, y: f64) {
        let ticks = self.x_ticks();
        for &value in &ticks.values {
            let text = ticks.text(value);
            // The outermost numbers stay on the sheet.
            let half = 0.5 * width(&text);
            let x = self.on_x(value).min(WIDTH - 2.0 - half);
            self.text(&text, Point::new(x, y + LINE_HEIGHT), MIDDLE);
        }
        let Axis { label, unit } = &self.chart.x;
        let middle = 0.5 * (self.left + self.right());
        let at = Point::new(middle, y + 2.2 * LINE_HEIGHT);
        self.text(&format!("{label} [{unit}]"), at, MIDDLE);
    }
}

fn width(text: &str) -> f64 {
    lettering::width(text, CAPITALS)
}

fn look(number: usize) -> Stroke {
    Stroke {
        colour: Colour::of_body(number).shade(0.9),
        width: CURVE,
        dashes: DASHES[number / COLOURS % DASHES.len()],
    }
}

/// Returns the first, lowest, highest and last point within each small step of x: the picture
/// stays the same. A line that goes back is not thinned.
fn thinned(points: &[Point]) -> Vec<Point> {
    if points.len() <= THINNED || !points.is_sorted_by(|a, b| a.x <= b.x) {
        return points.to_vec();
    }
    let step = |p: &Point| (p.x * STEPS).floor();
    let mut kept = Vec::new();
    for bucket in points.chunk_by(|a, b| step(a) >= step(b)) {
        let by_y = |a: &&Point, b: &&Point| a.y.total_cmp(&b.y);
        let mut of_bucket: Vec<&Point> = [
            bucket.first(),
            bucket.iter().min_by(by_y),
            bucket.iter().max_by(by_y),
            bucket.last(),
        ]
        .into_iter()
        .flatten()
        .collect();
        of_bucket.sort_by(|a, b| a.x.total_cmp(&b.x));
        of_bucket.dedup();
        kept.extend(of_bucket);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_in_the_range_are_dotted() {
        let axis = || Axis {
            label: "time".to_owned(),
            unit: "s".to_owned(),
        };
        let chart = |instants| LineChart {
            title: String::new(),
            description: String::new(),
            x: axis(),
            at: vec![0.0, 1.0],
            instants,
            panels: vec![Panel {
                y: axis(),
                lines: Vec::new(),
            }],
        };
        let dotted = |instants: Vec<f64>| {
            let marks = Sheet::chart(&chart(instants)).marks;
            let dotted = marks
                .iter()
                .filter(|mark| mark.stroke.is_some_and(|stroke| stroke.dashes == INSTANTS));
            dotted
                .map(|mark| mark.outline.flattened().len())
                .sum::<usize>()
        };
        assert_eq!(dotted(Vec::new()), 0);
        assert_eq!(dotted(vec![-0.1, 0.0, 0.3, 1.0, 1.1]), 3);
    }

    #[test]
    fn thinning_keeps_what_can_be_seen() {
        let wave = |k: usize| {
            let x = k as f64 / 100.0;
            Point::new(x, 50.0 + 40.0 * (x / 3.0).sin())
        };
        let mut points: Vec<Point> = (0..60_000).map(wave).collect();
        points[31_234].y = 95.0;
        let kept = thinned(&points);
        // At most four points for each half unit of 600.
        assert!(kept.len() <= 4 * 1200, "{}", kept.len());
        assert!(kept.contains(&points[31_234]));
        assert!(kept.is_sorted_by(|a, b| a.x <= b.x));
        assert_eq!([kept.first(), kept.last()], [points.first(), points.last()]);
        assert_eq!(thinned(&points[..THINNED]), points[..THINNED]);
    }
}
