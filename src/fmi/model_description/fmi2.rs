//! The model description of FMI 2.0 (2.2, 3.3.1 and 4.3.1).

use std::collections::BTreeSet;
use std::io;

use super::xml::{WithOptional, Xml, boolean, non_empty, number};
use super::{Capabilities, Experiment, ModelDescription, Unknown};
use crate::fmi::log::Category;
use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable};
use crate::unit::Unit;

/// Writes the root element; `generated` is the attribute `generationDateAndTime`.
pub(super) fn write<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
    generated: Option<&str>,
) -> io::Result<()> {
    let optional = [
        ("description", non_empty(description.description)),
        ("author", description.author),
        ("version", description.version),
        ("copyright", description.copyright),
        ("license", description.license),
        ("generationDateAndTime", generated),
    ];
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", "2.0"),
            ("modelName", description.name),
            ("guid", &description.guid),
            (
                "generationTool",
                concat!("biela ", env!("CARGO_PKG_VERSION")),
            ),
            ("variableNamingConvention", "structured"),
            ("numberOfEventIndicators", "0"),
        ])
        .with_optional(&optional)
        .write_inner_content(|xml| {
            let variables = &description.variables;
            write_model_exchange(xml, description)?;
            write_co_simulation(xml, description)?;
            write_units(xml, variables)?;
            write_types(xml, variables)?;
            write_log_categories(xml)?;
            write_experiment(xml, description.experiment)?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    (variables.iter().enumerate())
                        .try_for_each(|(index, variable)| write_variable(xml, index, variable))
                })?;
            write_structure(xml, description)
        })?;
    Ok(())
}

fn write_model_exchange<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    let directional = description.capabilities.directional_derivatives;
    xml.create_element("ModelExchange")
        .with_attributes([
            ("modelIdentifier", description.name),
            ("completedIntegratorStepNotNeeded", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", boolean(directional)),
        ])
        .write_empty()?;
    Ok(())
}

fn write_co_simulation<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    let Capabilities {
        interpolates_inputs,
        output_derivatives,
        directional_derivatives,
    } = description.capabilities;
    xml.create_element("CoSimulation")
        .with_attributes([
            ("modelIdentifier", description.name),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", boolean(interpolates_inputs)),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("maxOutputDerivativeOrder", &output_derivatives.to_string()),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            (
                "providesDirectionalDerivative",
                boolean(directional_derivatives),
            ),
        ])
        .write_empty()?;
    Ok(())
}

fn real_unit<Q>(variable: &Variable<Q>) -> Option<Unit> {
    match variable.kind {
        Kind::Real { unit, .. } => unit,
        _ => None,
    }
}

/// Writes the units of the variables in the order of first use, each with the display units that
/// variables use.
fn write_units<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
    let mut units: Vec<(Unit, Vec<_>)> = Vec::new();
    for unit in variables.iter().filter_map(real_unit) {
        let index = units
            .iter()
            .position(|(known, _)| known.name == unit.name)
            .unwrap_or_else(|| {
                units.push((unit, Vec::new()));
                units.len() - 1
            });
        let displays = &mut units[index].1;
        displays.extend(unit.display.filter(|display| !displays.contains(display)));
    }
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| {
            for (unit, displays) in &units {
                let definition = xml
                    .create_element("Unit")
                    .with_attribute(("name", unit.name));
                definition.write_inner_content(|xml| {
                    let dimension = unit.dimension;
                    let exponents = [
                        ("kg", dimension.kg),
                        ("m", dimension.m),
                        ("s", dimension.s),
                        ("rad", dimension.rad),
                    ];
                    let mut base = xml.create_element("BaseUnit");
                    for (name, exponent) in exponents {
                        if exponent != 0 {
                            base = base.with_attribute((name, exponent.to_string().as_str()));
                        }
                    }
                    base.write_empty()?;
                    for display in displays {
                        xml.create_element("DisplayUnit")
                            .with_attributes([
                                ("name", display.name),
                                ("factor", &number(display.factor)),
                            ])
                            .write_empty()?;
                    }
                    Ok(())
                })?;
            }
            Ok(())
        })?;
    Ok(())
}

/// Returns the simple type of variables with this unit.
fn type_of(unit: Unit) -> Option<&'static str> {
    // No variable has such a name (2.2.3): a name of two parts ends with a lower-case word.
    let types = [
        (Unit::METRE, "biela.Length"),
        (Unit::METRE_PER_SECOND, "biela.Velocity"),
        (Unit::METRE_PER_SECOND_SQUARED, "biela.Acceleration"),
        (Unit::RADIAN, "biela.Angle"),
        (Unit::RADIAN_PER_SECOND, "biela.AngularVelocity"),
        (Unit::RADIAN_PER_SECOND_SQUARED, "biela.AngularAcceleration"),
    ];
    let mut types = types.into_iter();
    types
        .find(|(known, _)| known.name == unit.name)
        .map(|(_, name)| name)
}

