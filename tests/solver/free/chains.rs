//! Random chains of rods with stops and friction: what must hold for any of them.

use std::fmt::Write as _;
use std::time::Instant;

use super::run::{Fed, Run};
use crate::common::parse;

/// Numbers from 0 to 1, the same in every run.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn number(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }
}

/// A chain of one to three rods that hangs from a slider or from ground, each joint with a stop, with
/// friction, with both or with neither.
pub(super) fn chain(random: &mut Random) -> String {
    let has_slider = random.number() < 0.5;
    let rods = 1 + (random.number() * 3.0) as usize;
    let mut bodies = String::new();
    let mut joints = String::new();
    let mut freedoms = String::new();
    let mut stops = String::new();
    let mut friction = String::new();
    let mut add_contacts = |random: &mut Random, name: &str, reach: f64| {
        if random.number() < 0.7 {
            let (low, high) = (random.between(-reach, -0.2), random.between(0.2, reach));
            let kind = if random.number() < 0.6 {
                format!("restitution = {:.2}", random.between(0.0, 0.9))
            } else {
                format!(
                    "stiffness = {:.1}, damping = {:.2}",
                    random.between(50.0, 2000.0),
                    random.between(0.0, 5.0)
                )
            };
            writeln!(
                stops,
                "stop_{name} = {{ of = \"{name}\", min = {low:.3}, max = {high:.3}, {kind} }}"
            )
            .expect("a string takes it");
        }
        let sticking = random.between(1.0, 1.5);
        if random.number() < 0.35 {
            let coulomb = random.between(0.01, 2.0);
            let sticking = coulomb * sticking;
            writeln!(friction, "friction_{name} = {{ of = \"{name}\", force = {coulomb:.3}, static = {sticking:.4} }}").expect("a string takes it");
        } else if random.number() < 0.6 {
            let coefficient = random.between(0.05, 0.4);
            let sticking = coefficient * sticking;
            let place = match name.strip_prefix("turn") {
                Some(rod) => format!(
                    "joint = \"pin{rod}\", radius = {:.3}",
                    random.between(0.005, 0.03)
                ),
                None => "joint = \"guide\"".to_owned(),
            };
            writeln!(friction, "friction_{name} = {{ {place}, coefficient = {coefficient:.3}, static = {sticking:.4} }}").expect("a string takes it");
        }
    };
    let mut last = "ground.O".to_owned();
    if has_slider {
        writeln!(
            bodies,
            "[bodies.slider]\nmass = {:.2}\nmarkers = {{ O = [0, 0] }}",
            random.between(0.5, 3.0)
        )
        .expect("a string takes it");
        writeln!(
            joints,
            "guide = {{ type = \"translational\", markers = [\"ground.O\", \"slider.O\"] }}"
        )
        .expect("a string takes it");
        writeln!(freedoms, "way = {{ coordinate = \"x\", markers = [\"ground.O\", \"slider.O\"], start = 0, velocity = {:.2} }}", random.between(-1.0, 1.0)).expect("a string takes it");
        add_contacts(random, "way", 0.6);
        last = "slider.O".to_owned();
    }
    for rod in 0..rods {
        let length = random.between(0.2, 0.8);
        writeln!(bodies, "[bodies.rod{rod}]\nmass = {:.2}\ninertia = {:.4}\ncenter = [{:.3}, 0]\nmarkers = {{ A = [0, 0], B = [{length:.3}, 0] }}", random.between(0.3, 2.0), random.between(0.005, 0.05), 0.5 * length).expect("a string takes it");
        writeln!(
            joints,
            "pin{rod} = {{ type = \"revolute\", markers = [\"{last}\", \"rod{rod}.A\"] }}"
        )
        .expect("a string takes it");
        writeln!(freedoms, "turn{rod} = {{ coordinate = \"angle\", markers = [\"{last}\", \"rod{rod}.A\"], start = {:.3}, velocity = {:.2} }}", random.between(-0.19, 0.19), random.between(-3.0, 3.0)).expect("a string takes it");
        add_contacts(random, &format!("turn{rod}"), 1.5);
        last = format!("rod{rod}.B");
    }
    format!(
        "format = 1\nname = \"chain\"\n[ground.markers]\nO = [0, 0]\n{bodies}[joints]\n{joints}[freedoms]\n{freedoms}[stops]\n{stops}[friction]\n{friction}"
    )
}

