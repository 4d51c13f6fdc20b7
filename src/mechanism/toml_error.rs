//! Syntax errors of TOML, in the words of someone who writes a mechanism.
//!
//! The parser tells where it stopped. The slip itself is read from that line: a missing quote, a
//! decimal comma, an expression without quotes.

use std::ops::Range;

use super::diagnostic::code;
use super::expression::CONSTANTS;
use super::wording::quoted;
use super::{Diagnostic, Span, Unit};

/// Slip in one line: its place in the line, the message and the help.
type Slip = (Range<usize>, String, Option<String>);

/// Returns the error at `span` of the text, about which the parser says `message`.
pub(super) fn syntax_error(text: &str, span: Span, message: &str) -> Diagnostic {
    let at = text.floor_char_boundary(span.start);
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let has_long_strings = text.contains("\"\"\"") || text.contains("'''");
    // A string that a line before does not close is the slip, wherever the parser stopped.
    let unclosed = (!has_long_strings)
        .then(|| unclosed_before(text, start))
        .flatten();
    let start = unclosed.unwrap_or(start);
    let line = text[start..].split(['\r', '\n']).next().unwrap_or_default();
    let at = (at - start).min(line.len());
    if !has_long_strings
        && message.contains("missing comma")
        && line[..at].trim().is_empty()
        && let Some((end, bracket)) = missing_bracket(text, start)
    {
        let message = format!("a `{bracket}` is missing here");
        return Diagnostic::error(code::SYNTAX, message).label(end..end, "");
    }
    let slip = (!has_long_strings)
        .then(|| missing_quote(line))
        .flatten()
        .or_else(|| foreign_letter(line, at))
        .or_else(|| round_brackets(line, at))
        .or_else(|| decimal_comma(line, at))
        .or_else(|| bare_value(line, at, message))
        .or_else(|| missing_mark(line, at, message));
    match slip {
        Some((place, message, help)) => Diagnostic::error(code::SYNTAX, message)
            .label(start + place.start..start + place.end, "")
            .help(help),
        None => Diagnostic::error(code::SYNTAX, message).label(span, ""),
    }
}

/// Strings of a line, with their quotes, and the place of a quote that nothing closes.
fn strings(line: &str) -> (Vec<Range<usize>>, Option<usize>) {
    let mut closed = Vec::new();
    let mut characters = line.char_indices();
    while let Some((start, quote)) = characters.next() {
        match quote {
            '#' => break,
            '"' | '\'' => {}
            _ => continue,
        }
        let mut end = None;
        while let Some((at, character)) = characters.next() {
            if character == quote {
                end = Some(at + 1);
                break;
            }
            if character == '\\' && quote == '"' {
                characters.next();
            }
        }
        let Some(end) = end else {
            return (closed, Some(start));
        };
        closed.push(start..end);
    }
    (closed, None)
}

/// Returns the start of the first line before the one at `start` that has an unclosed string.
fn unclosed_before(text: &str, start: usize) -> Option<usize> {
    let mut lines = text[..start].split_inclusive('\n').scan(0, |end, line| {
        *end += line.len();
        Some((*end - line.len(), line))
    });
    let found = lines.find(|(_, line)| strings(line).1.is_some());
    found.map(|(start, _)| start)
}

/// Finds a bracket that is opened before the line at `start` and never closed: the end of the
/// lines before, where it may be missing, and the closing bracket.
fn missing_bracket(text: &str, start: usize) -> Option<(usize, char)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    let (mut offset, mut end) = (0, 0);
    for line in text.split_inclusive('\n') {
        let (closed, _) = strings(line);
        let is_code = |at: &usize| !closed.iter().any(|string| string.contains(at));
        for (at, character) in line.char_indices().filter(|(at, _)| is_code(at)) {
            match character {
                '#' => break,
                '[' => open.push((offset + at, ']')),
                '{' => open.push((offset + at, '}')),
                ']' | '}' if open.pop()?.1 != character => return None,
                _ => {}
            }
        }
        offset += line.len();
        if offset <= start && !line.trim().is_empty() {
            let code = line.char_indices().find(|(at, c)| *c == '#' && is_code(at));
            let code = &line[..code.map_or(line.len(), |(comment, _)| comment)];
            if !code.trim().is_empty() {
                end = offset - line.len() + code.trim_end().len();
            }
        }
    }
    let before = open.iter().rev().find(|(at, _)| *at < start);
    before.map(|(_, bracket)| (end, *bracket))
}

