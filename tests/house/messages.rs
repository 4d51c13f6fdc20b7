//! Messages from the scripts to the solver, as types for the scripts: `crates/page/scripts/messages.d.ts`.
//!
//! The types follow from the requests in Rust. `INSTA_UPDATE=always cargo test --test house messages`
//! writes them anew; `make check-scripts` holds the scripts against them.

use std::fmt::Write as _;
use std::path::Path;

use syn::{Attribute, Expr, Fields, GenericArgument, Item, Lit, Meta, PathArguments, Type};

/// The requests: file, and the name of its enumeration `Request` for scripts.
const SOURCES: [(&str, &str); 3] = [
    ("crates/tools/src/page/request.rs", "PageRequest"),
    ("crates/tools/src/studio/request.rs", "StudioRequest"),
    ("crates/studio/src/lib.rs", "ExportRequest"),
];
const TYPES: &str = "crates/page/scripts/messages.d.ts";

#[test]
fn the_types_of_messages_are_those_of_the_requests() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut types = "// Messages from the scripts to the solver. Written by `tests/house/messages.rs` from the requests in \
                     Rust.\n"
        .to_owned();
    for (file, name) in SOURCES {
        let text = std::fs::read_to_string(root.join(file)).expect("the file is there");
        let source = syn::parse_file(&text).expect("it is Rust");
        for item in &source.items {
            types += &declaration(item, name);
        }
    }
    let path = root.join(TYPES);
    if std::env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always") {
        std::fs::write(&path, &types).expect("it can be written");
    }
    let written = std::fs::read_to_string(&path).expect("the file is there");
    let message = "INSTA_UPDATE=always cargo test --test house messages";
    assert!(written == types, "{TYPES} is not up to date: {message}");
}

/// Returns the declaration of what a request consists of; nothing for other items.
fn declaration(item: &Item, request: &str) -> String {
    let (attributes, name, body) = match item {
        Item::Enum(own) if is_read(&own.attrs) => {
            let tag = serde(&own.attrs, "tag");
            let variants = own.variants.iter();
            let variants = variants.filter(|variant| !has(&variant.attrs, "other"));
            let variants = variants.map(|variant| {
                let word = snake(&variant.ident.to_string());
                let Some(tag) = &tag else {
                    return format!("\n  | \"{word}\"");
                };
                let mut text = String::new();
                for line in documentation(&variant.attrs) {
                    let _ = write!(text, "\n  //{line}");
                }
                let fields = fields(&variant.fields);
                text + &format!("\n  | {{ {tag}: \"{word}\"{fields} }}")
            });
            (&own.attrs, &own.ident, variants.collect())
        }
        Item::Struct(own) if is_read(&own.attrs) => {
            let body = match serde(&own.attrs, "from") {
                Some(from) => format!(" {from}"),
                None => format!(" {{ {} }}", fields(&own.fields).trim_start_matches("; ")),
            };
            (&own.attrs, &own.ident, body)
        }
        Item::Type(own) => {
            let body = format!(" {}", script_type(&own.ty));
            (&own.attrs, &own.ident, body)
        }
        _ => return String::new(),
    };
    let name = match name.to_string() {
        name if name == "Request" => request.to_owned(),
        name => name,
    };
    let mut text = "\n".to_owned();
    for line in documentation(attributes) {
        let _ = writeln!(text, "//{line}");
    }
    text + &format!("export type {name} ={body};\n")
}

/// Returns the fields behind others.
fn fields(fields: &Fields) -> String {
    let fields = fields.iter().map(|field| {
        let name = field.ident.as_ref().expect("it has a name").to_string();
        let name = name.trim_start_matches("r#");
        let mut own = script_type(&field.ty);
        let is_option =
            matches!(&field.ty, Type::Path(path) if path.path.segments[0].ident == "Option");
        if is_option {
            own += " | null";
        }
        let mark = if is_option || has(&field.attrs, "default") {
            "?"
        } else {
            ""
        };
        format!("; {name}{mark}: {own}")
    });
    fields.collect()
}

/// Returns the type of the JSON that a type is read from; of an option that of its content.
fn script_type(own: &Type) -> String {
    match own {
        Type::Array(array) => {
            let Expr::Lit(length) = &array.len else {
                panic!("a list has a length")
            };
            let Lit::Int(length) = &length.lit else {
                panic!("a length is a number")
            };
            let length: usize = length.base10_parse().expect("it is a number");
            format!("[{}]", vec![script_type(&array.elem); length].join(", "))
        }
        Type::Tuple(tuple) => {
            let parts: Vec<String> = tuple.elems.iter().map(script_type).collect();
            format!("[{}]", parts.join(", "))
        }
        Type::Path(path) => {
            let last = path.path.segments.last().expect("a path has parts");
            let inner = match &last.arguments {
                PathArguments::AngleBracketed(inner) => match &inner.args[0] {
                    GenericArgument::Type(inner) => script_type(inner),
                    _ => panic!("messages have no lifetimes"),
                },
                _ => String::new(),
            };
            match last.ident.to_string().as_str() {
                "String" => "string".to_owned(),
                "f64" | "usize" => "number".to_owned(),
                "bool" => "boolean".to_owned(),
                "Value" => "unknown".to_owned(),
                "Vec" => format!("{inner}[]"),
                "Option" => inner,
                other => other.to_owned(),
            }
        }
        _ => panic!("messages have no such types"),
    }
}

/// Returns the lines of a documentation comment, each with its blank.
fn documentation(attributes: &[Attribute]) -> Vec<String> {
    let lines = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
                Expr::Lit(line) => match &line.lit {
                    Lit::Str(line) => Some(line.value().replace('\\', "")),
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        });
    lines.collect()
}

/// Returns whether a type is read from JSON.
fn is_read(attributes: &[Attribute]) -> bool {
    let mut lists = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::List(list) if list.path.is_ident("derive") => Some(list.tokens.to_string()),
            _ => None,
        });
    lists.any(|derived| derived.contains("Deserialize"))
}

/// Returns the value of a key of `#[serde(…)]`.
fn serde(attributes: &[Attribute], key: &str) -> Option<String> {
    let mut found = None;
    for attribute in attributes.iter().filter(|own| own.path().is_ident("serde")) {
        let parsed = attribute.parse_nested_meta(|meta| {
            let is_sought = meta.path.is_ident(key);
            if let Ok(value) = meta.value() {
                let value: syn::LitStr = value.parse()?;
                if is_sought {
                    found = Some(value.value());
                }
            } else if is_sought {
                found = Some(String::new());
            }
            Ok(())
        });
        parsed.expect("attributes of serde are words and texts");
    }
    found
}

fn has(attributes: &[Attribute], key: &str) -> bool {
    serde(attributes, key).is_some()
}

/// Returns a name in snake case.
fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.extend(letter.to_lowercase());
    }
    text
}
