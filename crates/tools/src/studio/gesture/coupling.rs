//! Joints whose coordinates are in proportion.

use super::stop::known;
use super::{Editing, Refusal};

/// Couples the coordinates of two joints one to one, as they are drawn; a length moves by a millimetre
/// per radian of an angle. A joint without a driver, a freedom or a measure gets a measure.
pub(super) fn coupling(editing: &mut Editing, joints: &[String; 2]) -> Result<(), Refusal> {
    if joints[0] == joints[1] {
        return Err("a coupling is between two joints: choose another one".into());
    }
    let mut names = Vec::new();
    let mut is_angle = Vec::new();
    for name in joints {
        let mechanism = editing.mechanism()?;
        let coordinate = editing.joint(name)?.free_coordinate().ok_or_else(|| {
            Refusal::Because(format!(
                "joint `{name}` has no coordinate of its own: choose a pin or a slide"
            ))
        })?;
        is_angle.push(coordinate.kind.is_angle());
        let own = known(mechanism).find(|(_, other)| *other == coordinate);
        names.push(match own {
            Some((own, _)) => own.to_owned(),
            None => {
                let keys = editing.coordinate_keys(coordinate)?;
                let word = if coordinate.kind.is_angle() {
                    "angle"
                } else {
                    "travel"
                };
                let own = editing.names.new_name(&format!("{name}_{word}"));
                editing
                    .text
                    .set(&["measures", &own], &format!("{{ {keys} }}"));
                own
            }
        });
    }
    let [first, second] = [&names[0], &names[1]];
    let equation = match is_angle[..] {
        [true, false] => format!("{second} = 1*mm*{first}"),
        [false, true] => format!("{first} = 1*mm*{second}"),
        _ => format!("{second} = 1*{first}"),
    };
    let name = editing.names.new_name("coupling");
    let value = format!("{{ type = \"coupling\", equation = \"{equation}\", phase = \"drawn\" }}");
    editing.text.set(&["joints", &name], &value);
    Ok(())
}
