//! Static equilibrium and linear equations on stops and with friction, against closed forms and against the
//! potential energy of four-bars, written apart.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use biela::dynamics::{Equilibrium, FreeMotion, StateSpace};
use biela::kinematics::{Solution, Solver};
use biela::mechanism::Mechanism;

use super::chains::{Random, chain};
use super::events::{pendulum, slider};
use super::run::Fed;
use crate::common::{assembled, parse};

const G: f64 = 9.81;
/// Error of a place and of a force relative to 1 + |value|: the steps end at 1e-13, and forces lose some
/// digits by the condition of the joints.
const MARK: f64 = 1e-10;

/// A mechanism at its start, at rest.
struct Still {
    mechanism: Arc<Mechanism>,
    solver: Solver,
    solution: Solution,
    free: FreeMotion,
}

impl Still {
    fn new(text: &str) -> Self {
        let mechanism = parse(text);
        let (mut solver, _) = assembled(&mechanism);
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        let free = FreeMotion::new(&solver, 1e-8).expect("a tolerance");
        let mut free = free.expect("it has freedoms");
        free.start(&mut solver, &Fed::default())
            .expect("it can start");
        free.tell(&mut solution);
        Self {
            mechanism,
            solver,
            solution,
            free,
        }
    }

    fn balance(&mut self) -> Equilibrium {
        let Self {
            solver,
            solution,
            free,
            ..
        } = self;
        let found = free.balance(solver, solution, &Fed::default());
        found.unwrap_or_else(|error| panic!("{error}"))
    }

    fn balances(&mut self) -> Vec<Equilibrium> {
        let Self {
            solver,
            solution,
            free,
            ..
        } = self;
        let found = free.balances(solver, solution, &Fed::default());
        found.unwrap_or_else(|error| panic!("{error}"))
    }

    fn linearize(&mut self) -> StateSpace {
        let Self {
            solver,
            solution,
            free,
            ..
        } = self;
        let space = free.linearize(solver, solution, &[]);
        space.unwrap_or_else(|error| panic!("{error}"))
    }

    /// Asserts the values of the drivers, and name and size of all that holds.
    fn assert_at(&self, found: &Equilibrium, drivers: &[f64], held: &[(&str, f64)]) {
        assert_eq!(found.drivers.len(), drivers.len());
        for (found, expected) in found.drivers.iter().zip(drivers) {
            assert_near(*found, *expected);
        }
        let names = found.held.iter().map(|held| held.name(&self.mechanism));
        let expected = held.iter().map(|(name, _)| *name);
        assert!(
            names.clone().eq(expected),
            "{:?}",
            names.collect::<Vec<_>>()
        );
        for (found, (_, force)) in found.held.iter().zip(held) {
            assert_near(found.size, *force);
        }
    }
}

fn assert_near(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(error <= MARK * (1.0 + expected.abs()), "{found} {expected}");
}

#[test]
fn a_rod_rests_on_a_stop() {
    // m g a cos(30°) about the pin.
    let torque = G * 0.5 * (PI / 6.0).cos();
    let stop = "[stops]\nlow = { of = \"swing\", min = \"-30*deg\" }";
    let mut rod = Still::new(&pendulum(stop));
    let found = rod.balance();
    rod.assert_at(&found, &[-PI / 6.0], &[("low", torque)]);
}

#[test]
fn a_slider_rests_on_a_stop() {
    let stop = "[stops]\nlow = { of = \"way\", min = 0.2, max = 50 }";
    for start in [0.2, 0.3, 40.0] {
        let mut block = Still::new(&slider(30.0, start, 0.0, stop));
        let found = block.balance();
        block.assert_at(&found, &[0.2], &[("low", 2.0 * G * 0.5)]);
    }
}

/// An elastic stop yields by m g / k.
#[test]
fn a_slider_rests_on_an_elastic_stop() {
    let stop = "[stops]\nlow = { of = \"way\", min = 0.2, stiffness = 1e7 }";
    let mut block = Still::new(&slider(90.0, 1.0, 0.0, stop));
    let found = block.balance();
    block.assert_at(&found, &[0.2 - 2.0 * G / 1e7], &[("low", 2.0 * G)]);
}

