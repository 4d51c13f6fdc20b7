//! The numbers of an animation: for each moment the places of the frames and the readings.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Rotation2, Vector2};
use serde_json::{Value, json};

use super::stage::Stage;
use super::{Animation, Moment};
use crate::drawing::anchor::Anchor;
use crate::drawing::attachment::Placement;
use crate::drawing::force_place::largest;
use crate::drawing::outline::{across, finite_extremes};
use crate::drawing::sheet::CAPITALS;
use biela::mechanism::rounded;

/// Part of the largest force that no arrow shows: it would be shorter than a line is wide.
const INVISIBLE: f64 = 1e-2;

/// Returns everything that the player needs.
///
/// `data` has one channel after the other; a channel is a whole number of two bytes, the low one
/// first, per moment; `scales` gives the values of 0 and of 65535. Each attachment has three
/// channels: x and y on the sheet and the angle in degrees. Each length has one. Each point with
/// arrows has four: velocity and acceleration as parts of the greatest of their kind, which
/// `most` gives \[m/s, m/s²\]. Each force has two and each torque one, parts of the greatest as
/// well, which `most` gives next \[N, N m\]. Each reading has one.
pub(super) fn film(animation: &Animation, stage: &mut Stage) -> Value {
    let moments = &animation.moments;
    let forces = Acting::new(animation, stage);
    let mut channels: Vec<Channel> = Vec::new();
    let placements: Vec<Vec<Placement>> = moments.iter().map(|m| stage.placements(&m.q)).collect();
    for attachment in 0..stage.attachments.len() {
        let of = |value: fn(&Placement) -> f64| {
            Channel::new(placements.iter().map(|p| value(&p[attachment])).collect())
        };
        channels.extend([of(|p| p.origin.x), of(|p| p.origin.y)]);
        channels.push(Channel {
            range: [-180.0, 180.0],
            ..of(|p| p.angle.to_degrees())
        });
    }
    for length in &stage.lengths {
        let values = moments.iter().map(|m| length.value(&m.q, stage.scale));
        channels.push(Channel::new(values.collect()));
    }
    let has_rates = moments
        .iter()
        .all(|m| m.rates.iter().all(|r| r.len() == m.q.len()));
    let points = if has_rates { &stage.points[..] } else { &[] };
    let (of_arrows, most) = arrows(points, moments);
    channels.extend(of_arrows);
    channels.extend(forces.channels(moments));
    for reading in 0..animation.readings.len() {
        let values = moments.iter().map(|moment| moment.readings[reading]);
        channels.push(Channel::new(values.collect()));
    }

    let most = [most, forces.most]
        .map(|most| most.map(significant))
        .concat();
    let home = placements.first().map_or(&[][..], Vec::as_slice);
    let clock = animation.clock;
    let scales: Vec<[f64; 2]> = channels.iter().map(|c| c.range.map(significant)).collect();
    let bytes: Vec<u8> = channels.iter().flat_map(Channel::bytes).collect();
    json!({
        "moments": moments.len(),
        "start": clock.start,
        "step": clock.step,
        "stop": clock.stop,
        "attachments": stage.attachments.len(),
        "capitals": CAPITALS,
        "labels": labels(stage, home),
        "lengths": stage.lengths.len(),
        "points": tracked(stage, points),
        "forces": forces.places[0],
        "torques": forces.places[1],
        "most": most,
        "readings": animation.readings.iter().map(|r| json!({
            "name": r.name,
            "unit": r.unit,
        })).collect::<Vec<_>>(),
        "scales": scales,
        "data": STANDARD.encode(bytes),
    })
}

/// Returns the labels in the frames of their attachments, which are at `home`.
pub(super) fn labels(stage: &Stage, home: &[Placement]) -> Vec<Value> {
    let labels = stage.labels.iter().map(|(attachment, label)| {
        let anchor = home[*attachment].inside(label.place.anchor);
        let side = label
            .place
            .side
            .map(|side| home[*attachment].turned_back(side));
        json!({
            "attachment": attachment,
            "at": pair(anchor),
            "side": side.map(|side| pair(100.0 * side)),
            "gap": short(label.place.gap),
        })
    });
    labels.collect()
}

/// Returns the points with arrows in the frames of their attachments.
pub(super) fn tracked(stage: &Stage, points: &[(usize, Anchor)]) -> Vec<Value> {
    let places = points.iter().map(|(attachment, anchor)| {
        let [x, y] = anchor.position;
        json!({
            "attachment": attachment,
            "at": [short(stage.scale * x), short(-stage.scale * y)],
        })
    });
    places.collect()
}

/// Returns velocity and acceleration of points on the sheet, each as a part of the greatest of its
/// kind, and these two \[m/s, m/s²\].
fn arrows(points: &[(usize, Anchor)], moments: &[Moment]) -> (Vec<Channel>, [f64; 2]) {
    let of_point = |(_, anchor): &(usize, Anchor)| -> Vec<[Vector2<f64>; 2]> {
        let rates = moments
            .iter()
            .map(|moment| rates(*anchor, &moment.q, [&moment.rates[0], &moment.rates[1]]));
        rates.collect()
    };
    let all: Vec<Vec<[Vector2<f64>; 2]>> = points.iter().map(of_point).collect();
    let most = [0, 1].map(|kind| {
        let norms = all.iter().flatten().map(|rates| rates[kind].norm());
        norms.filter(|norm| norm.is_finite()).fold(0.0, f64::max)
    });
    // Without motion there are no arrows.
    let factors = most.map(|most| if most > 0.0 { 1.0 / most } else { 0.0 });
    let channel = |rates: &[[Vector2<f64>; 2]], kind: usize, component: usize, sign: f64| {
        let values = rates
            .iter()
            .map(|r| sign * factors[kind] * r[kind][component]);
        Channel {
            range: [-1.0, 1.0],
            ..Channel::new(values.collect())
        }
    };
    let channels = all.iter().flat_map(|rates| {
        [(0, 0, 1.0), (0, 1, -1.0), (1, 0, 1.0), (1, 1, -1.0)]
            .map(|(kind, component, sign)| channel(rates, kind, component, sign))
    });
    (channels.collect(), most)
}

