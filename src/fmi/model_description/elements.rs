//! Elements of the model description that the versions of the standard have alike.

use std::collections::{BTreeMap, BTreeSet};
use std::io;

use quick_xml::writer::ElementWriter;

use super::xml::{Element, Xml, non_empty, number};
use super::{DependencyKind, Experiment, ModelDescription};
use crate::fmi::log::Category;
use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable};
use crate::unit::Unit;

/// Attributes of the root element that only one version has, or names in its own way.
pub(super) struct Root {
    /// Version of the standard.
    pub(super) version: &'static str,
    /// Name of the attribute for the GUID.
    pub(super) guid: &'static str,
    /// Count of event indicators, where the version has it here.
    pub(super) event_indicators: Option<&'static str>,
}

/// Writes the root element around its content; `generated` is the attribute
/// `generationDateAndTime`.
pub(super) fn write_root<Q>(
    xml: &mut Xml,
    description: &ModelDescription<'_, Q>,
    generated: Option<&str>,
    root: &Root,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", root.version),
            ("modelName", description.name),
            (root.guid, &description.guid),
            (
                "generationTool",
                concat!("biela ", env!("CARGO_PKG_VERSION")),
            ),
            ("variableNamingConvention", "structured"),
        ])
        .with_optional(&[
            ("numberOfEventIndicators", root.event_indicators),
            ("description", non_empty(description.description)),
            ("author", description.author),
            ("version", description.version),
            ("copyright", description.copyright),
            ("license", description.license),
            ("generationDateAndTime", generated),
        ])
        .with_content(content)
}

fn real_unit<Q>(variable: &Variable<Q>) -> Option<Unit> {
    match variable.kind {
        Kind::Real { unit, .. } => unit,
        _ => None,
    }
}

