//! The library as a host in C sees it: `tests/host.c` calls it through the standard's header.

#![cfg(c_host)]

mod arguments;
mod driver;
mod fmi3;
mod fmu_state;
mod instantiation;
mod memory;
mod messages;
mod runs;
mod states;
mod stepping;

use std::collections::BTreeSet;
use std::process::Command;

use driver::Host;
use set_up::runtime_library;
use states::functions;

/// Calls that no state decides about.
const IN_NO_STATE: [&str; 4] = [
    "GetTypesPlatform",
    "GetVersion",
    "Instantiate",
    "FreeInstance",
];

#[test]
fn the_functions_of_the_header_are_exported_and_nothing_else() {
    let header = format!("{}/fmi2Functions.h", env!("BIELA_FMI_HEADERS"));
    let header = std::fs::read_to_string(header).unwrap();
    let declared: BTreeSet<_> = header
        .lines()
        .filter_map(|line| line.trim().strip_prefix("FMI2_Export fmi2"))
        .filter_map(|line| line.trim_end_matches(';').split_whitespace().last())
        .collect();
    assert_eq!(declared.len(), 44);

    let here: BTreeSet<_> = functions()
        .map(|(name, _)| name)
        .chain(IN_NO_STATE)
        .map(|name| format!("fmi2{name}"))
        .collect();
    let declared: BTreeSet<_> = declared.iter().map(|name| name.to_string()).collect();
    assert_eq!(here, declared, "what these tests call");

    let header = format!("{}/fmi3Functions.h", env!("BIELA_FMI_HEADERS"));
    let header = std::fs::read_to_string(header).unwrap();
    let of_fmi3: BTreeSet<_> = header
        .lines()
        .filter_map(|line| line.trim().strip_prefix("FMI3_Export fmi3"))
        .filter_map(|line| line.trim_end_matches(';').split_whitespace().last())
        .map(str::to_owned)
        .collect();
    assert_eq!(of_fmi3.len(), 75);

    let list: &[&str] = if cfg!(target_vendor = "apple") {
        &["-g", "-U"]
    } else {
        &["-D", "--defined-only"]
    };
    let nm = Command::new("nm")
        .args(list)
        .arg(runtime_library())
        .output();
    let nm = nm.expect("the linker brings `nm` along");
    let exported: BTreeSet<_> = String::from_utf8(nm.stdout)
        .unwrap()
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .map(|symbol| symbol.trim_start_matches('_').to_owned())
        .collect();
    let declared: BTreeSet<_> = declared.union(&of_fmi3).cloned().collect();
    assert_eq!(exported, declared, "what the library exports");
}

#[test]
fn the_platform_and_version_are_those_of_the_standard() {
    let mut host = Host::start();
    assert_eq!(host.ok(&["GetTypesPlatform"]), ["default"]);
    assert_eq!(host.ok(&["GetVersion"]), ["2.0"]);
}
