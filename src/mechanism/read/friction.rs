//! Friction along coordinates and in joints.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown;
use crate::mechanism::{
    Bearing, BearingShape, Force, ForceLaw, FrictionLaw, Joint, Load, PassiveCause,
    RegularisedFriction,
};

use super::context::Context;
use super::kind::{AnyOf, Entry, Fields, Text};
use super::number::{LENGTH, NUMBER, Quantity, RATIO};
use super::placed::{Placed, Placing};
use super::reference::HolderName;
use super::table::{Field, table};

table! {
    /// Friction along a coordinate: it acts against its rate, and holds it at rest.
    struct FrictionKeys<'a> {
        /// Force of Coulomb [N or N.m].
        #[required("2.0")]
        force: Quantity = NUMBER.not_negative(),
        /// Largest force while it sticks [N or N.m]; that of Coulomb if left out.
        r#static: Quantity = NUMBER.not_negative(),
        /// Speed of Stribeck [m/s or rad/s]: about so fast, the force has fallen to that of Coulomb. If
        /// left out it falls at once.
        stribeck: Quantity = NUMBER.positive(),
        /// Exponent of Stribeck, at least 1; 2 if left out.
        exponent: Quantity = RATIO.positive(),
        /// Coefficient of viscous friction [N.s/m or N.m.s/rad].
        viscous: Quantity = NUMBER.not_negative(),
        /// Speed from which most of the force acts [m/s or rad/s]: slower, it falls to zero, and nothing
        /// sticks.
        regularised: Quantity = NUMBER.positive(),
        /// Description in one line.
        description: String = Text,
    }
}

table! {
    /// Friction in a joint, in proportion to its reaction.
    struct JointFrictionKeys<'a> {
        /// A revolute, translational or slot joint.
        #[required("\"A\"")]
        joint: usize = HolderName,
        /// Coefficient of friction while it slides.
        #[required("0.1")]
        coefficient: Quantity = RATIO.not_negative(),
        /// Coefficient while it sticks; the other one if left out.
        r#static: Quantity = RATIO.not_negative(),
        /// Speed of Stribeck [m/s or rad/s]: about so fast, the coefficient has fallen from `static` to
        /// `coefficient`. If left out it falls at once.
        stribeck: Quantity = NUMBER.positive(),
        /// Exponent of Stribeck, at least 1; 2 if left out.
        exponent: Quantity = RATIO.positive(),
        /// Coefficient of viscous friction [N.s/m or N.m.s/rad].
        viscous: Quantity = NUMBER.not_negative(),
        /// Radius of the pin of a revolute joint.
        radius: Quantity = LENGTH.positive(),
        /// Length of the guide of a translational joint, with the second marker in its middle: it bears
        /// the torque of the joint at its ends. If left out the torque makes no friction.
        length: Quantity = LENGTH.positive(),
        /// Description in one line.
        description: String = Text,
    }
}

/// Friction of any shape.
pub(super) type AnyFriction = AnyOf<Placed<FrictionKeys<'static>>, JointFrictionKeys<'static>>;

/// Coefficient of friction above those of dry surfaces: soft rubber has 1.5. Halved, a tyre is warned of.
/// Doubled, percents of a slippery pair, such as 3, pass.
const MOST_FRICTION: f64 = 2.0;

const PLACING: Placing = Placing {
    noun: "friction",
    verb: "slow",
    code: code::FRICTION_COORDINATE,
    or: ", or `joint` for the friction that its reaction makes",
};

