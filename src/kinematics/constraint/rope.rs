//! The length of a rope over points and pulleys.

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::Vector2;

use super::configuration::{CoefficientId, Configuration, perp};
use super::definition::{Constraint, Dimension, Formula, Incidence};
use super::gradient::Gradient;
use super::moving_configuration::{Moving, VariedMechanism, dot, quarter_turn, subtract};
use super::region::{Region, centripetal_bound, chord, speed_bound};
use crate::kinematics::tolerances::NEGLIGIBLE_LENGTH;
use crate::mechanism::{MarkerId, Mechanism, Number};

/// Middle of the turn within which a wrapped angle is counted: from −45° to 315°, so that an arc
/// that vanishes goes on continuously.
const MIDDLE: f64 = 3.0 * FRAC_PI_4;

/// Distance of the angle of an arc from a jump of its count at which a motion has ended there
/// \[rad\]: it ends after sub-steps that come as near as rounding lets them. Halved or doubled, the
/// message names the arc all the same.
const AT_JUMP: f64 = 1e-6;

/// c = Σ p_k t_k + Σ p_k r_k β_k with the number p_k of parts, the length t_k of the straight leg
/// from point k to the next one, and the arc of angle β_k on a pulley of radius r_k.
///
/// A leg leaves pulley k and meets pulley k + 1 along their common tangent. With σ = 1 for a pulley
/// on the left of the rope, −1 for one on the right and r = 0 for a point, the vector d from centre
/// to centre is d = t e + ρ n with the leg's direction e, n = perp(e) and
/// ρ = σ_{k+1} r_{k+1} − σ_k r_k. To first order a turn of a tangent changes no length: the gradient
/// is that of straight legs with these e.
#[derive(Clone, Debug)]
pub struct RopeLength {
    stations: Box<[Station]>,
    /// Number of parts of each leg.
    parts: Box<[CoefficientId]>,
}

/// A point over which a rope runs.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// The point, or the centre of the pulley.
    pub marker: MarkerId,
    /// Radius of the pulley, and 1 if it is on the left of the rope, −1 on the right.
    pub pulley: Option<(CoefficientId, f64)>,
}

/// A straight leg at one pose.
struct Leg {
    /// Distance of the centres.
    distance: f64,
    /// Offset of the tangent's ends, ρ.
    offset: f64,
    /// Length between the points of contact, zero where pulleys overlap.
    length: f64,
    /// Direction.
    e: Vector2<f64>,
}

impl RopeLength {
    /// Makes the relation of a rope over stations, with the number of parts of each leg.
    pub fn new(stations: Vec<Station>, parts: Vec<CoefficientId>) -> Self {
        Self {
            stations: stations.into(),
            parts: parts.into(),
        }
    }

    /// Returns σ r of a station's pulley, zero without one.
    fn reach(station: Station, at: &Configuration) -> f64 {
        let signed = |(radius, side)| side * at.coefficient(radius);
        station.pulley.map_or(0.0, signed)
    }

    /// Returns the legs with their stations and their numbers of parts.
    fn legs(&self) -> impl Iterator<Item = ([Station; 2], CoefficientId)> + '_ {
        let pairs = self.stations.windows(2).map(|pair| [pair[0], pair[1]]);
        pairs.zip(self.parts.iter().copied())
    }

    fn leg(&self, [from, to]: [Station; 2], at: &Configuration) -> Leg {
        let d = at.marker(to.marker).point - at.marker(from.marker).point;
        let distance = d.norm();
        let offset = Self::reach(to, at) - Self::reach(from, at);
        let length = tangent(distance, offset);
        let e = if distance == 0.0 {
            // As for a distance: an assembly can move coincident points apart.
            Vector2::x()
        } else if length > 0.0 {
            (length * d - offset * perp(d)) / (distance * distance)
        } else {
            -offset.signum() * perp(d) / distance
        };
        Leg {
            distance,
            offset,
            length,
            e,
        }
    }

    /// Returns the markers from the first to the last.
    pub fn markers(&self) -> impl Iterator<Item = MarkerId> + '_ {
        self.stations.iter().map(|station| station.marker)
    }

    /// Returns the pulleys with their places among the stations.
    fn pulleys(&self) -> impl Iterator<Item = (usize, (CoefficientId, f64))> + '_ {
        let stations = self.stations.iter().enumerate();
        stations.filter_map(|(k, station)| Some((k, station.pulley?)))
    }

    /// Returns the centre of each pulley with the angle of the rope's arc on it \[rad\]. Below zero
    /// the rope has left the pulley: it would have to push it.
    pub fn arcs<'a>(&'a self, at: &'a Configuration) -> impl Iterator<Item = (MarkerId, f64)> + 'a {
        self.pulleys().map(|(k, (_, side))| {
            let e = |k: usize| self.leg([self.stations[k], self.stations[k + 1]], at).e;
            let angle = arc(e(k - 1).into(), e(k).into(), side);
            (self.stations[k].marker, angle)
        })
    }

    /// Returns the legs without a tangent, by their markers: between points at one place, or pulleys of
    /// which one is inside the other.
    pub fn without_tangent<'a>(
        &'a self,
        at: &'a Configuration,
    ) -> impl Iterator<Item = [MarkerId; 2]> + 'a {
        self.legs().filter_map(|(stations, _)| {
            let Leg {
                distance, offset, ..
            } = self.leg(stations, at);
            let is_none = distance <= offset.abs() + NEGLIGIBLE_LENGTH;
            is_none.then(|| stations.map(|station| station.marker))
        })
    }

    /// Returns the pulley on which the angle of the arc \[rad\] is where its count jumps, with the angle.
    pub fn at_jump(&self, at: &Configuration) -> Option<(MarkerId, f64)> {
        let mut arcs = self.arcs(at);
        arcs.find(|(_, angle)| PI - (angle - MIDDLE).abs() <= AT_JUMP)
    }

    /// Returns whether no motion changes a leg.
    fn is_fixed(mechanism: &Mechanism, [from, to]: [Station; 2]) -> bool {
        let body = |station: Station| mechanism.markers[station.marker.index()].body;
        let is_turned = body(from).is_some() && (from.pulley.is_some() || to.pulley.is_some());
        body(from) == body(to) && !is_turned
    }
}

