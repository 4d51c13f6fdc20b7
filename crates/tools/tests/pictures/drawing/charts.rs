//! Charts.

use biela_tools::drawing::{Axis, Line, LineChart, Panel, Sheet, png, svg};

use crate::drawing::pictures::{WIDTH, check_apart, check_picture};

/// A chart of lines in several panels, with gaps, noise and long names.
fn chart() -> LineChart {
    let at: Vec<f64> = (0..=4000).map(|k| f64::from(k) / 1000.0).collect();
    let line = |name: &str, look, f: &dyn Fn(f64) -> f64| Line {
        name: name.to_owned(),
        look,
        values: at.iter().map(|t| f(*t)).collect(),
        marks: vec![(1.0, f(1.0), "a mark".to_owned())],
    };
    let axis = |label: &str, unit: &str| Axis {
        label: label.to_owned(),
        unit: unit.to_owned(),
    };
    let many = (0..9).map(|k| {
        line(&format!("a_body_with_a_long_name_{k}.x"), k, &|t| {
            t + k as f64
        })
    });
    LineChart {
        title: "chart".to_owned(),
        description: String::new(),
        x: axis("time", "s"),
        instants: Vec::new(),
        panels: vec![
            Panel {
                y: axis("position", "m"),
                lines: many.collect(),
            },
            Panel {
                y: axis("angle", "deg"),
                lines: vec![
                    line("turn", 0, &|t| 360.0 * t),
                    line("gap", 1, &|t| 1.0 / (t - 2.0).max(0.0)),
                ],
            },
            Panel {
                y: axis("acceleration", "m/s²"),
                lines: vec![line("noise", 2, &|t| 1e-13 * (50.0 * t).sin())],
            },
            Panel {
                y: axis("angular acceleration", "deg/s²"),
                lines: vec![line("large", 2, &|t| -2.5e6 * t)],
            },
        ],
        at,
    }
}

#[test]
fn charts_are_whole_and_labels_apart() {
    let svg = svg::write(&Sheet::chart(&chart()), WIDTH, false);
    let labels = check_picture("chart", &svg);
    check_apart("chart", &labels);
    for wanted in [
        "position [m]",
        "a_body_with_a_long_name_8.x",
        "angle [deg]",
        "1440",
        "acceleration [m/s²]",
        "angular acceleration [1e6 deg/s²]",
        "-10",
        "time [s]",
    ] {
        assert!(labels.iter().any(|label| label.text == wanted), "{wanted}");
    }
    assert!(png::write(&Sheet::chart(&chart()), WIDTH, false).is_some());
}

#[test]
fn lines_of_a_chart_are_where_their_values_are() {
    let svg = svg::write(&Sheet::chart(&chart()), WIDTH, false);
    let labels = check_picture("chart", &svg);
    // Grid lines lie at the middle of their numbers' height, capitals being 8.6 high.
    let place = |text: &str| {
        let label = labels.iter().find(|label| label.text == text);
        label.map(|label| {
            (
                0.5 * (label.x[0] + label.x[1]),
                0.5 * (label.y[0] + label.y[1]),
            )
        })
    };
    let (_, top) = place("1440").expect("it is a tick");
    let start = svg.find("class=\"curves\"").expect("there are curves");
    let data = svg[start..]
        .split("<path d=\"")
        .nth(10)
        .expect("the line `turn` is the tenth");
    let data = &data[..data.find('"').expect("it ends")];
    let points: Vec<[f64; 2]> = data
        .split(['M', 'L'])
        .filter(|point| !point.is_empty())
        .map(|point| {
            let mut numbers = point.split(' ').map(|n| n.parse().expect("a number"));
            [numbers.next(), numbers.next()].map(|n| n.expect("two numbers"))
        })
        .collect();
    let [first, last] = [points[0], points[points.len() - 1]];
    // Numbers have two decimals.
    assert!((last[1] - top).abs() < 0.02, "{last:?} {top}");
    assert!((place("4.0").expect("a tick").0 - last[0]).abs() < 10.0);
    for point in &points {
        let part = (point[0] - first[0]) / (last[0] - first[0]);
        let expected = first[1] + part * (last[1] - first[1]);
        assert!((point[1] - expected).abs() < 0.02, "{point:?}");
    }
    // An infinite value leaves a gap in the line: it starts once, in the middle.
    let gap = svg[start..]
        .split("<path d=\"")
        .nth(11)
        .expect("it is the eleventh");
    let begin: f64 = gap[1..gap.find(' ').expect("a number ends")]
        .parse()
        .expect("a number");
    assert!(begin > 0.5 * (first[0] + last[0]));
}
