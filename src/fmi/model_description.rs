//! `modelDescription.xml`, written from the table of variables (FMI 2.0, 2.2 and 4.3.1).

use std::collections::BTreeSet;
use std::io;

use quick_xml::events::{BytesDecl, Event};
use quick_xml::writer::{ElementWriter, Writer};

use super::guid;
use super::log::Category;
use super::variables::{
    Causality, Enumeration, Kind, Order, Quantity, Variability, Variable, Variables, dependencies,
};
use crate::kinematics::{Dependencies, Structure};
use crate::mechanism::{Mechanism, ParameterId, Unit};

type Xml = Writer<Vec<u8>>;

/// The model description of a mechanism's FMU.
///
/// `generated` is the attribute `generationDateAndTime`, left out for `None`: the same mechanism
/// then gives the same bytes.
#[must_use]
pub fn write(mechanism: &Mechanism, structure: &Structure, generated: Option<&str>) -> Vec<u8> {
    let variables = Variables::new(mechanism);
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    let written = write_document(&mut xml, mechanism, structure, &variables, generated);
    written.expect("writing to memory does not fail");
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    bytes
}

fn write_document(
    xml: &mut Xml,
    mechanism: &Mechanism,
    structure: &Structure,
    variables: &Variables,
    generated: Option<&str>,
) -> io::Result<()> {
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let guid = guid(mechanism);
    let optional = [
        ("description", non_empty(&mechanism.description)),
        ("author", mechanism.author.as_deref()),
        ("version", mechanism.version.as_deref()),
        ("copyright", mechanism.copyright.as_deref()),
        ("license", mechanism.license.as_deref()),
        ("generationDateAndTime", generated),
    ];
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", "2.0"),
            ("modelName", &mechanism.name),
            ("guid", &guid),
            (
                "generationTool",
                concat!("biela ", env!("CARGO_PKG_VERSION")),
            ),
            ("variableNamingConvention", "structured"),
        ])
        .with_optional(&optional)
        .write_inner_content(|xml| {
            write_co_simulation(xml, mechanism)?;
            write_units(xml, variables)?;
            write_types(xml, variables)?;
            write_log_categories(xml)?;
            write_experiment(xml, mechanism)?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    (variables.list().iter().enumerate())
                        .try_for_each(|(index, variable)| write_variable(xml, index, variable))
                })?;
            write_structure(xml, mechanism, structure, variables)
        })?;
    Ok(())
}

/// Attributes that are left out where they have no value.
trait WithOptional {
    fn with_optional(self, attributes: &[(&str, Option<&str>)]) -> Self;
}

impl WithOptional for ElementWriter<'_, Vec<u8>> {
    fn with_optional(mut self, attributes: &[(&str, Option<&str>)]) -> Self {
        for &(name, value) in attributes {
            if let Some(value) = value {
                self = self.with_attribute((name, value));
            }
        }
        self
    }
}

fn non_empty(text: &str) -> Option<&str> {
    Some(text).filter(|text| !text.is_empty())
}

/// A number so that reading it back gives the same bits.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn write_co_simulation(xml: &mut Xml, mechanism: &Mechanism) -> io::Result<()> {
    xml.create_element("CoSimulation")
        .with_attributes([
            ("modelIdentifier", mechanism.name.as_str()),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", "true"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("maxOutputDerivativeOrder", "2"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
        ])
        .write_empty()?;
    Ok(())
}

fn real_unit(variable: &Variable) -> Option<Unit> {
    match variable.kind {
        Kind::Real { unit, .. } => unit,
        _ => None,
    }
}

