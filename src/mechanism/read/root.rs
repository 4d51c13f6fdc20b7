//! The file as a whole: its format, its name and its sections.

use std::marker::PhantomData;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::c_keywords;
use crate::mechanism::names::{MOST_CHARACTERS, is_c_identifier, is_device, similar_identifier};
use crate::mechanism::syntax;
use crate::mechanism::wording::quoted;

use super::body::{BodyKeys, GroundKeys};
use super::contact::ContactKeys;
use super::context::Context;
use super::coordinate::{ConstraintKeys, CoordinateKeys};
use super::derived::AnyMeasure;
use super::driver::DriverKeys;
use super::force::AnyForce;
use super::freedom::FreedomKeys;
use super::friction::AnyFriction;
use super::function::AnyFunction;
use super::input::InputKeys;
use super::joint::AnyJoint;
use super::kind::Described;
use super::kind::{Entry, Fields, Item, Kind, Named, Section, Text, schema};
use super::parameter::AnyParameter;
use super::settings::{OutputKeys, SimulationKeys};
use super::stop::AnyStop;
use super::table::table;

table! {
    /// A planar mechanism for biela.
    struct Root<'a> {
        /// Version of the file format.
        #[required("1")]
        format: () = Format,
        /// FMI modelName and modelIdentifier: a C identifier.
        #[required("\"my_mechanism\"")]
        name: String = ModelName,
        /// Description in one line.
        description: String = Text,
        /// Author of the mechanism, for the FMU.
        author: String = Text,
        /// Version of the mechanism, for the FMU.
        version: String = Text,
        /// Licence of the mechanism, for the FMU.
        license: String = Text,
        /// Copyright of the mechanism, for the FMU.
        copyright: String = Text,
        /// Numbers that can be changed in the FMU without a new export.
        parameters: Vec<Entry<'a>> = Named(PhantomData::<AnyParameter>),
        /// Numbers from outside: FMI inputs.
        inputs: Vec<Entry<'a>> = Named(PhantomData::<InputKeys<'static>>),
        /// Functions that expressions call by name.
        functions: Vec<Entry<'a>> = Named(PhantomData::<AnyFunction>),
        /// The body that never moves.
        ground: Fields<'a> = Section(PhantomData::<GroundKeys<'static>>),
        /// The rigid bodies that move.
        bodies: Vec<Entry<'a>> = Named(PhantomData::<BodyKeys<'static>>),
        /// Joints between bodies.
        joints: Vec<Entry<'a>> = Named(PhantomData::<AnyJoint>),
        /// Coordinates held at values.
        constraints: Vec<Entry<'a>> = Named(PhantomData::<(CoordinateKeys<'static>, ConstraintKeys<'static>)>),
        /// Coordinates that are driven.
        drivers: Vec<Entry<'a>> = Named(PhantomData::<(CoordinateKeys<'static>, DriverKeys<'static>)>),
        /// Coordinates that move by the forces.
        freedoms: Vec<Entry<'a>> = Named(PhantomData::<(CoordinateKeys<'static>, FreedomKeys<'static>)>),
        /// Coordinates that are outputs.
        measures: Vec<Entry<'a>> = Named(PhantomData::<AnyMeasure>),
        /// Forces on the bodies, besides gravity.
        forces: Vec<Entry<'a>> = Named(PhantomData::<AnyForce>),
        /// Limits of coordinates.
        stops: Vec<Entry<'a>> = Named(PhantomData::<AnyStop>),
        /// Shapes that do not enter each other.
        contacts: Vec<Entry<'a>> = Named(PhantomData::<ContactKeys<'static>>),
        /// Friction along coordinates.
        friction: Vec<Entry<'a>> = Named(PhantomData::<AnyFriction>),
        /// Outputs of the FMU.
        outputs: Fields<'a> = Section(PhantomData::<OutputKeys<'static>>),
        /// Default experiment.
        simulation: Fields<'a> = Section(PhantomData::<SimulationKeys<'static>>),
    }
}

/// Version of the file format: 1.
pub(super) struct Format;

impl<'a> Kind<'a> for Format {
    type Value = ();

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<()> {
        if syntax::number(item.value.get_ref()) == Some(1.0) {
            return Some(());
        }
        let message = "this format of the file is not known";
        context
            .error(code::UNKNOWN_FORMAT, item.span(), message)
            .suggest("expected `format = 1`");
        None
    }

    schema! {{ "const": 1 }}
}

/// Pattern of names for which [`is_device`] holds.
const DEVICE: &str =
    "^([Cc][Oo][Nn]|[Pp][Rr][Nn]|[Aa][Uu][Xx]|[Nn][Uu][Ll]|([Cc][Oo][Mm]|[Ll][Pp][Tt])[0-9])$";

/// Name of the mechanism.
pub(super) struct ModelName;

impl<'a> Kind<'a> for ModelName {
    type Value = String;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<String> {
        let name = context.text(item.value)?;
        let name_of = |what| format!("the mechanism's name {} is {what}", quoted(name));
        let (message, rule) = if !is_c_identifier(name) {
            let message = name_of("not a C identifier");
            let rule = "letters, digits and `_`, not starting with a digit, and no word of the C \
                        language";
            (message, rule)
        } else if is_device(name) {
            let message = name_of("the name of a device on Windows");
            (message, "no file there can have it")
        } else if name.len() > MOST_CHARACTERS {
            let message = format!(
                "the mechanism's name has {} characters, at most {MOST_CHARACTERS} are possible",
                name.len()
            );
            (message, "files in the FMU are called so")
        } else {
            return Some(name.to_owned());
        };
        let similar = similar_identifier(name);
        let example = similar.map(|name| format!("; expected for example {}", quoted(&name)));
        context
            .error(code::ILLEGAL_NAME, item.span(), message)
            .suggest(format!("{rule}{}", example.unwrap_or_default()));
        None
    }

    schema! {
        {
            "type": "string",
            "maxLength": MOST_CHARACTERS,
            "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
            "not": { "anyOf": [{ "enum": c_keywords().collect::<Vec<_>>() }, { "pattern": DEVICE }] },
        }
    }
}

/// Returns the JSON Schema of mechanism files.
pub(super) fn schema() -> serde_json::Value {
    use serde_json::json;
    let mut schema = Root::schema();
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("biela mechanism, format 1");
    schema["$defs"] = json!({
        "number": {
            "description": "A number in SI units (m, rad, s, kg), or an expression over the parameters such as \"60*deg\".",
            "type": ["number", "string"],
        },
        "marker": {
            "description": "A marker as body.marker; ground is a body here.",
            "type": "string",
            "pattern": r"^[A-Za-z][A-Za-z0-9_]*\.[A-Za-z][A-Za-z0-9_]*$",
        },
    });
    // The reader reports missing bodies and an empty section alike.
    schema["required"] = json!(["format", "name", "bodies"]);
    schema["properties"]["bodies"]["minProperties"] = json!(1);
    schema
}
