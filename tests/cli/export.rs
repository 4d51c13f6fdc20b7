//! `biela export`

use std::io::Read as _;

use assert_cmd::Command;

use crate::program::{altered, biela};

#[test]
fn an_fmu_carries_its_picture_and_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let hostile = "description = \"<script>alert('&')</script>";
    let file = altered(
        folder.path(),
        "tlv",
        &[("description = \"Variable", hostile)],
    );
    let path = folder.path().join("tlv.fmu");
    biela(&["export", &file, "-o", path.to_str().unwrap()]).success();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut content = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(name).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        bytes
    };
    assert!(content("model.png").starts_with(b"\x89PNG"));
    let page = String::from_utf8(content("documentation/index.html")).unwrap();
    assert!(page.contains("&lt;script&gt;alert(") && !page.contains("<script>alert"));
    for wanted in [
        "down to 0.15 m: dead point, where body arm and body rod line up",
        "up to 0.65 m: dead point",
        ">arm_length</td><td data-what=\"Value\">0.25</td><td data-what=\"Unit\">m</td>",
        "<td data-what=\"Limits\">≥ 0.001</td>",
        ">arm.omega</td><td data-what=\"Causality\">output</td><td data-what=\"Unit\">rad/s</td>",
        ">rates</td>",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn export_is_reproducible_and_dated_only_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let export = |name: &str, epoch: Option<&str>| {
        let path = folder.path().join(name);
        let mut command = Command::new(env!("CARGO_BIN_EXE_biela"));
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        command.env_remove("SOURCE_DATE_EPOCH");
        command.envs(epoch.map(|epoch| ("SOURCE_DATE_EPOCH", epoch)));
        command
            .args(["export", "mechanisms/tlv.toml", "-o"])
            .arg(&path);
        command.assert().success();
        std::fs::read(path).unwrap()
    };
    let first = export("a.fmu", None);
    assert!(first == export("b.fmu", None));
    assert!(first != export("c.fmu", Some("1700000000")));
    assert!(export("d.fmu", Some("1700000000")) == export("e.fmu", Some("1700000000")));
    Command::new(env!("CARGO_BIN_EXE_biela"))
        .env("SOURCE_DATE_EPOCH", "yesterday")
        .args(["export", "mechanisms/tlv.toml"])
        .assert()
        .code(2);
}
