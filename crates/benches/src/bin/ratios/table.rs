//! Tables in Markdown.

use std::fmt::Write as _;

/// Text of a cell for which nothing was measured.
pub(crate) const NOT_RUN: &str = "not run";

/// Appends a table: the first column to the left, the others to the right.
pub(crate) fn table<const COLUMNS: usize>(
    out: &mut String,
    header: [&str; COLUMNS],
    rows: impl IntoIterator<Item = [String; COLUMNS]>,
) {
    let mut line = |cells: &[String]| {
        writeln!(out, "| {} |", cells.join(" | ")).expect("a text takes all");
    };
    line(&header.map(str::to_owned));
    let mut rule = [const { String::new() }; COLUMNS];
    rule.fill("---:".to_owned());
    "---".clone_into(&mut rule[0]);
    line(&rule);
    for row in rows {
        line(&row);
    }
    *out += "\n";
}

/// Writes a number with three digits, or all before the point.
pub(crate) fn short(number: f64) -> String {
    let digits = 2_i32.saturating_sub(number.abs().log10().floor() as i32);
    format!("{number:.*}", digits.clamp(0, 2) as usize)
}

/// Writes a value, or that there is none.
pub(crate) fn or_not_run<T>(value: Option<T>, write: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| NOT_RUN.to_owned(), write)
}
