//! Stops and friction in free motion, against closed forms.
//!
//! Instants are known to 1e-8 s and states to 1e-8 (1 + |value|) at a tolerance of 1e-10: the contract's
//! marks.

use std::f64::consts::PI;

use biela::dynamics::{Event, EventKind};
use biela::mechanism::Jet;

use super::run::{Fed, Run};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
const MARK: f64 = 1e-8;
const G: f64 = 9.81;

/// A body of 2 kg on a straight guide at an angle \[deg\] to the level, with its place `way` along it.
pub(super) fn slider(angle: f64, start: f64, velocity: f64, parts: &str) -> String {
    format!(
        r#"
format = 1
name = "slider"
[ground.markers]
O = [0, 0, "{angle}*deg"]
[bodies.slider]
mass = 2
markers = {{ P = [0, 0, "{angle}*deg"] }}
[joints]
guide = {{ type = "translational", markers = ["ground.O", "slider.P"] }}
[freedoms]
way = {{ coordinate = "x", markers = ["ground.O", "slider.P"], start = {start}, velocity = {velocity} }}
{parts}
"#
    )
}

/// A rod of 1 m and 1 kg that hangs at its end, level at first, with its angle `swing`.
pub(super) fn pendulum(parts: &str) -> String {
    format!(
        r#"
format = 1
name = "pendulum"
[ground.markers]
O = [0, 0]
[bodies.rod]
mass = 1
center = [0.5, 0]
inertia = "1/12"
markers = {{ O = [0, 0] }}
[joints]
pin = {{ type = "revolute", markers = ["ground.O", "rod.O"] }}
[freedoms]
swing = {{ coordinate = "angle", markers = ["ground.O", "rod.O"], start = 0 }}
{parts}
"#
    )
}

/// A block of 1 kg on a belt, each on a level guide.
fn belt(parts: &str) -> String {
    format!(
        r#"
format = 1
name = "belt"
[ground.markers]
O = [0, 0]
[bodies.belt]
markers = {{ B = [0, 0] }}
[bodies.block]
mass = 1
markers = {{ C = [0, 0] }}
[joints]
block_guide = {{ type = "translational", markers = ["ground.O", "block.C"] }}
belt_guide = {{ type = "translational", markers = ["ground.O", "belt.B"] }}
{parts}
"#
    )
}

/// Runs to a time in steps, and returns the events; the joints stay closed and no energy appears.
pub(super) fn played(run: &mut Run, until: f64, steps: u32) -> Vec<Event> {
    let mut events = Vec::new();
    let start = run.solver.pose().time;
    for step in 1..=steps {
        run.to(start + (until - start) * f64::from(step) / f64::from(steps));
        events.extend(run.free.events());
    }
    events
}

pub(super) fn assert_near(value: f64, truth: f64) {
    let error = (value - truth).abs();
    assert!(error < MARK * (1.0 + truth.abs()), "{value} {truth}");
}

/// Compares events with instants and kinds; the speeds of impacts count too.
fn assert_events(events: &[Event], expected: &[(f64, EventKind)]) {
    assert_eq!(events.len(), expected.len(), "{events:?}");
    for (event, (time, kind)) in events.iter().zip(expected) {
        assert_near(event.time, *time);
        match (event.kind, *kind) {
            (EventKind::Impact { speed }, EventKind::Impact { speed: truth }) => {
                assert_near(speed, truth);
            }
            (event, kind) => assert_eq!(event, kind),
        }
    }
}

/// Runs a mechanism at once and in many steps, with the same events and the same end.
pub(super) fn check(text: &str, until: f64, expected: &[(f64, EventKind)], state: [f64; 2]) -> Run {
    let mut runs = [1, 37].map(|steps| {
        let mut run = Run::new(&parse(text), TOLERANCE, Fed::default());
        assert_events(&played(&mut run, until, steps), expected);
        for (value, truth) in run.state().into_iter().zip(state) {
            assert_near(value, truth);
        }
        let energy = run.free.energy_error().abs();
        assert!(energy < 1e-9, "{energy}");
        run
    });
    std::mem::replace(
        &mut runs[0],
        Run::new(&parse(text), TOLERANCE, Fed::default()),
    )
}

