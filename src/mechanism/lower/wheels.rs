//! Joints of wheels: gears, belts, rack and pinion.

use crate::mechanism::diagnostic::code;
use crate::mechanism::syntax::Value;
use crate::mechanism::{BodyId, Expression, JointKind, RackSide, WheelSizes};

use super::context::{Context, Fields};

pub(super) const SIDES: [(&str, RackSide); 2] =
    [("above", RackSide::Above), ("below", RackSide::Below)];

impl<'a> Context<'a> {
    pub(super) fn gear(&mut self, fields: &Fields<'a>) -> Option<JointKind> {
        let sizes = self.wheel_sizes(fields);
        let internal = self.flag(fields, "internal");
        let carrier = self.carrier(fields);
        Some(JointKind::Gear {
            sizes: sizes?,
            internal: internal?,
            carrier: carrier?,
        })
    }

    pub(super) fn belt(&mut self, fields: &Fields<'a>) -> Option<JointKind> {
        let sizes = self.wheel_sizes(fields);
        let crossed = self.flag(fields, "crossed");
        let carrier = self.carrier(fields);
        Some(JointKind::Belt {
            sizes: sizes?,
            crossed: crossed?,
            carrier: carrier?,
        })
    }

    pub(super) fn rack_and_pinion(&mut self, fields: &Fields<'a>) -> Option<JointKind> {
        let radius = self.required_quantity(fields, "radius", "0.05");
        if let Some(radius) = &radius {
            self.check_positive(radius, "`radius`");
        }
        let side = match fields.get("side") {
            Some(value) => self.choice(value, &SIDES, code::ILLEGAL_VALUE, "side"),
            None => Some(RackSide::Above),
        };
        Some(JointKind::RackAndPinion {
            radius: radius?.expression,
            side: side?,
        })
    }

    /// The sizes under `radii` or under `teeth`.
    fn wheel_sizes(&mut self, fields: &Fields<'a>) -> Option<WheelSizes> {
        match (fields.get("radii"), fields.get("teeth")) {
            (Some(radii), None) => Some(WheelSizes::Radii(self.two_sizes(radii, "a radius")?)),
            (None, Some(teeth)) => Some(WheelSizes::Teeth(
                self.two_sizes(teeth, "a number of teeth")?,
            )),
            (radii, teeth) => {
                let (place, has) = if radii.and(teeth).is_some() {
                    (fields.key_span("teeth")?, "both `radii` and `teeth`")
                } else {
                    (fields.place.clone(), "neither `radii` nor `teeth`")
                };
                self.error_with_help(
                    code::WHEEL_SIZES,
                    place,
                    format!("{} has {has}", fields.subject),
                    "their ratio decides: `radii = [0.02, 0.05]` or `teeth = [20, 50]`".to_owned(),
                );
                None
            }
        }
    }

    fn two_sizes(&mut self, value: &'a Value<'a>, what: &str) -> Option<[Expression; 2]> {
        let sizes = self.quantities::<2>(value, "an array of two numbers")?;
        for size in &sizes {
            self.check_positive(size, what);
        }
        Some(sizes.map(|size| size.expression))
    }

    /// A boolean, false if left out.
    fn flag(&mut self, fields: &Fields<'a>, key: &str) -> Option<bool> {
        fields
            .get(key)
            .map_or(Some(false), |value| self.boolean(value))
    }

    /// The body under `carrier`, ground if left out.
    fn carrier(&mut self, fields: &Fields<'a>) -> Option<Option<BodyId>> {
        match fields.get("carrier") {
            None => Some(None),
            Some(value) if self.text(value)? == "ground" => Some(None),
            Some(value) => self.moving_body(value).map(Some),
        }
    }
}
