//! Motions and limits of joints in the plane.

use super::Reader;
use super::assembly::{AsmtMotion, Limit, Marker};
use super::expression;
use crate::exchange::draft::{Coordinate, Driver, DriverSource, LengthUnit, PointRef, Stop};
use crate::exchange::error::Error;
use crate::exchange::note::Note;

/// Part of a limit's value by which a drawn coordinate may be beyond it: the digits of the source.
const ON_LIMIT: f64 = 1e-9;

impl Reader<'_> {
    /// Adds a driver for a motion.
    pub(super) fn motion(&mut self, motion: &AsmtMotion) -> Result<(), Error> {
        let [i, j] = &motion.markers;
        let out_of_plane = || Error::OutOfPlane {
            joint: motion.name.clone(),
            class: motion.class.clone(),
        };
        let z = i.place.z();
        let (coordinate, side) = match &*motion.class {
            "RotationalMotion" if self.plane.is_normal(z) => {
                (Coordinate::Angle, self.plane.side(z))
            }
            "TranslationalMotion" if self.plane.is_within(z) => (Coordinate::X, 1.0),
            "RotationalMotion" | "TranslationalMotion" => return Err(out_of_plane()),
            "AllowRotation" => {
                self.draft.note(Note::LeftOut {
                    kind: "motion",
                    name: motion.name.clone(),
                    reason: "it drives nothing",
                });
                return Ok(());
            }
            class => {
                return Err(Error::UnknownMotion {
                    motion: motion.name.clone(),
                    class: class.to_owned(),
                });
            }
        };
        let (from, to) = self.measured(i, j, coordinate);
        let text = expression::motion(&motion.text);
        let source = match text {
            Some(text) => DriverSource::Motion(self.scaled(text, coordinate, side)),
            None => {
                self.draft.note(Note::Motion {
                    name: motion.name.clone(),
                    text: motion.text.clone(),
                });
                DriverSource::Input
            }
        };
        let name = self.name(&motion.name);
        self.draft.drivers.push(Driver {
            name,
            coordinate,
            from,
            to,
            source,
            limits: None,
        });
        Ok(())
    }

    /// Returns the markers between which a coordinate of a joint is measured.
    fn measured(&mut self, i: &Marker, j: &Marker, coordinate: Coordinate) -> (PointRef, PointRef) {
        match coordinate {
            Coordinate::Angle => (self.with_x_axis(i), self.with_x_axis(j)),
            _ => {
                let angle = self.plane.angle(i.place.z());
                (self.place(i, Some(angle)), self.place(j, Some(angle)))
            }
        }
    }

    /// Returns an expression with the sense of the plane, in SI units.
    fn scaled(&self, text: String, coordinate: Coordinate, side: f64) -> String {
        let unit = self.draft.unit;
        let scaled = match coordinate {
            Coordinate::Angle => text,
            _ if unit == LengthUnit::Metre => text,
            _ if text.parse::<f64>().is_ok() => format!("{text}*{}", unit.name()),
            _ => format!("({text})*{}", unit.name()),
        };
        if side < 0.0 {
            format!("-({scaled})")
        } else {
            scaled
        }
    }

    /// Adds a stop for a limit; two of one joint are one stop.
    pub(super) fn limit(&mut self, limit: &Limit) -> Result<(), Error> {
        let [i, j] = &limit.markers;
        let z = i.place.z();
        let note = |reason| Note::Limit {
            name: limit.name.clone(),
            reason,
        };
        let (coordinate, side) = if limit.turns && self.plane.is_normal(z) {
            (Coordinate::Angle, self.plane.side(z))
        } else if !limit.turns && self.plane.is_within(z) {
            (Coordinate::X, 1.0)
        } else {
            self.draft.note(note("it limits nothing in the plane"));
            return Ok(());
        };
        let value = expression::constant(&limit.text);
        let Some((value, number)) = value else {
            self.draft.note(note("its value has no counterpart"));
            return Ok(());
        };
        let value = self.scaled(value, coordinate, side);
        let at_least = (limit.kind == "=>") == (side > 0.0);
        let (from, to) = self.measured(i, j, coordinate);
        let drawn = self.draft.drawn(coordinate, from, to) - side * number;
        // Sizes of a mechanism are some units, those of angles some radians.
        let tolerance = ON_LIMIT * number.abs().max(1.0);
        if (at_least && drawn < -tolerance) || (!at_least && drawn > tolerance) {
            self.draft.note(note("it is drawn beyond it"));
            return Ok(());
        }
        let mut stops = self.draft.stops.iter_mut();
        let same =
            stops.find(|stop| stop.coordinate == coordinate && stop.from == from && stop.to == to);
        let stop = match same {
            Some(stop) => stop,
            None => {
                let name = self.name(&limit.name);
                self.draft.stops.push(Stop {
                    name,
                    coordinate,
                    from,
                    to,
                    min: None,
                    max: None,
                });
                let last = self.draft.stops.len() - 1;
                &mut self.draft.stops[last]
            }
        };
        if at_least {
            stop.min = Some(value)
        } else {
            stop.max = Some(value)
        }
        Ok(())
    }
}
