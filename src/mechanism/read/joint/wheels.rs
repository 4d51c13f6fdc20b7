//! Sizes of the two wheels of a gear or belt.

use crate::mechanism::WheelSizes;
use crate::mechanism::read::kind::Array;
use crate::mechanism::read::number::{LENGTH, Number, Quantity, RATIO};
use crate::mechanism::read::table::Field;

pub(super) const RADII: Array<Number, 2> = Array::new("[r1, r2]", [LENGTH.positive(); 2]);
pub(super) const TEETH: Array<Number, 2> = Array::new("[z1, z2]", [RATIO.positive(); 2]);
/// Help for wheels with both kinds of sizes or with neither.
pub(super) const HELP: &str = "their ratio decides: `radii = [0.02, 0.05]` or `teeth = [20, 50]`";

/// Returns the sizes under `radii` or under `teeth`.
pub(super) fn sizes(
    radii: Field<[Quantity; 2]>,
    teeth: Field<[Quantity; 2]>,
) -> Option<WheelSizes> {
    match radii.expressions() {
        Some(radii) => Some(WheelSizes::Radii(radii)),
        None => teeth.expressions().map(WheelSizes::Teeth),
    }
}