/// Returns the length of a tangent of two circles whose centres have this distance and whose ends
/// lie this far across from each other; zero where there is none.
fn tangent(distance: f64, offset: f64) -> f64 {
    if offset == 0.0 {
        distance
    } else {
        ((distance - offset) * (distance + offset)).max(0.0).sqrt()
    }
}

/// Returns the angle from one direction to another \[rad\], positive to the left for `side` 1, to
/// the right for −1.
fn arc<N: Number>(arrives: [N; 2], leaves: [N; 2], side: f64) -> N {
    let along = dot(arrives, leaves);
    let across = dot(quarter_turn(arrives), leaves) * side;
    let (sin, cos) = MIDDLE.sin_cos();
    let from_middle = (across * cos - along * sin).atan2(along * cos + across * sin);
    from_middle + N::constant(MIDDLE)
}

impl Formula for RopeLength {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let zero = N::constant(0.0);
        let reach = |station: Station| {
            let signed = |(radius, side)| at.coefficient(radius) * side;
            station.pulley.map_or(zero, signed)
        };
        let mut sum = zero;
        let mut before = [zero; 2];
        for ([from, to], part) in self.legs() {
            let part = at.coefficient(part);
            let d = subtract(at.point(to.marker), at.point(from.marker));
            let distance = d[0].hypot(d[1]);
            if from.pulley.is_none() && to.pulley.is_none() {
                sum += part * distance;
                continue;
            }
            let offset = reach(to) - reach(from);
            let length = ((distance - offset) * (distance + offset)).sqrt();
            let across = quarter_turn(d);
            let square = distance.square();
            let e = [0, 1].map(|k| (length * d[k] - offset * across[k]) / square);
            sum += part * length;
            if let Some((radius, side)) = from.pulley {
                sum += part * at.coefficient(radius) * arc(before, e, side);
            }
            before = e;
        }
        sum
    }
}

impl Constraint for RopeLength {
    fn dimension(&self) -> Dimension {
        Dimension::Length
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let mut sum = 0.0;
        let mut before = Vector2::zeros();
        for ([from, to], part) in self.legs() {
            let part = at.coefficient(part);
            let Leg { length, e, .. } = self.leg([from, to], at);
            row.add_point(at.marker(to.marker), part * e);
            row.add_point(at.marker(from.marker), -part * e);
            sum += part * length;
            if let Some((radius, side)) = from.pulley {
                sum += part * at.coefficient(radius) * arc(before.into(), e.into(), side);
            }
            before = e;
        }
        sum
    }

    fn value(&self, at: &Configuration) -> f64 {
        self.value_and_gradient(at, &mut Gradient::new())
    }

    fn admits(&self, value: f64) -> bool {
        value > 0.0
    }

    /// Bounds the turn of each leg by that of d, asin(reach / |d|), and by the change of its angle
    /// with d, asin(ρ / |d|), which is largest where d is shortest.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let mut bend = 0.0;
        let mut before = (Vector2::zeros(), 0.0);
        for ([from, to], part) in self.legs() {
            let part = at.coefficient(part).abs();
            let [i, j] = [from, to].map(|station| at.marker(station.marker));
            let Leg {
                distance,
                offset,
                e,
                ..
            } = self.leg([from, to], at);
            let reach = region.reach(i, j);
            let (shortest, offset) = (distance - reach, offset.abs());
            if shortest <= offset {
                return None;
            }
            let inclined = (offset / shortest).asin() - (offset / distance).asin();
            let turn = (reach / distance).asin() + inclined;
            if let Some((_, side)) = from.pulley {
                // The length jumps where the count of the arc does.
                let angle = arc(before.0.into(), e.into(), side);
                if (angle - MIDDLE).abs() + before.1 + turn >= PI {
                    return None;
                }
            }
            let direction = chord(turn);
            for marker in [i, j] {
                let swing = marker.arm.norm() * (direction + region.sway(marker));
                row.add_point_bound(marker, part * direction, part * swing);
            }
            let speed = speed_bound(i, j, v);
            let length = tangent(shortest, offset);
            bend += part * (speed * speed / length + centripetal_bound(i, j, v));
            before = (e, turn);
        }
        Some(bend)
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        for (legs, _) in self.legs() {
            if !Self::is_fixed(mechanism, legs) {
                let [from, to] = legs.map(|station| station.marker);
                incidence.point(mechanism, from, [true, true]);
                incidence.point(mechanism, to, [true, true]);
            }
        }
    }
}
