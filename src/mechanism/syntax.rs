//! TOML document in which each key and value knows its place.

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::diagnostic::code;
use super::toml_error::syntax_error;
use super::wording::quoted;
use super::{Diagnostic, Source, Span};

/// Key with its place.
pub(super) type Key<'a> = Spanned<DeString<'a>>;

/// Value with its place.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// Table in the order of the file.
pub(super) type Table<'a> = DeTable<'a>;

/// The TOML parser's message about a key that a table already has.
const DUPLICATE_KEY: &str = "duplicate key";

/// Parses the text. Returns with the document the errors about repeated keys, whose first value
/// counts.
///
/// # Errors
///
/// The file is not UTF-8, or has a syntax error: only the first, as one slip causes others.
pub(super) fn parse(source: &Source) -> Result<(Table<'_>, Vec<Diagnostic>), Diagnostic> {
    if let Some(fault) = source.fault() {
        return Err(
            Diagnostic::error(code::NOT_UTF_8, format!("the file {fault}"))
                .label(fault.span(), "")
                .help("save it as UTF-8".to_owned()),
        );
    }
    let (document, errors) = DeTable::parse_recoverable(source.text());
    let mut duplicates = Vec::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        if error.message() == DUPLICATE_KEY {
            duplicates.push(span);
        } else {
            return Err(syntax_error(source.text(), span, error.message()));
        }
    }
    let document = document.into_inner();
    let duplicates = duplicates.into_iter().map(|span| {
        let key = quoted(source.text().get(span.clone()).unwrap_or_default());
        let first = first_place(&document, source.text(), &span);
        let problem =
            Diagnostic::error(code::DUPLICATE_KEY, format!("the key {key} is given twice"))
                .label(span, "");
        match first {
            Some(first) => problem.label(first, "the first one"),
            None => problem,
        }
    });
    let duplicates = duplicates.collect();
    Ok((document, duplicates))
}

/// Returns the place of the first of two equal keys, of which the second is at `second`; `None` if
/// it cannot be told.
fn first_place(document: &Table<'_>, text: &str, second: &Span) -> Option<Span> {
    let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |end| end + 1);
    let name = text.get(second.clone())?;
    let start = line_start(second.start);
    let before = text[start..second.start].trim_start();
    let table = if let Some(table) = inline_table(document, text, second) {
        table
    } else if before.starts_with('[') {
        if let Some(first) = same_header(&text[..start], &format!("{before}{name}")) {
            return Some(first.end - name.len()..first.end);
        }
        descend(document, before.trim_start_matches('['))?
    } else {
        let is_header = |line: &&str| line.starts_with('[') && !line.contains(',');
        let header = text[..start].lines().map(str::trim).rfind(is_header);
        let header = header.map_or("", |header| header.split(['[', ']']).nth(1).unwrap_or(""));
        descend(descend(document, header)?, before)?
    };
    let (key, _) = table.get_key_value(name.trim_matches(['"', '\'']))?;
    Some(key.span()).filter(|first| first.end <= second.start)
}

/// Returns the place of a line's beginning such as `[bodies.crank`, which a bracket closes.
fn same_header(text: &str, header: &str) -> Option<Span> {
    let mut end = 0;
    text.split_inclusive('\n').find_map(|line| {
        let start = end + line.len() - line.trim_start().len();
        end += line.len();
        let rest = line.trim_start().strip_prefix(header)?;
        rest.trim_start()
            .starts_with(']')
            .then(|| start..start + header.len())
    })
}

/// Returns the innermost table in braces around a place.
fn inline_table<'t, 'a>(table: &'t Table<'a>, text: &str, place: &Span) -> Option<&'t Table<'a>> {
    table.iter().find_map(|(_, value)| {
        let inner = value.get_ref().as_table()?;
        let span = value.span();
        let is_inline = text.get(span.clone())?.starts_with('{');
        let is_around = is_inline && span.start < place.start && place.end <= span.end;
        inline_table(inner, text, place).or(is_around.then_some(inner))
    })
}

/// Returns the table under a path of keys such as `bodies.crank`.
fn descend<'t, 'a>(table: &'t Table<'a>, path: &str) -> Option<&'t Table<'a>> {
    let keys = path
        .split('.')
        .map(|key| key.trim().trim_matches(['"', '\'']));
    keys.filter(|key| !key.is_empty())
        .try_fold(table, |table, key| table.get(key)?.get_ref().as_table())
}

/// Returns the type of a value for messages.
pub(super) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}

/// Returns the number nearest to a TOML integer or float, infinite if it is out of range; `None`
/// for other values.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            // TOML has no sign here. Past 128 bits it is no number that anyone meant.
            #[expect(
                clippy::cast_precision_loss,
                reason = "rounded as a decimal one would be"
            )]
            let number = u128::from_str_radix(integer.as_str(), integer.radix())
                .map_or(f64::INFINITY, |digits| digits as f64);
            Some(number)
        }
        _ => None,
    }
}

