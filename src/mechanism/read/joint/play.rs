//! Play of joints: `backlash` between flanks, `unilateral` contacts.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::Fields;
use crate::mechanism::read::number::Quantity;
use crate::mechanism::read::table::Field;
use crate::mechanism::wording::shown;
use crate::mechanism::{Expression, Play};

/// Play under two keys of a joint, `None` without it.
type MaybePlay = Option<Box<Play>>;

impl<'a> Context<'a> {
    /// Returns the play between flanks.
    pub(super) fn backlash(
        &mut self,
        backlash: Field<Quantity>,
        restitution: Field<Quantity>,
        owner: &Fields<'a>,
    ) -> Option<MaybePlay> {
        let is_given = backlash.key.is_some();
        let restitution = self.restitution_of(restitution, is_given, "backlash", owner)?;
        let Some(backlash) = backlash.optional()? else {
            return Some(None);
        };
        Some(Some(Box::new(Play {
            backlash: Some(backlash.expression),
            restitution,
        })))
    }

    /// Returns the play of a contact that only pushes, or of a rope.
    pub(super) fn unilateral(
        &mut self,
        unilateral: Field<bool>,
        restitution: Field<Quantity>,
        owner: &Fields<'a>,
    ) -> Option<MaybePlay> {
        let opens = unilateral.or(false)?;
        let restitution = self.restitution_of(restitution, opens, "unilateral = true", owner)?;
        Some(opens.then(|| {
            Box::new(Play {
                backlash: None,
                restitution,
            })
        }))
    }

    /// Returns the coefficient of restitution, which needs another key.
    fn restitution_of(
        &mut self,
        restitution: Field<Quantity>,
        is_possible: bool,
        key: &str,
        owner: &Fields<'a>,
    ) -> Option<Option<Expression>> {
        if let (Some(span), false) = (&restitution.key, is_possible) {
            let message = format!("{} has `restitution`, but no `{key}`", owner.subject);
            self.error(code::UNKNOWN_KEY, span.clone(), message)
                .suggest("only parts that can part meet again");
            return None;
        }
        self.check_restitution(&restitution);
        Some(restitution.optional()?.map(|quantity| quantity.expression))
    }

    /// Reports a coefficient of restitution that is none.
    pub(in crate::mechanism::read) fn check_restitution(&mut self, restitution: &Field<Quantity>) {
        if let Some(value) = restitution.number()
            && !(0.0..=1.0).contains(&value)
        {
            let message = format!("`restitution` must be from 0 to 1, is {}", shown(value));
            self.error(code::ILLEGAL_VALUE, restitution.span.clone(), message);
        }
    }
}
