//! Warnings of values that are legal but probably in another unit than meant.

use std::borrow::Cow;

use crate::mechanism::diagnostic::code;
use crate::mechanism::unit_slip::{
    GAP, LARGE, is_plain, large_angle, large_angles, large_in, large_velocity,
};
use crate::mechanism::wording::{quoted, shown};
use crate::mechanism::{Dimension, DisplayUnit, Jet, Span, Unit};

use super::context::{Context, Length};
use super::number::Quantity;

/// Help for an angle in degrees, before the text to write.
const DEGREES: &str = "degrees are written";

impl<'a> Context<'a> {
    /// Warns of a quantity in place of one in `unit` that has another dimension, or that looks
    /// like degrees.
    pub(super) fn warn_of_unit(&mut self, quantity: &Quantity, unit: Unit) {
        self.warn_of_dimension(quantity, unit.dimension);
        if unit.dimension == Dimension::ANGLE {
            self.warn_of_degrees(quantity);
        }
        if let (Dimension::LENGTH, Some(value)) = (unit.dimension, quantity.value)
            && value != 0.0
        {
            let bare = self.bare_text(quantity).is_some();
            self.lengths.push(Length {
                size: value.abs(),
                bare: bare.then(|| quantity.span.clone()),
            });
        }
    }

    /// Warns of a parameter's value that has another dimension than its unit, or looks like one in
    /// its display unit.
    pub(super) fn warn_of_parameter(&mut self, value: &Quantity, unit: Unit) {
        match unit.display {
            Some(display) if self.warn_of_display(value, display) => {}
            _ => self.warn_of_unit(value, unit),
        }
    }

    /// Warns of a length or angle whose value has another dimension.
    fn warn_of_dimension(&mut self, quantity: &Quantity, expected: Dimension) {
        let Some(dimension) = quantity.dimension else {
            return;
        };
        let is_checked = [Dimension::LENGTH, Dimension::ANGLE].contains(&expected);
        if !is_checked || dimension.agrees_with(expected) {
            return;
        }
        let file = self.source.text();
        let text = file.get(quantity.span.clone()).unwrap_or_default();
        let text = quoted(text.trim_matches(['"', '\'']));
        let before = file.get(..quantity.span.start).unwrap_or_default();
        let is_component = before.trim_end().ends_with(['[', ',']);
        let (found, expected) = (describe(dimension), describe(expected));
        let message = format!("{text} is {found}, in place of {expected}");
        let problem = self.warn(code::WRONG_DIMENSION, quantity.span.clone(), message);
        if is_component && dimension == Dimension::ANGLE {
            problem.suggest("a marker in polar form is `{ r = 0.1, angle = \"10*deg\" }`");
        }
    }

    /// Warns of a sum, a difference or a comparison of quantities of different dimensions.
    pub(super) fn warn_of_clash(&mut self, span: Span, part: &str, dimensions: [Dimension; 2]) {
        let [a, b] = dimensions.map(describe);
        let message = format!("{part} combines {a} with {b}");
        self.warn(code::WRONG_DIMENSION, span, message);
    }

    /// Warns of an angle that is a bare number of more than a turn: it looks like degrees.
    pub(super) fn warn_of_degrees(&mut self, angle: &Quantity) {
        // The author of an expression has thought of the unit.
        let Some((text, value)) = self.bare_text(angle).zip(angle.value) else {
            return;
        };
        if let Some(message) = large_angle(value) {
            self.warn_of_large_angle(&angle.span, message, DEGREES, &format!("\"{text}*deg\""));
        }
    }

    /// Warns of a function of a bare angle of more than a turn, which stands at `span`: `cos(45)`.
    pub(super) fn warn_of_argument(&mut self, span: &Span, argument: &str) {
        let angle = argument.parse().ok().and_then(large_angle);
        if let Some(message) = angle {
            self.warn_of_large_angle(span, message, DEGREES, &format!("{argument}*deg"));
        }
    }

    /// Warns of a motion of an angle by plain numbers that looks like degrees: it has this value and
    /// this velocity at the start.
    pub(super) fn warn_of_motion(&mut self, span: &Span, start: Jet) {
        let text = self.source.text().get(span.clone()).unwrap_or_default();
        let text = text.trim_matches(['"', '\'']);
        if !is_plain(text) {
            return;
        }
        let written = format!("\"({text})*deg\"");
        if let Some(message) = large_angle(start.value) {
            self.warn_of_large_angle(span, message, DEGREES, &written);
        } else if let Some(message) = large_velocity(start.first()) {
            let help = "degrees per second are written";
            self.warn_of_large_angle(span, message, help, &written);
        }
    }

    /// Warns of bare angles of a table that look like degrees.
    pub(super) fn warn_of_angles(&mut self, span: &Span, angles: &[f64]) {
        if let Some(message) = large_angles(angles) {
            let help = "a column of degrees has";
            self.warn_of_large_angle(span, message, help, "scale = [1, \"deg\"]");
        }
    }

    /// Warns of an angle once per kind of help, which is followed by the text to write.
    fn warn_of_large_angle(&mut self, span: &Span, message: String, help: &str, written: &str) {
        if !self.warn_again(code::LARGE_ANGLE, help, span) {
            self.warn(code::LARGE_ANGLE, span.clone(), message)
                .suggest(format!("{help} `{written}`"));
        }
    }

