//! Constants of relations between wheels, and of equations.

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::did_you_mean;
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::{Item, Kind, schema};
use crate::mechanism::read::number::NUMBER;
use crate::mechanism::read::number::Number;
use crate::mechanism::read::number::Quantity;
use crate::mechanism::read::table::Field;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Expression, Phase};

/// Word for the constant that the estimates give.
const DRAWN: &str = "drawn";

/// Phase: `"drawn"`, or a number.
pub(super) struct PhaseOf(pub(super) Number);

impl<'a> Kind<'a> for PhaseOf {
    type Value = Phase;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Phase> {
        if let DeValue::String(text) = item.value.get_ref() {
            if text == DRAWN {
                return Some(Phase::Drawn);
            }
            if context.parameters.get(text).is_none()
                && let Some(help) = did_you_mean(text, &[DRAWN])
            {
                let message = format!("no phase {}", quoted(text));
                let error = context.error(code::BAD_EXPRESSION, item.span(), message);
                error.suggest(help);
                return None;
            }
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
