//! Bodies and pins of a document.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::xml::Element;
use crate::exchange::draft::{Draft, GROUND};
use crate::exchange::error::{self, Error};
use crate::exchange::note::Note;
use crate::exchange::sketch::{Bodies, Sketch};

/// Layer of drawings, which move nothing.
const DRAWING: &str = "1";

/// The parts of a document that make a mechanism.
pub(super) struct Document<'a> {
    /// Units of the document per unit of the draft.
    pub(super) per_unit: f64,
    pub(super) sketch: Sketch,
    pub(super) connectors: Vec<&'a Element>,
    by_id: HashMap<&'a str, usize>,
    links: Vec<&'a Element>,
    /// Links that are bodies, by their ids: place in the sketch.
    pub(super) link_by_id: BTreeMap<&'a str, usize>,
    /// Points of each link of the sketch.
    pub(super) points_of: Vec<Vec<usize>>,
    ratios: Vec<&'a Element>,
    notes: Vec<Note>,
}

impl<'a> Document<'a> {
    pub(super) fn read(root: &'a Element, per_unit: f64) -> Result<Self, Error> {
        let mut document = Self {
            per_unit,
            sketch: Sketch::default(),
            connectors: Vec::new(),
            by_id: HashMap::new(),
            links: Vec::new(),
            link_by_id: BTreeMap::new(),
            points_of: Vec::new(),
            ratios: Vec::new(),
            notes: Vec::new(),
        };
        let is_drawn = |element: &Element| {
            element.text("layer").map(str::trim) == Some(DRAWING)
                || element.is("measurementelement")
        };
        let mut drawn = 0;
        for child in &root.children {
            match &*child.name {
                "Link" | "element" if is_drawn(child) => drawn += 1,
                "Link" | "element" => document.links.push(child),
                "ratios" => document.ratios.extend(&child.children),
                _ => {}
            }
        }
        // A mechanism may use a point of the drawing.
        let used: HashSet<&str> = {
            let limits = root.children.iter().filter(|child| !is_drawn(child));
            let limits = limits.flat_map(|child| child.ids("slidelimit"));
            let links = document.links.iter();
            limits
                .chain(links.flat_map(|link| link.ids("connector")))
                .collect()
        };
        for child in &root.children {
            if child.name == "connector" {
                if is_drawn(child) && !used.contains(child.id()?) {
                    drawn += 1;
                } else {
                    document.add_connector(child)?;
                }
            }
        }
        if drawn > 0 {
            document.notes.push(Note::Entities {
                count: drawn,
                kind: "element of the drawing".to_owned(),
                reason: "drawings and measures move nothing",
            });
        }
        Ok(document)
    }

