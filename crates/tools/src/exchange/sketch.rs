//! A draft from named points, links through them and anchors.

use std::collections::BTreeMap;

use super::draft::{BodyRef, Draft, GROUND, JointKind, Point, PointRef};
use super::error::start_of;
use super::note::Note;

/// Most bodies on one point between which rigid pairs are sought.
const MOST_PAIRED: usize = 32;

/// Points, links through them, and anchors, as programs for linkages have them.
#[derive(Debug, Default)]
pub(super) struct Sketch {
    points: Vec<(String, [f64; 2])>,
    links: Vec<Link>,
    anchors: Vec<bool>,
}

#[derive(Debug)]
struct Link {
    name: String,
    points: Vec<usize>,
    /// The link that it is one body with, itself if none comes before it.
    group: usize,
    is_ground: bool,
}

/// A sketch as bodies of a draft.
#[derive(Debug)]
pub(super) struct Bodies {
    /// Body of each link.
    pub(super) of_link: Vec<BodyRef>,
    /// Bodies through each point, in the order of their pins.
    pub(super) at_point: Vec<Vec<PointRef>>,
}

impl Sketch {
    pub(super) fn add_point(&mut self, name: &str, at: [f64; 2]) -> usize {
        self.points.push((start_of(name), at));
        self.anchors.push(false);
        self.points.len() - 1
    }

    pub(super) fn add_link(&mut self, name: &str, mut points: Vec<usize>) -> usize {
        let mut seen = std::collections::BTreeSet::new();
        points.retain(|point| seen.insert(*point));
        let group = self.links.len();
        self.links.push(Link {
            name: start_of(name),
            points,
            group,
            is_ground: false,
        });
        group
    }

    pub(super) fn anchor(&mut self, point: usize) {
        self.anchors[point] = true;
    }

    pub(super) fn is_anchor(&self, point: usize) -> bool {
        self.anchors[point]
    }

    /// Adds a point to a link.
    pub(super) fn add_to_link(&mut self, link: usize, point: usize) {
        let points = &mut self.links[link].points;
        if !points.contains(&point) {
            points.push(point);
        }
    }

    /// Returns whether a link has two anchors, so that it is ground.
    pub(super) fn is_standing(&self, link: usize) -> bool {
        let points = self.links[link].points.iter();
        let mut anchored = points.filter(|point| self.anchors[**point]);
        let first = anchored.next();
        first.is_some_and(|first| anchored.any(|point| self.are_apart(*first, *point)))
    }

    pub(super) fn at(&self, point: usize) -> [f64; 2] {
        self.points[point].1
    }

    /// Returns whether two points are at different places.
    fn are_apart(&self, a: usize, b: usize) -> bool {
        self.at(a).map(f64::to_bits) != self.at(b).map(f64::to_bits)
    }

    pub(super) fn name(&self, point: usize) -> &str {
        &self.points[point].0
    }

    /// Makes a link part of ground.
    pub(super) fn ground(&mut self, link: usize) {
        let group = self.group(link);
        self.links[group].is_ground = true;
    }

    /// Makes two links one body.
    pub(super) fn merge(&mut self, a: usize, b: usize) {
        let (a, b) = (self.group(a), self.group(b));
        let (first, second) = (a.min(b), a.max(b));
        self.links[second].group = first;
        self.links[first].is_ground |= self.links[second].is_ground;
    }

    /// Returns the link that stands for a link's body.
    fn group(&mut self, mut link: usize) -> usize {
        loop {
            let next = self.links[link].group;
            if next == link {
                return link;
            }
            // Ways become shorter each time they are gone.
            self.links[link].group = self.links[next].group;
            link = next;
        }
    }

    /// Makes links with two anchors ground, and links that share two places one body.
    fn join_rigid(&mut self) {
        for link in 0..self.links.len() {
            if self.is_standing(link) {
                self.ground(link);
            }
        }
        while self.merge_pairs() {}
    }

    /// Merges links that share two places; returns whether there were any.
    fn merge_pairs(&mut self) -> bool {
        let mut groups_at: Vec<Vec<usize>> = vec![Vec::new(); self.points.len()];
        for link in 0..self.links.len() {
            let group = self.group(link);
            for &point in &self.links[link].points {
                let groups = &mut groups_at[point];
                if groups.len() < MOST_PAIRED && !groups.contains(&group) {
                    groups.push(group);
                }
            }
        }
        let mut shared: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut found = Vec::new();
        for (point, groups) in groups_at.iter().enumerate() {
            for (index, &a) in groups.iter().enumerate() {
                for &b in &groups[..index] {
                    let first = *shared.entry([a.min(b), a.max(b)]).or_insert(point);
                    if self.are_apart(first, point) {
                        found.push([a, b]);
                    }
                }
            }
        }
        for &[a, b] in &found {
            self.merge(a, b);
        }
        !found.is_empty()
    }

    /// Adds the bodies and their pins to a draft. Pins are named by their points.
    pub(super) fn build(&mut self, draft: &mut Draft) -> Bodies {
        self.join_rigid();
        let mut body_of_group = BTreeMap::new();
        let mut of_link = Vec::new();
        for link in 0..self.links.len() {
            let group = self.group(link);
            let is_ground = self.links[group].is_ground;
            let name = &self.links[link].name;
            let body = *body_of_group.entry(group).or_insert_with(|| {
                if is_ground {
                    GROUND
                } else {
                    draft.add_body(name)
                }
            });
            if is_ground {
                draft.note(Note::Grounded { name: name.clone() });
            } else if group != link {
                draft.note(Note::Merged {
                    name: self.links[group].name.clone(),
                    other: name.clone(),
                });
            }
            of_link.push(body);
        }
        let mut at_point: Vec<Vec<PointRef>> = vec![Vec::new(); self.points.len()];
        for (point, refs) in at_point.iter_mut().enumerate() {
            if self.anchors[point] {
                refs.push(self.place(draft, GROUND, point));
            }
        }
        for (link, &body) in of_link.iter().enumerate() {
            for &point in &self.links[link].points {
                if at_point[point].iter().all(|known| known.body != body) {
                    let placed = self.place(draft, body, point);
                    // Ground comes first.
                    match body {
                        GROUND => at_point[point].insert(0, placed),
                        _ => at_point[point].push(placed),
                    }
                }
            }
        }
        for (point, refs) in at_point.iter().enumerate() {
            if let [first, others @ ..] = &refs[..] {
                for &other in others {
                    draft.join(&self.points[point].0, JointKind::Revolute, *first, other);
                }
            }
        }
        Bodies { of_link, at_point }
    }

    /// Adds a point to a body.
    pub(super) fn place(&self, draft: &mut Draft, body: BodyRef, point: usize) -> PointRef {
        let (name, at) = &self.points[point];
        let point = Point {
            name: name.clone(),
            at: *at,
            angle: None,
        };
        draft.add_point(body, point)
    }
}

impl Bodies {
    /// Returns the point of a body at a point of the sketch.
    pub(super) fn on(&self, body: BodyRef, point: usize) -> Option<PointRef> {
        let mut refs = self.at_point[point].iter().copied();
        refs.find(|placed| placed.body == body)
    }
}
