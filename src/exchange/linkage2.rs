//! Documents of Linkage (`.linkage2`): connectors, links through them, and ratios of gears.

use std::collections::{BTreeMap, HashMap};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::draft::{
    BodyRef, Coordinate, Draft, Driver, DriverSource, GROUND, JointKind, LengthUnit, Point,
    PointRef, Stop, Wheels,
};
use super::error::{self, Error};
use super::note::Note;
use super::sketch::{Bodies, Sketch};
use crate::mechanism::rounded;

/// Units of a document per inch, whatever unit it shows.
const PER_INCH: f64 = 96.0;

/// Deepest element: a real document has four levels.
const DEEPEST: usize = 32;

/// Attributes that concern the picture only.
const DISPLAY: [&str; 6] = [
    "color",
    "drawcircle",
    "shape",
    "labels",
    "angles",
    "measurementelement",
];

/// An element with its attributes and those below it.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: HashMap<String, String>,
    children: Vec<Element>,
    line: usize,
}

impl Element {
    fn text(&self, key: &str) -> Option<&str> {
        self.attributes.get(key).map(String::as_str)
    }

    fn is(&self, key: &str) -> bool {
        self.text(key)
            .is_some_and(|value| value == "true" || value == "1")
    }

    /// Returns a number, 0 if it is missing.
    fn number(&self, key: &str) -> Result<f64, Error> {
        self.text(key)
            .map_or(Ok(0.0), |text| error::number(text, self.line))
    }

    fn id(&self) -> Result<&str, Error> {
        self.text("id").ok_or_else(|| Error::Missing {
            line: self.line,
            place: format!("`{}`", error::start_of(&self.name)),
            key: "id",
        })
    }

    /// Returns a name: its own, or its id after a word.
    fn label(&self, word: &str) -> String {
        match self
            .text("name")
            .map(str::trim)
            .filter(|name| !name.is_empty())
        {
            Some(name) => error::start_of(name),
            None => error::start_of(&format!("{word}{}", self.text("id").unwrap_or_default())),
        }
    }

    /// Returns the ids of elements of this name below, or in an attribute of the name.
    fn ids<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        let below = self.children.iter().filter(move |child| child.name == name);
        let below = below.filter_map(|child| child.text("id"));
        below.chain(self.text(name))
    }
}

/// Reads a file.
pub(super) fn read(text: &str, draft: &mut Draft) -> Result<(), Error> {
    let root = parse(text)?;
    if root.name != "linkage2" {
        let found = format!("<{}>", root.name);
        return Err(Error::unexpected(root.line, &found, "`<linkage2>`"));
    }
    let program = root.children.iter().find(|child| child.name == "program");
    let units = program.and_then(|program| program.text("units"));
    draft.unit = match units {
        Some("Inches") => LengthUnit::Inch,
        _ => LengthUnit::Millimetre,
    };
    // Six decimals of a 96th of an inch.
    draft.digits = 9;
    let per_unit = match draft.unit {
        LengthUnit::Inch => PER_INCH,
        _ => PER_INCH / 25.4,
    };
    let mut document = Document::default();
    for child in &root.children {
        match &*child.name {
            "connector" => document.add_connector(child, per_unit)?,
            "Link" | "element" => document.links.push(child),
            "ratios" => document.ratios.extend(&child.children),
            "background" => draft.note(Note::LeftOut {
                kind: "background",
                name: child.label("picture"),
                reason: "it is only seen",
            }),
            _ => {}
        }
    }
    document.draft(draft, per_unit)?;
    note_display(&root, draft);
    Ok(())
}

/// Notes attributes that concern the picture only.
fn note_display(root: &Element, draft: &mut Draft) {
    let is_there = |key: &&&str| {
        root.children
            .iter()
            .any(|child| child.attributes.contains_key(**key) && child.text(key) != Some("false"))
    };
    let there: Vec<&str> = DISPLAY.iter().filter(is_there).copied().collect();
    if !there.is_empty() {
        draft.note(Note::Display {
            what: there.join(", "),
        });
    }
}

