//! Documents of Linkage, written from links through pins.

use std::f64::consts::PI;
use std::fmt::Write as _;

use super::PER_INCH;
use crate::exchange::pins::Pins;
use biela::mechanism::{rounded, shortest};

/// Speed of an input without a motion, which is moved by hand \[rpm\].
const RPM: f64 = 15.0;

/// Layer of mechanisms.
const LAYER: u32 = 16;

/// Returns a document of Linkage, with lengths in millimetres.
#[must_use]
pub fn linkage_document(pins: &Pins) -> String {
    let mut text = String::from("<linkage2>\r\n");
    text.push_str("\t<program units=\"Millimeters\"/>\r\n");
    let at = |at: [f64; 2]| at.map(|x| shortest(x / 0.0254 * PER_INCH, 6));
    // Ways reach as far as the mechanism does.
    let reach = pins.pins.iter().flat_map(|pin| pin.at);
    let reach = reach.fold(0.0, |most: f64, x| most.max(x.abs()));
    let mut next = pins.pins.len();
    let mut ends = Vec::new();
    for (index, pin) in pins.pins.iter().enumerate() {
        let [x, y] = at(pin.at);
        let name = quick_xml::escape::escape(&pin.name);
        let _ = write!(
            text,
            "\t<connector id=\"{index}\" name=\"{name}\" layer=\"{LAYER}\" x=\"{x}\" y=\"{y}\""
        );
        if pin.is_ground {
            text.push_str(" anchor=\"true\"");
        }
        if let Some(input) = pins.inputs.iter().find(|input| input.pin == index) {
            // A positive speed is clockwise.
            let rpm = input.speed.map_or(RPM, |speed| -speed * 30.0 / PI);
            let _ = write!(text, " input=\"true\" rpm=\"{}\"", rounded(rpm, 9));
            if input.speed.is_none() {
                text.push_str(" alwaysmanual=\"true\"");
            }
        }
        if pin.is_shown {
            text.push_str(" draw=\"true\"");
        }
        match pin.way {
            None => text.push_str("/>\r\n"),
            Some(angle) => {
                let (sin, cos) = angle.sin_cos();
                let limits = [-reach, reach].map(|way| {
                    let end = [pin.at[0] + way * cos, pin.at[1] + way * sin];
                    ends.push((next, at(end)));
                    next += 1;
                    next - 1
                });
                let _ = write!(
                    text,
                    " slider=\"true\">\r\n\t\t<slidelimit id=\"{}\"/>\r\n\t\t<slidelimit id=\"{}\"/>\r\n\t</connector>\r\n",
                    limits[0], limits[1]
                );
            }
        }
    }
    for (id, [x, y]) in ends {
        let _ = write!(
            text,
            "\t<connector id=\"{id}\" layer=\"{LAYER}\" x=\"{x}\" y=\"{y}\" anchor=\"true\"/>\r\n"
        );
    }
    // The block of a slider is its connector.
    let links = pins.links.iter().filter(|link| link.pins.len() > 1);
    for (index, link) in links.enumerate() {
        let name = quick_xml::escape::escape(&link.name);
        let _ = write!(
            text,
            "\t<Link id=\"{index}\" name=\"{name}\" layer=\"{LAYER}\">\r\n"
        );
        for pin in &link.pins {
            let _ = write!(text, "\t\t<connector id=\"{pin}\"/>\r\n");
        }
        text.push_str("\t</Link>\r\n");
    }
    text.push_str("</linkage2>\r\n");
    text
}
