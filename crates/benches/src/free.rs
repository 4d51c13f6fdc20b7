//! Free motion: the same method for biela and for accelerations in C, and whole runs.

use std::convert::Infallible;

use biela::dynamics::integrator::{ErrorControl, Failure, Integrator, Method, System};
use biela::dynamics::{FreeMotion, Given};
use biela::kinematics::{Solution, Solver};
use biela::mechanism::{DriverId, Jet};

use crate::by_hand::{four_bar_acceleration, four_bar_masses, pendulum_acceleration};
use crate::clock::timed;
use crate::motion::{set_up, with_masses};
use crate::shipped;

/// Relative tolerance of both.
const TOLERANCE: f64 = 1e-8;
/// Time between two steps of a host \[s\]; the integrator's own are about as long.
const STEP: f64 = 0.01;

/// A pendulum of 1 kg at 1 m that is let go in level position (IFToMM, benchmark A01).
const PENDULUM: &str = r#"
format = 1
name = "pendulum"
ground.markers = { O = [0, 0] }
bodies.rod = { mass = 1, center = [1, 0], markers = { O = [0, 0] } }
joints.O = { type = "revolute", markers = ["ground.O", "rod.O"] }
freedoms.swing = { coordinate = "angle", markers = ["ground.O", "rod.O"], start = 0 }
"#;

/// Bars that hang from each other, each with stops 0.6 rad to both sides of the bar above.
const STOPPED: usize = 10;

/// A whole run of free motion.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Name of the moving thing, as a table says it.
    pub what: &'static str,
    text: fn() -> String,
    /// Time that passes \[s\], from one step of a host to the next.
    step: f64,
    /// Steps of the host in the whole run.
    pub steps: u32,
    /// Times that others publish for it.
    pub published: &'static str,
}

/// Cost of a run.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Time of the thread \[s\].
    pub time: f64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Events: impacts, rests, changes of friction.
    pub events: usize,
    /// Energy gained without a cause \[J\].
    pub energy_error: f64,
}

/// Benchmarks of the IFToMM library with what others publish, then friction and events.
pub const RUNS: [Run; 8] = [
    Run {
        what: "A01, pendulum, 10 s",
        text: || PENDULUM.to_owned(),
        step: 0.1,
        steps: 100,
        published: "37 ms Exudyn, 637 ms OpenSim",
    },
    Run {
        what: "A02, 2 four-bars, 10 s",
        text: || four_bars(2),
        step: 0.1,
        steps: 100,
        published: "455 ms OpenSim",
    },
    Run {
        what: "A02, 40 four-bars, 10 s",
        text: || four_bars(40),
        step: 0.1,
        steps: 100,
        published: "",
    },
    Run {
        what: "A03, Andrews, 0.05 s",
        text: || shipped!("andrews_free").to_owned(),
        step: 0.001,
        steps: 50,
        published: "384 ms OpenSim",
    },
    Run {
        what: "five-bar with two freedoms, 10 s",
        text: || shipped!("five_bar_free").to_owned(),
        step: 0.1,
        steps: 100,
        published: "",
    },
    Run {
        what: "four-bar, 10 s",
        text: || rubbed_four_bar(0),
        step: 0.1,
        steps: 100,
        published: "",
    },
    Run {
        what: "four-bar with friction in four pins, 10 s",
        text: || rubbed_four_bar(4),
        step: 0.1,
        steps: 100,
        published: "",
    },
    Run {
        what: "ten hanging bars with impacts, 2 s",
        text: bouncing_chain,
        step: 0.1,
        steps: 20,
        published: "",
    },
];

