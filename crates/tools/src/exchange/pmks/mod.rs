//! Links of PMKS+, whose query is the mechanism.
//!
//! | file | subject |
//! |---|---|
//! | `digits` | numbers and flags in 64 digits |
//! | `link` | the query, taken apart |
//! | `load` | masses and forces |
//! | `write` | links that open a mechanism there |

mod digits;
mod link;
mod load;
mod write;

use std::collections::{HashMap, HashSet};

use super::draft::{
    BodyRef, Coordinate, Draft, Driver, DriverSource, GROUND, JointKind, LengthUnit, Point,
};
use super::error::{Error, start_of};
use super::note::Note;
use super::sketch::{Bodies, Sketch};
use link::{Joint, Query};
pub use write::pmks_link;

/// Returns whether a text is a link of PMKS+, or its query.
pub(super) fn is_start(text: &str) -> bool {
    link::query(text).is_some()
}

/// A link on its way into a draft.
struct Reader<'a> {
    query: &'a Query,
    /// Points by the ids of their joints.
    points: HashMap<&'a str, usize>,
    /// Bodies by the ids of their links, parts of links among them.
    body_of: HashMap<&'a str, BodyRef>,
    bodies: Bodies,
    /// Bodies that are blocks of sliders.
    blocks: Vec<BodyRef>,
}

/// Reads a link.
pub(super) fn read(text: &str, draft: &mut Draft) -> Result<(), Error> {
    let query = link::query(text).ok_or(Error::UnknownFormat)?;
    let mut query = Query::read(&query)?;
    let others = std::mem::take(&mut query.others);
    // Ten micrometres, or ten thousandths of an inch or of a metre.
    draft.digits = 10;
    draft.unit = query.unit;
    let reader = Reader::new(&query, draft)?;
    for (point, joint) in query.joints.iter().enumerate() {
        if joint.is_prismatic {
            reader.slide(draft, point, joint)?;
        } else if joint.is_input {
            reader.turn(draft, point, joint);
        }
        if joint.shows_curve {
            let mut moving = reader.bodies.at_point[point].iter();
            let moving = moving.find(|placed| placed.body != GROUND);
            let is_fixed = joint.is_grounded || joint.is_prismatic;
            draft.outputs.extend(moving.filter(|_| !is_fixed).copied());
        }
    }
    reader.masses(draft);
    reader.forces(draft)?;
    others.note(draft);
    Ok(())
}

impl<'a> Reader<'a> {
    /// Adds the bodies and their pins.
    fn new(query: &'a Query, draft: &mut Draft) -> Result<Self, Error> {
        let mut sketch = Sketch::default();
        let mut points = HashMap::new();
        for joint in &query.joints {
            let point = sketch.add_point(&joint.name, joint.at);
            if joint.is_grounded && !joint.is_prismatic {
                sketch.anchor(point);
            }
            points.insert(&*joint.id, point);
        }
        let has_root = query.links.iter().any(|link| link.is_root);
        let mut added = HashMap::new();
        let mut blocks = Vec::new();
        let mut on_point: Vec<Vec<usize>> = vec![Vec::new(); query.joints.len()];
        for link in &query.links {
            if has_root && !link.is_root {
                continue;
            }
            let on_link: Result<Vec<usize>, Error> = link
                .joints
                .iter()
                .map(|id| {
                    points.get(&**id).copied().ok_or_else(|| Error::Unknown {
                        place: format!("link `{}`", start_of(&link.name)),
                        kind: "joint",
                        name: start_of(id),
                    })
                })
                .collect();
            let on_link = on_link?;
            let index = sketch.add_link(&link.name, on_link.clone());
            for point in on_link {
                on_point[point].push(index);
            }
            added.insert(&*link.id, index);
            if link.is_block {
                blocks.push(index);
            }
        }
        // All links on a welded pin are one.
        for (joint, links) in query.joints.iter().zip(&on_point) {
            if joint.is_welded && !joint.is_prismatic {
                for pair in links.windows(2) {
                    sketch.merge(pair[0], pair[1]);
                }
            }
        }
        let bodies = sketch.build(draft);
        let mut body_of = HashMap::new();
        let by_id: HashMap<&str, &link::Link> =
            query.links.iter().map(|link| (&*link.id, link)).collect();
        for (id, index) in &added {
            body_of.insert(*id, bodies.of_link[*index]);
        }
        // A part of several links belongs to the first of them.
        let mut seen = HashSet::new();
        for link in &query.links {
            let Some(index) = added.get(&*link.id) else {
                continue;
            };
            let mut open = vec![&*link.id];
            while let Some(id) = open.pop() {
                if seen.insert(id) {
                    body_of.entry(id).or_insert(bodies.of_link[*index]);
                    let parts = by_id.get(id).map_or(&[][..], |link| &link.parts);
                    open.extend(parts.iter().map(|id| &**id));
                }
            }
        }
        let blocks = blocks.iter().map(|link| bodies.of_link[*link]).collect();
        Ok(Self {
            query,
            points,
            body_of,
            bodies,
            blocks,
        })
    }

