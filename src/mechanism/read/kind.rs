//! Kinds of values: texts, words, flags, arrays and tables.

use std::collections::HashSet;
use std::hash::Hash;
use std::marker::PhantomData;

use toml::de::DeValue;

use crate::mechanism::Span;
use crate::mechanism::diagnostic::code;
use crate::mechanism::names;
use crate::mechanism::syntax::{Key, Table, Value};
use crate::mechanism::wording::quoted;
use crate::unit::UnitName;

use super::context::Context;

/// Kind of value: how it is read, and how editors check it.
pub(super) trait Kind<'a> {
    /// Result of reading.
    type Value;

    /// Returns the value, `None` if it is wrong, which is reported.
    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Self::Value>;

    /// Returns the JSON Schema.
    fn schema(&self) -> serde_json::Value;

    /// Returns the unit of the value's numbers.
    fn unit(&self) -> Option<UnitName> {
        None
    }
}

/// Implements [`Kind::schema`] by a JSON value.
macro_rules! schema {
    ($this:ident => $($json:tt)+) => {
        fn schema(&self) -> serde_json::Value {
            let $this = self;
            serde_json::json!($($json)+)
        }
    };
    ($($json:tt)+) => {
        fn schema(&self) -> serde_json::Value {
            serde_json::json!($($json)+)
        }
    };
}

pub(super) use schema;

/// Pattern of names in the JSON Schema.
pub(super) const NAME: &str = "^[A-Za-z][A-Za-z0-9_]*$";

/// Keys and values of a table of the file.
#[derive(Clone)]
pub(super) struct Fields<'a> {
    pub(super) table: &'a Table<'a>,
    /// Place of the table's name, where a missing key is reported.
    pub(super) place: Span,
    /// Name of what it describes: "joint `A`".
    pub(super) subject: String,
}

/// Named thing: `crank` in `[bodies]`.
#[derive(Clone, Copy)]
pub(super) struct Entry<'a> {
    pub(super) key: &'a Key<'a>,
    pub(super) value: &'a Value<'a>,
}

impl<'a> Entry<'a> {
    pub(super) fn name(&self) -> &'a str {
        self.key.get_ref()
    }
}

/// Value of a key, or an item of its array.
pub(super) struct Item<'f, 'a> {
    /// Table that has the key.
    pub(super) fields: &'f Fields<'a>,
    pub(super) key: &'a Key<'a>,
    pub(super) value: &'a Value<'a>,
}

impl<'f, 'a> Item<'f, 'a> {
    pub(super) fn span(&self) -> Span {
        self.value.span()
    }

    /// Returns an item of the array.
    pub(super) fn with(&self, value: &'a Value<'a>) -> Item<'f, 'a> {
        Item { value, ..*self }
    }
}

/// Text, which the FMU's XML can have.
pub(super) struct Text;

impl<'a> Kind<'a> for Text {
    type Value = String;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<String> {
        let text = context.text(item.value)?;
        // XML 1.0, section 2.2: characters that no document may have, not even escaped.
        let is_illegal = |c: &char| matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
        if let Some(character) = text.chars().find(is_illegal) {
            let message = format!(
                "`{}` has the character U+{:04X}, which the FMU's XML cannot have",
                item.key.get_ref(),
                u32::from(character)
            );
            context.error(code::ILLEGAL_TEXT, item.span(), message);
            return None;
        }
        Some(text.to_owned())
    }

    schema! {{ "type": "string" }}
}

/// Name of a file or of one of its columns.
pub(super) struct ExternalName;

impl<'a> Kind<'a> for ExternalName {
    type Value = &'a str;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<&'a str> {
        context.text(item.value)
    }

    schema! {{ "type": "string" }}
}

/// `true` or `false`.
pub(super) struct Flag;

impl<'a> Kind<'a> for Flag {
    type Value = bool;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<bool> {
        let flag = item.value.get_ref().as_bool();
        if flag.is_none() {
            context.wrong_type(item.value, "`true` or `false`");
        }
        flag
    }

    schema! {{ "type": "boolean" }}
}

/// Returns help for another term for a word.
pub(super) fn word_here(word: &str) -> String {
    format!("the word for it here is `{word}`")
}

/// Choice among words.
pub(super) struct Word<T> {
    /// Name of what is chosen: "coordinate".
    noun: &'static str,
    /// Code of the error for an unknown word.
    code: &'static str,
    /// Returns the words with their meanings.
    words: fn() -> Vec<(&'static str, T)>,
    /// Returns help for another term.
    synonym: fn(&str) -> Option<String>,
}

impl<T> Word<T> {
    pub(super) const fn new(
        noun: &'static str,
        code: &'static str,
        words: fn() -> Vec<(&'static str, T)>,
    ) -> Self {
        Self {
            noun,
            code,
            words,
            synonym: |_| None,
        }
    }

    /// Returns the choice with other terms for its words, which messages explain.
    pub(super) const fn with_synonyms(self, synonym: fn(&str) -> Option<String>) -> Self {
        Self { synonym, ..self }
    }

    fn names(&self) -> Vec<&'static str> {
        (self.words)().iter().map(|(word, _)| *word).collect()
    }
}

impl<'a, T> Kind<'a> for Word<T> {
    type Value = T;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<T> {
        let text = context.text(item.value)?;
        let meaning = (self.words)().into_iter().find(|(word, _)| *word == text);
        if meaning.is_none() {
            let message = format!("no {} {}", self.noun, quoted(text));
            let help = (self.synonym)(text).or_else(|| names::help(text, &self.names(), &[]));
            context.error(self.code, item.span(), message).help = help;
        }
        meaning.map(|(_, meaning)| meaning)
    }