    fn add_connector(&mut self, element: &'a Element) -> Result<(), Error> {
        let at = [element.number("x")?, element.number("y")?].map(|x| x / self.per_unit);
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

    pub(super) fn point(&self, place: &str, id: &str) -> Result<usize, Error> {
        self.by_id.get(id).copied().ok_or_else(|| Error::Unknown {
            place: place.to_owned(),
            kind: "connector",
            name: error::start_of(id),
        })
    }

    /// Returns the points of a link.
    pub(super) fn points(&self, place: &str, link: &Element) -> Result<Vec<usize>, Error> {
        let ids = link.ids("connector");
        ids.map(|id| self.point(place, id)).collect()
    }

    pub(super) fn draft(mut self, draft: &mut Draft) -> Result<(), Error> {
        // Actuators are lengths between two points, no bodies.
        let (actuators, links): (Vec<&Element>, Vec<&Element>) =
            self.links.iter().partition(|link| link.is("actuator"));
        let bodies_of = self.with_bodies(&links)?;
        for link in &bodies_of {
            let label = link.label("link_");
            let points = self.points(&format!("link `{label}`"), link)?;
            self.points_of.push(points.clone());
            let added = self.sketch.add_link(&label, points);
            self.link_by_id.insert(link.id()?, added);
        }
        self.fasten(&bodies_of)?;
        self.weld_at_inputs();
        for note in std::mem::take(&mut self.notes) {
            draft.note(note);
        }
        let bodies = self.sketch.build(draft);
        self.inputs(draft, &bodies)?;
        for actuator in actuators {
            self.actuator(draft, &bodies, actuator)?;
        }
        for point in 0..self.connectors.len() {
            self.slider(draft, &bodies, point)?;
        }
        for ratio in &self.ratios {
            self.ratio(draft, &bodies, ratio)?;
        }
        self.outputs(draft, &bodies);
        Ok(())
    }

    /// Returns the links that are bodies: those with two points, gears, and what is fastened.
    fn with_bodies(&mut self, links: &[&'a Element]) -> Result<Vec<&'a Element>, Error> {
        let ratios = self.ratios.iter().flat_map(|ratio| &ratio.children);
        let geared = ratios.filter_map(|wheel| wheel.text("id"));
        let fastened = links.iter().flat_map(|link| link.ids("fastenlink"));
        let carried = self.connectors.iter().flat_map(|at| at.ids("fastenlink"));
        let needed: HashSet<&str> = geared.chain(fastened).chain(carried).collect();
        let mut kept = Vec::new();
        for link in links {
            let count = link.ids("connector").collect::<HashSet<_>>().len();
            let is_held = |key| link.ids(key).next().is_some();
            let is_body = count > 1
                || link.is("gear")
                || is_held("fastenlink")
                || is_held("fastenconnector")
                || needed.contains(link.id()?);
            if is_body {
                kept.push(*link);
            } else {
                self.notes.push(Note::LeftOut {
                    kind: "link",
                    name: link.label("link_"),
                    reason: "with one connector it is no body",
                });
            }
        }
        Ok(kept)
    }

    /// Makes links that are fastened to each other one body, those fastened to an anchor ground, and
    /// connectors points of the link that they are fastened to.
    fn fasten(&mut self, links: &[&'a Element]) -> Result<(), Error> {
        for (index, link) in links.iter().enumerate() {
            let label = link.label("link_");
            for id in link.ids("fastenlink") {
                match self.link_by_id.get(id) {
                    Some(&other) => self.sketch.merge(index, other),
                    None => self.loose(&label, "it is fastened to a link that is no body"),
                }
            }
            for id in link.ids("fastenconnector") {
                let point = self.point(&format!("link `{label}`"), id)?;
                if self.sketch.is_anchor(point) {
                    self.sketch.ground(index);
                } else {
                    self.loose(&label, "it is fastened to a connector that moves");
                }
            }
        }
        for point in 0..self.connectors.len() {
            let element = self.connectors[point];
            let label = self.sketch.name(point).to_owned();
            for id in element.ids("fastenlink") {
                match self.link_by_id.get(id) {
                    Some(&link) => self.sketch.add_to_link(link, point),
                    None => self.loose(&label, "it is fastened to a link that is no body"),
                }
            }
            for id in element.ids("fastenconnector") {
                let other = self.point(&format!("connector `{label}`"), id)?;
                if self.sketch.is_anchor(other) {
                    self.sketch.anchor(point);
                } else {
                    self.loose(&label, "it is fastened to a connector that moves");
                }
            }
        }
        Ok(())
    }

    fn loose(&mut self, name: &str, reason: &'static str) {
        self.notes.push(Note::LeftOut {
            kind: "the fastening of",
            name: name.to_owned(),
            reason,
        });
    }

    /// Makes all links that an input turns one body. A link with two anchors stands still.
    fn weld_at_inputs(&mut self) {
        for (point, element) in self.connectors.iter().enumerate() {
            if !element.is("input") || !element.is("anchor") {
                continue;
            }
            let links = 0..self.points_of.len();
            let turned = links.filter(|link| self.points_of[*link].contains(&point));
            let turned: Vec<usize> = turned
                .filter(|link| !self.sketch.is_standing(*link))
                .collect();
            for pair in turned.windows(2) {
                self.sketch.merge(pair[0], pair[1]);
            }
        }
    }

    /// Adds traced points, and tells connectors that nothing has.
    fn outputs(&self, draft: &mut Draft, bodies: &Bodies) {
        for (point, element) in self.connectors.iter().enumerate() {
            let refs = &bodies.at_point[point];
            if element.is("draw") {
                match refs.iter().find(|placed| placed.body != GROUND) {
                    Some(moving) => draft.outputs.push(*moving),
                    None => draft.note(Note::LeftOut {
                        kind: "the trace of",
                        name: self.sketch.name(point).to_owned(),
                        reason: "the point does not move",
                    }),
                }
            }
            if refs.is_empty() {
                draft.note(Note::LeftOut {
                    kind: "connector",
                    name: self.sketch.name(point).to_owned(),
                    reason: "no link has it",
                });
            }
        }
    }
}
