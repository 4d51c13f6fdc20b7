//! The elements of `modelDescription.xml`, in the order of the file: FMI 2.0 (2.2, 3.3.1 and 4.3.1)
//! and FMI 3.0 (2.4, 3.4 and 4.4).
//!
//! A variable has the same name and the same value reference in both versions. Counts of the solver
//! are discrete Integers in FMI 2.0 and continuous Float64s in FMI 3.0, where a discrete variable
//! would change at events only (2.4.7.4).

use std::collections::BTreeSet;
use std::io;

use super::xml::{Element, ElementWriter, Xml, boolean, non_empty, number};
use super::{Capabilities, Experiment, ModelDescription, Unknown};
use crate::fmi::log::Category;
use crate::fmi::state::Version;
use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable, value_reference};
use crate::unit::Unit;

/// Writes the root element; `generated` is the attribute `generationDateAndTime`.
pub(super) fn write<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
    generated: Option<&str>,
) -> io::Result<()> {
    let (standard, variables) = (description.standard, &description.variables);
    let indicators = description.event_indicators.len().to_string();
    let (version, guid, event_indicators) = match standard {
        Version::Fmi2 => ("2.0", "guid", Some(&*indicators)),
        Version::Fmi3 => ("3.0", "instantiationToken", None),
    };
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", version),
            ("modelName", description.name),
            (guid, &description.guid),
            (
                "generationTool",
                concat!("biela ", env!("CARGO_PKG_VERSION")),
            ),
            ("variableNamingConvention", "structured"),
        ])
        .with_optional(&[
            ("numberOfEventIndicators", event_indicators),
            ("description", non_empty(description.description)),
            ("author", description.author),
            ("version", description.version),
            ("copyright", description.copyright),
            ("license", description.license),
            ("generationDateAndTime", generated),
        ])
        .with_content(|xml| {
            match standard {
                Version::Fmi2 => write_interfaces_of_fmi2(xml, description)?,
                Version::Fmi3 => write_interfaces_of_fmi3(xml, description)?,
            }
            write_units(xml, variables)?;
            write_types(xml, standard, variables)?;
            write_log_categories(xml, standard)?;
            write_experiment(xml, description.experiment)?;
            xml.create_element("ModelVariables").with_content(|xml| {
                (0..variables.len())
                    .try_for_each(|place| write_variable(xml, standard, place, variables))
            })?;
            write_structure(xml, description)
        })
}

fn write_interfaces_of_fmi2<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
) -> io::Result<()> {
    let Capabilities {
        interpolates_inputs,
        output_derivatives,
        directional_derivatives,
        intermediate_update: _,
    } = description.capabilities;
    let directional = boolean(directional_derivatives);
    xml.create_element("ModelExchange")
        .with_attributes([
            ("modelIdentifier", description.name),
            ("completedIntegratorStepNotNeeded", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", directional),
        ])
        .empty()?;
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
            ("providesDirectionalDerivative", directional),
        ])
        .empty()
}

fn write_interfaces_of_fmi3<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
) -> io::Result<()> {
    let Capabilities {
        interpolates_inputs: _,
        output_derivatives,
        directional_derivatives,
        intermediate_update,
    } = description.capabilities;
    let derivatives = boolean(directional_derivatives);
    let intermediate = boolean(intermediate_update);
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
    xml.create_element("CoSimulation")
        .with_attributes(common)
        .with_attributes([
            ("canHandleVariableCommunicationStepSize", "true"),
            ("maxOutputDerivativeOrder", &output_derivatives.to_string()),
            ("providesIntermediateUpdate", intermediate),
            ("mightReturnEarlyFromDoStep", "true"),
            ("canReturnEarlyAfterIntermediateUpdate", intermediate),
            ("hasEventMode", "true"),
        ])
        .empty()
}

/// Writes the units of the variables in the order of first use, each with the display units that
/// variables use.
fn write_units<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
    let mut units: Vec<(Unit, Vec<_>)> = Vec::new();
    for variable in variables {
        let Kind::Real {
            unit: Some(unit), ..
        } = variable.kind
        else {
            continue;
        };
        let known = units.iter().position(|(known, _)| known.name == unit.name);
        let index = known.unwrap_or_else(|| {
            units.push((unit, Vec::new()));
            units.len() - 1
        });
        let displays = &mut units[index].1;
        displays.extend(unit.display.filter(|display| !displays.contains(display)));
    }
    // The schemas forbid an empty list.
    if units.is_empty() {
        return Ok(());
    }
    xml.create_element("UnitDefinitions").with_content(|xml| {
        for (unit, displays) in &units {
            let definition = xml
                .create_element("Unit")
                .with_attribute(("name", unit.name.as_str()));
            definition.with_content(|xml| {
                let mut base = xml.create_element("BaseUnit");
                for (name, exponent) in unit.dimension.base_units() {
                    base = base.with_attribute((name, exponent.to_string().as_str()));
                }
                base.empty()?;
                for display in displays {
                    xml.create_element("DisplayUnit")
                        .with_attributes([
                            ("name", display.name.as_str()),
                            ("factor", &number(display.factor)),
                        ])
                        .empty()?;
                }
                Ok(())
            })?;
        }
        Ok(())
    })
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
        (Unit::NEWTON, "biela.Force"),
        (Unit::NEWTON_METRE, "biela.Torque"),
        (Unit::JOULE, "biela.Energy"),
    ];
    let mut types = types.into_iter();
    types
        .find(|(known, _)| known.name == unit.name)
        .map(|(_, name)| name)
}

