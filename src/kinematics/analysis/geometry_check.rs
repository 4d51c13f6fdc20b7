//! Checks the geometry of joints: the distances of wheels, the hollows of cams, the arcs of ropes.
//!
//! The equations of these joints hold all the same; a warning tells that the drawing does not fit
//! them.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::Vector2;

use super::off_pulley::arcs;
use crate::kinematics::constraint::Contour;
use crate::kinematics::constraint::configuration::{Configuration, ProfileId, perp};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::mechanism::{
    CamFollower, Expression, Interval, Jet3, MarkerId, ProfileInForce, RackSide, WheelSizes,
    Wheels, fixed_apart,
};

/// A joint that does not fit its own numbers at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometryWarning {
    /// Name of the joint.
    pub joint: String,
    /// The numbers that do not fit.
    pub kind: GeometryWarningKind,
}

/// The numbers of a joint that do not fit each other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GeometryWarningKind {
    /// The distance of the centres of two gears does not fit their radii.
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
        /// The least distance at which they do not overlap \[m\].
        least: f64,
    },
    /// The distance of a pinion's centre from the rack does not fit its radius.
    RackDistance {
        /// The centre's coordinate on the rack marker's y-axis \[m\].
        distance: f64,
        /// The radius, negative for a pinion below \[m\].
        expected: f64,
    },
    /// The contour has a hollow that is too narrow for the roller: undercutting. The contact
    /// jumps from one of its sides to the other.
    NarrowHollow {
        /// First and last polar angle of each hollow \[rad\].
        ranges: Vec<[f64; 2]>,
        /// Least radius of curvature in the hollows \[m\].
        curvature: f64,
        /// Radius of the roller \[m\].
        roller: f64,
    },
    /// A flat face cannot reach into a hollow of the contour: the contact jumps across it.
    HollowUnderFace {
        /// First and last polar angle of each part that is not convex \[rad\].
        ranges: Vec<[f64; 2]>,
    },
    /// A rope has no direction between two points, or no tangent between two pulleys.
    NoTangent {
        /// The markers, with their bodies.
        markers: [String; 2],
    },
    /// A rope does not touch its pulley.
    OffPulley {
        /// Marker at the pulley's centre, with its body.
        pulley: String,
        /// Angle of the rope's arc on it, below zero \[rad\].
        angle: f64,
    },
}

impl fmt::Display for GeometryWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint `{}`: ", self.joint)?;
        match &self.kind {
            GeometryWarningKind::GearCentres { distance, expected } => {
                let [distance, expected] = apart(*distance, *expected);
                write!(
                    f,
                    "the centres are {distance} m apart; the radii ask for {expected} m"
                )
            }
            GeometryWarningKind::BeltCentres { distance, least } => {
                let [distance, least] = apart(*distance, *least);
                write!(
                    f,
                    "the centres are {distance} m apart; wheels of these radii need more than \
                     {least} m"
                )
            }
            GeometryWarningKind::RackDistance { distance, expected } => {
                let [distance, expected] = apart(*distance, *expected);
                write!(
                    f,
                    "the pinion's centre is at y = {distance} m of the rack; its radius and side \
                     ask for {expected} m"
                )
            }
            GeometryWarningKind::NarrowHollow {
                ranges,
                curvature,
                roller,
            } => {
                let [roller, curvature] = apart(*roller, *curvature);
                write!(
                    f,
                    "a roller of radius {roller} m does not fit into hollows of the contour whose \
                     radius of curvature goes down to {curvature} m: {}",
                    degrees(ranges)
                )
            }
            GeometryWarningKind::HollowUnderFace { ranges } => write!(
                f,
                "a flat face cannot follow the contour where it is hollow: {}",
                degrees(ranges)
            ),
            GeometryWarningKind::NoTangent {
                markers: [from, to],
            } => write!(
                f,
                "the rope has no direction from `{from}` to `{to}`: they are at one place, or the \
                 pulley of one is inside that of the other; leave one of them out"
            ),
            GeometryWarningKind::OffPulley { pulley, angle } => write!(
                f,
                "the rope does not touch its pulley at `{pulley}`: the arc on it is {:.1} deg; is \
                 its side right?",
                angle.to_degrees()
            ),
        }
    }
}

