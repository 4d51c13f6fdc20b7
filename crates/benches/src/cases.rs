//! Cases to measure, by name; `README.md` lists the names.

use std::time::Duration;

use biela_tools::page::Host;

use crate::by_hand::{
    FourBarForces, cam_flat, cam_knife, cam_roller, four_bar, four_bar_masses, slider_crank,
};
use crate::chain::{Chain, Kind};
use crate::clock::timed;
use crate::cycle::{Cycle, Order};
use crate::free::{self, Free};
use crate::generated::{Ground, chain, scissor_lift};
use crate::motion::{Loaded, Moving, Stepper, Sweep, set_up, with_masses};
use crate::shipped;

/// A program that does a number of steps and returns the time that they take.
pub type Run = Box<dyn FnMut(u64) -> Duration>;

/// Something that is done in steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// `NAME` or `NAME@STEPS`: what is done, and the steps of a sweep of the driver, 10,000 if
    /// left out.
    pub name: String,
    /// Loops or cells; 1 for a mechanism of one size.
    pub size: usize,
}

impl Case {
    /// Names a case.
    #[must_use]
    pub fn new(name: impl Into<String>, size: usize) -> Self {
        let name = name.into();
        Self { name, size }
    }

    /// Returns the steps of a sweep.
    fn sweep(&self) -> Result<u32, String> {
        match self.name.split_once('@') {
            None => Ok(10_000),
            Some((_, steps)) => match steps.parse() {
                Ok(steps) if steps > 0 => Ok(steps),
                _ => Err(format!("`{steps}` is no number of steps")),
            },
        }
    }

    /// Returns the steps that time and instructions are averaged over: whole sweeps of a mechanism
    /// of one size, as the work differs along them.
    ///
    /// # Errors
    ///
    /// The number of steps of a sweep is no number.
    pub fn span(&self) -> Result<u64, String> {
        let size = self.size.max(1) as u64;
        if self.name.starts_with("set_up") {
            return Ok((100 / size).max(1));
        }
        if size == 1 {
            return Ok(1_000_u64.next_multiple_of(self.sweep()?.into()));
        }
        Ok((10_000 / size).max(20))
    }

