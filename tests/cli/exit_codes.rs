//! What is wrong with files and arguments, and the exit code that says so.

use crate::program::{altered, biela, stderr, stdout};

#[test]
fn a_bad_file_exits_with_1_and_shows_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("\"crank.O\"]", "\"cranck.O\"]")],
    );
    for command in ["check", "run", "draw", "export"] {
        let assert = biela(&[command, &file]).code(1);
        assert_eq!(stdout(&assert), "");
        let message = stderr(&assert);
        assert!(message.contains("four_bar.toml:31:"), "{message}");
        assert!(message.contains("no body `cranck`"), "{message}");
        assert!(message.contains("did you mean `crank`?"), "{message}");
    }
}

#[test]
fn a_mechanism_that_does_not_close_exits_with_1_and_names_the_joint() {
    let folder = tempfile::tempdir().unwrap();
    let file = altered(
        folder.path(),
        "four_bar",
        &[("value = 0.10", "value = 0.80")],
    );
    for command in ["check", "run", "draw", "export"] {
        let assert = biela(&[command, &file]).code(1);
        let message = stderr(&assert);
        assert!(
            message.contains("joint `O4` stays open by 142.8 mm"),
            "{message}"
        );
    }
}

#[test]
fn a_mechanism_without_driver_exits_with_1_and_says_what_is_loose() {
    let folder = tempfile::tempdir().unwrap();
    let driver = "crank_angle = { coordinate = \"angle\", markers = [\"ground.O2\", \"crank.O\"], start = \"60*deg\" }";
    let file = altered(folder.path(), "four_bar", &[(driver, "")]);
    let assert = biela(&["check", &file]).code(1);
    // What can be counted is shown all the same.
    assert!(stdout(&assert).contains("constraints            8"));
    assert!(stderr(&assert).contains("free to move: body `crank`"));
}

#[test]
fn bad_usage_exits_with_2() {
    for (arguments, expected) in [
        (&["check"][..], "required"),
        (
            &["check", "no_such_file.toml"],
            "cannot read `no_such_file.toml`",
        ),
        (&["fly"], "unrecognized subcommand"),
        (
            &["run", "mechanisms/tlv.toml", "--step", "0"],
            "expected a positive time",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--stop", "-1"],
            "must not be before the start",
        ),
        (&["run", "mechanisms/tlv.toml", "--step", "1e-300"], "rows"),
        (
            &["run", "mechanisms/tlv.toml", "--drive", "side_length"],
            "has no `=`",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--drive", "side=1"],
            "no driver `side`; expected `side_length`",
        ),
        (
            &[
                "run",
                "mechanisms/tlv.toml",
                "--drive",
                "side_length=0.3+*t",
            ],
            "^",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--set", "bas=1"],
            "no parameter `bas`",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--set", "base=0"],
            "not a permitted value",
        ),
        (&["run", "mechanisms/tlv.toml", "--set", "base=t"], "--set"),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "tlv.pdf"],
            "`tlv.pdf` has neither the extension .svg nor .png",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "svg"],
            "neither the extension",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "-o", "no_such_folder/x.svg"],
            "cannot write `no_such_folder/x.svg`",
        ),
        (
            &["draw", "mechanisms/tlv.toml", "--width", "0"],
            "invalid value '0' for '--width <PIXELS>'",
        ),
        (
            &["run", "mechanisms/tlv.toml", "--animate", "tlv.svg"],
            "`tlv.svg` has neither the extension .html nor .htm",
        ),
        (
            &["watch", "no_such_file.toml"],
            "cannot read `no_such_file.toml`",
        ),
        (
            &["watch", "mechanisms/tlv.toml", "--drive", "side=1"],
            "no driver `side`; expected `side_length`",
        ),
        (
            &["export", "mechanisms/tlv.toml", "--runtime", "mechanisms"],
            "no runtime library",
        ),
        (
            &[
                "export",
                "mechanisms/tlv.toml",
                "-o",
                "no_such_folder/x.fmu",
            ],
            "cannot write",
        ),
    ] {
        let assert = biela(arguments).code(2);
        let message = stderr(&assert);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_changes_no_status_but_that_of_results() {
    let full = || std::fs::File::create("/dev/full").unwrap();
    for (arguments, status) in [
        (&["check", "no_such_file.toml"][..], 2),
        (&["check", "tests/diagnostics/syntax.toml"], 1),
        (&["check", "tests/diagnostics/floating-body.toml"], 1),
        // That nothing moves is noted.
        (&["run", "mechanisms/four_bar.toml", "--plot", "-"], 0),
        (&["fly"], 2),
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_biela"));
        let ended = command.args(arguments).stderr(full()).output().unwrap();
        assert_eq!(ended.status.code(), Some(status), "{arguments:?}");
    }
    // What is held back until a line or the program ends is missed as well.
    for arguments in [
        &["check", "mechanisms/tlv.toml"][..],
        &["run", "mechanisms/tlv.toml"],
        &["draw", "mechanisms/tlv.toml", "-o", "-"],
        &["export", "mechanisms/tlv.toml", "--model-description", "-"],
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_biela"));
        let command = command.args(arguments).stdout(full());
        let ended = command.output().unwrap();
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8(ended.stderr).unwrap();
        assert!(message.contains("cannot write stdout: "), "{message}");
    }
}
