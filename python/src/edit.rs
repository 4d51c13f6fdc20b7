//! The text of a mechanism file with other values. Comments and layout stay.

use biela::kinematics::Pose;
use biela::mechanism::{DriverSource, Mechanism};
use toml_edit::{Array, DocumentMut, Item, TableLike, Value};

use crate::error::Failure;

/// Returns the text with the parameters of these names, the inputs and the estimates of all bodies
/// as the pose has them.
///
/// # Errors
///
/// The text is no TOML, which a mechanism file is.
pub(crate) fn edit(
    text: &str,
    mechanism: &Mechanism,
    names: &[String],
    pose: &Pose,
) -> Result<String, Failure> {
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| Failure::File(error.to_string()))?;
    let root = document.as_table_mut();
    for (parameter, value) in mechanism.parameters.iter().zip(&pose.parameters) {
        if names.contains(&parameter.name) {
            let parameters = table(root.get_mut("parameters"))?;
            match parameters.get_mut(&parameter.name) {
                Some(item) if item.is_table_like() => {
                    set(table(Some(item))?, "value", (*value).into());
                }
                _ => set(parameters, &parameter.name, (*value).into()),
            }
        }
    }
    for (driver, value) in mechanism.drivers.iter().zip(&pose.drivers) {
        if let DriverSource::Input { .. } = driver.source {
            let drivers = table(root.get_mut("drivers"))?;
            let driver = table(drivers.get_mut(&driver.name))?;
            set(driver, "start", (*value).into());
        }
    }
    for (body, q) in mechanism.bodies.iter().zip(pose.q.chunks_exact(3)) {
        let bodies = table(root.get_mut("bodies"))?;
        let body = table(bodies.get_mut(&body.name))?;
        set(
            body,
            "estimate",
            Value::Array(q.iter().copied().collect::<Array>()),
        );
    }
    Ok(document.to_string())
}

/// Returns the table that an item of a mechanism file is.
fn table(item: Option<&mut Item>) -> Result<&mut dyn TableLike, Failure> {
    let table = item.and_then(Item::as_table_like_mut);
    table.ok_or_else(|| Failure::File("the text is no mechanism file".to_owned()))
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