/// Finds a string without its closing or its opening quote.
fn missing_quote(line: &str) -> Option<Slip> {
    let (closed, open) = strings(line);
    let open = open?;
    // After a missing quote, the text between two strings counts as a string.
    let is_suspect = |string: &&Range<usize>| {
        let next = line[string.end..].trim_start().chars().next();
        next.is_some_and(|next| !",]}=#.".contains(next))
    };
    let start = closed
        .iter()
        .find(is_suspect)
        .map_or(open, |string| string.start);
    let before = line[..start].trim_end();
    if !before.is_empty() && !before.ends_with(['=', '[', '{', ',', '.']) {
        let word = before.rfind(['=', '[', '{', ',']).map_or(0, |end| end + 1);
        let word = word + line[word..].len() - line[word..].trim_start().len()..before.len();
        let text = &line[word.clone()];
        return Some((
            word.start..start + 1,
            "this string has no opening quote".to_owned(),
            Some(write_quoted(text)),
        ));
    }
    let content = &line[start + 1..];
    let content = content
        .split([',', ']', '}', '#'])
        .next()
        .unwrap_or_default()
        .trim_end();
    // A quote of the other kind was meant to close it.
    let other = if line[start..].starts_with('"') {
        '\''
    } else {
        '"'
    };
    let inside = content.strip_suffix(other).unwrap_or(content);
    Some((
        start..start + 1 + content.len(),
        "this string has no closing quote".to_owned(),
        (!inside.is_empty()).then(|| write_quoted(inside)),
    ))
}

/// Finds a letter that names do not have, in a key or in the name of a table.
fn foreign_letter(line: &str, at: usize) -> Option<Slip> {
    let letter = line[at..].chars().next()?;
    let is_foreign = letter.is_alphabetic() && !letter.is_ascii();
    let is_header = line.trim_start().starts_with('[') && !line[..at].contains('=');
    let rest = line[at..].trim_start_matches(|c: char| c.is_alphanumeric() || "_-.".contains(c));
    (is_foreign && (is_header || rest.trim_start().starts_with('='))).then(|| {
        (
            at..at + letter.len_utf8(),
            "a name has the letters a to z, digits and `_`".to_owned(),
            Some(format!("write it without `{letter}`")),
        )
    })
}

/// Finds an array that has round brackets.
fn round_brackets(line: &str, at: usize) -> Option<Slip> {
    let start = line[..at].rfind('=')? + 1;
    let value = line[start..].trim_start();
    let start = line.len() - value.len();
    let end = value.find(')')?;
    let inside = value[..end].strip_prefix('(')?;
    // An expression between brackets has none of its own.
    (inside.contains(',') && !inside.contains('(')).then(|| {
        (
            start..start + end + 1,
            "an array has square brackets".to_owned(),
            Some(format!("write {}", quoted(&format!("[{inside}]")))),
        )
    })
}

fn write_quoted(text: &str) -> String {
    format!("write {}", quoted(&format!("\"{text}\"")))
}

/// Finds `0,05` at or before the place where the parser stopped.
fn decimal_comma(line: &str, at: usize) -> Option<Slip> {
    let is_digit = |c: char| c.is_ascii_digit();
    let (closed, _) = strings(line);
    let commas = line.match_indices(',').map(|(comma, _)| comma);
    let mut commas = commas.filter(|comma| !closed.iter().any(|string| string.contains(comma)));
    commas.find_map(|comma| {
        let before = line[..comma].trim_end_matches(is_digit);
        let after = line[comma + 1..].trim_start_matches(is_digit);
        let (start, end) = (before.len(), line.len() - after.len());
        if start == comma || end == comma + 1 {
            return None;
        }
        let sign = before.trim_end_matches(['+', '-']);
        let is_value = sign.trim_end().ends_with('=')
            && !after.trim_start().starts_with(['=', '.'])
            && comma <= at;
        // In an array only the leading zero tells a number from two.
        let is_item = at == comma + 1 && line[comma + 1..].starts_with('0') && end > comma + 2;
        (is_value || is_item).then(|| {
            let number = line[sign.len()..end].replace(',', ".");
            (
                sign.len()..end,
                "the decimal mark is a point".to_owned(),
                Some(format!("write `{number}`")),
            )
        })
    })
}

