//! The model description of FMI 3.0 (2.4, 3.4 and 4.4).
//!
//! A variable has the name and the value reference that it has in FMI 2.0. Counts of the solver are
//! continuous Float64 here: a discrete variable would change at events only (2.4.7.4).

use std::io;

use super::elements::{
    Root, Type, causality_name, initial_name, lists, types, variability_name, with_values,
    write_experiment, write_items, write_log_categories, write_real_type, write_root, write_units,
    write_variables,
};
use super::xml::{Element, Xml, boolean, non_empty};
use super::{ModelDescription, Unknown};
use crate::fmi::variable::{Causality, Kind, Variable};

/// Writes the root element; `generated` is the attribute `generationDateAndTime`.
pub(super) fn write<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
    generated: Option<&str>,
) -> io::Result<()> {
    let root = Root {
        version: "3.0",
        guid: "instantiationToken",
        event_indicators: None,
    };
    write_root(xml, description, generated, &root, |xml| {
        let variables = &description.variables;
        write_interfaces(xml, description)?;
        write_units(xml, variables)?;
        write_types(xml, variables)?;
        write_log_categories(xml, "")?;
        write_experiment(xml, description.experiment)?;
        write_variables(xml, variables, write_variable)?;
        write_structure(xml, description)
    })
}

fn write_interfaces<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    let capabilities = description.capabilities;
    let derivatives = boolean(capabilities.directional_derivatives);
    let common = [
        ("modelIdentifier", description.name),
        ("canBeInstantiatedOnlyOncePerProcess", "false"),
        ("canGetAndSetFMUState", "true"),
        ("canSerializeFMUState", "true"),
        ("providesDirectionalDerivatives", derivatives),
        ("providesAdjointDerivatives", derivatives),
        ("providesPerElementDependencies", "true"),
    ];
    xml.create_element("ModelExchange")
        .with_attributes(common)
        .with_attribute(("needsCompletedIntegratorStep", "true"))
        .empty()?;
    let intermediate = boolean(capabilities.intermediate_update);
    xml.create_element("CoSimulation")
        .with_attributes(common)
        .with_attributes([
            ("canHandleVariableCommunicationStepSize", "true"),
            (
                "maxOutputDerivativeOrder",
                &capabilities.output_derivatives.to_string(),
            ),
            ("providesIntermediateUpdate", intermediate),
            ("mightReturnEarlyFromDoStep", "true"),
            ("canReturnEarlyAfterIntermediateUpdate", intermediate),
            ("hasEventMode", "true"),
        ])
        .empty()
}

fn write_types<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
    let types = types(variables);
    // The schema forbids an empty list.
    if types.is_empty() {
        return Ok(());
    }
    xml.create_element("TypeDefinitions").with_content(|xml| {
        types.into_iter().try_for_each(|declared| match declared {
            Type::Real(name, unit) => {
                let element = xml.create_element("Float64Type");
                write_real_type(element.with_attribute(("name", name)), name, unit)
            }
            Type::Enumeration(enumeration) => {
                let element = xml.create_element("EnumerationType");
                write_items(
                    element.with_attribute(("name", enumeration.name)),
                    enumeration,
                )
            }
        })
    })
}

fn write_variable<Q>(xml: &mut Xml, index: usize, variable: &Variable<Q>) -> io::Result<()> {
    let element = match variable.kind {
        Kind::Real { .. } | Kind::Integer => "Float64",
        Kind::Enumeration(_) => "Enumeration",
    };
    let variability = match variable.kind {
        Kind::Integer => "continuous",
        _ => variability_name(variable.variability),
    };
    let crosses = matches!(variable.causality, Causality::Input | Causality::Output);
    let intermediate = (crosses && variability == "continuous").then_some("true");
    let element = xml
        .create_element(element)
        .with_attributes([
            ("name", variable.name.as_str()),
            ("valueReference", &index.to_string()),
        ])
        .with_optional(&[("description", non_empty(&variable.description))])
        .with_attributes([
            ("causality", causality_name(variable.causality)),
            ("variability", variability),
        ])
        .with_optional(&[
            ("intermediateUpdate", intermediate),
            ("initial", initial_name(variable.causality)),
        ]);
    let derivative_of = variable.derivative_of.map(|of| of as usize);
    with_values(element, variable, derivative_of).empty()
}

fn write_structure<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    xml.create_element("ModelStructure").with_content(|xml| {
        write_unknowns(xml, "Output", &description.outputs)?;
        write_unknowns(xml, "InitialUnknown", &description.initial_unknowns)
    })
}

fn write_unknowns(xml: &mut Xml, name: &str, unknowns: &[Unknown]) -> io::Result<()> {
    for unknown in unknowns {
        let mut dependencies = unknown.dependencies.clone();
        dependencies.extend(&unknown.parameters);
        let [references, kinds] = lists(&dependencies, |index| index - 1);
        xml.create_element(name)
            .with_attributes([
                ("valueReference", (unknown.index - 1).to_string().as_str()),
                ("dependencies", &references),
            ])
            .with_optional(&[("dependenciesKind", non_empty(&kinds))])
            .empty()?;
    }
    Ok(())
}