/// Reads the elements of an XML text.
fn parse(text: &str) -> Result<Element, Error> {
    let mut reader = Reader::from_str(text);
    let line_at = |position: u64| {
        let end = usize::try_from(position).unwrap_or(usize::MAX);
        let before = &text.as_bytes()[..end.min(text.len())];
        1 + before.iter().filter(|byte| **byte == b'\n').count()
    };
    let bad = |position: u64, reason: &dyn std::fmt::Display| Error::Xml {
        line: line_at(position),
        reason: error::start_of(&reason.to_string()),
    };
    // Lines are counted from the last element on.
    let (mut counted, mut line) = (0, 1);
    let mut open: Vec<Element> = Vec::new();
    loop {
        let event = reader
            .read_event()
            .map_err(|error| bad(reader.error_position(), &error))?;
        let position = usize::try_from(reader.buffer_position()).unwrap_or(text.len());
        let position = position.min(text.len());
        let passed = &text.as_bytes()[counted.min(position)..position];
        line += passed.iter().filter(|byte| **byte == b'\n').count();
        counted = position;
        let closed = match event {
            Event::Start(start) => {
                open.push(element(&start, line)?);
                if open.len() > DEEPEST {
                    return Err(Error::TooDeep { line });
                }
                None
            }
            Event::Empty(start) => Some(element(&start, line)?),
            Event::End(_) => open.pop(),
            Event::Eof => {
                return Err(bad(
                    reader.buffer_position(),
                    &"it ends before its first element does",
                ));
            }
            _ => None,
        };
        if let Some(closed) = closed {
            match open.last_mut() {
                Some(parent) => parent.children.push(closed),
                None => return Ok(closed),
            }
        }
    }
}

fn element(start: &BytesStart, line: usize) -> Result<Element, Error> {
    let mut attributes = HashMap::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|error| Error::Xml {
            line,
            reason: error::start_of(&error.to_string()),
        })?;
        let value = quick_xml::escape::unescape(&attribute.value).map_err(|error| Error::Xml {
            line,
            reason: error::start_of(&error.to_string()),
        })?;
        attributes.insert(attribute.key.as_ref().to_owned(), value.into_owned());
    }
    Ok(Element {
        name: start.name().as_ref().to_owned(),
        attributes,
        children: Vec::new(),
        line,
    })
}

/// The parts of a document that make a mechanism.
#[derive(Default)]
struct Document<'a> {
    sketch: Sketch,
    connectors: Vec<&'a Element>,
    by_id: HashMap<&'a str, usize>,
    links: Vec<&'a Element>,
    ratios: Vec<&'a Element>,
}

impl<'a> Document<'a> {
    fn add_connector(&mut self, element: &'a Element, per_unit: f64) -> Result<(), Error> {
        let at = [element.number("x")?, element.number("y")?].map(|x| x / per_unit);
        let id = element.id()?;
        let label = match id.parse::<u8>() {
            // As on the screen of the program.
            Ok(number @ 0..26)
                if element
                    .text("name")
                    .is_none_or(|name| name.trim().is_empty()) =>
            {
                char::from(b'A' + number).to_string()
            }
            _ => element.label("P"),
        };
        let point = self.sketch.add_point(&label, at);
        if element.is("anchor") {
            self.sketch.anchor(point);
        }
        self.connectors.push(element);
        self.by_id.insert(id, point);
        Ok(())
    }

    fn point(&self, place: &str, id: &str) -> Result<usize, Error> {
        self.by_id.get(id).copied().ok_or_else(|| Error::Unknown {
            place: place.to_owned(),
            kind: "connector",
            name: error::start_of(id),
        })
    }

    fn draft(mut self, draft: &mut Draft, per_unit: f64) -> Result<(), Error> {
        // Actuators are lengths between two points, no bodies.
        let (actuators, links): (Vec<&Element>, Vec<&Element>) =
            self.links.iter().partition(|link| link.is("actuator"));
        let mut by_id = BTreeMap::new();
        let mut points_of = Vec::new();
        for link in &links {
            let label = link.label("link_");
            let place = format!("link `{label}`");
            let points: Result<Vec<usize>, Error> = link
                .ids("connector")
                .map(|id| self.point(&place, id))
                .collect();
            let points = points?;
            points_of.push(points.clone());
            by_id.insert(link.id()?, self.sketch.add_link(&label, points));
        }
        self.fasten(&links, &by_id);
        self.weld_at_inputs(&points_of);
        let bodies = self.sketch.build(draft);
        self.inputs(draft, &bodies)?;
        for actuator in actuators {
            self.actuator(draft, &bodies, actuator, per_unit)?;
        }
        for point in 0..self.connectors.len() {
            self.slider(draft, &bodies, point, per_unit)?;
        }
        for ratio in &self.ratios {
            self.ratio(draft, &bodies, ratio, &by_id, &points_of, per_unit)?;
        }
        for (element, refs) in self.connectors.iter().zip(&bodies.at_point) {
            if element.is("draw")
                && let Some(moving) = refs.iter().find(|placed| placed.body != GROUND)
            {
                draft.outputs.push(*moving);
            }
            if refs.is_empty() {
                draft.note(Note::LeftOut {
                    kind: "connector",
                    name: element.label(""),
                    reason: "no link has it",
                });
            }
        }
        Ok(())
    }

