//! A rope over points.

use super::{Editing, Refusal, Target};

/// Adds a rope from the first point to the last, straight over those between, as long as it is drawn.
pub(super) fn rope(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let places = points.iter().map(|point| editing.settled(point));
    let places: Vec<[f64; 2]> = places.collect::<Result<_, _>>()?;
    let parts = places.windows(2).map(|pair| {
        let [[x, y], [u, v]] = [pair[0], pair[1]];
        f64::hypot(u - x, v - y)
    });
    let length = editing.length(parts.sum());
    let markers = points.iter().map(|point| editing.marker_at(point));
    let markers: Vec<String> = markers.collect::<Result<_, _>>()?;
    let name = editing.names.new_name("rope");
    let markers = markers.join("\", \"");
    let value = format!("{{ type = \"rope\", markers = [\"{markers}\"], length = {length} }}");
    editing.text.set(&["joints", &name], &value);
    Ok(())
}
