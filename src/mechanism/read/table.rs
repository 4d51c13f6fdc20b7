//! Tables of the file. Each is declared once, with its keys, their kinds and their meaning.
//!
//! [`table!`] declares a table as a structure with a field per key. Reading, the messages about
//! unknown and missing keys and the JSON Schema all follow from the declaration.

use std::sync::LazyLock;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names;
use crate::mechanism::syntax::Table;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Expression, Span};

use super::context::Context;
use super::kind::{Described, Entry, Fields, Item, Kind};
use super::number::Quantity;
use super::other_words;

/// Key of a table in the JSON Schema.
pub(super) struct Key {
    pub(super) name: &'static str,
    /// Whether the table must have the key.
    pub(super) required: bool,
    /// The schema of its value, with its meaning.
    pub(super) schema: serde_json::Value,
}

/// Two keys of which a table has exactly one; the code and the help of the error otherwise.
pub(super) type Alternative = ([&'static str; 2], &'static str, &'static str);

/// Table declared by [`table!`], or two that share one table of the file.
pub(super) trait Keys<'a>: Sized {
    /// Meaning of the table, for editors.
    const MEANING: &'static str;

    /// Returns the names of the keys.
    fn names() -> Vec<&'static str>;

    /// Returns the keys. A function of its own: a library that asks for no schema holds none.
    fn keys() -> Vec<Key>;

    fn alternative() -> Option<Alternative>;

    /// Reads the value of each key.
    fn read(context: &mut Context<'a>, fields: &Fields<'a>) -> Self;
}

impl<'a, A: Keys<'a>, B: Keys<'a>> Keys<'a> for (A, B) {
    const MEANING: &'static str = B::MEANING;

    fn names() -> Vec<&'static str> {
        [A::names(), B::names()].concat()
    }

    fn keys() -> Vec<Key> {
        A::keys().into_iter().chain(B::keys()).collect()
    }

    fn alternative() -> Option<Alternative> {
        A::alternative().or(B::alternative())
    }

    fn read(context: &mut Context<'a>, fields: &Fields<'a>) -> Self {
        (A::read(context, fields), B::read(context, fields))
    }
}

/// Part of a table under one key.
pub(super) struct Field<T> {
    /// Place of the key, `None` if it is left out.
    pub(super) key: Option<Span>,
    /// Place of the value, the table's if the key is left out.
    pub(super) span: Span,
    /// The value, `None` if the key is left out or its value is wrong.
    pub(super) value: Option<T>,
}

impl<T> Field<T> {
    /// Returns the value, `default` if the key is left out, `None` if its value is wrong.
    pub(super) fn or(self, default: T) -> Option<T> {
        Some(self.optional()?.unwrap_or(default))
    }

    /// Returns the value, `Some(None)` if the key is left out, `None` if its value is wrong.
    pub(super) fn optional(self) -> Option<Option<T>> {
        match self.key {
            Some(_) => self.value.map(Some),
            None => Some(None),
        }
    }
}

impl<T> Field<Vec<T>> {
    pub(super) fn items(&self) -> &[T] {
        self.value.as_deref().unwrap_or_default()
    }
}

impl<'a> Field<Fields<'a>> {
    /// Returns the keys and values, none if the section is left out or wrong.
    pub(super) fn or_empty(self) -> Fields<'a> {
        static EMPTY: LazyLock<Table<'static>> = LazyLock::new(Table::new);
        self.value.unwrap_or_else(|| Fields {
            table: &EMPTY,
            place: self.span,
            subject: String::new(),
        })
    }
}

impl Field<Quantity> {
    pub(super) fn expression(self) -> Option<Expression> {
        self.value.map(|quantity| quantity.expression)
    }

    /// Returns the value for the file's parameters, or `default` if the key is left out.
    pub(super) fn number_or(&self, default: f64) -> Option<f64> {
        match self.key {
            Some(_) => self.number(),
            None => Some(default),
        }
    }

    /// Returns the value for the file's parameters.
    pub(super) fn number(&self) -> Option<f64> {
        self.value.as_ref()?.value
    }
}