    /// Makes links that are fastened to each other one body; those fastened to an anchor ground.
    fn fasten(&mut self, links: &[&Element], by_id: &BTreeMap<&str, usize>) {
        for (index, link) in links.iter().enumerate() {
            let to: Vec<usize> = link
                .ids("fastenlink")
                .filter_map(|id| by_id.get(id).copied())
                .collect();
            for other in to {
                self.sketch.merge(index, other);
            }
            let anchored = link.ids("fastenconnector").any(|id| {
                let point = self.by_id.get(id);
                point.is_some_and(|point| self.sketch.is_anchor(*point))
            });
            if anchored {
                self.sketch.ground(index);
            }
        }
    }

    /// Makes all links that an input turns one body.
    fn weld_at_inputs(&mut self, points_of: &[Vec<usize>]) {
        for (point, element) in self.connectors.iter().enumerate() {
            if !element.is("input") || !element.is("anchor") {
                continue;
            }
            let mut turned = (0..points_of.len()).filter(|link| points_of[*link].contains(&point));
            if let Some(first) = turned.next() {
                for link in turned {
                    self.sketch.merge(first, link);
                }
            }
        }
    }

    fn inputs(&self, draft: &mut Draft, bodies: &Bodies) -> Result<(), Error> {
        for (element, refs) in self.connectors.iter().zip(&bodies.at_point) {
            let [from, to, ..] = refs[..] else { continue };
            if !element.is("input") {
                continue;
            }
            let rpm = element.number("rpm")?;
            let source = match element.is("alwaysmanual") {
                true => DriverSource::Input,
                false => draft.turning(rpm),
            };
            if !matches!(source, DriverSource::Input) {
                draft.note(Note::Sense);
            }
            let name = draft.point(to).name.clone();
            draft.drivers.push(Driver {
                name: format!("{name}_angle"),
                coordinate: Coordinate::Angle,
                from,
                to,
                source,
                limits: None,
            });
        }
        Ok(())
    }

    /// Adds the length of an actuator as a driver.
    fn actuator(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        element: &Element,
        per_unit: f64,
    ) -> Result<(), Error> {
        let name = element.label("actuator_");
        let place = format!("link `{name}`");
        let points: Result<Vec<usize>, Error> = element
            .ids("connector")
            .map(|id| self.point(&place, id))
            .collect();
        let points = points?;
        let first = |point: &usize| bodies.at_point[*point].first().copied();
        let ends = match &points[..] {
            [a, b, ..] => first(a).zip(first(b)),
            _ => None,
        };
        let Some((from, to)) = ends else {
            draft.note(Note::LeftOut {
                kind: "actuator",
                name,
                reason: "its ends are on no two links",
            });
            return Ok(());
        };
        let throw = element.number("throw")? / per_unit;
        let cpm = element.number("cpm")?;
        let drawn = draft.drawn(Coordinate::Distance, from, to);
        let end = drawn + throw.copysign(cpm);
        let source = if cpm == 0.0 || throw == 0.0 || end <= 0.0 {
            DriverSource::Input
        } else {
            draft.note(Note::Course { name: name.clone() });
            let half = rounded((end - drawn) / 2.0, 12);
            let unit = draft.unit.name();
            draft.run_for(60.0 / cpm.abs());
            DriverSource::Added(format!("{half}*{unit}*(1 - cos({}*rpm*t))", cpm.abs()))
        };
        draft.drivers.push(Driver {
            name,
            coordinate: Coordinate::Distance,
            from,
            to,
            source,
            limits: (throw != 0.0 && end > 0.0).then(|| [drawn.min(end), drawn.max(end)]),
        });
        Ok(())
    }

