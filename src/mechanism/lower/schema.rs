//! The file format as a JSON Schema (2020-12), from the tables by which the reader goes.

use serde_json::{Map, Value, json};

use super::{
    bodies, cams, coordinates, header, joints, motions, names, parameters, settings, tables, wheels,
};
use crate::mechanism::names::{BODY_QUANTITIES, taken};
use crate::mechanism::{DisplayUnit, Unit};

/// A schema of mechanism files, by which editors complete and check them.
///
/// It knows keys, types and choices. What depends on more than one place, such as whether a name
/// stands for anything, only the reader knows.
///
/// # Panics
///
/// If a key of the reader has no schema, which a test excludes.
#[must_use]
pub fn schema() -> Value {
    let mut schema = object(
        "A planar mechanism for biela.",
        &header::KEYS,
        &["format", "name", "bodies"],
        root_key,
    );
    let fields = schema.as_object_mut().expect("it is an object");
    fields.insert(
        "$schema".to_owned(),
        json!("https://json-schema.org/draft/2020-12/schema"),
    );
    fields.insert("title".to_owned(), json!("biela mechanism, format 1"));
    fields.insert(
        "$defs".to_owned(),
        json!({
            "quantity": {
                "description": "A number in SI units (m, rad, s, kg), or an expression over the parameters such as \"60*deg\".",
                "type": ["number", "string"],
            },
            "pair": list(&json!({ "$ref": "#/$defs/quantity" }), 2, 2),
            "marker": {
                "description": "A marker as body.marker; ground is a body here.",
                "type": "string",
                "pattern": r"^[A-Za-z][A-Za-z0-9_]*\.[A-Za-z][A-Za-z0-9_]*$",
            },
            "markers": with(
                list(&json!({ "$ref": "#/$defs/marker" }), 2, 2),
                "description",
                json!("The markers i and j, on different bodies: what is measured is j as seen from i."),
            ),
            "frames": {
                "description": "Markers: frames fixed on the body.",
                "type": "object",
                "propertyNames": { "pattern": NAME, "not": { "enum": BODY_QUANTITIES } },
                "additionalProperties": with(
                    list(&json!({ "$ref": "#/$defs/quantity" }), 2, 3),
                    "description",
                    json!("[x, y] or [x, y, angle] in the body's frame."),
                ),
            },
            "table": object("A motion that goes through points.", &[&motions::KEYS[..], &tables::TABLE_KEYS].concat(), &[], table_key),
            "contour": object("Points of a closed contour.", &tables::TABLE_KEYS, &[], table_key),
            "joint": joint(),
        }),
    );
    schema
}

/// A name in a mechanism.
const NAME: &str = "^[A-Za-z][A-Za-z0-9_]*$";

fn root_key(key: &str) -> Option<Value> {
    let text = |description: &str| json!({ "type": "string", "description": description });
    Some(match key {
        "format" => json!({ "const": 1, "description": "The format of this file." }),
        "name" => json!({
            "description": "The FMU's modelName and modelIdentifier: a C identifier.",
            "type": "string",
            "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
            "not": { "enum": header::C_KEYWORDS.as_slice() },
        }),
        "description" => text("What it is, in one line."),
        "author" => text("Who made it; goes to the FMU."),
        "version" => text("Its version; goes to the FMU."),
        "license" => text("Its licence; goes to the FMU."),
        "copyright" => text("Its copyright; goes to the FMU."),
        "parameters" => named(
            "Numbers that can be changed in the FMU without exporting again.",
            json!({
                "anyOf": [
                    { "$ref": "#/$defs/quantity" },
                    object("A parameter with attributes.", &parameters::KEYS, &["value"], parameter_key),
                ],
            }),
        ),
        "ground" => object("What does not move.", &names::GROUND_KEYS, &[], |key| {
            (key == "markers").then(|| json!({ "$ref": "#/$defs/frames" }))
        }),
        "bodies" => with(
            named(
                "The rigid bodies that move.",
                object("A body.", &bodies::KEYS, &[], body_key),
            ),
            "minProperties",
            json!(1),
        ),
        "joints" => named(
            "What holds bodies together.",
            json!({ "$ref": "#/$defs/joint" }),
        ),
        "constraints" => named(
            "Bare coordinates held at values.",
            coordinate(
                "A coordinate held at a value.",
                &coordinates::CONSTRAINT_KEYS,
                &["value"],
            ),
        ),
        "drivers" => named(
            "What moves the mechanism.",
            with(
                coordinate(
                    "A coordinate that is driven.",
                    &coordinates::DRIVER_KEYS,
                    &[],
                ),
                "oneOf",
                json!([{ "required": ["start"] }, { "required": ["motion"] }]),
            ),
        ),
        "measures" => named(
            "Coordinates that are told.",
            coordinate(
                "A coordinate that is told, with its rates.",
                &coordinates::MEASURE_KEYS,
                &[],
            ),
        ),
        "outputs" => object(
            "What the FMU has as outputs.",
            &settings::OUTPUT_KEYS,
            &[],
            |key| {
                Some(match key {
                    "bodies" => json!({
                        "description": "Only these bodies; all if left out.",
                        "type": "array",
                        "items": { "type": "string", "pattern": NAME },
                        "uniqueItems": true,
                    }),
                    "markers" => json!({
                        "description": "Points of interest.",
                        "type": "array",
                        "items": { "$ref": "#/$defs/marker" },
                        "uniqueItems": true,
                    }),
                    _ => return None,
                })
            },
        ),
        "simulation" => object(
            "The default experiment.",
            &settings::SIMULATION_KEYS,
            &[],
            |key| {
                let description = match key {
                    "start" => "Start time [s].",
                    "stop" => "Stop time [s].",
                    "step" => "Communication step [s].",
                    "tolerance" => "Tolerance for hosts; biela solves to rounding.",
                    "gravity" => {
                        return Some(with_ref("pair", "Acceleration of gravity [x, y] [m/s2]."));
                    }
                    _ => return None,
                };
                Some(with_ref("quantity", description))
            },
        ),
        _ => return None,
    })
}

