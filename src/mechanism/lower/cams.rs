//! Cam pairs: the follower and the cam's profile.

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::syntax::Value;
use crate::mechanism::{CamFollower, JointKind, Profile, ProfileError, ProfileInForce, Variable};

use super::context::{Context, Fields};
use super::tables::TABLE_KEYS;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Follower {
    Knife,
    Roller,
    Flat,
}

pub(super) const FOLLOWERS: [(&str, Follower); 3] = [
    ("knife", Follower::Knife),
    ("roller", Follower::Roller),
    ("flat", Follower::Flat),
];

impl<'a> Context<'a> {
    pub(super) fn cam(&mut self, fields: &Fields<'a>) -> Option<JointKind> {
        let follower = self
            .required(fields, "follower", "\"roller\"")
            .and_then(|value| self.choice(value, &FOLLOWERS, code::ILLEGAL_VALUE, "follower"));
        let radius = match follower {
            Some(Follower::Roller) => {
                let radius = self.required_quantity(fields, "radius", "0.01");
                if let Some(radius) = &radius {
                    self.check_positive(radius, "`radius`");
                }
                radius
            }
            _ => None,
        };
        if let (Some(Follower::Knife | Follower::Flat), Some(span)) =
            (follower, fields.key_span("radius"))
        {
            self.error_with_help(
                code::UNKNOWN_KEY,
                span,
                format!("{} has `radius`, but no roller", fields.subject),
                "only `follower = \"roller\"` has a radius".to_owned(),
            );
        }
        let profile = self
            .required(fields, "profile", "\"0.04 + 0.01*(1 - cos(theta))\"")
            .and_then(|value| self.profile(value));
        let follower = match follower? {
            Follower::Knife => CamFollower::Knife,
            Follower::Flat => CamFollower::Flat,
            Follower::Roller => CamFollower::Roller {
                radius: radius?.expression,
            },
        };
        Some(JointKind::Cam {
            follower,
            profile: profile?,
        })
    }

    fn profile(&mut self, value: &'a Value<'a>) -> Option<Profile> {
        let profile = match value.get_ref() {
            DeValue::Table(table) => {
                let fields = Fields {
                    table,
                    place: value.span(),
                    subject: "the profile".to_owned(),
                };
                self.check_keys(&fields, &TABLE_KEYS);
                let mut known = self.table(&fields, "[theta, R]")?;
                self.check_ordinates_positive(&known, "the radius of a contour")?;
                self.close_turn(&mut known)?;
                if known.len() < 3 {
                    let message = "a closed contour has three points at least";
                    self.error(code::BAD_TABLE, value.span(), message);
                    return None;
                }
                Profile::Table(known.table)
            }
            _ => Profile::Expression(self.expression(value, Some(Variable::PolarAngle))?),
        };
        self.check_contour(&profile, value)?;
        Some(profile)
    }

    /// Refuses what is no contour with the file's parameters.
    fn check_contour(&mut self, profile: &Profile, value: &'a Value<'a>) -> Option<()> {
        let values = &self.parameter_values;
        if profile.parameters().any(|id| values[id.index()].is_none()) {
            return Some(());
        }
        let mut in_force = ProfileInForce::new(profile, values.len());
        let error = in_force
            .set_parameters(|id| values[id.index()].unwrap_or(0.0))
            .and_then(|()| in_force.check_smoothness())
            .err();
        let Some(error) = error else {
            return Some(());
        };
        let help = match error {
            ProfileError::Open { .. } | ProfileError::Corner { .. } => Some(
                "a contour goes once round without corners: use `theta` in sines and cosines of \
                 whole multiples, or give points"
                    .to_owned(),
            ),
            _ => None,
        };
        self.error_with_help(code::BAD_PROFILE, value.span(), error.to_string(), help);
        None
    }
}
