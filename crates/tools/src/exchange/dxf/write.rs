//! Entities as a drawing in DXF of release 12, in ASCII and millimetres.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::arcs::Vertex;

/// Entities by layers. Lengths are in millimetres.
#[derive(Debug, Default)]
pub(super) struct Entities {
    /// Colours of the layers, by name.
    layers: BTreeMap<String, u8>,
    text: String,
}

impl Entities {
    /// Adds the beginning of an entity.
    fn begin(&mut self, kind: &str, layer: &str) {
        // Seven colours that every program shows.
        let next = u8::try_from(self.layers.len() % 7).unwrap_or(0) + 1;
        self.layers.entry(layer.to_owned()).or_insert(next);
        self.pair(0, kind);
        self.pair(8, layer);
    }

    fn pair(&mut self, code: i32, value: &str) {
        let _ = writeln!(self.text, "{code:>3}\n{value}");
    }

    fn number(&mut self, code: i32, value: f64) {
        // Zero has no sign.
        let text = format!("{:.9}", value + 0.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        self.pair(code, if text == "-0" { "0" } else { text });
    }

    fn point(&mut self, code: i32, [x, y]: [f64; 2]) {
        for (code, value) in [(code, x), (code + 10, y), (code + 20, 0.0)] {
            self.number(code, value);
        }
    }

    pub(super) fn line(&mut self, layer: &str, ends: [[f64; 2]; 2]) {
        self.begin("LINE", layer);
        self.point(10, ends[0]);
        self.point(11, ends[1]);
    }

    pub(super) fn circle(&mut self, layer: &str, at: [f64; 2], radius: f64) {
        self.begin("CIRCLE", layer);
        self.point(10, at);
        self.number(40, radius);
    }

    pub(super) fn write(&mut self, layer: &str, at: [f64; 2], height: f64, text: &str) {
        self.begin("TEXT", layer);
        self.point(10, at);
        self.number(40, height);
        self.pair(1, text);
    }

    pub(super) fn polyline(&mut self, layer: &str, vertices: &[Vertex], closed: bool) {
        self.begin("POLYLINE", layer);
        self.pair(66, "1");
        self.point(10, [0.0; 2]);
        self.pair(70, if closed { "1" } else { "0" });
        for vertex in vertices {
            self.begin("VERTEX", layer);
            self.point(10, vertex.at);
            if vertex.bulge != 0.0 {
                // Its error times the chord is a distance.
                let bulge = format!("{:.15}", vertex.bulge);
                self.pair(42, &bulge);
            }
        }
        self.begin("SEQEND", layer);
    }

    /// Returns the drawing.
    pub(super) fn drawing(self) -> String {
        let header = [
            (0, "SECTION"),
            (2, "HEADER"),
            (9, "$ACADVER"),
            (1, "AC1009"),
            (9, "$INSUNITS"),
            (70, "4"),
            (9, "$MEASUREMENT"),
            (70, "1"),
            (0, "ENDSEC"),
            (0, "SECTION"),
            (2, "TABLES"),
            (0, "TABLE"),
            (2, "LTYPE"),
            (70, "1"),
            (0, "LTYPE"),
            (2, "CONTINUOUS"),
            (70, "0"),
            (3, "Solid"),
            (72, "65"),
            (73, "0"),
            (40, "0.0"),
            (0, "ENDTAB"),
            (0, "TABLE"),
            (2, "LAYER"),
        ];
        let mut drawing = Self::default();
        for (code, value) in header {
            drawing.pair(code, value);
        }
        drawing.pair(70, &self.layers.len().to_string());
        for (layer, colour) in &self.layers {
            drawing.pair(0, "LAYER");
            drawing.pair(2, layer);
            drawing.pair(70, "0");
            drawing.pair(62, &colour.to_string());
            drawing.pair(6, "CONTINUOUS");
        }
        let middle = [
            (0, "ENDTAB"),
            (0, "ENDSEC"),
            (0, "SECTION"),
            (2, "ENTITIES"),
        ];
        for (code, value) in middle {
            drawing.pair(code, value);
        }
        drawing.text.push_str(&self.text);
        drawing.pair(0, "ENDSEC");
        drawing.pair(0, "EOF");
        drawing.text
    }
}
