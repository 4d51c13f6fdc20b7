//! Points that are moved while the mechanism is designed: its geometry changes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::super::drawn::within_turn;
use super::super::drawn::{Drawn, inside, outside};
use super::mass::followed;
use super::{Editing, Refusal, Through, exact_angle};
use crate::write::{NumberInUnit, written};
use biela::mechanism::{BodyId, DriverSource, MarkerId, Mechanism};

/// Change of a number below which it stays as it is \[m or rad\].
pub(super) const UNCHANGED: f64 = 1e-9;

/// Parts of the text that are replaced together: it is read once for all of them.
#[derive(Default)]
struct Parts {
    replaced: Vec<(Range<usize>, String)>,
    /// Estimates that the file does not have yet, by the names of their bodies.
    added: Vec<(String, String)>,
}

impl Parts {
    fn replace(&mut self, place: Range<usize>, with: String) {
        self.replaced.retain(|(other, _)| *other != place);
        self.replaced.push((place, with));
    }

    /// Takes the numbers of markers, of masses that follow them, and of estimates.
    fn take(
        &mut self,
        editing: &Editing,
        mechanism: &Mechanism,
        meant: &Meant,
        through: Option<Through>,
    ) -> Result<(), Refusal> {
        for (marker, place) in &meant.inside {
            set_marker(editing, self, mechanism, *marker, *place, through)?;
        }
        for (body, frame) in &meant.frames {
            set_estimate(editing, self, mechanism, BodyId(*body), *frame);
        }
        for body in &mechanism.bodies {
            if body.markers.iter().any(|id| meant.inside.contains_key(id)) {
                let inside = |id: MarkerId| {
                    let place = meant.inside.get(&id).copied();
                    place.unwrap_or_else(|| editing.drawn.inside(id))
                };
                for (place, with) in followed(editing, body, None, inside) {
                    self.replace(place, with);
                }
            }
        }
        Ok(())
    }

    fn write(mut self, editing: &mut Editing) {
        self.replaced.sort_by_key(|(place, _)| place.start);
        editing.text.replace_all(&self.replaced);
        for (body, estimate) in self.added {
            editing.text.set(&["bodies", &body, "estimate"], &estimate);
        }
    }
}

/// The places that are meant.
struct Meant {
    /// New frames of bodies.
    frames: BTreeMap<usize, [f64; 3]>,
    /// New places of markers in the frames of their bodies.
    inside: BTreeMap<MarkerId, [f64; 3]>,
}

/// Moves the points at `markers`, with all that is pinned to them, by the way `by` \[m\]. Where a number
/// is an expression, `through` says whether its `parameter` changes or the `number` takes its place.
pub(super) fn shift(
    editing: &mut Editing,
    markers: &[String],
    by: [f64; 2],
    through: Option<Through>,
) -> Result<(), Refusal> {
    let markers = markers.iter().map(|path| editing.marker(path));
    let markers: Vec<MarkerId> = markers.collect::<Result<_, _>>()?;
    if markers.is_empty() {
        return Err("no point is to be moved".into());
    }
    move_points(editing, &markers, by, through)
}

/// Moves points with all that is pinned to them. A bar gets another length and direction, a plate
/// another shape, and a body all of whose points move goes along. Start values of drivers follow.
pub(super) fn move_points(
    editing: &mut Editing,
    markers: &[MarkerId],
    by: [f64; 2],
    through: Option<Through>,
) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    let mut moved: BTreeSet<MarkerId> = BTreeSet::new();
    for marker in markers {
        moved.extend(editing.drawn.pinned_to(*marker));
    }
    let meant = meant(editing, mechanism, &moved, by);
    let mut parts = Parts::default();
    parts.take(editing, mechanism, &meant, through)?;
    set_starts(editing, &mut parts, mechanism, &meant);
    parts.write(editing);
    Ok(())
}

