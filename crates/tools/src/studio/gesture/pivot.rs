//! A point that is fixed to ground by a pin.

use super::{Editing, Refusal, marker_name};

/// Pins a marker to ground where it is.
pub(super) fn pivot(editing: &mut Editing, path: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    let mechanism = editing.mechanism()?;
    let pinned = editing.drawn.pinned_to(marker);
    if pinned
        .iter()
        .any(|id| mechanism.markers[id.index()].body.is_none())
    {
        return Err(format!("`{path}` is fixed to ground already").into());
    }
    let [x, y] = editing.drawn.point(marker);
    let wanted = marker_name(path);
    let is_taken = editing.text.has(&["ground", "markers", wanted]);
    let letter = if is_taken {
        editing.names.new_letter()
    } else {
        wanted.to_owned()
    };
    let ground = editing.add_marker("ground", &letter, [x, y, 0.0]);
    editing.join(&letter, "revolute", [&ground, path]);
    Ok(())
}
