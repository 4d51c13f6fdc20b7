//! Texts of mechanisms of any size with known motions; also used by `crates/benches`.

use std::f64::consts::{FRAC_PI_3, PI};
use std::fmt::Write as _;

/// Length of a bar of [`scissor_lift`] \[m\].
pub const BAR: f64 = 0.4;
/// Angle of its bars at the start \[rad\].
pub const BAR_ANGLE: f64 = PI / 6.0;

/// Pivots on ground of the rockers of a [`chain`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// Each [`SPACING`] to the right of the one before.
    Straight,
    /// In turn to the right and to the left of the one before, so that numbers stay small in long
    /// chains.
    Zigzag,
}

/// Distance of neighbouring pivots \[m\].
pub const SPACING: f64 = 0.25;

/// `loops` loops: the four-bar of `mechanisms/four_bar.toml`, then parallelograms, each with the
/// rocker before as its crank, so that every rocker turns like the first.
///
/// Bodies: `crank`, then `coupler_k` and `rocker_k` for k = 1 to `loops`; the origin of each is at
/// the pin or pivot that comes first in this order. The driver is `crank_angle`, which starts at
/// 60°. `crates/benches/yardstick/chain.h` has the same geometry.
pub fn chain(loops: usize, ground: Ground) -> String {
    let (crank, coupler, rocker, base) = (0.10, 0.25, 0.30, 0.40);
    // Estimates: the closed pose at 60°, to a millimetre and a milliradian.
    let start = FRAC_PI_3;
    let pin = [crank * start.cos(), crank * start.sin()];
    let diagonal = f64::hypot(base - pin[0], pin[1]);
    let leaning = f64::atan2(-pin[1], base - pin[0]);
    let opposite = |of: f64, beside: f64| {
        ((diagonal * diagonal + beside * beside - of * of) / (2.0 * diagonal * beside)).acos()
    };
    let coupler_phi = leaning + opposite(rocker, coupler);
    let rocker_phi = leaning + PI - opposite(coupler, rocker);
    let tip = [rocker * rocker_phi.cos(), rocker * rocker_phi.sin()];

    let mut pivots = "[ground.markers]\nO = [0, 0]\n".to_owned();
    let mut bodies = format!(
        "[bodies.crank]\nmarkers = {{ O = [0, 0], A = [{crank}, 0] }}\n\
         estimate = [0, 0, {start:.3}]\n"
    );
    let mut joints =
        "[joints]\nO = { type = \"revolute\", markers = [\"ground.O\", \"crank.O\"] }\n".to_owned();
    let mut pivot = base;
    for k in 1..=loops {
        let back = ground == Ground::Zigzag && k % 2 == 1;
        // The body that drives the loop, and how far its pivot is from the rocker's.
        let (driving, at, length, phi) = if k == 1 {
            ("crank.A".to_owned(), pin, coupler, coupler_phi)
        } else {
            let step = if back { -SPACING } else { SPACING };
            let at = [pivot + tip[0], tip[1]];
            pivot += step;
            let phi = if back { PI } else { 0.0 };
            (format!("rocker_{}.B", k - 1), at, SPACING, phi)
        };
        let [x, y] = at;
        writeln!(pivots, "O{k} = [{pivot}, 0]").expect("a text takes all");
        write!(
            bodies,
            "[bodies.coupler_{k}]\nmarkers = {{ A = [0, 0], B = [{length}, 0] }}\n\
             estimate = [{x:.3}, {y:.3}, {phi:.3}]\n\
             [bodies.rocker_{k}]\nmarkers = {{ O = [0, 0], B = [{rocker}, 0] }}\n\
             estimate = [{pivot}, 0, {rocker_phi:.3}]\n"
        )
        .expect("a text takes all");
        write!(
            joints,
            "A{k} = {{ type = \"revolute\", markers = [\"{driving}\", \"coupler_{k}.A\"] }}\n\
             B{k} = {{ type = \"revolute\", markers = [\"coupler_{k}.B\", \"rocker_{k}.B\"] }}\n\
             O{k} = {{ type = \"revolute\", markers = [\"ground.O{k}\", \"rocker_{k}.O\"] }}\n"
        )
        .expect("a text takes all");
    }
    format!(
        "format = 1\nname = \"chain\"\n{pivots}{bodies}{joints}[drivers]\n\
         crank_angle = {{ coordinate = \"angle\", markers = [\"ground.O\", \"crank.O\"], \
         start = \"60*deg\" }}\n"
    )
}

