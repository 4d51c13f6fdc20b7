//! A bar between two points, or a plate through more.

use super::super::drawn::inside;
use super::{Editing, Onto, Refusal, Target, marker_name};

/// Adds a body through points. At a marker, at ground and at another body it is pinned.
pub(super) fn link(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let points = &settled(editing, points)?;
    let [first, second, ..] = &points[..] else {
        return Err("a link needs two points".into());
    };
    let [dx, dy] = [second.at[0] - first.at[0], second.at[1] - first.at[1]];
    for (index, point) in points.iter().enumerate() {
        let is_same = |other: &&Target| {
            let [dx, dy] = [0, 1].map(|k| other.at[k] - point.at[k]);
            f64::hypot(dx, dy) <= editing.same()
        };
        if points[..index].iter().any(|other| is_same(&other)) {
            return Err("two points of the link are one".into());
        }
    }
    let frame = [first.at[0], first.at[1], f64::atan2(dy, dx)];
    let mut markers = Vec::new();
    let mut joints = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let other = match &point.onto {
            Onto::Sheet => None,
            _ => Some(editing.marker_at(point)?),
        };
        let letter = match &other {
            // The two markers of a pin have one name.
            Some(path) if !markers.iter().any(|(n, _)| n == marker_name(path)) => {
                marker_name(path).to_owned()
            }
            _ => editing.names.new_letter(),
        };
        let [x, y] = match index {
            0 => [0.0, 0.0],
            1 => [f64::hypot(dx, dy), 0.0],
            _ => inside(frame, point.at),
        };
        markers.push((letter.clone(), [x, y, 0.0]));
        joints.extend(other.map(|other| (letter, other)));
    }
    let word = if points.len() == 2 { "link" } else { "plate" };
    let body = editing.add_body(word, &markers, frame);
    for (letter, other) in joints {
        let own = format!("{body}.{letter}");
        editing.join(&letter, "revolute", [&other, &own]);
    }
    Ok(())
}

/// Returns the points with those at markers where the markers are.
fn settled(editing: &Editing, points: &[Target]) -> Result<Vec<Target>, Refusal> {
    let settle = |point: &Target| {
        Ok(Target {
            at: editing.settled(point)?,
            onto: point.onto.clone(),
        })
    };
    points.iter().map(settle).collect()
}
