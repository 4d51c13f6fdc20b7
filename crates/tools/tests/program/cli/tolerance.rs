//! `biela tolerance`

use crate::cli::program::{biela, stderr, stdout};
use crate::common::mechanisms::crank;

/// Two links in line with their drivers: P = a (cos u, sin u) + b (cos v, sin v).
const ARM: &str = r#"
format = 1
name = "arm"

[parameters]
a = { value = 0.3, unit = "m", display = "mm", tolerance = "0.2*mm" }
b = { value = 0.2, unit = "m", display = "mm", tolerance = "0.1*mm" }
c = 0.0

[ground.markers]
O = [0, 0]

[bodies.upper]
markers = { O = [0, 0], A = ["a", "c"] }

[bodies.lower]
markers = { A = [0, 0], P = ["b", 0] }
estimate = [0.3, 0, 0]

[joints]
O = { type = "revolute", markers = ["ground.O", "upper.O"] }
A = { type = "revolute", markers = ["upper.A", "lower.A"] }

[drivers]
u = { coordinate = "angle", markers = ["ground.O", "upper.O"], start = 0 }
v = { coordinate = "angle", markers = ["ground.O", "lower.A"], start = 0 }

[outputs]
markers = ["lower.P"]
"#;

#[test]
fn deviations_of_an_arm_are_sums_of_projections() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.toml");
    std::fs::write(&file, ARM).unwrap();
    let file = file.to_str().unwrap();
    let drives = ["--drive", "u = pi/3", "--drive", "v = pi/2*t"];
    let mut arguments = vec!["tolerance", file, "--stop", "1", "--step", "0.5"];
    arguments.extend(drives);
    let told = stdout(&biela(&arguments).success());
    // At t = 0, v is 0: |dx| = 0.2 cos 60° + 0.1, and the root of the squares.
    // At t = 1, v is 90°: |dy| = 0.2 sin 60° + 0.1.
    let x: f64 = 0.2 * 0.5 + 0.1;
    let y: f64 = 0.2 * 0.75_f64.sqrt() + 0.1;
    let root = |a: f64| (a * a + 0.1 * 0.1_f64).sqrt();
    let rows: Vec<Vec<&str>> = told
        .lines()
        .map(|l| l.split_whitespace().collect())
        .collect();
    for (row, worst, statistical, time) in [
        (1, x, root(0.1), "0"),
        (2, y, root(0.2 * 0.75_f64.sqrt()), "1"),
    ] {
        let number = |column: usize| rows[row][column].parse::<f64>().unwrap();
        // Three decimals of a power of ten.
        assert!((number(1) / worst - 1.0).abs() < 5.1e-4, "{told}");
        assert!((number(2) / statistical - 1.0).abs() < 5.1e-4, "{told}");
        assert_eq!((rows[row][3], rows[row][4]), ("mm", time), "{told}");
    }
    assert_eq!([rows[1][0], rows[2][0]], ["lower.P.x", "lower.P.y"]);
    assert!(rows[2].ends_with(&["a", "63", "%"]), "{told}");
}

#[test]
fn a_file_without_tolerances_is_told_what_to_add() {
    let assert = biela(&["tolerance", "mechanisms/four_bar.toml"]).code(2);
    assert!(stderr(&assert).contains("add for example `tolerance = \"0.05*mm\"`"));
}

/// Runs `biela tolerance` with a mechanism and returns the row of a variable.
fn row_of(text: &str, variable: &str, options: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file.toml");
    std::fs::write(&file, text).expect("written");
    let mut arguments = vec![
        "tolerance",
        file.to_str().expect("UTF-8"),
        "--variables",
        variable,
    ];
    arguments.extend(options);
    let told = stdout(&biela(&arguments).success());
    let row = told.lines().nth(1).expect("a row").split_whitespace();
    row.map(str::to_owned).collect()
}

/// The measure is 0/0 in the first row, where the driver rests.
#[test]
fn times_without_a_value_are_passed_over() {
    let text = format!(
        "{ARM}\n[measures]\nx = {{ coordinate = 'x', markers = ['ground.O', 'lower.P'] }}\n\
        ratio = {{ value = 'x.velocity/u.velocity', unit = 'm' }}\n"
    );
    let drives = ["--drive", "u = t^2", "--stop", "1", "--step", "0.5"];
    // dx/du = -a sin u: its tolerance is largest at u = 1.
    let row = row_of(&text, "ratio", &drives);
    let worst: f64 = row[1].parse().unwrap();
    // Millimetres.
    assert!(
        (worst / (0.2 * 1.0_f64.sin()) - 1.0).abs() < 5.1e-4,
        "{row:?}"
    );
    assert_eq!(&row[3..], ["mm", "1", "a", "100", "%"]);
    // At rest throughout there is none.
    assert_eq!(
        row_of(&text, "ratio", &["--stop", "1"])[1..].join(" "),
        "no value at any time"
    );
}

/// The root has an infinite slope at zero.
#[test]
fn a_deviation_without_a_derivative_is_refused() {
    let text = format!("{ARM}\n[measures]\nroot = {{ value = 'sqrt(a - 0.3)', unit = 'm' }}\n");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file.toml");
    std::fs::write(&file, text).expect("written");
    let file = file.to_str().expect("UTF-8");
    let told = stderr(&biela(&["tolerance", file, "--variables", "root", "--stop", "0"]).code(1));
    assert!(
        told.contains("measure `root` has no finite derivative with respect to `a`"),
        "{told}"
    );
}

/// A point mass m at the end of an arm that holds it: the effort is m g a cos u.
#[test]
fn forces_have_tolerances() {
    let point = "parameters.a = { value = 0.3, unit = 'm', tolerance = '0.2*mm' }\n\
        bodies.crank.mass = 2\nbodies.crank.center = ['a', 0]\nsimulation.gravity = [0, -10]\n";
    let text = crank("start = 0") + point;
    let row = row_of(&text, "turn.effort", &["--stop", "0"]);
    let worst: f64 = row[1].parse().unwrap();
    assert!(
        (worst / (2.0 * 10.0 * 0.2e-3) - 1.0).abs() < 5.1e-4,
        "{row:?}"
    );
    assert_eq!(&row[3..], ["N.m", "0", "a", "100", "%"]);
}
