//! Followers that lift off their cams.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use super::{DEAD_POINTS, JAMS, is, log_between};
use crate::attack::free::case::{Case, Check, Gap};
use crate::attack::free::text::Text;
use crate::mutation::Chance;

/// A contour: an eccentric circle with a lobe, which may be narrow.
#[derive(Clone, Copy, Debug)]
struct Contour {
    radius: f64,
    eccentricity: f64,
    lobe: f64,
    width: f64,
    place: f64,
}

impl Contour {
    /// Draws a contour; one that a flat face can follow is a circle alone.
    fn draw(chance: &mut Chance, is_convex: bool) -> Self {
        let radius = chance.between(0.02, 0.06);
        Self {
            radius,
            eccentricity: radius * chance.between(0.05, 0.75),
            lobe: if is_convex || is(chance, 0.4) {
                0.0
            } else {
                radius * chance.between(0.05, 0.3)
            },
            width: log_between(chance, 0.05, 0.5),
            place: chance.between(-PI, PI),
        }
    }

    fn at(&self, theta: f64) -> f64 {
        let Self {
            radius: r,
            eccentricity: e,
            lobe,
            width,
            place,
        } = *self;
        let (sin, cos) = theta.sin_cos();
        let half = ((0.5 * (theta - place)).sin() / width).powi(2);
        e * cos + (r * r - (e * sin).powi(2)).sqrt() + lobe * (-half).exp()
    }

    fn expression(&self) -> String {
        let Self {
            radius: r,
            eccentricity: e,
            lobe,
            width,
            place,
        } = self;
        let circle = format!("{e:?}*cos(theta) + sqrt({r:?}^2 - ({e:?}*sin(theta))^2)");
        if *lobe > 0.0 {
            format!("{circle} + {lobe:?}*exp(-(sin((theta - ({place:?}))/2)/{width:?})^2)")
        } else {
            circle
        }
    }

    /// Returns its points.
    fn points(&self) -> Vec<[f64; 2]> {
        const POINTS: u32 = 1440;
        let thetas = (0..POINTS).map(|k| TAU * f64::from(k) / f64::from(POINTS));
        let points = thetas.map(|theta| {
            let (sin, cos) = theta.sin_cos();
            [self.at(theta) * cos, self.at(theta) * sin]
        });
        points.collect()
    }

    /// Removes the lobe if its flanks are too hollow for a roller, which would touch at two places.
    fn for_roller(self, radius: f64) -> Self {
        const PLACES: u32 = 1440;
        let step = TAU / f64::from(PLACES);
        let is_hollow = (0..PLACES).any(|k| {
            let theta = step * f64::from(k);
            let [before, here, after] = [-1.0, 0.0, 1.0].map(|s| self.at(theta + s * step));
            let slope = (after - before) / (2.0 * step);
            let bend = (after - 2.0 * here + before) / (step * step);
            let turned = here * here + 2.0 * slope * slope - here * bend;
            // The hollow has to be wider than the roller by half of it.
            turned * 1.5 * radius < -(here * here + slope * slope).powf(1.5)
        });
        if is_hollow {
            Self { lobe: 0.0, ..self }
        } else {
            self
        }
    }

    fn largest(&self) -> f64 {
        let radii = self.points().into_iter().map(|[x, y]| x.hypot(y));
        radii.fold(0.0, f64::max)
    }
}

/// Adds a cam that turns at constant speed, to and fro, or freely.
fn add_cam(chance: &mut Chance, text: &mut Text) {
    text.ground("O", [0.0, 0.0], 0.0);
    let inertia = log_between(chance, 1e-3, 1e-1);
    text.body("cam", "O = [0, 0]", [0.0; 3], [1.0, inertia, 0.0]);
    text.joint("O", "revolute", ["ground.O", "cam.O"], "");
    let speed = log_between(chance, 3.0, 60.0) * chance.between(-1.0, 1.0).signum();
    let speed = text.nudged(speed);
    let markers = ["ground.O", "cam.O"];
    match chance.below(4) {
        0 => text.freedom("turn", "angle", markers, [0.0, speed]),
        1 => {
            let reach = chance.between(0.3, 3.0);
            let motion = format!("{reach:?}*sin({:?}*t)", speed / reach);
            text.driver("turn", "angle", markers, &motion);
        }
        _ => text.driver("turn", "angle", markers, &format!("{speed:?}*t")),
    }
}

