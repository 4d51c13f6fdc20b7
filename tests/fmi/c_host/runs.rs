//! Runs: the numbers, several instances, threads.

use std::sync::Arc;

use biela::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status};

use crate::c_host::driver::{A, B, Fmu, Host};

/// Position, velocity and acceleration of the crank at time `t`.
fn motion(t: f64) -> [f64; 3] {
    [1.0 + 2.0 * t + t * t, 2.0 + 2.0 * t, 2.0]
}

/// The communication points of [`run`].
fn points() -> impl Iterator<Item = f64> {
    (0..20).map(|step| 0.1 * f64::from(step))
}

/// All Real variables after each step of a run with the first driver's three inputs set.
pub(crate) fn run(host: &mut Host, slot: &str, fmu: &Fmu) -> Vec<Vec<f64>> {
    host.instantiated(slot, fmu);
    host.initialize(slot);
    let rows = points()
        .map(|t| {
            let values = motion(t).map(|value| value.to_string()).join(",");
            host.ok(&["SetReal", slot, "3", "1,2,3", &values]);
            host.ok(&["DoStep", slot, &t.to_string(), "0.1", "1"]);
            host.get_reals(slot, &fmu.reals())
        })
        .collect();
    host.ok(&["Terminate", slot]);
    host.ok(&["FreeInstance", slot]);
    rows
}

/// The same in Rust.
fn run_in_rust(fmu: &Fmu) -> Vec<Vec<f64>> {
    struct Silent;
    impl Sink for Silent {
        fn write(&self, status: Status, _: Category, message: &str) {
            panic!("{status:?}: {message}");
        }
    }
    let mechanism = Arc::clone(&fmu.mechanism);
    let model = MechanismModel::new(mechanism, Interface::CoSimulation).expect("it assembles");
    let mut instance = Instance::new(model, Box::new(Silent), false);
    let ready = instance
        .setup_experiment(0.0, None)
        .and_then(|()| instance.enter_initialization_mode())
        .and_then(|()| instance.exit_initialization_mode());
    ready.expect("the start values are those of the file");
    points()
        .map(|t| {
            let reals = fmu.reals();
            let mut values = vec![0.0; reals.len()];
            let stepped = instance
                .set_real(&[1, 2, 3], &motion(t))
                .and_then(|()| instance.do_step(t, 0.1))
                .and_then(|()| instance.get_real(&reals, &mut values));
            stepped.expect("the crank turns fully");
            values
        })
        .collect()
}

#[test]
fn a_run_gives_what_it_gives_in_rust() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let rows = run(&mut host, A, &fmu);
    assert_eq!(rows, run_in_rust(&fmu), "to the last bit");

    // And what it should: held inputs, so that the crank is where it was set before the step.
    let column = |name: &str| {
        let value_reference: u32 = fmu.vr(name).parse().unwrap();
        let mut reals = fmu.reals().into_iter();
        reals.position(|real| real == value_reference).unwrap()
    };
    let crank = ["crank.phi", "crank.omega", "crank.alpha"].map(column);
    for (t, row) in points().zip(&rows) {
        for (column, expected) in crank.into_iter().zip(motion(t)) {
            assert!((row[column] - expected).abs() < 1e-12, "{t}");
        }
    }
}

#[test]
fn one_thread_after_another_may_use_an_instance() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let rows = run(&mut host, A, &fmu);
    host.in_threads = true;
    assert_eq!(run(&mut host, A, &fmu), rows);
}

#[test]
fn instances_do_not_know_of_each_other() {
    let [crank, triangle] = ["four_bar", "tlv"].map(Fmu::of);
    let start = |host: &mut Host, slot: &str, fmu: &Fmu| {
        host.instantiated(slot, fmu);
        host.initialize(slot);
    };
    // Both ways of driving keep within what the triangle can do.
    let step = |host: &mut Host, slot: &str, fmu: &Fmu, t: f64| {
        host.set_real(slot, "1", 0.35 + 0.1 * t);
        assert_eq!(host.do_step(slot, t, 0.1).status, Status::Ok);
        host.get_reals(slot, &fmu.reals())
    };

    let mut host = Host::start();
    let alone = [&crank, &triangle].map(|fmu| {
        start(&mut host, A, fmu);
        let rows: Vec<_> = points().map(|t| step(&mut host, A, fmu, t)).collect();
        host.ok(&["FreeInstance", A]);
        rows
    });

    start(&mut host, A, &crank);
    start(&mut host, B, &triangle);
    for (row, t) in points().enumerate() {
        assert_eq!(step(&mut host, A, &crank, t), alone[0][row]);
        assert_eq!(step(&mut host, B, &triangle, t), alone[1][row]);
    }
    // Each has its own environment.
    for slot in [A, B] {
        let answer = host.call(&["SetTime", slot, "1"]);
        assert_eq!(answer.log[0].slot, slot);
    }
}

#[test]
fn several_threads_may_use_an_instance_each() {
    let [crank, triangle] = ["four_bar", "tlv"].map(Fmu::of);
    let mut host = Host::start();
    let mut run = |how: &str| {
        for (slot, fmu) in [(A, &crank), (B, &crank), ("2", &triangle), ("3", &triangle)] {
            host.instantiated(slot, fmu);
            host.initialize(slot);
        }
        // An output in both.
        let values = host.ok(&["Run", how, "100", "20"]);
        for slot in [A, B, "2", "3"] {
            host.ok(&["FreeInstance", slot]);
        }
        values
    };
    let in_turn = run("in turn");
    assert_eq!(in_turn.len(), 400);
    assert_ne!(in_turn[99], in_turn[399]);
    assert_eq!(run("at once"), in_turn, "to the last bit");
}

#[test]
fn the_host_may_leave_any_rounding_mode_set() {
    let mut host = Host::start();
    for name in ["four_bar", "tlv", "cam_roller", "platform_3rpr"] {
        let fmu = Fmu::of(name);
        let reals = fmu.reals();
        let list: Vec<_> = reals.iter().map(u32::to_string).collect();
        let count = reals.len().to_string();
        let found = host.ok(&["Modes", &fmu.guid, &fmu.uri(), &count, &list.join(",")]);
        assert_eq!(found, ["0", "0"], "{name}: values and modes that differ");
    }
}