    /// Adds the way of a slider.
    fn slider(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        point: usize,
        per_unit: f64,
    ) -> Result<(), Error> {
        let element = self.connectors[point];
        let ends: Vec<&str> = element.ids("slidelimit").collect();
        if !element.is("slider") || bodies.at_point[point].is_empty() {
            return Ok(());
        }
        let name = self.sketch.name(point).to_owned();
        let [a, b] = ends[..] else {
            return Err(Error::SliderWay { slider: name });
        };
        let place = format!("slider `{name}`");
        let [a, b] = [self.point(&place, a)?, self.point(&place, b)?];
        let slid = bodies.at_point[point][0];
        let carriers = bodies.at_point[a].iter().map(|placed| placed.body);
        let carrier = carriers
            .filter(|body| *body != slid.body)
            .find(|body| bodies.on(*body, b).is_some());
        let Some(carrier) = carrier else {
            return Err(Error::SliderWay { slider: name });
        };
        let [from_at, to_at] = [a, b].map(|end| self.sketch.at(end));
        let way = [to_at[0] - from_at[0], to_at[1] - from_at[1]];
        let length = way[0].hypot(way[1]);
        let radius = element.number("slideradius")? / per_unit;
        if radius > 0.0 {
            let at = self.sketch.at(point);
            let centre = arc_centre(from_at, to_at, radius, at);
            let centre = centre.ok_or_else(|| Error::SliderArc {
                slider: name.clone(),
                radius,
            })?;
            let from = draft.add_point(
                carrier,
                Point {
                    name: format!("{name}_centre"),
                    at: centre,
                    angle: None,
                },
            );
            draft.join(&format!("{name}_arc"), JointKind::Link(radius), from, slid);
            draft.note(Note::Limit {
                name,
                reason: "the ends of an arc are no limits of a coordinate",
            });
            return Ok(());
        }
        if length == 0.0 {
            return Err(Error::SliderWay { slider: name });
        }
        let from = draft.add_point(
            carrier,
            Point {
                name: format!("{name}_way"),
                at: from_at,
                angle: Some(way[1].atan2(way[0])),
            },
        );
        draft.join(&format!("{name}_slot"), JointKind::Slot, from, slid);
        draft.stops.push(Stop {
            name: format!("{name}_ends"),
            coordinate: Coordinate::X,
            from,
            to: slid,
            min: Some("0".to_owned()),
            max: Some(format!("{}*{}", rounded(length, 9), draft.unit.name())),
        });
        Ok(())
    }

    /// Adds a pair of gears or a chain.
    fn ratio(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        element: &Element,
        by_id: &BTreeMap<&str, usize>,
        points_of: &[Vec<usize>],
        per_unit: f64,
    ) -> Result<(), Error> {
        let wheels: Vec<&Element> = element
            .children
            .iter()
            .filter(|c| c.name == "link")
            .collect();
        let place = "a ratio".to_owned();
        let &[a, b] = &wheels[..] else {
            return Err(Error::Missing {
                line: element.line,
                place,
                key: "link",
            });
        };
        let link = |wheel: &Element| {
            let id = wheel.id()?;
            by_id.get(id).copied().ok_or_else(|| Error::Unknown {
                place: place.clone(),
                kind: "link",
                name: error::start_of(id),
            })
        };
        let links = [link(a)?, link(b)?];
        let are_radii = element.is("sizeassize");
        let sizes = [a.number("size")?, b.number("size")?].map(|size| match are_radii {
            true => size / per_unit,
            false => size,
        });
        let axle = |link: usize| -> Option<(PointRef, usize)> {
            let point = *points_of[link].first()?;
            Some((bodies.on(bodies.of_link[link], point)?, point))
        };
        let axles = axle(links[0]).zip(axle(links[1]));
        let kind = error::start_of(element.text("type").unwrap_or("gears"));
        let Some(((from, p), (to, q))) = axles.filter(|_| sizes[0] > 0.0 && sizes[1] > 0.0) else {
            draft.note(Note::LeftOut {
                kind: "ratio",
                name: kind,
                reason: "its wheels have no axles or no sizes",
            });
            return Ok(());
        };
        let shares = |body: BodyRef| bodies.on(body, q).is_some();
        let mut carriers = bodies.at_point[p].iter().map(|placed| placed.body);
        let carrier = carriers.find(|body| *body != from.body && *body != to.body && shares(*body));
        let wheels = Wheels {
            sizes,
            are_radii,
            carrier: carrier.unwrap_or(GROUND),
        };
        let names = [from, to].map(|wheel| draft.bodies[wheel.body.0].name.clone());
        let kind = match &*kind {
            "chain" => JointKind::Belt(wheels),
            _ => JointKind::Gear(wheels),
        };
        draft.join(&format!("{}_{}", names[0], names[1]), kind, from, to);
        Ok(())
    }
}

/// Returns the centre of the circle of this radius through two points on which, or nearest to which,
/// a third one lies; `None` if that is off by more than a thousandth of the radius.
fn arc_centre(a: [f64; 2], b: [f64; 2], radius: f64, at: [f64; 2]) -> Option<[f64; 2]> {
    let way = [b[0] - a[0], b[1] - a[1]];
    let length = way[0].hypot(way[1]);
    let height = (radius * radius - length * length / 4.0).max(0.0).sqrt();
    let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
    let normal = [-way[1] / length, way[0] / length];
    let miss = |centre: &[f64; 2]| {
        let distance = (at[0] - centre[0]).hypot(at[1] - centre[1]);
        (distance - radius).abs()
    };
    let centres = [height, -height].map(|h| [middle[0] + h * normal[0], middle[1] + h * normal[1]]);
    let nearest = centres
        .into_iter()
        .min_by(|p, q| miss(p).total_cmp(&miss(q)));
    nearest.filter(|centre| length > 0.0 && miss(centre) <= 1e-3 * radius)
}
