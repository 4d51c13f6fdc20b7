//! Drawings in DXF, by a convention: a layer is a body, a circle is a pin, a text by it is its name.
//!
//! | file | subject |
//! |---|---|
//! | `pairs` | pairs of a code and a value |
//! | `entities` | lines, circles and texts of a drawing, blocks inserted |
//! | `workshop` | [`WorkshopDrawing`]: a mechanism at a pose, written |
//! | `write`, `arcs` | its entities as text; curves as lines and arcs |

mod arcs;
mod entities;
mod pairs;
mod workshop;
mod write;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::draft::{Draft, GROUND, JointKind, LengthUnit, Point};
use super::error::Error;
use super::note::Note;
use super::sketch::Sketch;
use entities::Drawing;
pub use workshop::WorkshopDrawing;

/// End of the name of a layer whose lines are slots of a body.
const SLOT: &str = "_slot";

/// Part of the name of a layer between a body and the one that slides along its lines.
const SLIDE: &str = "_slide_";

/// Ends of the names of layers with shapes of a body, which are no bodies.
const SHAPES: [&str; 5] = ["_gear", "_contour", "_pitch", "_outer", "_curve"];

/// Start of the names of layers with paths, which may pass through pins.
const PATH: &str = "path";

/// Distance of points that are one, as a part of the drawing's size.
const SAME: f64 = 1e-4;

/// Returns whether a text begins as an ASCII DXF does.
pub(super) fn is_start(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    match (lines.next(), lines.next()) {
        (Some("0"), Some(second)) => second == "SECTION",
        (Some("999"), Some(_)) => true,
        _ => false,
    }
}

/// Reads a file.
pub(super) fn read(text: &str, length: Option<LengthUnit>, draft: &mut Draft) -> Result<(), Error> {
    if text.starts_with("AutoCAD Binary DXF") {
        return Err(Error::BinaryDxf);
    }
    let drawing = Drawing::read(text)?;
    let (unit, factor) = match (length, drawing.units) {
        (Some(unit), _) => (unit, 1.0),
        (None, 1) => (LengthUnit::Inch, 1.0),
        (None, 2) => (LengthUnit::Inch, 12.0),
        (None, 4) => (LengthUnit::Millimetre, 1.0),
        (None, 5) => (LengthUnit::Centimetre, 1.0),
        (None, 6) => (LengthUnit::Metre, 1.0),
        (None, _) => return Err(Error::NoUnit),
    };
    draft.unit = unit;
    draft.digits = 9;
    let drawing = drawing.scaled(factor);
    let near = Near::of(&drawing);
    let pins = pins(&drawing, &near);
    build(&drawing, &pins, &near, draft);
    for (kind, count) in &drawing.others {
        draft.note(Note::Entities {
            count: *count,
            kind: kind.clone(),
            reason: "only lines, polylines, arcs, circles and texts are read",
        });
    }
    Ok(())
}

/// Points within a distance count as one.
struct Near {
    distance: f64,
}

impl Near {
    fn of(drawing: &Drawing) -> Self {
        let ends = drawing.lines.iter().flat_map(|line| line.ends);
        let centres = drawing.circles.iter().map(|circle| circle.at);
        let mut box_: Option<[f64; 4]> = None;
        for [x, y] in ends.chain(centres) {
            let [a, b, c, d] = box_.unwrap_or([x, y, x, y]);
            box_ = Some([a.min(x), b.min(y), c.max(x), d.max(y)]);
        }
        let [a, b, c, d] = box_.unwrap_or([0.0, 0.0, 1.0, 1.0]);
        Self {
            distance: (SAME * (c - a).hypot(d - b)).max(1e-9),
        }
    }

    fn cell(&self, at: [f64; 2]) -> [i64; 2] {
        at.map(|x| (x / self.distance).floor() as i64)
    }

    /// Returns the cells in which points near `at` lie.
    fn cells(&self, at: [f64; 2]) -> impl Iterator<Item = [i64; 2]> {
        let [x, y] = self.cell(at);
        (-1..=1).flat_map(move |i| (-1..=1).map(move |j| [x + i, y + j]))
    }

