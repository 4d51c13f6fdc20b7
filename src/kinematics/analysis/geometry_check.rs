//! Whether wheels are where their sizes ask for, and whether a follower can follow its cam.
//!
//! The equations of these pairs hold all the same; a misfit tells that the drawing does not
//! belong to them.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::Vector2;

use crate::kinematics::configuration::{ProfileId, perp};
use crate::kinematics::constraint::Contour;
use crate::kinematics::solver::Solver;
use crate::mechanism::{
    CamFollower, Interval, Jet3, JointKind, MarkerId, ProfileInForce, RackSide, WheelSizes,
};

/// A joint that does not fit its own numbers, in the pose at which the solver stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    /// Name of the joint.
    pub joint: String,
    /// What does not fit.
    pub kind: MisfitKind,
}

/// What does not fit in a joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MisfitKind {
    /// The centres of two gears are not as far apart as their radii ask for.
    GearCentres {
        /// Distance of the centres \[m\].
        distance: f64,
        /// Sum of the radii, or difference of an internal gear's \[m\].
        expected: f64,
    },
    /// The wheels of a belt overlap.
    BeltCentres {
        /// Distance of the centres \[m\].
        distance: f64,
        /// What it has to exceed \[m\].
        least: f64,
    },
    /// A pinion's centre is not a radius away from the rack.
    RackDistance {
        /// The centre's coordinate on the rack marker's y-axis \[m\].
        distance: f64,
        /// The radius, negative for a pinion below \[m\].
        expected: f64,
    },
    /// The contour has a hollow that is too narrow for the roller: undercutting. The contact
    /// jumps from one of its sides to the other.
    NarrowHollow {
        /// Polar angles from which to which, one a hollow \[rad\].
        ranges: Vec<[f64; 2]>,
        /// Radius of curvature where they are narrowest \[m\].
        curvature: f64,
        /// Radius of the roller \[m\].
        roller: f64,
    },
    /// A flat face cannot reach into a hollow of the contour: the contact jumps across it.
    HollowUnderFace {
        /// Polar angles from which to which the contour is not convex \[rad\].
        ranges: Vec<[f64; 2]>,
    },
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint `{}`: ", self.joint)?;
        match &self.kind {
            MisfitKind::GearCentres { distance, expected } => write!(
                f,
                "the centres are {distance:.6} m apart; the radii ask for {expected:.6} m"
            ),
            MisfitKind::BeltCentres { distance, least } => write!(
                f,
                "the centres are {distance:.6} m apart; wheels of these radii need more than \
                 {least:.6} m"
            ),
            MisfitKind::RackDistance { distance, expected } => write!(
                f,
                "the pinion's centre is at y = {distance:.6} m of the rack; its radius and side \
                 ask for {expected:.6} m"
            ),
            MisfitKind::NarrowHollow {
                ranges,
                curvature,
                roller,
            } => write!(
                f,
                "a roller of radius {roller:.6} m does not fit into hollows of the contour whose \
                 radius of curvature goes down to {curvature:.6} m: {}",
                degrees(ranges)
            ),
            MisfitKind::HollowUnderFace { ranges } => write!(
                f,
                "a flat face cannot follow the contour where it is hollow: {}",
                degrees(ranges)
            ),
        }
    }
}

/// Ranges of polar angles, the first of them.
fn degrees(ranges: &[[f64; 2]]) -> String {
    const SHOWN: usize = 4;
    let shown = ranges.iter().take(SHOWN).map(|range| {
        let [from, to] = range.map(f64::to_degrees);
        format!("from theta = {from:.1} to {to:.1} deg")
    });
    let mut text = shown.collect::<Vec<_>>().join(", ");
    if let Some(more @ 1..) = ranges.len().checked_sub(SHOWN) {
        text += &format!(", and in {more} more places");
    }
    text
}

/// Into so many parts a contour is divided to begin with.
const PARTS: u32 = 64;
/// Parts are divided down to this width \[rad\], 0.02°.
const SMALLEST_PART: f64 = TAU / 16_384.0;
/// A distance that is wrong by no more than this part of it fits.
const TOLERANCE: f64 = 1e-6;

impl Solver {
    /// What does not fit in the pose at which the mechanism stands, in the order of the joints.
    #[must_use]
    pub fn misfits(&self) -> Vec<Misfit> {
        let mut misfits = Vec::new();
        let mut profiles = (0..).map(ProfileId);
        for joint in &self.mechanism().joints {
            let centres = [joint.from, joint.to];
            let kind = match &joint.kind {
                JointKind::Gear {
                    sizes: WheelSizes::Radii(radii),
                    internal,
                    ..
                } => self.misfit_of_gear(
                    centres,
                    radii.each_ref().map(|r| self.number(r)),
                    *internal,
                ),
                JointKind::Belt {
                    sizes: WheelSizes::Radii(radii),
                    crossed,
                    ..
                } => {
                    self.misfit_of_belt(centres, radii.each_ref().map(|r| self.number(r)), *crossed)
                }
                JointKind::RackAndPinion { radius, side } => {
                    self.misfit_of_rack(centres, self.number(radius), *side)
                }
                JointKind::Cam { follower, .. } => {
                    let profile = profiles.next().map(|id| self.at.profile(id));
                    profile.and_then(|profile| self.misfit_of_cam(profile, follower))
                }
                _ => None,
            };
            misfits.extend(kind.map(|kind| Misfit {
                joint: joint.name.clone(),
                kind,
            }));
        }
        misfits
    }