impl<const N: usize> Field<[Quantity; N]> {
    pub(super) fn expressions(self) -> Option<[Expression; N]> {
        self.value
            .map(|quantities| quantities.map(|quantity| quantity.expression))
    }
}

/// Declares tables: a structure with a field per key, `key: Type = kind`.
///
/// A documentation comment is the meaning that editors show; the unit comes from the kind.
/// `#[required(example)]` marks a key that the table must have, `#[one_of(a, b, code, help)]`
/// two keys of which it has exactly one.
macro_rules! table {
    ($(
        $(#[doc = $meaning:literal])+
        $(#[one_of($first:ident, $second:ident, $code:expr, $help:expr)])?
        struct $name:ident<$life:lifetime> {
            $(
                $(#[doc = $key_meaning:literal])+
                $(#[required($example:expr)])?
                $key:ident: $type:ty = $kind:expr,
            )*
        }
    )+) => {$(
        $(#[doc = $meaning])+
        pub(super) struct $name<$life> {
            $($(#[doc = $key_meaning])+ pub(super) $key: $crate::mechanism::read::table::Field<$type>,)*
            /// The whole table.
            #[allow(dead_code, reason = "only some tables are asked for their place and name")]
            pub(super) owner: $crate::mechanism::read::kind::Fields<$life>,
        }

        impl<$life> $crate::mechanism::read::table::Keys<$life> for $name<$life> {
            const MEANING: &'static str = concat!($($meaning),+);

            fn names() -> Vec<&'static str> {
                vec![$($crate::mechanism::read::table::key_name(stringify!($key)),)*]
            }

            fn keys() -> Vec<$crate::mechanism::read::table::Key> {
                vec![$(
                    $crate::mechanism::read::table::Key {
                        name: $crate::mechanism::read::table::key_name(stringify!($key)),
                        required: ![$($example,)? ""][0].is_empty(),
                        schema: $crate::mechanism::read::table::key_schema(
                            &$kind,
                            concat!($($key_meaning),+),
                        ),
                    },
                )*]
            }

            fn alternative() -> Option<$crate::mechanism::read::table::Alternative> {
                [$(Some(([stringify!($first), stringify!($second)], $code, $help)),)? None][0]
            }

            fn read(
                context: &mut $crate::mechanism::read::context::Context<$life>,
                fields: &$crate::mechanism::read::kind::Fields<$life>,
            ) -> Self {
                // A table without keys does not use the context.
                let _ = &context;
                Self {
                    $($key: context.field(
                        fields,
                        $crate::mechanism::read::table::key_name(stringify!($key)),
                        [$($example,)? ""][0],
                        &$kind,
                    ),)*
                    owner: fields.clone(),
                }
            }
        }
    )+};
}

pub(super) use table;

/// Returns the key that a field's identifier stands for: `type` for `r#type`.
pub(super) const fn key_name(identifier: &'static str) -> &'static str {
    match identifier.as_bytes() {
        [b'r', b'#', ..] => identifier.split_at(2).1,
        _ => identifier,
    }
}

impl<'a> Context<'a> {
    /// Reads a table; reports unknown, missing and conflicting keys.
    pub(super) fn table<T: Keys<'a>>(&mut self, fields: &Fields<'a>) -> T {
        self.check_keys::<T>(fields);
        T::read(self, fields)
    }

    /// Reads the keys of `T` in a table of which the other keys, those of `S`, have been read.
    pub(super) fn further<S: Keys<'a>, T: Keys<'a>>(&mut self, fields: &Fields<'a>) -> T {
        self.check_keys::<(S, T)>(fields);
        T::read(self, fields)
    }

    /// Reports unknown and conflicting keys.
    fn check_keys<T: Keys<'a>>(&mut self, fields: &Fields<'a>) {
        let known: Vec<&'static str> = T::names();
        for (key, value) in fields.table {
            let name: &str = key.get_ref();
            if !known.contains(&name) {
                let message = format!("unknown key {} in {}", quoted(name), fields.subject);
                let other = other_words::help(name, value, &known);
                let near = || {
                    let near = names::nearest(name, &known).into_iter().collect();
                    Some((names::help(name, &known, &[])?, near))
                };
                let (help, meant) = other.or_else(near).unzip();
                for meant in meant.into_iter().flatten() {
                    self.misspelt_keys.insert((fields.place.start, meant));
                }
                self.error(code::UNKNOWN_KEY, key.span(), message).help = help;
            }
        }
        let Some(([first, second], code, help)) = T::alternative() else {
            return;
        };
        let (place, has) = match [first, second].map(|name| fields.table.get_key_value(name)) {
            [Some(_), Some((key, _))] => (key.span(), format!("both `{first}` and `{second}`")),
            [None, None]
                if !self.is_misspelt(fields, first) && !self.is_misspelt(fields, second) =>
            {
                (
                    fields.place.clone(),
                    format!("neither `{first}` nor `{second}`"),
                )
            }
            _ => return,
        };
        let message = format!("{} has {has}", fields.subject);
        self.error(code, place, message).suggest(help);
    }

    /// Reads the table of a named thing, such as a "body".
    pub(super) fn entry<T: Keys<'a>>(&mut self, entry: Entry<'a>, noun: &str) -> Option<T> {
        let fields = self.entry_fields(entry, noun)?;
        Some(self.table(&fields))
    }

    pub(super) fn entry_fields(&mut self, entry: Entry<'a>, noun: &str) -> Option<Fields<'a>> {
        let subject = format!("{noun} {}", quoted(entry.name()));
        self.fields(entry.key.span(), entry.value, subject)
    }

    /// Reads the value of a key; reports one that is missing if there is an `example` for it.
    pub(super) fn field<K: Kind<'a>>(
        &mut self,
        fields: &Fields<'a>,
        name: &'static str,
        example: &str,
        kind: &K,
    ) -> Field<K::Value> {
        let Some((key, value)) = fields.table.get_key_value(name) else {
            if !example.is_empty() {
                self.missing_key(fields, name, example);
            }
            return Field {
                key: None,
                span: fields.place.clone(),
                value: None,
            };
        };
        Field {
            key: Some(key.span()),
            span: value.span(),
            value: kind.read(self, &Item { fields, key, value }),
        }
    }

    /// Returns whether another key of the table was probably meant to be this one.
    fn is_misspelt(&self, fields: &Fields<'a>, name: &'static str) -> bool {
        self.misspelt_keys.contains(&(fields.place.start, name))
    }

    /// Reports a key that is missing, unless it stands there with a slip.
    pub(super) fn missing_key(&mut self, fields: &Fields<'a>, name: &'static str, example: &str) {
        if self.is_misspelt(fields, name) {
            return;
        }
        let message = format!("{} has no `{name}`", fields.subject);
        self.error(code::MISSING_KEY, fields.place.clone(), message)
            .suggest(format!("add `{name} = {example}`"));
    }
}

/// Returns the schema of a key's value with its meaning and its unit.
pub(super) fn key_schema<'a>(kind: &impl Kind<'a>, meaning: &str) -> serde_json::Value {
    let meaning = meaning.trim();
    let mut schema = kind.schema();
    schema["description"] = match kind.unit() {
        Some(unit) => format!("{} [{unit}].", meaning.trim_end_matches('.')).into(),
        None => meaning.into(),
    };
    schema
}

/// A table is described by its keys and has no others.
impl<T: Keys<'static>> Described for T {
    fn schema() -> serde_json::Value {
        let keys = T::keys();
        let required: Vec<_> = (keys.iter().filter(|key| key.required))
            .map(|key| key.name)
            .collect();
        let properties = keys
            .into_iter()
            .map(|key| (key.name.to_owned(), key.schema));
        let mut schema = serde_json::json!({
            "type": "object",
            "description": T::MEANING.trim(),
            "properties": properties.collect::<serde_json::Map<_, _>>(),
            "required": required,
            "additionalProperties": false,
        });
        if let Some(([first, second], ..)) = T::alternative() {
            schema["oneOf"] =
                serde_json::json!([{ "required": [first] }, { "required": [second] }]);
        }
        schema
    }
}