fn write_types<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
    let mut written = BTreeSet::new();
    xml.create_element("TypeDefinitions")
        .write_inner_content(|xml| {
            for variable in variables {
                match &variable.kind {
                    Kind::Real {
                        unit: Some(unit), ..
                    } => {
                        // A variable may have another display unit than its type.
                        let usual = Unit::by_name(unit.name).unwrap_or(*unit);
                        if let Some(name) = type_of(usual).filter(|name| written.insert(*name)) {
                            write_type(xml, name, |xml| {
                                let display = usual.display.map(|display| display.name);
                                let quantity = name.trim_start_matches("biela.");
                                xml.create_element("Real")
                                    .with_attributes([("quantity", quantity), ("unit", usual.name)])
                                    .with_optional(&[("displayUnit", display)])
                                    .write_empty()?;
                                Ok(())
                            })?;
                        }
                    }
                    Kind::Enumeration(enumeration) if written.insert(enumeration.name) => {
                        write_type(xml, enumeration.name, |xml| write_items(xml, enumeration))?;
                    }
                    _ => {}
                }
            }
            Ok(())
        })?;
    Ok(())
}

fn write_type(
    xml: &mut Xml,
    name: &str,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    xml.create_element("SimpleType")
        .with_attribute(("name", name))
        .write_inner_content(content)?;
    Ok(())
}

fn write_items(xml: &mut Xml, enumeration: &Enumeration) -> io::Result<()> {
    xml.create_element("Enumeration")
        .write_inner_content(|xml| {
            for (index, (name, description)) in enumeration.items.iter().enumerate() {
                xml.create_element("Item")
                    .with_attributes([
                        ("name", *name),
                        ("value", &(index + 1).to_string()),
                        ("description", description),
                    ])
                    .write_empty()?;
            }
            Ok(())
        })?;
    Ok(())
}

fn write_log_categories(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("LogCategories")
        .write_inner_content(|xml| {
            for (category, description) in Category::ALL {
                xml.create_element("Category")
                    .with_attributes([("name", category.name()), ("description", description)])
                    .write_empty()?;
            }
            Ok(())
        })?;
    Ok(())
}

fn write_experiment(xml: &mut Xml, experiment: Experiment) -> io::Result<()> {
    xml.create_element("DefaultExperiment")
        .with_attributes([
            ("startTime", number(experiment.start).as_str()),
            ("stopTime", &number(experiment.stop)),
            ("tolerance", &number(experiment.tolerance)),
            ("stepSize", &number(experiment.step)),
        ])
        .write_empty()?;
    Ok(())
}

fn write_variable<Q>(xml: &mut Xml, index: usize, variable: &Variable<Q>) -> io::Result<()> {
    let causality = match variable.causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    };
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    let initial = match variable.causality {
        Causality::Parameter => Some("exact"),
        Causality::CalculatedParameter | Causality::Output | Causality::Local => Some("calculated"),
        Causality::Input | Causality::Independent => None,
    };
    xml.create_element("ScalarVariable")
        .with_attributes([
            ("name", variable.name.as_str()),
            ("valueReference", &index.to_string()),
        ])
        .with_optional(&[("description", non_empty(&variable.description))])
        .with_attributes([("causality", causality), ("variability", variability)])
        .with_optional(&[("initial", initial)])
        .write_inner_content(|xml| write_variable_type(xml, variable))?;
    Ok(())
}

fn write_variable_type<Q>(xml: &mut Xml, variable: &Variable<Q>) -> io::Result<()> {
    match variable.kind {
        Kind::Real {
            unit,
            start,
            min,
            max,
            nominal,
        } => {
            let display = unit.and_then(|unit| unit.display);
            let [min, max, nominal, start] =
                [min, max, nominal, start].map(|value| value.map(number));
            let derivative = variable.derivative_of.map(|of| (of + 1).to_string());
            xml.create_element("Real")
                .with_optional(&[
                    ("declaredType", unit.and_then(type_of)),
                    ("unit", unit.map(|unit| unit.name)),
                    ("displayUnit", display.map(|display| display.name)),
                    ("min", min.as_deref()),
                    ("max", max.as_deref()),
                    ("nominal", nominal.as_deref()),
                    ("start", start.as_deref()),
                    ("derivative", derivative.as_deref()),
                ])
                .write_empty()?;
        }
        Kind::Integer => {
            xml.create_element("Integer").write_empty()?;
        }
        Kind::Enumeration(enumeration) => {
            xml.create_element("Enumeration")
                .with_attributes([("declaredType", enumeration.name), ("start", "1")])
                .write_empty()?;
        }
    }
    Ok(())
}

fn write_structure<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    xml.create_element("ModelStructure")
        .write_inner_content(|xml| {
            write_unknowns(xml, "Outputs", &description.outputs)?;
            write_unknowns(xml, "InitialUnknowns", &description.initial_unknowns)
        })?;
    Ok(())
}

fn write_unknowns(xml: &mut Xml, name: &str, unknowns: &[Unknown]) -> io::Result<()> {
    // The schema forbids empty lists.
    if unknowns.is_empty() {
        return Ok(());
    }
    xml.create_element(name).write_inner_content(|xml| {
        for unknown in unknowns {
            let indices = unknown.dependencies.keys().map(usize::to_string);
            let kinds = unknown.dependencies.values().map(|kind| kind.name());
            let indices = indices.collect::<Vec<_>>().join(" ");
            let kinds = kinds.collect::<Vec<_>>().join(" ");
            xml.create_element("Unknown")
                .with_attributes([
                    ("index", unknown.index.to_string().as_str()),
                    ("dependencies", &indices),
                ])
                // The schema forbids an empty list of kinds.
                .with_optional(&[("dependenciesKind", non_empty(&kinds))])
                .write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}
