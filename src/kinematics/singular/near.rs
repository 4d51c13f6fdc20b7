//! Blocks near a singular position.

use nalgebra::DMatrix;

use crate::kinematics::element::Element;
use crate::kinematics::model::Model;
use crate::kinematics::state::State;
use crate::kinematics::system::System;
use crate::mechanism::{Coordinate, CoordinateKind, DriverId, JointKind, MarkerId, Mechanism};

/// Most unknowns of a block whose singular positions are located, by dense matrices.
pub const LARGEST_BLOCK: usize = 120;
/// Regularity below which a singular position may be near.
pub(in crate::kinematics) const NEAR: f64 = 0.05;
/// Entries of a null vector above this part of the largest one are free to move.
const FREE: f64 = 1e-3;

/// Returns the blocks near a singular position that are small enough; all are factorised.
pub(super) fn near_singular(model: &Model) -> Vec<usize> {
    let blocks = model.plan.blocks.iter().enumerate();
    let near = blocks
        .filter(|(_, block)| block.regularity() < NEAR && block.columns().len() <= LARGEST_BLOCK);
    near.map(|(index, _)| index).collect()
}

/// Returns the names of the bodies and joints that a null vector moves; `free` has its entries for
/// these unknowns. A body that turns alone about a pin lines up with what holds it at a distance,
/// whose name follows if there is one alone.
pub(super) fn bodies_of(system: &System, columns: &[usize], free: &[f64]) -> Vec<String> {
    let motion = || columns.iter().copied().zip(free.iter().copied());
    let mut names = system.describe_moved(motion(), FREE);
    let moved = motion().find(|(_, value)| value.abs() > FREE);
    if let ([_], Some((column, _))) = (&names[..], moved) {
        names.extend(distance_to(system.mechanism(), column / 3));
    }
    names
}

/// Returns kind and name of the only element that holds a body with a pin at a distance.
fn distance_to(mechanism: &Mechanism, body: usize) -> Option<String> {
    let is_on_body = |marker: MarkerId| {
        let carrier = mechanism.markers[marker.index()].body;
        carrier.is_some_and(|carrier| carrier.index() == body)
    };
    let joints = || {
        let joints = mechanism.joints.iter().enumerate();
        joints.filter(|(_, joint)| is_on_body(joint.from) || is_on_body(joint.to))
    };
    let holds = |coordinate: &Coordinate| {
        coordinate.kind == CoordinateKind::Distance
            && (is_on_body(coordinate.from) || is_on_body(coordinate.to))
    };
    let links = joints().filter(|(_, joint)| matches!(joint.kind, JointKind::Link { .. }));
    let constraints = mechanism.constraints.iter().enumerate();
    let drivers = mechanism.drivers.iter().enumerate();
    let mut elements = links
        .map(|(index, _)| Element::Joint(index))
        .chain(
            constraints
                .filter(|(_, held)| holds(&held.coordinate))
                .map(|(k, _)| Element::Constraint(k)),
        )
        .chain(
            drivers
                .filter(|(_, driver)| holds(&driver.coordinate))
                .map(|(k, _)| Element::Driver(DriverId(k))),
        );
    let element = elements.next()?;
    let has_pin = joints().any(|(_, joint)| matches!(joint.kind, JointKind::Revolute));
    (has_pin && elements.next().is_none()).then(|| element.describe(mechanism))
}

/// Returns the Jacobian of a block's rows in its own unknowns at the pose, scaled.
pub(super) fn block_jacobian(model: &Model, state: &State, block: usize) -> DMatrix<f64> {
    let block = &model.plan.blocks[block];
    let columns = block.columns();
    let place = |column: usize| columns.iter().position(|&own| own == column);
    let system = &model.system;
    let (_, jacobian) = system.dense_rows(block.rows(), columns.len(), place, state.values());
    jacobian
}
