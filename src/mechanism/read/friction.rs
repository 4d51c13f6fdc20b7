//! Friction along coordinates and in joints.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown;
use crate::mechanism::{
    Bearing, BearingShape, CamFollower, CoordinateKind, Force, ForceLaw, FrictionLaw, Joint, Load,
    PassiveCause, RegularisedFriction, SlidingWay,
};

use super::context::Context;
use super::kind::{AnyOf, Array, Entry, Fields, Item, Kind, Text, schema};
use super::number::{LENGTH, NUMBER, Number, Quantity, RATIO};
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
        /// A joint of type revolute, translational, slot, link, curve or cam.
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
        /// Radius of the pin of a revolute joint or of a roller on a cam, or of both pins of a link; [r_i, r_j]
        /// for different ones.
        radius: Vec<Quantity> = Radii,
        /// Length of the guide of a translational joint or of the carriage on a curve, with the second marker in
        /// its middle: it bears the torque of the joint at its ends. If left out the torque makes no friction.
        length: Quantity = LENGTH.positive(),
        /// Description in one line.
        description: String = Text,
    }
}

table! {
    /// Friction along a coordinate, in proportion to the effort of a coupling that presses.
    struct PressedFrictionKeys<'a> {
        /// A coupling between lengths.
        #[required("\"press\"")]
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
        /// Description in one line.
        description: String = Text,
    }
}

/// Radius of one pin, or of two.
struct Radii;

impl Radii {
    const BOTH: Array<Number, 2> = Array::new("[r_i, r_j]", [LENGTH.positive(); 2]);
}

impl<'a> Kind<'a> for Radii {
    type Value = Vec<Quantity>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<Quantity>> {
        if item.value.get_ref().is_array() {
            return Some(Self::BOTH.read(context, item)?.into());
        }
        Some(vec![LENGTH.positive().read(context, item)?])
    }

    schema! {{ "anyOf": [LENGTH.positive().schema(), Self::BOTH.schema()] }}
}

/// Friction in a joint, as its kind decides it.
struct Rubs {
    way: SlidingWay,
    /// Kind of the coordinate that slides.
    kind: CoordinateKind,
    /// Pins whose radii the file gives.
    pins: usize,
    /// Whether a guide may have a length.
    has_length: bool,
}

impl Rubs {
    /// Returns how a joint rubs, `None` if it does not.
    fn of(joint: &Joint) -> Option<Self> {
        use CoordinateKind::{Angle, X};
        let own = joint.free_coordinate();
        let (way, kind, pins, has_length) = if let Some((follower, _)) = joint.cam() {
            match follower {
                CamFollower::Roller { .. } => (SlidingWay::Contact, Angle, 1, false),
                CamFollower::Knife | CamFollower::Flat => (SlidingWay::Contact, X, 0, false),
            }
        } else if let Some(curve) = joint.curve() {
            (SlidingWay::Contact, X, 0, curve.follow)
        } else if joint.rod().is_some() {
            (SlidingWay::Rod(0), Angle, 2, false)
        } else {
            let turns = joint.guide().is_none_or(|guide| guide.turns);
            let pins = usize::from(joint.is_pin());
            (SlidingWay::Coordinate, own?.kind, pins, !turns)
        };
        Some(Self {
            way,
            kind,
            pins,
            has_length,
        })
    }
}

/// Friction of any shape.
pub(super) type AnyFriction = AnyOf<
    Placed<FrictionKeys<'static>>,
    AnyOf<JointFrictionKeys<'static>, Placed<PressedFrictionKeys<'static>>>,
