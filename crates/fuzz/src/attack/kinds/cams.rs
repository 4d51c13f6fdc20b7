//! Cams with followers of all kinds.

use std::f64::consts::PI;
use std::fmt::Write as _;

use crate::attack::Case;
use crate::attack::text::{Point, Text, angle, direction, dyad, end, frame, point, sign};
use crate::mutation::Chance;

/// A contour of some waves and a lobe, which may be narrow.
struct Contour {
    base: f64,
    lift: f64,
    waves: f64,
    lobe: f64,
    width: f64,
    place: f64,
}

impl Contour {
    /// Draws a contour; a convex one for a flat face.
    fn draw(chance: &mut Chance, convex: bool) -> Self {
        let base = chance.between(0.1, 0.2);
        let waves = chance.between(1.0, 4.0).floor();
        let (lift, lobe) = (chance.between(0.0, 0.05), chance.between(-0.02, 0.05));
        let (width, place) = (chance.between(0.02, 0.5), angle(chance));
        let lift = if convex {
            0.9 * lift / (waves * waves + 1.0)
        } else {
            lift
        };
        Self {
            base,
            lift,
            waves,
            lobe: if convex { 0.0 } else { lobe },
            width,
            place,
        }
    }

    fn radius(&self, theta: f64) -> f64 {
        let bump = ((theta - self.place).cos() - 1.0) / (self.width * self.width);
        self.base + self.lift * (self.waves * theta).cos() + self.lobe * bump.exp()
    }

    /// Returns the profile as it is written in the file: an expression, or a table of a few points
    /// of it.
    fn profile(&self, chance: &mut Chance, text: &mut Text<'_>) -> String {
        let [base, lift, lobe] = [self.base, self.lift, self.lobe]
            .map(|length| text.length(chance, length))
            .map(|length| length.trim_matches('\'').to_owned());
        if self.lobe == 0.0 && chance.between(0.0, 1.0) < 0.3 {
            let mut points = String::new();
            for k in 0..24 {
                let theta = f64::from(k) * PI / 12.0;
                let wave = (self.waves * theta).cos();
                let _ = write!(points, "[{theta:?}, '{base} + ({lift})*({wave:?})'], ");
            }
            return format!("{{ table = [{}] }}", points.trim_end_matches(", "));
        }
        let place = text.turning(chance, self.place);
        let place = place.trim_matches('\'');
        let (waves, square) = (self.waves, self.width * self.width);
        format!(
            "'{base} + ({lift})*cos({waves}*theta) \
             + ({lobe})*exp((cos(theta - ({place})) - 1)/{square:?})'"
        )
    }
}

const KINDS: [&str; 3] = ["knife", "roller", "flat"];
const ROLLER: f64 = 0.01;

/// Adds a cam that turns about the origin and touches the marker `a` of the body `follower`.
/// Returns its angle.
fn add_cam(chance: &mut Chance, text: &mut Text<'_>, contour: &Contour, kind: &str) {
    text.ground("O", [0.0, 0.0], 0.0);
    text.pin("O", ["ground.O", "cam.a"]);
    let follower = match kind {
        "roller" => format!("'roller', radius = {}", text.number(ROLLER)),
        kind => format!("'{kind}'"),
    };
    let profile = contour.profile(chance, text);
    let more = format!(", follower = {follower}, profile = {profile}");
    text.joint("contact", "cam", ["cam.a", "follower.a"], &more);
}

/// A follower that slides, beside the cam's axis or not; driven at the cam.
pub fn cam_slide(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let kind = KINDS[chance.below(3)];
    let contour = Contour::draw(chance, kind == "flat");
    let (cam, aside) = (angle(chance), chance.between(-0.06, 0.06).max(0.0));
    text.body("cam", "a = [0, 0]", [0.0, 0.0, cam]);
    let height = contour.radius(0.5 * PI - cam) + if kind == "roller" { ROLLER } else { 0.0 };
    text.ground("G", [aside, 0.0], 0.5 * PI);
    // The x-axis of a flat face lies across the guide, more or less.
    let face = if kind == "flat" {
        chance.between(-0.3, 0.3)
    } else {
        0.0
    };
    let place = [aside, height];
    let marks = [frame("g", place, 0.5 * PI), frame("a", place, face)];
    text.plate(chance, "follower", [aside, height, 0.0], &marks);
    text.slide("G", ["ground.G", "follower.g"]);
    add_cam(chance, &mut text, &contour, kind);
    let to = cam + chance.between(-4.0, 4.0);
    text.turn("u", ["ground.O", "cam.a"], cam, to);
    text.case()
}

/// Adds a follower on an arm, its marker `b` at the pin of a rod. Returns that pin and the arm's
/// angle.
fn add_arm(
    chance: &mut Chance,
    text: &mut Text<'_>,
    contour: &Contour,
    kind: &str,
) -> (Point, f64) {
    let cam = angle(chance);
    text.body("cam", "a = [0, 0]", [0.0, 0.0, cam]);
    let touch = chance.between(0.5, 2.5);
    let height = contour.radius(touch - cam) + if kind == "roller" { ROLLER } else { 0.0 };
    let place = end([0.0, 0.0], height, touch);
    let pivot = end(
        [0.0, 0.0],
        chance.between(0.25, 0.5),
        touch + chance.between(0.4, 1.2),
    );
    let arm = direction(pivot, place);
    let pin = end(pivot, chance.between(0.05, 0.2), angle(chance));
    text.ground("P", pivot, 0.0);
    let at = if kind == "flat" { pivot } else { place };
    let marks = [point("p", pivot), frame("a", at, arm), point("b", pin)];
    text.plate(chance, "follower", [pivot[0], pivot[1], arm], &marks);
    text.pin("P", ["ground.P", "follower.p"]);
    add_cam(chance, text, contour, kind);
    let to = cam + chance.between(-4.0, 4.0);
    text.turn("u", ["ground.O", "cam.a"], cam, to);
    (pin, arm)
}

/// A follower on an arm.
pub fn cam_arm(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let kind = KINDS[chance.below(3)];
    let contour = Contour::draw(chance, kind == "flat");
    let _ = add_arm(chance, &mut text, &contour, kind);
    text.case()
}

/// A follower on an arm that moves a dyad.
pub fn cam_in_loop(chance: &mut Chance, mut text: Text<'_>) -> Case {
    let kind = KINDS[chance.below(3)];
    let contour = Contour::draw(chance, kind == "flat");
    let (pin, _) = add_arm(chance, &mut text, &contour, kind);
    let bars = [0; 2].map(|_| chance.between(0.1, 0.5));
    let pivot = end(
        pin,
        (bars[0] + bars[1]) * chance.between(0.3, 0.95),
        angle(chance),
    );
    let angles = dyad(pin, pivot, bars, sign(chance));
    text.ground("D", pivot, 0.0);
    let bars = bars.map(|length| text.length(chance, length));
    text.bar("rod", &bars[0], pin, angles[0]);
    text.bar("rocker", &bars[1], pivot, angles[1]);
    text.pin("B", ["follower.b", "rod.a"]);
    text.pin("C", ["rod.b", "rocker.b"]);
    text.pin("D", ["ground.D", "rocker.a"]);
    text.case()
}
