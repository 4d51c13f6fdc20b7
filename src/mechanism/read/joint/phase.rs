//! Constants of relations between wheels, and of equations.

use toml::de::DeValue;

use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::{Item, Kind, schema};
use crate::mechanism::read::number::NUMBER;
use crate::mechanism::read::number::Number;
use crate::mechanism::read::number::Quantity;
use crate::mechanism::read::table::Field;
use crate::mechanism::{Expression, Phase};

/// Word for the constant that the estimates give.
const DRAWN: &str = "drawn";

/// Phase: `"drawn"`, or a number.
pub(super) struct PhaseOf(pub(super) Number);

impl<'a> Kind<'a> for PhaseOf {
    type Value = Phase;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Phase> {
        if let DeValue::String(text) = item.value.get_ref()
            && text == DRAWN
        {
            return Some(Phase::Drawn);
        }
        let Quantity { expression, .. } = self.0.read(context, item)?;
        Some(Phase::At(expression))
    }

    schema! {{ "anyOf": [{ "const": DRAWN }, NUMBER.schema()] }}
}

/// Returns the phase under a key; zero if it is left out.
pub(super) fn phase(field: Field<Phase>) -> Option<Phase> {
    field.or(Phase::At(Expression::constant(0.0)))
}
