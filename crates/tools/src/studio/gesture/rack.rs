//! A pinion on a rack.

use std::f64::consts::FRAC_PI_2;

use super::wheel::Centre;
use super::{Editing, Refusal, Target};

/// Adds a pinion at a target, and a rack that slides on a guide of ground through the contact, at right
/// angles to the line from the centre.
pub(super) fn rack(
    editing: &mut Editing,
    target: &Target,
    contact: [f64; 2],
) -> Result<(), Refusal> {
    let centre = Centre::of(editing, target, false)?;
    let way = [0, 1].map(|k| contact[k] - centre.at[k]);
    let radius = editing.length(f64::hypot(way[0], way[1]));
    if radius == "0" {
        return Err("the pinion has no radius: click further from its centre".into());
    }
    centre.settle(editing);
    let pinion = centre.make(editing, "pinion")?;
    // The pinion is above the rack: on the side of its y-axis.
    let angle = f64::atan2(-way[1], -way[0]) - FRAC_PI_2;
    let frame = [contact[0], contact[1], angle];
    let guide = editing.ground_name("guide");
    let guide = editing.add_marker("ground", &guide, frame);
    let letter = editing.names.new_letter();
    let body = editing.add_body("rack", &[(letter.clone(), [0.0; 3])], frame);
    let own = format!("{body}.{letter}");
    editing.join("guide", "translational", [&guide, &own]);
    let name = editing.names.new_name("mesh");
    let value = format!(
        "{{ type = \"rack_and_pinion\", markers = [\"{pinion}\", \"{own}\"], radius = {radius}, side \
         = \"above\", phase = \"drawn\" }}"
    );
    editing.text.set(&["joints", &name], &value);
    Ok(())
}
