//! The step path allocates nothing.

#![allow(
    unsafe_code,
    reason = "a counting allocator has to implement `GlobalAlloc`"
)]

mod common;
#[path = "common/generated.rs"]
#[allow(dead_code, reason = "also used by `crates/benches`")]
mod generated;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use biela::fmi::{
    Category, CoSimulation, Instance, Interface, MechanismModel, Sink, Status, Version,
};
use biela::kinematics::Rates;
use biela::mechanism::{Jet, MarkerId};
use common::{assembled, parse, shipped, straight_to};
use generated::{Ground, chain, scissor_lift};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// Counts what this thread allocates.
struct Counting;

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // No thread-local storage is left while a thread ends; nothing is measured then.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, message: &str) {
        panic!("unexpected message: {message}");
    }
}

/// An instance that has nothing to say.
fn silent(name: &str) -> common::Instance {
    let model = MechanismModel::new(shipped(name), Interface::CoSimulation)
        .expect("the mechanism assembles");
    Instance::new(model, Box::new(Silent), false)
}

fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

#[test]
fn the_allocator_counts() {
    assert_eq!(allocations(|| drop(Box::new(1))), 1);
}

#[test]
fn a_cycle_of_set_step_and_get_allocates_nothing() {
    // All with one crank or cam: the solver's kinds of blocks, gears, cams of every kind.
    for name in [
        "pendulum",
        "slider_crank",
        "four_bar",
        "tlv_crank",
        "slotted_lever",
        "stephenson_six_bar",
        "jansen_leg",
        "geared_five_bar",
        "rack_drive",
        "cam_knife",
        "cam_points",
        "cam_roller_arm",
        "cam_flat",
        // With forces.
        "andrews",
    ] {
        let mut instance = silent(name);
        let outputs: Vec<u32> = (1..=instance.variables().len() as u32)
            .filter(|vr| {
                let variable = &instance.variables()[*vr as usize - 1];
                matches!(variable.kind, biela::fmi::Kind::Real { .. })
            })
            .collect();
        let mut values = vec![0.0; outputs.len()];
        instance.setup_experiment(0.0, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        let count = allocations(|| {
            for step in 0..100 {
                let t = 0.01 * f64::from(step);
                // The three inputs of the driver, a derivative, a large step now and then.
                let jump = if step % 10 == 0 { 2.5 } else { 0.0 };
                let angle = 0.6 + t * (1.0 + 0.05 * t) + jump;
                let inputs = [angle, 1.0 + 0.1 * t, 0.1];
                instance.set_real(&[1, 2, 3], &inputs).unwrap();
                if step % 3 == 0 {
                    instance
                        .set_real_input_derivatives(&[1], &[1], &[1.0])
                        .unwrap();
                }
                // Reading between setting and stepping, too.
                if step % 4 == 0 {
                    instance.get_real(&outputs, &mut values).unwrap();
                }
                instance.do_step(t, 0.01).unwrap();
                instance.get_real(&outputs, &mut values).unwrap();
            }
        });
        assert_eq!(count, 0, "{name}");
        assert!(values.iter().all(|value| value.is_finite()));
    }
}

/// Steps from one stop to the other and back, up to where one is touched.
#[test]
fn steps_beside_stops_allocate_nothing() {
    let mut instance = silent("latch");
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    let strike = (0.02_f64 / 0.03).asin();
    let count = allocations(|| {
        for (step, angle) in (0..).zip([0.3, strike, strike, 0.7, -0.69, 0.729, strike, 0.0]) {
            instance.set_real(&[1], &[angle]).expect("legal");
            let t = 0.1 * f64::from(step);
            instance.do_step(t, 0.1).expect("it is no further");
        }
    });
    assert_eq!(count, 0);
}

/// Steps of FMI 3.0 with and without early return, and events between them.
#[test]
fn steps_and_events_of_fmi_3_allocate_nothing() {
    for name in ["pendulum", "four_bar", "jansen_leg", "andrews"] {
        for early_return_allowed in [false, true] {
            let model = MechanismModel::new(shipped(name), Interface::CoSimulation).unwrap();
            let mut instance = Instance::of_version(Version::Fmi3, model, Box::new(Silent), false);
            let agreed = CoSimulation {
                event_mode_used: true,
                early_return_allowed,
                ..CoSimulation::default()
            };
            instance.agree(agreed).unwrap();
            let references: Vec<u32> = (1..=instance.variables().len() as u32)
                .filter(|vr| {
                    let variable = &instance.variables()[*vr as usize - 1];
                    variable.kind.is_real()
                })
                .collect();
            let mut values = vec![0.0; references.len()];
            instance.enter_initialization_mode_at(0.0, None).unwrap();
            instance.exit_initialization_mode().unwrap();
            let count = allocations(|| {
                for step in 0..50 {
                    let t = 0.01 * f64::from(step);
                    instance.set_real(&[1, 2, 3], &[0.6 + t, 1.0, 0.1]).unwrap();
                    instance.get_real(&references, &mut values).unwrap();
                    instance.new_discrete_states().unwrap();
                    instance.enter_step_mode().unwrap();
                    instance.begin_step(t, 0.01).unwrap();
                    instance.get_real(&references, &mut values).unwrap();
                    instance.enter_event_mode().unwrap();
                }
            });
            assert_eq!(count, 0, "{name}");
        }
    }
}

/// Steps by integration, with a motor whose torque changes and parameters that stay.
#[test]
fn steps_of_free_motion_allocate_nothing() {
    for name in [
        "pendulum_free",
        "double_pendulum",
        "engine_free",
        "five_bar_free",
        "four_bar_free",
        "swinging_tip",
    ] {
        let mut instance = silent(name);
        let place = |wanted: &str| {
            let mut variables = instance.variables().iter();
            let place = variables.position(|variable| variable.name == wanted);
            place.map(biela::fmi::value_reference)
        };
        let motor = place("motor.effort");
        let outputs: Vec<u32> = ["rod.phi", "crank.alpha", "energy.kinetic", "coupler.vx"]
            .into_iter()
            .filter_map(place)
            .collect();
        assert!(!outputs.is_empty(), "{name}");
        let mut values = vec![0.0; outputs.len()];
        instance.setup_experiment(0.0, None).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        let mut step = |instance: &mut common::Instance, index: i32| {
            let t = 0.01 * f64::from(index);
            if let Some(motor) = motor {
                instance.set_real(&[motor], &[0.1 * t]).expect("legal");
            }
            instance.do_step(t, 0.01).expect("it moves");
            instance.get_real(&outputs, &mut values).expect("legal");
        };
        step(&mut instance, 0);
        let count = allocations(|| (1..100).for_each(|index| step(&mut instance, index)));
        assert_eq!(count, 0, "{name}");
    }
}

/// Tables whose parameters move: their splines are found anew at each sub-step.
#[test]
fn a_tunable_table_allocates_nothing() {
    let mut instance = silent("pick_and_place");
    let lift = instance
        .variables()
        .iter()
        .position(|variable| variable.name == "lift")
        .expect("it has one");
    let lift = biela::fmi::value_reference(lift);
    instance.setup_experiment(0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    let count = allocations(|| {
        for step in 0..100 {
            let t = 0.01 * f64::from(step);
            instance.set_real(&[lift], &[0.1 + 0.05 * t]).unwrap();
            instance.do_step(t, 0.01).unwrap();
        }
    });
    assert_eq!(count, 0);
}

/// The same for the solver by itself, on mechanisms of every kind of block: dyads and slides,
/// blocks small enough for dense matrices, and large ones, driven by one or more drivers, with
/// and without redundant constraints.
#[test]
fn a_step_of_the_solver_allocates_nothing() {
    let generated = [
        ("chain", chain(20, Ground::Zigzag)),
        ("small lift", scissor_lift(2)),
        ("large lift", scissor_lift(12)),
        ("very large lift", scissor_lift(20)),
        ("chain with a pin doubled", {
            let pin = "A_again = { type = \"revolute\", markers = [\"crank.A\", \"coupler_1.A\"] }";
            chain(5, Ground::Zigzag).replace("[drivers]", &format!("{pin}\n[drivers]"))
        }),
    ];
    let shipped = [
        "slider_crank",
        "double_rocker",
        "five_bar_robot",
        "excavator_arm",
        "cam_roller_arm",
    ]
    .map(|name| (name, shipped(name)));
    let generated = generated.map(|(name, text)| (name, parse(&text)));
    for (name, mechanism) in shipped.into_iter().chain(generated) {
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(solver.pose().q.len());
        let mut saved = solver.pose().clone();
        let home = solver.pose().drivers[0];
        let count = allocations(|| {
            for step in 1..=50 {
                straight_to(&solver, &mut path, home + 1e-4 * f64::from(step));
                solver.track(&path).expect("nothing is in the way");
                let driver = Jet::new(0.0, [1.0, 0.5]);
                solver
                    .solve_rates(|_| driver, &mut rates)
                    .expect("the pose is regular");
                let mut sum = solver.residual() + solver.rcond();
                for marker in 0..mechanism.markers.len() {
                    sum += solver.marker(MarkerId(marker), &rates)[0].second();
                }
                for measure in 0..mechanism.measures.len() {
                    sum += solver.measure(measure, &rates).second();
                }
                assert!(sum.is_finite());
                if step % 10 == 0 {
                    solver.save(&mut saved);
                    solver.restore(&saved);
                }
            }
        });
        assert_eq!(count, 0, "{name}");
    }
}