/// Two weights one on the other, on the ground.
#[test]
fn two_weights_rest_on_each_other() {
    let mut pile = Still::new(
        r#"
format = 1
name = "pile"
ground.markers = { O = [0, 0, "90*deg"] }
bodies.a = { mass = 2, markers = { P = [0, 0, "90*deg"] } }
bodies.b = { mass = 3, estimate = [0, 3, 0], markers = { P = [0, 0, "90*deg"] } }
joints.g = { type = "translational", markers = ["ground.O", "a.P"] }
joints.h = { type = "translational", markers = ["ground.O", "b.P"] }
freedoms.u = { coordinate = "x", markers = ["ground.O", "a.P"], start = 1.5 }
freedoms.v = { coordinate = "x", markers = ["ground.O", "b.P"], start = 3 }
stops.base = { of = "u", min = 0.2 }
stops.pile = { coordinate = "x", markers = ["a.P", "b.P"], min = 0.5 }
"#,
    );
    let found = pile.balance();
    pile.assert_at(&found, &[0.2, 0.7], &[("base", 5.0 * G), ("pile", 3.0 * G)]);
}

/// A ball that a spring draws sideways along a floor: it stays on the floor, and slides on it to where the
/// spring is free.
#[test]
fn a_ball_slides_along_a_stop() {
    let mut ball = Still::new(
        r#"
format = 1
name = "ball"
ground.markers = { O = [0, 0] }
bodies.ball = { mass = 2, inertia = 1, markers = { P = [0, 0] } }
constraints.upright = { coordinate = "angle", markers = ["ground.O", "ball.P"], value = 0 }
freedoms.x = { coordinate = "x", markers = ["ground.O", "ball.P"], start = 1 }
freedoms.y = { coordinate = "y", markers = ["ground.O", "ball.P"], start = 1 }
stops.base = { of = "y", min = 0.1 }
forces.spring = { coordinate = "x", markers = ["ground.O", "ball.P"], stiffness = 3, free = 0.4 }
"#,
    );
    let found = ball.balance();
    ball.assert_at(&found, &[0.4, 0.1], &[("base", 2.0 * G)]);
}

/// A weight on a vertical guide hangs at a rope of 1.3 m from a point 0.3 m beside the guide, 2 m up.
#[test]
fn a_weight_hangs_at_a_rope() {
    let height = 2.0 - (1.3_f64 * 1.3 - 0.09).sqrt();
    let tension = 2.0 * G * 1.3 / (2.0 - height);
    let mut weight = Still::new(
        r#"
format = 1
name = "weight"
ground.markers = { O = [0, 0, "90*deg"], A = [0.3, 2] }
bodies.a = { mass = 2, markers = { P = [0, 0, "90*deg"] } }
joints.g = { type = "translational", markers = ["ground.O", "a.P"] }
joints.r = { type = "rope", markers = ["ground.A", "a.P"], length = 1.3, unilateral = true }
freedoms.u = { coordinate = "x", markers = ["ground.O", "a.P"], start = 1.5 }
"#,
    );
    let found = weight.balance();
    assert_near(found.drivers[0], height);
    assert_near(found.held[0].size.abs(), tension);
    let told = found.held[0].describe(&weight.mechanism);
    assert!(told.starts_with("rope `r` is taut, 20.16"), "{told}");
}