    fn number(&self, expression: &crate::mechanism::Expression) -> f64 {
        expression.evaluate(&|p| self.pose.parameters[p.index()], 0.0)
    }

    fn distance(&self, [from, to]: [MarkerId; 2]) -> f64 {
        (self.at.marker(to).point - self.at.marker(from).point).norm()
    }

    fn misfit_of_gear(
        &self,
        centres: [MarkerId; 2],
        [first, second]: [f64; 2],
        internal: bool,
    ) -> Option<MisfitKind> {
        let distance = self.distance(centres);
        let expected = if internal {
            (first - second).abs()
        } else {
            first + second
        };
        ((distance - expected).abs() > TOLERANCE * first.max(second))
            .then_some(MisfitKind::GearCentres { distance, expected })
    }

    fn misfit_of_belt(
        &self,
        centres: [MarkerId; 2],
        [first, second]: [f64; 2],
        crossed: bool,
    ) -> Option<MisfitKind> {
        let distance = self.distance(centres);
        let least = if crossed {
            first + second
        } else {
            (first - second).abs()
        };
        (distance <= least).then_some(MisfitKind::BeltCentres { distance, least })
    }

    fn misfit_of_rack(
        &self,
        [pinion, rack]: [MarkerId; 2],
        radius: f64,
        side: RackSide,
    ) -> Option<MisfitKind> {
        let (pinion, rack) = (self.at.marker(pinion), self.at.marker(rack));
        let distance = perp(rack.axis).dot(&(pinion.point - rack.point));
        let expected = match side {
            RackSide::Above => radius,
            RackSide::Below => -radius,
        };
        ((distance - expected).abs() > TOLERANCE * radius)
            .then_some(MisfitKind::RackDistance { distance, expected })
    }

    fn misfit_of_cam(
        &self,
        profile: &ProfileInForce,
        follower: &CamFollower,
    ) -> Option<MisfitKind> {
        match follower {
            // A point of the contour at every polar angle, whatever its curvature.
            CamFollower::Knife => None,
            // A roller that touches the contour in two places leaves a pocket between them, and
            // every pocket has a hollow narrower than the roller: looking for those is enough.
            CamFollower::Roller { radius } => {
                let roller = self.number(radius);
                // 1 + κ r, times the cube of the speed √(R² + R′²).
                let room = |radius: Jet3<Interval>| {
                    let (square, bend) = bending(radius);
                    let cube = |square: f64| square.max(0.0).powf(1.5);
                    let at = |square: f64, bend: f64| cube(square) + roller * bend;
                    Interval::new(at(square.low, bend.low), at(square.high, bend.high))
                };
                let ranges = ranges_below_zero(profile, room);
                let middles = ranges.iter().map(|[from, to]| from.midpoint(*to));
                let narrowest = middles
                    .chain(ProfileInForce::sample_angles())
                    .map(|theta| curvature(profile, theta))
                    .fold(f64::INFINITY, f64::min);
                (!ranges.is_empty()).then(|| MisfitKind::NarrowHollow {
                    ranges,
                    curvature: -narrowest.recip(),
                    roller,
                })
            }
            CamFollower::Flat => {
                let ranges = ranges_below_zero(profile, |radius| bending(radius).1);
                (!ranges.is_empty()).then_some(MisfitKind::HollowUnderFace { ranges })
            }
        }
    }
}

/// R² + R′², and R² + 2R′² − R R″, which has the sign of the curvature.
fn bending(radius: Jet3<Interval>) -> (Interval, Interval) {
    let square = |x: Interval| {
        let (low, high) = (x.low.abs().min(x.high.abs()), x.magnitude());
        let crosses = x.low < 0.0 && x.high > 0.0;
        Interval::new(if crosses { 0.0 } else { low * low }, high * high)
    };
    let (r, slope) = (square(radius.value), square(radius.first()));
    let sum = r + slope;
    (sum, sum + slope - radius.value * radius.second())
}

/// The curvature of a contour, positive where it is convex \[1/m\].
fn curvature(profile: &ProfileInForce, theta: f64) -> f64 {
    let shape = Contour::shape(profile, theta, Vector2::x());
    shape.turn[0] / shape.speed[0]
}

/// The polar angles, from which to which in rising order, where a function of the contour is
/// certainly negative, to within a part of a degree.
fn ranges_below_zero(
    profile: &ProfileInForce,
    function: impl Fn(Jet3<Interval>) -> Interval,
) -> Vec<[f64; 2]> {
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    // Ranges still to be looked at, the last one first.
    let mut open: Vec<[f64; 2]> = (0..PARTS)
        .rev()
        .map(|part| [part, part + 1].map(|k| f64::from(k) * (TAU / f64::from(PARTS))))
        .collect();
    while let Some([from, to]) = open.pop() {
        let middle = from.midpoint(to);
        let sign = profile.bounds(middle, 0.5 * (to - from)).map(&function);
        match sign {
            Some(sign) if sign.low > 0.0 => {}
            Some(sign) if sign.high < 0.0 => match ranges.last_mut() {
                Some(last) if from - last[1] <= SMALLEST_PART => last[1] = to,
                _ => ranges.push([from, to]),
            },
            _ if to - from > SMALLEST_PART => open.extend([[middle, to], [from, middle]]),
            // On the edge, or at a place where the curvature jumps.
            _ => {}
        }
    }
    // What goes on over the seam is one range.
    if let [first, .., last] = &mut ranges[..]
        && first[0] + TAU - last[1] <= SMALLEST_PART
    {
        last[1] = first[1] + TAU;
        ranges.remove(0);
    }
    ranges
}
