//! Forces at change points against those of the same motion on both sides.
//!
//! Each case draws a mechanism with a change point, masses and loads, and a motion through the
//! point. Far enough from the point, where the equations are regular, the reactions at six places of
//! the motion give a polynomial; at the point the solver's reactions agree with it, or are refused
//! because they grow without bound. Efforts and their derivatives exist in any case.

use std::sync::Arc;

use biela::kinematics::{Direction, Error, ForceParts, ForceQuantity, Path, Solution, Solver};
use biela::mechanism::{DriverId, Mechanism, Source};

use super::{Counts, Finding};
use crate::mutation::Chance;

/// Kinds of mechanisms with change points.
pub const FORCE_KINDS: [(&str, Draw); 4] = [
    ("parallelogram_with_masses", parallelogram),
    ("antiparallelogram_with_masses", antiparallelogram),
    ("equal_slider_crank_with_masses", equal_slider_crank),
    ("garage_door_with_masses", garage_door),
];

/// Draws a mechanism whose driver `u` comes to its change point at t = 0, from t = −1.
pub type Draw = fn(&mut Chance) -> String;

/// Time from one place to the next \[s\], motions being of the order of a radian per second. Nearer
/// places than those of the solver would have more rounding, farther ones less of the polynomial's
/// accuracy, 20 (APART/R)⁶ for a Taylor series that converges up to R = 0.3.
const APART: f64 = 8e-3;
const PLACES: [f64; 6] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0];
/// Weights of the polynomial of degree five through the places, at the point.
const WEIGHTS: [f64; 6] = [0.05, -0.3, 0.75, 0.75, -0.3, 0.05];
/// Largest difference at the point, in parts of the largest force.
const SAME: f64 = 1e-5;
/// Least growth of the largest reaction from the outer places to the inner ones, at a third of the
/// distance, where it is without bound.
const GROWS: f64 = 1.05;

/// Runs a number of cases of a kind, and reports each difference to `found`, with its seed.
pub fn run_forces(kind: usize, seed: u64, cases: u64, mut found: impl FnMut(u64, &str)) -> Counts {
    let mut counts = Counts::default();
    for case in seed..seed + cases {
        match try_forces(&force_case(kind, case)) {
            Ok((Finding::NotAssembled, _)) => counts.not_assembled += 1,
            Ok((_, is_refused)) => {
                counts.agree += 1;
                counts.stopped += u32::from(is_refused);
            }
            Err(words) => {
                counts.differ += 1;
                found(case, &words);
            }
        }
    }
    counts
}

/// Returns the mechanism file of a case.
#[must_use]
pub fn force_case(kind: usize, seed: u64) -> String {
    // Neighbouring seeds shall have nothing in common.
    let mut chance = Chance::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (FORCE_KINDS[kind].1)(&mut chance)
}

/// A mechanism on its motion.
struct Run {
    solver: Solver,
    path: Path,
    solution: Solution,
}

impl Run {
    fn go_to(&mut self, time: f64) -> Result<(), String> {
        self.solver.pose().set_path(&mut self.path);
        self.path.duration = time - self.path.start;
        let tracked = self.solver.track(&self.path);
        tracked.map_err(|blocked| format!("stops before {time}: {:?}", blocked.reason))?;
        self.solution.follow_motions(&self.solver);
        let solved = self.solution.solve_rates(&mut self.solver);
        solved.map_err(|error| format!("no rates at {time}: {error}"))
    }

    fn solve(&mut self, parts: ForceParts) -> Result<(), Error> {
        self.solution.solve_forces(&mut self.solver, parts)
    }

    /// Returns effort and bias, then all reactions.
    fn forces(&self) -> Vec<f64> {
        let joints = self.solver.mechanism().joints.len();
        let of_driver = [
            ForceQuantity::Effort(DriverId(0)),
            ForceQuantity::Bias(DriverId(0)),
            ForceQuantity::Inertia(DriverId(0)),
        ];
        let reactions = (0..joints).flat_map(|joint| (0..3).map(move |c| (joint, c)));
        let reactions = reactions.map(|(joint, c)| ForceQuantity::Reaction(joint, c));
        let all = of_driver.into_iter().chain(reactions);
        all.map(|quantity| self.solution.force(quantity)).collect()
    }

    /// Returns the derivative of the effort along the motion.
    fn slope(&mut self) -> Result<f64, Error> {
        let mut direction = Direction::zero(self.solver.mechanism());
        direction.time = 1.0;
        let changes = self.solution.force_changes(&mut self.solver, &direction)?;
        let changes = changes.expect("forces are sought");
        changes.change(ForceQuantity::Effort(DriverId(0)))
    }
}