#[test]
fn a_block_slides_to_rest() {
    // It sticks after v² / 2a, and does not creep.
    let text = slider(
        0.0,
        0.0,
        3.0,
        "[friction]\nrail = { of = \"way\", force = 4 }",
    );
    let (a, v) = (2.0, 3.0);
    let run = check(
        &text,
        100.0,
        &[(v / a, EventKind::Sticks)],
        [v * v / (2.0 * a), 0.0],
    );
    assert_eq!(run.state()[1].to_bits(), 0);
}

/// On a slope a block goes up, rests where friction holds it, or comes back.
#[test]
fn a_block_turns_back_on_a_slope() {
    let slope = |force: f64| {
        let friction = format!("[friction]\nrail = {{ of = \"way\", force = {force} }}");
        slider(20.0, 0.0, 3.0, &friction)
    };
    let pull = G * 20.0_f64.to_radians().sin();
    let [up, down] = [pull + 1.5, pull - 1.5];
    let (turn, top) = (3.0 / up, 9.0 / (2.0 * up));
    let fallen = 2.0 - turn;
    let state = [top - 0.5 * down * fallen * fallen, -down * fallen];
    check(&slope(3.0), 2.0, &[], state);
    let up = pull + 4.0;
    let rest = [(3.0 / up, EventKind::Sticks)];
    check(&slope(8.0), 2.0, &rest, [9.0 / (2.0 * up), 0.0]);
}

/// The amplitudes of a spring with Coulomb's friction fall by 2 F / k in each half period, until the
/// spring cannot break it away.
#[test]
fn the_amplitudes_of_a_spring_fall_by_steps() {
    let parts = r#"
[forces]
spring = { coordinate = "x", markers = ["ground.O", "slider.P"], stiffness = 200, free = 0 }
[friction]
rail = { of = "way", force = 12 }
"#;
    // 1 − 0.12 n: at 0.04 the spring exerts 8 N.
    let half = PI / 10.0;
    check(
        &slider(0.0, 1.0, 0.0, parts),
        5.0,
        &[(8.0 * half, EventKind::Sticks)],
        [0.04, 0.0],
    );
}

/// A block on a belt sticks, breaks away and sticks again: from x₀ = S / k it swings about F / k until
/// it is as fast as the belt.
#[test]
fn a_block_on_a_belt_sticks_and_slips() {
    let parts = r#"
[drivers]
belt_way = { coordinate = "x", markers = ["ground.O", "belt.B"], motion = "0.1*t" }
[freedoms]
way = { coordinate = "x", markers = ["ground.O", "block.C"], start = 0.02, velocity = 0.1 }
[forces]
spring = { coordinate = "x", markers = ["ground.O", "block.C"], stiffness = 100, free = 0 }
[friction]
rubber = { coordinate = "x", markers = ["belt.B", "block.C"], force = 2, static = 3 }
"#;
    let text = belt(parts);
    let (omega, speed) = (10.0_f64, 0.1_f64);
    // At x₀ with the belt's speed; mirrored about F / k it has that speed again.
    let [lead, center] = [0.03, 0.02];
    let angle = 2.0 * (PI - (omega * (lead - center) / speed).atan());
    let slip = angle / omega;
    let stick = 2.0 * (lead - center) / speed;
    let first = (lead - 0.02) / speed;
    let mut run = Run::new(&parse(&text), TOLERANCE, Fed::default());
    let events = played(&mut run, first + 5.0 * (slip + stick) + 0.01, 11);
    let expected: Vec<_> = (0..12)
        .map(|k| {
            let periods = f64::from(k / 2) * (slip + stick) + first;
            match k % 2 {
                0 => (periods, EventKind::Slides),
                _ => (periods + slip, EventKind::Sticks),
            }
        })
        .take(11)
        .collect();
    assert_events(&events, &expected);
}