    /// Warns of a bare number that is large in its display unit: it looks like one in that unit.
    /// Returns whether it does.
    fn warn_of_display(&mut self, quantity: &Quantity, display: DisplayUnit) -> bool {
        let Some((text, value)) = self.bare_text(quantity).zip(quantity.value) else {
            return false;
        };
        let Some((message, name)) = large_in(value, display) else {
            return false;
        };
        let help = "values are SI";
        if !self.warn_again(code::LARGE_LENGTH, help, &quantity.span) {
            self.warn(code::LARGE_LENGTH, quantity.span.clone(), message)
                .suggest(format!("{help}: `value = \"{text}*{name}\"`"));
        }
        true
    }

    /// Warns of a marker `[0,1, 0]`: a comma between whole numbers, beside one with a blank, looks
    /// like a decimal one.
    pub(super) fn warn_of_decimal_comma(&mut self, marker: Span) {
        let text = self.source.text().get(marker.clone()).unwrap_or_default();
        let is_part = |c: char| c.is_ascii_digit() || c == '.';
        let pairs = text.match_indices(',').filter_map(|(comma, _)| {
            let start = text[..comma].trim_end_matches(is_part).len();
            let end = text.len() - text[comma + 1..].trim_start_matches(is_part).len();
            (start < comma && end > comma + 1).then_some(start..end)
        });
        let [pair] = &pairs.collect::<Vec<_>>()[..] else {
            return;
        };
        let number = text[pair.clone()].replacen(',', ".", 1);
        // Two points, as in `[0.1,0.2, 0]`, or a second number that is zero are no slip.
        if number.matches('.').count() == 1 && !number.ends_with(".0") {
            let span = marker.start + pair.start..marker.start + pair.end;
            self.warn(
                code::DECIMAL_COMMA,
                span,
                "a marker's third number is its angle",
            )
            .suggest(format!("the decimal mark is a point: `{number}`"));
        }
    }

    /// Warns of bare lengths that are far larger than all others: they look like millimetres.
    pub(super) fn warn_of_large_lengths(&mut self) {
        let mut lengths = std::mem::take(&mut self.lengths);
        lengths.sort_by(|a, b| a.size.total_cmp(&b.size));
        let gap = |k: &usize| lengths[k - 1].size * GAP <= lengths[*k].size;
        let Some(first) = (1..lengths.len()).find(gap) else {
            self.warn_of_large_mechanism(&lengths);
            return;
        };
        let (usual, large) = lengths.split_at(first);
        let most = shown(usual[first - 1].size);
        for Length { size, bare } in large {
            if let Some(span) = bare
                && *size >= LARGE
            {
                let help = "millimetres are written";
                if self.warn_again(code::LARGE_LENGTH, help, span) {
                    continue;
                }
                let text = self.source.text().get(span.clone()).unwrap_or_default();
                let message = format!(
                    "a length of {} m beside others of up to {most} m",
                    shown(*size)
                );
                self.warn(code::LARGE_LENGTH, span.clone(), message)
                    .suggest(format!("{help} `\"{text}*mm\"`"));
            }
        }
    }

    /// Warns of a mechanism of bare lengths most of which, sorted by size, are larger than those of
    /// machines: it looks like one in millimetres.
    fn warn_of_large_mechanism(&mut self, lengths: &[Length]) {
        let all_bare = lengths.iter().all(|length| length.bare.is_some());
        let is_large = lengths
            .get(lengths.len() / 2)
            .is_some_and(|middle| middle.size >= LARGE);
        if let (true, [least, .., most]) = (all_bare && is_large, lengths)
            && let Some(span) = &most.bare
        {
            let text = self.source.text().get(span.clone()).unwrap_or_default();
            let [least, size] = [least, most].map(|length| shown(length.size));
            let message = format!("the mechanism has lengths from {least} m to {size} m");
            self.warn(code::LARGE_LENGTH, span.clone(), message)
                .suggest(format!(
                    "lengths are in metres: millimetres are written `\"{text}*mm\"`"
                ));
        }
    }

    /// Returns the text of a quantity that is a bare number, as expressions write it: they have no
    /// `0x10` and no `1_000`.
    fn bare_text(&self, quantity: &Quantity) -> Option<Cow<'a, str>> {
        let text = self.source.text().get(quantity.span.clone())?;
        if text.starts_with(['"', '\'']) {
            return None;
        }
        match text.parse::<f64>() {
            Ok(_) => Some(text.into()),
            Err(_) => Some(quantity.value?.to_string().into()),
        }
    }
}

/// Returns a dimension in words.
fn describe(dimension: Dimension) -> String {
    let words = [
        (Dimension::LENGTH, "a length"),
        (Dimension::ANGLE, "an angle"),
        (Unit::SECOND.dimension, "a time"),
        (Unit::KILOGRAM.dimension, "a mass"),
        (Unit::NEWTON.dimension, "a force"),
    ];
    if let Some((_, word)) = words.iter().find(|(known, _)| *known == dimension) {
        return (*word).to_owned();
    }
    format!("a quantity in {}", dimension.symbol())
}
