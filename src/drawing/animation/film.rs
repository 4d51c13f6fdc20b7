//! The numbers of an animation: for each moment where the frames are and what is told beside.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Rotation2, Vector2};
use serde_json::{Value, json};

use super::stage::{LengthDriver, Placement, Stage};
use super::{Animation, Moment};
use crate::drawing::outline::across;
use crate::drawing::rider::along;
use crate::drawing::scene::Anchor;
use crate::drawing::sheet::CAPITALS;

/// Everything that the player needs.
///
/// `data` has one channel after the other, each a whole number of two bytes, the low one first,
/// for every moment; `scales` says between which two values they run. For each rider there are
/// three: x and y on the sheet and the angle in degrees. For each length driver there are two:
/// the length, and where its first point is beside the line. For each point with arrows four:
/// velocity and acceleration, as parts of the greatest there is, which `most` tells \[m/s, m/s²\].
/// For each reading one.
pub(super) fn film(animation: &Animation, stage: &Stage) -> Value {
    let moments = &animation.moments;
    let mut channels: Vec<Channel> = Vec::new();
    let placements: Vec<Vec<Placement>> = moments.iter().map(|m| stage.placements(&m.q)).collect();
    for rider in 0..stage.riders.len() {
        let of = |value: fn(&Placement) -> f64| {
            Channel::new(placements.iter().map(|p| value(&p[rider])).collect())
        };
        channels.extend([of(|p| p.origin.x), of(|p| p.origin.y)]);
        channels.push(Channel {
            range: [-180.0, 180.0],
            ..of(|p| p.angle.to_degrees())
        });
    }
    for driver in &stage.lengths {
        let values: Vec<[f64; 2]> = moments.iter().map(|m| length(driver, &m.q)).collect();
        for part in 0..2 {
            let of_part = values.iter().map(|value| stage.scale * value[part]);
            channels.push(Channel::new(of_part.collect()));
        }
    }
    let has_rates = moments
        .iter()
        .all(|m| m.rates.iter().all(|r| r.len() == m.q.len()));
    let points = if has_rates { &stage.points[..] } else { &[] };
    let (of_arrows, most) = arrows(points, moments);
    channels.extend(of_arrows);
    for reading in 0..animation.readings.len() {
        let values = moments.iter().map(|moment| moment.readings[reading]);
        channels.push(Channel::new(values.collect()));
    }

    let home = placements.first().map_or(&[][..], Vec::as_slice);
    let labels = stage.labels.iter().map(|(rider, label)| {
        let anchor = home[*rider].inside(label.place.anchor);
        let side = label.place.side.map(|side| home[*rider].turned_back(side));
        json!({
            "rider": rider,
            "at": pair(anchor),
            "side": side.map(|side| pair(100.0 * side)),
            "gap": short(label.place.gap),
            "size": [short(label.text.width()), CAPITALS],
        })
    });
    let clock = animation.clock;
    let scales: Vec<[f64; 2]> = channels.iter().map(|c| c.range.map(significant)).collect();
    let bytes: Vec<u8> = channels.iter().flat_map(Channel::bytes).collect();
    json!({
        "moments": moments.len(),
        "start": clock.start,
        "step": clock.step,
        "stop": clock.stop,
        "riders": stage.riders.len(),
        "labels": labels.collect::<Vec<_>>(),
        "lengths": stage.lengths.iter().map(|l| json!({
            "rider": l.rider,
            "offset": short(l.offset),
        })).collect::<Vec<_>>(),
        "points": points.iter().map(|(rider, anchor)| json!({
            "rider": rider,
            "at": [short(stage.scale * anchor.position[0]), short(-stage.scale * anchor.position[1])],
        })).collect::<Vec<_>>(),
        "most": most.map(significant),
        "readings": animation.readings.iter().map(|r| json!({
            "name": r.name,
            "unit": r.unit,
        })).collect::<Vec<_>>(),
        "scales": scales,
        "data": STANDARD.encode(bytes),
    })
}

