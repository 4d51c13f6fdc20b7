//! Redundancy: rows of Phi that follow from the others, and the rows that are solved.
//!
//! An ordinary mechanism has as many equations as unknowns, none of them redundant, and does not
//! use this module. If equations and unknowns cannot be paired, or if the Jacobian is singular at
//! the first pose, numbers decide: the mechanism is closed on *all* rows, and the rank of the
//! constraints' Jacobian is found at this pose and at poses a little further along the free
//! motion. A row that depends on others at all these poses is redundant. A row that depends on
//! others at the first pose only belongs to a singular position.
//!
//! The plan sets redundant rows aside: the one declared last of several dependent rows, and never a
//! driver's. The tracker rejects a step after which these rows do not hold. The best choice of rows
//! depends on the pose (a flat parallelogram needs its third crank): if the rows in use become
//! nearly dependent, others are chosen.
//!
//! | file | subject |
//! |---|---|
//! | [`closure`] | closes a mechanism on all its rows |
//! | [`rank`] | finds degrees of freedom and redundant rows |
//! | [`slip`] | explains redundant rows that are open by little |
//! | [`contradiction`] | explains rows that cannot be satisfied together |
//! | [`choice`] | chooses the rows that are solved |
//! | [`ratio`] | equations of which one coordinate moves too far |
//! | [`undriven`] | coordinates that would hold a mechanism whose drivers are too few |
//! | [`watch`] | bounds rows set aside between the ends of a sub-step |

mod choice;
mod closure;
mod contradiction;
mod rank;
mod ratio;
mod slip;
mod undriven;
mod watch;

pub use choice::Redundancy;
pub(super) use choice::{
    are_rows_fit, assemble_on_all, change_rows, choose_rows, is_nearly_singular, opened,
    redundancies,
};
pub(super) use rank::{drivers_first, jacobian_rows};
pub(super) use ratio::explain_ratio;
pub use undriven::{Undriven, undriven};
pub(super) use watch::watch_between;
