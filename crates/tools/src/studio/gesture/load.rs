//! A force at a point.

use super::{Editing, Refusal};

/// Adds a force at a marker of a body, whose components are inputs.
pub(super) fn load(editing: &mut Editing, path: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    if editing.body_of(marker)? == "ground" {
        return Err(format!(
            "`{path}` is a point of ground, which no force moves: choose a point of a body"
        )
        .into());
    }
    let name = editing.names.new_name("load");
    let value = format!("{{ marker = \"{path}\" }}");
    editing.text.set(&["forces", &name], &value);
    Ok(())
}