/// A scissor lift of `cells` pairs of crossing bars, driven by the height of its free end, which
/// couples all cells into one block.
///
/// Bodies: `left_k` and `right_k` for k = 1 to `cells`, from the ground up: bars of length [`BAR`]
/// with their origins at their lower ends, the one that starts on the left at the angle φ, the
/// other one at π − φ. The driver `height` is u = `cells` · [`BAR`] · sin φ \[m\].
pub fn scissor_lift(cells: usize) -> String {
    let [across, up] = [BAR * BAR_ANGLE.cos(), BAR * BAR_ANGLE.sin()];
    let middle = BAR / 2.0;
    let markers = format!("markers = {{ P = [0, 0], M = [{middle}, 0], Q = [{BAR}, 0] }}");
    let mut bodies = String::new();
    let mut joints = "[joints]\n\
         foot = { type = \"revolute\", markers = [\"ground.O\", \"left_1.P\"] }\n\
         slide = { type = \"slot\", markers = [\"ground.O\", \"right_1.P\"] }\n"
        .to_owned();
    for k in 1..=cells {
        let y = up * (k - 1) as f64;
        let below = k - 1;
        write!(
            bodies,
            "[bodies.left_{k}]\n{markers}\nestimate = [0, {y:.3}, {BAR_ANGLE:.3}]\n\
             [bodies.right_{k}]\n{markers}\nestimate = [{across:.3}, {y:.3}, {:.3}]\n",
            PI - BAR_ANGLE
        )
        .expect("a text takes all");
        writeln!(
            joints,
            "M{k} = {{ type = \"revolute\", markers = [\"left_{k}.M\", \"right_{k}.M\"] }}"
        )
        .expect("a text takes all");
        if k > 1 {
            write!(
                joints,
                "L{k} = {{ type = \"revolute\", markers = [\"right_{below}.Q\", \"left_{k}.P\"] }}\n\
                 R{k} = {{ type = \"revolute\", markers = [\"left_{below}.Q\", \"right_{k}.P\"] }}\n"
            )
            .expect("a text takes all");
        }
    }
    let height = up * cells as f64;
    format!(
        "format = 1\nname = \"scissor_lift\"\n[ground.markers]\nO = [0, 0]\n{bodies}{joints}\
         [drivers]\nheight = {{ coordinate = \"y\", \
         markers = [\"ground.O\", \"left_{cells}.Q\"], start = {height} }}\n"
    )
}

/// A lift of `cells` pairs of crossing bars of 1 m, driven by the angle `u` of its lowest bar `a0`,
/// the foot of the other one, `b0`, sliding on ground. `crossings` gives the distances of the
/// crossing of each cell from the lower ends of its two bars; bars that do not cross in their
/// middles bend the lift. Bodies: `a0`, `b0`, `a1`, … with their origins at their lower ends.
///
/// Estimates are the closed form of [`lift_from_below_pose`] at the angle `start` \[rad\].
pub fn lift_from_below(cells: usize, start: f64, crossings: impl Fn(usize) -> [f64; 2]) -> String {
    let pose = lift_from_below_pose(cells, start, &crossings);
    let (mut bodies, mut joints) = (String::new(), "[joints]\n".to_owned());
    for k in 0..cells {
        for (side, name) in ["a", "b"].into_iter().enumerate() {
            let [x, y, phi] = pose[2 * k + side];
            let at = crossings(k)[side];
            writeln!(
                bodies,
                "[bodies.{name}{k}]\nmarkers = {{ P = [0, 0], M = [{at}, 0], Q = [1, 0] }}\n\
                 estimate = [{x}, {y}, {phi}]"
            )
            .expect("a text takes all");
        }
        writeln!(
            joints,
            "M{k} = {{ type = \"revolute\", markers = [\"a{k}.M\", \"b{k}.M\"] }}"
        )
        .expect("a text takes all");
        let [on_a, on_b] = if k == 0 {
            ["revolute", "slot"].map(|kind| (kind, "ground.O".to_owned()))
        } else {
            ["b", "a"].map(|below| ("revolute", format!("{below}{}.Q", k - 1)))
        };
        for (name, (kind, below)) in [("a", on_a), ("b", on_b)] {
            writeln!(
                joints,
                "{}{k} = {{ type = \"{kind}\", markers = [\"{below}\", \"{name}{k}.P\"] }}",
                name.to_uppercase()
            )
            .expect("a text takes all");
        }
    }
    format!(
        "format = 1\nname = \"lift\"\n[ground.markers]\nO = [0, 0]\n{bodies}{joints}[drivers]\n\
         u = {{ coordinate = \"angle\", markers = [\"ground.O\", \"a0.P\"], start = {start} }}\n"
    )
}

/// The pose of [`lift_from_below`]: x, y and phi of `a0`, `b0`, `a1`, …, cell by cell by the
/// intersection of two circles about the lower ends, at whose left `a` begins.
pub fn lift_from_below_pose(
    cells: usize,
    angle: f64,
    crossings: impl Fn(usize) -> [f64; 2],
) -> Vec<[f64; 3]> {
    let [on_a, on_b] = crossings(0);
    let mut left = [0.0, 0.0];
    let height = on_a * angle.sin();
    let mut right = [
        on_a * angle.cos() + (on_b * on_b - height * height).sqrt(),
        0.0,
    ];
    let mut pose = Vec::new();
    for k in 0..cells {
        let [on_a, on_b] = crossings(k);
        let base = [right[0] - left[0], right[1] - left[1]];
        let distance = f64::hypot(base[0], base[1]);
        let along = (distance * distance + on_a * on_a - on_b * on_b) / (2.0 * distance);
        let up = (on_a * on_a - along * along).sqrt();
        let [e, n] = [
            base.map(|c| c / distance),
            [-base[1] / distance, base[0] / distance],
        ];
        let crossing = [0, 1].map(|c| left[c] + along * e[c] + up * n[c]);
        let bar = |from: [f64; 2]| {
            let phi = f64::atan2(crossing[1] - from[1], crossing[0] - from[0]);
            (
                [from[0], from[1], phi],
                [from[0] + phi.cos(), from[1] + phi.sin()],
            )
        };
        let ((a, top_a), (b, top_b)) = (bar(left), bar(right));
        pose.extend([a, b]);
        [left, right] = [top_b, top_a];
    }
    pose
}
