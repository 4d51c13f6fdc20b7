//! Loads: arrows of forces at a point, arcs of torques. Their length has no meaning.

use super::*;
use biela::mechanism::{ForceLaw, Simulation, Variable};

/// A force or a torque, or both, on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadArrow {
    /// The force's name in the file.
    pub name: String,
    /// The point at which it acts.
    pub at: Anchor,
    /// The anchor along whose axes the force is.
    pub axes: Anchor,
    /// Directions of arrows along these axes: of the force, or the positive ones of components
    /// that are inputs.
    pub arrows: Vec<[f64; 2]>,
    /// 1.0 for a torque counter-clockwise, -1.0 for one clockwise, 0.0 for none.
    pub turn: f64,
}

/// Length of a straight arrow.
const LENGTH: f64 = 34.0;
/// Distance of an arrow's end from its point.
const GAP: f64 = PIN + 2.0;
/// Radius and angle of an arc, and its angle between two straight arrows.
const RADIUS: f64 = 17.0;
const ARC: f64 = 4.0;
const QUARTER: f64 = 1.3;

/// Composes a force and torque at a marker, along the axes of an anchor; inputs without a law.
pub(super) fn compose_at(
    composer: &mut Composer,
    name: &str,
    [at, axes]: [Anchor; 2],
    law: Option<&[Expression; 3]>,
) {
    let Some(law) = law else {
        return add(composer, name, [at, axes], vec![[1.0, 0.0], [0.0, 1.0]], 1.0);
    };
    let Simulation { start, stop, .. } = composer.mechanism.simulation;
    // One that rises from zero has its direction later.
    let sizes = [start, 0.5 * (start + stop), stop].map(|time| {
        // Coordinates and their rates are one: what grows has its direction.
        let variable = |which| if which == Variable::Time { time } else { 1.0 };
        let value =
            |size: &Expression| size.evaluate_at(&|p| composer.parameter(p), &variable);
        law.each_ref().map(value)
    });
    let is_seen =
        |sizes: &&[f64; 3]| sizes.iter().any(|size| *size != 0.0) && sizes.iter().all(|size| size.is_finite());
    let [x, y, torque] = sizes.iter().find(is_seen).copied().unwrap_or_default();
    let size = x.hypot(y);
    let arrows = if size > 0.0 {
        vec![[x / size, y / size]]
    } else {
        Vec::new()
    };
    let turn = if torque == 0.0 { 0.0 } else { torque.signum() };
    add(composer, name, [at, axes], arrows, turn);
}

/// Composes a force along an axis, or a torque, that acts on the second of two bodies; an input
/// without a law.
pub(super) fn compose_along(
    composer: &mut Composer,
    name: &str,
    [from, to]: [Anchor; 2],
    axis: Option<Anchor>,
    law: Option<&ForceLaw>,
) {
    let coordinate = |q: &[f64]| match axis {
        None => to.placed(q).angle - from.placed(q).angle,
        Some(axis) => {
            let along = direction(axis.placed(q).angle);
            along.dot(&(to.placed(q).point - from.placed(q).point))
        }
    };
    let start = composer.mechanism.simulation.start;
    let sign = law.map_or(1.0, |law| {
        let size = |[position, velocity]: [f64; 2]| {
            // Coordinates elsewhere rest at zero like the coordinate, or grow like it.
            let other = |which| if which == Variable::Time { start } else { velocity };
            law.evaluate(&|p| composer.parameter(p), &other, [position, velocity])
        };
        // One that is zero here has its direction elsewhere, or in motion.
        let poses = || std::iter::once(composer.q).chain(composer.poses());
        let sizes = [0.0, 1.0]
            .into_iter()
            .flat_map(|velocity| poses().map(move |q| [coordinate(q), velocity]));
        let mut seen = sizes.map(size).filter(|size| *size != 0.0 && size.is_finite());
        seen.next().map_or(0.0, f64::signum)
    });
    let (arrows, turn) = match axis {
        None => (Vec::new(), sign),
        Some(_) if sign == 0.0 => (Vec::new(), 0.0),
        Some(_) => (vec![[sign, 0.0]], 0.0),
    };
    add(composer, name, [to, axis.unwrap_or(to)], arrows, turn);
}

fn add(
    composer: &mut Composer,
    name: &str,
    [at, axes]: [Anchor; 2],
    arrows: Vec<[f64; 2]>,
    turn: f64,
) {
    if !arrows.is_empty() || turn != 0.0 {
        composer.add(LoadArrow {
            name: name.to_owned(),
            at,
            axes,
            arrows,
            turn,
        });
    }
}

impl Shape for LoadArrow {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::Turned {
            at: self.at,
            along: self.axes,
        });
        let (point, _) = pen.place(self.at);
        let (_, axis) = pen.place(self.axes);
        let mut places = Vec::new();
        let [parts, gaps] = [
            [(1.0, 0.0), (0.6, 3.0), (0.2, 5.0)],
            [(4.0, 0.0), (12.0, 4.0), (24.0, 10.0)],
        ];
        for [x, y] in &self.arrows {
            // The y-axis of the sheet points down.
            let along = *x * axis - *y * across(axis);
            let outwards = if self.arrows.len() == 1 {
                pen.away(along, point)
            } else {
                along
            };
            let [near, far] = [GAP, GAP + LENGTH].map(|length| point + length * outwards);
            let ends = if outwards == along {
                [near, far]
            } else {
                [far, near]
            };
            pen.straight_arrow(Layer::Force, ends, Colour::INK, LINE);
            let sides = [(outwards, 0.0), (across(along), 1.0), (-across(along), 1.0)];
            places.extend(Candidate::beside([near, far], &parts, &sides, &gaps));
        }
        if self.turn != 0.0 {
            let x = angle(axis);
            // On the sheet angles count clockwise.
            let (start, turn) = match self.arrows.len() {
                2 => (0.5 * (std::f64::consts::FRAC_PI_2 - QUARTER) - x, QUARTER),
                _ => (-0.5 * self.turn * ARC - x, self.turn * ARC),
            };
            pen.arc_arrow(
                Layer::Force,
                (point, RADIUS),
                [start, turn],
                Colour::INK,
                LINE,
            );
            places.extend(Candidate::around(point, RADIUS + 2.0));
        }
        pen.label(Named::Load, &self.name, Colour::INK, places);
    }

    fn extent(&self) -> Vec<Disc> {
        vec![self.at.into()]
    }
}
