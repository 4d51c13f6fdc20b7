//! A point that is moved onto another one and pinned there.

use super::shift::move_points;
use super::{Editing, Refusal, Through, marker_name};

/// Moves a marker, with all that is pinned to it, onto another one and pins it there.
pub(super) fn join(
    editing: &mut Editing,
    [path, onto_path]: [&str; 2],
    through: Option<Through>,
) -> Result<(), Refusal> {
    let (marker, onto) = (editing.marker(path)?, editing.marker(onto_path)?);
    let moved = editing.drawn.pinned_to(marker);
    if moved.contains(&onto) {
        return Err(format!("`{path}` and `{onto_path}` are pinned to each other already").into());
    }
    let mechanism = editing.mechanism()?;
    let body_of = |id: biela::mechanism::MarkerId| mechanism.markers[id.index()].body;
    let there = editing.drawn.pinned_to(onto);
    let shared = moved.iter().find_map(|id| {
        let other = there.iter().find(|other| body_of(**other) == body_of(*id));
        Some((*id, *other?))
    });
    if let Some((id, other)) = shared {
        let [id, other] = [id, other].map(|id| mechanism.marker_path(id));
        return Err(format!(
            "`{id}` and `{other}` are points of one body, which cannot be pinned to each other: \
             choose a point of another body"
        )
        .into());
    }
    let [from, to] = [marker, onto].map(|id| editing.drawn.point(id));
    let by = [to[0] - from[0], to[1] - from[1]];
    // Points that meet already keep their bodies as they are.
    if f64::hypot(by[0], by[1]) > editing.same() {
        move_points(editing, &[marker], by, through)?;
    }
    editing.join(marker_name(path), "revolute", [onto_path, path]);
    Ok(())
}
