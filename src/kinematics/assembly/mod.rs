//! Assembly: finds a pose that satisfies given rows, from the estimates in the file (Eq. 3.6.9).
//!
//! The blocks are assembled one after the other, each on the branch that is nearest the
//! estimates. A block that does not close sends the search back to another branch of the blocks
//! that it reads. If closed forms and interval bounds exclude all branches, the mechanism is
//! proved impossible; otherwise no pose was found, and one may still exist.
//!
//! | file | subject |
//! |---|---|
//! | [`estimate`] | the estimates, and the distance of a pose from them |
//! | [`turns`] | whole turns of angles |
//! | [`least_squares`] | damped least squares on rows of Phi |
//! | [`part`] | assembles a part of the mechanism from several starts |
//! | [`closure`] | closes a mechanism as a whole on any rows |
//! | [`gaps`] | the joints that stay open |
//! | [`fit`] | the length or the phase that would close one |
//! | [`loops`] | finds all branches of a block by bounds over intervals |
//! | [`branches`] | lists the branches of one block |
//! | [`search`] | finds branches of all blocks that fit together |
//! | [`nearest`] | finds the nearest pose of a mechanism that does not close |

pub(super) mod branches;
pub(super) mod closure;
pub(super) mod estimate;
pub(super) mod fit;
pub(super) mod gaps;
pub(super) mod least_squares;
mod loops;
pub(super) mod nearest;
pub(super) mod part;
pub(super) mod search;
pub(super) mod turns;