/// The forces and torques that an animation shows: those that are seen at some moment.
struct Acting {
    /// Their indices in the animation.
    indices: [Vec<usize>; 2],
    /// Their kinds, attachments and places there.
    places: [Vec<Value>; 2],
    /// The largest force \[N\] and the largest torque \[N m\], zero if there is none.
    most: [f64; 2],
}

impl Acting {
    fn new(animation: &Animation, stage: &mut Stage) -> Self {
        let moments = &animation.moments;
        let limits = largest(moments.iter().flat_map(|moment| &moment.forces));
        let mut acting = Self {
            indices: Default::default(),
            places: Default::default(),
            most: limits.map(or_zero),
        };
        for (index, force) in animation.forces.iter().enumerate() {
            let own = largest(moments.iter().map(|moment| &moment.forces[index])).map(or_zero);
            for kind in [0, 1] {
                if own[kind] > INVISIBLE * limits[kind] {
                    let [x, y] = force.at.position;
                    acting.indices[kind].push(index);
                    acting.places[kind].push(json!({
                        "kind": force.kind.word(),
                        "attachment": stage.attach(force.at),
                        "at": [short(stage.scale * x), short(-stage.scale * y)],
                    }));
                }
            }
        }
        acting
    }

    /// Returns two channels per force, x to the right and y down, and one per torque.
    fn channels(&self, moments: &[Moment]) -> Vec<Channel> {
        let [forces, torques] = &self.indices;
        let of = |index: usize, component: usize, factor: f64| {
            let values = moments.iter().map(|m| factor * m.forces[index][component]);
            Channel::new(values.collect())
        };
        let [force, torque] = self.most.map(f64::recip);
        let forces = forces
            .iter()
            .flat_map(|&index| [of(index, 0, force), of(index, 1, -force)]);
        forces
            .chain(torques.iter().map(|&index| of(index, 2, torque)))
            .collect()
    }
}

/// Returns a largest value, zero in place of the infinity that stands for none.
fn or_zero(largest: f64) -> f64 {
    if largest.is_finite() { largest } else { 0.0 }
}

/// Returns velocity and acceleration of a point of a rigid body.
pub(super) fn rates(anchor: Anchor, q: &[f64], rates: [&[f64]; 2]) -> [Vector2<f64>; 2] {
    let Some(body) = anchor.body else {
        return [Vector2::zeros(); 2];
    };
    let of_body = |values: &[f64]| [0, 1, 2].map(|k| values[3 * body.index() + k]);
    let [_, _, phi] = of_body(q);
    let [vx, vy, omega] = of_body(rates[0]);
    let [ax, ay, alpha] = of_body(rates[1]);
    let arm = Rotation2::new(phi) * Vector2::from(anchor.position);
    [
        Vector2::new(vx, vy) + omega * across(arm),
        Vector2::new(ax, ay) + alpha * across(arm) - omega * omega * arm,
    ]
}

/// One number per moment.
struct Channel {
    values: Vec<f64>,
    range: [f64; 2],
}

/// Values below this one are rounding noise, in all units of channels: units of the sheet, degrees,
/// parts of the greatest, SI units of readings.
const NOISE: f64 = 1e-11;

impl Channel {
    fn new(mut values: Vec<f64>) -> Self {
        for value in values.iter_mut().filter(|value| value.abs() < NOISE) {
            *value = 0.0;
        }
        let range = finite_extremes(&values);
        Self { values, range }
    }

    /// Returns the values as 16-bit numbers from one end of the range to the other.
    fn bytes(&self) -> impl Iterator<Item = u8> {
        let [low, high] = self.range.map(significant);
        let step = (high - low) / f64::from(u16::MAX);
        self.values.iter().flat_map(move |value| {
            let level = if step > 0.0 {
                (value - low) / step
            } else {
                0.0
            };
            // The middle of a symmetric range lies between two levels, where rounding noise, which
            // differs between machines, would choose.
            let level = (1024.0 * level).round() / 1024.0;
            // Casts saturate; what is not a number becomes zero.
            (level.round() as u16).to_le_bytes()
        })
    }
}

/// Rounds to seven digits: far more than 16 bits tell apart.
fn significant(value: f64) -> f64 {
    rounded(value, 7)
}

fn short(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

fn pair(point: Vector2<f64>) -> [f64; 2] {
    [short(point.x), short(point.y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    // Noise of a few units in the last place, as between machines with other libraries of functions.
    #[test]
    fn rounding_noise_leaves_the_bytes() {
        let bytes = |values: [f64; 5]| Channel::new(values.to_vec()).bytes().collect::<Vec<u8>>();
        for (exact, noisy) in [
            ([0.0; 5], [0.0, 3e-16, -2e-13, 0.0, 1e-14]),
            (
                [-1.0, 1.0, 0.0, 0.5, -0.5],
                [-1.0, 1.0, -1e-16, 0.5 + 2e-16, -0.5 - 1e-16],
            ),
            ([45.0; 5], [45.0, 45.0 + 1e-14, 45.0, 45.0 - 1e-14, 45.0]),
        ] {
            assert_eq!(bytes(exact), bytes(noisy));
        }
    }
}