/// The energy is that of the work done, stops are not passed, and events come to no heap.
#[test]
fn chains_keep_their_balances() {
    for case in 0..12 {
        let mut random = Random::new(case);
        let text = chain(&mut random);

        let mut run = Run::new(&parse(&text), 1e-9, Fed::default());
        let begun = Instant::now();
        let mut events = 0;
        for step in 1..=10 {
            if let Err(error) = run.try_to(0.1 * f64::from(step)) {
                panic!("case {case}: {error}\n{text}");
            }
            events += run.free.events().count();
            let [values, ..] = run.freedoms();
            let mechanism = run.solver.mechanism();
            for stop in mechanism.stops.iter().filter(|stop| stop.is_rigid()) {
                let freedom = mechanism
                    .driver_id(stop.subject())
                    .expect("it is of a freedom");
                let value = values[freedom.index()];
                let [least, most] = stop.limits(&|id| run.solver.pose().parameters[id.index()]);
                assert!(
                    (least - 1e-12..=most + 1e-12).contains(&value),
                    "case {case}: {value} beyond {}\n{text}",
                    stop.name
                );
            }
        }
        assert!(
            run.energy_error < 1e-6,
            "case {case}: {}\n{text}",
            run.energy_error
        );
        assert!(events < 2000, "case {case}: {events} events\n{text}");
        // Far more than any takes, for what would not end.
        assert!(begun.elapsed().as_secs() < 60, "case {case}\n{text}");
    }
}

/// Two joints come to rest at once: one slides with less than it takes to move it, and the other sticks.
const GIVES_WAY: &str = r#"
format = 1
name = "chain"
[ground.markers]
O = [0, 0]
[bodies.slider]
mass = 2.42
markers = { O = [0, 0] }
[bodies.rod0]
mass = 0.75
inertia = 0.0197
center = [0.242, 0]
markers = { A = [0, 0], B = [0.485, 0] }
[bodies.rod1]
mass = 1.47
inertia = 0.0056
center = [0.350, 0]
markers = { A = [0, 0], B = [0.701, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "slider.O"] }
pin0 = { type = "revolute", markers = ["slider.O", "rod0.A"] }
pin1 = { type = "revolute", markers = ["rod0.B", "rod1.A"] }
[freedoms]
way = { coordinate = "x", markers = ["ground.O", "slider.O"], start = 0, velocity = -0.55 }
turn0 = { coordinate = "angle", markers = ["slider.O", "rod0.A"], start = 0.052, velocity = -0.45 }
turn1 = { coordinate = "angle", markers = ["rod0.B", "rod1.A"], start = -0.174, velocity = -0.74 }
[stops]
stop_way = { of = "way", min = -0.242, max = 0.454, stiffness = 1163.6, damping = 0.50 }
[friction]
f_way = { of = "way", force = 1.919, static = 2.8546 }
f_turn0 = { of = "turn0", force = 1.832, static = 2.6395 }
f_turn1 = { of = "turn1", force = 0.744, static = 0.8418 }
"#;

/// All comes to rest, with velocities whose squares are no numbers.
const RESTS: &str = r#"
format = 1
name = "chain"
[ground.markers]
O = [0, 0]
[bodies.slider]
mass = 1.94
markers = { O = [0, 0] }
[bodies.rod0]
mass = 0.62
inertia = 0.0225
center = [0.300, 0]
markers = { A = [0, 0], B = [0.599, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "slider.O"] }
pin0 = { type = "revolute", markers = ["slider.O", "rod0.A"] }
[freedoms]
way = { coordinate = "x", markers = ["ground.O", "slider.O"], start = 0, velocity = -0.47 }
turn0 = { coordinate = "angle", markers = ["slider.O", "rod0.A"], start = -0.099, velocity = 1.76 }
[stops]
stop_turn0 = { of = "turn0", min = -0.472, max = 0.417, restitution = 0.57 }
[friction]
f_way = { of = "way", force = 1.795, static = 2.2138 }
f_turn0 = { joint = "pin0", radius = 0.020, coefficient = 0.256, static = 0.3425 }
"#;

#[test]
fn chains_go_on_and_rest() {
    for text in [GIVES_WAY, RESTS] {
        let mut run = Run::new(&parse(text), 1e-9, Fed::default());
        run.to(2.0);
        assert!(run.free.events().count() < 100);
        assert!(run.energy_error < 1e-9, "{}", run.energy_error);
    }
}
