//! Springs, trains of wheels and rolling against closed forms.

use super::run::{Fed, assert_follows, times};
use crate::common::parse;

/// A block on a slide, or on a slot with its angle held.
fn block(joint: &str, start: f64, velocity: f64, forces: &str) -> String {
    let held = match joint {
        "slot" => {
            "[constraints]\nlevel = { coordinate = \"angle\", \
             markers = [\"ground.O\", \"block.B\"], value = 0 }\n"
        }
        _ => "",
    };
    format!(
        "format = 1\nname = \"block\"\n[ground.markers]\nO = [0, 0]\n\
         [bodies.block]\nmarkers = {{ B = [0, 0] }}\nestimate = [{start}, 0, 0]\nmass = 2\n\
         [joints]\nguide = {{ type = \"{joint}\", markers = [\"ground.O\", \"block.B\"] }}\n{held}\
         [freedoms]\nx = {{ coordinate = \"x\", markers = [\"ground.O\", \"block.B\"], \
         start = {start}, velocity = {velocity} }}\n[forces]\n{forces}"
    )
}

fn along(name: &str, keys: &str) -> String {
    format!("{name} = {{ coordinate = \"x\", markers = [\"ground.O\", \"block.B\"]{keys} }}\n")
}

/// x = x₀ + e^(−δt) (A cos ωt + B sin ωt) with 2 kg, 50 N/m and a damper.
#[test]
fn a_block_on_a_spring_swings_and_decays() {
    let (start, velocity, free): (f64, f64, f64) = (0.3, -0.7, 0.1);
    for damping in [0.0_f64, 1.5] {
        let delta: f64 = 0.25 * damping;
        let omega = (25.0 - delta * delta).sqrt();
        let a = start - free;
        let b = (velocity + delta * a) / omega;
        let exact = |t: f64| {
            let (sin, cos) = (omega * t).sin_cos();
            let decay = (-delta * t).exp();
            vec![
                free + decay * (a * cos + b * sin),
                decay * ((b * omega - delta * a) * cos - (a * omega + delta * b) * sin),
            ]
        };
        let keys = format!(", stiffness = 50, free = {free}, damping = {damping}");
        for joint in ["translational", "slot"] {
            let mechanism = parse(&block(joint, start, velocity, &along("spring", &keys)));
            let times = times(10.0, 40);
            assert_follows(
                &format!("spring on {joint}, damper {damping}"),
                &mechanism,
                Fed::default(),
                &times,
                |index| exact(times[index]),
                25.0 * a * a + velocity * velocity,
            );
        }
    }
}

/// The force input is constant, or rises: x = f t²/(2 m) + r t³/(6 m).
#[test]
fn a_block_follows_a_force_input() {
    let mechanism = parse(&block("translational", 0.0, 0.0, &along("motor", "")));
    let cases: [(Fed, f64, f64); 2] = [
        (
            Fed {
                loads: |_, loads| loads.fill(3.0),
                ..Fed::default()
            },
            3.0,
            0.0,
        ),
        (
            Fed {
                loads: |t, loads| loads.fill(3.0 - 1.5 * t),
                ..Fed::default()
            },
            3.0,
            -1.5,
        ),
    ];
    for (fed, force, ramp) in cases {
        let times = times(6.0, 24);
        let exact = |t: f64| {
            vec![
                force * t * t / 4.0 + ramp * t.powi(3) / 12.0,
                force * t / 2.0 + ramp * t * t / 4.0,
            ]
        };
        let largest = times.iter().map(|t| exact(*t)[1].powi(2));
        assert_follows(
            &format!("force input {force} + {ramp} t"),
            &mechanism,
            fed,
            &times,
            |index| exact(times[index]),
            largest.fold(0.0, f64::max),
        );
    }
}

