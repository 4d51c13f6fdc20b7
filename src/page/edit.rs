//! The text of a mechanism file with other values. Comments and layout stay.

use toml_edit::{Array, DocumentMut, Item, TableLike, TomlError, Value};

use crate::kinematics::Pose;
use crate::mechanism::{DriverId, DriverSource, Mechanism, constant, rounded};

/// Digits of an estimate: the assembly starts from it, and ends at the same pose.
const ESTIMATE_DIGITS: usize = 9;
/// Digits of all other numbers at most: a start value decides the pose, and rounding may put it
/// beyond a stop or a dead point.
const ALL_DIGITS: usize = 17;

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
pub enum Place {
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
    place: Place,
) -> Result<String, EditError> {
    let mut document: DocumentMut = text.parse()?;
    let root = document.as_table_mut();
    for (parameter, value) in mechanism.parameters.iter().zip(&pose.parameters) {
        if names.contains(&parameter.name) {
            let parameters = table(root.get_mut("parameters"))?;
            match parameters.get_mut(&parameter.name) {
                Some(item) if item.is_table_like() => {
                    set_number(table(Some(item))?, "value", *value);
                }
                _ => set_number(parameters, &parameter.name, *value),
            }
        }
    }
    if place != Place::Keep {
        let drivers = mechanism.drivers.iter().zip(&pose.drivers).enumerate();
        for (index, (driver, value)) in drivers {
            let (key, velocity) = match driver.source {
                DriverSource::Input { .. } => ("drivers", None),
                DriverSource::Free { .. } => ("freedoms", velocity(DriverId(index))),
                DriverSource::Motion(_) => continue,
            };
            let drivers = table(root.get_mut(key))?;
            let driver = table(drivers.get_mut(&driver.name))?;
            set_number(driver, "start", *value);
            if let Some(velocity) = velocity {
                set_number(driver, "velocity", velocity);
            }
        }
    }
    if place == Place::Whole {
        for (body, q) in mechanism.bodies.iter().zip(pose.q.chunks_exact(3)) {
            let bodies = table(root.get_mut("bodies"))?;
            let body = table(bodies.get_mut(&body.name))?;
            let old = body.get("estimate").and_then(Item::as_array).cloned();
            let values = q.iter().enumerate().map(|(k, value)| {
                let old = old.as_ref().and_then(|old| old.get(k));
                let value = rounded(*value, ESTIMATE_DIGITS);
                old.and_then(|old| in_unit_of(old, value, ESTIMATE_DIGITS))
                    .unwrap_or_else(|| value.into())
            });
            let estimate = values.collect::<Array>();
            set(body, "estimate", Value::Array(estimate));
        }
    }
    Ok(laid_out_as(text, document.to_string()))
}

/// Returns an edited text with the byte order mark and the line ends of the old one, which a
/// document does not keep.
fn laid_out_as(old: &str, edited: String) -> String {
    const MARK: char = '\u{feff}';
    let mark = if old.starts_with(MARK) {
        "\u{feff}"
    } else {
        ""
    };
    let lines = old.matches('\n').count();
    let edited = edited.trim_start_matches(MARK).replace("\r\n", "\n");
    if lines > 0 && old.matches("\r\n").count() == lines {
        mark.to_owned() + &edited.replace('\n', "\r\n")
    } else {
        mark.to_owned() + &edited
    }
}

/// Returns the table that an item of a mechanism file is.
fn table(item: Option<&mut Item>) -> Result<&mut dyn TableLike, EditError> {
    item.and_then(Item::as_table_like_mut)
        .ok_or(EditError::Table)
}

/// Sets a number of a table; the unit of the old one stays.
fn set_number(table: &mut dyn TableLike, key: &str, number: f64) {
    let old = table.get(key).and_then(Item::as_value);
    let in_unit = old.and_then(|old| in_unit_of(old, number, ALL_DIGITS));
    let value = in_unit.unwrap_or_else(|| quotient(number, 1.0, ALL_DIGITS).into());
    set(table, key, value);
}

/// Sets a value of a table; a comment behind the old one stays.
fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(Item::Value(old)) = table.get_mut(key) {
        *value.decor_mut() = old.decor().clone();
        *old = value;
    } else {
        table.insert(key, Item::Value(value));
    }
}

/// Returns a number in the unit of an old value, if that has one: `"50*mm"` after `"40*mm"`.
fn in_unit_of(old: &Value, value: f64, digits: usize) -> Option<Value> {
    let (number, unit) = old.as_str()?.split_once('*')?;
    number.trim().parse::<f64>().ok()?;
    let factor = constant(unit.trim())?;
    let number = quotient(value, factor, digits);
    Some(format!("{number}*{}", unit.trim()).into())
}

/// Returns a value in units of a factor. It is rounded to twelve digits where these give the value
/// to rounding, otherwise to `digits`.
fn quotient(value: f64, factor: f64, digits: usize) -> f64 {
    /// Units in the last place of the value by which product and quotient can miss it.
    const NEAR: f64 = 4.0 * f64::EPSILON;
    let number = value / factor;
    let is_near = |number: &f64| (number * factor - value).abs() <= NEAR * value.abs();
    Some(rounded(number, 12))
        .filter(is_near)
        .unwrap_or_else(|| rounded(number, digits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Path, Solver};
    use crate::mechanism::Source;

    #[test]
    fn an_edited_file_keeps_its_line_ends_and_its_byte_order_mark() {
        let shipped = include_str!("../../mechanisms/four_bar.toml").replace("\r\n", "\n");
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
            let same = edit(&text, &mechanism, &names, (pose, |_| None), Place::Keep)
                .expect("its own text");
            assert_eq!(same, text);
        }
    }
}