fn parameter_key(key: &str) -> Option<Value> {
    Some(match key {
        "value" => with_ref(
            "quantity",
            "The value; derived if it uses other parameters.",
        ),
        "unit" => {
            json!({ "enum": Unit::ALL.map(|unit| unit.name), "description": "The unit of the value." })
        }
        "display" => json!({
            "enum": DisplayUnit::ALL.map(|unit| unit.name),
            "description": "The unit in which hosts show it.",
        }),
        "min" => with_ref("quantity", "The smallest permitted value."),
        "max" => with_ref("quantity", "The largest permitted value."),
        "tunable" => {
            json!({ "type": "boolean", "description": "Whether it may change between steps." })
        }
        "description" => description(),
        _ => return None,
    })
}

fn body_key(key: &str) -> Option<Value> {
    Some(match key {
        "markers" => json!({ "$ref": "#/$defs/frames" }),
        "estimate" => with(
            list(&json!({ "$ref": "#/$defs/quantity" }), 3, 3),
            "description",
            json!("[x, y, phi]: where to look for the assembly."),
        ),
        "mass" => with_ref("quantity", "Mass [kg]."),
        "inertia" => with_ref(
            "quantity",
            "Moment of inertia about the centre of mass [kg.m2].",
        ),
        "center" => with_ref("pair", "Centre of mass [x, y] in the body's frame."),
        "description" => description(),
        _ => return None,
    })
}

/// A table of a coordinate, with these keys besides its own.
fn coordinate(what: &str, further: &[&str], required: &[&str]) -> Value {
    let keys = [&coordinates::KEYS[..], further].concat();
    let required = [&["coordinate", "markers"][..], required].concat();
    object(what, &keys, &required, |key| {
        Some(match key {
            "coordinate" => json!({
                "description": "What is measured from marker i to marker j.",
                "enum": choices(&coordinates::COORDINATES),
            }),
            "markers" => json!({ "$ref": "#/$defs/markers" }),
            "axes" => with_ref(
                "marker",
                "On whose axes x or y is measured, if not on those of i.",
            ),
            "value" => with_ref("quantity", "The value at which it is held."),
            "start" => with_ref("quantity", "Makes it an FMI input with this start value."),
            "motion" => json!({
                "description": "Prescribes it: an expression in t, or a table.",
                "anyOf": [{ "$ref": "#/$defs/quantity" }, { "$ref": "#/$defs/table" }],
            }),
            "description" => description(),
            _ => return None,
        })
    })
}

fn table_key(key: &str) -> Option<Value> {
    Some(match key {
        "table" => json!({
            "description": "The points.",
            "type": "array",
            "items": { "$ref": "#/$defs/pair" },
            "minItems": 2,
        }),
        "file" => json!({ "type": "string", "description": "A CSV file beside this one." }),
        "columns" => with(
            list(&json!({ "type": "string" }), 2, 2),
            "description",
            json!("Its columns, by name; the first two if left out."),
        ),
        "scale" => json!({
            "description": "What abscissas and values are multiplied by.",
            "$ref": "#/$defs/pair",
        }),
        "law" => {
            json!({ "enum": choices(&motions::LAWS), "description": "How it goes from point to point." })
        }
        "ends" => {
            json!({ "enum": choices(&motions::ENDS), "description": "What comes before the first point and after the last." })
        }
        _ => return None,
    })
}