/// Returns the place of a string's content, `None` if the source has it with escapes. Byte n of
/// the string is byte n of that place.
fn content_span(source: &Source, quoted: Span, content: &str) -> Option<Span> {
    let raw = source.text().get(quoted.clone())?;
    ["\"\"\"", "'''", "\"", "'"].iter().find_map(|quote| {
        let inner = raw.strip_prefix(quote)?.strip_suffix(quote)?;
        let start = quoted.start + quote.len();
        (inner == content).then(|| start..start + inner.len())
    })
}

/// Returns the place of the bytes `part` of a string's content, the whole string's if `part` is
/// empty or the source has the string with escapes.
pub(super) fn part_span(source: &Source, quoted: Span, content: &str, part: Span) -> Span {
    match content_span(source, quoted.clone(), content) {
        Some(place) if !part.is_empty() => place.start + part.start..place.start + part.end,
        _ => quoted,
    }
}

/// Returns the document's content as text without comments and layout. Two documents have the same
/// text exactly if they have the same keys and values in the same order, numbers compared as
/// 64-bit floats.
pub(super) fn canonical(document: &Table<'_>) -> String {
    let mut text = String::new();
    write_table(&mut text, document);
    text
}

fn write_table(text: &mut String, table: &Table<'_>) {
    text.push('{');
    for (index, (key, value)) in table.iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        write_string(text, key.get_ref());
        text.push(':');
        write_value(text, value.get_ref());
    }
    text.push('}');
}

fn write_value(text: &mut String, value: &DeValue<'_>) {
    match value {
        DeValue::String(string) => write_string(text, string),
        DeValue::Integer(_) | DeValue::Float(_) => {
            let number = number(value).unwrap_or(f64::NAN);
            // The shortest digits that give the same number back.
            *text += &format!("{number:?}");
        }
        DeValue::Boolean(boolean) => *text += if *boolean { "true" } else { "false" },
        DeValue::Datetime(datetime) => *text += &datetime.to_string(),
        DeValue::Array(array) => {
            text.push('[');
            for (index, item) in array.iter().enumerate() {
                if index > 0 {
                    text.push(',');
                }
                write_value(text, item.get_ref());
            }
            text.push(']');
        }
        DeValue::Table(table) => write_table(text, table),
    }
}

fn write_string(text: &mut String, string: &str) {
    text.push('"');
    for character in string.chars() {
        if matches!(character, '"' | '\\') {
            text.push('\\');
        }
        text.push(character);
    }
    text.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn canonical_of(text: &str) -> String {
        let source = Source::new("a.toml", text);
        let (document, duplicates) = parse(&source).expect("good syntax");
        assert!(duplicates.is_empty());
        canonical(&document)
    }

    #[test]
    fn layout_and_comments_do_not_count() {
        let inline = canonical_of("[a]\nb = { c = [1, 2.5], d = 'x' } # comment\n");
        let header = canonical_of("# comment\n[a.b]\nc = [\n  1.0,\n  25e-1,\n]\nd = \"x\"\n");
        assert_eq!(inline, header);
        assert_eq!(inline, r#"{"a":{"b":{"c":[1.0,2.5],"d":"x"}}}"#);
    }

    #[test]
    fn equal_numbers_are_written_alike() {
        for text in ["1", "1.0", "0.1e1", "0x1", "1_0e-1", "+1"] {
            assert_eq!(
                canonical_of(&format!("a = {text}")),
                r#"{"a":1.0}"#,
                "{text}"
            );
        }
        assert_eq!(canonical_of("a = 0.10"), canonical_of("a = 0.1"));
        assert_ne!(
            canonical_of("a = 0.1"),
            canonical_of("a = 0.10000000000000002")
        );
    }

    #[test]
    fn order_types_and_strings_count() {
        assert_ne!(canonical_of("a = 1\nb = 2"), canonical_of("b = 2\na = 1"));
        assert_ne!(canonical_of("a = 1"), canonical_of("a = '1.0'"));
        assert_ne!(
            canonical_of("a = ['x', 'y']"),
            canonical_of("a = ['x\",\"y']")
        );
        assert_ne!(canonical_of("a = 'b '"), canonical_of("a = 'b'"));
    }

    #[test]
    fn huge_integers_are_no_panic() {
        let source = Source::new(
            "a.toml",
            format!("a = {}\nb = 0x{}", "9".repeat(400), "f".repeat(400)),
        );
        let (document, _) = parse(&source).expect("good syntax");
        for (_, value) in &document {
            assert_eq!(number(value.get_ref()), Some(f64::INFINITY));
        }
    }

    #[test]
    fn the_content_of_a_plain_string_has_a_place() {
        let source = Source::new("a.toml", r#"a = "1 + x" # b"#);
        assert_eq!(content_span(&source, 4..11, "1 + x"), Some(5..10));
        let escaped = Source::new("a.toml", r#"a = "1\u0020x""#);
        assert_eq!(content_span(&escaped, 4..14, "1 x"), None);
    }
}
