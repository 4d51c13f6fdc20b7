//! `modelDescription/` is the reviewed contract of each shipped mechanism's interface.

mod common;

use std::path::PathBuf;

use biela::fmi::model_description;
use common::{assembled, shipped};

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn stems(name: &str, extension: &str) -> Vec<String> {
    let mut stems: Vec<_> = std::fs::read_dir(folder(name))
        .expect("the folder is part of the project")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .map(|path| {
            let stem = path.file_stem().expect("files have names");
            stem.to_str().expect("names are ASCII").to_owned()
        })
        .collect();
    stems.sort();
    stems
}

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
        let xml = model_description::write(solver.mechanism(), solver.structure(), None);
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

#[test]
fn the_same_mechanism_gives_the_same_bytes() {
    let (solver, _) = assembled(&shipped("four_bar"));
    let write =
        |generated| model_description::write(solver.mechanism(), solver.structure(), generated);
    assert_eq!(write(None), write(None));
    let dated = String::from_utf8(write(Some("2026-11-21T00:00:00Z"))).expect("XML is text");
    assert!(dated.contains("generationDateAndTime=\"2026-11-21T00:00:00Z\""));
}