    /// Makes the program that does the steps.
    ///
    /// # Errors
    ///
    /// There is no such case.
    pub fn run(&self) -> Result<Run, String> {
        let (size, sweep) = (self.size, self.sweep()?);
        let turn = [Sweep::turn(sweep)];
        let ground = Ground::Straight;
        let name = self.name.split('@').next().unwrap_or_default();
        let sized = ["chain", "lift"].iter().any(|end| name.contains(end));
        if size == 0 || size > 1 && !sized {
            return Err(format!("`{name}` has no size {size}"));
        }
        Ok(match name {
            "four_bar" => repeat(Moving::new(shipped!("four_bar")), turn),
            "four_bar_forces" => {
                let text = with_masses(shipped!("four_bar"), &four_bar_masses());
                repeat(Loaded::new(&text), turn)
            }
            "slider_crank" => repeat(Moving::new(shipped!("slider_crank")), turn),
            "cam_roller" => repeat(Moving::new(shipped!("cam_roller")), turn),
            "cam_flat" => repeat(Moving::new(shipped!("cam_flat")), turn),
            "cam_knife" => repeat(Moving::new(shipped!("cam_knife")), turn),
            "parallelogram" => repeat(Moving::new(shipped!("parallelogram")), turn),
            "jansen_leg" => repeat(Moving::new(shipped!("jansen_leg")), turn),
            "five_bar_robot" => {
                let arm = |from: f64, to: f64| {
                    Sweep::between(from.to_radians(), to.to_radians(), sweep, 1.0)
                };
                let arms = [arm(135.0, 105.0), arm(45.0, 60.0)];
                repeat(Moving::new(shipped!("five_bar_robot")), arms)
            }
            "platform_3rpr" => {
                let legs = [0.40, 0.38, 0.34].map(|to| Sweep::between(0.36, to, sweep, 0.1));
                repeat(Moving::new(shipped!("platform_3rpr")), legs)
            }
            "block_and_tackle" => repeat(
                Moving::new(shipped!("block_and_tackle")),
                [Sweep::between(0.5, 0.8, sweep, 0.1)],
            ),
            "geared_five_bar" => repeat(Moving::new(shipped!("geared_five_bar")), turn),
            "rack_drive" => repeat(Moving::new(shipped!("rack_drive")), turn),
            "scissor_lift_screw" => repeat(Moving::new(shipped!("scissor_lift_screw")), turn),
            "groove_cam" => repeat(Moving::new(shipped!("groove_cam")), turn),
            "sash_window" => repeat(
                Moving::new(shipped!("sash_window")),
                [Sweep::between(0.5, 1.2, sweep, 0.1)],
            ),
            "chain" => repeat(Moving::new(&chain(size, ground)), turn),
            "lift" => repeat(Moving::new(&scissor_lift(size)), [Sweep::lift(size, sweep)]),
            "free_pendulum" => move_on(Free::pendulum()),
            "free_four_bar" => move_on(Free::four_bar()),
            "c_free_pendulum" => move_on(free::ByHand::pendulum()),
            "c_free_four_bar" => move_on(free::ByHand::four_bar()),
            "set_up_chain" => set_ups(chain(size, ground)),
            "set_up_lift" => set_ups(scissor_lift(size)),
            "page_four_bar" => page(shipped!("four_bar"), turn),
            "page_jansen_leg" => page(shipped!("jansen_leg"), turn),
            "page_cam_roller" => page(shipped!("cam_roller"), turn),
            "c_four_bar" => repeat(four_bar(), turn),
            "c_four_bar_forces" => repeat(FourBarForces::new(), turn),
            "c_slider_crank" => repeat(slider_crank(), turn),
            "c_cam_roller" => repeat(cam_roller(), turn),
            "c_cam_flat" => repeat(cam_flat(), turn),
            "c_cam_knife" => repeat(cam_knife(), turn),
            "c_chain" => repeat(Chain::new(size, ground, Kind::Plain), turn),
            "c_chain_updated" => repeat(Chain::new(size, ground, Kind::Updated), turn),
            "c_chain_condition" => repeat(Chain::new(size, ground, Kind::Condition), turn),
            "fmu" => cycles(Cycle::biela(2, sweep, Order::File)),
            "fmu_of_fmi_3" => cycles(Cycle::biela(3, sweep, Order::File)),
            "fmu_by_quantity" => cycles(Cycle::biela(2, sweep, Order::Quantity)),
            "fmu_reversed" => cycles(Cycle::biela(2, sweep, Order::Reversed)),
            "fmu_random" => cycles(Cycle::biela(2, sweep, Order::Random)),
            "c_fmu" => cycles(Cycle::yardstick(sweep, Order::File)),
            "c_fmu_by_quantity" => cycles(Cycle::yardstick(sweep, Order::Quantity)),
            "c_fmu_reversed" => cycles(Cycle::yardstick(sweep, Order::Reversed)),
            "c_fmu_random" => cycles(Cycle::yardstick(sweep, Order::Random)),
            _ => return Err(format!("no case `{name}`")),
        })
    }
}

/// Steps along sweeps, one per driver.
fn repeat<const DRIVERS: usize>(
    mut stepper: impl Stepper + 'static,
    mut sweeps: [Sweep; DRIVERS],
) -> Run {
    Box::new(move |steps| {
        let run = || {
            for _ in 0..steps {
                stepper.step(&sweeps.each_mut().map(Sweep::step));
            }
        };
        timed(run).1
    })
}

/// Lets a mechanism move by its forces.
fn move_on(mut motion: impl free::Motion + 'static) -> Run {
    Box::new(move |steps| timed(|| (0..steps).for_each(|_| motion.step())).1)
}

/// Moves the first driver as the hand does on a page, with all numbers of its picture.
fn page(text: &str, [mut sweep]: [Sweep; 1]) -> Run {
    let mut host = Host::default();
    let request = serde_json::json!({ "do": "open", "name": "page.toml", "text": text });
    let answer = host.answer(&request.to_string());
    assert!(answer["page"].is_object(), "{answer}");
    Box::new(move |steps| {
        let run = || (0..steps).all(|_| host.drive(0, sweep.step().value));
        let (reached, time) = timed(run);
        assert!(reached, "nothing is in the way");
        time
    })
}

/// Runs cycles of an FMU.
fn cycles(mut cycle: Cycle) -> Run {
    Box::new(move |cycles| cycle.run(cycles))
}

/// Sets up a mechanism from its text to its first pose.
fn set_ups(text: String) -> Run {
    // The result is dropped outside of the time.
    Box::new(move |times| (0..times).map(|_| timed(|| set_up(&text)).1).sum())
}