/// The chain of four-bars of the IFToMM library (A02): bars of 1 m and 1 kg, upright, whose first free
/// pin moves at 1 m/s.
fn four_bars(count: usize) -> String {
    let mut bodies = String::new();
    let mut joints = "[joints]\n".to_owned();
    let mut ground = "[ground.markers]\n".to_owned();
    let mut bar = |name: String, at: [usize; 2], phi: &str| {
        let [x, y] = at;
        bodies += &format!(
            "[bodies.{name}]\nmarkers = {{ A = [0, 0], B = [1, 0] }}\nestimate = [{x}, {y}, {phi}]\n\
             mass = 1\ninertia = \"1/12\"\ncenter = [0.5, 0]\n"
        );
    };
    let mut pin = |name: String, a: String, b: String| {
        joints += &format!("{name} = {{ type = \"revolute\", markers = [\"{a}\", \"{b}\"] }}\n");
    };
    for k in 0..=count {
        ground += &format!("O{k} = [{k}, 0]\n");
        bar(format!("post{k}"), [k, 0], "\"90*deg\"");
        pin(
            format!("O{k}"),
            format!("ground.O{k}"),
            format!("post{k}.A"),
        );
        if k > 0 {
            let before = k - 1;
            bar(format!("beam{k}"), [before, 1], "0");
            pin(
                format!("A{k}"),
                format!("post{before}.B"),
                format!("beam{k}.A"),
            );
            pin(format!("B{k}"), format!("beam{k}.B"), format!("post{k}.B"));
        }
    }
    format!(
        "format = 1\nname = \"chain\"\n{ground}{bodies}{joints}[freedoms]\nturn = {{ coordinate = \"angle\", \
         markers = [\"ground.O0\", \"post0.A\"], start = \"90*deg\", velocity = -1 }}\n"
    )
}

/// The four-bar of `mechanisms/four_bar.toml` with masses, and friction in the first of its pins.
fn rubbed_four_bar(rubbed: usize) -> String {
    let mut text = with_masses(shipped!("four_bar"), &four_bar_masses());
    text = text.replace("[drivers]", "[freedoms]");
    for joint in &["O2", "A", "B", "O4"][..rubbed] {
        text += &format!(
            "[friction.of_{joint}]\njoint = \"{joint}\"\ncoefficient = 0.05\nradius = 0.005\n"
        );
    }
    text
}

/// Hanging bars between stops.
fn bouncing_chain() -> String {
    let (mut bodies, mut joints) = (String::new(), "[joints]\n".to_owned());
    let (mut freedoms, mut stops) = ("[freedoms]\n".to_owned(), "[stops]\n".to_owned());
    let mut above = "ground.O".to_owned();
    for k in 0..STOPPED {
        bodies += &format!(
            "[bodies.bar{k}]\nmarkers = {{ A = [0, 0], B = [0.1, 0] }}\nestimate = [{}, 0, 0]\n\
             mass = 0.1\ninertia = 1e-4\ncenter = [0.05, 0]\n",
            0.1 * k as f64
        );
        joints +=
            &format!("J{k} = {{ type = \"revolute\", markers = [\"{above}\", \"bar{k}.A\"] }}\n");
        freedoms += &format!(
            "a{k} = {{ coordinate = \"angle\", markers = [\"{above}\", \"bar{k}.A\"], start = 0 }}\n"
        );
        stops += &format!("s{k} = {{ of = \"a{k}\", min = -0.6, max = 0.6, restitution = 0.5 }}\n");
        above = format!("bar{k}.B");
    }
    format!(
        "format = 1\nname = \"bars\"\n[ground.markers]\nO = [0, 0]\n{bodies}{joints}{freedoms}{stops}"
    )
}

impl Run {
    /// Runs its first steps once.
    ///
    /// # Panics
    ///
    /// If something is in the way.
    #[must_use]
    pub fn cost(&self, steps: u32) -> Cost {
        let mut free = Free::every(&(self.text)(), self.step);
        let (events, time) = timed(|| {
            (0..steps).fold(0, |events, _| {
                free.step();
                events + free.motion.events().count()
            })
        });
        Cost {
            time: time.as_secs_f64(),
            evaluations: free.motion.statistics().evaluations,
            events,
            energy_error: free.motion.energy_error(),
        }
    }
}

