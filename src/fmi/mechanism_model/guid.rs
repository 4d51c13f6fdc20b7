//! The GUID that ties a model description to its mechanism.

use std::sync::Arc;

use uuid::Uuid;

use super::decisions::Decisions;
use super::variables::{FORCE_TABLE_VERSION, TABLE_VERSION};
use crate::mechanism::Mechanism;

/// Name space of biela's GUIDs, an arbitrary constant.
const NAMESPACE: Uuid = Uuid::from_u128(0x8d0c_61f7_2f0e_4b36_9a53_b1e1_a0f0_0d1e);

/// Returns the GUID of a mechanism's FMU: a hash of its values and tables, of the version of the table
/// of variables, and of the decisions of its export. Comments and layout of the file have no effect.
#[must_use]
pub fn guid(mechanism: &Mechanism) -> String {
    guid_decided(mechanism, &Decisions::of(&Arc::new(mechanism.clone())))
}

/// Returns the GUID of the FMU that follows from the decisions of an export.
pub(super) fn guid_decided(mechanism: &Mechanism, decisions: &Decisions) -> String {
    let mut content = format!("biela {TABLE_VERSION}\n{}", mechanism.canonical);
    if mechanism.has_dynamics() {
        content += &format!("\nforces {FORCE_TABLE_VERSION}");
    }
    content += &decisions.canonical(mechanism);
    format!("{{{}}}", Uuid::new_v5(&NAMESPACE, content.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Source;

    fn guid_of(text: &str) -> String {
        guid(&Mechanism::parse(&Source::new("test.toml", text)).unwrap().0)
    }

    #[test]
    fn values_change_the_guid_but_comments_and_layout_do_not() {
        let text = include_str!("../../../mechanisms/pendulum.toml");
        let original = guid_of(text);
        let reworded = text
            .replace("# Simple", "# A simple")
            .replace("0.5,", "0.50 ,");
        assert_ne!(reworded, text);
        assert_eq!(guid_of(&reworded), original);
        assert_ne!(guid_of(&text.replace("0.5,", "0.51,")), original);
        assert_ne!(guid_of(&text.replace("swing_angle", "swing")), original);
    }
}