/// Moves a point on its body alone: what is pinned to it follows where the mechanism closes, and all
/// other lengths and the starts of drivers stay.
pub(super) fn move_alone(
    editing: &mut Editing,
    marker: MarkerId,
    by: [f64; 2],
    through: Option<Through>,
) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    let meant = meant(editing, mechanism, &BTreeSet::from([marker]), by);
    let mut parts = Parts::default();
    parts.take(editing, mechanism, &meant, through)?;
    parts.write(editing);
    Ok(())
}

/// Returns the frames and places in which the moved markers have gone the way.
fn meant(
    editing: &Editing,
    mechanism: &Mechanism,
    moved: &BTreeSet<MarkerId>,
    by: [f64; 2],
) -> Meant {
    let drawn = editing.drawn;
    let mut meant = Meant {
        frames: BTreeMap::new(),
        inside: BTreeMap::new(),
    };
    let there = |marker: MarkerId| {
        let [x, y] = drawn.point(marker);
        if moved.contains(&marker) {
            [x + by[0], y + by[1]].map(|x| drawn.settled(x))
        } else {
            [x, y]
        }
    };
    for marker in moved {
        if mechanism.markers[marker.index()].body.is_none() {
            let [x, y] = there(*marker);
            let [_, _, turn] = drawn.inside(*marker);
            meant.inside.insert(*marker, [x, y, turn]);
        }
    }
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let mine: Vec<MarkerId> = (body.markers.iter().copied())
            .filter(|marker| moved.contains(marker))
            .collect();
        let frame = drawn.frame(Some(BodyId(index)));
        if mine.is_empty() {
            continue;
        }
        if mine.len() == body.markers.len() {
            let [x, y, phi] = frame;
            meant.frames.insert(index, [x + by[0], y + by[1], phi]);
            continue;
        }
        if let Some([foot, head]) = ends_of_bar(editing, &body.markers) {
            let ([x, y], [u, v]) = (there(foot), there(head));
            let [dx, dy] = [u - x, v - y];
            meant.frames.insert(index, [x, y, f64::atan2(dy, dx)]);
            meant.inside.insert(head, [f64::hypot(dx, dy), 0.0, 0.0]);
            continue;
        }
        for marker in mine {
            let [x, y] = inside(frame, there(marker));
            let [_, _, turn] = drawn.inside(marker);
            meant.inside.insert(marker, [x, y, turn]);
        }
    }
    meant
}

/// Returns foot and head of a bar: two markers, one at the origin, the other on the x-axis.
pub(super) fn ends_of_bar(editing: &Editing, markers: &[MarkerId]) -> Option<[MarkerId; 2]> {
    let [a, b] = markers else {
        return None;
    };
    let places = [*a, *b].map(|marker| editing.drawn.inside(marker));
    let is_origin = |[x, y, turn]: [f64; 3]| x == 0.0 && y == 0.0 && turn == 0.0;
    let is_ahead = |[x, y, turn]: [f64; 3]| x > 0.0 && y == 0.0 && turn == 0.0;
    if is_origin(places[0]) && is_ahead(places[1]) {
        Some([*a, *b])
    } else if is_origin(places[1]) && is_ahead(places[0]) {
        Some([*b, *a])
    } else {
        None
    }
}

fn set_marker(
    editing: &Editing,
    parts: &mut Parts,
    mechanism: &Mechanism,
    marker: MarkerId,
    place: [f64; 3],
    through: Option<Through>,
) -> Result<(), Refusal> {
    let name = &mechanism.markers[marker.index()].name;
    let body = editing.body_of(marker)?;
    let path: Vec<&str> = match body {
        "ground" => vec!["ground", "markers", name],
        body => vec!["bodies", body, "markers", name],
    };
    let now = editing.drawn.inside(marker);
    if editing.text.element(&path, 0).is_some() {
        for index in 0..2 {
            if (place[index] - now[index]).abs() > UNCHANGED {
                set_number(
                    editing,
                    parts,
                    mechanism,
                    &path,
                    Some(index),
                    place[index],
                    through,
                )?;
            }
        }
        return Ok(());
    }
    // In polar form.
    let polar = |[x, y, _]: [f64; 3]| [f64::hypot(x, y), f64::atan2(y, x)];
    for (key, (new, old)) in ["r", "angle"]
        .into_iter()
        .zip(polar(place).into_iter().zip(polar(now)))
    {
        if (new - old).abs() > UNCHANGED {
            let path: Vec<&str> = path.iter().copied().chain([key]).collect();
            set_number(editing, parts, mechanism, &path, None, new, through)?;
        }
    }
    Ok(())
}

