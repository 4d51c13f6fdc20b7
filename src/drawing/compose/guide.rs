//! Guides of what slides lengthwise: a follower's stem, a rack.

use nalgebra::Vector2;

use super::Composer;
use crate::drawing::outline::{across, direction};
use crate::drawing::scene::{Anchor, Held, Symbol, WaySide};
use crate::mechanism::{CamFollower, Joint, JointKind, RackSide};

/// Where a guide begins and ends on what always is between roller or contact and a stem's end.
const STEM_PARTS: [f64; 2] = [0.3, 0.75];
/// A stem has at least this length, in travels of its follower; it gets `LONGER` if it has less.
const SHORTEST: f64 = 1.5;
const LONGER: f64 = 2.0;

/// A long body in its guide: a part of the way, and what is drawn there.
struct Guide {
    range: [f64; 2],
    side: WaySide,
    holds: Held,
}

impl Composer<'_> {
    /// Guides a body that reaches along its way on ground, rather than by a block: a follower
    /// that slides on a cam, or a rack. False if it is none.
    pub(super) fn guide(&mut self, along: Anchor, to: Anchor) -> bool {
        if along.body.is_some() || to.body.is_none() {
            return false;
        }
        let joints = self.mechanism.joints.iter();
        let own = joints.filter(|joint| self.anchor(joint.to).body == to.body);
        let guides: Vec<(Guide, Option<[f64; 2]>)> = own
            .filter_map(|joint| match &joint.kind {
                JointKind::Cam { follower, .. } => self.stem(along, to, joint, follower),
                JointKind::RackAndPinion { radius, side } => {
                    let pair = [joint.from, joint.to].map(|marker| self.anchor(marker));
                    Some((self.back(along, to, pair, self.value(radius), *side)?, None))
                }
                _ => None,
            })
            .collect();
        for (guide, end) in &guides {
            let body = to.body.map(|body| &mut self.spans[body.index()]);
            if let Some((spans, end)) = body.zip(*end) {
                spans.push(end);
            }
            self.add(Symbol::SlideWay {
                along,
                range: guide.range,
                side: guide.side,
                holds: guide.holds,
            });
        }
        !guides.is_empty()
    }

    /// The guide of a cam follower between the contact and the end of its stem, and that end if
    /// the markers make no stem that is long enough. None if the follower is no straight stem along its way.
    fn stem(
        &self,
        along: Anchor,
        to: Anchor,
        joint: &Joint,
        follower: &CamFollower,
    ) -> Option<(Guide, Option<[f64; 2]>)> {
        let [cam, contact] = [joint.from, joint.to].map(|marker| self.anchor(marker));
        let [s_contact, _] = to.coordinates(contact.position.into());
        let [s_cam, _] = self.from(to, cam);
        let outwards = if s_contact < s_cam { -1.0 } else { 1.0 };
        let [low, high] = self.range(along, to);
        let near = 1e-6 * (s_contact - s_cam).abs().max(high - low);
        let on_face = |point: Vector2<f64>| {
            matches!(follower, CamFollower::Flat) && contact.coordinates(point)[1].abs() <= near
        };
        let mut length = 0.0_f64;
        for point in self.positions(to.body) {
            let [s, aside] = to.coordinates(point.into());
            if on_face(point.into()) {
                continue;
            }
            if aside.abs() > near {
                return None;
            }
            length = length.max(outwards * (s - s_contact));
        }
        let travel = high - low;
        let clear = match follower {
            CamFollower::Roller { radius } => self.value(radius),
            CamFollower::Knife | CamFollower::Flat => 0.0,
        };
        let is_short = length <= SHORTEST * travel + clear;
        if is_short {
            length = (LONGER * travel).max((s_contact - s_cam).abs()) + clear;
        }
        let end = s_contact + outwards * length;
        // The markers' axes are parallel, in one sense or in the other.
        let sense = (to.placed(self.q).angle - along.angle).cos().signum();
        let (nearest, farthest) = if sense * outwards > 0.0 {
            (low, high)
        } else {
            (high, low)
        };
        let start = s_contact + outwards * clear;
        let [from, until] = [farthest + sense * start, nearest + sense * end];
        let [a, b] = STEM_PARTS.map(|part| from + part * (until - from));
        let guide = Guide {
            range: [a.min(b), a.max(b)],
            side: WaySide::Both,
            holds: Held::Bar,
        };
        let tip = || Vector2::from(to.position) + end * direction(to.angle);
        Some((guide, is_short.then(|| tip().into())))
    }

    /// The guide of a rack along its back, where the rack always is. None if the rack is not
    /// along its way, or goes farther than it is long.
    fn back(
        &self,
        along: Anchor,
        to: Anchor,
        [pinion, rack]: [Anchor; 2],
        radius: f64,
        side: RackSide,
    ) -> Option<Guide> {
        let teeth = self.rack_range([pinion, rack], radius);
        let ends = teeth.map(|s| Anchor {
            position: (Vector2::from(rack.position) + s * direction(rack.angle)).into(),
            ..rack
        });
        let near = 1e-6 * (teeth[1] - teeth[0]);
        let is_off = |end: &Anchor| to.coordinates(end.position.into())[1].abs() > near;
        if ends.iter().any(is_off) {
            return None;
        }
        let [a, b] = ends.map(|end| self.range(along, end));
        let range = [a[1].min(b[1]), a[0].max(b[0])];
        if range[0] >= range[1] {
            return None;
        }
        let axis = direction(rack.placed(self.q).angle);
        let teeth_up = across(direction(along.angle)).dot(&across(axis)) > 0.0;
        Some(Guide {
            range,
            side: if teeth_up == (side == RackSide::Above) {
                WaySide::Below
            } else {
                WaySide::Above
            },
            holds: Held::Rack,
        })
    }
}
