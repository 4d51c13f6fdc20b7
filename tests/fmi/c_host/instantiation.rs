//! Instantiation: right and wrong arguments and resource locations.

use biela::fmi::Status;

use crate::c_host::driver::{A, Fmu, Host, Instantiate, percent_encoded};

#[test]
fn what_cannot_be_instantiated_is_null_and_tells_the_logger() {
    let fmu = Fmu::of("four_bar");
    let right = Instantiate::right(&fmu);
    let text = |text: &str| Some(text.to_owned());
    let with = |change: &dyn Fn(&mut Instantiate)| {
        let mut with = right.clone();
        change(&mut with);
        with
    };
    let with_uri = |uri: &str| with(&|it| it.uri = text(uri));
    let with_guid = |guid: &str| with(&|it| it.guid = text(guid));
    let broken = Fmu::of("pendulum");
    std::fs::write(
        broken.resources.join(biela::fmi::RESOURCE),
        "format = 1\nname = ",
    )
    .unwrap();

    let mut host = Host::start();
    let mut reason = |with: &Instantiate| {
        let (made, log) = host.instantiate(A, with);
        assert!(!made);
        let [message] = &log[..] else {
            panic!("{log:?}")
        };
        assert_eq!(message.status, Status::Error);
        assert_eq!(message.category, "logStatusError");
        assert_eq!(message.instance, with.name.clone().unwrap_or_default());
        assert!(message.text.starts_with("fmi2Instantiate: "), "{message:?}");
        message.text.clone()
    };
    for (with, why) in [
        (
            with_guid("{00000000-0000-0000-0000-000000000000}"),
            "do not belong together",
        ),
        // No format of `printf`.
        (with_guid("%s%n%d"), "the GUID `%s%n%d` is not"),
        (with_guid(""), "the GUID `` is not"),
        (with(&|it| it.guid = None), "`fmuGUID` is a null pointer"),
        (
            with(&|it| it.uri = None),
            "`fmuResourceLocation` is a null pointer",
        ),
        (
            with(&|it| it.name = None),
            "`instanceName` is a null pointer",
        ),
        (with(&|it| it.name = text("")), "`instanceName` is empty"),
        // At least one character that is no white space (2.1.5).
        (
            with(&|it| it.name = text(" \t")),
            "`instanceName` is empty or blank",
        ),
        (
            with_uri("file://C:/resources"),
            "names the host `C:`; a drive follows `file:///`",
        ),
        (with_uri(""), "the resource location is empty"),
        (
            with_uri("https://example.org/resources"),
            "is not a `file:` URI",
        ),
        (with_uri("resources"), "is not a `file:` URI"),
        (
            with_uri("file://server/share/resources"),
            "is on another host, `server`",
        ),
        (
            with_uri(&format!("{}/nowhere", fmu.uri())),
            "cannot read the mechanism",
        ),
        (
            with_uri(&format!("{}%00", fmu.uri())),
            "cannot read the mechanism",
        ),
        (with_uri(&broken.uri()), "2:8"),
    ] {
        let reason = reason(&with);
        assert!(reason.contains(why), "{reason}");
    }
}

/// A lone start byte, and a letter of Latin-1.
#[test]
fn texts_that_are_not_utf_8_are_refused() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    for (field, name) in [
        (2, "instanceName"),
        (3, "fmuGUID"),
        (4, "fmuResourceLocation"),
    ] {
        for text in [r"\xc3", r"caf\xe9.toml"] {
            let mut request = [
                "Instantiate",
                A,
                "name",
                &fmu.guid,
                "file:///x",
                "1",
                "0",
                "full",
            ];
            request[field] = text;
            let answer = host.call(&request);
            assert_eq!(answer.results, ["0"]);
            let expected = format!("fmi2Instantiate: `{name}` is not UTF-8");
            assert_eq!(answer.log[0].text, expected);
        }
    }
}

#[test]
fn without_a_logger_nobody_is_told() {
    let fmu = Fmu::of("four_bar");
    let right = Instantiate::right(&fmu);
    let mut host = Host::start();
    for callbacks in ["none", "no logger"] {
        let wrong = Instantiate {
            callbacks,
            guid: Some("wrong".to_owned()),
            ..right.clone()
        };
        assert_eq!(host.instantiate(A, &wrong), (false, vec![]));
    }
    let silent = Instantiate {
        callbacks: "no logger",
        ..right
    };
    assert_eq!(host.instantiate(A, &silent), (true, vec![]));
    let answer = host.call(&["Terminate", A]);
    assert_eq!((answer.status, answer.log), (Status::Error, vec![]));
}

#[test]
fn resources_are_found_in_any_usual_spelling() {
    let fmu = Fmu::in_folder("pendulum", "a b#c%20d ü 模");
    let encoded = percent_encoded(fmu.path());
    assert!(encoded.ends_with("a%20b%23c%2520d%20%C3%BC%20%E6%A8%A1"));
    // As some hosts write them: only what would be ambiguous is encoded.
    let sloppy = fmu.path().replace('%', "%25");
    let mut host = Host::start();
    for uri in [
        format!("file://{encoded}"),
        format!("file://{encoded}/"),
        format!("file:{encoded}"),
        format!("file://localhost{encoded}"),
        format!("FILE://{}", encoded.replace("%C3%BC", "%c3%bc")),
        format!("file://{sloppy}"),
        fmu.path().to_owned(),
    ] {
        let with = Instantiate {
            uri: Some(uri.clone()),
            ..Instantiate::right(&fmu)
        };
        assert_eq!(host.instantiate(A, &with), (true, vec![]), "{uri}");
        host.ok(&["FreeInstance", A]);
    }
}
