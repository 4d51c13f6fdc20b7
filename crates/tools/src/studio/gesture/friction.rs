//! Friction in joints.

use super::{Editing, Refusal};
use biela::mechanism::rounded;

/// Usual coefficient of dry steel on bronze.
const COEFFICIENT: f64 = 0.1;
/// Usual radius of a pin in parts of the drawing's size.
const PIN: f64 = 0.02;

/// Gives a pin, a slider or a slot friction.
pub(super) fn friction(editing: &mut Editing, name: &str) -> Result<(), Refusal> {
    let joint = editing.joint(name)?;
    let radius = if joint.is_pin() {
        format!(", radius = {}", rounded(PIN * editing.drawn.size(), 1))
    } else if joint.guide().is_some_and(|guide| guide.aside.is_none()) {
        String::new()
    } else {
        return Err(format!(
            "the studio gives friction to pins, sliders and slots: write that of joint `{name}` in \
             the text"
        )
        .into());
    };
    let known = editing.text.keys(&["friction"]);
    let of_joint = format!("\"{name}\"");
    let has = known
        .iter()
        .find(|known| editing.text.get(&["friction", known, "joint"]) == Some(&of_joint));
    if let Some(known) = has {
        return Err(format!("`{known}` is the friction of this joint already").into());
    }
    let own = editing.names.new_name(&format!("{name}_friction"));
    let value = format!("{{ joint = \"{name}\", coefficient = {COEFFICIENT}{radius} }}");
    editing.text.set(&["friction", &own], &value);
    Ok(())
}
