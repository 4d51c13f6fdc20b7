//! Joints: a file per type, which declares the type's keys and reads them.

mod belt;
mod cam;
mod coupling;
mod curve;
mod gear;
mod link;
mod phase;
mod play;
mod rack_and_pinion;
mod revolute;
mod revolute_translational;
mod rolling;
mod rope;
mod slot;
mod translational;
mod weld;
mod wheels;

use crate::mechanism::diagnostic::code;
use crate::mechanism::{Joint, JointKind, MarkerId};

use super::context::Context;
use super::kind::{Described, Entry, Fields, Text, Word, word_here};
use super::reference::{MARKERS, MarkerPair};
use super::table::{Keys, table};

table! {
    /// A joint between two bodies.
    struct JointKeys<'a> {
        /// Type of the joint.
        #[required("\"revolute\"")]
        r#type: &'static JointType = JOINT_TYPE,
        /// Description in one line.
        description: String = Text,
    }

    /// A joint between two bodies.
    struct PairKeys<'a> {
        /// Markers i and j, on different bodies.
        #[required(MARKERS)]
        markers: [MarkerId; 2] = MarkerPair,
    }
}

/// Joint that the keys of its type make, with its markers i and j.
type Made = (JointKind, [MarkerId; 2]);

/// Type of joint as the file knows it.
pub(super) struct JointType {
    /// Name under `type`.
    name: &'static str,
    /// Other terms for it, each with the keys to write for it where the name alone says too little.
    synonyms: &'static [(&'static str, Option<&'static str>)],
    /// Reads the keys of the type.
    read: for<'a> fn(&mut Context<'a>, &Fields<'a>) -> Option<Made>,
}

/// Declares a type of joint: its name and other terms for it, some with the keys to write for them,
/// its keys besides those of every joint, and the joint that they make. One with `own markers` reads
/// these too, and returns i and j.
macro_rules! joint_type {
    (@keys) => { None };
    (@keys $keys:literal) => { Some($keys) };
    (own markers; $($rest:tt)+) => {
        $crate::mechanism::read::joint::joint_type! {
            @by ($crate::mechanism::read::joint::read_own)
                [$crate::mechanism::read::joint::JointKeys<'_>]
            $($rest)+
        }
    };
    ($name:literal $($rest:tt)+) => {
        $crate::mechanism::read::joint::joint_type! {
            @by ($crate::mechanism::read::joint::read_pair)
                [(
                    $crate::mechanism::read::joint::JointKeys<'_>,
                    $crate::mechanism::read::joint::PairKeys<'_>,
                )]
            $name $($rest)+
        }
    };
    (
        @by ($read:path) [$common:ty]
        $name:literal $(or $synonym:literal $(as $written:literal)?)* => $kind:expr;
        $(#[$($attribute:tt)+])+
        struct $keys:ident<$life:lifetime> { $($key:tt)* }
    ) => {
        $crate::mechanism::read::table::table! {
            $(#[$($attribute)+])+
            struct $keys<$life> { $($key)* }
        }

        pub(super) static TYPE: $crate::mechanism::read::joint::JointType = $crate::mechanism::read::joint::JointType {
            name: $name,
            synonyms: &[$((
                $synonym,
                $crate::mechanism::read::joint::joint_type!(@keys $($written)?),
            )),*],
            read: |context, fields| {
                let kind: for<$life> fn($keys<$life>, &mut $crate::mechanism::read::context::Context<$life>) -> _ = $kind;
                $read(context, fields, kind)
            },
        };

        /// Returns the schema of a joint of the type.
        pub(super) fn schema() -> serde_json::Value {
            <($common, $keys<'_>) as $crate::mechanism::read::kind::Described>::schema()
        }
    };
}

/// Reads the keys of a joint between two markers, and makes it.
fn read_pair<'a, K: Keys<'a>>(
    context: &mut Context<'a>,
    fields: &Fields<'a>,
    kind: fn(K, &mut Context<'a>) -> Option<JointKind>,
) -> Option<Made> {
    let (pair, keys) = context.further::<JointKeys<'a>, (PairKeys<'a>, K)>(fields);
    let kind = kind(keys, context);
    Some((kind?, pair.markers.value?))
}

/// Reads the keys of a joint with markers of its own, and makes it.
fn read_own<'a, K: Keys<'a>>(
    context: &mut Context<'a>,
    fields: &Fields<'a>,
    kind: fn(K, &mut Context<'a>) -> Option<Made>,
) -> Option<Made> {
    kind(context.further::<JointKeys<'a>, K>(fields), context)
}

use joint_type;

/// Lists the types of joints, each by its file.
macro_rules! joint_types {
    ($($file:ident,)+) => {
        static JOINT_TYPES: &[&JointType] = &[$(&$file::TYPE),+];

        /// Returns the schema of each type.
        fn schemas() -> Vec<serde_json::Value> {
            vec![$($file::schema()),+]
        }
    };
}

// A new type is a file and a line here.
joint_types! {
    revolute,
    translational,
    slot,
    link,
    revolute_translational,
    weld,
    gear,
    belt,
    rack_and_pinion,
    rolling,
    cam,
    coupling,
    rope,
    curve,
}

const JOINT_TYPE: Word<&JointType> = Word::new("joint type", code::UNKNOWN_JOINT_TYPE, || {
    let joint_types = JOINT_TYPES.iter();
    joint_types
        .map(|&joint_type| (joint_type.name, joint_type))
        .collect()
})
.with_synonyms(|text| {
    JOINT_TYPES.iter().find_map(|joint_type| {
        let mut synonyms = joint_type.synonyms.iter();
        let (_, written) = synonyms.find(|(term, _)| term.eq_ignore_ascii_case(text))?;
        Some(match written {
            Some(keys) => format!("write `{keys}`"),
            None => word_here(joint_type.name),
        })
    })
});

impl<'a> Context<'a> {
    pub(super) fn joint(&mut self, entry: Entry<'a>) -> Option<Joint> {
        let fields = self.entry_fields(entry, "joint")?;
        // The keys of an unknown type are unknown too.
        let common = JointKeys::read(self, &fields);
        let (kind, [from, to]) = (common.r#type.value?.read)(self, &fields)?;
        Some(Joint {
            name: entry.name().to_owned(),
            description: common.description.value.unwrap_or_default(),
            kind,
            from,
            to,
        })
    }
}

/// A joint in the JSON Schema: for each type its keys.
pub(super) struct AnyJoint;

impl Described for AnyJoint {
    fn schema() -> serde_json::Value {
        use serde_json::json;
        let mut joint = JointKeys::schema();
        let branches = JOINT_TYPES.iter().zip(schemas()).map(|(joint_type, mut keys)| {
            // The choice of types stands outside of the branches.
            keys["properties"]["type"] = json!(true);
            json!({ "if": { "properties": { "type": { "const": joint_type.name } } }, "then": keys })
        });
        joint["allOf"] = branches.collect();
        // Each branch has the other keys, and knows those of its type.
        joint["properties"] = json!({ "type": joint["properties"]["type"] });
        joint["additionalProperties"] = json!(true);
        joint
    }
}
