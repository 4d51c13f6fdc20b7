//! Drivers and parameters that a variable depends on.

use super::variables::Quantity;
use crate::kinematics::{Dependencies, ForceQuantity, Structure};
use crate::mechanism::{Load, Mechanism, Signal};

impl Quantity {
    /// Returns the drivers and parameters that an output or a calculated parameter depends on,
    /// structurally exact; none for other variables.
    #[must_use]
    pub(super) fn dependencies(self, mechanism: &Mechanism, structure: &Structure) -> Dependencies {
        let mut dependencies = Dependencies::default();
        match self {
            Self::Output(Signal::Body(body, component), _) => {
                dependencies.extend(structure.dependencies(3 * body.index() + component));
            }
            Self::Output(Signal::Marker(marker, component), _) => {
                let of_point = structure.point_dependencies(mechanism, marker, component);
                dependencies.extend(&of_point);
            }
            Self::Output(Signal::Measure(index), _) => {
                let coordinate = &mechanism.measures[index].coordinate;
                dependencies.extend(&structure.coordinate_dependencies(mechanism, coordinate));
            }
            Self::Output(Signal::Motion(driver), _) => {
                dependencies.drivers.insert(driver);
                if let Some(motion) = mechanism.drivers[driver.index()].motion() {
                    dependencies.add_motion(mechanism, motion);
                }
            }
            Self::Parameter(parameter) => dependencies.add_parameter(mechanism, parameter),
            Self::Derived(index, _) => {
                let measure = &mechanism.derived[index];
                dependencies.add_expression(mechanism, &measure.value);
                for (signal, order) in measure.signals() {
                    let of_signal = Self::Output(signal, order);
                    dependencies.extend(&of_signal.dependencies(mechanism, structure));
                }
            }
            Self::Force(quantity) => {
                add_force_dependencies(mechanism, structure, quantity, &mut dependencies)
            }
            Self::Input(..)
            | Self::ForceInput(_)
            | Self::RateSource
            | Self::Extrapolation
            | Self::Residual
            | Self::Rcond
            | Self::Iterations
            | Self::Substeps
            | Self::Proved
            | Self::Time => {}
        }
        dependencies
    }
}

/// Adds the drivers and parameters that a force depends on: a force along a coordinate on that, all
/// others on the whole mechanism.
fn add_force_dependencies(
    mechanism: &Mechanism,
    structure: &Structure,
    quantity: ForceQuantity,
    dependencies: &mut Dependencies,
) {
    if let ForceQuantity::Applied(force, _) = quantity {
        let load = &mechanism.forces[force].load;
        if let Load::Coordinate { coordinate, .. } = load {
            dependencies.extend(&structure.coordinate_dependencies(mechanism, coordinate));
        }
        for expression in load.expressions() {
            dependencies.add_expression(mechanism, expression);
        }
        return;
    }
    for body in 0..3 * mechanism.bodies.len() {
        dependencies.extend(structure.dependencies(body));
    }
    for body in &mechanism.bodies {
        let center = body.center.iter().flatten();
        for expression in body.mass.iter().chain(&body.inertia).chain(center) {
            dependencies.add_expression(mechanism, expression);
        }
        // Points of forces and reactions.
        for marker in &body.markers {
            let marker = &mechanism.markers[marker.index()];
            for expression in marker.position.iter().chain([&marker.angle]) {
                dependencies.add_expression(mechanism, expression);
            }
        }
    }
    for expression in &mechanism.simulation.gravity {
        dependencies.add_expression(mechanism, expression);
    }
    for expression in mechanism.forces.iter().flat_map(|f| f.load.expressions()) {
        dependencies.add_expression(mechanism, expression);
    }
}