/// Tries a case; returns whether the reactions at the point are refused.
///
/// # Errors
///
/// The difference, in words.
fn try_forces(text: &str) -> Result<(Finding, bool), String> {
    let source = Source::new("attack.toml", text);
    let mechanism = match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(problems) => panic!("{problems:#?}\n{text}"),
    };
    let path = Path::new(&mechanism);
    let Ok(solver) = Solver::assembled(mechanism, &path) else {
        return Ok((Finding::NotAssembled, false));
    };
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    let mut run = Run {
        solver,
        path,
        solution,
    };
    let mut around = Vec::new();
    let mut at = None;
    for (k, place) in PLACES.into_iter().enumerate() {
        if k == 3 {
            run.go_to(0.0)?;
            let efforts = ForceParts {
                efforts: true,
                reactions: false,
            };
            let solved = run.solve(efforts);
            solved.map_err(|error| format!("no efforts at the point: {error}"))?;
            let slope = run.slope().map_err(|error| format!("no slope: {error}"))?;
            let reactions = run.solve(ForceParts::ALL);
            at = Some((reactions, run.forces(), slope));
        }
        run.go_to(place * APART)?;
        let solved = run.solve(ForceParts::ALL);
        solved.map_err(|error| format!("no forces at {place}: {error}"))?;
        around.push(run.forces());
    }
    let (reactions, found, slope) = at.expect("the point is among the places");
    let largest = |forces: &[f64]| forces.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let scale = around
        .iter()
        .map(|forces| largest(forces))
        .fold(0.0, f64::max);
    let limit = |index: usize| -> f64 {
        let terms = around.iter().zip(WEIGHTS);
        terms.map(|(forces, weight)| weight * forces[index]).sum()
    };
    let is_refused = match reactions {
        Ok(()) => false,
        Err(Error::ChangePoint { .. }) => true,
        Err(error) => return Err(format!("refused: {error}")),
    };
    let compared = if is_refused { 3 } else { found.len() };
    for (index, value) in found.iter().take(compared).enumerate() {
        let off = (value - limit(index)).abs();
        if off.is_nan() || off > SAME * scale {
            let limit = limit(index);
            return Err(format!("force {index} is {value}, from both sides {limit}"));
        }
    }
    let efforts = around.iter().zip([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]);
    let difference: f64 = efforts.map(|(forces, weight)| weight * forces[0]).sum();
    let difference = difference / (60.0 * APART);
    let off = (slope - difference).abs();
    if off.is_nan() || off > 1e-3 * scale {
        return Err(format!(
            "the effort's slope is {slope}, by differences {difference}"
        ));
    }
    if is_refused {
        let inner = largest(&around[2][3..]).max(largest(&around[3][3..]));
        let outer = largest(&around[0][3..]).min(largest(&around[5][3..]));
        if inner < GROWS * outer {
            return Err(format!("refused, but from {outer} to {inner} only"));
        }
    }
    Ok((Finding::Agrees, is_refused))
}

/// Draws a motion through the value `point` at t = 0: straight, evenly accelerated or a sine.
fn motion(chance: &mut Chance, point: &str) -> String {
    let speed = chance.between(0.3, 1.2);
    match chance.below(3) {
        0 => format!("{point} + {speed}*t"),
        1 => format!("{point} + {speed}*t + {}*t^2", chance.between(-0.1, 0.1)),
        _ => format!("{point} + {speed}*sin(t)"),
    }
}

/// Draws the keys of a body's mass, with a comma before them: without a mass, with its centre on the
/// line of the pins, or anywhere. Without all but one mass reactions are often bounded.
fn mass(chance: &mut Chance, length: f64) -> String {
    let [mass, inertia] = [chance.between(0.5, 5.0), chance.between(0.01, 0.1)];
    let along = length * chance.between(-0.2, 1.0);
    let across = length * chance.between(-0.3, 0.3);
    match chance.below(4) {
        0 | 1 => String::new(),
        2 => format!(", mass = {mass}, inertia = {inertia}, center = [{along}, 0]"),
        _ => format!(", mass = {mass}, inertia = {inertia}, center = [{along}, {across}]"),
    }
}

fn gravity(chance: &mut Chance) -> &'static str {
    [
        "simulation.gravity = [0, 0]",
        "simulation.gravity = [0, -9.81]",
    ][chance.below(2)]
}