fn set_estimate(
    editing: &Editing,
    parts: &mut Parts,
    mechanism: &Mechanism,
    body: BodyId,
    frame: [f64; 3],
) {
    let name = &mechanism.bodies[body.index()].name;
    let path = ["bodies", &**name, "estimate"];
    if editing.text.element(&path, 0).is_none() {
        parts.added.push((name.clone(), editing.estimate(frame)));
        return;
    }
    for (index, value) in editing.drawn.settled_frame(frame).into_iter().enumerate() {
        let Some(place) = editing.text.element(&path, index) else {
            continue;
        };
        let old = editing.text.as_str()[place.clone()].to_owned();
        if let Some(new) = in_place_of(editing, &old, value, index == 2) {
            parts.replace(place, new);
        }
    }
}

/// Lets the drivers start where the mechanism is meant to be.
fn set_starts(editing: &Editing, parts: &mut Parts, mechanism: &Mechanism, meant: &Meant) {
    let drawn = editing.drawn;
    let place = |marker: MarkerId| {
        let body = mechanism.markers[marker.index()].body;
        let frame = body.and_then(|body| meant.frames.get(&body.index()).copied());
        let frame = frame.unwrap_or_else(|| drawn.frame(body));
        let inside = meant.inside.get(&marker).copied();
        outside(frame, inside.unwrap_or_else(|| drawn.inside(marker)))
    };
    for driver in &mechanism.drivers {
        let (section, start) = match driver.source {
            DriverSource::Input { start } => ("drivers", start),
            DriverSource::Free { start, .. } => ("freedoms", start),
            DriverSource::Motion(_) => continue,
        };
        let is_angle = driver.coordinate.kind.is_angle();
        let change = Drawn::value_at(driver.coordinate, place) - drawn.value(driver.coordinate);
        let change = if is_angle {
            within_turn(change)
        } else {
            change
        };
        let path = [section, &*driver.name, "start"];
        if change.abs() <= UNCHANGED {
            continue;
        }
        if let Some(place) = editing.text.place(&path)
            && let old = &editing.text.as_str()[place.clone()]
            && let value = drawn.settled_value(start + change, is_angle)
            && let Some(new) = in_place_of(editing, old, value, is_angle)
        {
            parts.replace(place, new);
        }
    }
}

/// Sets a number at a path, or an element of the list there.
fn set_number(
    editing: &Editing,
    parts: &mut Parts,
    mechanism: &Mechanism,
    path: &[&str],
    element: Option<usize>,
    value: f64,
    through: Option<Through>,
) -> Result<(), Refusal> {
    let is_angle = path.last() == Some(&"angle");
    let Some(place) = editing.text.number(path, element) else {
        return Err(format!(
            "`{}` has another form than this gesture knows",
            path.join(".")
        )
        .into());
    };
    let old = editing.text.as_str()[place.clone()].to_owned();
    let new = match in_place_of(editing, &old, value, is_angle) {
        Some(new) => new,
        None if through == Some(Through::Number) => editing.value(value, is_angle),
        None => {
            let formula = old.trim_matches('"').to_owned();
            let (parameter, wanted) = parameter_for(mechanism, editing, &formula, value)?;
            if through == Some(Through::Parameter)
                && let Some(wanted) = wanted
            {
                return set_parameter(editing, parts, &parameter, wanted, is_angle);
            }
            return Err(Refusal::Ask {
                parameter,
                formula,
                value: wanted,
            });
        }
    };
    parts.replace(place, new);
    Ok(())
}