/// Returns two lengths with as many decimals as tell them apart.
fn apart(a: f64, b: f64) -> [String; 2] {
    fixed_apart(a, b, 6)
}

/// Describes the first of some ranges of polar angles.
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

/// Number of parts of a contour at first.
const PARTS: u32 = 64;
/// Least width of a part \[rad\], 0.02°.
const SMALLEST_PART: f64 = TAU / 16_384.0;
/// Relative error of a distance that fits, and angle of an arc that is rounding \[rad\].
const TOLERANCE: f64 = 1e-6;

/// Returns the joints that do not fit their own numbers at the pose, in the order of declaration, curves
/// and ropes last.
pub(in crate::kinematics) fn geometry_warnings(
    compiled: &CompiledMechanism,
    state: &State,
) -> Vec<GeometryWarning> {
    let check = Check {
        at: &state.at,
        parameters: &state.pose.parameters,
    };
    let mut profiles = (0..).map(ProfileId);
    let joints = compiled.system.mechanism().joints.iter();
    let mut warnings: Vec<_> = joints
        .filter_map(|joint| {
            let centres = [joint.from, joint.to];
            let of_cam = joint.cam().and_then(|(follower, _)| {
                let profile = profiles.next().map(|id| state.at.profile(id));
                check.cam(profile?, follower)
            });
            let of_wheels = |wheels| check.wheels(centres, wheels);
            let kind = of_cam.or_else(|| joint.wheels().and_then(of_wheels));
            let joint = joint.name.clone();
            kind.map(|kind| GeometryWarning { joint, kind })
        })
        .collect();
    let mechanism = compiled.system.mechanism();
    let legs = compiled.system.ropes().flat_map(|(joint, rope)| {
        let legs = rope.without_tangent(&state.at);
        legs.map(move |markers| (joint, markers))
    });
    warnings.extend(legs.map(|(joint, markers)| GeometryWarning {
        joint: mechanism.joints[joint].name.clone(),
        kind: GeometryWarningKind::NoTangent {
            markers: markers.map(|marker| mechanism.marker_path(marker)),
        },
    }));
    let off = arcs(&compiled.system, state).filter(|(.., angle)| *angle < -TOLERANCE);
    warnings.extend(off.map(|(joint, marker, angle)| GeometryWarning {
        joint: mechanism.joints[joint].name.clone(),
        kind: GeometryWarningKind::OffPulley {
            pulley: mechanism.marker_path(marker),
            angle,
        },
    }));
    warnings
}

/// A check of joints at a pose.
struct Check<'a> {
    at: &'a Configuration,
    parameters: &'a [f64],
}