/// Writes the units of the variables in the order of first use, each with the display units that
/// variables use.
pub(super) fn write_units<Q>(xml: &mut Xml, variables: &[Variable<Q>]) -> io::Result<()> {
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
    xml.create_element("UnitDefinitions").with_content(|xml| {
        for (unit, displays) in &units {
            let definition = xml
                .create_element("Unit")
                .with_attribute(("name", unit.name));
            definition.with_content(|xml| {
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
                base.empty()?;
                for display in displays {
                    xml.create_element("DisplayUnit")
                        .with_attributes([
                            ("name", display.name),
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
    ];
    let mut types = types.into_iter();
    types
        .find(|(known, _)| known.name == unit.name)
        .map(|(_, name)| name)
}

/// A declared type.
pub(super) enum Type {
    /// A real number with this unit.
    Real(&'static str, Unit),
    /// A choice.
    Enumeration(&'static Enumeration),
}

/// Returns the types of the variables in the order of first use.
pub(super) fn types<Q>(variables: &[Variable<Q>]) -> Vec<Type> {
    let mut names = BTreeSet::new();
    let mut types = Vec::new();
    for variable in variables {
        match variable.kind {
            Kind::Real {
                unit: Some(unit), ..
            } => {
                // A variable may have another display unit than its type.
                let usual = Unit::by_name(unit.name).unwrap_or(unit);
                if let Some(name) = type_of(usual).filter(|name| names.insert(*name)) {
                    types.push(Type::Real(name, usual));
                }
            }
            Kind::Enumeration(enumeration) if names.insert(enumeration.name) => {
                types.push(Type::Enumeration(enumeration));
            }
            _ => {}
        }
    }
    types
}

/// Writes quantity and units of a type of real numbers into an element.
pub(super) fn write_real_type(
    element: ElementWriter<'_, Vec<u8>>,
    name: &str,
    unit: Unit,
) -> io::Result<()> {
    let display = unit.display.map(|display| display.name);
    let quantity = name.trim_start_matches("biela.");
    element
        .with_attributes([("quantity", quantity), ("unit", unit.name)])
        .with_optional(&[("displayUnit", display)])
        .empty()
}

/// Appends the attributes of the variable's values; `derivative_of` identifies the variable whose
/// derivative it is.
pub(super) fn with_values<'a, Q>(
    element: ElementWriter<'a, Vec<u8>>,
    variable: &Variable<Q>,
    derivative_of: Option<usize>,
) -> ElementWriter<'a, Vec<u8>> {
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
            let derivative = derivative_of.map(|of| of.to_string());
            element.with_optional(&[
                ("declaredType", unit.and_then(type_of)),
                ("unit", unit.map(|unit| unit.name)),
                ("displayUnit", display.map(|display| display.name)),
                ("min", min.as_deref()),
                ("max", max.as_deref()),
                ("nominal", nominal.as_deref()),
                ("start", start.as_deref()),
                ("derivative", derivative.as_deref()),
            ])
        }
        Kind::Integer => element,
        Kind::Enumeration(enumeration) => {
            element.with_attributes([("declaredType", enumeration.name), ("start", "1")])
        }
    }
}

/// Writes the items of an enumeration into an element.
pub(super) fn write_items(
    element: ElementWriter<'_, Vec<u8>>,
    enumeration: &Enumeration,
) -> io::Result<()> {
    element.with_content(|xml| {
        for (index, (name, description)) in enumeration.items.iter().enumerate() {
            xml.create_element("Item")
                .with_attributes([
                    ("name", *name),
                    ("value", &(index + 1).to_string()),
                    ("description", description),
                ])
                .empty()?;
        }
        Ok(())
    })
}

/// Writes the log categories; `always` is appended to the descriptions of those that reach the host
/// with any settings.
pub(super) fn write_log_categories(xml: &mut Xml, always: &str) -> io::Result<()> {
    xml.create_element("LogCategories").with_content(|xml| {
        for (category, description) in Category::ALL {
            let always = if category.always() { always } else { "" };
            let description = format!("{description}{always}");
            xml.create_element("Category")
                .with_attributes([("name", category.name()), ("description", &description)])
                .empty()?;
        }
        Ok(())
    })
}

/// Writes the default experiment.
pub(super) fn write_experiment(xml: &mut Xml, experiment: Experiment) -> io::Result<()> {
    xml.create_element("DefaultExperiment")
        .with_attributes([
            ("startTime", number(experiment.start).as_str()),
            ("stopTime", &number(experiment.stop)),
            ("tolerance", &number(experiment.tolerance)),
            ("stepSize", &number(experiment.step)),
        ])
        .empty()
}

/// Writes the list of variables, each with its index.
pub(super) fn write_variables<Q>(
    xml: &mut Xml,
    variables: &[Variable<Q>],
    write_variable: impl Fn(&mut Xml, usize, &Variable<Q>) -> io::Result<()>,
) -> io::Result<()> {
    xml.create_element("ModelVariables").with_content(|xml| {
        (variables.iter().enumerate())
            .try_for_each(|(index, variable)| write_variable(xml, index, variable))
    })
}

/// Returns the name of a causality.
pub(super) fn causality_name(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

/// Returns the name of a variability.
pub(super) fn variability_name(variability: Variability) -> &'static str {
    match variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

/// Returns the attribute `initial` of variables of a causality.
pub(super) fn initial_name(causality: Causality) -> Option<&'static str> {
    match causality {
        Causality::Parameter => Some("exact"),
        Causality::CalculatedParameter | Causality::Output | Causality::Local => Some("calculated"),
        Causality::Input | Causality::Independent => None,
    }
}

/// Returns dependencies as a list of numbers and a list of kinds; `number` converts an index.
pub(super) fn lists(
    dependencies: &BTreeMap<usize, DependencyKind>,
    number: impl Fn(&usize) -> usize,
) -> [String; 2] {
    let numbers = dependencies.keys().map(|index| number(index).to_string());
    let kinds = dependencies.values().map(|kind| kind.name());
    [
        numbers.collect::<Vec<_>>().join(" "),
        kinds.collect::<Vec<_>>().join(" "),
    ]
}