/// Returns a number as it stands in place of an old one: in its unit. `None` in place of an
/// expression.
fn in_place_of(editing: &Editing, old: &str, value: f64, is_angle: bool) -> Option<String> {
    let Some(own) = NumberInUnit::of(old) else {
        let old = old.trim().replace('_', "").parse::<f64>().ok()?;
        // An angle that was zero says nothing about its unit.
        return Some(if is_angle && old != 0.0 {
            written(exact_angle(value, 1.0))
        } else {
            editing.value(value, is_angle)
        });
    };
    let number = if is_angle {
        exact_angle(value, own.factor())
    } else {
        editing.exact(value, own.factor())
    };
    Some(own.write(&written(number)))
}

/// Returns the one parameter of an expression, with the value that gives the expression another one;
/// no value where the expression is not linear in it.
fn parameter_for(
    mechanism: &Mechanism,
    editing: &Editing,
    formula: &str,
    value: f64,
) -> Result<(String, Option<f64>), Refusal> {
    let expression = mechanism.parse_expression(formula, None);
    let expression = expression.map_err(|error| error.to_string())?;
    let mut used: Vec<_> = expression.parameters().collect();
    used.sort_unstable();
    used.dedup();
    let [parameter] = used[..] else {
        let names: Vec<String> = (used.iter())
            .map(|id| mechanism.parameters[id.index()].name.clone())
            .collect();
        return Ok((names.join(", "), None));
    };
    let own = &mechanism.parameters[parameter.index()];
    let mut parameters = editing.drawn.parameters.clone();
    let now = parameters[parameter.index()];
    let mut at = |x: f64| {
        parameters[parameter.index()] = x;
        expression.value(&parameters)
    };
    let step = now.abs().max(1.0);
    let [here, there, beyond] = [at(now), at(now + step), at(now + 2.0 * step)];
    let slope = (there - here) / step;
    let bent = (beyond - 2.0 * there + here).abs() > 1e-9 * (beyond.abs() + here.abs());
    let wanted = now + (value - here) / slope;
    let fits = !own.derived && !bent && slope != 0.0 && wanted.is_finite();
    Ok((own.name.clone(), fits.then_some(wanted)))
}

fn set_parameter(
    editing: &Editing,
    parts: &mut Parts,
    name: &str,
    value: f64,
    is_angle: bool,
) -> Result<(), Refusal> {
    let table = ["parameters", name, "value"];
    let path = if editing.text.has(&table) {
        &table[..]
    } else {
        &table[..2]
    };
    let place = editing.text.place(path);
    let new = place.and_then(|place| {
        let old = &editing.text.as_str()[place.clone()];
        let new = in_place_of(editing, old, value, is_angle)?;
        Some((place, new))
    });
    let new = new.ok_or_else(|| Refusal::Because(format!("`{name}` is an expression itself")))?;
    parts.replace(new.0, new.1);
    Ok(())
}

/// Gives the bodies whose estimates are off by more than a part of the drawing's size, or by more than an
/// angle of as many radians, their present places.
pub(super) fn refresh_estimates(editing: &mut Editing, far: f64) {
    let Some(mechanism) = &editing.drawn.mechanism else {
        return;
    };
    if editing.drawn.open.is_some() {
        return;
    }
    let size = editing.drawn.size();
    let mut parts = Parts::default();
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let frame = editing.drawn.frame(Some(BodyId(index)));
        let estimate = body
            .estimate
            .each_ref()
            .map(|part| part.value(&editing.drawn.parameters));
        let off = f64::hypot(estimate[0] - frame[0], estimate[1] - frame[1]);
        let turned = within_turn(estimate[2] - frame[2]).abs();
        if off > far * size || turned > far {
            set_estimate(editing, &mut parts, mechanism, BodyId(index), frame);
        }
    }
    parts.write(editing);
}
