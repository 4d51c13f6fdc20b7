//! The rows that the solver leaves out.

/// The rows that the solver leaves out.
#[derive(Clone, Debug, Default)]
pub(in crate::kinematics) struct SetAside {
    /// Those of redundant equations, of equals the ones declared last; ascending.
    pub(super) redundant: Vec<usize>,
    /// As many, those left out at the first pose; ascending.
    pub(super) first: Vec<usize>,
    /// As many, those left out at present; ascending.
    pub(super) now: Vec<usize>,
}

impl SetAside {
    pub(in crate::kinematics) fn is_empty(&self) -> bool {
        self.now.is_empty()
    }
}
