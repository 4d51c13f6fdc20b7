//! One input of the file or of a force.

use crate::fmi::codec::{Codec, Unreadable};
use crate::mechanism::Jet;

/// Value of an input, and its path during the next step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ForceInput {
    /// Value as set by the host.
    value: f64,
    /// First and second derivative for the next step.
    derivatives: [f64; 2],
    /// Value at the present point: `value`, or the end of its path in the last step.
    present: f64,
}

impl ForceInput {
    /// Makes an input with its value at the start.
    pub(super) fn new(start: f64) -> Self {
        Self {
            value: start,
            present: start,
            ..Self::default()
        }
    }

    /// Returns the value as set by the host.
    pub(super) fn get(&self) -> f64 {
        self.value
    }

    /// Returns the value with its derivatives for the next step.
    pub(super) fn path(&self) -> Jet {
        Jet::new(self.value, self.derivatives)
    }

    /// Returns the value at the present point.
    pub(super) fn present(&self) -> f64 {
        self.present
    }

    pub(super) fn set(&mut self, value: f64) {
        self.value = value;
        self.present = value;
    }

    /// Sets the derivative of order 1 or 2 for the next step.
    pub(super) fn set_derivative(&mut self, order: usize, value: f64) {
        self.derivatives[order - 1] = value;
    }

    /// Returns the value a time `tau` after the start of the next step.
    pub(super) fn after(&self, tau: f64) -> f64 {
        let [first, second] = self.derivatives;
        self.value + tau * (first + 0.5 * tau * second)
    }

    /// Goes on for a time `h` on the path, whose derivatives are then used up.
    pub(super) fn advance(&mut self, h: f64) {
        self.present = self.after(h);
        self.derivatives = [0.0; 2];
    }

    /// Visits all fields.
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            value,
            derivatives,
            present,
        } = self;
        codec.each(
            derivatives.iter_mut().chain([value, present]),
            Codec::finite,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::ForceInput;

    #[test]
    #[expect(clippy::float_cmp, reason = "numbers exact in binary")]
    fn derivatives_shape_one_step() {
        let mut input = ForceInput::default();
        input.set(3.0);
        input.set_derivative(1, 2.0);
        input.set_derivative(2, 4.0);
        assert_eq!((input.get(), input.present()), (3.0, 3.0));
        input.advance(0.5);
        assert_eq!((input.get(), input.present()), (3.0, 4.5));
        input.advance(0.5);
        assert_eq!(input.present(), 3.0);
    }
}
