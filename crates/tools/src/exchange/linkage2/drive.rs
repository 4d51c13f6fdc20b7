//! Inputs, which turn links about their anchors, and actuators.

use super::document::Document;
use super::xml::Element;
use crate::exchange::draft::{Coordinate, Draft, Driver, DriverSource};
use crate::exchange::error::Error;
use crate::exchange::note::Note;
use crate::exchange::sketch::Bodies;
use biela::mechanism::rounded;

/// A coordinate that goes out and back over a stroke at a constant speed.
struct Sweep {
    /// 1 if it goes out towards greater values, otherwise −1.
    side: f64,
    /// Way from the inner end to where it is drawn, in `unit`.
    inside: f64,
    /// Length of the stroke, in `unit`.
    stroke: f64,
    unit: &'static str,
}

impl Sweep {
    /// Returns the values at both ends of the stroke, from the drawn one.
    fn ends(&self) -> [f64; 2] {
        let ends = [-self.inside, self.stroke - self.inside].map(|end| self.side * end);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// Returns the motion at a rate, an expression that is positive outwards. `size` is the size of
    /// `unit` in the unit of the coordinate.
    fn motion(&self, rate: &str, size: f64) -> DriverSource {
        let number = |value: f64| match rounded(value, 12) {
            0.0 => "0".to_owned(),
            value => format!("{value}*{}", self.unit),
        };
        // The distance from the middle of the period is least at the outer end.
        let start = match self.inside {
            0.0 => String::new(),
            inside => format!("{} + ", number(inside)),
        };
        let way = format!("{start}{rate}*t").replace("+ -", "- ");
        let period = number(2.0 * self.stroke);
        let sign = if self.side > 0.0 { "-" } else { "" };
        DriverSource::Added {
            shift: self.side * (self.stroke - self.inside) * size,
            text: format!("{sign}abs(mod({way}, {period}) - {})", number(self.stroke)),
        }
    }
}

impl Document<'_> {
    pub(super) fn inputs(&self, draft: &mut Draft, bodies: &Bodies) -> Result<(), Error> {
        for (point, element) in self.connectors.iter().enumerate() {
            if !element.is("input") {
                continue;
            }
            let name = self.sketch.name(point);
            let left_out = |reason| Note::LeftOut {
                kind: "input",
                name: name.to_owned(),
                reason,
            };
            let [from, to, others @ ..] = &bodies.at_point[point][..] else {
                draft.note(left_out("no link turns about it"));
                continue;
            };
            if !element.is("anchor") {
                draft.note(Note::MovingInput {
                    name: name.to_owned(),
                });
            }
            if !others.is_empty() {
                draft.note(left_out("a further link is free to turn about it"));
            }
            let rpm = element.number("rpm")?;
            let limit = element.number("limitangle")?;
            let sweep = Sweep {
                // A positive speed is clockwise.
                side: -1.0_f64.copysign(rpm),
                inside: element.number("startoffset")?,
                stroke: limit,
                unit: "deg",
            };
            let is_swept = sweep.stroke > 0.0 && (0.0..=sweep.stroke).contains(&sweep.inside);
            if !is_swept && (sweep.stroke != 0.0 || sweep.inside != 0.0) {
                draft.note(Note::LeftOut {
                    kind: "limits of input",
                    name: name.to_owned(),
                    reason: "its start is not between them",
                });
            }
            let (source, limits) = if element.is("alwaysmanual") || rpm == 0.0 {
                let start = draft.drawn(Coordinate::Angle, *from, *to);
                let ends = sweep.ends().map(|end| start + end.to_radians());
                (DriverSource::Input, is_swept.then_some(ends))
            } else if is_swept {
                let cycle = 120.0 * sweep.stroke / (360.0 * rpm.abs());
                draft.run_for(cycle);
                let speed = draft.speed(-rpm);
                let rate = match speed.strip_prefix('-') {
                    _ if rpm < 0.0 => speed,
                    Some(speed) => speed.to_owned(),
                    None => format!("-{speed}"),
                };
                (sweep.motion(&rate, 1_f64.to_radians()), None)
            } else {
                (draft.turning(-rpm), None)
            };
            draft.drivers.push(Driver {
                name: format!("{name}_angle"),
                coordinate: Coordinate::Angle,
                from: *from,
                to: *to,
                source,
                limits,
            });
        }
        Ok(())
    }

    /// Adds the length of an actuator as a driver.
    pub(super) fn actuator(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        element: &Element,
    ) -> Result<(), Error> {
        let name = element.label("actuator_");
        let points = self.points(&format!("link `{name}`"), element)?;
        let first = |point: &usize| bodies.at_point[*point].first().copied();
        let ends = match &points[..] {
            [a, b] => first(a).zip(first(b)),
            _ => None,
        };
        let ends = ends.filter(|(from, to)| from.body != to.body);
        let Some((from, to)) = ends else {
            draft.note(Note::LeftOut {
                kind: "actuator",
                name,
                reason: "its two ends are not on two bodies",
            });
            return Ok(());
        };
        let throw = element.number("throw")? / self.per_unit;
        let cpm = element.number("cpm")?;
        let inside = element.number("startoffset")? / self.per_unit;
        let drawn = draft.drawn(Coordinate::Distance, from, to);
        let sweep = Sweep {
            side: 1.0_f64.copysign(cpm) * throw.signum(),
            inside,
            stroke: throw.abs(),
            unit: draft.unit.name(),
        };
        let ends = sweep.ends().map(|end| drawn + end);
        let is_swept =
            throw != 0.0 && ends[0] > 0.0 && (0.0..=sweep.stroke).contains(&sweep.inside);
        if !is_swept && (throw != 0.0 || inside != 0.0) {
            draft.note(Note::LeftOut {
                kind: "the stroke of actuator",
                name: name.clone(),
                reason: "its ends are no lengths around the drawn one",
            });
        }
        let (source, limits) = if is_swept && cpm != 0.0 && !element.is("alwaysmanual") {
            draft.run_for(60.0 / cpm.abs());
            // Out and back in one cycle.
            let speed = rounded(2.0 * sweep.stroke * cpm.abs() / 60.0, 12);
            let rate = format!("{speed}*{}", draft.unit.name());
            (sweep.motion(&rate, 1.0), None)
        } else {
            (DriverSource::Input, is_swept.then_some(ends))
        };
        draft.drivers.push(Driver {
            name,
            coordinate: Coordinate::Distance,
            from,
            to,
            source,
            limits,
        });
        Ok(())
    }
}
