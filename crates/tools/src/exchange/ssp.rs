//! An FMU with its parameters and units as a system of SSP 1.0 (`.ssp`).

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Seek, Write};

use quick_xml::escape::escape;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use biela::fmi::{Causality, Kind, Variable};
use biela::mechanism::{Mechanism, Unit};

/// Namespaces with the prefixes that all hosts take.
const SPACES: &str = "xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" \
                      xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\"";

/// Namespace of OMSimulator's annotations.
const OMS: &str =
    "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";

/// Writes a system with one FMU of FMI 2.0, whose inputs and outputs are the system's own, and a file
/// with the values of its parameters.
///
/// The same input gives the same bytes: entries have a fixed order and a fixed date.
///
/// # Errors
///
/// `out` cannot be written.
pub fn write_ssp<Q>(
    out: impl Write + Seek,
    mechanism: &Mechanism,
    variables: &[Variable<Q>],
    fmu: &[u8],
) -> io::Result<()> {
    let mut zip = ZipWriter::new(out);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let name = &mechanism.name;
    zip.start_file("SystemStructure.ssd", options)?;
    zip.write_all(structure(mechanism, variables).as_bytes())?;
    zip.start_file(format!("resources/{name}.ssv"), options)?;
    zip.write_all(values(name, variables).as_bytes())?;
    // It is compressed already.
    let stored = options.compression_method(CompressionMethod::Stored);
    zip.start_file(format!("resources/{name}.fmu"), stored)?;
    zip.write_all(fmu)?;
    zip.finish()?;
    Ok(())
}

/// Returns the kind of a variable's connector, if it has one.
fn kind<Q>(variable: &Variable<Q>) -> Option<&'static str> {
    match variable.causality {
        Causality::Input => Some("input"),
        Causality::Parameter => Some("parameter"),
        causality if causality.is_output() => Some("output"),
        _ => None,
    }
}

/// Returns the element of a connector's type.
fn type_of<Q>(variable: &Variable<Q>) -> String {
    match variable.kind {
        Kind::Real { unit: None, .. } => "<ssc:Real/>".to_owned(),
        Kind::Real {
            unit: Some(unit), ..
        } => format!("<ssc:Real unit=\"{}\"/>", unit.name),
        Kind::Integer | Kind::Enumeration { .. } => "<ssc:Integer/>".to_owned(),
    }
}

/// Returns the units of variables with their SI exponents, in elements of a prefix.
fn units<'a, Q: 'a>(
    variables: impl Iterator<Item = &'a Variable<Q>>,
    prefix: &str,
    indent: &str,
) -> String {
    let mut known: BTreeMap<String, Unit> = BTreeMap::new();
    for variable in variables {
        if let Kind::Real {
            unit: Some(unit), ..
        } = variable.kind
        {
            known.insert(unit.name.to_string(), unit);
        }
    }
    if known.is_empty() {
        return String::new();
    }
    let mut xml = format!("{indent}<{prefix}:Units>\n");
    for (name, unit) in known {
        let exponents = unit.dimension.base_units();
        let exponents = exponents.map(|(base, exponent)| format!(" {base}=\"{exponent}\""));
        let exponents: String = exponents.collect();
        let _ = writeln!(
            xml,
            "{indent}  <ssc:Unit name=\"{name}\"><ssc:BaseUnit{exponents}/></ssc:Unit>"
        );
    }
    let _ = writeln!(xml, "{indent}</{prefix}:Units>");
    xml
}

