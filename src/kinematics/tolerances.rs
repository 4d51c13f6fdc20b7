//! Tolerances that several files share. A tolerance of one file stands in that file.
//!
//! Each says what it is derived from, and what changes if it is halved or doubled. All compare
//! scaled numbers, in radians and characteristic lengths, unless a unit says otherwise.

/// Largest residual that counts as zero, in multiples of the estimate of its rounding error.
///
/// The estimate counts each number of a row once; the sums of a row round a few times more.
/// Halved, some poses need one more correction, which [`STALLED`] ends. Doubled, poses are accepted
/// one correction earlier and keep an error of eight roundings.
pub(in crate::kinematics) const AT_ROUNDING: f64 = 4.0;

/// Largest residual that counts as zero after it has stopped falling, in multiples of the estimate
/// of its rounding error.
///
/// The estimate leaves out the products inside a row, which matter in nearly singular poses.
/// Halved, some of these poses are rejected as not converged. Doubled, Newton–Raphson that circles
/// round a pose may count as converged, 4e-14 away from it.
pub(in crate::kinematics) const STALLED: f64 = 100.0;

/// Reciprocal condition below which a pose is singular.
///
/// A singular position is found to the square root of the rounding, 1.5e-8, and its reciprocal
/// condition is of that size. Halved, an assembly that ends in a dead point may be taken for
/// regular, and its rates are noise. Doubled, regular poses up to 2e-7 rad from a dead point are
/// refused too.
pub(in crate::kinematics) const SINGULAR: f64 = 1e-7;

/// Largest remainder of a row after elimination that depends on the rows before it.
///
/// Lies between two sizes: at a singular position, which is located to the square root of the
/// rounding, remainders are about 1e-8; 0.03 away from it, where ranks are compared, about 1e-2.
/// Halved or doubled, it is still far from both.
pub(in crate::kinematics) const DEPENDENT: f64 = 1e-6;

/// Least coefficient in a combination of rows that is not rounding, as a part of the largest.
///
/// Rounding of a coefficient is at most some 1e-16 over the least remainder, 1e-10 for
/// [`DEPENDENT`]. Halved or doubled, messages change only where the leverages of joints differ by
/// a million.
pub(in crate::kinematics) const LEAST_COEFFICIENT: f64 = 1e-6;

/// Least gap that is certainly more than rounding, as a part of the lengths that it is a difference
/// of.
///
/// A proof relies on bodies found before only if their reciprocal condition is at least 1e-5: they
/// are then known to some 1e-11 of the lengths. Halved, the factor to that error is 5. Doubled,
/// gaps up to 2e-10 of the lengths are reported without a proof.
pub(in crate::kinematics) const CERTAIN_GAP: f64 = 1e-10;

/// Largest length that counts as rounding \[m\]; between places farther than 1 m from their
/// origin, largest length as a part of that distance.
///
/// A few hundred roundings of coordinates of about a metre. Halved, two points that shall coincide
/// may get a direction, which is noise. Doubled, mechanisms of less than 2e-13 m have no size.
pub(in crate::kinematics) const NEGLIGIBLE_LENGTH: f64 = 1e-13;

/// Largest distance of two places on a path, from 0 to 1, that count as one.
///
/// Places of singular positions are located to 1e-9 of a path at worst: corrections end at 1e-9
/// where rounding stops them. Halved, one singular position may be reported as two, or as one
/// behind the pose. Doubled, two that are 2e-9 of a path apart count as one.
pub(in crate::kinematics) const SAME_PLACE_ON_PATH: f64 = 1e-9;

/// Minimum sub-step, as a part of the path. The path is blocked where such a sub-step is rejected.
///
/// Some thousand roundings of a place on the path. Halved, a path of the same steps is blocked
/// after one more halving, at half the distance from a dead point. Doubled, at twice the distance.
pub(in crate::kinematics) const SMALLEST_SUBSTEP: f64 = 1e-12;

/// Largest part of a row's value that uncertain unknowns add if their directions are left out.
///
/// Directions cost time and gain the cosine of an angle. Halved, more sub-steps take the time.
/// Doubled, bounds are up to 1 % wider and a sub-step at the limit is shortened.
pub(in crate::kinematics) const WITHOUT_DIRECTION: f64 = 0.01;
