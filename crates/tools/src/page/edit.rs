//! The text of a mechanism file with other values. Comments and layout stay.

use toml_edit::TomlError;

use crate::write::{NumberInUnit, TomlText, estimate, largest_coordinate};
use biela::kinematics::Pose;
use biela::mechanism::{DriverId, DriverSource, Mechanism};

/// A text that is no mechanism file.
#[derive(Clone, Debug, thiserror::Error)]
pub enum EditError {
    /// It is no TOML.
    #[error("{0}")]
    Toml(#[from] TomlError),
    /// A table of the mechanism is missing.
    #[error("the text is no mechanism file")]
    Table,
}

/// The part of a pose that goes into the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PosePart {
    /// Nothing: the file keeps its start values and estimates.
    Keep,
    /// The start values of freedoms and of the drivers that are inputs.
    Starts,
    /// Start values, and the estimates of all bodies: the file assembles at the pose.
    Whole,
}

/// Returns the text with the parameters of these names, and with `place` of the pose, which comes with
/// the velocities that freedoms start with, where they are known.
///
/// # Errors
///
/// The text is not that of the mechanism.
pub fn edit(
    text: &str,
    mechanism: &Mechanism,
    names: &[String],
    (pose, velocity): (&Pose, impl Fn(DriverId) -> Option<f64>),
    place: PosePart,
) -> Result<String, EditError> {
    let mut text = TomlText::new(text)?;
    for (parameter, value) in mechanism.parameters.iter().zip(&pose.parameters) {
        if names.contains(&parameter.name) {
            set_parameter(&mut text, &parameter.name, *value)?;
        }
    }
    if place != PosePart::Keep {
        let drivers = mechanism.drivers.iter().zip(&pose.drivers).enumerate();
        for (index, (driver, value)) in drivers {
            let (section, velocity) = match driver.source {
                DriverSource::Input { .. } => ("drivers", None),
                DriverSource::Free { .. } => ("freedoms", velocity(DriverId(index))),
                DriverSource::Motion(_) => continue,
            };
            set_number(&mut text, &[section, &driver.name, "start"], *value)?;
            if let Some(velocity) = velocity {
                set_number(&mut text, &[section, &driver.name, "velocity"], velocity)?;
            }
        }
    }
    if place == PosePart::Whole {
        let size = largest_coordinate(&pose.q);
        for (body, q) in mechanism.bodies.iter().zip(pose.q.chunks_exact(3)) {
            let path = ["bodies", &*body.name, "estimate"];
            let old = |index| Some(&text.as_str()[text.element(&path, index)?]);
            let estimate = estimate([q[0], q[1], q[2]], size, old);
            set(&mut text, &path, &estimate)?;
        }
    }
    Ok(text.as_str().to_owned())
}

/// Returns the text with other values of parameters, by their names, and with other starts of freedoms:
/// name, key and value \[SI\].
///
/// # Errors
///
/// The text is not that of the mechanism.
pub fn change_values<'a>(
    text: &str,
    parameters: impl IntoIterator<Item = (&'a str, f64)>,
    starts: impl IntoIterator<Item = (&'a str, &'a str, f64)>,
) -> Result<String, EditError> {
    let mut text = TomlText::new(text)?;
    for (name, value) in parameters {
        set_parameter(&mut text, name, value)?;
    }
    for (freedom, key, value) in starts {
        set_number(&mut text, &["freedoms", freedom, key], value)?;
    }
    Ok(text.as_str().to_owned())
}

/// Returns the text with other starts of inputs \[SI\], by their names.
pub(super) fn set_input_starts<'a>(
    text: String,
    starts: impl Iterator<Item = (&'a str, f64)>,
) -> Result<String, EditError> {
    let mut text = TomlText::new(&text)?;
    for (name, start) in starts {
        set_number(&mut text, &["inputs", name, "start"], start)?;
    }
    Ok(text.as_str().to_owned())
}

/// Sets the value of a parameter, which is a number or a table.
fn set_parameter(text: &mut TomlText, name: &str, value: f64) -> Result<(), EditError> {
    let own = ["parameters", name, "value"];
    let is_number = !text.has_keys(&own[..2]);
    set_number(text, if is_number { &own[..2] } else { &own }, value)
}

/// Sets a number of a table; the unit of the old one stays.
fn set_number(text: &mut TomlText, path: &[&str], number: f64) -> Result<(), EditError> {
    let value = NumberInUnit::write_in_unit_of(text.get(path), number);
    set(text, path, &value)
}

/// Sets a value of a table of the mechanism.
fn set(text: &mut TomlText, path: &[&str], value: &str) -> Result<(), EditError> {
    if !text.has_keys(&path[..path.len() - 1]) {
        return Err(EditError::Table);
    }
    text.set(path, value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use biela::kinematics::{Path, Solver};
    use biela::mechanism::Source;

    #[test]
    fn an_edited_file_keeps_its_line_ends_and_its_byte_order_mark() {
        let shipped = include_str!("../../../../mechanisms/four_bar.toml").replace("\r\n", "\n");
        for text in [
            shipped.clone(),
            shipped.replace('\n', "\r\n"),
            format!("\u{feff}{}", shipped.replace('\n', "\r\n")),
        ] {
            let source = Source::new("four_bar.toml", text.clone());
            let (mechanism, _) = Mechanism::parse(&source).expect("it is the example");
            let mechanism = std::sync::Arc::new(mechanism);
            let mut solver = Solver::new(std::sync::Arc::clone(&mechanism)).expect("it is sound");
            solver.assemble(&Path::new(&mechanism)).expect("it closes");
            let pose = solver.pose();
            let names = ["coupler_length".to_owned()];
            let same = edit(&text, &mechanism, &names, (pose, |_| None), PosePart::Keep)
                .expect("its own text");
            assert_eq!(same, text);
        }
    }
}
