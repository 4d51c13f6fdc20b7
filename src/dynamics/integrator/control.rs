//! Error control: tolerance, scales, the norm of an error.

use super::error::Invalid;

/// Ratio of the tolerance for the error estimate of a step to the tolerance asked for: errors of
/// steps add up and grow, and the error after many steps is what a user compares. Over 10 s of
/// smooth motion that is not chaotic the error was measured up to 500 times the tolerance of a step
/// with the explicit method, and 4000 times with the stiff one.
pub const STEP_TOLERANCE_RATIO: f64 = 1e-3;

/// Smallest tolerance for the error estimate of a step: below, the estimate is rounding.
const LEAST_STEP_TOLERANCE: f64 = 1e-14;

/// Tolerance and scales of the components.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorControl {
    /// Tolerance for the error estimate of a step, relative.
    step_tolerance: f64,
    scales: Vec<f64>,
}

impl ErrorControl {
    /// Makes an error control for one component per scale. The error of component i after a run of
    /// some seconds is to be near `tolerance` · (`scales[i]` + |x\[i\]|); see
    /// [`STEP_TOLERANCE_RATIO`].
    ///
    /// A scale has its component's unit. An infinite scale leaves its component out of error
    /// control: a quadrature, on which the other components do not depend.
    ///
    /// # Errors
    ///
    /// [`Invalid::Tolerance`], [`Invalid::Scale`].
    pub fn new(tolerance: f64, scales: Vec<f64>) -> Result<Self, Invalid> {
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(Invalid::Tolerance(tolerance));
        }
        let unfit = scales
            .iter()
            .position(|&scale| scale.is_nan() || scale <= 0.0);
        if let Some(component) = unfit {
            return Err(Invalid::Scale {
                component,
                scale: scales[component],
            });
        }
        Ok(Self {
            step_tolerance: (STEP_TOLERANCE_RATIO * tolerance).max(LEAST_STEP_TOLERANCE),
            scales,
        })
    }

    /// Returns the number of components.
    #[must_use]
    pub fn order(&self) -> usize {
        self.scales.len()
    }

    /// Returns the error of a component that counts as 1: step tolerance · (scale + |x|).
    pub(super) fn weight(&self, component: usize, x: f64) -> f64 {
        self.step_tolerance * (self.scales[component] + x.abs())
    }

    /// Returns the largest component of `error`, each divided by its weight at the larger of two
    /// values. The largest, not the root mean square: components at rest, of which a mechanism has
    /// many, would hide the error of one that moves. NaN where a component is NaN.
    pub(super) fn norm(&self, x: [&[f64]; 2], error: impl Fn(usize) -> f64) -> f64 {
        let mut norm = 0.0;
        for (component, (a, b)) in x[0].iter().zip(x[1]).enumerate() {
            let larger = a.abs().max(b.abs());
            let ratio = (error(component) / self.weight(component, larger)).abs();
            if ratio > norm || ratio.is_nan() {
                norm = ratio;
            }
        }
        norm
    }
}
