//! A strike of contacts, as far as its changes along directions need it.

/// Velocities that contacts have changed at one instant.
#[derive(Debug)]
pub(super) struct Strike {
    /// Velocities of the freedoms before and after.
    pub(super) velocities: [Vec<f64>; 2],
    pub(super) pushes: Vec<Push>,
}

/// A contact that pushes in a strike.
#[derive(Debug)]
pub(super) struct Push {
    /// Index of the passive force.
    pub(super) force: usize,
    /// Impulse along the coordinate \[N s or N m s\].
    pub(super) impulse: f64,
    /// Rate of the coordinate before \[m/s or rad/s\].
    pub(super) rate: f64,
    /// The part of the rate with which it bounces, `None` where it does not close, or comes to rest.
    pub(super) restitution: Option<f64>,
}
