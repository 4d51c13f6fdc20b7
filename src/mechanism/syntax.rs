//! TOML document in which each key and value knows its place.

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::diagnostic::code;
use super::toml_error::syntax_error;
use super::{Diagnostic, Source, Span};

/// Key with its place.
pub(super) type Key<'a> = Spanned<DeString<'a>>;

/// Value with its place.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// Table in the order of the file.
pub(super) type Table<'a> = DeTable<'a>;

/// The TOML parser's message about a key that a table already has.
const DUPLICATE_KEY: &str = "duplicate key";

/// Parses the text. Returns with the document the places of repeated keys, whose first value counts.
///
/// # Errors
///
/// The file is not UTF-8, or has a syntax error: only the first, as one slip causes others.
pub(super) fn parse(source: &Source) -> Result<(Table<'_>, Vec<Span>), Diagnostic> {
    if let Some(fault) = source.fault() {
        return Err(
            Diagnostic::error(code::NOT_UTF_8, format!("the file {fault}"))
                .label(fault.span(), "")
                .help(fault.help().to_owned()),
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
    Ok((document.into_inner(), duplicates))
}

/// Returns the place of the first of two equal keys, of which the second is at `second`; `None` if
/// they are in no common table.
///
/// The parser names only the second. Under another name it becomes a key beside the first. The lines
/// after it may have a third.
pub(super) fn first_place(text: &str, second: &Span) -> Option<Span> {
    let name = text.get(second.clone())?;
    let line = text[second.end..]
        .split_inclusive('\n')
        .next()
        .unwrap_or_default();
    let other_name = "_".repeat(name.len());
    let renamed = [&text[..second.start], &other_name, line].concat();
    let (document, _) = DeTable::parse_recoverable(&renamed);
    let table = table_with_key(document.get_ref(), second)?;
    let (first, _) = table.get_key_value(name.trim_matches(['"', '\'']))?;
    Some(first.span())
}

/// Returns the table whose key is at a place.
fn table_with_key<'t, 'a>(table: &'t Table<'a>, place: &Span) -> Option<&'t Table<'a>> {
    if table.keys().any(|key| key.span() == *place) {
        return Some(table);
    }
    let mut inner = table.values().flat_map(|value| match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => vec![value],
    });
    inner.find_map(|value| table_with_key(value.get_ref().as_table()?, place))
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
    fn the_first_of_two_equal_keys_is_in_the_same_table() {
        // The last `k` of each text is the second, the one in angle brackets the first.
        for text in [
            "[a] # one, two\nk = 1\n[b] # one, two\n<k> = 1\nk = 2\n",
            "[a]\nk = 1\n[b]\n<k> = 1\n[b.c]\nd = 1\n[b.k]\n",
            "[<k>]\nx = 1\n[a]\n[k]\n",
            "x = { k = 1, y = [{ <k> = 1,\n  k = 2,\n  z = 3 }] }\n",
            "[a]\nb.<k> = 1\nb.k = 2\n",
        ] {
            let first = text.find('<').expect("it is marked");
            let text = text.replace(['<', '>'], "");
            let second = text.rfind('k').expect("it is the last one");
            let found = first_place(&text, &(second..second + 1));
            assert_eq!(found, Some(first..first + 1), "{text}");
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