/// A motion that goes on in steps of a host.
pub trait Motion {
    /// Moves on by one step of the host.
    fn step(&mut self);

    /// Returns angle and velocity of the freedom.
    fn state(&self) -> [f64; 2];
}

/// A mechanism that biela moves by its forces.
#[derive(Debug)]
pub struct Free {
    solver: Solver,
    solution: Solution,
    motion: FreeMotion,
    step: f64,
    steps: u32,
}

/// No inputs.
struct Nothing;

impl Given for Nothing {
    fn driver(&self, _: DriverId, _: f64) -> Jet {
        unreachable!("all drivers are freedoms")
    }

    fn loads(&self, _: f64, _: &mut [f64]) {}
}

impl Free {
    /// The pendulum.
    #[must_use]
    pub fn pendulum() -> Self {
        Self::new(PENDULUM)
    }

    /// The four-bar of `mechanisms/four_bar.toml` with masses, let go at 60°.
    #[must_use]
    pub fn four_bar() -> Self {
        let text = with_masses(shipped!("four_bar"), &four_bar_masses());
        Self::new(&text.replace("[drivers]", "[freedoms]"))
    }

    fn new(text: &str) -> Self {
        Self::every(text, STEP)
    }

    fn every(text: &str, step: f64) -> Self {
        let (mut solver, _) = set_up(text);
        let motion = FreeMotion::new(&solver, TOLERANCE).expect("a tolerance");
        let mut motion = motion.expect("there is a freedom");
        motion.start(&mut solver, &Nothing).expect("it has mass");
        Self {
            solution: Solution::new(&solver),
            solver,
            motion,
            step,
            steps: 0,
        }
    }
}

impl Motion for Free {
    fn step(&mut self) {
        self.steps += 1;
        let until = self.step * f64::from(self.steps);
        let Self {
            solver,
            solution,
            motion,
            ..
        } = self;
        let moved = motion.advance(solver, solution, &Nothing, until);
        moved.expect("nothing is in the way");
    }

    fn state(&self) -> [f64; 2] {
        let driver = self.motion.drivers()[0];
        [driver.value, driver.first()]
    }
}

/// A motion whose acceleration C computes.
#[derive(Debug)]
pub struct ByHand {
    integrator: Integrator,
    acceleration: Acceleration,
    steps: u32,
}

/// The acceleration at an angle and a velocity.
#[derive(Clone, Copy, Debug)]
struct Acceleration(fn(f64, f64) -> f64);

impl System for Acceleration {
    type Cause = Infallible;

    fn derivatives(
        &mut self,
        _: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<Infallible>> {
        dx[0] = x[1];
        dx[1] = (self.0)(x[0], x[1]);
        Ok(())
    }
}

impl ByHand {
    /// The pendulum.
    #[must_use]
    pub fn pendulum() -> Self {
        Self::new(0.0, |angle, _| pendulum_acceleration(angle))
    }

    /// The four-bar.
    #[must_use]
    pub fn four_bar() -> Self {
        Self::new(60.0_f64.to_radians(), four_bar_acceleration)
    }

    fn new(angle: f64, acceleration: fn(f64, f64) -> f64) -> Self {
        let control = ErrorControl::new(TOLERANCE, vec![1.0; 2]).expect("a tolerance");
        let start = vec![angle, 0.0];
        let integrator = Integrator::new(Method::Explicit, control, 0.0, start);
        Self {
            integrator: integrator.expect("a start"),
            acceleration: Acceleration(acceleration),
            steps: 0,
        }
    }
}

impl Motion for ByHand {
    fn step(&mut self) {
        self.steps += 1;
        let until = STEP * f64::from(self.steps);
        while self.integrator.state().t.to_bits() != until.to_bits() {
            let step = self.integrator.advance(&mut self.acceleration, until);
            step.expect("it is smooth");
        }
    }

    fn state(&self) -> [f64; 2] {
        let x = &self.integrator.state().x;
        [x[0], x[1]]
    }
}
