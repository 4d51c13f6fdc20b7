//! `biela report`

use crate::cli::program::{biela, stdout};

/// Returns the report of a shipped mechanism.
fn report(name: &str, options: &[&str]) -> String {
    let file = format!("mechanisms/{name}.toml");
    let all: Vec<&str> = ["report", &file, "-o", "-"]
        .into_iter()
        .chain(options.iter().copied())
        .collect();
    stdout(&biela(&all).success())
}

#[test]
fn a_report_is_one_page_with_all_there_is_to_tell() {
    let page = report("four_bar", &[]);
    // Transmission angles of the four-bar with crank and base in line: law of cosines.
    let angle = |d: f64| {
        let cos = (0.25_f64.powi(2) + 0.3_f64.powi(2) - d * d) / (2.0 * 0.25 * 0.3);
        cos.acos().to_degrees()
    };
    let [least, greatest] = [angle(0.3), angle(0.5)].map(|a| format!("{a:.3}"));
    for part in [
        "<title>four_bar</title>",
        "lengths in mm",
        "<td data-what=\"\">degrees of freedom</td><td data-what=\"Number\">1</td>",
        "turns fully",
        &least[..5],
        &greatest[..5],
        "transmission angle",
        "<td data-what=\"Parameter\">rocker_length</td>",
        "crank_angle = { coordinate = &quot;angle&quot;",
    ] {
        assert!(page.contains(part), "{part}");
    }
    for outside in ["<script", "src=", "href=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(!page.contains("Forces at rest"));
    assert_eq!(page, report("four_bar", &[]));
    assert_eq!(page.matches("<svg").count(), 2);
}

#[test]
fn a_report_of_a_mechanism_with_forces_tells_them() {
    let page = report("excavator_arm", &[]);
    for part in ["Forces at rest", "largest effort", "largest force in joint"] {
        assert!(page.contains(part), "{part}");
    }
    // One chart for each of the three drivers.
    assert_eq!(page.matches("<svg").count(), 4);
}

#[test]
fn conditions_hold_in_a_report() {
    let page = report(
        "four_bar",
        &["--set", "crank_length = 0.05", "--drive", "crank_angle = 1"],
    );
    assert!(page.contains("from 57.2957795131 deg"));
    assert!(page.contains("<td data-what=\"Value\">0.05</td>"));
}

/// A rod of length l on a pivot swings about hanging down with the frequency sqrt(3 g/(2 l))/(2 pi).
#[test]
fn a_report_of_free_motion_has_its_chart_its_events_and_its_frequencies() {
    let page = report("pendulum_free", &[]);
    let frequency = (3.0 * 9.81 / (2.0 * 0.5_f64)).sqrt() / std::f64::consts::TAU;
    let expected = format!("swings at {frequency:.4}");
    for part in [
        "<h2>Motion</h2>",
        "<h3>Equilibrium</h3>",
        &expected,
        "swing = 0.000000000 rad",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let page = report("servo_arm", &[]);
    assert!(
        page.contains("impact at stop ends with"),
        "events are listed"
    );
    // Nothing moves by itself.
    assert!(!report("four_bar", &[]).contains("<h2>Motion</h2>"));
}
