//! Four-bars: their type by Grashof's rule, and the transmission angle, in plain words.

use super::drawn::Drawn;
use biela::mechanism::{BodyId, Joint, MarkerId, Mechanism};

/// Part of the sum of two lengths within which it is the sum of the other two.
const SAME: f64 = 1e-9;

/// Says what type of four-bar is drawn, and how well it transmits force there; nothing of a drawing that is
/// open, or that has not exactly one four-bar on ground.
pub(super) fn describe(drawn: &Drawn) -> Option<String> {
    let mechanism = drawn
        .mechanism
        .as_deref()
        .filter(|_| drawn.open.is_none())?;
    let (pins, bodies) = only_loop(mechanism)?;
    let at = pins.map(|pin| {
        let [x, y, _] = drawn.place(mechanism.joints[pin].from);
        [x, y]
    });
    let far = |a: [f64; 2], b: [f64; 2]| f64::hypot(b[0] - a[0], b[1] - a[1]);
    let [input, coupler, output, base] = [0, 1, 2, 3].map(|k| far(at[k], at[(k + 1) % 4]));
    let lengths = [input, coupler, output, base];
    let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let rest = lengths.iter().sum::<f64>() - shortest - longest;
    if shortest <= drawn.same() {
        return None;
    }
    let name = |link: usize| &mechanism.bodies[bodies[link]].name;
    let excess = shortest + longest - rest;
    let is_shortest = |length: f64| length.to_bits() == shortest.to_bits();
    let kind = if excess.abs() <= SAME * rest {
        "change-point four-bar: it can become flat".to_owned()
    } else if excess > 0.0 {
        "triple-rocker: no link turns fully".to_owned()
    } else if is_shortest(base) {
        "double-crank: both links on ground turn fully".to_owned()
    } else if is_shortest(coupler) {
        format!("double-rocker: `{}` turns fully", name(1))
    } else {
        let crank = if is_shortest(input) { 0 } else { 2 };
        format!("crank-rocker: `{}` turns fully", name(crank))
    };
    let [ahead, back] = [at[1], at[3]].map(|end| [end[0] - at[2][0], end[1] - at[2][1]]);
    let cross = ahead[0] * back[1] - ahead[1] * back[0];
    let dot = ahead[0] * back[0] + ahead[1] * back[1];
    let angle = f64::atan2(cross.abs(), dot.abs()).to_degrees();
    Some(format!("{kind}; transmission angle {angle:.0}° here"))
}

/// Returns the pins of the only four-bar on ground, from the input's pin on ground to that of the output,
/// and its moving bodies in this order: input, coupler, output. The link that a driver turns is the input,
/// otherwise the first one of the file.
fn only_loop(mechanism: &Mechanism) -> Option<([usize; 4], [usize; 3])> {
    let body = |id: MarkerId| mechanism.markers[id.index()].body;
    let ends = |joint: &Joint| [body(joint.from), body(joint.to)];
    let pins: Vec<(usize, [Option<BodyId>; 2])> = (mechanism.joints.iter().enumerate())
        .filter(|(_, joint)| joint.is_pin())
        .map(|(index, joint)| (index, ends(joint)))
        .collect();
    // The pins of a body, each with the body at its other end.
    let beyond = |from: Option<BodyId>, last: Option<usize>| {
        let pins = pins.iter().filter(move |(pin, _)| Some(*pin) != last);
        pins.filter_map(move |&(pin, [a, b])| match (a == from, b == from) {
            (true, false) => Some((pin, b)),
            (false, true) => Some((pin, a)),
            _ => None,
        })
    };
    let mut found = Vec::new();
    for (first, input) in beyond(None, None) {
        for (second, coupler) in beyond(input, Some(first)).filter(|(_, body)| body.is_some()) {
            for (third, output) in beyond(coupler, Some(second)) {
                let Some([a, b, c]) = input.zip(coupler).zip(output).map(|((a, b), c)| [a, b, c])
                else {
                    continue;
                };
                let last = beyond(output, Some(third)).filter(|(_, body)| body.is_none());
                for (fourth, _) in last.filter(|_| a != c) {
                    let links = [a, b, c].map(BodyId::index);
                    found.push(([first, second, third, fourth], links));
                }
            }
        }
    }
    // Each one is found from both of its ends.
    let [one, other] = found[..] else {
        return None;
    };
    let is_driven = |pin: usize| {
        let coordinate = mechanism.joints[pin].free_coordinate();
        let mut drivers = mechanism.drivers.iter();
        drivers.any(|driver| Some(driver.coordinate) == coordinate)
    };
    let is_first = match [one, other].map(|(pins, _)| is_driven(pins[0])) {
        [true, false] => true,
        [false, true] => false,
        _ => one.1[0] < other.1[0],
    };
    Some(if is_first { one } else { other })
}
