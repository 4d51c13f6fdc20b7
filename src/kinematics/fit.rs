//! Whether wheels are where their sizes ask for, and whether a follower can follow its cam.
//!
//! The equations of these pairs hold all the same; a misfit tells that the drawing does not
//! belong to them.

use std::fmt;

use nalgebra::Vector2;

use super::configuration::{ProfileId, perp};
use super::constraint::Contour;
use super::solver::Solver;
use crate::mechanism::{CamFollower, JointKind, MarkerId, ProfileInForce, RackSide, WheelSizes};

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
        /// Polar angles from which to which \[rad\].
        range: [f64; 2],
        /// Radius of curvature of the hollow where it is narrowest \[m\].
        curvature: f64,
        /// Radius of the roller \[m\].
        roller: f64,
    },
    /// A flat face cannot reach into a hollow of the contour: the contact jumps across it.
    HollowUnderFace {
        /// Polar angles from which to which the contour is not convex \[rad\].
        range: [f64; 2],
    },
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint `{}`: ", self.joint)?;
        let degrees = |range: &[f64; 2]| {
            let [from, to] = range.map(f64::to_degrees);
            format!("between theta = {from:.1} and {to:.1} deg")
        };
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
                range,
                curvature,
                roller,
            } => write!(
                f,
                "a roller of radius {roller:.6} m does not fit into the contour's hollow {}, \
                 whose radius of curvature goes down to {curvature:.6} m",
                degrees(range)
            ),
            MisfitKind::HollowUnderFace { range } => write!(
                f,
                "the contour is hollow {}: a flat face cannot follow it there",
                degrees(range)
            ),
        }
    }
}

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
                let too_narrow = |curvature: f64| 1.0 + curvature * roller <= 0.0;
                let (range, curvature) = worst_range(&curvatures(profile), too_narrow)?;
                Some(MisfitKind::NarrowHollow {
                    range,
                    curvature: -curvature.recip(),
                    roller,
                })
            }
            CamFollower::Flat => {
                let hollow = |curvature: f64| curvature <= 0.0;
                let (range, _) = worst_range(&curvatures(profile), hollow)?;
                Some(MisfitKind::HollowUnderFace { range })
            }
        }
    }
}

/// The curvature of a contour at the sample angles, positive where it is convex \[1/m\].
fn curvatures(profile: &ProfileInForce) -> Vec<f64> {
    ProfileInForce::sample_angles()
        .map(|theta| {
            let shape = Contour::shape(profile, theta, Vector2::x());
            shape.turn[0] / shape.speed[0]
        })
        .collect()
}

/// The polar angles round the smallest value for which all values are bad, and that value; `None`
/// if it is not bad.
fn worst_range(values: &[f64], bad: impl Fn(f64) -> bool) -> Option<([f64; 2], f64)> {
    let count = values.len();
    let worst = (0..count).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
    if !bad(values[worst]) {
        return None;
    }
    let reach = |step: usize| {
        let places = (1..count).map(|k| (worst + k * step) % count);
        places.take_while(|&place| bad(values[place])).count()
    };
    let (forwards, backwards) = (reach(1), reach(count - 1));
    let angle = std::f64::consts::TAU / count as f64;
    let from = worst as f64 - backwards as f64;
    let to = (worst + forwards) as f64;
    Some(([from * angle, to * angle], values[worst]))
}