/// A tappet rests on an eccentric disc of 0.1 m whose centre is 0.04 m from the shaft, at an angle: the
/// disc's highest point is 0.1 m above its centre.
#[test]
fn a_tappet_rests_on_its_cam() {
    let angle = 0.7_f64;
    let mut tappet = Still::new(&format!(
        r#"
format = 1
name = "tappet"
ground.markers = {{ O = [0, 0], G = [0, 0, "90*deg"] }}
bodies.cam = {{ mass = 1, inertia = 1, markers = {{ O = [0, 0] }} }}
bodies.tap = {{ mass = 2, estimate = [0, 0.3, 0], markers = {{ P = [0, 0], G = [0, 0, "90*deg"] }} }}
joints.shaft = {{ type = "revolute", markers = ["ground.O", "cam.O"] }}
joints.guide = {{ type = "translational", markers = ["ground.G", "tap.G"] }}
joints.disc = {{ type = "cam", markers = ["cam.O", "tap.P"], follower = "flat", profile = "0.04*cos(theta) + sqrt(0.01 - 0.0016*sin(theta)^2)", unilateral = true }}
drivers.turn = {{ coordinate = "angle", markers = ["ground.O", "cam.O"], motion = "{angle}" }}
freedoms.lift = {{ coordinate = "x", markers = ["ground.G", "tap.G"], start = 0.3 }}
"#
    ));
    let found = tappet.balance();
    assert_near(found.drivers[1], 0.1 + 0.04 * angle.sin());
    assert_near(found.held[0].size.abs(), 2.0 * G);
}

/// A rod between two stops beyond the top: it rests on the one or the other.
#[test]
fn all_stops_that_bear_are_found() {
    for (least, most, start) in [(-30.0_f64, 200.0_f64, 20.0), (60.0, 110.0, 88.0)] {
        let text = pendulum(&format!(
            "[stops]\nends = {{ of = \"swing\", min = \"{least}*deg\", max = \"{most}*deg\" }}"
        ));
        let mut rod = Still::new(&text.replace("start = 0", &format!("start = \"{start}*deg\"")));
        let mut found = rod.balances();
        found.sort_by(|a, b| a.drivers[0].total_cmp(&b.drivers[0]));
        assert_eq!(found.len(), 2, "{found:?}");
        for (found, end) in found.iter().zip([least, most].map(f64::to_radians)) {
            rod.assert_at(found, &[end], &[("ends", G * 0.5 * end.cos())]);
        }
    }
}

/// Friction holds a block on a slope up to its limit; two of them share the force.
#[test]
fn friction_keeps_a_start_that_it_holds() {
    let weight = 2.0 * G * 0.5;
    let spring = "[forces]\ns = { coordinate = \"x\", markers = [\"ground.O\", \"slider.P\"], stiffness = 100, free = 0 }\n";
    for (limits, holds) in [
        (vec![9.9], true),
        (vec![9.7], false),
        (vec![5.0, 4.9], true),
        (vec![5.0, 4.7], false),
    ] {
        let frictions = limits
            .iter()
            .enumerate()
            .map(|(k, limit)| format!("f{k} = {{ of = \"way\", force = {limit} }}\n"));
        let parts = format!("{spring}[friction]\n{}", frictions.collect::<String>());
        let mut block = Still::new(&slider(30.0, 0.0, 0.0, &parts));
        let found = block.balance();
        if holds {
            assert_near(found.drivers[0], 0.0);
            let sum: f64 = found.held.iter().map(|held| held.size).sum();
            assert_near(sum, weight);
            for (held, limit) in found.held.iter().zip(&limits) {
                assert!(
                    held.size.abs() <= *limit && held.limit == Some(*limit),
                    "{held:?}"
                );
            }
            assert!(found.left_out.is_empty());
        } else {
            block.assert_at(&found, &[-weight / 100.0], &[]);
            assert_eq!(found.left_out.len(), limits.len());
        }
    }
}

/// Friction that is left out takes no share of a stop's force.
#[test]
fn friction_that_is_left_out_bears_nothing() {
    let parts =
        "[stops]\nlow = { of = \"way\", min = 0 }\n[friction]\nf = { of = \"way\", force = 4 }";
    let mut block = Still::new(&slider(30.0, 1.0, 0.0, parts));
    let found = block.balance();
    block.assert_at(&found, &[0.0], &[("low", 2.0 * G * 0.5)]);
    assert_eq!(found.left_out.len(), 1);
}

