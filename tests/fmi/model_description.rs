//! `modelDescription/` is the reviewed contract of each shipped mechanism's interface.

use crate::common::{assembled, folder, shipped, stems};
use biela::fmi::{Version, describe};

/// The generation tool's version changes with every release and is no part of the contract.
fn masked(xml: &str) -> String {
    let tool = concat!("generationTool=\"biela ", env!("CARGO_PKG_VERSION"), "\"");
    assert!(xml.contains(tool), "{tool} is missing");
    xml.replace(tool, "generationTool=\"biela\"")
}

fn unversioned(xml: &str) -> String {
    let start =
        xml.find("generationTool=\"biela").expect("it says so") + "generationTool=\"biela".len();
    let end = start + xml[start..].find('"').expect("the attribute ends");
    format!("{}{}", &xml[..start], &xml[end..])
}

#[test]
fn every_shipped_mechanism_has_its_contract() {
    assert_eq!(
        stems("modelDescription", "xml"),
        stems("mechanisms", "toml")
    );
}

#[test]
fn interfaces_do_not_drift() {
    for name in stems("mechanisms", "toml") {
        let (solver, _) = assembled(&shipped(&name));
        let xml = describe(solver.mechanism(), solver.structure(), Version::Fmi2).write(None);
        let xml = String::from_utf8(xml).expect("XML is text");
        let path = folder("modelDescription").join(format!("{name}.xml"));
        let contract = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            masked(&xml) == unversioned(&contract),
            "the interface of {name} has changed: if that is meant, run `make refresh` and review \
             modelDescription/{name}.xml"
        );
    }
}

/// FMI 3.0: mechanisms with inputs, prescribed motions, markers, measures and tables.
const OF_FMI_3: [&str; 4] = ["cam_points", "four_bar", "parallelogram", "slider_crank"];

#[test]
fn interfaces_of_fmi_3_do_not_drift() {
    assert_eq!(stems("modelDescription/fmi3", "xml"), OF_FMI_3);
    for name in OF_FMI_3 {
        let (solver, _) = assembled(&shipped(name));
        let description = describe(solver.mechanism(), solver.structure(), Version::Fmi3);
        let xml = String::from_utf8(description.write(None)).expect("XML is text");
        let path = folder("modelDescription/fmi3").join(format!("{name}.xml"));
        let contract = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            masked(&xml) == unversioned(&contract),
            "the interface of {name} in FMI 3.0 has changed: if that is meant, run `make refresh` \
             and review modelDescription/fmi3/{name}.xml"
        );
    }
}

#[test]
fn the_same_mechanism_gives_the_same_bytes() {
    let (solver, _) = assembled(&shipped("four_bar"));
    let write = |generated| {
        describe(solver.mechanism(), solver.structure(), Version::Fmi2).write(generated)
    };
    assert_eq!(write(None), write(None));
    let dated = String::from_utf8(write(Some("2026-11-21T00:00:00Z"))).expect("XML is text");
    assert!(dated.contains("generationDateAndTime=\"2026-11-21T00:00:00Z\""));
}
