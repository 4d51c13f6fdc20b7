//! Links of PMKS+, whose query is the mechanism.
//!
//! | file | subject |
//! |---|---|
//! | `digits` | numbers and flags in 64 digits |
//! | `link` | the query, taken apart |
//! | `write` | links that open a mechanism there |

mod digits;
mod link;
mod write;

use std::collections::HashMap;

use super::draft::{Coordinate, Draft, Driver, DriverSource, GROUND, JointKind, LengthUnit, Point};
use super::error::{Error, start_of};
use super::note::Note;
use super::sketch::{Bodies, Sketch};
use link::{Joint, Query};
pub use write::pmks_link;

/// Returns whether a text is a link of PMKS+, or its query.
pub(super) fn is_start(text: &str) -> bool {
    link::query(text).is_some()
}

/// Reads a link.
pub(super) fn read(text: &str, draft: &mut Draft) -> Result<(), Error> {
    let query = link::query(text).ok_or(Error::UnknownFormat)?;
    let query = Query::read(&query)?;
    // Ten micrometres, or ten thousandths of an inch or of a metre.
    draft.digits = 10;
    draft.unit = query.unit;
    let mut sketch = Sketch::default();
    let mut by_id = HashMap::new();
    for joint in &query.joints {
        let point = sketch.add_point(&joint.name, joint.at);
        if joint.is_grounded && !joint.is_prismatic {
            sketch.anchor(point);
        }
        by_id.insert(&*joint.id, point);
    }
    let has_root = query.links.iter().any(|link| link.is_root);
    let links = query.links.iter().filter(|link| link.is_root || !has_root);
    let mut blocks = Vec::new();
    for link in links {
        let points: Result<Vec<usize>, Error> = link
            .joints
            .iter()
            .map(|id| {
                by_id.get(&**id).copied().ok_or_else(|| Error::Unknown {
                    place: format!("link `{}`", start_of(&link.name)),
                    kind: "joint",
                    name: start_of(id),
                })
            })
            .collect();
        let added = sketch.add_link(&link.name, points?);
        if link.is_block {
            blocks.push(added);
        }
    }
    let bodies = sketch.build(draft);
    let blocks: Vec<_> = blocks.iter().map(|link| bodies.of_link[*link]).collect();
    for (point, joint) in query.joints.iter().enumerate() {
        if joint.is_prismatic {
            slide(draft, &bodies, point, joint, &blocks)?;
        } else if joint.is_input {
            turn(draft, &bodies, point, joint, &query);
        }
        if joint.shows_curve {
            let mut moving = bodies.at_point[point].iter();
            let moving = moving.find(|placed| placed.body != GROUND);
            let is_fixed = joint.is_grounded || joint.is_prismatic;
            draft.outputs.extend(moving.filter(|_| !is_fixed).copied());
        }
    }
    if query.has_masses {
        draft.note(Note::Masses {
            reason: "the link does not tell their unit",
        });
    }
    if query.forces > 0 {
        draft.note(Note::Forces {
            count: query.forces,
        });
    }
    Ok(())
}

/// Adds a pin that is turned.
fn turn(draft: &mut Draft, bodies: &Bodies, point: usize, joint: &Joint, query: &Query) {
    let [from, to, ..] = bodies.at_point[point][..] else {
        return;
    };
    let source = draft.turning(query.rpm);
    draft.drivers.push(Driver {
        name: format!("{}_angle", joint.name),
        coordinate: Coordinate::Angle,
        from,
        to,
        source,
        limits: None,
    });
}

/// Adds the way of a slider on ground: of a block without turning, of any other body through a slot.
fn slide(
    draft: &mut Draft,
    bodies: &Bodies,
    point: usize,
    joint: &Joint,
    blocks: &[super::draft::BodyRef],
) -> Result<(), Error> {
    if !joint.is_grounded {
        return Err(Error::UnknownJoint {
            joint: start_of(&joint.name),
            class: "slider on a moving link".to_owned(),
        });
    }
    let Some(&slid) = bodies.at_point[point].first() else {
        return Ok(());
    };
    let from = draft.add_point(
        GROUND,
        Point {
            name: format!("{}_way", joint.name),
            at: joint.at,
            angle: Some(joint.angle),
        },
    );
    let is_block = blocks.contains(&slid.body);
    let kind = match is_block {
        true => JointKind::Translational,
        false => JointKind::Slot,
    };
    if is_block {
        draft.bodies[slid.body.0].points[slid.point].angle = Some(joint.angle);
    }
    draft.join(&format!("{}_slide", joint.name), kind, from, slid);
    if joint.is_input {
        let name = format!("{}_travel", joint.name);
        draft.note(Note::Motion {
            name: name.clone(),
            text: "speed of a slider".to_owned(),
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

impl LengthUnit {
    /// Returns the unit of an index of PMKS+.
    fn of_pmks(index: u64) -> Self {
        match index {
            0 => Self::Inch,
            2 => Self::Metre,
            _ => Self::Centimetre,
        }
    }
}
