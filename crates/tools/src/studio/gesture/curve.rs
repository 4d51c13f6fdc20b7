//! A track through points, in which a pin runs.

use super::{Editing, Refusal};

/// Lets a marker stay on a curve of ground through its own point and others \[m\].
pub(super) fn curve(editing: &mut Editing, path: &str, points: &[[f64; 2]]) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    if editing.body_of(marker)? == "ground" {
        return Err(format!("`{path}` is a point of ground: choose one that moves").into());
    }
    let [x, y] = editing.drawn.point(marker);
    let mut table = vec!["[0, 0]".to_owned()];
    for [u, v] in points {
        let [u, v] = [editing.length(u - x), editing.length(v - y)];
        table.push(format!("[{u}, {v}]"));
    }
    let track = editing.ground_name("track");
    let track = editing.add_marker("ground", &track, [x, y, 0.0]);
    let name = editing.names.new_name("track");
    let table = table.join(", ");
    let lines = format!(
        "type = \"curve\"\nmarkers = [\"{track}\", \"{path}\"]\npoints = {{ table = [{table}] }}"
    );
    editing.text.add_section(&["joints", &name], &lines);
    Ok(())
}
