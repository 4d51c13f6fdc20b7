//! Results of a run: the quantities by name, and their values at a pose.
//!
//! | file | subject |
//! |---|---|
//! | `output` | the outputs by name |
//! | `signals` | values of signals, and of measures computed from them |
//! | `solution` | rates and forces at a pose |

mod output;
mod signals;
mod solution;

pub use output::{ForceNeed, Output, OutputSource, omitted_reactions};
pub use solution::Solution;
