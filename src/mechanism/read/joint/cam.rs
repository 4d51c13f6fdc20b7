//! `cam`: a follower on the contour of a cam.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::Described;
use crate::mechanism::read::kind::{Flag, Item, Kind, Word, schema};
use crate::mechanism::read::motion::LAW;
use crate::mechanism::read::number::NUMBER;
use crate::mechanism::read::number::{LENGTH, Quantity, RATIO};
use crate::mechanism::read::points::PointKeys;
use crate::mechanism::read::table::table;
use crate::mechanism::{
    CamFollower, Interpolation, JointKind, Profile, ProfileError, ProfileInForce, Span, Variable,
};

use super::joint_type;

joint_type! {
    "cam" => |keys, context| context.cam(keys);

    /// A follower, which has marker j, on the contour of a cam, which has marker i.
    struct Cam<'a> {
        /// Part of the follower that touches the cam.
        #[required("\"roller\"")]
        follower: Option<CamFollower> = FOLLOWER,
        /// Radius of the roller.
        radius: Quantity = LENGTH.positive(),
        /// Polar radius of the contour [m]: an expression in theta, or points.
        #[required("\"0.04 + 0.01*(1 - cos(theta))\"")]
        profile: Profile = Contour,
        /// Whether the follower lifts off in free motion, where the contact would have to pull.
        unilateral: bool = Flag,
        /// Part of the velocity with which it bounces, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
    }
}

/// Followers; `None` is a roller, whose radius has a key of its own.
const FOLLOWER: Word<Option<CamFollower>> = Word::new("follower", code::ILLEGAL_VALUE, || {
    vec![
        ("knife", Some(CamFollower::Knife)),
        ("roller", None),
        ("flat", Some(CamFollower::Flat)),
    ]
});

table! {
    /// A contour through points.
    struct ContourKeys<'a> {
        /// Way from each point to the next; a closed spline if left out.
        law: Interpolation = LAW,
    }
}

/// Contour of a cam.
struct Contour;

impl<'a> Kind<'a> for Contour {
    type Value = Profile;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Profile> {
        if context.is_points_alone(
            item,
            "profile",
            "expected `profile = \"0.04 + 0.01*cos(theta)\"`, `profile = { table = [[0, 0.04], …] }` \
             or `profile = { file = \"a.csv\" }`",
        ) {
            return None;
        }
        let profile = if item.value.get_ref().is_table() {
            let fields = context.fields(item.span(), item.value, "the profile".to_owned())?;
            let keys = context.table::<(PointKeys<'a>, ContourKeys<'a>)>(&fields);
            context.contour_table(keys)?
        } else {
            Profile::Expression(
                context
                    .formula(item.value, &[Variable::PolarAngle], None)?
                    .expression,
            )
        };
        context.check_contour(&profile, item.span())?;
        Some(profile)
    }

    schema! {{ "anyOf": [NUMBER.schema(), <(PointKeys<'_>, ContourKeys<'_>)>::schema()] }}
}

impl<'a> Context<'a> {
    fn cam(&mut self, keys: Cam<'a>) -> Option<JointKind> {
        let follower = match (keys.follower.value?, keys.radius.key.clone()) {
            (None, None) => {
                self.missing_key(&keys.owner, "radius", "0.01");
                return None;
            }
            (None, Some(_)) => CamFollower::Roller {
                radius: keys.radius.expression()?,
            },
            (Some(follower), radius) => {
                if let Some(span) = radius {
                    let message = format!("{} has `radius`, but no roller", keys.owner.subject);
                    self.error(code::UNKNOWN_KEY, span, message)
                        .suggest("only `follower = \"roller\"` has a radius");
                }
                follower
            }
        };
        Some(JointKind::Cam {
            follower,
            profile: keys.profile.value?,
            play: self.unilateral(keys.unilateral, keys.restitution, &keys.owner)?,
        })
    }

    fn contour_table(
        &mut self,
        (keys, contour): (PointKeys<'a>, ContourKeys<'a>),
    ) -> Option<Profile> {
        let law_place = contour.law.span.clone();
        let interpolation = contour.law.or(Interpolation::Spline);
        if let Some(Interpolation::Linear | Interpolation::Steps) = interpolation {
            let message = "a contour of straight lines or steps has corners";
            self.error(code::ILLEGAL_VALUE, law_place, message)
                .suggest("leave `law` out for a spline, or take a motion law such as `cycloidal`");
            return None;
        }
        let place = keys.owner.place.clone();
        let mut points = self.points(keys)?;
        self.check_ordinates_positive(&points, "the radius of a contour")?;
        self.close_turn(&mut points)?;
        let interpolation = interpolation?;
        if interpolation == Interpolation::Spline && points.table.points.len() < 3 {
            let message = "a closed contour has three points at least";
            self.error(code::BAD_TABLE, place, message)
                .suggest("a rise and a return by a law, such as `law = \"cycloidal\"`, need two");
            return None;
        }
        Some(Profile::Table {
            table: points.table,
            interpolation,
        })
    }

    /// Refuses a profile that is no contour with the file's parameters.
    fn check_contour(&mut self, profile: &Profile, span: Span) -> Option<()> {
        if !self.knows(profile.parameters()) {
            return Some(());
        }
        let mut in_force = ProfileInForce::new(profile, self.parameter_values.len());
        let error = in_force
            .set_parameters(|id| self.known_value(id))
            .and_then(|()| in_force.check_smoothness())
            .err();
        let Some(error) = error else {
            return Some(());
        };
        let message = error.to_string();
        let problem = self.error(code::BAD_PROFILE, span, message);
        if let ProfileError::Open { .. } | ProfileError::Corner { .. } = error {
            problem.suggest(
                "a contour goes once round without corners: use `theta` in sines and cosines of \
                 whole multiples, or give points",
            );
        }
        None
    }
}
