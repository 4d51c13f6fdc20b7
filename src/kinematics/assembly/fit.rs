//! The number that would let a mechanism close.

use super::estimate::estimate;
use super::gaps::CLOSED;
use crate::kinematics::error::Fit;
use crate::kinematics::origin::Origin;
use crate::kinematics::state::State;
use crate::kinematics::system::System;
use crate::mechanism::{BodyId, Joint, MarkerId};

/// Returns the length of a link or a rope, or between the two pins of a body, that would close an
/// origin, or whether the phase of its wheels as drawn would.
///
/// Before: all other origins are closed at the present pose.
pub(in crate::kinematics) fn fit(system: &System, state: &State, origin: Origin) -> Option<Fit> {
    let mechanism = system.mechanism();
    let Origin::Joint(index) = origin else {
        return None;
    };
    let joint = &mechanism.joints[index];
    let point = |marker| state.at.marker(marker).point;
    let length = |from, to| (point(to) - point(from)).norm();
    if joint.rod().is_some() || joint.rope().is_some() {
        let row = system.rows_of(&[origin])[0];
        return Some(Fit::Length {
            origin: origin.describe(mechanism),
            between: None,
            length: system.equations()[row].constraint.value(&state.at),
            present: state.targets.constant(row),
        });
    }
    if joint.is_pin() {
        // The body declared last of the two is the one that people have added.
        let ends = [(joint.to, joint.from), (joint.from, joint.to)];
        let body = |marker: MarkerId| mechanism.markers[marker.index()].body;
        let mut found: Vec<_> = ends
            .into_iter()
            .filter_map(|(own, partner)| {
                let body = body(own)?;
                let other = other_pin(system, body, index)?;
                Some((body, own, partner, other))
            })
            .collect();
        found.sort_by_key(|(body, ..)| body.index());
        let (body, own, partner, other) = found.pop()?;
        let name = |marker: MarkerId| mechanism.markers[marker.index()].name.clone();
        return Some(Fit::Length {
            origin: format!("body `{}`", mechanism.bodies[body.index()].name),
            between: Some([name(other), name(own)]),
            length: length(other, partner),
            present: length(other, own),
        });
    }
    joint.kind.phase()?;
    let row = *system.rows_of(&[origin]).first()?;
    let equation = &system.equations()[row];
    let drawn = estimate(system, &state.pose.parameters).ok()?;
    let mut at = state.at.clone();
    let here = equation.constraint.value(&at);
    at.set_pose(mechanism, &drawn);
    let missing = (equation.constraint.value(&at) - here) * equation.row_scale(&at);
    (missing.abs() <= CLOSED).then(|| Fit::Phase {
        origin: origin.describe(mechanism),
    })
}

/// Returns the length beyond which an origin that is open by `gap` \[m\] closes.
///
/// Before: all other origins are closed at the present pose, and the gap is the least one.
pub(super) fn reach(system: &System, state: &State, origin: Origin, gap: f64) -> Option<Fit> {
    /// Largest relative difference of the gap and the change of the length where they lie in line.
    const IN_LINE: f64 = 1e-3;
    let found = fit(system, state, origin)?;
    let Fit::Length {
        length, present, ..
    } = found
    else {
        return None;
    };
    let change = (length - present).abs();
    ((change - gap).abs() <= IN_LINE * gap).then_some(found)
}

/// Returns the marker of the second pin of a body that two pins hold and nothing else; `pin` is one
/// of them.
fn other_pin(system: &System, body: BodyId, pin: usize) -> Option<MarkerId> {
    let mechanism = system.mechanism();
    let on_body = |marker: MarkerId| mechanism.markers[marker.index()].body == Some(body);
    let own = |joint: &Joint| [joint.from, joint.to].into_iter().find(|&m| on_body(m));
    let unknowns = 3 * body.index()..3 * body.index() + 3;
    let equations = system.equations().iter().enumerate();
    let touching = equations.filter(|(row, _)| {
        let columns = system.incidence(*row).unknowns;
        columns.iter().any(|column| unknowns.contains(column))
    });
    let mut other = None;
    for (_, equation) in touching {
        let Origin::Joint(index) = equation.origin else {
            return None;
        };
        let joint = &mechanism.joints[index];
        if !joint.is_pin() {
            return None;
        }
        if index != pin && other.replace(index).is_some_and(|before| before != index) {
            return None;
        }
    }
    other.and_then(|index| own(&mechanism.joints[index]))
}