/// With Stribeck's exponent 1 a block slows down by m v′ = −C − D exp(−v / v_s): w = exp(v / v_s) falls
/// linearly in itself, w′ = −(C w + D) / (m v_s), until it sticks at w = 1. Its way is an integral of
/// v_s ln w, here by Simpson's rule, whose error is some 1e-14.
#[test]
fn a_block_slides_to_rest_by_stribecks_exponent() {
    let text = slider(
        0.0,
        0.0,
        1.0,
        "[friction]\nrail = { of = \"way\", force = 3, static = 5, stribeck = 0.4, exponent = 1 }",
    );
    let (mass, coulomb, more, speed) = (2.0, 3.0, 2.0, 0.4_f64);
    let (rest, rate) = (more / coulomb, coulomb / (mass * speed));
    let begin = (1.0 / speed).exp() + rest;
    let velocity = |time: f64| speed * (begin * (-rate * time).exp() - rest).ln();
    let way = |time: f64| {
        let half = 500;
        let h = time / f64::from(2 * half);
        let ends = velocity(0.0) + velocity(time);
        let inner = (1..2 * half).map(|k| f64::from(2 + 2 * (k % 2)) * velocity(f64::from(k) * h));
        h / 3.0 * (ends + inner.sum::<f64>())
    };
    let stop = (begin / (1.0 + rest)).ln() / rate;
    check(&text, 0.2, &[], [way(0.2), velocity(0.2)]);
    check(&text, 1.0, &[(stop, EventKind::Sticks)], [way(stop), 0.0]);
}

/// A ball bounces ever more often, and rests: instants are a geometric series.
#[test]
fn a_ball_comes_to_rest() {
    for restitution in [0.0, 0.3, 0.8, 0.95] {
        let stop =
            format!("[stops]\nbottom = {{ of = \"way\", min = 0, restitution = {restitution} }}");
        let mut run = Run::new(
            &parse(&slider(90.0, 1.0, 0.0, &stop)),
            TOLERANCE,
            Fed::default(),
        );
        let speed = (2.0 * G).sqrt();
        let first = speed / G;
        let until = first + 2.0 * speed / G * restitution / (1.0 - restitution) + 1.0;
        let events = played(&mut run, until, 7);
        let (rest, impacts) = events.split_last().expect("there are some");
        assert_eq!(rest.kind, EventKind::Rests);
        assert_near(rest.time, until - 1.0);
        let (mut time, mut speed) = (first, speed);
        for impact in impacts {
            let EventKind::Impact { speed: met } = impact.kind else {
                panic!("{impact:?}")
            };
            assert_near(impact.time, time);
            // Heights are known to some roundings.
            let error = (met * met - speed * speed).abs();
            assert!(error < MARK * speed + 2.0 * G * 1e-14, "{met} {speed}");
            speed *= restitution;
            time += 2.0 * speed / G;
        }
        // Bouncing ends where the last bounces take less than the rounding of their height.
        assert!(speed < 1e-6, "{speed}");
        assert!(
            run.state()[0].abs() < 1e-15 && run.state()[1] == 0.0,
            "{:?}",
            run.state()
        );
        assert!(run.energy_error < 1e-11, "{}", run.energy_error);
    }
}

/// A stop that an input pulls the body off is left at once when it pulls harder than the weight.
#[test]
fn a_stop_is_left_when_it_would_pull() {
    let parts = r#"
[forces]
lift = { coordinate = "x", markers = ["ground.O", "slider.P"], value = "10*t" }
[stops]
bottom = { of = "way", min = 0 }
"#;
    // 10 t = 2 g; then x = 5 τ³ / 6.
    let leaves = 0.2 * G;
    check(
        &slider(90.0, 0.0, 0.0, parts),
        leaves + 1.0,
        &[(leaves, EventKind::Leaves)],
        [5.0 / 6.0, 2.5],
    );
}

