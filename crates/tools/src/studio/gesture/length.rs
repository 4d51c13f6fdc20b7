//! The distance between two points of a body, which is set or becomes a parameter.

use super::parameter::{add_parameter, check_name, is_number};
use super::shift::{UNCHANGED, ends_of_bar, move_alone};
use super::{Editing, Refusal, Through};
use biela::mechanism::MarkerId;

/// Sets the distance between two `markers` of one body, or of ground, to `value` \[m\]: the second one
/// moves along the line on its body, all other lengths stay. With `name` the length becomes a
/// parameter.
pub(super) fn length(
    editing: &mut Editing,
    markers: &[String],
    value: Option<f64>,
    name: Option<&str>,
    through: Option<Through>,
) -> Result<(), Refusal> {
    let [first, second] = markers else {
        return Err("a length is between two points".into());
    };
    let ends = [editing.marker(first)?, editing.marker(second)?];
    let [body, other] = [editing.body_of(ends[0])?, editing.body_of(ends[1])?];
    if body != other {
        return Err(format!(
            "`{first}` and `{second}` are on different bodies: a cylinder between them sets their \
             distance"
        )
        .into());
    }
    if ends[0] == ends[1] {
        return Err("a length is between two different points".into());
    }
    let [a, b] = ends.map(|id| editing.drawn.place(id));
    let way = [b[0] - a[0], b[1] - a[1]];
    let now = f64::hypot(way[0], way[1]);
    if now <= editing.same() {
        return Err(format!(
            "`{first}` and `{second}` are at one place: move one of them in the direction that the \
             length is to have"
        )
        .into());
    }
    let value = value.unwrap_or(now);
    if value <= 0.0 {
        return Err("a length is above zero".into());
    }
    let is_other = (value - now).abs() > UNCHANGED;
    if let Some(name) = name {
        check_name(editing, name)?;
        number_of(editing, body, ends)?;
        let [x, y, _] = editing.drawn.inside(ends[1]);
        let moves_origin = [x, y].into_iter().all(|x| x.abs() <= editing.same());
        let is_bar = editing
            .body(body)
            .is_ok_and(|body| ends_of_bar(editing, &body.markers).is_some());
        if moves_origin && !is_bar && is_other {
            return Err(format!(
                "`{second}` is the origin of `{body}`: choose it first, so that `{first}` moves"
            )
            .into());
        }
    }
    if is_other {
        let by = way.map(|part| part * (value - now) / now);
        move_alone(editing, ends[1], by, through)?;
    }
    if let Some(name) = name {
        // Only now has the number its last value.
        let (path, element) = number_of(editing, body, ends)?;
        let path: Vec<&str> = path.iter().map(String::as_str).collect();
        let place = editing.text.number(&path, element);
        let place = place.ok_or("the number of the length is not found")?;
        let old = editing.text.as_str()[place.clone()].to_owned();
        let (sign, length) = match old.trim_start_matches('"').strip_prefix('-') {
            Some(_) => ("-", old.replacen('-', "", 1)),
            None => ("", old),
        };
        editing.text.replace(place, &format!("\"{sign}{name}\""));
        add_parameter(editing, name, &length, Some("m"));
    }
    Ok(())
}

/// Returns the path of the number that is the distance between two markers, and its place in the list
/// there.
fn number_of(
    editing: &Editing,
    body: &str,
    ends: [MarkerId; 2],
) -> Result<(Vec<String>, Option<usize>), Refusal> {
    let mechanism = editing.mechanism()?;
    let places = ends.map(|id| {
        let [x, y, _] = editing.drawn.inside(id);
        [x, y]
    });
    let is_zero = |x: f64| x.abs() <= editing.same();
    let is_origin = |place: [f64; 2]| place.into_iter().all(is_zero);
    let far = match places.map(is_origin) {
        [true, false] => 1,
        [false, true] => 0,
        _ => {
            return Err(format!(
                "the length stands in no single number of the file: neither point is the origin of \
                 `{body}`"
            )
            .into());
        }
    };
    let marker = &mechanism.markers[ends[far].index()].name;
    let mut path = match body {
        "ground" => vec!["ground", "markers", marker],
        body => vec!["bodies", body, "markers", marker],
    };
    let mut element = None;
    if editing.text.element(&path, 0).is_some() {
        element = Some(match places[far].map(is_zero) {
            [false, true] => 0,
            [true, false] => 1,
            _ => {
                return Err(format!(
                    "the length stands in no single number of the file: `{body}.{marker}` is on no \
                     axis of `{body}`"
                )
                .into());
            }
        });
    } else {
        path.push("r");
    }
    let place = editing.text.number(&path, element);
    let old = place
        .map(|place| editing.text.as_str()[place].to_owned())
        .unwrap_or_default();
    if !is_number(&old) {
        let formula = old.trim_matches('"');
        return Err(format!("the length is an expression already: `{formula}`").into());
    }
    Ok((path.into_iter().map(str::to_owned).collect(), element))
}
