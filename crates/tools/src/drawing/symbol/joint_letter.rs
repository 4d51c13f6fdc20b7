//! Letters of joints.

use super::composer::point_name;
use super::*;
use biela::mechanism::{Coordinate, CoordinateKind, MarkerId};

/// The letter of the joints at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLetter {
    /// The letter, or a short name.
    pub name: String,
    /// The place.
    pub at: Anchor,
}

/// A place that one or several joints hold together.
pub(super) struct JointPlace {
    pub(super) name: String,
    /// The point on each body that has it, or on ground.
    pub(super) points: Vec<Anchor>,
    /// Names of the joints, in the order of the file, then of cylinders.
    joints: Vec<String>,
}

/// Greatest length of a name that stands as a letter.
const SHORT: usize = 3;

/// Returns the places of the joints in the order of the file, then of the ends of cylinders. They
/// have the joints' own names if each place has a short one, otherwise letters that no point of
/// interest has.
pub(super) fn places(composer: &Composer) -> Vec<JointPlace> {
    let mut places: Vec<JointPlace> = Vec::new();
    let anchor = |marker: MarkerId| composer.anchor(marker);
    let joints = composer.mechanism.joints.iter().flat_map(|joint| {
        let points = points_of(joint, anchor);
        points.into_iter().map(|points| (&joint.name, points))
    });
    // A cylinder holds its ends as a link does.
    let cylinders = composer.mechanism.drivers.iter().flat_map(|driver| {
        let Coordinate { kind, from, to, .. } = driver.coordinate;
        let ends = (kind == CoordinateKind::Distance).then(|| [from, to].map(anchor));
        let points = ends.into_iter().flatten().map(|end| vec![end]);
        points.map(|points| (&driver.name, points))
    });
    for (joint, points) in joints.chain(cylinders) {
        let mut place = JointPlace {
            name: String::new(),
            points,
            joints: vec![joint.clone()],
        };
        // Joints that share a point of a body are at one place.
        let index = places.iter().position(|other| other.meets(&place));
        let index = index.unwrap_or(places.len());
        while let Some(other) = places.iter().position(|other| other.meets(&place)) {
            let mut known = places.remove(other);
            known.joints.append(&mut place.joints);
            known.points.append(&mut place.points);
            place = known;
        }
        places.insert(index, place);
    }
    let outputs = composer.mechanism.outputs.markers.iter();
    let taken: Vec<String> = outputs
        .map(|m| point_name(composer.mechanism, *m))
        .collect();
    let short = |place: &JointPlace| {
        let mut names = place.joints.iter();
        names.find(|name| name.len() <= SHORT).cloned()
    };
    let names: Option<Vec<String>> = places.iter().map(short).collect();
    let is_unlike = |names: &Vec<String>| (1..names.len()).all(|k| !names[..k].contains(&names[k]));
    let names = names.filter(is_unlike).unwrap_or_else(|| {
        let free = letters().filter(|letter| !taken.contains(letter));
        free.take(places.len()).collect()
    });
    for (place, name) in places.iter_mut().zip(names) {
        place.name = name;
    }
    places
}

/// Composes the letters. Returns a key of letters that the file does not have.
pub(super) fn compose(composer: &mut Composer, places: &[JointPlace]) -> Vec<String> {
    let is_own = |place: &JointPlace| place.joints.contains(&place.name);
    for place in places {
        let is_named = composer.mechanism.outputs.markers.iter().any(|marker| {
            let point = composer.anchor(*marker);
            point_name(composer.mechanism, *marker) == place.name && place.has(&point)
        });
        if !is_named {
            composer.symbols.push(
                JointLetter {
                    name: place.name.clone(),
                    at: place.points[0],
                }
                .into(),
            );
        }
    }
    if places.iter().all(is_own) {
        return Vec::new();
    }
    let key = places
        .iter()
        .map(|place| format!("{}: {}", place.name, place.joints.join(", ")));
    vec![key.collect::<Vec<_>>().join("; ")]
}

/// Returns the places of a joint, each as the points that are there on bodies whatever the pose.
fn points_of(joint: &Joint, anchor: impl Fn(MarkerId) -> Anchor) -> Vec<Vec<Anchor>> {
    let [from, to] = [joint.from, joint.to].map(&anchor);
    match &joint.kind {
        JointKind::Revolute | JointKind::Weld => vec![vec![from, to]],
        JointKind::Translational
        | JointKind::Slot
        | JointKind::RevoluteTranslational { .. }
        | JointKind::Curve(_) => vec![vec![to]],
        JointKind::Link { .. } => vec![vec![from], vec![to]],
        JointKind::Rope(rope) => {
            let points = rope.points.iter();
            points.map(|point| vec![anchor(point.marker)]).collect()
        }
        // The joints of their bodies have letters.
        JointKind::Gear { .. }
        | JointKind::Belt { .. }
        | JointKind::RackAndPinion { .. }
        | JointKind::Rolling { .. }
        | JointKind::Coupling(_)
        | JointKind::Cam { .. } => Vec::new(),
    }
}

/// Returns A, B and so on; after Z, A1.
fn letters() -> impl Iterator<Item = String> {
    (0..).flat_map(|round| {
        ('A'..='Z').map(move |letter| match round {
            0 => letter.to_string(),
            _ => format!("{letter}{round}"),
        })
    })
}

impl JointPlace {
    /// Returns whether a point of a body is this place.
    pub(super) fn has(&self, point: &Anchor) -> bool {
        self.points.iter().any(|own| are_one(own, point))
    }

    fn meets(&self, other: &Self) -> bool {
        other.points.iter().any(|point| self.has(point))
    }
}

/// Returns whether two anchors are one point of one body, to within rounding.
pub(super) fn are_one(a: &Anchor, b: &Anchor) -> bool {
    let [p, q] = [a, b].map(|anchor| Point::from(anchor.position));
    a.body == b.body && (p - q).norm() <= 1e-9 * p.norm().max(q.norm())
}

impl Shape for JointLetter {
    fn draw(&self, pen: &mut Pen) {
        let (center, ..) = pen.on(self.at);
        let places = Candidate::around(center, PIN + 1.0);
        pen.label(Named::Point, &self.name, Colour::INK, places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