/// A hanging block turns a pinion by its rack, the pinion a wheel by a mesh, the wheel a pulley by a
/// belt: m_eff = m + Σ I (turns per height)², g m/m_eff constant.
#[test]
fn a_block_on_a_train_of_wheels_falls_evenly() {
    // Pinion of 0.1 m on the rack; gear 0.1 to 0.25 m; belt 0.2 to 0.05 m.
    let text = "format = 1\nname = \"train\"\n[ground.markers]\nrail = [0, 0, \"90*deg\"]\n\
        P = [0.1, 0]\nW = [0.45, 0]\nV = [1.45, 0]\n\
        [bodies.block]\nmarkers = { B = [0, 0, \"90*deg\"] }\nestimate = [0, 0, 0]\nmass = 1.5\n\
        [bodies.pinion]\nmarkers = { C = [0, 0], D = [0, 0, \"90*deg\"] }\nestimate = [0.1, 0, 0]\n\
        mass = 1\ninertia = 0.004\n\
        [bodies.wheel]\nmarkers = { C = [0, 0] }\nestimate = [0.45, 0, 0]\nmass = 3\n\
        inertia = 0.05\n\
        [bodies.pulley]\nmarkers = { C = [0, 0] }\nestimate = [1.45, 0, 0]\nmass = 0.4\n\
        inertia = 0.0006\n\
        [joints]\nguide = { type = \"translational\", markers = [\"ground.rail\", \"block.B\"] }\n\
        P = { type = \"revolute\", markers = [\"ground.P\", \"pinion.C\"] }\n\
        W = { type = \"revolute\", markers = [\"ground.W\", \"wheel.C\"] }\n\
        V = { type = \"revolute\", markers = [\"ground.V\", \"pulley.C\"] }\n\
        rack = { type = \"rack_and_pinion\", markers = [\"pinion.D\", \"block.B\"], radius = 0.1, \
        side = \"below\" }\n\
        mesh = { type = \"gear\", markers = [\"pinion.C\", \"wheel.C\"], radii = [0.1, 0.25] }\n\
        belt = { type = \"belt\", markers = [\"wheel.C\", \"pulley.C\"], radii = [0.2, 0.05] }\n\
        [freedoms]\nheight = { coordinate = \"x\", markers = [\"ground.rail\", \"block.B\"], \
        start = 0 }\n";
    let pinion: f64 = 1.0 / 0.1;
    let wheel = pinion * 0.1 / 0.25;
    let pulley = wheel * 0.2 / 0.05;
    let effective = 1.5 + 0.004 * pinion.powi(2) + 0.05 * wheel.powi(2) + 0.0006 * pulley.powi(2);
    let acceleration = -1.5 * 9.81 / effective;
    let times = times(3.0, 12);
    assert_follows(
        "train of wheels",
        &parse(text),
        Fed::default(),
        &times,
        |index| {
            let t = times[index];
            vec![0.5 * acceleration * t * t, acceleration * t]
        },
        0.5 * effective * (3.0 * acceleration).powi(2),
    );
}

/// A wheel rolls down a slope of 20°: φ̈ = m g r sin/(I + m r²), whichever coordinate is free.
#[test]
fn a_wheel_rolls_down_a_slope() {
    let (mass, inertia, radius): (f64, f64, f64) = (2.0, 0.03, 0.3);
    let slope = -20.0_f64.to_radians();
    let along = mass * 9.81 * (-slope).sin() / (mass + inertia / (radius * radius));
    let [x, y] = [-radius * slope.sin(), radius * slope.cos()];
    for (coordinate, factor) in [("x", 1.0), ("angle", -1.0 / radius)] {
        let text = format!(
            "format = 1\nname = \"wheel\"\n[ground.markers]\ntrack = [0, 0, {slope}]\n\
             [bodies.wheel]\nmarkers = {{ centre = [0, 0] }}\n\
             estimate = [{x}, {y}, {slope}]\nmass = {mass}\ninertia = {inertia}\n\
             [joints]\ncontact = {{ type = \"rolling\", markers = [\"wheel.centre\", \
             \"ground.track\"], radius = {radius} }}\n\
             [freedoms]\nroll = {{ coordinate = \"{coordinate}\", markers = [\"ground.track\", \
             \"wheel.centre\"], start = 0, velocity = {} }}\n",
            -0.5 * factor
        );
        let times = times(4.0, 16);
        let speed = -0.5 + 4.0 * along;
        assert_follows(
            &format!("rolling, {coordinate}"),
            &parse(&text),
            Fed::default(),
            &times,
            |index| {
                let t = times[index];
                vec![
                    factor * (-0.5 * t + 0.5 * along * t * t),
                    factor * (-0.5 + along * t),
                ]
            },
            0.5 * (mass + inertia / (radius * radius)) * speed * speed,
        );
    }
}