    schema! { word => { "enum": word.names() } }
}

/// Array of values in a form such as `[x, y]`.
pub(super) struct Array<K, const N: usize> {
    form: &'static str,
    items: [K; N],
}

impl<K, const N: usize> Array<K, N> {
    pub(super) const fn new(form: &'static str, items: [K; N]) -> Self {
        Self { form, items }
    }
}

impl<'a, K: Kind<'a>, const N: usize> Kind<'a> for Array<K, N> {
    type Value = [K::Value; N];

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<[K::Value; N]> {
        let expected = format!("an array `{}`", self.form);
        let values = context.items(item.value, &expected)?;
        if values.len() != N {
            context.wrong_type(item.value, &expected);
            return None;
        }
        // Each is read, so that each wrong one is reported.
        let mut kinds = self.items.iter().zip(values);
        let read = [(); N].map(|()| {
            let (kind, value) = kinds.next()?;
            kind.read(context, &item.with(value))
        });
        read.into_iter()
            .collect::<Option<Vec<_>>>()?
            .try_into()
            .ok()
    }

    schema! {
        array => {
            "type": "array",
            "prefixItems": array.items.iter().map(Kind::schema).collect::<Vec<_>>(),
            "minItems": N,
            "maxItems": N,
        }
    }

    fn unit(&self) -> Option<UnitName> {
        self.items[0].unit()
    }
}

/// Things of the mechanism, each once.
pub(super) struct List<K> {
    /// Name of the things: "markers".
    pub(super) plural: &'static str,
    pub(super) item: K,
}

impl<'a, K: Kind<'a, Value: Copy + Eq + Hash>> Kind<'a> for List<K> {
    type Value = Vec<K::Value>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<K::Value>> {
        let mut seen = HashSet::new();
        let mut things = Vec::new();
        for name in context.items(item.value, &format!("an array of {}", self.plural))? {
            let Some(thing) = self.item.read(context, &item.with(name)) else {
                continue;
            };
            if seen.insert(thing) {
                things.push(thing);
            } else {
                let quoted = quoted(name.get_ref().as_str().unwrap_or_default());
                let message = format!("{quoted} is listed twice");
                context.error(code::DUPLICATE_OUTPUT, name.span(), message);
            }
        }
        Some(things)
    }

    schema! { list => { "type": "array", "items": list.item.schema(), "uniqueItems": true } }
}

/// Part of the file that editors know by a schema and that is read later.
pub(super) trait Described {
    fn schema() -> serde_json::Value;
}

/// Part of the file described as `A` or as `B` says.
pub(super) struct AnyOf<A, B>(PhantomData<(A, B)>);

impl<A: Described, B: Described> Described for AnyOf<A, B> {
    fn schema() -> serde_json::Value {
        // One list of all shapes: forms and completion look for the shape of a thing in it.
        let shapes = [A::schema(), B::schema()].into_iter();
        let shapes = shapes.flat_map(|schema| match schema.get("anyOf") {
            Some(serde_json::Value::Array(shapes)) => shapes.clone(),
            _ => vec![schema],
        });
        serde_json::json!({ "anyOf": shapes.collect::<Vec<_>>() })
    }
}

/// Table described as `T` says.
pub(super) struct Section<T>(pub(super) PhantomData<T>);

impl<'a, T: Described> Kind<'a> for Section<T> {
    type Value = Fields<'a>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Fields<'a>> {
        context.fields(
            item.key.span(),
            item.value,
            format!("`[{}]`", item.key.get_ref()),
        )
    }

    schema! { T::schema() }
}

/// Table of named things, each described as `T` says.
pub(super) struct Named<T>(pub(super) PhantomData<T>);

impl<'a, T: Described> Kind<'a> for Named<T> {
    type Value = Vec<Entry<'a>>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<Entry<'a>>> {
        context.entries(item)
    }

    schema! {
        {
            "type": "object",
            "propertyNames": { "pattern": NAME, "not": { "enum": crate::mechanism::expression::taken().collect::<Vec<_>>() } },
            "additionalProperties": T::schema(),
        }
    }
}

impl<'a> Context<'a> {
    /// Returns the keys and values of a table called `subject`, whose name stands at `place`.
    pub(super) fn fields(
        &mut self,
        place: Span,
        value: &'a Value<'a>,
        subject: String,
    ) -> Option<Fields<'a>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            let help = match value.get_ref() {
                DeValue::String(_) if subject.starts_with("measure ") => {
                    Some("a formula is written `{ value = \"crank.phi/2\" }`")
                }
                DeValue::Array(_) if subject.is_empty() => {
                    Some("each thing has a name: `[bodies.crank]`, not `[[bodies]]`")
                }
                _ => None,
            };
            self.wrong_type(value, "a table").help = help.map(str::to_owned);
        }
        Some(Fields {
            table: table?,
            place,
            subject,
        })
    }

    /// Returns the named things of a table.
    pub(super) fn entries(&mut self, item: &Item<'_, 'a>) -> Option<Vec<Entry<'a>>> {
        let fields = self.fields(item.key.span(), item.value, String::new())?;
        let entries = fields.table.iter();
        Some(entries.map(|(key, value)| Entry { key, value }).collect())
    }
}
