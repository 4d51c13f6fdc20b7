//! Joints: which types there are, and the keys that each needs.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{Joint, JointKind};

use super::context::{Context, Entry, Fields};

/// The keys that every joint may have.
pub(super) const KEYS: [&str; 3] = ["type", "markers", "description"];

/// A type of joint as the file knows it.
pub(super) struct JointType {
    /// What `type` says.
    pub(super) name: &'static str,
    /// The keys besides [`KEYS`].
    pub(super) keys: &'static [&'static str],
    /// Reads these keys.
    read: Read,
}

type Read = for<'a> fn(&mut Context<'a>, &Fields<'a>) -> Option<JointKind>;

/// Every type of joint; a new one is a line here and a variant of [`JointKind`].
pub(super) static JOINT_TYPES: [JointType; 10] = [
    plain("revolute", |_, _| Some(JointKind::Revolute)),
    plain("translational", |_, _| Some(JointKind::Translational)),
    plain("slot", |_, _| Some(JointKind::Slot)),
    JointType {
        name: "link",
        keys: &["length"],
        read: |context, fields| {
            let length = context.required_quantity(fields, "length", "0.1")?;
            context.check_positive(&length, "`length`");
            Some(JointKind::Link {
                length: length.expression,
            })
        },
    },
    JointType {
        name: "revolute_translational",
        keys: &["offset"],
        read: |context, fields| {
            let offset = context.required_quantity(fields, "offset", "0.1")?;
            Some(JointKind::RevoluteTranslational {
                offset: offset.expression,
            })
        },
    },
    plain("weld", |_, _| Some(JointKind::Weld)),
    JointType {
        name: "gear",
        keys: &["radii", "teeth", "internal", "carrier"],
        read: |context, fields| context.gear(fields),
    },
    JointType {
        name: "belt",
        keys: &["radii", "teeth", "crossed", "carrier"],
        read: |context, fields| context.belt(fields),
    },
    JointType {
        name: "rack_and_pinion",
        keys: &["radius", "side"],
        read: |context, fields| context.rack_and_pinion(fields),
    },
    JointType {
        name: "cam",
        keys: &["follower", "radius", "profile"],
        read: |context, fields| context.cam(fields),
    },
];

/// A type that needs nothing but its markers.
const fn plain(name: &'static str, read: Read) -> JointType {
    JointType {
        name,
        keys: &[],
        read,
    }
}

impl<'a> Context<'a> {
    pub(super) fn lower_joints(&mut self, entries: &[Entry<'a>]) -> Vec<Joint> {
        let joints = entries.iter();
        joints
            .filter_map(|entry| self.lower_joint(*entry))
            .collect()
    }

    fn lower_joint(&mut self, entry: Entry<'a>) -> Option<Joint> {
        let fields = self.entry_fields(entry, "joint")?;
        let joint_type = self.joint_type(&fields);
        let markers = self.marker_pair(&fields);
        let mut legal = KEYS.to_vec();
        match joint_type {
            Some(joint_type) => legal.extend(joint_type.keys),
            // Of a type that is not known the keys are not known either.
            None => legal.extend(fields.entries().map(|entry| entry.name())),
        }
        self.check_keys(&fields, &legal);
        self.description(&fields);
        let kind = (joint_type?.read)(self, &fields)?;
        let (from, to) = markers?;
        Some(Joint {
            name: entry.name().to_owned(),
            kind,
            from,
            to,
        })
    }

    fn joint_type(&mut self, fields: &Fields<'a>) -> Option<&'static JointType> {
        let value = self.required(fields, "type", "\"revolute\"")?;
        let names: Vec<_> = JOINT_TYPES.iter().map(|t| (t.name, t)).collect();
        self.choice(value, &names, code::UNKNOWN_JOINT_TYPE, "joint type")
    }
}