    /// Adds a pin that is turned.
    fn turn(&self, draft: &mut Draft, point: usize, joint: &Joint) {
        let left_out = |reason| Note::LeftOut {
            kind: "input",
            name: start_of(&joint.name),
            reason,
        };
        let [from, to, others @ ..] = &self.bodies.at_point[point][..] else {
            draft.note(left_out("no link turns about it"));
            return;
        };
        if !others.is_empty() {
            draft.note(left_out("a further link is free to turn about it"));
        }
        let rpm = match joint.speed {
            None => self.query.rpm,
            Some(speed) => {
                if self.query.is_clockwise {
                    draft.note(Note::OwnSpeed {
                        name: start_of(&joint.name),
                    });
                }
                speed
            }
        };
        let source = draft.turning(rpm);
        draft.drivers.push(Driver {
            name: format!("{}_angle", joint.name),
            coordinate: Coordinate::Angle,
            from: *from,
            to: *to,
            source,
            limits: None,
        });
    }

    /// Adds the way of a slider on ground or on a link: of a block or a welded slider without turning,
    /// of any other body through a slot.
    fn slide(&self, draft: &mut Draft, point: usize, joint: &Joint) -> Result<(), Error> {
        let unknown = |kind, id: &str| Error::Unknown {
            place: format!("slider `{}`", start_of(&joint.name)),
            kind,
            name: start_of(id),
        };
        let (carrier, at, angle) = match &joint.slot {
            Some([link, a, b]) => {
                let carrier = self.body_of.get(&**link);
                let carrier = carrier.ok_or_else(|| unknown("link", link))?;
                let place = |id: &String| -> Result<[f64; 2], Error> {
                    let point = self.points.get(&**id);
                    let point = point.ok_or_else(|| unknown("joint", id))?;
                    Ok(self.query.joints[*point].at)
                };
                let [a, b] = [place(a)?, place(b)?];
                draft.note(Note::Limit {
                    name: start_of(&joint.name),
                    reason: "the slot goes on beyond its ends",
                });
                (*carrier, a, (b[1] - a[1]).atan2(b[0] - a[0]))
            }
            None if joint.is_grounded => (GROUND, joint.at, joint.angle),
            None => {
                return Err(Error::UnknownJoint {
                    joint: start_of(&joint.name),
                    class: "slider without a way".to_owned(),
                });
            }
        };
        let left_out = |reason| Note::LeftOut {
            kind: "slider",
            name: start_of(&joint.name),
            reason,
        };
        let Some(&slid) = self.bodies.at_point[point].first() else {
            draft.note(left_out("no link has it"));
            return Ok(());
        };
        if slid.body == carrier {
            draft.note(left_out("its way is on its own body"));
            return Ok(());
        }
        let from = draft.add_point(
            carrier,
            Point {
                name: format!("{}_way", joint.name),
                at,
                angle: Some(angle),
            },
        );
        let keeps = joint.is_welded || self.blocks.contains(&slid.body);
        let kind = if keeps {
            JointKind::Translational
        } else {
            JointKind::Slot
        };
        if keeps {
            draft.bodies[slid.body.0].points[slid.point].angle = Some(angle);
        }
        draft.join(&format!("{}_slide", joint.name), kind, from, slid);
        if joint.is_input {
            let name = format!("{}_travel", joint.name);
            let speed = joint.speed.unwrap_or(self.query.linear_speed);
            draft.note(Note::Motion {
                name: name.clone(),
                text: format!("a speed of {speed} {}/s", draft.unit.name()),
            });
            draft.drivers.push(Driver {
                name,
                coordinate: Coordinate::X,
                from,
                to: slid,
                source: DriverSource::Input,
                limits: None,
            });
        }
        Ok(())
    }
}

impl LengthUnit {
    /// Returns the unit of an index of PMKS+.
    fn of_pmks(index: u64) -> Option<Self> {
        match index {
            0 => Some(Self::Inch),
            1 => Some(Self::Centimetre),
            2 => Some(Self::Metre),
            _ => None,
        }
    }
}
