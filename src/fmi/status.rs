//! Status of a call.

/// Status of a call, in the order of `fmi2Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Success.
    Ok = 0,
    /// Success with advice on wrong use, once for each kind of [`Advice`](super::Advice) in a run.
    Warning = 1,
    /// Not possible from here; the host may continue another way.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// A defect of biela; the instance is unusable.
    Fatal = 4,
}