/// The units that variables use, in the order of their first use, each with the display units
/// that variables use.
fn write_units(xml: &mut Xml, variables: &Variables) -> io::Result<()> {
    let mut units: Vec<(Unit, Vec<_>)> = Vec::new();
    for unit in variables.list().iter().filter_map(real_unit) {
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

/// The simple type that variables with this unit and its usual display unit are declared with.
fn type_of(unit: Unit) -> Option<&'static str> {
    let types = [
        (Unit::METRE, "Length"),
        (Unit::METRE_PER_SECOND, "Velocity"),
        (Unit::METRE_PER_SECOND_SQUARED, "Acceleration"),
        (Unit::RADIAN, "Angle"),
        (Unit::RADIAN_PER_SECOND, "AngularVelocity"),
        (Unit::RADIAN_PER_SECOND_SQUARED, "AngularAcceleration"),
    ];
    let mut types = types.into_iter();
    types
        .find(|(known, _)| known.name == unit.name)
        .map(|(_, name)| name)
}

fn write_types(xml: &mut Xml, variables: &Variables) -> io::Result<()> {
    let mut written = BTreeSet::new();
    xml.create_element("TypeDefinitions")
        .write_inner_content(|xml| {
            for variable in variables.list() {
                match &variable.kind {
                    Kind::Real {
                        unit: Some(unit), ..
                    } => {
                        // The type has the unit's usual display unit, a variable may have another.
                        let usual = Unit::by_name(unit.name).unwrap_or(*unit);
                        if let Some(name) = type_of(usual).filter(|name| written.insert(*name)) {
                            write_type(xml, name, |xml| {
                                let display = usual.display.map(|display| display.name);
                                xml.create_element("Real")
                                    .with_attributes([("quantity", name), ("unit", usual.name)])
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

fn write_experiment(xml: &mut Xml, mechanism: &Mechanism) -> io::Result<()> {
    let simulation = &mechanism.simulation;
    xml.create_element("DefaultExperiment")
        .with_attributes([
            ("startTime", number(simulation.start).as_str()),
            ("stopTime", &number(simulation.stop)),
            ("tolerance", &number(simulation.tolerance)),
            ("stepSize", &number(simulation.step)),
        ])
        .write_empty()?;
    Ok(())
}

fn write_variable(xml: &mut Xml, index: usize, variable: &Variable) -> io::Result<()> {
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

fn write_variable_type(xml: &mut Xml, variable: &Variable) -> io::Result<()> {
    match variable.kind {
        Kind::Real {
            unit,
            start,
            min,
            max,
        } => {
            let display = unit.and_then(|unit| unit.display);
            let [min, max, start] = [min, max, start].map(|value| value.map(number));
            xml.create_element("Real")
                .with_optional(&[
                    ("declaredType", unit.and_then(type_of)),
                    ("unit", unit.map(|unit| unit.name)),
                    ("displayUnit", display.map(|display| display.name)),
                    ("min", min.as_deref()),
                    ("max", max.as_deref()),
                    ("start", start.as_deref()),
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

/// Finds the places of variables in the model description, counted from 1.
struct Indices<'a> {
    mechanism: &'a Mechanism,
    /// Place of the first of the three inputs of each driver that is an input.
    inputs: Vec<Option<usize>>,
    /// Place of each parameter.
    parameters: Vec<usize>,
    rate_source: Option<usize>,
    time: usize,
}

impl<'a> Indices<'a> {
    fn new(mechanism: &'a Mechanism, variables: &Variables) -> Self {
        let mut indices = Self {
            mechanism,
            inputs: vec![None; mechanism.drivers.len()],
            parameters: vec![0; mechanism.parameters.len()],
            rate_source: None,
            time: 0,
        };
        for (place, variable) in (1..).zip(variables.list()) {
            match variable.quantity {
                Quantity::Input(driver, Order::Position) => {
                    indices.inputs[driver.index()] = Some(place);
                }
                Quantity::Parameter(parameter) => indices.parameters[parameter.index()] = place,
                Quantity::RateSource => indices.rate_source = Some(place),
                Quantity::Time => indices.time = place,
                _ => {}
            }
        }
        indices
    }

    fn parameter(&self, parameter: ParameterId) -> usize {
        self.parameters[parameter.index()]
    }

    /// Inputs and time that a quantity of this order depends on, over all settings of `rates`:
    /// estimated rates come from positions.
    fn inputs(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut places = BTreeSet::new();
        for driver in &dependencies.drivers {
            match self.inputs[driver.index()] {
                Some(first) => places.extend(first..=first + order as usize),
                None => {
                    places.insert(self.time);
                }
            }
        }
        places
    }

    /// What a quantity of this order depends on at the start: parameters as well.
    fn initial(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut places = self.inputs(dependencies, order);
        // What no driver moves has rates of zero, whatever the parameters.
        if order == Order::Position || !dependencies.drivers.is_empty() {
            places.extend(dependencies.parameters.iter().map(|&p| self.parameter(p)));
        }
        let has_input = |driver: &crate::mechanism::DriverId| {
            self.mechanism.drivers[driver.index()].motion().is_none()
        };
        if order > Order::Position && dependencies.drivers.iter().any(has_input) {
            places.extend(self.rate_source);
        }
        places
    }
}

fn write_structure(
    xml: &mut Xml,
    mechanism: &Mechanism,
    structure: &Structure,
    variables: &Variables,
) -> io::Result<()> {
    let indices = Indices::new(mechanism, variables);
    let unknowns: Vec<_> = (1..)
        .zip(variables.list())
        .filter_map(|(place, variable)| {
            let order = match variable.quantity {
                Quantity::Body(_, _, order)
                | Quantity::Marker(_, _, order)
                | Quantity::Measure(_, order)
                | Quantity::Motion(_, order) => order,
                Quantity::Parameter(_) if variable.causality != Causality::Parameter => {
                    Order::Position
                }
                _ => return None,
            };
            let dependencies = dependencies(mechanism, structure, variable.quantity);
            Some((place, variable.causality, dependencies, order))
        })
        .collect();
    xml.create_element("ModelStructure")
        .write_inner_content(|xml| {
            let outputs: Vec<_> = unknowns
                .iter()
                .filter(|(_, causality, ..)| *causality == Causality::Output)
                .map(|(place, _, dependencies, order)| {
                    (*place, indices.inputs(dependencies, *order))
                })
                .collect();
            write_unknowns(xml, "Outputs", &outputs)?;
            let initial: Vec<_> = unknowns
                .iter()
                .map(|(place, _, dependencies, order)| {
                    (*place, indices.initial(dependencies, *order))
                })
                .collect();
            write_unknowns(xml, "InitialUnknowns", &initial)
        })?;
    Ok(())
}

fn write_unknowns(
    xml: &mut Xml,
    name: &str,
    unknowns: &[(usize, BTreeSet<usize>)],
) -> io::Result<()> {
    // The schema has no empty lists.
    if unknowns.is_empty() {
        return Ok(());
    }
    xml.create_element(name).write_inner_content(|xml| {
        for (place, dependencies) in unknowns {
            let dependencies: Vec<_> = dependencies.iter().map(usize::to_string).collect();
            xml.create_element("Unknown")
                .with_attributes([
                    ("index", place.to_string().as_str()),
                    ("dependencies", &dependencies.join(" ")),
                ])
                .write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}