fn four_bar(chance: &mut Chance, anti: bool) -> String {
    let (a, b) = (chance.between(0.1, 0.3), chance.between(0.35, 0.6));
    let text = motion(chance, "pi");
    // At t = −1 the driver is short of pi; the exact angles are found from these estimates.
    let at: f64 = 2.4;
    let (x, y) = (a * at.cos(), a * at.sin());
    let (rocker, coupler) = if anti {
        // The diagonal from A to O4, and the triangle mirrored on it.
        let (dx, dy) = (b - x, -y);
        let (d, along) = (dx.hypot(dy), dy.atan2(dx));
        let half = ((b * b + d * d - a * a) / (2.0 * b * d)).acos();
        let coupler = along - half;
        let (bx, by) = (x + b * coupler.cos(), y + b * coupler.sin());
        (by.atan2(bx - b), coupler)
    } else {
        (at, 0.0)
    };
    let [crank_mass, coupler_mass, rocker_mass] = [a, b, a].map(|length| mass(chance, length));
    let gravity = gravity(chance);
    // A spring without effect lets a mechanism without masses have forces.
    format!(
        r#"format = 1
name = "four_bar"
{gravity}
ground.markers = {{ O2 = [0, 0], O4 = [{b}, 0] }}
bodies.crank = {{ markers = {{ O2 = [0, 0], A = [{a}, 0] }}, estimate = [0, 0, {at}]{crank_mass} }}
bodies.coupler = {{ markers = {{ A = [0, 0], B = [{b}, 0] }}, estimate = [{x}, {y}, {coupler}]{coupler_mass} }}
bodies.rocker = {{ markers = {{ O4 = [0, 0], B = [{a}, 0] }}, estimate = [{b}, 0, {rocker}]{rocker_mass} }}
joints.O2 = {{ type = "revolute", markers = ["ground.O2", "crank.O2"] }}
joints.A = {{ type = "revolute", markers = ["crank.A", "coupler.A"] }}
joints.B = {{ type = "revolute", markers = ["rocker.B", "coupler.B"] }}
joints.O4 = {{ type = "revolute", markers = ["ground.O4", "rocker.O4"] }}
drivers.u = {{ coordinate = "angle", markers = ["ground.O2", "crank.O2"], motion = "{text}" }}
forces.none = {{ coordinate = "angle", markers = ["ground.O2", "crank.O2"], stiffness = 0, free = 0 }}
simulation.start = -1
"#
    )
}

fn parallelogram(chance: &mut Chance) -> String {
    four_bar(chance, false)
}

fn antiparallelogram(chance: &mut Chance) -> String {
    four_bar(chance, true)
}

fn equal_slider_crank(chance: &mut Chance) -> String {
    let r = chance.between(0.1, 0.4);
    let text = motion(chance, "pi/2");
    let at: f64 = 0.8;
    let (x, y, slider) = (r * at.cos(), r * at.sin(), 2.0 * r * at.cos());
    let [crank_mass, rod_mass, slider_mass] = [r; 3].map(|length| mass(chance, length));
    let gravity = gravity(chance);
    format!(
        r#"format = 1
name = "slider_crank"
{gravity}
ground.markers = {{ O = [0, 0], slide = [0, 0] }}
bodies.crank = {{ markers = {{ O = [0, 0], A = [{r}, 0] }}, estimate = [0, 0, {at}]{crank_mass} }}
bodies.rod = {{ markers = {{ A = [0, 0], B = [{r}, 0] }}, estimate = [{x}, {y}, {}]{rod_mass} }}
bodies.slider = {{ markers = {{ B = [0, 0] }}, estimate = [{slider}, 0, 0]{slider_mass} }}
joints.O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
joints.A = {{ type = "revolute", markers = ["crank.A", "rod.A"] }}
joints.B = {{ type = "revolute", markers = ["rod.B", "slider.B"] }}
joints.slide = {{ type = "translational", markers = ["ground.slide", "slider.B"] }}
drivers.u = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], motion = "{text}" }}
forces.none = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], stiffness = 0, free = 0 }}
simulation.start = -1
"#,
        -at
    )
}

/// A door with its mass on the line of its joints hangs in equilibrium at the point: its reactions
/// are bounded, unless it is accelerated.
fn garage_door(chance: &mut Chance) -> String {
    let arm = chance.between(0.3, 1.0);
    let (track, length) = (2.0 * arm, 2.0 * arm);
    let start = 0.3 * arm;
    let speed = -start;
    let text = match chance.below(3) {
        0 => format!("{speed}*t"),
        1 => format!("{speed}*t + {}*t^2", chance.between(-0.02, 0.02)),
        _ => format!("{speed}*sin(t)"),
    };
    let [mass, inertia] = [chance.between(1.0, 60.0), chance.between(0.1, 20.0)];
    let below = chance.between(0.2, 1.5) * arm;
    let bottom = track - length;
    format!(
        r#"format = 1
name = "garage_door"
ground.markers = {{ J = [0, {arm}], track = [0, {track}] }}
bodies.door = {{ markers = {{ top = [0, {track}], P = [0, {bottom}] }}, mass = {mass}, inertia = {inertia}, center = [0, {}] }}
bodies.arm.markers = {{ J = [0, {arm}], P = [0, {bottom}] }}
joints.J = {{ type = "revolute", markers = ["ground.J", "arm.J"] }}
joints.P = {{ type = "revolute", markers = ["arm.P", "door.P"] }}
joints.track = {{ type = "slot", markers = ["ground.track", "door.top"] }}
drivers.u = {{ coordinate = "x", markers = ["ground.track", "door.top"], motion = "{text}" }}
simulation.start = -1
"#,
        track - below
    )
}