    fn is_same(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        (a[0] - b[0]).hypot(a[1] - b[1]) <= self.distance
    }
}

/// A circle, or several of one centre.
struct Pin {
    at: [f64; 2],
    name: String,
    /// Layers of its circles, and of lines that end at its centre, in order.
    layers: Vec<String>,
}

/// Returns the pins of a drawing.
fn pins(drawing: &Drawing, near: &Near) -> Vec<Pin> {
    let mut pins: Vec<Pin> = Vec::new();
    let mut radii: Vec<f64> = Vec::new();
    let mut by_cell: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let find = |by_cell: &HashMap<[i64; 2], Vec<usize>>, pins: &[Pin], at: [f64; 2]| {
        let known = near
            .cells(at)
            .filter_map(|cell| by_cell.get(&cell))
            .flatten();
        let mut known = known.copied();
        known.find(|pin| near.is_same(pins[*pin].at, at))
    };
    let add_layer = |pin: &mut Pin, layer: &str| {
        if !is_shape(layer) && !pin.layers.iter().any(|known| known == layer) {
            pin.layers.push(layer.to_owned());
        }
    };
    for circle in drawing.circles.iter().filter(|c| !is_shape(&c.layer)) {
        let pin = find(&by_cell, &pins, circle.at).unwrap_or_else(|| {
            pins.push(Pin {
                at: circle.at,
                name: String::new(),
                layers: Vec::new(),
            });
            radii.push(circle.radius);
            by_cell
                .entry(near.cell(circle.at))
                .or_default()
                .push(pins.len() - 1);
            pins.len() - 1
        });
        radii[pin] = radii[pin].max(circle.radius);
        add_layer(&mut pins[pin], &circle.layer);
    }
    for line in &drawing.lines {
        for end in line.ends {
            if let Some(pin) = find(&by_cell, &pins, end) {
                add_layer(&mut pins[pin], &line.layer);
            }
        }
    }
    // Each text names the nearest circle in whose reach it begins.
    for text in &drawing.texts {
        let distance = |pin: usize| {
            let at = pins[pin].at;
            (at[0] - text.at[0]).hypot(at[1] - text.at[1])
        };
        let reach = |pin: &usize| distance(*pin) <= radii[*pin] + 2.0 * text.height;
        let nearest = (0..pins.len())
            .filter(|pin| pins[*pin].name.is_empty())
            .filter(reach)
            .min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        if let Some(pin) = nearest {
            pins[pin].name.clone_from(&text.text);
        }
    }
    pins
}

/// Returns whether a layer has slots, ways or shapes of a body.
fn is_shape(layer: &str) -> bool {
    layer.ends_with(SLOT) || layer.contains(SLIDE) || SHAPES.iter().any(|end| layer.ends_with(end))
}

/// Returns the bodies that the name of a layer with slots or ways names.
fn carriers(layer: &str) -> impl Iterator<Item = &str> {
    let slot = layer.strip_suffix(SLOT).map(|carrier| [carrier, carrier]);
    let slide = || {
        layer
            .split_once(SLIDE)
            .map(|(carrier, slider)| [carrier, slider])
    };
    slot.or_else(slide).into_iter().flatten()
}

fn is_ground(layer: &str) -> bool {
    layer.eq_ignore_ascii_case("ground")
}

/// Returns the layers that are bodies, or ground: those with a circle, or with lines from pin to pin.
fn bodies_among<'a>(drawing: &'a Drawing, pins: &'a [Pin]) -> BTreeSet<&'a str> {
    let circles = drawing.circles.iter().map(|circle| &*circle.layer);
    let mut layers: BTreeSet<&str> = circles.filter(|layer| !is_shape(layer)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for layer in pins.iter().flat_map(|pin| &pin.layers) {
        let count = counts.entry(layer).or_default();
        *count += 1;
        if *count == 2 && !layer.starts_with(PATH) {
            layers.insert(layer);
        }
    }
    layers
}

/// Returns the pins whose centres lie on a line.
fn on_line<'a>(
    [a, b]: [[f64; 2]; 2],
    pins: &'a [Pin],
    near: &'a Near,
) -> impl Iterator<Item = usize> + 'a {
    let way = [b[0] - a[0], b[1] - a[1]];
    let length = way[0].hypot(way[1]);
    (0..pins.len()).filter(move |pin| {
        let at = [pins[*pin].at[0] - a[0], pins[*pin].at[1] - a[1]];
        let along = (at[0] * way[0] + at[1] * way[1]) / length;
        let across = (at[1] * way[0] - at[0] * way[1]) / length;
        let reach = -near.distance..=length + near.distance;
        across.abs() <= near.distance && reach.contains(&along)
    })
}

