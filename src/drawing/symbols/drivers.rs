//! Arrows and dimension lines of drivers.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::names::around;
use super::{LINE, PIN, Pen, THIN, on_sheet_direction};
use crate::drawing::labels::{Candidate, Label};
use crate::drawing::outline::{Outline, Point, across, unit};
use crate::drawing::palette::Colour;
use crate::drawing::rider::Rider;
use crate::drawing::scene::{Anchor, Frame};
use crate::drawing::sheet::{Layer, Mark};

/// Radius of an angle driver's arc.
const ARC: f64 = 27.0;
/// An angle smaller than this, 20°, has no room for an arrow.
const SEEN: f64 = PI / 9.0;
/// The arc where the angle itself is too small to be seen.
const SMALL_ARC: f64 = 1.6;
/// A line shorter than this has no room for two arrows.
const SHORT: f64 = 18.0;
/// How far a dimension line lies beside what it measures.
pub(in crate::drawing) const BESIDE: f64 = 21.0;
/// How far a dimension line between two pins ends before their middle.
const DRIVER_INSET: f64 = PIN + 1.0;
/// Length and half the width of an arrow.
const ARROW: [f64; 2] = [8.0, 2.9];

impl Pen<'_> {
    pub(super) fn angle_driver(&mut self, name: &str, from: Anchor, to: Anchor) {
        let Frame {
            angle: reference, ..
        } = from.placed(self.q);
        let (center, axis) = self.place(to);
        let turn = (to.placed(self.q).angle - reference) % TAU;
        // The arrow alone can turn with its body.
        let seen = !self.moving && (SEEN..=TAU - SEEN).contains(&turn.abs());
        let (start, turn) = if seen {
            let foot = on_sheet_direction(reference);
            let line = Outline::line(&[center + PIN * foot, center + (ARC + 8.0) * foot]);
            self.line(Layer::Driver, line, Colour::DRIVER, THIN);
            (reference, turn)
        } else {
            let towards = to.placed(self.q).angle;
            (towards - 0.5 * SMALL_ARC, SMALL_ARC)
        };
        // The arrow's length belongs to the arc; on the sheet angles count clockwise.
        let tip = if seen {
            axis
        } else {
            on_sheet_direction(start + turn)
        };
        let ahead = turn.signum();
        let shaft = turn - ahead * ARROW[0] / ARC;
        let arc = Outline::arc(center, ARC, -start, -shaft);
        self.line(Layer::Driver, arc, Colour::DRIVER, LINE);
        let chord = on_sheet_direction(start + turn + ahead * (FRAC_PI_2 - 0.5 * ARROW[0] / ARC));
        self.arrow(center + ARC * tip, chord);
        let mut candidates = Vec::new();
        for (part, cost) in [(0.5, 0.0), (0.7, 1.0), (0.3, 1.0), (0.9, 3.0), (0.1, 3.0)] {
            for (gap, far) in [(4.0, 0.0), (12.0, 4.0), (24.0, 10.0)] {
                let side = on_sheet_direction(start + part * turn);
                candidates.push(Candidate {
                    anchor: center + ARC * side,
                    side: Some(side),
                    gap,
                    cost: cost + far,
                });
            }
        }
        // If all along the arc is taken, near it.
        let middle = on_sheet_direction(start + 0.5 * turn);
        candidates.extend(around(center, ARC + 2.0).map(|mut candidate| {
            let off = candidate.side.map_or(0.0, |side| 1.0 - side.dot(&middle));
            candidate.cost += 2.0 + 4.0 * off;
            candidate
        }));
        self.driver_labels.push(Label {
            content: name.to_owned(),
            colour: Colour::DRIVER.shade(0.8),
            follows: Rider::Point(to),
            may_miss: false,
            candidates,
        });
    }

    pub(super) fn length_driver(
        &mut self,
        name: &str,
        markers: [Anchor; 2],
        axis: Option<Anchor>,
        beside: bool,
    ) {
        let [from, to] = markers.map(|marker| self.place(marker).0);
        let along = axis.map_or_else(|| unit(to - from), |axis| self.place(axis).1);
        let aside = self.away(across(along), 0.5 * (from + to));
        let offset = if beside {
            BESIDE * aside
        } else {
            Point::zeros()
        };
        // For a coordinate along an axis, the line lies at the point that is driven.
        let foot = to - (to - from).dot(&along) * along;
        let short = (to - foot).norm() < SHORT;
        let [start, end] = if short {
            [to - SHORT * along, to + SHORT * along]
        } else {
            [foot, to]
        };
        let inset = if beside { 0.0 } else { DRIVER_INSET };
        let forth = unit(end - start);
        let [start, end] = [start + offset + inset * forth, end + offset - inset * forth];
        if beside && !short && !self.moving {
            for (point, line_end) in [(from, start), (to, end)] {
                let away = unit(line_end - point);
                let extension = Outline::line(&[point + (PIN + 2.0) * away, line_end + 4.0 * away]);
                self.line(Layer::Driver, extension, Colour::DRIVER, THIN);
            }
        }
        let arrow = 0.8 * ARROW[0] * forth;
        let line = Outline::line(&[start + arrow, end - arrow]);
        if self.moving {
            self.changing.push(Mark {
                layer: Layer::Driver,
                outline: line,
                fill: None,
                stroke: None,
            });
        } else {
            self.line(Layer::Driver, line, Colour::DRIVER, LINE);
            self.arrow(end, forth);
            self.arrow(start, -forth);
        }
        let mut candidates = Vec::new();
        for (part, cost) in [(0.5, 0.0), (0.35, 1.0), (0.65, 1.0), (0.2, 3.0), (0.8, 3.0)] {
            for (side, other) in [(aside, 0.0), (-aside, 1.0)] {
                for (gap, far) in [(5.0, 0.0), (14.0, 5.0)] {
                    candidates.push(Candidate {
                        anchor: start + part * (end - start),
                        side: Some(side),
                        gap,
                        cost: cost + other + far,
                    });
                }
            }
        }
        for tip in [start, end] {
            candidates.extend(around(tip, 5.0));
        }
        self.driver_labels.push(Label {
            content: name.to_owned(),
            colour: Colour::DRIVER.shade(0.8),
            follows: Rider::Point(markers[1]),
            may_miss: false,
            candidates,
        });
    }

    /// On which side of a length driver's line it is drawn: 1 for that of the axis turned by a
    /// quarter turn on the sheet, -1 for the other.
    pub(in crate::drawing) fn side_of_length(
        &self,
        markers: [Anchor; 2],
        axis: Option<Anchor>,
    ) -> f64 {
        let [from, to] = markers.map(|marker| self.place(marker).0);
        let along = axis.map_or_else(|| unit(to - from), |axis| self.place(axis).1);
        let aside = across(along);
        aside.dot(&self.away(aside, 0.5 * (from + to)))
    }

    /// This direction or the opposite one: away from the mechanism.
    fn away(&self, aside: Point, from: Point) -> Point {
        if aside.dot(&(self.middle - from)) > 1e-6 {
            -aside
        } else {
            aside
        }
    }

    fn arrow(&mut self, tip: Point, along: Point) {
        let [length, half] = ARROW;
        let base = tip - length * along;
        let aside = half * across(along);
        let outline = Outline::polygon(&[tip, base + aside, base - aside]);
        self.area(Layer::Driver, outline, (Colour::DRIVER, 1.0), None);
    }
}