/// A spring that only pushes: half a period in contact, and back with the same speed; with a damper the
/// body is let go before the spring is free of force.
#[test]
fn an_elastic_stop_throws_back() {
    let wall = |damping: f64| {
        let stop = format!(
            "[stops]\nwall = {{ of = \"way\", max = 1, stiffness = 800, damping = {damping} }}"
        );
        slider(0.0, 0.0, 1.5, &stop)
    };
    let meets = 1.0 / 1.5;
    let impact = EventKind::Impact { speed: 1.5 };
    let leaves = meets + PI / 20.0;
    check(
        &wall(0.0),
        1.0,
        &[(meets, impact), (leaves, EventKind::Leaves)],
        [1.0 - 1.5 * (1.0 - leaves), -1.5],
    );
    // x = v/ω e^(−δ τ) sin ω τ until the force vanishes: ẍ = 0.
    let delta = 20.0_f64 / 4.0;
    let omega = (400.0 - delta * delta).sqrt();
    let free = (2.0 * delta * omega).atan2(delta * delta - omega * omega) / omega;
    let decay = (-delta * free).exp();
    let out = 1.5 / omega * decay * (omega * free).sin();
    let back = 1.5 * decay * ((omega * free).cos() - delta / omega * (omega * free).sin());
    let leaves = meets + free + out / -back;
    check(
        &wall(20.0),
        1.0,
        &[(meets, impact), (leaves, EventKind::Leaves)],
        [1.0 + out + back * (1.0 - meets - free), back],
    );
}

/// A rod that falls from the level against a rigid stop at the bottom: each swing has the square of the
/// restitution of its energy, and small swings are those of the pendulum.
#[test]
fn a_pendulum_swings_against_a_stop() {
    let stop = "[stops]\npost = { of = \"swing\", min = \"-90*deg\", restitution = 0.5 }";
    let mut run = Run::new(&parse(&pendulum(stop)), TOLERANCE, Fed::default());
    let events = played(&mut run, 4.0, 5);
    // The speed at the bottom by the energy: ω² = 3 g / l; half of it after each impact.
    let mut speed = (3.0 * G).sqrt();
    let mut last = None;
    for event in &events {
        let EventKind::Impact { speed: met } = event.kind else {
            continue;
        };
        assert_near(met, speed);
        if let Some(last) = last {
            // A swing to one side takes half a period: 2 K(k) / ω₀ with k = ω / 2 ω₀.
            let natural = (1.5 * G).sqrt();
            let modulus: f64 = speed / (2.0 * natural);
            assert_near(event.time - last, 2.0 * complete(modulus) / natural);
        }
        (last, speed) = (Some(event.time), 0.5 * speed);
    }
    assert!(events.len() >= 5, "{events:?}");
}

