//! The multipliers of the block's rows.

use nalgebra::Vector2;

use super::{RrpDyad, Second};
use crate::kinematics::constraint::Gradient;
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::plan::load::{add_force, add_moment, load_about};
use crate::kinematics::plan::revolute::Revolute;
use crate::kinematics::system::System;
use crate::mechanism::MarkerId;

/// Solves the block's part of Phi_qᵀ λ = `side`.
///
/// While the angle of a turns at the rate 1, the revolutes and the angle of b hold, and the row of
/// the projection alone takes the power of `side`. What it leaves, those rows bear.
pub(super) fn solve_transposed(
    dyad: &RrpDyad,
    system: &System,
    at: &Configuration,
    side: &mut [f64],
    multipliers: &mut [f64],
) {
    let (frames, parts) = (at.frames(), &*dyad.parts);
    let mut gradient = Gradient::new();
    let constraint = &system.equations()[parts.row].constraint;
    constraint.gradient(at, &mut gradient);
    let turn = dyad.turn(frames);
    let rate = |column: usize| {
        let moving = turn.iter().find(|(body, _)| *body == column / 3);
        moving.map_or(0.0, |(_, rates)| rates[column % 3])
    };
    let slope: f64 = gradient
        .entries()
        .map(|(column, partial)| partial * rate(column))
        .sum();
    let power = turn
        .iter()
        .flat_map(|(body, rates)| side[3 * body..].iter().zip(rates));
    let projection = power.map(|(load, rate)| load * rate).sum::<f64>() / slope;
    multipliers[parts.row] = projection;
    for (column, partial) in gradient.entries() {
        side[column] -= projection * partial;
    }

    let first = Pin {
        body: dyad.body as usize,
        s: dyad.s,
        revolute: parts.outer,
    };
    if let (Some((body, s)), Some(second)) = (dyad.second.pin(), &parts.second) {
        let pin = Pin {
            body,
            s,
            revolute: second.revolute,
        };
        let (force, torque) = pin.bear(second.pin, frames, side, multipliers);
        multipliers[second.row] = second.sense * torque;
        match &dyad.second {
            Second::None => {}
            Second::Carried { reference, l, .. } => {
                if let Some(body) = *reference {
                    add_moment(side, body, torque);
                }
                let frame = &frames[first.body];
                let arm = frame.rotate(first.s) + frame.rotate(*l);
                add_force(side, first.body, arm, force);
            }
            Second::Parallel { anchor, .. } => {
                add_moment(side, first.body, torque);
                anchor.load(frames, force, side);
            }
        }
    }
    // No moment is left about the pin.
    let (force, _) = first.bear(parts.pin, frames, side, multipliers);
    dyad.anchor.load(frames, force, side);
}

/// A revolute on a body of the block.
struct Pin {
    body: usize,
    s: Vector2<f64>,
    revolute: Revolute,
}

impl Pin {
    /// Writes λ of the revolute, whose marker on the body is `own`, and returns the force that it
    /// bears and the moment about it.
    fn bear(
        &self,
        own: MarkerId,
        frames: &[BodyPose],
        side: &[f64],
        multipliers: &mut [f64],
    ) -> (Vector2<f64>, f64) {
        let arm = frames[self.body].rotate(self.s);
        let (force, moment) = load_about(side, self.body, arm);
        let sense = self.revolute.sense_to(own);
        let [x, y] = self.revolute.rows;
        multipliers[x] = sense * force.x;
        multipliers[y] = sense * force.y;
        (force, moment)
    }
}

impl Second {
    /// Returns the second body and its point in the revolute.
    fn pin(&self) -> Option<(usize, Vector2<f64>)> {
        match self {
            Self::None => None,
            Self::Carried { body, s, .. } | Self::Parallel { body, s, .. } => {
                Some((*body as usize, *s))
            }
        }
    }
}

impl RrpDyad {
    /// Returns the rates of x, y and phi of its bodies while the angle of a turns at the rate 1 and
    /// the bodies found before rest.
    fn turn(&self, frames: &[BodyPose]) -> [(usize, [f64; 3]); 2] {
        let a = self.body as usize;
        let arm = frames[a].rotate(self.s);
        let v = -perp(arm);
        let first = (a, [v.x, v.y, 1.0]);
        let second = match &self.second {
            Second::None => (a, [0.0; 3]),
            Second::Carried { body, l, .. } => {
                // Its pin moves with a; it does not turn.
                let v = perp(frames[a].rotate(*l));
                (*body as usize, [v.x, v.y, 0.0])
            }
            Second::Parallel { body, s, .. } => {
                let v = -perp(frames[*body as usize].rotate(*s));
                (*body as usize, [v.x, v.y, 1.0])
            }
        };
        [first, second]
    }
}
