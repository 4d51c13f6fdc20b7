//! Pictures of mechanisms, and their texts.

use biela_tools::drawing::{Scene, Sheet, svg};
use quick_xml::Reader;
use quick_xml::events::Event;

use crate::common::{assembled, shipped};

pub(crate) const WIDTH: u32 = 640;

pub(crate) fn picture(name: &str) -> String {
    let (mut solver, _) = assembled(&shipped(name));
    let scene = Scene::new(&mut solver, true);
    svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false)
}

/// A text on the sheet with its box.
pub(crate) struct Label {
    pub(crate) text: String,
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

/// Returns the texts of a picture. Fails unless it is well-formed and everything is on the sheet.
pub(crate) fn check_picture(name: &str, svg: &str) -> Vec<Label> {
    let mut reader = Reader::from_str(svg);
    let (mut size, mut labels, mut open): ([f64; 2], Vec<Label>, bool) =
        ([0.0; 2], Vec::new(), false);
    loop {
        match reader.read_event().expect("the picture is well-formed") {
            Event::Eof => break,
            Event::Start(element) | Event::Empty(element) => {
                let attribute = |key: &str| {
                    element
                        .try_get_attribute(key)
                        .expect("attributes are well-formed")
                        .map(|a| a.value.into_owned())
                };
                let value = |key: &str| attribute(key).map(|v| v.parse::<f64>().expect("a number"));
                open = element.name().as_ref() == "text";
                match element.name().as_ref() {
                    "svg" => {
                        let view = attribute("viewBox").expect("there is one");
                        let numbers: Vec<f64> = view
                            .split(' ')
                            .map(|n| n.parse().expect("a number"))
                            .collect();
                        size = [numbers[2], numbers[3]];
                    }
                    "path" => {
                        let data = attribute("d").expect("paths have data");
                        let numbers = data
                            .split(|c: char| c.is_ascii_alphabetic() || c == ' ')
                            .filter(|n| !n.is_empty());
                        for (index, number) in numbers.enumerate() {
                            let number: f64 = number.parse().expect("a number");
                            // Control points of curves may lie outside them, by less than the margin.
                            assert!(number >= 0.0 && number <= size[index % 2], "{name}: {data}");
                        }
                    }
                    "text" => {
                        let [x, y] = ["x", "y"].map(|key| value(key).expect("it has a place"));
                        let width = value("textLength").expect("it has a width");
                        // Capitals are 8.6 high.
                        labels.push(Label {
                            text: String::new(),
                            x: [x, x + width],
                            y: [y - 8.6, y],
                        });
                        assert!(
                            x >= 0.0 && x + width <= size[0] && y >= 8.6 && y <= size[1],
                            "{name}"
                        );
                    }
                    _ => {}
                }
            }
            Event::Text(text) if open => {
                labels.last_mut().expect("a text is open").text = text.to_string();
                open = false;
            }
            _ => {}
        }
    }
    labels
}

pub(crate) fn check_apart(name: &str, labels: &[Label]) {
    for (index, a) in labels.iter().enumerate() {
        for b in &labels[..index] {
            let apart = [(a.x, b.x), (a.y, b.y)]
                .iter()
                .any(|(p, q)| p[1] <= q[0] || q[1] <= p[0]);
            assert!(apart, "{name}: {} and {}", a.text, b.text);
        }
    }
}
