//! Memory: nothing is read or written that should not be, and nothing is left behind.

use std::io::Write;
use std::process::Command;

use biela::fmi::Status;

use crate::arguments::{REFUSED, refusals};
use crate::driver::{A, Fmu, Host, Instantiate, has};
use crate::runs::run;

#[test]
fn instances_come_and_go() {
    let fmu = Fmu::of("pendulum");
    let mut host = Host::start();
    let mut first = None;
    // More often than a process may usually have files open.
    for _ in 0..1100 {
        host.instantiated(A, &fmu);
        host.initialize(A);
        host.set_real(A, "0", 0.5);
        assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
        let values = host.get_reals(A, &fmu.reals());
        host.ok(&["FreeInstance", A]);
        assert_eq!(*first.get_or_insert_with(|| values.clone()), values);
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
    // What valgrind finds it tells on stderr, which has to be empty in the end.
}