/// A cart of 2 kg with a rod of 1 kg, 0.5 m long to its centre, I = 0.1 kg.m2.
fn cart(turn: &str, friction: &str) -> String {
    format!(
        r#"
format = 1
name = "cart"
ground.markers = {{ O = [0, 0] }}
bodies.cart = {{ mass = 2, markers = {{ O = [0, 0] }} }}
bodies.rod = {{ mass = 1, center = [0.5, 0], inertia = 0.1, markers = {{ O = [0, 0] }} }}
joints.rail = {{ type = "translational", markers = ["ground.O", "cart.O"] }}
joints.pin = {{ type = "revolute", markers = ["cart.O", "rod.O"] }}
freedoms.x = {{ coordinate = "x", markers = ["ground.O", "cart.O"] }}
freedoms.turn = {{ coordinate = "angle", markers = ["cart.O", "rod.O"], start = "{turn}" }}
{friction}
"#
    )
}

/// The cart stays where friction holds it while the rod comes down.
#[test]
fn friction_holds_a_part_of_the_mechanism() {
    let mut still = Still::new(&cart(
        "20*deg",
        "friction.rail_f = { of = \"x\", force = 30 }",
    ));
    let found = still.balance();
    still.assert_at(&found, &[0.0, -PI / 2.0], &[("rail_f", 0.0)]);
}

/// With the cart held, the rod swings alone with ω² = m g a / (I + m a²). Two zeros of A stand for the
/// cart. Without friction ω² = m g a (M + m) / ((I + m a²) (M + m) − m² a²).
#[test]
fn a_held_freedom_leaves_the_linear_equations() {
    let swings = |space: &StateSpace| {
        let roots = space.a.complex_eigenvalues();
        let squares = roots.iter().map(|root| root.im * root.im);
        squares.fold(0.0, f64::max)
    };
    let mut free = Still::new(&cart("-90*deg", ""));
    let space = free.linearize();
    assert!(space.held.is_empty());
    assert_near(swings(&space), G * 0.5 * 3.0 / (0.35 * 3.0 - 0.25));
    let mut held = Still::new(&cart(
        "-90*deg",
        "friction.rail_f = { of = \"x\", force = 3 }",
    ));
    let space = held.linearize();
    assert_eq!(space.held[0].name(&held.mechanism), "rail_f");
    let stiff = -G * 0.5 / 0.35;
    let expected = [
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, stiff, 0.0],
    ];
    for (row, expected) in expected.iter().enumerate() {
        for (column, expected) in expected.iter().enumerate() {
            assert_near(space.a[(row, column)], *expected);
        }
    }
}

/// A rod on a stop does not move.
#[test]
fn held_motions_are_impossible_in_linear_equations() {
    let stop = "[stops]\nlow = { of = \"swing\", min = 0 }";
    let space = Still::new(&pendulum(stop)).linearize();
    assert_eq!(space.held.len(), 1);
    assert!(space.a.amax() < MARK, "{}", space.a);
}

/// Two sliders side by side that friction ties together: what one does, the other does.
#[test]
fn a_coordinate_between_freedoms_is_held() {
    let mut two = Still::new(
        r#"
format = 1
name = "two"
ground.markers = { O = [0, 0] }
bodies.a = { mass = 2, markers = { P = [0, 0] } }
bodies.b = { mass = 3, markers = { P = [0, 0] } }
joints.g = { type = "translational", markers = ["ground.O", "a.P"] }
joints.h = { type = "translational", markers = ["ground.O", "b.P"] }
freedoms.u = { coordinate = "x", markers = ["ground.O", "a.P"] }
freedoms.v = { coordinate = "x", markers = ["ground.O", "b.P"] }
forces.s = { coordinate = "x", markers = ["ground.O", "a.P"], stiffness = 20, free = 0 }
friction.f = { coordinate = "x", markers = ["a.P", "b.P"], force = 5 }
"#,
    );
    let space = two.linearize();
    let roots = space.a.complex_eigenvalues();
    let square = roots
        .iter()
        .map(|root| root.im * root.im)
        .fold(0.0, f64::max);
    // The spring moves both.
    assert_near(square, 20.0 / 5.0);
    let zeros = roots.iter().filter(|root| root.norm() < 1e-6).count();
    assert_eq!(zeros, 2, "{roots}");
    // One velocity is that of both, the other counts for nothing.
    let sums = [1, 3].map(|column| space.a[(0, column)] + space.a[(2, column)]);
    assert_near(sums[0] + sums[1], 2.0);
    assert_near(sums[0] * sums[1], 0.0);
}

