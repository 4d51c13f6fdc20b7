//! The model description of FMI 2.0 (2.2, 3.3.1 and 4.3.1).

use std::io;

use super::elements::{
    Root, Type, causality_name, initial_name, lists, types, variability_name, with_values,
    write_experiment, write_items, write_log_categories, write_real_type, write_root, write_units,
    write_variables,
};
use super::xml::{Element, Xml, boolean, non_empty};
use super::{Capabilities, ModelDescription, Unknown};
use crate::fmi::variable::{Kind, Variable};

/// Writes the root element; `generated` is the attribute `generationDateAndTime`.
pub(super) fn write<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
    generated: Option<&str>,
) -> io::Result<()> {
    let root = Root {
        version: "2.0",
        guid: "guid",
        event_indicators: Some("0"),
    };
    write_root(xml, description, generated, &root, |xml| {
        let variables = &description.variables;
        write_model_exchange(xml, description)?;
        write_co_simulation(xml, description)?;
        write_units(xml, variables)?;
        write_types(xml, variables)?;
        write_log_categories(xml, "; always logged")?;
        write_experiment(xml, description.experiment)?;
        write_variables(xml, variables, write_variable)?;
        write_structure(xml, description)
    })
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
        .empty()
}

fn write_co_simulation<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    let Capabilities {
        interpolates_inputs,
        output_derivatives,
        directional_derivatives,
        intermediate_update: _,
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
        .empty()
}

fn write_types<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
    xml.create_element("TypeDefinitions").with_content(|xml| {
        types(variables)
            .into_iter()
            .try_for_each(|declared| match declared {
                Type::Real(name, unit) => write_type(xml, name, |xml| {
                    write_real_type(xml.create_element("Real"), name, unit)
                }),
                Type::Enumeration(enumeration) => write_type(xml, enumeration.name, |xml| {
                    write_items(xml.create_element("Enumeration"), enumeration)
                }),
            })
    })
}

fn write_type(
    xml: &mut Xml,
    name: &str,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    xml.create_element("SimpleType")
        .with_attribute(("name", name))
        .with_content(content)
}

fn write_variable<Q>(xml: &mut Xml, index: usize, variable: &Variable<Q>) -> io::Result<()> {
    let [causality, variability] = [
        causality_name(variable.causality),
        variability_name(variable.variability),
    ];
    let initial = initial_name(variable.causality);
    xml.create_element("ScalarVariable")
        .with_attributes([
            ("name", variable.name.as_str()),
            ("valueReference", &index.to_string()),
        ])
        .with_optional(&[("description", non_empty(&variable.description))])
        .with_attributes([("causality", causality), ("variability", variability)])
        .with_optional(&[("initial", initial)])
        .with_content(|xml| {
            let element = match variable.kind {
                Kind::Real { .. } => "Real",
                Kind::Integer => "Integer",
                Kind::Enumeration(_) => "Enumeration",
            };
            let derivative_of = variable.derivative_of.map(|of| of as usize + 1);
            with_values(xml.create_element(element), variable, derivative_of).empty()
        })
}

fn write_structure<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    xml.create_element("ModelStructure").with_content(|xml| {
        write_unknowns(xml, "Outputs", &description.outputs)?;
        write_unknowns(xml, "InitialUnknowns", &description.initial_unknowns)
    })
}

fn write_unknowns(xml: &mut Xml, name: &str, unknowns: &[Unknown]) -> io::Result<()> {
    // The schema forbids empty lists.
    if unknowns.is_empty() {
        return Ok(());
    }
    xml.create_element(name).with_content(|xml| {
        for unknown in unknowns {
            let [indices, kinds] = lists(&unknown.dependencies, |index| *index);
            xml.create_element("Unknown")
                .with_attributes([
                    ("index", unknown.index.to_string().as_str()),
                    ("dependencies", &indices),
                ])
                // The schema forbids an empty list of kinds.
                .with_optional(&[("dependenciesKind", non_empty(&kinds))])
                .empty()?;
        }
        Ok(())
    })
}
