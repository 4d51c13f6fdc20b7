//! FMUs with contacts of shapes.

#![allow(
    clippy::float_cmp,
    reason = "a state that is restored goes on with the same bits"
)]

use std::sync::Arc;

use biela::fmi::{Causality, Interface, Version};
use biela::mechanism::Mechanism;

use crate::clauses::{get, started, vr};
use crate::common::log::Heard;
use crate::common::{Instance, parse};

const G: f64 = 9.81;

/// A disc of 2 kg and 10 cm over a groove of 90°.
fn disc() -> Arc<Mechanism> {
    parse(
        "format = 1\nname = 'groove'\n[ground.markers]\nZ = [0, 0]\nL = [-1, 1]\nR = [1, 1]\n\
         [ground.shapes]\ngroove = { wall = ['R', 'Z', 'L'], depth = 0.05 }\n\
         [bodies.disc]\nmass = 2\ninertia = 0.01\nestimate = [0, 0.4, 0]\nmarkers = { O = [0, 0] }\n\
         shapes.rim = { disc = 'O', radius = 0.1 }\n[freedoms]\n\
         x = { coordinate = 'x', markers = ['ground.Z', 'disc.O'], start = 0 }\n\
         y = { coordinate = 'y', markers = ['ground.Z', 'disc.O'], start = 0.4 }\n\
         turn = { coordinate = 'angle', markers = ['ground.Z', 'disc.O'], start = 0 }\n\
         [contacts]\nhit = { shapes = ['disc.rim', 'ground.groove'] }\n",
    )
}

fn instance(interface: Interface) -> Instance {
    let heard = Heard::default();
    started(heard.instance_of(Version::Fmi2, disc(), interface))
}

fn touching(instance: &mut Instance) -> i32 {
    let reference = [vr(instance, "hit.touching")];
    let mut values = instance.integers(&reference).expect("legal");
    values.next().expect("one")
}

#[test]
fn a_disc_falls_into_a_groove() {
    let mut instance = instance(Interface::CoSimulation);
    instance.do_step(0.0, 0.1).expect("it falls");
    let height = 0.4 - 0.5 * G * 0.01;
    let [y, clearance, effort] = get(&mut instance, ["y.position", "hit.clearance", "hit.effort"]);
    assert!((y - height).abs() < 1e-12, "{y}");
    assert!(
        (clearance - (height / 2_f64.sqrt() - 0.1)).abs() < 1e-12,
        "{clearance}"
    );
    assert_eq!((effort, touching(&mut instance)), (0.0, 0));
    instance.do_step(0.1, 0.4).expect("it comes to rest");
    let [clearance, effort] = get(&mut instance, ["hit.clearance", "hit.effort"]);
    assert!(clearance.abs() < 1e-13, "{clearance}");
    // Both sides of the groove push with m g / √2.
    assert!(
        (effort - 2.0 * 2.0 * G / 2_f64.sqrt()).abs() < 1e-10,
        "{effort}"
    );
    assert_eq!(touching(&mut instance), 2);
    // Modes of both elements are part of the state.
    let state = instance.fmu_state().expect("legal");
    let bytes = instance.serialize_fmu_state(&state).expect("legal");
    instance.do_step(0.5, 0.5).expect("it rests");
    let outputs = ["x.position", "y.position", "hit.clearance", "hit.effort"];
    let expected = get(&mut instance, outputs);
    let mut other = self::instance(Interface::CoSimulation);
    let read = other.deserialize_fmu_state(&bytes).expect("its own");
    other.set_fmu_state(&read).expect("the same mechanism");
    assert_eq!(touching(&mut other), 2);
    other.do_step(0.5, 0.5).expect("it rests");
    assert_eq!(get(&mut other, outputs), expected);
}

#[test]
fn a_contact_has_the_indicators_of_one_force() {
    let mut instance = instance(Interface::ModelExchange);
    let variables = instance.variables().iter();
    let is_indicator = |causality| causality == Causality::EventIndicator;
    let indicators = variables.filter(|variable| is_indicator(variable.causality));
    assert_eq!(indicators.count(), 2);
    // The least gap of both elements.
    let [clearance] = get(&mut instance, ["hit.clearance"]);
    let mut least = |x: f64| {
        let states = [x, 0.0, 0.4, 0.0, 0.0, 0.0];
        instance.set_continuous_states(&states).expect("legal");
        instance
            .event_indicators(2)
            .expect("two")
            .next()
            .expect("two")
    };
    assert!((least(0.0) - clearance).abs() < 1e-12);
    let [left, right] = [least(-0.1), least(0.1)];
    assert!(
        (left - (clearance - 0.1 / 2_f64.sqrt())).abs() < 1e-12,
        "{left}"
    );
    assert!((right - left).abs() < 1e-12, "{left} {right}");
}

#[test]
fn the_derivative_of_a_clearance_is_that_of_differences() {
    let mut instance = instance(Interface::ModelExchange);
    let count = 6;
    let states: Vec<f64> = instance.continuous_states(count).expect("known").collect();
    let unknown = [vr(&instance, "hit.clearance")];
    for (place, known) in ["x.position", "y.position", "turn.position"]
        .into_iter()
        .enumerate()
    {
        let known = [vr(&instance, known)];
        let place = states.len().min(2 * place);
        let mut at = |step: f64| {
            let mut moved = states.clone();
            moved[0] += 0.05;
            moved[place] += step;
            instance.set_continuous_states(&moved).expect("legal");
            let [clearance] = get(&mut instance, ["hit.clearance"]);
            clearance
        };
        let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
        at(0.0);
        let exact = instance.directional_derivative(&unknown, &known, &[1.0]);
        let exact = exact.expect("it has one")[0];
        assert!((exact - slope).abs() < 1e-9, "{place}: {exact} {slope}");
    }
}