/// A joint: for each type its keys.
fn joint() -> Value {
    let types: Vec<&str> = joints::JOINT_TYPES.iter().map(|joint| joint.name).collect();
    let branches = joints::JOINT_TYPES.iter().map(|joint| {
        let keys = [&joints::KEYS[..], joint.keys].concat();
        let required: &[&str] = match joint.name {
            "link" => &["length"],
            "revolute_translational" => &["offset"],
            "rack_and_pinion" => &["radius"],
            "cam" => &["follower", "profile"],
            _ => &[],
        };
        let mut branch = object("", &keys, required, joint_key);
        if joint.keys.contains(&"teeth") {
            branch = with(
                branch,
                "oneOf",
                json!([{ "required": ["radii"] }, { "required": ["teeth"] }]),
            );
        }
        json!({ "if": { "properties": { "type": { "const": joint.name } } }, "then": branch })
    });
    json!({
        "type": "object",
        "required": ["type", "markers"],
        "properties": { "type": { "enum": types, "description": "The type of joint." } },
        "allOf": branches.collect::<Vec<_>>(),
    })
}

fn joint_key(key: &str) -> Option<Value> {
    let flag = |description: &str| json!({ "type": "boolean", "description": description });
    Some(match key {
        // Its choices stand where it is chosen.
        "type" => json!(true),
        "markers" => json!({ "$ref": "#/$defs/markers" }),
        "description" => description(),
        "length" => with_ref("quantity", "The distance of the two points."),
        "offset" => with_ref("quantity", "How far j is beside the x-axis of i."),
        "radii" => with_ref("pair", "Radii of the pitch circles of i and j."),
        "teeth" => with_ref("pair", "Teeth of the wheels of i and j."),
        "internal" => flag("Whether one of the wheels has its teeth inside."),
        "crossed" => flag("Whether the belt crosses between the wheels."),
        "carrier" => {
            json!({ "type": "string", "pattern": NAME, "description": "The body that carries the axles; ground if left out." })
        }
        "radius" => with_ref(
            "quantity",
            "The radius of the pinion, or of the follower's roller.",
        ),
        "side" => {
            json!({ "enum": choices(&wheels::SIDES), "description": "On which side of the rack the pinion is." })
        }
        "follower" => {
            json!({ "enum": choices(&cams::FOLLOWERS), "description": "What touches the cam." })
        }
        "profile" => json!({
            "description": "The cam's polar radius: an expression in theta, or points.",
            "anyOf": [{ "$ref": "#/$defs/quantity" }, { "$ref": "#/$defs/contour" }],
        }),
        _ => return None,
    })
}

fn description() -> Value {
    json!({ "type": "string", "description": "What it is, in one line." })
}

/// A table with these keys and no others.
fn object(
    what: &str,
    keys: &[&str],
    required: &[&str],
    of: impl Fn(&str) -> Option<Value>,
) -> Value {
    let properties: Map<String, Value> = keys
        .iter()
        .map(|key| {
            let schema = of(key).unwrap_or_else(|| panic!("`{key}` has no schema"));
            ((*key).to_owned(), schema)
        })
        .collect();
    let mut schema =
        json!({ "type": "object", "properties": properties, "additionalProperties": false });
    if !what.is_empty() {
        schema = with(schema, "description", json!(what));
    }
    if !required.is_empty() {
        schema = with(schema, "required", json!(required));
    }
    schema
}

/// A table of things by name.
fn named(what: &str, thing: Value) -> Value {
    let taken: Vec<&str> = taken().collect();
    let mut schema = json!({
        "description": what,
        "type": "object",
        "propertyNames": { "pattern": NAME, "not": { "enum": taken } },
    });
    schema["additionalProperties"] = thing;
    schema
}

fn list(item: &Value, least: usize, most: usize) -> Value {
    json!({ "type": "array", "items": item, "minItems": least, "maxItems": most })
}

fn with_ref(definition: &str, description: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{definition}"), "description": description })
}

fn with(mut schema: Value, key: &str, value: Value) -> Value {
    schema[key] = value;
    schema
}

fn choices<T>(choices: &[(&'static str, T)]) -> Vec<&'static str> {
    choices.iter().map(|(name, _)| *name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_reader_has_a_schema() {
        let schema = schema();
        let properties = schema["properties"].as_object().expect("there are keys");
        assert!(properties.keys().eq(header::KEYS.iter()));
        let joint = &schema["$defs"]["joint"];
        assert_eq!(
            joint["allOf"].as_array().map(Vec::len),
            Some(joints::JOINT_TYPES.len())
        );
    }
}
