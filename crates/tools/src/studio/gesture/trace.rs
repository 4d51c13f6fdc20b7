//! Points whose paths are shown.

use super::{Editing, Refusal};

/// Makes a marker a point of interest, or no longer.
pub(super) fn trace(editing: &mut Editing, path: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    let mechanism = editing.mechanism()?;
    if mechanism.markers[marker.index()].body.is_none() {
        return Err("a point of ground does not move".into());
    }
    let mut shown: Vec<String> = (mechanism.outputs.markers.iter())
        .map(|id| mechanism.marker_path(*id))
        .collect();
    match shown.iter().position(|other| other == path) {
        Some(index) => {
            shown.remove(index);
        }
        None => shown.push(path.to_owned()),
    }
    if shown.is_empty() {
        editing.text.remove(&["outputs", "markers"]);
    } else {
        let shown: Vec<String> = shown.iter().map(|path| format!("\"{path}\"")).collect();
        let list = format!("[{}]", shown.join(", "));
        editing.text.set(&["outputs", "markers"], &list);
    }
    Ok(())
}
