//! Shapes of bodies, and contacts between them.

use super::super::drawn::inside;
use super::{Editing, Onto, Refusal, ShapeKind, Target, marker_name};
use biela::mechanism::{MarkerId, Shape, ShapeId};

/// Adds a shape to a body: to the `body` that is named, otherwise to one that has all the points. The
/// radius is the distance of `rim`.
pub(super) fn shape(
    editing: &mut Editing,
    kind: ShapeKind,
    body: Option<&str>,
    points: &[Target],
    rim: Option<[f64; 2]>,
) -> Result<(), Refusal> {
    let least = match kind {
        ShapeKind::Disc | ShapeKind::Hole => 1,
        ShapeKind::Bar => 2,
        ShapeKind::Outline => 3,
    };
    if points.len() < least {
        return Err(format!("{} needs {least} points", kind.phrase()).into());
    }
    let body = match body {
        Some(body) => body.to_owned(),
        None => common_body(editing, points)?,
    };
    let settled = points.iter().map(|point| editing.settled(point));
    let places: Vec<[f64; 2]> = settled.collect::<Result<_, _>>()?;
    let radius = rim.map(|rim| editing.rounded(distance(rim, &places)));
    if kind != ShapeKind::Outline && radius.is_none_or(|radius| radius <= 0.0) {
        return Err(format!("{} needs a radius: click further away", kind.phrase()).into());
    }
    let mut corners = Vec::new();
    for place in places {
        let corner = format!("\"{}\"", corner(editing, &body, place)?);
        if corners.contains(&corner) {
            return Err("two points of the shape are one".into());
        }
        corners.push(corner);
    }
    let key = kind.word();
    let corners = match kind {
        ShapeKind::Disc | ShapeKind::Hole => corners.concat(),
        ShapeKind::Bar | ShapeKind::Outline => format!("[{}]", corners.join(", ")),
    };
    let radius = radius.map(|radius| format!(", radius = {}", editing.length(radius)));
    let value = format!("{{ {key} = {corners}{} }}", radius.unwrap_or_default());
    let owner = match &*body {
        "ground" => vec!["ground"],
        body => vec!["bodies", body],
    };
    let numbered = (2..).map(|number| format!("{key}_{number}"));
    let mut names = std::iter::once(key.to_owned()).chain(numbered);
    let is_free = |name: &String| {
        let mut lists = ["markers", "shapes"].into_iter();
        lists.all(|list| !editing.text.has(&[&owner[..], &[list, name]].concat()))
    };
    let name = names.find(is_free).unwrap_or_default();
    let path = [&owner[..], &["shapes", &name]].concat();
    editing.text.set(&path, &value);
    Ok(())
}

/// Keeps the shapes at two places from entering each other.
pub(super) fn contact(editing: &mut Editing, points: &[Target; 2]) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    let [first, second] = [
        shape_at(editing, &points[0])?,
        shape_at(editing, &points[1])?,
    ];
    let of = |id: ShapeId| mechanism.shapes[id.index()].body;
    if of(first) == of(second) {
        return Err("a contact is between shapes of two bodies: choose one of another body".into());
    }
    let [first, second] = [first, second].map(|id| mechanism.shape_path(id));
    let name = editing.names.new_name("contact");
    let value = format!("{{ shapes = [\"{first}\", \"{second}\"] }}");
    editing.text.set(&["contacts", &name], &value);
    Ok(())
}

/// Returns the uppermost shape at a place that is no hole: of the target's body, if it has one.
fn shape_at(editing: &Editing, target: &Target) -> Result<ShapeId, Refusal> {
    let mechanism = editing.mechanism()?;
    let covers = |shape: &Shape| {
        let at = inside(editing.drawn.frame(shape.body), target.at);
        !shape.is_hole() && mechanism.covers(shape, at, &editing.drawn.parameters)
    };
    let here = (0..mechanism.shapes.len()).map(ShapeId);
    let here: Vec<ShapeId> = here
        .filter(|id| covers(&mechanism.shapes[id.index()]))
        .collect();
    let wanted = match &target.onto {
        Onto::Body(name) => Some(mechanism.body_id(name)),
        _ => None,
    };
    let own = here
        .iter()
        .rev()
        .find(|id| wanted == Some(mechanism.shapes[id.index()].body));
    own.or(here.last()).copied().ok_or_else(|| {
        "there is no shape here: draw a bar, a disc or an outline on the body first".into()
    })
}

/// Returns the body that has all points: one that moves rather than ground.
fn common_body(editing: &Editing, points: &[Target]) -> Result<String, Refusal> {
    let mut common: Option<Vec<&str>> = None;
    for point in points {
        let here: Vec<&str> = match &point.onto {
            Onto::Sheet => continue,
            Onto::Ground => vec!["ground"],
            Onto::Body(body) => vec![&*editing.body(body)?.name],
            Onto::Marker(path) => {
                let pinned = editing.drawn.pinned_to(editing.marker(path)?).into_iter();
                let bodies = pinned.map(|id| editing.body_of(id));
                bodies.collect::<Result<_, _>>()?
            }
        };
        common = Some(match common {
            None => here,
            Some(known) => known.into_iter().filter(|b| here.contains(b)).collect(),
        });
    }
    let Some(common) = common else {
        return Err("a shape is part of a body: begin at one of its points or on its bar".into());
    };
    let moving = common.iter().find(|body| **body != "ground");
    let found = moving.or(common.first()).map(|body| (*body).to_owned());
    found.ok_or_else(|| "a shape is part of one body: these points are on different ones".into())
}

/// Returns the name of the marker of a body at a point \[m\], which is added if there is none.
fn corner(editing: &mut Editing, body: &str, at: [f64; 2]) -> Result<String, Refusal> {
    let mechanism = editing.mechanism()?;
    let is_here = |id: &MarkerId| {
        let [x, y, _] = editing.drawn.place(*id);
        f64::hypot(x - at[0], y - at[1]) <= editing.same()
    };
    let mut markers = (0..mechanism.markers.len()).map(MarkerId);
    let own = markers.find(|id| {
        let is_named = !mechanism.markers[id.index()].name.is_empty();
        is_named && editing.body_of(*id).is_ok_and(|owner| owner == body) && is_here(id)
    });
    if let Some(id) = own {
        return Ok(mechanism.markers[id.index()].name.clone());
    }
    let [x, y] = inside(editing.frame(body)?, at);
    let letter = editing.names.new_letter();
    let path = editing.add_marker(body, &letter, [x, y, 0.0]);
    Ok(marker_name(&path).to_owned())
}

/// Returns the distance of a point from the line through points \[m\].
fn distance(from: [f64; 2], points: &[[f64; 2]]) -> f64 {
    let to = |[x, y]: [f64; 2]| f64::hypot(from[0] - x, from[1] - y);
    let ends = points.iter().map(|point| to(*point));
    let feet = points.windows(2).map(|pair| {
        let [[x, y], [u, v]] = [pair[0], pair[1]];
        let [dx, dy] = [u - x, v - y];
        let along = ((from[0] - x) * dx + (from[1] - y) * dy) / (dx * dx + dy * dy);
        to([
            x + along.clamp(0.0, 1.0) * dx,
            y + along.clamp(0.0, 1.0) * dy,
        ])
    });
    ends.chain(feet).fold(f64::INFINITY, f64::min)
}
