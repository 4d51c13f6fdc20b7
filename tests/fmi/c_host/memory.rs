//! Memory: nothing is read or written that should not be, and nothing is left behind.

use std::io::Write;
use std::process::Command;

use crate::c_host::arguments::{REFUSED, refusals};
use crate::c_host::driver::{A, Fmu, Host, Instantiate, has};
use crate::c_host::runs::run;

#[test]
fn instances_come_and_go() {
    let fmu = Fmu::of("pendulum");
    let mut host = Host::start();
    let live = |host: &mut Host, times: &str| host.ok(&["Lives", times, &fmu.guid, &fmu.uri()]);
    // Until the memory pools of the C library have the size that they keep.
    live(&mut host, "500");
    let before = host.resident_memory();
    live(&mut host, "5000");
    if let (Some(before), Some(after)) = (before, host.resident_memory()) {
        // The smallest block that could be forgotten each time takes 32 bytes, 160 kB in all.
        let grown = after.saturating_sub(before);
        assert!(grown < 100_000, "{grown} bytes after {before}");
    }
}

#[test]
fn memory_is_used_as_it_should() {
    if !has("valgrind") {
        // Not captured as `eprintln!` would be.
        writeln!(std::io::stderr(), "SKIPPED: valgrind is not installed").unwrap();
        return;
    }
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--error-exitcode=1", "--leak-check=full"]);
    valgrind.arg(env!("BIELA_C_HOST"));
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start_with(valgrind);
    run(&mut host, A, &fmu);
    let mut wrong = Instantiate::right(&fmu);
    wrong.guid = Some("wrong".to_owned());
    assert!(!host.instantiate(A, &wrong).0);
    host.instantiated(A, &fmu);
    host.initialize(A);
    for (request, _) in refusals(REFUSED, &fmu) {
        host.call(&request);
    }
    // Model exchange, with derivatives along a direction.
    host.ok(&["FreeInstance", A]);
    let exchange = Instantiate {
        model_exchange: true,
        ..Instantiate::right(&fmu)
    };
    assert!(host.instantiate(A, &exchange).0);
    host.initialize(A);
    host.ok(&["NewDiscreteStates", A, "room"]);
    host.ok(&["EnterContinuousTimeMode", A]);
    let outputs: Vec<_> = fmu.outputs().iter().map(u32::to_string).collect();
    let (n, outputs) = (outputs.len().to_string(), outputs.join(","));
    for t in ["0.1", "0.2"] {
        host.ok(&["SetTime", A, t]);
        host.set_real(A, "1", 1.5);
        host.ok(&["GetReal", A, &n, &outputs, "room"]);
        let request = ["GetDirectionalDerivative", A, &n, &outputs];
        host.ok(&[&request[..], &["2", "1,2", "1,0.5", "room"]].concat());
        host.ok(&["CompletedIntegratorStep", A, "room", "room"]);
    }
    host.ok(&["EnterEventMode", A]);
    host.ok(&["Lives", "2", &fmu.guid, &fmu.uri()]);
    // valgrind reports on stderr, which has to be empty in the end.
}
