//! Contacts of shapes in free motion, against closed forms.

use std::fmt::Write as _;

use biela::dynamics::{Event, EventKind};

use super::events::{assert_near, played};
use super::run::{Fed, Run};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
const G: f64 = 9.81;

/// A body that moves freely, with places, velocities, mass, inertia, markers and shapes.
struct Free<'a> {
    name: &'a str,
    q: [f64; 3],
    p: [f64; 3],
    mass: f64,
    inertia: f64,
    markers: &'a str,
    shapes: &'a str,
}

/// A disc at rest at the origin.
const DISC: Free<'static> = Free {
    name: "disc",
    q: [0.0; 3],
    p: [0.0; 3],
    mass: 1.0,
    inertia: 0.005,
    markers: "",
    shapes: "rim = { disc = 'O', radius = 0.1 }",
};

/// A file with shapes of ground, bodies and contacts.
fn file(ground: &str, bodies: &[Free<'_>], more: &str) -> String {
    let mut text = format!("format = 1\nname = 'free'\n{ground}\n");
    let mut freedoms = String::from("[freedoms]\n");
    for Free {
        name,
        q,
        p,
        mass,
        inertia,
        markers,
        shapes,
    } in bodies
    {
        let _ = write!(
            text,
            "[bodies.{name}]\nmass = {mass}\ninertia = {inertia}\nestimate = [{}, {}, {}]\n\
             markers = {{ O = [0, 0], {markers} }}\n[bodies.{name}.shapes]\n{shapes}\n",
            q[0], q[1], q[2]
        );
        for (k, kind) in ["x", "y", "angle"].into_iter().enumerate() {
            let _ = writeln!(
                freedoms,
                "{name}_{kind} = {{ coordinate = '{kind}', markers = ['ground.Z', '{name}.O'], \
                 start = {}, velocity = {} }}",
                q[k], p[k]
            );
        }
    }
    text + &freedoms + more
}

const FLOOR: &str = "[ground.markers]\nZ = [0, 0]\nL = [-5, 0]\nR = [5, 0]\n[ground.shapes]\n\
                     floor = { wall = ['R', 'L'], depth = 0.05 }";

fn impacts(events: &[Event]) -> Vec<f64> {
    let impacts = events.iter();
    let impacts = impacts.filter(|event| matches!(event.kind, EventKind::Impact { .. }));
    impacts.map(|event| event.time).collect()
}

fn run(text: &str) -> Run {
    Run::new(&parse(text), TOLERANCE, Fed::default())
}

/// A disc bounces down a slope of 30° and comes to rest on it after 2 v / (g cos 30° (1 − e)).
#[test]
fn a_disc_bounces_down_a_slope() {
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let ground = format!(
        "[ground.markers]\nZ = [0, 0]\nL = [{}, {}]\nR = [{}, {}]\n[ground.shapes]\n\
         slope = {{ wall = ['R', 'L'], depth = 0.05 }}",
        -20.0 * cos,
        20.0 * sin,
        20.0 * cos,
        -20.0 * sin
    );
    let disc = Free {
        q: [0.6 * sin, 0.6 * cos, 0.0],
        ..DISC
    };
    let more = "[contacts]\nhit = { shapes = ['disc.rim', 'ground.slope'], restitution = 0.6 }";
    let text = file(&ground, &[disc], more);
    for steps in [1, 50] {
        let mut run = run(&text);
        let events = played(&mut run, 2.0, steps);
        let (fall, speed) = ((1.0 / (G * cos)).sqrt(), (G * cos).sqrt());
        let mut time = fall;
        for (k, found) in impacts(&events).into_iter().enumerate() {
            assert!((found - time).abs() < 1e-9, "{k}: {found} {time}");
            time += 2.0 * speed * 0.6_f64.powi(k as i32 + 1) / (G * cos);
        }
        let last = events.last().expect("it comes to rest");
        assert_eq!(last.kind, EventKind::Rests);
        assert!((last.time - 4.0 * fall).abs() < 1e-9, "{last:?}");
        let way = 0.5 * G * sin * 4.0;
        let state = run.state();
        let truth = [way * cos + 0.1 * sin, -way * sin + 0.1 * cos, 0.0];
        for (found, truth) in state.iter().zip(truth) {
            assert!(
                (found - truth).abs() < 1e-9 * (1.0 + way),
                "{state:?} {truth:?}"
            );
        }
    }
}

/// A disc rests in a groove of 90° on two places of one contact.
#[test]
fn a_disc_rests_in_a_groove() {
    let ground = "[ground.markers]\nZ = [0, 0]\nL = [-1, 1]\nR = [1, 1]\n[ground.shapes]\n\
                  groove = { wall = ['R', 'Z', 'L'], depth = 0.05 }";
    let disc = |height: f64| Free {
        q: [0.0, 0.1 * 2_f64.sqrt() + height, 0.0],
        ..DISC
    };
    let more = "[contacts]\nhit = { shapes = ['disc.rim', 'ground.groove'] }";
    let mut still = run(&file(ground, &[disc(0.0)], more));
    assert!(played(&mut still, 1.0, 7).is_empty());
    assert!((still.state()[1] - 0.1 * 2_f64.sqrt()).abs() < 1e-13);
    let held = still.free.held();
    assert_eq!(held.len(), 1, "{held:?}");
    assert!(
        (held[0].size - 2.0 * G / 2_f64.sqrt()).abs() < 1e-10,
        "{held:?}"
    );
    let mut dropped = run(&file(ground, &[disc(0.3)], more));
    let events = played(&mut dropped, 1.0, 7);
    let fall = (0.6 / G).sqrt();
    let told = [EventKind::Impact { speed: 0.0 }, EventKind::Rests];
    assert_eq!(events.len(), 2, "{events:?}");
    for (event, told) in events.iter().zip(told) {
        assert!((event.time - fall).abs() < 1e-9, "{events:?}");
        assert_eq!(event.kind.as_str(), told.as_str());
    }
    for (found, truth) in dropped.state().iter().zip([0.0, 0.1 * 2_f64.sqrt(), 0.0]) {
        assert!((found - truth).abs() < 1e-12, "{:?}", dropped.state());
    }
}

fn block(half: [f64; 2], q: [f64; 3], outline: &str) -> String {
    let [b, a] = half;
    let markers = format!(
        "A = [{}, {}], B = [{b}, {}], C = [{b}, {a}], D = [{}, {a}], M = [0.01, {}]",
        -b, -a, -a, -b, -a
    );
    let shapes = format!("box = {{ outline = {outline} }}");
    let block = Free {
        name: "block",
        q,
        p: [0.0; 3],
        mass: 1.0,
        inertia: (a * a + b * b) / 3.0,
        markers: &markers,
        shapes: &shapes,
    };
    file(FLOOR, &[block], "")
}

const OUTLINES: [&str; 4] = [
    "['A', 'B', 'C', 'D']",
    "['D', 'C', 'B', 'A']",
    "['C', 'D', 'A', 'B']",
    "['A', 'M', 'B', 'C', 'D']",
];

/// A block that is dropped flat strikes with two corners at once.
#[test]
fn a_block_falls_flat() {
    for outline in OUTLINES {
        let text = block([0.2, 0.1], [0.0, 0.6, 0.0], outline)
            + "[contacts]\nhit = { shapes = ['block.box', 'ground.floor'], restitution = 0.5 }";
        let mut run = run(&text);
        let events = played(&mut run, 1.5, 4);
        let (fall, speed) = ((1.0 / G).sqrt(), G.sqrt());
        let mut time = fall;
        let impacts = impacts(&events);
        assert!(impacts.len() > 10, "{}", impacts.len());
        for (k, found) in impacts.into_iter().enumerate() {
            assert!((found - time).abs() < 1e-9, "{outline} {k}: {found} {time}");
            time += 2.0 * speed * 0.5_f64.powi(k as i32 + 1) / G;
        }
        let last = events.last().expect("it comes to rest");
        assert_eq!(last.kind, EventKind::Rests);
        assert!((last.time - 3.0 * fall).abs() < 1e-8, "{last:?}");
        for (found, truth) in run.state().iter().zip([0.0, 0.1, 0.0, 0.0, 0.0, 0.0]) {
            assert!((found - truth).abs() < 1e-12, "{outline} {:?}", run.state());
        }
    }
}

/// A block rocks from corner to corner without friction: each impact leaves 0.7 of its rate.
#[test]
fn a_block_rocks_to_rest() {
    let (b, a, phi) = (0.05_f64, 0.2_f64, 0.1_f64);
    let height = b * phi.sin() + a * phi.cos();
    for outline in [OUTLINES[1], OUTLINES[3]] {
        let text = block([b, a], [0.0, height, phi], outline)
            + "[contacts]\nhit = { shapes = ['ground.floor', 'block.box'] }";
        let mut run = run(&text);
        let events = played(&mut run, 0.6, 3);
        let told = [0.097_943_666, 0.212_626_682, 0.288_303_897, 0.339_968_730];
        for (found, truth) in impacts(&events).into_iter().zip(told) {
            assert!((found - truth).abs() < 2e-9, "{outline}: {found} {truth}");
        }
        let last = events.last().expect("it comes to rest");
        assert_eq!(last.kind, EventKind::Rests, "{outline}");
        assert!(
            (last.time - 0.458_453_384).abs() < 1e-6,
            "{outline} {last:?}"
        );
        for (found, truth) in run.state().iter().zip([0.0, a, 0.0, 0.0, 0.0, 0.0]) {
            assert!((found - truth).abs() < 1e-10, "{outline} {:?}", run.state());
        }
    }
}

/// A disc passes a post or bounces off it, whatever the rows.
#[test]
fn a_disc_meets_a_post_at_any_rows() {
    let ground = "[ground.markers]\nZ = [0, 0]\nP = [1, 0]\n[ground.shapes]\n\
                  post = { disc = 'P', radius = 0.01 }";
    for (y, steps) in [
        (0.0, 1),
        (0.0, 10),
        (0.02, 1),
        (0.02, 40),
        (-0.059, 1),
        (0.061, 1),
    ] {
        let disc = Free {
            q: [0.0, y, 0.0],
            p: [10.0, 0.0, 0.0],
            shapes: "rim = { disc = 'O', radius = 0.05 }",
            ..DISC
        };
        let more = "[contacts]\nhit = { shapes = ['disc.rim', 'ground.post'], restitution = 1 }\n\
                    [simulation]\ngravity = [0, 0]";
        let mut run = run(&file(ground, &[disc], more));
        let events = played(&mut run, 1.0, steps);
        let state = run.state();
        if y > 0.06 {
            assert!(events.is_empty(), "{events:?}");
            assert_near(state[0], 10.0);
            continue;
        }
        // The normal leads from the post's centre to the disc's.
        let n = [-(0.06_f64.powi(2) - y * y).sqrt() / 0.06, y / 0.06];
        let time = (1.0 + 0.06 * n[0]) / 10.0;
        assert_eq!(events.len(), 1, "{y} {steps}: {events:?}");
        assert!((events[0].time - time).abs() < 1e-9, "{events:?}");
        let normal = 10.0 * n[0];
        let v = [10.0 - 2.0 * normal * n[0], -2.0 * normal * n[1]];
        let rest = 1.0 - time;
        let truth = [
            10.0 * time + v[0] * rest,
            y + v[1] * rest,
            0.0,
            v[0],
            v[1],
            0.0,
        ];
        for (found, truth) in state.iter().zip(truth) {
            assert!(
                (found - truth).abs() < 1e-8 * (1.0 + truth.abs()),
                "{state:?} {truth:?}"
            );
        }
    }
}

/// Two capsules that turn meet in flight: without gravity their momentum, and the sum of their moments of
/// momentum, stay; at a restitution of 1 the energy does.
#[test]
fn two_capsules_meet_in_flight() {
    let ground = "[ground.markers]\nZ = [0, 0]";
    let capsule = |name, q: [f64; 3], p: [f64; 3], mass: f64| Free {
        name,
        q,
        p,
        mass,
        inertia: 0.01 * mass,
        markers: "S = [-0.2, 0], T = [0.3, 0.05]",
        shapes: "side = { bar = ['S', 'T'], radius = 0.04 }",
    };
    for (shapes, e) in [
        ("['one.side', 'other.side']", 1.0),
        ("['other.side', 'one.side']", 1.0),
        ("['one.side', 'other.side']", 0.4),
    ] {
        let bodies = [
            capsule("one", [0.0, 0.0, 0.2], [0.5, 0.3, 2.0], 1.0),
            capsule("other", [0.1, 0.5, -0.4], [0.0, -0.8, 1.0], 2.5),
        ];
        let more = format!(
            "[contacts]\nhit = {{ shapes = {shapes}, restitution = {e} }}\n\
             [simulation]\ngravity = [0, 0]"
        );
        let mut run = run(&file(ground, &bodies, &more));
        let momentum = |run: &Run| {
            let [q, p, _] = run.freedoms();
            let mut sum = [0.0; 4];
            for (k, mass) in [1.0, 2.5].into_iter().enumerate() {
                let [x, y, vx, vy, w] =
                    [q[3 * k], q[3 * k + 1], p[3 * k], p[3 * k + 1], p[3 * k + 2]];
                sum[0] += mass * vx;
                sum[1] += mass * vy;
                sum[2] += mass * (x * vy - y * vx) + 0.01 * mass * w;
                sum[3] += 0.5 * mass * (vx * vx + vy * vy + 0.01 * w * w);
            }
            sum
        };
        let before = momentum(&run);
        let events = played(&mut run, 1.0, 3);
        let after = momentum(&run);
        assert!(!impacts(&events).is_empty(), "{events:?}");
        for k in 0..3 {
            assert!((after[k] - before[k]).abs() < 1e-12, "{before:?} {after:?}");
        }
        if e > 0.9 {
            assert!((after[3] - before[3]).abs() < 1e-11, "{before:?} {after:?}");
        } else {
            assert!(after[3] < before[3]);
        }
    }
}

/// A disc falls on an elastic floor: within it, y = −g/ω² (1 − cos ωt) − v/ω sin ωt.
#[test]
fn a_disc_bounces_on_an_elastic_floor() {
    let disc = Free {
        q: [0.0, 0.3, 0.0],
        mass: 2.0,
        ..DISC
    };
    let more = "[contacts]\nhit = { shapes = ['disc.rim', 'ground.floor'], stiffness = 8e3 }";
    let text = file(FLOOR, &[disc], more);
    let (omega, fall) = (4e3_f64.sqrt(), (0.4 / G).sqrt());
    let v = G * fall;
    // It leaves where y = 0 again: tan(ωt/2) = −v ω / g.
    let within = 2.0 / omega * (std::f64::consts::PI - (v * omega / G).atan());
    let period = 2.0 * fall + within;
    for steps in [1, 60] {
        let mut run = run(&text);
        let events = played(&mut run, 2.0 * period + 0.7 * fall, steps);
        let kinds: Vec<&str> = events.iter().map(|event| event.kind.as_str()).collect();
        assert_eq!(kinds, ["impact", "leaves", "impact", "leaves"]);
        for (k, event) in events.iter().enumerate() {
            let truth = (k / 2) as f64 * period + fall + (k % 2) as f64 * within;
            assert!((event.time - truth).abs() < 1e-9, "{event:?} {truth}");
        }
        let height = 0.3 - 0.5 * G * (0.7 * fall).powi(2);
        assert!((run.state()[1] - height).abs() < 1e-9, "{:?}", run.state());
        assert!(run.energy_error < 1e-9, "{}", run.energy_error);
    }
}

/// A ratchet wheel of `teeth` teeth with a pawl that a spring presses on it, whose nose has this radius.
fn ratchet(teeth: usize, nose: f64, more: &str) -> String {
    let (mut markers, mut outline) = (String::new(), Vec::new());
    for k in 0..teeth {
        let angle = std::f64::consts::TAU * k as f64 / teeth as f64;
        let (sin, cos) = angle.sin_cos();
        for (name, radius) in [("r", 0.08), ("t", 0.1)] {
            let _ = write!(
                markers,
                ", {name}{k} = [{}, {}]",
                radius * cos,
                radius * sin
            );
            outline.push(format!("'{name}{k}'"));
        }
    }
    let outline = outline.join(", ");
    format!(
        "format = 1\nname = 'ratchet'\n[ground.markers]\nO = [0, 0]\nP = [0.1, 0.12]\n\
         [bodies.wheel]\nmass = 1\ninertia = 0.005\nmarkers = {{ O = [0, 0]{markers} }}\n\
         shapes.rim = {{ outline = [{outline}], fillet = 0.001 }}\n\
         [bodies.pawl]\nmass = 0.1\ninertia = 1e-4\ncenter = [0.04, 0]\n\
         estimate = [0.1, 0.12, -2.4]\nmarkers = {{ P = [0, 0], T = [0.08, 0] }}\n\
         shapes.nose = {{ disc = 'T', radius = {nose} }}\n\
         [joints]\naxle = {{ type = 'revolute', markers = ['ground.O', 'wheel.O'] }}\n\
         pin = {{ type = 'revolute', markers = ['ground.P', 'pawl.P'] }}\n\
         [freedoms]\n\
         turn = {{ coordinate = 'angle', markers = ['ground.O', 'wheel.O'], start = 0.1, velocity = 6 }}\n\
         swing = {{ coordinate = 'angle', markers = ['ground.P', 'pawl.P'], start = -1.5 }}\n\
         [forces]\npress = {{ coordinate = 'angle', markers = ['ground.P', 'pawl.P'], \
         stiffness = 0.5, free = -2.9 }}\n\
         [contacts]\ntooth = {{ shapes = ['pawl.nose', 'wheel.rim']{more} }}\n"
    )
}

/// The nose never enters the wheel, whatever the rows and the teeth, and no energy appears.
#[test]
fn a_pawl_stays_outside_its_ratchet() {
    for (teeth, nose, rows) in [(8, 0.004, [1, 3, 20]), (6, 0.001, [1, 2, 5])] {
        for steps in rows {
            let mut run = run(&ratchet(teeth, nose, ", restitution = 0.2"));
            let shapes = run.solver.mechanism().stops[0].coordinate.shapes();
            let shapes = shapes.expect("it is a contact");
            let mut events = Vec::new();
            for step in 1..=steps {
                run.to(0.1 * f64::from(step) / f64::from(steps));
                events.extend(run.free.events());
                let (clearance, _) = run.solver.clearance(shapes).expect("they have features");
                assert!(clearance > -1e-12, "{teeth} {steps}: {clearance} at {step}");
            }
            assert!(events.len() > 2, "{events:?}");
            assert!(run.energy_error < 1e-9, "{}", run.energy_error);
        }
    }
}

/// A driven plate presses a disc against a wall: the motion ends there, and both contacts are told.
#[test]
fn what_is_squeezed_ends_the_motion() {
    for guided in [false, true] {
        let guide = if guided {
            "[constraints]\nlevel = { coordinate = 'y', markers = ['ground.Z', 'disc.O'], value = 0 }\n\
             straight = { coordinate = 'angle', markers = ['ground.Z', 'disc.O'], value = 0 }\n"
        } else {
            ""
        };
        let freedoms = if guided {
            "x = { coordinate = 'x', markers = ['ground.Z', 'disc.O'], start = 0.3 }"
        } else {
            "x = { coordinate = 'x', markers = ['ground.Z', 'disc.O'], start = 0.3 }\n\
             y = { coordinate = 'y', markers = ['ground.Z', 'disc.O'], start = 0 }\n\
             turn = { coordinate = 'angle', markers = ['ground.Z', 'disc.O'], start = 0 }"
        };
        let text = format!(
            "format = 1\nname = 'press'\n[ground.markers]\nZ = [0, 0]\nU = [1, 1]\nD = [1, -1]\n\
             [ground.shapes]\nwall = {{ wall = ['U', 'D'], depth = 0.1 }}\n\
             [bodies.plate]\nmarkers = {{ O = [0, 0], A = [0, -0.5], B = [0, 0.5] }}\n\
             shapes.face = {{ bar = ['A', 'B'], radius = 0.05 }}\n\
             [bodies.disc]\nmass = 1\ninertia = 0.01\nestimate = [0.3, 0, 0]\n\
             markers = {{ O = [0, 0] }}\nshapes.rim = {{ disc = 'O', radius = 0.1 }}\n\
             [joints]\nslide = {{ type = 'translational', markers = ['ground.Z', 'plate.O'] }}\n\
             {guide}[drivers]\n\
             push = {{ coordinate = 'x', markers = ['ground.Z', 'plate.O'], motion = '0.5*t' }}\n\
             [freedoms]\n{freedoms}\n[contacts]\n\
             front = {{ shapes = ['plate.face', 'disc.rim'] }}\n\
             back = {{ shapes = ['disc.rim', 'ground.wall'] }}\n[simulation]\ngravity = [0, 0]\n"
        );
        let mut run = run(&text);
        let error = run
            .try_to(3.0)
            .expect_err("the disc is squeezed")
            .to_string();
        for name in ["`front`", "`back`"] {
            assert!(error.contains(name), "{error}");
        }
        assert!(error.contains("1.5"), "{error}");
    }
}

fn table(radius: f64) -> String {
    format!(
        "[ground.markers]\nZ = [0, 0]\nL = [-2, 0]\nD = [0, -2]\n[ground.shapes]\n\
         table = {{ wall = ['D', 'Z', 'L'], depth = {radius} }}"
    )
}

/// A disc slides over the round edge of a table, and leaves it where v² = g r cos of the slope.
#[test]
fn a_disc_slides_over_an_edge() {
    let disc = Free {
        q: [-0.3031, 0.1, 0.0],
        p: [0.5, 0.0, 0.0],
        ..DISC
    };
    let more = "[contacts]\nhit = { shapes = ['disc.rim', 'ground.table'] }";
    let text = file(&table(0.05), &[disc], more);
    for steps in [1, 23] {
        let mut run = run(&text);
        let events = played(&mut run, 0.8, steps);
        assert_eq!(events.len(), 1, "{events:?}");
        assert_eq!(events[0].kind, EventKind::Leaves);
        assert!((events[0].time - 0.676_785_312).abs() < 1e-9, "{events:?}");
        let r = 0.15;
        // v² = v₀² + 2 g r (1 − cos), and v² = g r cos.
        let cos = (0.25 + 2.0 * G * r) / (3.0 * G * r);
        let (sin, speed) = ((1.0 - cos * cos).sqrt(), (G * r * cos).sqrt());
        let t = 0.8 - events[0].time;
        let truth = [
            -0.05 + r * sin + speed * cos * t,
            -0.05 + r * cos - speed * sin * t - 0.5 * G * t * t,
        ];
        for (found, truth) in run.state().iter().zip(truth) {
            assert!((found - truth).abs() < 1e-9, "{:?} {truth:?}", run.state());
        }
    }
}

/// A block slides over the edge of a table, tips on it and leaves it, against an integration in minimal
/// coordinates by SciPy.
#[test]
fn a_block_slides_over_an_edge() {
    let block = Free {
        name: "block",
        q: [-0.5017, 0.1, 0.0],
        p: [0.5, 0.0, 0.0],
        mass: 2.0,
        inertia: 2.0 * (0.4 * 0.4 + 0.2 * 0.2) / 12.0,
        markers: "A = [-0.2, -0.1], B = [0.2, -0.1], C = [0.2, 0.1], D = [-0.2, 0.1]",
        shapes: "box = { outline = ['A', 'B', 'C', 'D'] }",
    };
    let more = "[contacts]\nhit = { shapes = ['block.box', 'ground.table'] }";
    let mut run = run(&file(&table(0.005), &[block], more));
    let events = played(&mut run, 1.6, 1);
    let last = events.last().expect("it leaves");
    assert_eq!(events.len(), 1, "{events:?}");
    assert!((last.time - 1.272_554_311).abs() < 2e-9, "{last:?}");
    let truth = [0.363_953_765_6, -0.859_953_360_4, -2.048_679_261_8];
    for (found, truth) in run.state().iter().zip(truth) {
        assert!((found - truth).abs() < 1e-8, "{:?} {truth:?}", run.state());
    }
}