/// Rods with rigid and elastic stops and with friction along coordinates and in joints: set free at the
/// equilibrium, they stay there.
#[test]
fn random_chains_stay_where_they_balance() {
    for case in 0..60 {
        let text = chain(&mut Random::new(1000 + case));
        let mut still = Still::new(&text);
        let found = still.balance();
        let Still {
            solver,
            solution,
            free,
            ..
        } = &mut still;
        let moved = free.advance(solver, solution, &Fed::default(), 1.0);
        assert!(moved.is_ok(), "case {case}: {moved:?}\n{text}");
        for (now, then) in solver.pose().drivers.iter().zip(&found.drivers) {
            // Far above the error of a place, far below any motion that begins.
            assert!(
                (now - then).abs() < 1e-8,
                "case {case}: {now} {then}\n{text}"
            );
        }
    }
}

/// A crank-rocker by its lengths: crank a, coupler b, rocker c, base d.
struct FourBar {
    lengths: [f64; 4],
    masses: [f64; 3],
    centers: [[f64; 2]; 3],
    stiffness: f64,
    free: f64,
    anchor: [f64; 2],
    start: f64,
}

impl FourBar {
    /// Draws one whose crank turns fully (Grashof).
    fn random(random: &mut Random) -> Self {
        loop {
            let mut number = |least, most| random.between(least, most);
            let lengths = [
                number(0.2, 0.5),
                number(0.5, 1.2),
                number(0.5, 1.2),
                number(0.5, 1.2),
            ];
            let [a, b, c, d] = lengths;
            let longest = b.max(c).max(d);
            // Far enough from a change point.
            if 2.0 * (a + longest) > a + b + c + d - 0.1 {
                continue;
            }
            return Self {
                lengths,
                masses: [number(0.3, 2.0), number(0.3, 2.0), number(0.3, 2.0)],
                centers: lengths_of(&mut number, [a, b, c]),
                stiffness: number(1.0, 150.0),
                free: number(0.1, 1.8),
                anchor: [number(-1.0, 2.0), number(-2.0, 2.0)],
                start: number(-PI, PI),
            };
        }
    }

    /// Places and angles of the bodies for an angle of the crank.
    fn pose(&self, crank: f64) -> [[f64; 3]; 3] {
        let [a, b, c, d] = self.lengths;
        let [x, y] = [a * crank.cos(), a * crank.sin()];
        let (dx, dy) = (d - x, -y);
        let base = dx.hypot(dy);
        let along = (base * base + b * b - c * c) / (2.0 * base);
        let across = (b * b - along * along).sqrt();
        let [u, v] = [dx / base, dy / base];
        let [px, py] = [x + along * u - across * v, y + along * v + across * u];
        [
            [0.0, 0.0, crank],
            [x, y, (py - y).atan2(px - x)],
            [d, 0.0, py.atan2(px - d)],
        ]
    }

    /// Potential energy of weights and of the spring, which acts on the rocker's centre.
    fn energy(&self, crank: f64) -> f64 {
        let pose = self.pose(crank);
        let centers: Vec<[f64; 2]> = (pose.iter().zip(&self.centers))
            .map(|([x, y, phi], [u, v])| {
                [
                    x + phi.cos() * u - phi.sin() * v,
                    y + phi.sin() * u + phi.cos() * v,
                ]
            })
            .collect();
        let weights = self.masses.iter().zip(&centers);
        let [x, y] = centers[2];
        let length = (x - self.anchor[0]).hypot(y - self.anchor[1]);
        let stretch = length - self.free;
        weights.map(|(mass, [_, y])| mass * G * y).sum::<f64>()
            + 0.5 * self.stiffness * stretch * stretch
    }

    /// All minima of the energy over a turn of the crank: its angles from −π to π.
    fn minima(&self) -> Vec<f64> {
        const SAMPLES: usize = 20_000;
        let at = |k: usize| TAU * k as f64 / SAMPLES as f64 - PI;
        let is_low = |k: &usize| {
            let [before, here, after] = [at(*k) - TAU / SAMPLES as f64, at(*k), at(*k + 1)];
            let here = self.energy(here);
            here < self.energy(before) && here <= self.energy(after)
        };
        (0..SAMPLES).filter(is_low).map(at).collect()
    }