/// A tappet with a knife, a roller or a flat face on a cam, pressed by gravity and perhaps a spring.
pub fn cam_tappet(chance: &mut Chance, mut text: Text) -> Case {
    let follower = ["knife", "roller", "flat"][chance.below(3)];
    let contour = Contour::draw(chance, follower == "flat");
    add_cam(chance, &mut text);
    let roller = chance.between(0.005, 0.03);
    let contour = match follower {
        "roller" => contour.for_roller(roller),
        _ => contour,
    };
    let above = match follower {
        "roller" => roller,
        _ => 0.0,
    };
    let touches = follower == "knife" && is(chance, 0.5);
    let start = if touches {
        contour.at(FRAC_PI_2)
    } else {
        contour.largest() + above + log_between(chance, 1e-4, 0.03)
    };
    let duration = chance.between(0.3, 1.5);
    let speed = [0.0, chance.between(-0.5, 0.5)][chance.below(2)];
    let markers = format!("F = [0, 0], S = [0, 0, {FRAC_PI_2:?}]");
    text.ground("S", [0.0, 0.0], FRAC_PI_2);
    let mass = chance.between(0.2, 3.0);
    text.body("tap", &markers, [0.0, start, 0.0], [mass, 0.0, 0.0]);
    text.joint("S", "translational", ["ground.S", "tap.S"], "");
    text.freedom("y", "x", ["ground.S", "tap.S"], [start, speed]);
    if is(chance, 0.6) {
        let stiffness = text.nudged(mass * log_between(chance, 50.0, 5000.0));
        let damping = [0.0, chance.between(0.0, 20.0)][chance.below(2)];
        let free = start - chance.between(0.0, 0.05);
        let more = format!(", stiffness = {stiffness:?}, free = {free:?}, damping = {damping:?}");
        text.along("forces", "spring", "x", ["ground.S", "tap.S"], &more);
    }
    let restitution = [0.0, chance.between(0.0, 0.8)][chance.below(2)];
    let restitution = text.nudged(restitution);
    let radius = match follower {
        "roller" => format!(", radius = {roller:?}"),
        _ => String::new(),
    };
    let more = format!(
        ", follower = '{follower}', profile = '{}', unilateral = true, restitution = {restitution:?}{radius}",
        contour.expression()
    );
    text.joint("touch", "cam", ["cam.O", "tap.F"], &more);
    let rubs = is(chance, 0.3);
    if rubs {
        let coefficient = chance.between(0.05, 0.4);
        let pin = match follower {
            "roller" => format!(", radius = {:?}", chance.between(0.1, 0.9) * roller),
            _ => String::new(),
        };
        let entry = format!("{{ joint = 'touch', coefficient = {coefficient:?}{pin} }}");
        text.add("friction", "rub", &entry);
    }
    if is(chance, 0.3) {
        let most = start + chance.between(0.001, 0.05);
        text.add(
            "stops",
            "roof",
            &format!("{{ of = 'y', max = {most:?}, restitution = 0.3 }}"),
        );
    }
    let points = Arc::new(contour.points());
    let gap: Gap = match follower {
        "knife" => Box::new(move |q| q[4] - contour.at(FRAC_PI_2 - q[2])),
        "roller" => Box::new(move |q| roller_gap(&points, q[2], [q[3], q[4]]) - roller),
        _ => Box::new(move |q| {
            let (sin, cos) = q[2].sin_cos();
            let heights = points.iter().map(|[x, y]| sin * x + cos * y);
            q[4] - heights.fold(0.0, f64::max)
        }),
    };
    let name = "touch".to_owned();
    Case {
        checks: vec![Check::Gap { name, gap }],
        refusals: if rubs { JAMS } else { &[] },
        ..Case::new(text.end(duration), duration)
    }
}

/// Returns the least distance of a point from the contour of a cam at the origin that has turned.
fn roller_gap(points: &[[f64; 2]], turn: f64, [x, y]: [f64; 2]) -> f64 {
    let (sin, cos) = turn.sin_cos();
    let own = [cos * x + sin * y, cos * y - sin * x];
    let distances = points.iter().map(|p| (own[0] - p[0]).hypot(own[1] - p[1]));
    distances.fold(f64::INFINITY, f64::min)
}

/// An arm with a roller on a cam, pressed by its weight and perhaps a spring.
pub fn cam_arm(chance: &mut Chance, mut text: Text) -> Case {
    let contour = Contour::draw(chance, false);
    add_cam(chance, &mut text);
    let roller = chance.between(0.002, 0.03);
    // Far from the cam two places are as near as each other where a flank is as hollow as that.
    let contour = contour.for_roller(roller + 0.05);
    let pivot = [-chance.between(0.12, 0.3), chance.between(0.0, 0.08)];
    let length = -pivot[0] * chance.between(0.9, 1.1);
    let above = contour.largest() + roller + log_between(chance, 1e-3, 0.03);
    // The roller is at least so high above the cam's axis.
    let start = ((above - pivot[1]) / length).clamp(-1.0, 0.9).asin();
    let duration = chance.between(0.3, 1.5);
    let mass = chance.between(0.2, 3.0);
    text.ground("D", pivot, 0.0);
    let markers = format!("D = [0, 0], F = [{length:?}, 0]");
    let inertia = mass * length * length / 12.0;
    let pose = [pivot[0], pivot[1], start];
    text.body("arm", &markers, pose, [mass, inertia, 0.5 * length]);
    text.joint("D", "revolute", ["ground.D", "arm.D"], "");
    text.freedom("lift", "angle", ["ground.D", "arm.D"], [start, 0.0]);
    if is(chance, 0.6) {
        let stiffness = text.nudged(inertia * log_between(chance, 100.0, 10000.0));
        let free = start - chance.between(0.0, 0.5);
        let more = format!(", stiffness = {stiffness:?}, free = {free:?}");
        text.along("forces", "spring", "angle", ["ground.D", "arm.D"], &more);
    }
    let restitution = [0.0, chance.between(0.0, 0.8)][chance.below(2)];
    let restitution = text.nudged(restitution);
    let more = format!(
        ", follower = 'roller', radius = {roller:?}, profile = '{}', unilateral = true, restitution = {restitution:?}",
        contour.expression()
    );
    text.joint("touch", "cam", ["cam.O", "arm.F"], &more);
    if is(chance, 0.3) {
        let (coefficient, radius) = (chance.between(0.05, 0.4), chance.between(0.002, 0.01));
        let entry =
            format!("{{ joint = 'D', coefficient = {coefficient:?}, radius = {radius:?} }}");
        text.add("friction", "pin", &entry);
    }
    let points = contour.points();
    let gap = move |q: &[f64]| {
        let (sin, cos) = q[5].sin_cos();
        roller_gap(&points, q[2], [q[3] + length * cos, q[4] + length * sin]) - roller
    };
    let check = Check::Gap {
        name: "touch".to_owned(),
        gap: Box::new(gap),
    };
    Case {
        checks: vec![check],
        refusals: DEAD_POINTS,
        ..Case::new(text.end(duration), duration)
    }
}
