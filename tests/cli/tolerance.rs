//! `biela tolerance`

use crate::program::{biela, stderr, stdout};

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
