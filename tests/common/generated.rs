//! Texts of mechanisms of any size with known motions; also used by `benches/`.

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
/// 60°. `benches/yardstick/chain.h` has the same geometry.
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
