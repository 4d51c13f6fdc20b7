//! Friction along coordinates.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{Force, ForceLaw, FrictionLaw, Load, PassiveCause, RegularisedFriction};

use super::context::Context;
use super::kind::{Entry, Text};
use super::number::{NUMBER, Quantity};
use super::placed::{Placed, Placing};
use super::table::table;

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
        /// Coefficient of viscous friction [N.s/m or N.m.s/rad].
        viscous: Quantity = NUMBER.not_negative(),
        /// Speed from which most of the force acts [m/s or rad/s]: slower, it falls to zero, and nothing
        /// sticks.
        regularised: Quantity = NUMBER.positive(),
        /// Description in one line.
        description: String = Text,
    }
}

/// Friction of either shape.
pub(super) type AnyFriction = Placed<FrictionKeys<'static>>;

const PLACING: Placing = Placing {
    noun: "friction",
    verb: "slow",
    code: code::FRICTION_COORDINATE,
};

impl<'a> Context<'a> {
    /// Reads friction, after the measures and drivers.
    pub(super) fn friction(&mut self, entry: Entry<'a>) -> Option<Force> {
        let (coordinate, _, keys) = self.placed::<FrictionKeys<'a>>(entry, &PLACING)?;
        let coulomb = keys.force.number();
        if let (Some(coulomb), Some(sticking)) = (coulomb, keys.r#static.number())
            && sticking < coulomb
        {
            let message = format!("{} sticks with less than it slides", keys.owner.subject);
            self.error(code::OUT_OF_RANGE, keys.r#static.span.clone(), message)
                .suggest("`static` is at least `force`");
        }
        if let (Some(span), None) = (&keys.stribeck.key, &keys.r#static.key) {
            let message = format!("{} has `stribeck`, but no `static`", keys.owner.subject);
            self.error(code::UNKNOWN_KEY, span.clone(), message)
                .suggest("the force falls from `static` to `force`");
        }
        let coordinate = coordinate?;
        let law = FrictionLaw {
            coulomb: keys.force.expression()?,
            sticking: keys.r#static.optional()?.map(|q| q.expression),
            stribeck: keys.stribeck.optional()?.map(|q| q.expression),
            viscous: keys.viscous.optional()?.map(|q| q.expression),
        };
        let load = match keys.regularised.optional()? {
            None => Load::Passive {
                coordinate,
                cause: PassiveCause::Friction(law),
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
}
