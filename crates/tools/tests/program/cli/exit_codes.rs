//! Exit codes for faults of files and arguments.

use crate::cli::program::{altered, biela, stderr, stdout};

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
    // The counts are shown all the same.
    assert!(stdout(&assert).contains("constraints            8"));
    assert!(stderr(&assert).contains("free to move: body `crank`"));
}

/// Command lines, each with its status and a part of its message, in which `\n` ends a line.
const RUNS: &str = r"
# Commands and times.
check
    2 required
check no_such_file.toml
    2 cannot read `no_such_file.toml`
fly
    2 unrecognized subcommand
run mechanisms/tlv.toml --step 0
    2 expected a positive time
run mechanisms/tlv.toml --stop -1
    2 must not be before the start
run mechanisms/tlv.toml --step 1e-300
    2 makes more than 1e9 rows
run mechanisms/tlv.toml --step -1
    2 --step is -1; expected a positive time
run mechanisms/tlv.toml --stop inf
    2 --stop is inf; expected a finite number
run mechanisms/tlv.toml --start nan
    2 --start is NaN; expected a finite number
run mechanisms/tlv.toml --step 0.01 --stop 1e300
    2 a step of 0.01 s from 0 s to 1e300 s makes more than 1e9 rows
run mechanisms/tlv.toml --step 1e-6 --stop 1 -p x.svg
    2 --plot: 1000001 rows are more than the 1000000 of which a picture is made
# Drivers and parameters.
run mechanisms/tlv.toml --drive side_length
    2 has no `=`
run mechanisms/tlv.toml --drive side=1
    2 --drive: no driver `side`; did you mean `side_length`?
run mechanisms/tlv.toml --drive foo=1
    2 --drive: no driver `foo`; expected `side_length`
run mechanisms/tlv.toml --drive side_length=0.3+*t
    2 ^
run mechanisms/tlv.toml --set bas=1
    2 --set: no parameter `bas`; did you mean `base`?
run mechanisms/tlv.toml --set side_length=1
    2 --set: no parameter `side_length`; `side_length` is a driver: use --drive
run mechanisms/tlv.toml --drive base=1
    2 --drive: no driver `base`; `base` is a parameter: use --set
run mechanisms/tlv.toml --stop 0,5
    2 expected a number of seconds, such as 0.5
run mechanisms/tlv.toml -o motion.xls
    2 `motion.xls` would be CSV: an Excel file has the extension .xlsx
report mechanisms/tlv.toml -o report.pdf
    2 `report.pdf` has neither the extension .html nor .htm
check mechanisms/tlv
    2 did you mean `mechanisms/tlv.toml`?
run mechanisms/tlv.toml --set base=0
    2 --set: `base` cannot be set to 0: expected at least 0.001 m
run mechanisms/tlv.toml --set base=-1e300
    2 --set: `base` cannot be set to -1e300: expected at least 0.001 m
run mechanisms/tlv.toml --set base=sqrt(-arm_length)
    2 --set: `base` is NaN: expected a finite number
run mechanisms/tlv.toml --set base=1 -s 'base = 1'
    2 --set: `base` is given twice
draw mechanisms/tlv.toml -d side_length=1 -d side_length=1
    2 --drive: `side_length` is given twice
run mechanisms/tlv.toml --drive side_length=
    2 --drive: the expression is empty; write a number or a formula over the parameters\n
run mechanisms/tlv.toml --drive 'side_length= 1/t'
    2 --drive: at t = 0, the value of `1/t` is not finite\n  1/t\n  ^\n
draw mechanisms/tlv.toml --drive side_length=sqrt(t)
    2 --drive: at t = 0, the velocity of `sqrt(t)` is not finite\n
run mechanisms/tlv.toml --set base=t
    2 --set
# Pictures and files.
draw mechanisms/tlv.toml -o tlv.pdf
    2 `tlv.pdf` has neither the extension .svg nor .png
draw mechanisms/tlv.toml -o svg
    2 neither the extension
draw mechanisms/tlv.toml -o no_such_folder/x.svg
    2 cannot write `no_such_folder/x.svg`
draw mechanisms/tlv.toml --width 0
    2 invalid value '0' for '--width <PIXELS>'
run mechanisms/tlv.toml --animate tlv.mp4
    2 `tlv.mp4` has none of the extensions .html, .htm, .svg and .gif
run mechanisms/hatch.toml --animate hatch.svg --forces
    2 --forces: a moving picture has no arrows of forces; a page has them, .html
watch no_such_file.toml
    2 cannot read `no_such_file.toml`
watch mechanisms/tlv.toml --drive side=1
    2 no driver `side`; did you mean `side_length`?
draw mechanisms/tlv.toml --width -5
    2 -5 is not in 16..=8192
export mechanisms/tlv.toml --runtime mechanisms
    2 no runtime library
export mechanisms/tlv.toml -o no_such_folder/x.fmu
    2 cannot write
";

/// Splits a command line at its spaces, of which those between apostrophes belong to an argument.
fn arguments(line: &str) -> Vec<&str> {
    let parts = line.split('\'').enumerate();
    parts
        .flat_map(|(k, part)| match k % 2 {
            0 => part.split_whitespace().collect(),
            _ => vec![part],
        })
        .collect()
}

#[test]
fn bad_usage_has_its_status_and_says_what_is_wrong() {
    let mut lines = RUNS
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    while let (Some(line), Some(ending)) = (lines.next(), lines.next()) {
        let (status, message) = ending.trim_start().split_once(' ').unwrap();
        let assert = biela(&arguments(line)).code(status.parse::<i32>().unwrap());
        let told = stderr(&assert);
        assert!(
            told.contains(&message.replace(r"\n", "\n")),
            "{line}: {told}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_changes_no_status_but_that_of_results() {
    let full = || std::fs::File::create("/dev/full").unwrap();
    for (arguments, status) in [
        (&["check", "no_such_file.toml"][..], 2),
        (
            &["check", "crates/tools/tests/file/diagnostics/syntax.toml"],
            1,
        ),
        (
            &[
                "check",
                "crates/tools/tests/file/diagnostics/floating-body.toml",
            ],
            1,
        ),
        // A note says that nothing moves.
        (&["run", "mechanisms/four_bar.toml", "--plot", "-"], 0),
        (&["fly"], 2),
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_biela"));
        command.current_dir(set_up::root());
        let ended = command.args(arguments).stderr(full()).output().unwrap();
        assert_eq!(ended.status.code(), Some(status), "{arguments:?}");
    }
    // The loss of output that is held back until a line or the program ends counts as well.
    for arguments in [
        &["check", "mechanisms/tlv.toml"][..],
        &["run", "mechanisms/tlv.toml"],
        &["draw", "mechanisms/tlv.toml", "-o", "-"],
        &["export", "mechanisms/tlv.toml", "--model-description", "-"],
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_biela"));
        command.current_dir(set_up::root());
        let command = command.args(arguments).stdout(full());
        let ended = command.output().unwrap();
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8(ended.stderr).unwrap();
        assert!(message.contains("cannot write stdout: "), "{message}");
    }
}