>;

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
    pub(super) fn friction(
        &mut self,
        entry: Entry<'a>,
        joints: Option<&[Joint]>,
    ) -> Option<Vec<Force>> {
        let fields = self.entry_fields(entry, PLACING.noun)?;
        let joint = fields.table.get("joint");
        let pressed = joint.and_then(|name| self.holders.get(name.get_ref().as_str()?));
        let pressed = pressed.and_then(|index| joints?.get(index)?.equation());
        let has = |key| fields.table.contains_key(key);
        if let (Some(equation), true) = (pressed, has("of") || has("coordinate")) {
            return Some(vec![self.pressed_friction(entry, equation.is_angle)?]);
        }
        if joint.is_some() {
            return self.joint_friction(entry, &fields, joints);
        }
        let (coordinate, _, keys) = self.placed::<FrictionKeys<'a>>(entry, &PLACING)?;
        let force = ("force", keys.force);
        let law = self.law(
            &keys.owner,
            force,
            keys.r#static,
            [keys.stribeck, keys.exponent],
            Some(keys.viscous),
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
        Some(vec![Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load,
        }])
    }

    /// Reads friction in a joint, that of a link at each of its pins.
    fn joint_friction(
        &mut self,
        entry: Entry<'a>,
        fields: &Fields<'a>,
        joints: Option<&[Joint]>,
    ) -> Option<Vec<Force>> {
        let keys = self.table::<JointFrictionKeys<'a>>(fields);
        self.warn_of_coefficient(&keys.coefficient, &fields.subject);
        let coefficient = ("coefficient", keys.coefficient);
        let viscous = keys.viscous.key.clone();
        let law = self.law(
            &keys.owner,
            coefficient,
            keys.r#static,
            [keys.stribeck, keys.exponent],
            Some(keys.viscous),
        );
        let index = keys.joint.value?;
        // None is behind the joints: a constraint.
        let joint = joints?.get(index);
        let Some((joint, rubs)) = joint.and_then(|joint| Some((joint, Rubs::of(joint)?))) else {
            let message = format!("{} is in no joint that slides", keys.owner.subject);
            self.error(code::FRICTION_COORDINATE, keys.joint.span.clone(), message)
                .suggest(
                    "friction acts in joints of type `revolute`, `translational`, `slot`, `link`, \
                     `curve` and `cam`, and along the coordinate that `of` names by a `coupling`; for \
                     others give `coordinate`, `markers` and `force`",
                );
            return None;
        };
        let given = keys.radius.value.as_ref().map_or(0, Vec::len);
        let foreign = [
            keys.radius.key.clone().filter(|_| given > rubs.pins),
            keys.length.key.clone().filter(|_| !rubs.has_length),
        ];
        let subject = &keys.owner.subject;
        let fault = if let Some(key) = foreign.into_iter().flatten().next() {
            Some((
                code::UNKNOWN_KEY,
                key,
                format!("{subject} has a key that its joint has no use for"),
                "a `revolute` joint and a roller on a `cam` have a `radius`, a `link` one or two, a \
                 `translational` joint and a `curve` with `follow` a `length`",
            ))
        } else if rubs.pins > 0 && keys.radius.key.is_none() {
            Some((
                code::MISSING_KEY,
                keys.owner.place.clone(),
                format!("{subject} has no `radius`"),
                "the friction of a pin is a torque: give the pin's radius, such as `radius = \"8*mm\"`",
            ))
        } else {
            let key = viscous.filter(|_| joint.kind.play().is_some());
            key.map(|key| {
                (
                    code::UNKNOWN_KEY,
                    key,
                    format!("{subject} has `viscous`, but is in a joint that opens"),
                    "friction ends there as the parts part: a damper is a force with `damping`",
                )
            })
        };
        if let Some((code, span, message, help)) = fault {
            self.error(code, span, message).suggest(help);
            return None;
        }
        let law = law?;
        let length = keys.length.optional()?.map(|q| q.expression);
        let radii = keys.radius.optional()?.unwrap_or_default();
        let description = keys.description.value.unwrap_or_default();
        let forces = (0..rubs.pins.max(1)).map(|pin| {
            let radius = radii.get(pin).or(radii.first());
            let shape = match radius {
                Some(radius) => BearingShape::Pin {
                    radius: radius.expression.clone(),
                },
                None => BearingShape::Guide {
                    length: length.clone(),
                },
            };
            let (way, end) = match rubs.way {
                SlidingWay::Rod(_) => (SlidingWay::Rod(pin), [".i", ".j"][pin]),
                way => (way, ""),
            };
            let mut law = law.clone();
            law.bearing = Some(Bearing {
                joint: index,
                shape,
                way,
            });
            Force {
                name: format!("{}{end}", entry.name()),
                description: description.clone(),
                load: Load::Passive {
                    coordinate: joint.coordinate(rubs.kind),
                    cause: PassiveCause::Friction(Box::new(law)),
                },
            }
        });
        Some(forces.collect())
    }

    /// Reads friction along a coordinate that a coupling presses.
    fn pressed_friction(&mut self, entry: Entry<'a>, by_torque: bool) -> Option<Force> {
        let (coordinate, _, keys) = self.placed::<PressedFrictionKeys<'a>>(entry, &PLACING)?;
        self.warn_of_coefficient(&keys.coefficient, &keys.owner.subject);
        let law = self.law(
            &keys.owner,
            ("coefficient", keys.coefficient),
            keys.r#static,
            [keys.stribeck, keys.exponent],
            None,
        );
        if by_torque {
            let message = format!("{} has a coupling between angles", keys.owner.subject);
            self.error(code::FRICTION_COORDINATE, keys.joint.span, message)
                .suggest("only a coupling between lengths presses with a force");
            return None;
        }
        let mut law = law?;
        law.bearing = Some(Bearing {
            joint: keys.joint.value?,
            shape: BearingShape::Effort,
            way: SlidingWay::Coordinate,
        });
        Some(Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load: Load::Passive {
                coordinate: coordinate?,
                cause: PassiveCause::Friction(Box::new(law)),
            },
        })
    }

    /// Warns of a coefficient that no surfaces have.
    fn warn_of_coefficient(&mut self, coefficient: &Field<Quantity>, subject: &str) {
        if let Some(number) = coefficient.number().filter(|c| *c > MOST_FRICTION) {
            let message = format!(
                "{subject} has the coefficient {}: more than any dry surfaces",
                shown(number)
            );
            self.warn(code::UNUSUAL_VALUE, coefficient.span.clone(), message)
                .suggest(
                    "steel on steel has 0.1 to 0.6, rubber on a road 1; percents are no unit here",
                );
        }
    }

    /// Returns the law of friction, with the force or the coefficient while it slides, under its key.
    fn law(
        &mut self,
        owner: &Fields<'a>,
        (key, sliding): (&str, Field<Quantity>),
        sticking: Field<Quantity>,
        [stribeck, exponent]: [Field<Quantity>; 2],
        viscous: Option<Field<Quantity>>,
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
            viscous: match viscous {
                Some(viscous) => viscous.optional()?.map(|q| q.expression),
                None => None,
            },
            bearing: None,
        })
    }
}