impl Check<'_> {
    fn numbers(&self, expressions: &[Expression; 2]) -> [f64; 2] {
        expressions.each_ref().map(|e| e.value(self.parameters))
    }

    fn distance(&self, [from, to]: [MarkerId; 2]) -> f64 {
        (self.at.marker(to).point - self.at.marker(from).point).norm()
    }

    fn wheels(&self, centres: [MarkerId; 2], wheels: Wheels) -> Option<GeometryWarningKind> {
        let radii = |sizes: &WheelSizes| match sizes {
            WheelSizes::Radii(radii) => Some(self.numbers(radii)),
            WheelSizes::Teeth(_) => None,
        };
        match wheels {
            Wheels::Mesh {
                sizes, internal, ..
            } => self.gear(centres, radii(sizes)?, internal),
            Wheels::Belt { sizes, crossed, .. } => self.belt(centres, radii(sizes)?, crossed),
            Wheels::Rack { radius, side } => {
                self.rack(centres, radius.value(self.parameters), side)
            }
            Wheels::Track => None,
        }
    }

    fn gear(
        &self,
        centres: [MarkerId; 2],
        [first, second]: [f64; 2],
        internal: bool,
    ) -> Option<GeometryWarningKind> {
        let distance = self.distance(centres);
        let expected = if internal {
            (first - second).abs()
        } else {
            first + second
        };
        ((distance - expected).abs() > TOLERANCE * first.max(second))
            .then_some(GeometryWarningKind::GearCentres { distance, expected })
    }

    fn belt(
        &self,
        centres: [MarkerId; 2],
        [first, second]: [f64; 2],
        crossed: bool,
    ) -> Option<GeometryWarningKind> {
        let distance = self.distance(centres);
        let least = if crossed {
            first + second
        } else {
            (first - second).abs()
        };
        (distance <= least).then_some(GeometryWarningKind::BeltCentres { distance, least })
    }

    fn rack(
        &self,
        [pinion, rack]: [MarkerId; 2],
        radius: f64,
        side: RackSide,
    ) -> Option<GeometryWarningKind> {
        let (pinion, rack) = (self.at.marker(pinion), self.at.marker(rack));
        let distance = perp(rack.axis).dot(&(pinion.point - rack.point));
        let expected = match side {
            RackSide::Above => radius,
            RackSide::Below => -radius,
        };
        ((distance - expected).abs() > TOLERANCE * radius)
            .then_some(GeometryWarningKind::RackDistance { distance, expected })
    }

    fn cam(&self, profile: &ProfileInForce, follower: &CamFollower) -> Option<GeometryWarningKind> {
        match follower {
            // A knife edge touches a point at every polar angle, whatever the curvature.
            CamFollower::Knife => None,
            // A roller that touches the contour in two places leaves a pocket between them, and
            // every pocket has a hollow narrower than the roller: looking for those is enough.
            CamFollower::Roller { radius } => {
                let roller = radius.value(self.parameters);
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
                (!ranges.is_empty()).then(|| GeometryWarningKind::NarrowHollow {
                    ranges,
                    curvature: -narrowest.recip(),
                    roller,
                })
            }
            CamFollower::Flat => {
                let ranges = ranges_below_zero(profile, |radius| bending(radius).1);
                (!ranges.is_empty()).then_some(GeometryWarningKind::HollowUnderFace { ranges })
            }
        }
    }
}

/// Returns R² + R′², and R² + 2R′² − R R″, which has the sign of the curvature.
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

/// Returns the curvature of a contour, positive where it is convex \[1/m\].
fn curvature(profile: &ProfileInForce, theta: f64) -> f64 {
    let shape = Contour::shape(profile, theta, Vector2::x());
    shape.turn[0] / shape.speed[0]
}

/// Returns the ranges of polar angles, ascending, in which a function of the contour is certainly
/// negative, to within a part of a degree.
fn ranges_below_zero(
    profile: &ProfileInForce,
    function: impl Fn(Jet3<Interval>) -> Interval,
) -> Vec<[f64; 2]> {
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    // Ranges still to be divided, the last one first.
    let mut open: Vec<[f64; 2]> = (0..PARTS)
        .rev()
        .map(|part| [part, part + 1].map(|k| f64::from(k) * (TAU / f64::from(PARTS))))
        .collect();
    while let Some([from, to]) = open.pop() {
        let middle = from.midpoint(to);
        let bounds = profile.bounds(middle, 0.5 * (to - from));
        let sign = bounds.map(|bounds| function(bounds.radius));
        match sign {
            Some(sign) if sign.low > 0.0 => {}
            Some(sign) if sign.high < 0.0 => match ranges.last_mut() {
                Some(last) if from - last[1] <= SMALLEST_PART => last[1] = to,
                _ => ranges.push([from, to]),
            },
            _ if to - from > SMALLEST_PART => open.extend([[middle, to], [from, middle]]),
            // At the edge of a range, or where the curvature jumps.
            _ => {}
        }
    }
    // A range across the seam is one.
    if let [first, .., last] = &mut ranges[..]
        && first[0] + TAU - last[1] <= SMALLEST_PART
    {
        last[1] = first[1] + TAU;
        ranges.remove(0);
    }
    ranges
}