    /// Whether an angle of the crank is a minimum, to the resolution of the samples.
    fn has_minimum(&self, crank: f64) -> bool {
        let distance = |minimum: &f64| turned(crank - minimum).abs();
        self.minima().iter().any(|minimum| distance(minimum) < 1e-3)
    }

    fn file(&self, from: &str, to: &str) -> String {
        let [a, b, c, d] = self.lengths;
        let pose = self.pose(self.start);
        let [s, t] = self.anchor;
        let bodies = ["crank", "coupler", "rocker"].iter().zip([a, b, c]);
        let bodies = bodies.zip(&self.masses).zip(&self.centers).zip(&pose);
        let bodies: String = bodies
            .map(|((((name, length), mass), [u, v]), [x, y, phi])| {
                format!(
                    "[bodies.{name}]\nmass = {mass}\ninertia = 0.05\ncenter = [{u}, {v}]\n\
                     estimate = [{x}, {y}, {phi}]\n\
                     markers = {{ O = [0, 0], A = [{length}, 0], C = [{u}, {v}] }}\n"
                )
            })
            .collect();
        format!(
            r#"
format = 1
name = "four_bar"
[ground.markers]
O = [0, 0]
P = [{d}, 0]
S = [{s}, {t}]
{bodies}
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
A = {{ type = "revolute", markers = ["crank.A", "coupler.O"] }}
B = {{ type = "revolute", markers = ["coupler.A", "rocker.A"] }}
P = {{ type = "revolute", markers = ["ground.P", "rocker.O"] }}
[freedoms]
f = {{ coordinate = "angle", markers = ["{from}", "{to}"] }}
[forces]
spring = {{ coordinate = "distance", markers = ["ground.S", "rocker.C"], stiffness = {}, free = {} }}
"#,
            self.stiffness, self.free
        )
    }
}

/// Centres of mass on bodies of these lengths.
fn lengths_of(number: &mut impl FnMut(f64, f64) -> f64, lengths: [f64; 3]) -> [[f64; 2]; 3] {
    lengths.map(|length| [length * number(0.1, 0.9), number(-0.2, 0.2)])
}

/// The coordinates that may be the freedom.
const FREEDOMS: [(&str, &str); 4] = [
    ("ground.O", "crank.O"),
    ("ground.O", "coupler.O"),
    ("ground.P", "rocker.O"),
    ("coupler.A", "rocker.A"),
];

/// An angle between −π and π.
fn turned(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Rocker and coupler have dead points twice a turn: the equilibrium is the same for each freedom, and a
/// minimum of the energy.
#[test]
fn the_equilibrium_does_not_depend_on_the_freedom() {
    let mut random = Random::new(7);
    for case in 0..20 {
        let bars = FourBar::random(&mut random);
        let angles = FREEDOMS.map(|(from, to)| Still::new(&bars.file(from, to)).balance().q[2]);
        assert!(bars.has_minimum(angles[0]), "case {case}: {angles:?}");
        for angle in angles {
            // The energy is flat at its minimum: some roundings of forces over its curvature.
            assert!((angle - angles[0]).abs() < 1e-8, "case {case}: {angles:?}");
        }
    }
}

/// Once round there are all minima of the energy, for each freedom.
#[test]
fn all_equilibria_of_a_turn_are_found_for_each_freedom() {
    let mut random = Random::new(11);
    for case in 0..8 {
        let bars = FourBar::random(&mut random);
        let minima = bars.minima();
        for (from, to) in FREEDOMS {
            let found = Still::new(&bars.file(from, to)).balances();
            let angles: Vec<f64> = found.iter().map(|found| found.q[2]).collect();
            let is_found = |minimum: &f64| {
                let mut angles = angles.iter();
                angles.any(|angle| turned(angle - minimum).abs() < 1e-3)
            };
            assert!(
                minima.iter().all(is_found) && angles.iter().all(|angle| bars.has_minimum(*angle)),
                "case {case} {to}: {angles:?} {minima:?}"
            );
        }
    }
}
