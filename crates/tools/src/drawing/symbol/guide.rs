//! Guides of bodies that slide lengthwise: a follower's stem, a rack.

use super::*;
use biela::mechanism::Wheels;

/// Ends of a guide as parts of the stretch that always lies between the contact and a stem's end.
const STEM_PARTS: [f64; 2] = [0.3, 0.75];
/// Least length of a stem in travels of its follower, and the length of a stem that has less.
const SHORTEST: f64 = 1.5;
const LONGER: f64 = 2.0;

/// Composes the guide of a body that reaches along its way on ground: a follower that slides on a
/// cam, or a rack. Returns false for any other body.
pub(super) fn compose(composer: &mut Composer, along: Anchor, to: Anchor) -> bool {
    let Some(body) = to.body.filter(|_| along.body.is_none()) else {
        return false;
    };
    let joints = composer.mechanism.joints.iter();
    let own = joints.filter(|joint| composer.anchor(joint.to).body == to.body);
    let guides: Vec<(SlideWay, Option<Point>)> = own
        .filter_map(|joint| {
            if let Some((follower, _)) = joint.cam() {
                return stem(composer, along, to, joint, follower);
            }
            let Some(Wheels::Rack { radius, side }) = joint.wheels() else {
                return None;
            };
            let pair = [joint.from, joint.to].map(|marker| composer.anchor(marker));
            let radius = composer.value(radius);
            Some((back(composer, along, to, pair, radius, side)?, None))
        })
        .collect();
    let is_guided = !guides.is_empty();
    for (guide, end) in guides {
        composer.spans[body.index()].extend(end.map(<[f64; 2]>::from));
        composer.add(guide);
    }
    is_guided
}

/// Returns the guide of a cam follower between the contact and the end of its stem, and that end
/// if the markers make no stem that is long enough. `None` if the follower is no straight stem
/// along its way.
fn stem(
    composer: &Composer,
    along: Anchor,
    to: Anchor,
    joint: &Joint,
    follower: &CamFollower,
) -> Option<(SlideWay, Option<Point>)> {
    let [cam, contact] = [joint.from, joint.to].map(|marker| composer.anchor(marker));
    let [s_contact, _] = to.coordinates(contact.position.into());
    let [s_cam, _] = composer.coordinates(to, cam);
    let outwards = if s_contact < s_cam { -1.0 } else { 1.0 };
    let [low, high] = composer.range(along, to);
    let near = 1e-6 * (s_contact - s_cam).abs().max(high - low);
    let on_face = |point: Point| {
        matches!(follower, CamFollower::Flat) && contact.coordinates(point)[1].abs() <= near
    };
    let mut length = 0.0_f64;
    for point in composer.positions(to.body) {
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
        CamFollower::Roller { radius } => composer.value(radius),
        CamFollower::Knife | CamFollower::Flat => 0.0,
    };
    let is_short = length <= SHORTEST * travel + clear;
    if is_short {
        length = (LONGER * travel).max((s_contact - s_cam).abs()) + clear;
    }
    let end = s_contact + outwards * length;
    // The markers' axes are parallel, in one sense or in the other.
    let sense = (to.placed(composer.q).angle - along.angle).cos().signum();
    let (nearest, farthest) = if sense * outwards > 0.0 {
        (low, high)
    } else {
        (high, low)
    };
    let start = s_contact + outwards * clear;
    let [from, until] = [farthest + sense * start, nearest + sense * end];
    let [a, b] = STEM_PARTS.map(|part| from + part * (until - from));
    let guide = SlideWay {
        along,
        range: [a.min(b), a.max(b)],
        side: WaySide::Both,
        contact: GuideContact::Bar,
    };
    Some((guide, is_short.then(|| to.on_axis(end))))
}

/// Returns the guide of a rack along its back, where the rack always is. `None` if the rack is
/// not along its way, or goes farther than it is long.
fn back(
    composer: &Composer,
    along: Anchor,
    to: Anchor,
    [pinion, rack]: [Anchor; 2],
    radius: f64,
    side: RackSide,
) -> Option<SlideWay> {
    let teeth = rack::range(composer, [pinion, rack], rack::END * radius);
    let ends = teeth.map(|s| rack.moved_to(rack.on_axis(s).into()));
    let near = 1e-6 * (teeth[1] - teeth[0]);
    let is_off = |end: &Anchor| to.coordinates(end.position.into())[1].abs() > near;
    if ends.iter().any(is_off) {
        return None;
    }
    let [a, b] = ends.map(|end| composer.range(along, end));
    let range = [a[1].min(b[1]), a[0].max(b[0])];
    if range[0] >= range[1] {
        return None;
    }
    let axis = direction(rack.placed(composer.q).angle);
    let teeth_up = across(direction(along.angle)).dot(&across(axis)) > 0.0;
    Some(SlideWay {
        along,
        range,
        side: if teeth_up == (side == RackSide::Above) {
            WaySide::Below
        } else {
            WaySide::Above
        },
        contact: GuideContact::Rack,
    })
}
