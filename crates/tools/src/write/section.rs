//! Sections of a file, and entries of a table.

use biela::mechanism::Mechanism;

/// Longest line of a table with its entries.
const LINE: usize = 100;

/// Returns the sections of a mechanism file in the order of the format, in which new ones are put.
pub fn sections() -> Vec<&'static str> {
    Mechanism::keys()
        .skip_while(|key| *key != "parameters")
        .collect()
}

/// Writes entries in braces, or says that they are too long for one line with `name` in front.
pub fn in_braces(name: &str, entries: &[(String, String)]) -> Option<String> {
    let entries: Vec<String> = (entries.iter())
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    let braces = format!("{{ {} }}", entries.join(", "));
    (name.len() + 3 + braces.len() <= LINE).then_some(braces)
}

/// Writes entries on lines.
pub fn in_lines(entries: &[(String, String)]) -> String {
    let lines: Vec<String> = (entries.iter())
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_the_tables_of_the_format() {
        let schema = Mechanism::schema();
        let keys = schema["properties"].as_object().expect("it has keys");
        for (key, value) in keys {
            let is_table = value["type"] == "object";
            assert_eq!(sections().contains(&&**key), is_table, "{key}");
        }
    }
}