/// Adds bodies, pins and slots to a draft.
fn build(drawing: &Drawing, pins: &[Pin], near: &Near, draft: &mut Draft) {
    let is_body = bodies_among(drawing, pins);
    let mut sketch = Sketch::default();
    let mut points_of: Vec<(&str, Vec<usize>)> = Vec::new();
    let mut index_of: HashMap<&str, usize> = HashMap::new();
    for (number, pin) in (1..).zip(pins) {
        let name = match pin.name.trim() {
            "" => format!("P{number}"),
            name => name.to_owned(),
        };
        let point = sketch.add_point(&name, pin.at);
        for layer in pin
            .layers
            .iter()
            .filter(|layer| is_body.contains(&***layer))
        {
            if is_ground(layer) {
                sketch.anchor(point);
                continue;
            }
            let index = *index_of.entry(layer).or_insert_with(|| {
                points_of.push((layer, Vec::new()));
                points_of.len() - 1
            });
            points_of[index].1.push(point);
        }
    }
    // A body may have nothing but a slot.
    for layer in drawing.lines.iter().flat_map(|line| carriers(&line.layer)) {
        if !is_ground(layer) {
            index_of.entry(layer).or_insert_with(|| {
                points_of.push((layer, Vec::new()));
                points_of.len() - 1
            });
        }
    }
    for (layer, points) in points_of {
        sketch.add_link(layer, points);
    }
    let bodies = sketch.build(draft);
    let body_of = |layer: &str| {
        if is_ground(layer) {
            Some(GROUND)
        } else {
            Some(bodies.of_link[*index_of.get(layer)?])
        }
    };
    for (pin, placed) in bodies.at_point.iter().enumerate() {
        if let [only] = placed[..]
            && only.body != GROUND
            && !pins[pin].name.is_empty()
        {
            draft.outputs.push(only);
        }
    }
    let mut left: BTreeMap<&str, usize> = BTreeMap::new();
    for line in &drawing.lines {
        let [a, b] = line.ends;
        let angle = (b[1] - a[1]).atan2(b[0] - a[0]);
        let way = |name: String| Point {
            name,
            at: a,
            angle: Some(angle),
        };
        let is_long = !near.is_same(a, b);
        if let Some(carrier) = line.layer.strip_suffix(SLOT)
            && let Some(carrier) = body_of(carrier).filter(|_| is_long)
        {
            for pin in on_line(line.ends, pins, near) {
                let Some(&to) = bodies.at_point[pin].first() else {
                    continue;
                };
                if bodies.on(carrier, pin).is_none() {
                    let name = sketch.name(pin).to_owned();
                    let from = draft.add_point(carrier, way(format!("{name}_way")));
                    draft.join(&format!("{name}_slot"), JointKind::Slot, from, to);
                }
            }
        } else if let Some((carrier, slider)) = line.layer.split_once(SLIDE)
            && let Some((carrier, to)) = body_of(carrier).zip(body_of(slider))
            && is_long
            && carrier != to
        {
            let [from, to] = [(carrier, slider), (to, "")].map(|(body, name)| {
                let name = if name.is_empty() {
                    "way".to_owned()
                } else {
                    format!("{name}_way")
                };
                draft.add_point(body, way(name))
            });
            draft.join(
                &format!("{slider}_slide"),
                JointKind::Translational,
                from,
                to,
            );
        } else if body_of(&line.layer).is_none() {
            *left.entry(&line.layer).or_default() += 1;
        }
    }
    for (layer, count) in left {
        draft.note(Note::Entities {
            count,
            kind: format!("line of layer `{layer}`"),
            reason: "no circle makes the layer a body",
        });
    }
}