/// Finds a value that TOML does not know: an expression without quotes, or a number it writes
/// differently.
fn bare_value(line: &str, at: usize, message: &str) -> Option<Slip> {
    let about_values = [
        "quoted", "float", "boolean", "mantissa", "fraction", "zero", "integer", "exponent",
    ];
    if !about_values.iter().any(|word| message.contains(word)) {
        return None;
    }
    let place = value_at(line, at);
    let value = &line[place.clone()];
    let slip = |message: &str, help: String| Some((place.clone(), message.to_owned(), Some(help)));
    if value.is_empty() {
        return Some((at..at, "a value is missing here".to_owned(), None));
    }
    for word in ["true", "false"] {
        if value.eq_ignore_ascii_case(word) {
            return slip(
                "`true` and `false` have small letters",
                format!("write `{word}`"),
            );
        }
    }
    if ["yes", "no", "on", "off"].contains(&&*value.to_ascii_lowercase()) {
        let message = "such a value is `true` or `false`, without quotes";
        return Some((place, message.to_owned(), None));
    }
    if let Some(value) = value.strip_suffix(';') {
        return slip(
            "a line ends without a semicolon",
            format!("write `{value}`"),
        );
    }
    let curly = ['“', '”', '„', '‘', '’', '«', '»'];
    if value.starts_with(curly) {
        return slip(
            "a string has straight quotes",
            write_quoted(value.trim_matches(curly)),
        );
    }
    if value.contains(['"', '\'', '=']) {
        return None;
    }
    if let Ok(number) = value.parse::<f64>()
        && value.contains(|c: char| c.is_ascii_digit())
    {
        return slip(
            "a number has digits on both sides of its point, and no zeros before them",
            format!("write `{number}`"),
        );
    }
    let digits = value.len()
        - value
            .trim_start_matches(|c: char| "+-._".contains(c) || c.is_ascii_digit())
            .len();
    let (number, unit) = value.split_at(digits);
    let (number, unit) = (number.trim_end(), unit.trim());
    let constant = if unit == "°" { "deg" } else { unit };
    if number.parse::<f64>().is_ok() {
        if CONSTANTS.iter().any(|(name, _)| *name == constant) {
            let product = format!("{number}*{constant}");
            return slip("an expression needs quotes", write_quoted(&product));
        }
        if Unit::by_name(unit).is_some() {
            return slip(
                "values are written in SI units, without the unit",
                format!("write `{number}`"),
            );
        }
    }
    let is_word = value
        .chars()
        .all(|c| c.is_alphanumeric() || "_.".contains(c));
    let message = if is_word {
        "a word needs quotes"
    } else {
        "an expression needs quotes"
    };
    slip(message, write_quoted(value))
}

/// Returns the place of the value around `at`: up to the next comma or bracket that is not within
/// parentheses.
fn value_at(line: &str, at: usize) -> Range<usize> {
    let start = line[..at]
        .rfind(['=', '[', '{', ','])
        .map_or(0, |end| end + 1);
    let start = start + line[start..].len() - line[start..].trim_start().len();
    let mut depth = 0_u32;
    let end = line[start..].find(|character| {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '#' | ']' | '}' => return true,
            ',' => return depth == 0,
            _ => {}
        }
        false
    });
    let end = end.map_or(line.len(), |end| start + end);
    start..start + line[start..end].trim_end().len()
}

/// Finds a bracket, comma or equals sign that is missing where the parser stopped.
fn missing_mark(line: &str, at: usize, message: &str) -> Option<Slip> {
    let next = line[at..].chars().next();
    let place = at..at + next.map_or(0, char::len_utf8);
    let is_about = |words: &str| message.contains(words);
    let begins = |mark: &&str| line.trim_start().starts_with(*mark);
    let (message, help) = if ["//", "/*", "--", "%", ";"].iter().any(begins) {
        ("a comment begins with `#`", None)
    } else if next == Some(';') {
        ("a line ends without a semicolon", None)
    } else if is_about("unclosed inline table") || (is_about("missing comma") && next == Some(']'))
    {
        ("a `}` is missing here", None)
    } else if is_about("unclosed") || (is_about("missing comma") && next == Some('}')) {
        ("a `]` is missing here", None)
    } else if is_about("missing comma") {
        ("a comma is missing here", None)
    } else if is_about("no value") || is_about("missing assignment") {
        if line[..at].trim_end().ends_with(':') || next == Some(':') {
            ("a key is followed by `=`, not by `:`", None)
        } else {
            ("a `=` is missing here, after the key", None)
        }
    } else if is_about("unexpected key or value") {
        (
            "the line goes on after its value",
            Some(
                "each key of a table has a line of its own; within `{ }` commas separate them"
                    .to_owned(),
            ),
        )
    } else {
        return None;
    };
    Some((place, message.to_owned(), help))
}
