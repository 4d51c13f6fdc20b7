//! Sentences to the user, on stderr.
//!
//! | file | subject |
//! |---|---|
//! | `message` | messages |
//! | `error` | errors of commands, and their exit status |
//! | `progress` | progress of a long run |
//! | `suggested_estimates` | a pose written as estimates of a file |

pub(super) mod error;
pub(super) mod message;
pub(super) mod progress;
pub(super) mod suggested_estimates;