/// The length that a driver drives, and how far its first point is beside the line \[m\], to the
/// right as seen along it: down on the sheet.
fn length(driver: &LengthDriver, q: &[f64]) -> [f64; 2] {
    let [from, to] = driver.markers.map(|marker| marker.placed(q).point);
    let along = along(driver.axis, to - from, q);
    let length = (to - from).dot(&along);
    let foot = to - length * along;
    [length, -(from - foot).dot(&across(along))]
}

/// Velocity and acceleration of points on the sheet, each as a part of the greatest there is, and
/// those two \[m/s, m/s²\].
fn arrows(points: &[(usize, Anchor)], moments: &[Moment]) -> (Vec<Channel>, [f64; 2]) {
    let mut all: [Vec<Vec<Vector2<f64>>>; 2] = Default::default();
    let mut most = [0.0_f64; 2];
    for (_, anchor) in points {
        let rates = moments.iter().map(|moment| rates(*anchor, moment));
        let (velocity, acceleration): (Vec<_>, Vec<_>) = rates.map(|[v, a]| (v, a)).unzip();
        for ((all, most), values) in all.iter_mut().zip(&mut most).zip([velocity, acceleration]) {
            let norms = values
                .iter()
                .map(|v| v.norm())
                .filter(|norm| norm.is_finite());
            *most = norms.fold(*most, f64::max);
            all.push(values);
        }
    }
    let mut channels = Vec::new();
    for point in 0..points.len() {
        for (all, most) in all.iter().zip(most) {
            // Where nothing moves there is nothing to see.
            let factor = if most > 0.0 { 1.0 / most } else { 0.0 };
            for (component, sign) in [(0, 1.0), (1, -1.0)] {
                let values = all[point].iter().map(|v| sign * factor * v[component]);
                channels.push(Channel {
                    range: [-1.0, 1.0],
                    ..Channel::new(values.collect())
                });
            }
        }
    }
    (channels, most)
}

/// Velocity and acceleration of a point of a rigid body.
fn rates(anchor: Anchor, moment: &Moment) -> [Vector2<f64>; 2] {
    let Some(body) = anchor.body else {
        return [Vector2::zeros(); 2];
    };
    let of_body = |values: &[f64]| [0, 1, 2].map(|k| values[3 * body.index() + k]);
    let [_, _, phi] = of_body(&moment.q);
    let [vx, vy, omega] = of_body(&moment.rates[0]);
    let [ax, ay, alpha] = of_body(&moment.rates[1]);
    let arm = Rotation2::new(phi) * Vector2::from(anchor.position);
    [
        Vector2::new(vx, vy) + omega * across(arm),
        Vector2::new(ax, ay) + alpha * across(arm) - omega * omega * arm,
    ]
}

/// One number for each moment.
struct Channel {
    values: Vec<f64>,
    range: [f64; 2],
}

impl Channel {
    fn new(values: Vec<f64>) -> Self {
        let finite = values.iter().filter(|value| value.is_finite());
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let range = finite.fold(none, |[low, high], v| [low.min(*v), high.max(*v)]);
        let range = if range[0] <= range[1] {
            range
        } else {
            [0.0; 2]
        };
        Self { values, range }
    }

    /// The values as 16-bit numbers from the range's one end to its other.
    fn bytes(&self) -> impl Iterator<Item = u8> {
        let [low, high] = self.range.map(significant);
        let step = (high - low) / f64::from(u16::MAX);
        self.values.iter().flat_map(move |value| {
            let level = if step > 0.0 {
                (value - low) / step
            } else {
                0.0
            };
            // Casts saturate; what is not a number becomes zero.
            (level.round() as u16).to_le_bytes()
        })
    }
}

/// Seven digits: far more than 16 bits tell apart.
fn significant(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

fn short(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

fn pair(point: Vector2<f64>) -> [f64; 2] {
    [short(point.x), short(point.y)]
}