/// Returns the description of the system.
fn structure<Q>(mechanism: &Mechanism, variables: &[Variable<Q>]) -> String {
    let name = &mechanism.name;
    let connected = variables
        .iter()
        .filter_map(|variable| Some((variable, kind(variable)?)));
    let connectors = |indent: &str, outside: bool| {
        let mut xml = format!("{indent}<ssd:Connectors>\n");
        for (variable, kind) in connected.clone() {
            if outside && kind == "parameter" {
                continue;
            }
            let _ = writeln!(
                xml,
                "{indent}  <ssd:Connector name=\"{}\" kind=\"{kind}\">{}</ssd:Connector>",
                variable.name,
                type_of(variable)
            );
        }
        let _ = writeln!(xml, "{indent}</ssd:Connectors>");
        xml
    };
    let mut connections = String::new();
    for (variable, kind) in connected.clone() {
        let own = &variable.name;
        let _ = match kind {
            "input" => writeln!(
                connections,
                "      <ssd:Connection startConnector=\"{own}\" endElement=\"{name}\" \
                 endConnector=\"{own}\"/>"
            ),
            "output" => writeln!(
                connections,
                "      <ssd:Connection startElement=\"{name}\" startConnector=\"{own}\" \
                 endConnector=\"{own}\"/>"
            ),
            _ => Ok(()),
        };
    }
    let simulation = &mechanism.simulation;
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <ssd:SystemStructureDescription \
         xmlns:ssd=\"http://ssp-standard.org/SSP1/SystemStructureDescription\" {SPACES} \
         version=\"1.0\" name=\"{name}\">\n  \
         <ssd:System name=\"{name}_system\" description=\"{}\">\n{}    \
         <ssd:Elements>\n      \
         <ssd:Component name=\"{name}\" type=\"application/x-fmu-sharedlibrary\" \
         source=\"resources/{name}.fmu\" implementation=\"CoSimulation\">\n{}        \
         <ssd:ParameterBindings>\
         <ssd:ParameterBinding source=\"resources/{name}.ssv\"/>\
         </ssd:ParameterBindings>\n      \
         </ssd:Component>\n    \
         </ssd:Elements>\n    \
         <ssd:Connections>\n{connections}    </ssd:Connections>\n{}  \
         </ssd:System>\n{}  \
         <ssd:DefaultExperiment startTime=\"{:?}\" stopTime=\"{:?}\"/>\n\
         </ssd:SystemStructureDescription>\n",
        escape(&mechanism.description),
        connectors("    ", true),
        connectors("        ", false),
        master(simulation.step),
        units(connected.clone().map(|(variable, _)| variable), "ssd", "  "),
        simulation.start,
        simulation.stop,
    )
}

/// Returns the annotation without which some versions of OMSimulator refuse a system: a master with
/// fixed steps \[s\].
fn master(step: f64) -> String {
    format!(
        "    <ssd:Annotations>\n      \
         <ssc:Annotation type=\"org.openmodelica\">\n        \
         <oms:Annotations xmlns:oms=\"{OMS}\">\n          \
         <oms:SimulationInformation>\n            \
         <oms:FixedStepMaster description=\"oms-ma\" stepSize=\"{step:?}\"/>\n          \
         </oms:SimulationInformation>\n        \
         </oms:Annotations>\n      \
         </ssc:Annotation>\n    \
         </ssd:Annotations>\n"
    )
}

/// Returns the file of parameter values.
fn values<Q>(name: &str, variables: &[Variable<Q>]) -> String {
    let parameters = variables
        .iter()
        .filter(|variable| variable.causality == Causality::Parameter);
    let mut rows = String::new();
    for variable in parameters.clone() {
        let value = match &variable.kind {
            Kind::Real {
                unit,
                start: Some(start),
                ..
            } => {
                let unit = unit.map_or(String::new(), |unit| format!(" unit=\"{}\"", unit.name));
                format!("<ssv:Real value=\"{start:?}\"{unit}/>")
            }
            Kind::Enumeration { start, .. } => format!("<ssv:Integer value=\"{start}\"/>"),
            _ => continue,
        };
        let _ = writeln!(
            rows,
            "    <ssv:Parameter name=\"{}\">{value}</ssv:Parameter>",
            variable.name
        );
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <ssv:ParameterSet {SPACES} version=\"1.0\" name=\"{name}\">\n  \
         <ssv:Parameters>\n{rows}  </ssv:Parameters>\n{}\
         </ssv:ParameterSet>\n",
        units(parameters, "ssv", "  ")
    )
}
