//! The model description of a mechanism's FMU.

use std::sync::Arc;

use super::MechanismModel;
use super::decisions::Decisions;
use super::dependencies::{DependencyTable, Kinds};
use super::guid::guid_decided;
use super::variables::{Quantity, variables_of};
use crate::dynamics::KeptStart;
use crate::fmi::model::Model;
use crate::fmi::model_description::{Experiment, Member, ModelDescription, Terminal, Unknown};
use crate::fmi::state::Version;
use crate::fmi::variable::{Causality, Kind, Variable, value_reference};
use crate::kinematics::{OutputSource, Structure, System};
use crate::mechanism::{BodyId, Mechanism, Order, Unit, rounded};

/// Returns the model description of a mechanism's FMU for a version of the standard.
#[must_use]
pub fn describe<'a>(
    mechanism: &'a Arc<Mechanism>,
    structure: &Structure,
    standard: Version,
) -> ModelDescription<'a, Quantity> {
    describe_decided(mechanism, structure, standard, &Decisions::of(mechanism))
}

/// Returns the model description that follows from the decisions of an export.
pub(super) fn describe_decided<'a>(
    mechanism: &'a Arc<Mechanism>,
    structure: &Structure,
    standard: Version,
    decisions: &Decisions,
) -> ModelDescription<'a, Quantity> {
    let kept = KeptStart::of(mechanism);
    let started = kept.as_ref().map_or(mechanism, |kept| &kept.mechanism);
    let mut variables = variables_of(started, decisions);
    set_nominal(mechanism, &mut variables);
    let table = DependencyTable::new(mechanism, structure, &variables);
    let mut outputs = Vec::new();
    let mut derivatives = Vec::new();
    let mut initial_unknowns = Vec::new();
    let mut event_indicators = Vec::new();
    for (place, variable) in variables.iter().enumerate() {
        let value_reference = value_reference(place);
        let Some(known) = table.of(variable.quantity) else {
            continue;
        };
        let unknown = Unknown {
            value_reference,
            dependencies: known.inputs,
            parameters: known.parameters,
        };
        if variable.causality == Causality::EventIndicator {
            event_indicators.push(unknown);
            continue;
        }
        let of = variable.derivative_of.map(|of| variables[of].causality);
        if of.is_some_and(Causality::is_state) {
            derivatives.push(unknown.clone());
        }
        if variable.causality.is_output() {
            outputs.push(unknown);
        }
        if matches!(
            variable.causality,
            Causality::State | Causality::StartedOutput
        ) {
            continue;
        }
        initial_unknowns.push(Unknown {
            value_reference,
            dependencies: known.initial,
            parameters: Kinds::new(),
        });
    }
    let simulation = &mechanism.simulation;
    ModelDescription {
        standard,
        name: &mechanism.name,
        description: &mechanism.description,
        author: mechanism.author.as_deref(),
        version: mechanism.version.as_deref(),
        copyright: mechanism.copyright.as_deref(),
        license: mechanism.license.as_deref(),
        guid: guid_decided(mechanism, decisions),
        experiment: Experiment {
            start: simulation.start,
            stop: simulation.stop,
            step: simulation.step,
            tolerance: simulation.tolerance,
        },
        capabilities: MechanismModel::CAPABILITIES,
        terminals: terminals(mechanism, &variables),
        variables,
        outputs,
        derivatives,
        initial_unknowns,
        event_indicators,
    }
}

/// Returns a terminal per driver, with all variables of the driver that cross the interface, one per
/// marker among the outputs, and one per force that is an input.
fn terminals(mechanism: &Mechanism, variables: &[Variable<Quantity>]) -> Vec<Terminal> {
    let drivers = mechanism.drivers.iter().map(|driver| {
        let description = if driver.description.is_empty() {
            format!("{} `{}`", driver.noun(), driver.name)
        } else {
            driver.description.clone()
        };
        (driver.name.clone(), description)
    });
    let markers = mechanism.outputs.markers.iter().map(|&id| {
        let path = mechanism.marker_path(id);
        let description = format!("marker `{path}`");
        (path, description)
    });
    let mut forces: Vec<usize> = (mechanism.force_inputs().iter())
        .map(|component| component.force)
        .collect();
    forces.dedup();
    let is_force =
        |variable: &Variable<Quantity>| matches!(variable.quantity, Quantity::ForceInput(_));
    let forces = forces.into_iter().map(|force| {
        let name = &mechanism.forces[force].name;
        (name.clone(), format!("force `{name}`"))
    });
    let terminals = drivers
        .chain(markers)
        .chain(forces)
        .map(|(name, description)| {
            let members = variables.iter().filter_map(|variable| {
                let member = variable.name.strip_prefix(&name)?.strip_prefix('.')?;
                let crosses =
                    variable.causality == Causality::Input || variable.causality.is_output();
                (crosses && !member.contains('.')).then(|| Member {
                    name: member.to_owned(),
                    variable: variable.name.clone(),
                    is_flow: member == "effort" || is_force(variable),
                })
            });
            let members = members.collect();
            Terminal {
                name,
                description,
                members,
            }
        });
    terminals.collect()
}

/// Gives lengths among inputs and outputs the mechanism's size as their usual magnitude, rounded to
/// one digit; forces the weight W of the bodies, torques and energies W times the size. Angles have the
/// order of 1, which is the default.
fn set_nominal(mechanism: &Arc<Mechanism>, variables: &mut [Variable<Quantity>]) {
    let system = System::new(Arc::clone(mechanism));
    let (mut at, mut targets) = (system.configuration(), system.targets());
    let parameters = mechanism.default_parameters();
    if system
        .set_parameters(&parameters, &mut at, &mut targets)
        .is_err()
    {
        return;
    }
    let bodies = (0..mechanism.bodies.len()).map(BodyId);
    let masses = bodies.filter_map(|body| Some(mechanism.weight_at(body, &parameters)?.mass));
    let [gx, gy] = mechanism
        .simulation
        .gravity
        .each_ref()
        .map(|g| g.value(&parameters));
    let weight = masses.sum::<f64>() * gx.hypot(gy);
    let magnitudes = [
        (Unit::METRE, at.size()),
        (Unit::NEWTON, weight),
        (Unit::NEWTON_METRE, weight * at.size()),
        (Unit::JOULE, weight * at.size()),
    ];
    let magnitudes = magnitudes.map(|(unit, size)| (unit.name, rounded(size, 1)));
    for variable in variables {
        let has_magnitude = matches!(
            variable.quantity,
            Quantity::Input(_, Order::Position)
                | Quantity::ForceInput(_)
                | Quantity::Output(
                    OutputSource::Signal(_, Order::Position) | OutputSource::Force(_)
                )
        );
        if let Kind::Real {
            unit: Some(unit),
            nominal,
            ..
        } = &mut variable.kind
            && has_magnitude
            && let Some((_, size)) = magnitudes.iter().find(|(name, _)| *name == unit.name)
            && size.is_normal()
        {
            *nominal = Some(*size);
        }
    }
}