/// The complete elliptic integral of the first kind, by the arithmetic–geometric mean.
fn complete(modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - modulus * modulus).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// A weight that falls on a second one, which rests on the ground: all stop at once where nothing
/// bounces, and momentum and energy obey the law of restitution where they do.
#[test]
fn two_weights_meet() {
    let pair = |restitution: f64| {
        format!(
            r#"
format = 1
name = "pair"
[ground.markers]
O = [0, 0]
[bodies.a]
mass = 1
markers = {{ P = [0, 0] }}
[bodies.b]
mass = 3
estimate = [1.2, 0, 0]
markers = {{ P = [0, 0] }}
[joints]
left = {{ type = "translational", markers = ["ground.O", "a.P"] }}
right = {{ type = "translational", markers = ["ground.O", "b.P"] }}
[freedoms]
x_a = {{ coordinate = "x", markers = ["ground.O", "a.P"], start = 0, velocity = 2 }}
x_b = {{ coordinate = "x", markers = ["ground.O", "b.P"], start = 1, velocity = 0 }}
[stops]
buffer = {{ coordinate = "x", markers = ["a.P", "b.P"], min = 0.2, restitution = {restitution} }}
"#
        )
    };
    for restitution in [0.0, 0.4, 1.0] {
        let mut run = Run::new(&parse(&pair(restitution)), TOLERANCE, Fed::default());
        let events = played(&mut run, 1.0, 3);
        assert_near(events[0].time, 0.4);
        // v_a' = v (m_a − e m_b) / (m_a + m_b), v_b' = v m_a (1 + e) / (m_a + m_b).
        let after = [
            2.0 * (1.0 - 3.0 * restitution) / 4.0,
            2.0 * (1.0 + restitution) / 4.0,
        ];
        let state = run.state();
        assert_near(state[0], 0.8 + 0.6 * after[0]);
        assert_near(state[1], 1.0 + 0.6 * after[1]);
        assert_near(state[2], after[0]);
        assert_near(state[3], after[1]);
    }
}

/// Friction of a pin with Stribeck's and viscous parts: the energy that it takes is that of its power,
/// and the pendulum comes to rest where friction holds it.
#[test]
fn friction_takes_the_energy() {
    let friction = "[friction]\nbearing = { of = \"swing\", force = 0.2, static = 0.3, stribeck = 0.05, \
                    viscous = 0.02 }";
    let mut run = Run::new(&parse(&pendulum(friction)), TOLERANCE, Fed::default());
    let events = played(&mut run, 60.0, 60);
    assert_eq!(
        events.last().map(|event| event.kind),
        Some(EventKind::Sticks)
    );
    assert!(run.energy_error < 1e-9, "{}", run.energy_error);
    let [angle, speed] = run.state()[..] else {
        panic!("one freedom")
    };
    assert_eq!(speed.to_bits(), 0);
    // The weight's torque there is below the limit of sticking.
    assert!((0.5 * G * angle.cos()).abs() <= 0.3, "{angle}");
}

/// A motion that was saved in any mode goes on with the same bits.
#[test]
fn a_saved_motion_goes_on_with_the_same_bits() {
    let parts = "[stops]\nbottom = { of = \"way\", min = 0, restitution = 0.7 }\n[friction]\nrail = { of = \"way\", force = 0.5 }";
    let mechanism = parse(&slider(90.0, 0.3, 0.0, parts));
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    for step in 1..30 {
        let time = 0.05 * f64::from(step);
        run.to(time);
        let (state, pose) = (run.free.state(), run.solver.pose().clone());
        run.to(time + 0.3);
        let first = run.state();
        run.solver.restore(&pose);
        run.free.resume(&run.solver, &state).expect("its own");
        run.to(time + 0.3);
        assert_eq!(run.state(), first);
        run.solver.restore(&pose);
        run.free.resume(&run.solver, &state).expect("its own");
    }
}

/// A belt that jumps takes along what sticks to it in no time: the block stays where it is, and goes on
/// with the belt.
#[test]
fn a_driver_that_jumps_leaves_what_sticks() {
    let parts = r#"
[drivers]
belt_way = { coordinate = "x", markers = ["ground.O", "belt.B"], start = 0 }
[freedoms]
way = { coordinate = "x", markers = ["ground.O", "block.C"], start = 0 }
[friction]
rubber = { coordinate = "x", markers = ["belt.B", "block.C"], force = 2 }
"#;
    let text = belt(parts);
    let before = Fed {
        driver: |_, time| Jet::new(0.1 * time, [0.1, 0.0]),
        ..Fed::default()
    };
    let after = Fed {
        driver: |_, time| Jet::new(0.5 + 0.1 * time, [0.1, 0.0]),
        ..Fed::default()
    };
    let mechanism = parse(&text);
    let mut run = Run::new(&mechanism, TOLERANCE, before);
    // 2 N on 1 kg: after 0.05 s the block is as fast as the belt.
    let events = played(&mut run, 1.0, 1);
    assert_events(&events, &[(0.05, EventKind::Sticks)]);
    let place = run.state()[0];
    run.fed = after;
    let parameters = run.solver.pose().parameters.clone();
    run.free
        .jump(&mut run.solver, &run.fed, &parameters)
        .expect("nothing is in the way");
    let events = played(&mut run, 2.0, 1);
    assert_eq!(events, []);
    assert_near(run.state()[0], place + 0.1);
}

