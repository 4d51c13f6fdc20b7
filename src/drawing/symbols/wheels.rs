//! Wheels, belts and racks.

use std::f64::consts::TAU;

use super::names::around;
use super::{BAR, DASH_DOTS, HATCH, LINE, Pen, THIN, colour_of, on_sheet_direction};
use crate::drawing::labels::{Candidate, ON_WHEEL};
use crate::drawing::outline::{Outline, across, unit};
use crate::drawing::palette::Colour;
use crate::drawing::scene::Anchor;
use crate::drawing::sheet::Layer;

/// Thickness of a ring gear, and length of the mark on a wheel.
const RIM: f64 = 10.0;
/// Pitch and height of a rack's teeth.
pub(super) const TOOTH: [f64; 2] = [9.0, 5.0];
/// Height of a rack under its teeth.
pub(super) const RACK_BODY: f64 = 2.0 * BAR;

impl Pen<'_> {
    pub(super) fn wheel(&mut self, at: Anchor, radius: f64, ring: bool) {
        let (center, axis) = self.place(at);
        let colour = colour_of(at.body);
        let radius = radius * self.scale;
        let mark = if ring {
            let mut rim = Outline::circle(center, radius);
            rim.0.extend(Outline::circle(center, radius + RIM).0);
            self.line(Layer::Wheel, rim, colour, LINE);
            [radius, radius + RIM]
        } else {
            let pitch = Outline::circle(center, radius);
            self.area(Layer::Wheel, pitch.clone(), (colour, 0.2), None);
            self.dashed(Layer::Wheel, pitch, colour, LINE, DASH_DOTS);
            [(radius - RIM).max(0.6 * radius), radius]
        };
        if at.body.is_some() {
            // What shows how far it has turned.
            let mark = Outline::line(&mark.map(|r| center + r * axis));
            self.line(Layer::Wheel, mark, colour.shade(0.8), 2.4);
        } else if ring {
            let outer = radius + RIM;
            let count = (TAU * outer / (2.0 * HATCH)).round();
            let mut hatching = Outline::default();
            for k in 0..count as usize {
                let out = on_sheet_direction(k as f64 / count * TAU);
                let foot = center + outer * out;
                hatching.add_line(&[foot, foot + HATCH * (out - across(out))]);
            }
            self.line(Layer::Wheel, hatching, colour, THIN);
        }
        if let Some(body) = at.body {
            let outside = if ring { radius + RIM } else { radius };
            let places = &mut self.body_places[body.index()];
            places.extend(around(center, outside + 1.0));
            let inside = around(center, 0.35 * radius).chain(around(center, 0.6 * radius));
            places.extend(inside.map(|candidate| Candidate {
                cost: candidate.cost - if ring { 0.0 } else { ON_WHEEL },
                ..candidate
            }));
        }
    }

    pub(super) fn belt(&mut self, centers: [Anchor; 2], radii: [f64; 2], crossed: bool) {
        let [a, b] = centers.map(|center| self.place(center).0);
        let [r, s] = radii.map(|radius| radius * self.scale);
        let (along, distance) = (unit(b - a), (b - a).norm());
        let far = if crossed { -s } else { s };
        // The tangents touch both circles under the same angle from the line of centres.
        let cosine = (r - far) / distance;
        if cosine.abs() >= 1.0 {
            return;
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        for side in [1.0, -1.0] {
            let normal = cosine * along + side * sine * across(along);
            let tangent = Outline::line(&[a + r * normal, b + far * normal]);
            self.line(Layer::Wheel, tangent, Colour::INK, LINE);
        }
        for (center, radius) in [(a, r), (b, s)] {
            let circle = Outline::circle(center, radius);
            self.line(Layer::Wheel, circle, Colour::INK, LINE);
        }
    }

    pub(super) fn rack(&mut self, along: Anchor, range: [f64; 2], above: bool) {
        let (_, axis) = self.place(along);
        let [start, end] = self.ends(along, range);
        let colour = colour_of(along.body);
        let towards = if above { -across(axis) } else { across(axis) };
        let [pitch, height] = TOOTH;
        let length = (end - start).norm();
        let count = (length / pitch).round().max(1.0);
        let pitch = length / count;
        let (root, tip) = (-0.5 * height * towards, 0.5 * height * towards);
        let at = |s: f64| start + s * axis;
        let mut profile = vec![at(0.0) + root];
        for k in 0..count as usize {
            let s = k as f64 * pitch;
            profile.extend([
                at(s + 0.1 * pitch) + root,
                at(s + 0.3 * pitch) + tip,
                at(s + 0.7 * pitch) + tip,
                at(s + 0.9 * pitch) + root,
            ]);
        }
        profile.push(at(length) + root);
        if along.body.is_some() {
            let back = -(0.5 * height + RACK_BODY) * towards;
            profile.extend([at(length) + back, at(0.0) + back]);
            let outline = Outline::polygon(&profile);
            self.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
            self.places_beside(along.body, [start + back, end + back], -towards);
        } else {
            self.line(Layer::Ground, Outline::line(&profile), Colour::GROUND, LINE);
            let under = -(0.5 * height + 4.0) * towards;
            self.hatched([start + under, end + under], -towards);
        }
        let pitch_line = Outline::line(&[start, end]);
        self.dashed(Layer::Slot, pitch_line, colour, THIN, DASH_DOTS);
    }
}