impl<'a> Context<'a> {
    /// Reads friction, after the measures, drivers and joints; these are `None` if some cannot be read.
    pub(super) fn friction(&mut self, entry: Entry<'a>, joints: Option<&[Joint]>) -> Option<Force> {
        let fields = self.entry_fields(entry, PLACING.noun)?;
        if fields.table.contains_key("joint") {
            return self.joint_friction(entry, &fields, joints);
        }
        let (coordinate, _, keys) = self.placed::<FrictionKeys<'a>>(entry, &PLACING)?;
        let force = ("force", keys.force);
        let law = self.law(
            &keys.owner,
            force,
            keys.r#static,
            [keys.stribeck, keys.exponent],
            keys.viscous,
        );
        let (coordinate, law) = (coordinate?, law?);
        let load = match keys.regularised.optional()? {
            None => Load::Passive {
                coordinate,
                cause: PassiveCause::Friction(Box::new(law)),
            },
            Some(speed) => Load::Coordinate {
                coordinate,
                law: Some(ForceLaw {
                    friction: Some(Box::new(RegularisedFriction {
                        law,
                        speed: speed.expression,
                    })),
                    ..ForceLaw::default()
                }),
            },
        };
        Some(Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load,
        })
    }

    /// Reads friction in a joint.
    fn joint_friction(
        &mut self,
        entry: Entry<'a>,
        fields: &Fields<'a>,
        joints: Option<&[Joint]>,
    ) -> Option<Force> {
        let keys = self.table::<JointFrictionKeys<'a>>(fields);
        if let Some(coefficient) = keys.coefficient.number().filter(|c| *c > MOST_FRICTION) {
            let message = format!(
                "{} has the coefficient {}: more than any dry surfaces",
                fields.subject,
                shown(coefficient)
            );
            self.warn(code::UNUSUAL_VALUE, keys.coefficient.span.clone(), message)
                .suggest(
                    "steel on steel has 0.1 to 0.6, rubber on a road 1; percents are no unit here",
                );
        }
        let coefficient = ("coefficient", keys.coefficient);
        let law = self.law(
            &keys.owner,
            coefficient,
            keys.r#static,
            [keys.stribeck, keys.exponent],
            keys.viscous,
        );
        let index = keys.joint.value?;
        // None is behind the joints: a constraint.
        let joint = joints?.get(index);
        let coordinate = joint.and_then(Joint::free_coordinate);
        let is_pin = joint.is_some_and(Joint::is_pin);
        let guide = joint.and_then(Joint::guide);
        let is_guide = guide.is_some_and(|guide| !guide.turns);
        let subject = &keys.owner.subject;
        let foreign = [(&keys.radius.key, is_pin), (&keys.length.key, is_guide)];
        let foreign = foreign
            .into_iter()
            .find_map(|(key, fits)| key.clone().filter(|_| !fits));
        let (code, span, message, help) = if coordinate.is_none() {
            (
                code::FRICTION_COORDINATE,
                keys.joint.span.clone(),
                format!("{subject} is in no joint that slides"),
                "friction acts in joints of type `revolute`, `translational` and `slot`; for others give \
                 `coordinate`, `markers` and `force`",
            )
        } else if is_pin && keys.radius.key.is_none() {
            (
                code::MISSING_KEY,
                keys.owner.place.clone(),
                format!("{subject} has no `radius`"),
                "the friction of a pin is a torque: give the pin's radius, such as `radius = \"8*mm\"`",
            )
        } else if let Some(key) = foreign {
            (
                code::UNKNOWN_KEY,
                key,
                format!("{subject} has a key that its joint has no use for"),
                "a `revolute` joint has a `radius`, a `translational` one a `length`",
            )
        } else {
            let shape = match keys.radius.optional()? {
                Some(radius) => BearingShape::Pin {
                    radius: radius.expression,
                },
                None => BearingShape::Guide {
                    length: keys.length.optional()?.map(|q| q.expression),
                },
            };
            let mut law = law?;
            law.bearing = Some(Bearing {
                joint: index,
                shape,
            });
            return Some(Force {
                name: entry.name().to_owned(),
                description: keys.description.value.unwrap_or_default(),
                load: Load::Passive {
                    coordinate: coordinate?,
                    cause: PassiveCause::Friction(Box::new(law)),
                },
            });
        };
        self.error(code, span, message).suggest(help);
        None
    }

    /// Returns the law of friction, with the force or the coefficient while it slides, under its key.
    fn law(
        &mut self,
        owner: &Fields<'a>,
        (key, sliding): (&str, Field<Quantity>),
        sticking: Field<Quantity>,
        [stribeck, exponent]: [Field<Quantity>; 2],
        viscous: Field<Quantity>,
    ) -> Option<FrictionLaw> {
        if let (Some(sliding), Some(most)) = (sliding.number(), sticking.number())
            && most < sliding
        {
            let message = format!("{} sticks with less than it slides", owner.subject);
            self.error(code::OUT_OF_RANGE, sticking.span.clone(), message)
                .suggest(format!("`static` is at least `{key}`"));
        }
        if let (Some(span), None) = (&stribeck.key, &sticking.key) {
            let message = format!("{} has `stribeck`, but no `static`", owner.subject);
            self.error(code::UNKNOWN_KEY, span.clone(), message)
                .suggest(format!("friction falls from `static` to `{key}`"));
        }
        if let (Some(span), None) = (&exponent.key, &stribeck.key) {
            let message = format!("{} has `exponent`, but no `stribeck`", owner.subject);
            self.error(code::UNKNOWN_KEY, span.clone(), message)
                .suggest("`exponent` tells how friction falls over the speed `stribeck`");
        } else if exponent.number().is_some_and(|n| n > 0.0 && n < 1.0) {
            let message = format!("{} has an `exponent` below 1", owner.subject);
            self.error(code::OUT_OF_RANGE, exponent.span.clone(), message)
                .suggest("below 1 friction would fall infinitely steeply as sliding begins");
        }
        Some(FrictionLaw {
            coulomb: sliding.expression()?,
            sticking: sticking.optional()?.map(|q| q.expression),
            stribeck: stribeck.optional()?.map(|q| q.expression),
            exponent: exponent.optional()?.map(|q| q.expression),
            viscous: viscous.optional()?.map(|q| q.expression),
            bearing: None,
        })
    }
}