/// Numbers that a host sets may make a stop or friction impossible: it is named.
#[test]
fn impossible_numbers_are_named() {
    let text = slider(
        0.0,
        0.0,
        1.0,
        "[parameters]\nmu = 1\ne = 0.5\nn = 2\n[stops]\nwall = { of = \"way\", max = 1, restitution = \"e\" }\n\
         [friction]\nrail = { of = \"way\", force = \"mu\", static = \"mu\", \
         stribeck = 1, exponent = \"n\" }",
    );
    for (parameters, message) in [
        (
            [-1.0, 0.5, 2.0],
            "force `rail` has a negative number, or sticks with less than it slides",
        ),
        ([1.0, 0.5, 0.9], "force `rail` has an `exponent` below 1"),
        (
            [1.0, 1.5, 2.0],
            "force `wall` has a `restitution` that is not from 0 to 1",
        ),
    ] {
        let mut run = Run::new(&parse(&text), TOLERANCE, Fed::default());
        let refused = run.free.jump(&mut run.solver, &run.fed, &parameters);
        assert_eq!(
            refused.map_err(|error| error.to_string()),
            Err(message.to_owned())
        );
    }
}

/// Parts that close at the start meet there; those that lie or stick at the start began to do so before.
#[test]
fn an_impact_at_the_start_is_an_event_and_rest_is_none() {
    let stop = "[stops]\nbottom = { of = \"way\", min = 0, restitution = 0.5 }";
    let meets = EventKind::Impact { speed: 2.0 };
    // From 1 m/s upwards it is back after 2 v / g.
    let again = EventKind::Impact { speed: 1.0 };
    let run = |velocity| {
        Run::new(
            &parse(&slider(90.0, 0.0, velocity, stop)),
            TOLERANCE,
            Fed::default(),
        )
    };
    let mut falls = run(-2.0);
    let events = played(&mut falls, 2.5 / G, 3);
    assert_events(&events, &[(0.0, meets), (2.0 / G, again)]);
    assert_eq!(played(&mut run(0.0), 1.0, 3), []);
    let rubs = "[friction]\nrail = { of = \"way\", force = 0.5 }";
    let mut sticks = Run::new(
        &parse(&slider(0.0, 0.0, 0.0, rubs)),
        TOLERANCE,
        Fed::default(),
    );
    assert_eq!(played(&mut sticks, 1.0, 3), []);
}

/// Two stops at one place act as one, with the smaller restitution, whichever the file names first.
#[test]
fn two_stops_at_one_place_take_the_smaller_restitution() {
    for [first, second] in [[0.8, 0.2], [0.2, 0.8]] {
        let stops = format!(
            "[stops]\none = {{ of = \"way\", min = 0, restitution = {first} }}\n\
             other = {{ of = \"way\", min = 0, restitution = {second} }}"
        );
        let text = slider(0.0, 1.0, -2.0, &stops);
        let mut run = Run::new(&parse(&text), TOLERANCE, Fed::default());
        played(&mut run, 1.0, 3);
        // It is there after half a second, and goes back with a fifth of its speed.
        for (value, truth) in run.state().into_iter().zip([0.2, 0.4]) {
            assert_near(value, truth);
        }
    }
}
