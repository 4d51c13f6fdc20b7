//! The parts of a mechanism that do not move each other, and their sizes.

use nalgebra::Vector2;
use petgraph::unionfind::UnionFind;

use super::{Equation, EquationTarget};
use crate::kinematics::constraint::configuration::extent;
use crate::kinematics::constraint::{Dimension, Incidence};
use crate::kinematics::tolerances::NEGLIGIBLE_LENGTH;
use crate::mechanism::{Mechanism, ProfileInForce};

/// Least part of the mechanism's size that counts: a body of some eps of it is a point.
const LEAST: f64 = 1e-15;

/// Returns the size of each body's part, relative to the mechanism's size.
///
/// The bodies in one row belong together, those joined by ground alone do not: a platform of 1 mm
/// is no singular mechanism because a pendulum of 1 km hangs beside it. A size is that of
/// [`Configuration::size`], for the parameters of the file; a part of points alone has the
/// mechanism's.
///
/// [`Configuration::size`]: crate::kinematics::Configuration::size
pub(super) fn part_sizes(mechanism: &Mechanism, equations: &[Equation]) -> Vec<f64> {
    let bodies = mechanism.bodies.len();
    let mut parts = UnionFind::new(bodies);
    // The first body of each row.
    let first: Vec<Option<usize>> = equations
        .iter()
        .map(|equation| {
            let mut incidence = Incidence::default();
            equation.constraint.incidence(mechanism, &mut incidence);
            let unknowns = incidence.unknowns.into_iter();
            let mut met = unknowns.map(|column| column / 3).filter(|&b| b < bodies);
            let first = met.next()?;
            met.for_each(|body| {
                parts.union(first, body);
            });
            Some(first)
        })
        .collect();
    let value = |p: crate::mechanism::ParameterId| mechanism.parameters[p.index()].default;
    let mut sizes = vec![0.0_f64; bodies];
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let part = parts.find(index);
        let places = body.markers.iter().map(|marker| {
            let [x, y] = &mechanism.markers[marker.index()].position;
            Vector2::new(x.evaluate(&value, 0.0), y.evaluate(&value, 0.0))
        });
        sizes[part] = sizes[part].max(extent(places));
    }
    for joint in &mechanism.joints {
        if let Some((_, profile)) = joint.cam()
            && let Some(body) = mechanism.markers[joint.from.index()].body
        {
            let mut profile = ProfileInForce::new(profile, mechanism.parameters.len());
            // Parameters that make no contour are refused later.
            if profile.set_parameters(value).is_ok() {
                let part = parts.find(body.index());
                sizes[part] = sizes[part].max(profile.radius(0.0).value);
            }
        }
    }
    for (equation, first) in equations.iter().zip(first) {
        if let (Some(first), EquationTarget::Constant(target)) = (first, &equation.target)
            && equation.constraint.dimension() == Dimension::Length
        {
            let part = parts.find(first);
            sizes[part] = sizes[part].max(target.evaluate(&value, 0.0).abs());
        }
    }
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let relative = |body: usize| {
        let size = sizes[parts.find(body)];
        let part = size / largest;
        if size > NEGLIGIBLE_LENGTH && part > LEAST && part < 1.0 {
            part
        } else {
            1.0
        }
    };
    (0..bodies).map(relative).collect()
}