/// A declared type.
enum Type {
    /// A real number with this unit.
    Real(&'static str, Unit),
    /// A choice.
    Enumeration(&'static Enumeration),
}

/// Returns the types of the variables in the order of first use.
fn types<Q>(variables: &[Variable<Q>]) -> Vec<Type> {
    let mut names = BTreeSet::new();
    let mut types = Vec::new();
    for variable in variables {
        match variable.kind {
            Kind::Real {
                unit: Some(unit), ..
            } => {
                // A variable may have another display unit than its type.
                let usual = Unit::by_name(&unit.name).unwrap_or(unit);
                if let Some(name) = type_of(usual).filter(|name| names.insert(*name)) {
                    types.push(Type::Real(name, usual));
                }
            }
            Kind::Enumeration { choices, .. } if names.insert(choices.name) => {
                types.push(Type::Enumeration(choices));
            }
            _ => {}
        }
    }
    types
}

fn write_types<Q>(xml: &mut Xml, standard: Version, variables: &[Variable<Q>]) -> io::Result<()> {
    let types = types(variables);
    // The schemas forbid an empty list.
    if types.is_empty() {
        return Ok(());
    }
    xml.create_element("TypeDefinitions").with_content(|xml| {
        types.into_iter().try_for_each(|declared| match declared {
            Type::Real(name, unit) => {
                write_type(xml, standard, name, ["Real", "Float64Type"], |element| {
                    let quantity = name.trim_start_matches("biela.");
                    let display = unit.display.as_ref().map(|display| display.name.as_str());
                    element
                        .with_attributes([("quantity", quantity), ("unit", unit.name.as_str())])
                        .with_optional(&[("displayUnit", display)])
                        .empty()
                })
            }
            Type::Enumeration(Enumeration { name, items }) => {
                let elements = ["Enumeration", "EnumerationType"];
                write_type(xml, standard, name, elements, |element| {
                    element.with_content(|xml| {
                        for (value, (name, description)) in (1..).zip(*items) {
                            xml.create_element("Item")
                                .with_attributes([
                                    ("name", *name),
                                    ("value", &value.to_string()),
                                    ("description", description),
                                ])
                                .empty()?;
                        }
                        Ok(())
                    })
                })
            }
        })
    })
}

/// Writes a type: FMI 2.0 has its element within one for the name, FMI 3.0 the name in it. `elements`
/// are the names of the element in FMI 2.0 and in FMI 3.0.
fn write_type(
    xml: &mut Xml,
    standard: Version,
    name: &str,
    elements: [&'static str; 2],
    content: impl FnOnce(ElementWriter<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let [of_fmi2, of_fmi3] = elements;
    match standard {
        Version::Fmi2 => xml
            .create_element("SimpleType")
            .with_attribute(("name", name))
            .with_content(|xml| content(xml.create_element(of_fmi2))),
        Version::Fmi3 => content(xml.create_element(of_fmi3).with_attribute(("name", name))),
    }
}

fn write_log_categories(xml: &mut Xml, standard: Version) -> io::Result<()> {
    xml.create_element("LogCategories").with_content(|xml| {
        for (category, description) in Category::ALL {
            let always = match standard {
                Version::Fmi2 if category.always() => "; always logged",
                _ => "",
            };
            let description = format!("{description}{always}");
            xml.create_element("Category")
                .with_attributes([("name", category.name()), ("description", &description)])
                .empty()?;
        }
        Ok(())
    })
}

fn write_experiment(xml: &mut Xml, experiment: Experiment) -> io::Result<()> {
    xml.create_element("DefaultExperiment")
        .with_attributes([
            ("startTime", number(experiment.start).as_str()),
            ("stopTime", &number(experiment.stop)),
            ("tolerance", &number(experiment.tolerance)),
            ("stepSize", &number(experiment.step)),
        ])
        .empty()
}

fn write_variable<Q>(
    xml: &mut Xml,
    standard: Version,
    place: usize,
    variables: &[Variable<Q>],
) -> io::Result<()> {
    let variable = &variables[place];
    let is_state = |place: usize| variables[place].causality.is_state();
    let (element, variability) = match (&variable.kind, standard) {
        (Kind::Real { .. }, Version::Fmi2) => ("Real", variable.variability),
        (Kind::Real { .. }, Version::Fmi3) => ("Float64", variable.variability),
        (Kind::Integer, Version::Fmi2) => ("Integer", variable.variability),
        (Kind::Integer, Version::Fmi3) => ("Float64", Variability::Continuous),
        (Kind::Enumeration { .. }, _) => ("Enumeration", variable.variability),
    };
    let crosses = variable.causality == Causality::Input || variable.causality.is_output();
    let is_intermediate =
        standard == Version::Fmi3 && crosses && variability == Variability::Continuous;
    let outer = match standard {
        Version::Fmi2 => "ScalarVariable",
        Version::Fmi3 => element,
    };
    let head = xml
        .create_element(outer)
        .with_attributes([
            ("name", variable.name.as_str()),
            ("valueReference", &value_reference(place).to_string()),
        ])
        .with_optional(&[("description", non_empty(&variable.description))])
        .with_attributes([
            ("causality", causality_name(variable.causality)),
            ("variability", variability_name(variability)),
        ])
        .with_optional(&[
            ("intermediateUpdate", is_intermediate.then_some("true")),
            ("initial", initial_name(variable.causality)),
        ]);
    match standard {
        Version::Fmi2 => head.with_content(|xml| {
            write_values(xml.create_element(element), standard, variable, is_state)
        }),
        Version::Fmi3 => write_values(head, standard, variable, is_state),
    }
}

/// Writes the attributes of the variable's values into an element.
fn write_values<Q>(
    element: ElementWriter<'_>,
    standard: Version,
    variable: &Variable<Q>,
    is_state: impl Fn(usize) -> bool,
) -> io::Result<()> {
    let element = match variable.kind {
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
            // Some hosts of FMI 2.0 count each variable whose derivative is known as a state.
            let derivative = variable
                .derivative_of
                .filter(|of| standard == Version::Fmi3 || is_state(*of));
            let derivative = derivative.map(|of| value_reference(of).to_string());
            element.with_optional(&[
                ("declaredType", unit.and_then(type_of)),
                ("unit", unit.as_ref().map(|unit| unit.name.as_str())),
                (
                    "displayUnit",
                    display.as_ref().map(|display| display.name.as_str()),
                ),
                ("min", min.as_deref()),
                ("max", max.as_deref()),
                ("nominal", nominal.as_deref()),
                ("start", start.as_deref()),
                ("derivative", derivative.as_deref()),
            ])
        }
        Kind::Integer => element,
        Kind::Enumeration { choices, start } => element.with_attributes([
            ("declaredType", choices.name),
            ("start", start.to_string().as_str()),
        ]),
    };
    element.empty()
}

fn causality_name(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output | Causality::StartedOutput | Causality::State => "output",
        Causality::Local | Causality::LocalState | Causality::EventIndicator => "local",
        Causality::Independent => "independent",
    }
}

fn variability_name(variability: Variability) -> &'static str {
    match variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

/// Returns the attribute `initial` of variables of a causality.
fn initial_name(causality: Causality) -> Option<&'static str> {
    match causality {
        Causality::Parameter | Causality::StartedOutput | Causality::State => Some("exact"),
        Causality::CalculatedParameter
        | Causality::Output
        | Causality::LocalState
        | Causality::EventIndicator
        | Causality::Local => Some("calculated"),
        Causality::Input | Causality::Independent => None,
    }
}

fn write_structure<Q>(xml: &mut Xml, description: &ModelDescription<'_, Q>) -> io::Result<()> {
    let standard = description.standard;
    xml.create_element("ModelStructure").with_content(|xml| {
        for (list, element, unknowns) in [
            ("Outputs", "Output", &description.outputs),
            (
                "Derivatives",
                "ContinuousStateDerivative",
                &description.derivatives,
            ),
            (
                "InitialUnknowns",
                "InitialUnknown",
                &description.initial_unknowns,
            ),
            (
                "EventIndicators",
                "EventIndicator",
                &description.event_indicators,
            ),
        ] {
            let write = |xml: &mut Xml, element: &'static str| {
                let mut unknowns = unknowns.iter();
                unknowns.try_for_each(|unknown| write_unknown(xml, standard, element, unknown))
            };
            match standard {
                // The schema forbids an empty list, and knows none of event indicators.
                Version::Fmi2 if unknowns.is_empty() || list == "EventIndicators" => {}
                Version::Fmi2 => xml
                    .create_element(list)
                    .with_content(|xml| write(xml, "Unknown"))?,
                Version::Fmi3 => write(xml, element)?,
            }
        }
        Ok(())
    })
}

fn write_unknown(
    xml: &mut Xml,
    standard: Version,
    element: &'static str,
    unknown: &Unknown,
) -> io::Result<()> {
    let mut dependencies = unknown.dependencies.clone();
    let attribute = match standard {
        // Indices count from 1, as value references do.
        Version::Fmi2 => "index",
        Version::Fmi3 => {
            dependencies.extend(&unknown.parameters);
            "valueReference"
        }
    };
    let known = dependencies.keys().map(u32::to_string);
    let kinds = dependencies.values().map(|kind| kind.name());
    let [known, kinds] = [
        known.collect::<Vec<_>>().join(" "),
        kinds.collect::<Vec<_>>().join(" "),
    ];
    xml.create_element(element)
        .with_attributes([
            (attribute, unknown.value_reference.to_string().as_str()),
            ("dependencies", &known),
        ])
        // The schema forbids an empty list of kinds.
        .with_optional(&[("dependenciesKind", non_empty(&kinds))])
        .empty()
}
