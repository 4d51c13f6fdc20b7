//! Redundancy: rows of Phi that follow from the others, and the rows that are solved.
//!
//! An ordinary mechanism has as many equations as unknowns, none of them redundant, and pays
//! nothing here. Where equations and unknowns cannot be paired, or the Jacobian is singular where
//! the mechanism closes, numbers decide: the mechanism is closed on *all* rows, and the rank of
//! the constraints' Jacobian is found there and a little further along the motion that they
//! leave, closed on all constraints again. A row that depends on others in all these places is
//! redundant; a row that depends on them at the first place only makes a singular position.
//!
//! Redundant rows are set aside: of rows that depend on each other the one declared last, and
//! never a driver's. They are watched: a step after which they do not hold is rejected. Which rows
//! of a dependent set are fit to be solved depends on the pose (a parallelogram laid flat needs
//! its third crank); where those in use become nearly dependent, others are taken.
//!
//! | file | subject |
//! |---|---|
//! | [`closing`] | minimises the residual of any rows |
//! | [`closure`] | closes a mechanism on any rows |
//! | [`closure`] | closes a mechanism on all its rows |
//! | [`rank`] | finds degrees of freedom and redundant rows |
//! | [`contradiction`] | explains rows that cannot be satisfied together |
//! | [`choice`] | chooses the rows that are solved |

mod choice;
mod closure;
mod contradiction;
mod rank;

pub use choice::Redundancy;
pub(super) use choice::{
    assemble_on_all, change_rows, choose_rows, is_nearly_singular, may_cross, opened, redundancies,
    return_to_fit_rows,
};
