//! The report of `biela check` as JSON.

use std::path::Path as FilePath;
use std::sync::Arc;

use serde_json::{Value, json};

use super::forces::Forces;
use super::{NEARLY_SINGULAR, equations_of_joints, excursions};
use crate::cli::given::input::cannot_rest;
use crate::cli::given::settings::Settings;
use crate::cli::told::error::Error;
use biela::dynamics::KeptStart;
use biela::kinematics::{self, NeededPlay, OpenJoint, Path, Rates, Solver, System, offer_start};
use biela::mechanism::{BodyId, Diagnostic, DriverSource, Mechanism, Source};

/// Returns the report on a file and the outcome of the command.
///
/// The report tells all errors but those of a file that cannot be read and of settings.
pub(super) fn report(
    file: &FilePath,
    settings: &Settings,
    modes: bool,
) -> (Value, Result<(), Error>) {
    let name = file.display().to_string();
    let read = Source::open(name.clone(), file).map_err(Error::read(file));
    let changed = read.and_then(|source| match Mechanism::parse(&source) {
        Ok((mechanism, _)) => settings.changed(source, &mechanism),
        Err(_) => Ok(source),
    });
    match changed {
        Ok(source) => {
            let report = report_on(&source, modes);
            let outcome = match report["ok"].as_bool() {
                Some(true) => Ok(()),
                _ => Err(Error::Diagnosed),
            };
            (report, outcome)
        }
        Err(error) => {
            let message = error.to_string();
            let report = json!({ "file": name, "ok": false, "error": { "message": message } });
            (report, Err(error))
        }
    }
}

/// Returns the report on a mechanism, in SI units.
///
/// Keys without a value are left out: `mechanism` if the file has errors, `assembled` if the
/// mechanism does not close, `modes` if they were not asked for.
pub(in crate::cli) fn report_on(source: &Source, modes: bool) -> Value {
    let mut report = json!({ "file": source.name(), "ok": false });
    let (mechanism, warnings) = match Mechanism::parse(source) {
        Ok((mechanism, warnings)) => (Arc::new(mechanism), warnings),
        Err(errors) => {
            report["diagnostics"] = diagnostics(source, &errors);
            return report;
        }
    };
    report["diagnostics"] = diagnostics(source, &warnings);
    report["mechanism"] = describe(&mechanism);
    match assembled(&mechanism, modes) {
        Ok((found, cannot_rest)) => {
            report["ok"] = json!(cannot_rest.is_none());
            report["assembled"] = found;
            if let Some(message) = cannot_rest {
                report["error"] = json!({ "message": message });
            }
        }
        Err(error) => {
            let error = offer_start(error, &mechanism);
            report["error"] = json!({ "message": error.to_string() });
            if let kinematics::Error::NotAssembled { open, nearest, .. } = &error {
                report["error"]["open"] = gaps(open);
                report["error"]["nearest"] = poses(&mechanism, nearest);
            }
            if let Some(play) = NeededPlay::find(&mechanism, &error) {
                report["error"]["play"] = json!({
                    "driver": mechanism.drivers[play.driver.index()].name,
                    "from": play.range[0],
                    "to": play.range[1],
                    "open": gaps(&[play.open]),
                });
            }
        }
    }
    report
}

fn diagnostics(source: &Source, diagnostics: &[Diagnostic]) -> Value {
    let place = |offset: usize| {
        let position = source.position(offset);
        json!({ "line": position.line, "column": position.column })
    };
    let diagnostics = diagnostics.iter().map(|diagnostic| {
        let labels = diagnostic.labels.iter().map(|label| {
            json!({
                "start": place(label.span.start),
                "end": place(label.span.end),
                "text": label.text,
            })
        });
        json!({
            "severity": diagnostic.severity.as_str(),
            "code": diagnostic.code,
            "message": diagnostic.message,
            "help": diagnostic.help,
            "labels": labels.collect::<Vec<_>>(),
        })
    });
    diagnostics.collect()
}

fn describe(mechanism: &Arc<Mechanism>) -> Value {
    let system = System::new(Arc::clone(mechanism));
    let equations = equations_of_joints(&system);
    let bodies = mechanism.bodies.iter().map(|body| &body.name);
    let joints = mechanism.joints.iter().zip(equations);
    let joints =
        joints.map(|(joint, equations)| json!({ "name": joint.name, "equations": equations }));
    let drivers = mechanism.drivers.iter().map(|driver| {
        json!({
            "name": driver.name,
            "input": matches!(driver.source, DriverSource::Input { .. }),
            "unit": driver.coordinate.kind.unit().name.as_str(),
        })
    });
    json!({
        "name": mechanism.name,
        "description": mechanism.description,
        "unknowns": system.unknowns(),
        "bodies": bodies.collect::<Vec<_>>(),
        "joints": joints.collect::<Vec<_>>(),
        "constraints": mechanism.constraints.iter().map(|c| &c.name).collect::<Vec<_>>(),
        "drivers": drivers.collect::<Vec<_>>(),
    })
}

/// Returns area, mass, centre and inertia of each body with shapes; without a density the area alone.
fn shapes(mechanism: &Mechanism, parameters: &[f64]) -> Vec<Value> {
    let bodies = mechanism.bodies.iter().zip((0..).map(BodyId));
    let shapes = bodies.filter_map(|(body, id)| {
        let section = mechanism.section_of(id, parameters)?;
        let mut found = json!({ "body": body.name, "area": section.area });
        let weight = mechanism.weight_at(id, parameters);
        if let Some(weight) = weight.filter(|_| body.is_weighed) {
            found["mass"] = json!(weight.mass);
            found["center"] = json!(weight.center);
            found["inertia"] = json!(weight.inertia);
        }
        Some(found)
    });
    shapes.collect()
}

/// Assembles the mechanism at its start values and describes the pose; also says why it cannot rest
/// there.
fn assembled(
    mechanism: &Arc<Mechanism>,
    modes: bool,
) -> Result<(Value, Option<String>), kinematics::Error> {
    let mut solver = Solver::assembled(Arc::clone(mechanism), &Path::new(mechanism))?;
    let kept = KeptStart::of(mechanism);
    if let Some(kept) = &kept {
        solver.restore(&kept.pose);
    }
    let overlaps = kept.iter().flat_map(|kept| &kept.overlaps);
    let rcond = solver.rcond();
    let pose = solver.pose();
    let still = Rates::new(pose.q.len());
    let drivers = mechanism.drivers.iter().zip(&pose.drivers);
    let measures = mechanism
        .measures
        .iter()
        .enumerate()
        .map(|(index, measure)| {
            json!({
                "name": measure.name,
                "value": solver.measure(index, &still).value,
                "unit": measure.coordinate.kind.unit().name.as_str(),
            })
        });
    let (misfits, drawn) = (solver.geometry_warnings(), solver.drawn_apart());
    let misfits = misfits.iter().map(ToString::to_string);
    let drawn = drawn.iter().map(ToString::to_string);
    let texts = |texts: &mut dyn Iterator<Item = String>| texts.collect::<Vec<_>>();
    let mut found = json!({
        "degrees_of_freedom": mechanism.drivers.len(),
        "drivers": drivers.map(|(driver, value)| json!({
            "name": driver.name,
            "value": value,
            "unit": driver.coordinate.kind.unit().name.as_str(),
        })).collect::<Vec<_>>(),
        "bodies": poses(mechanism, &pose.q),
        "measures": measures.collect::<Vec<_>>(),
        "residual": solver.residual(),
        "rcond": rcond,
        "nearly_singular": rcond < NEARLY_SINGULAR,
        "redundancies": texts(&mut solver.redundancies().iter().map(ToString::to_string)),
        "misfits": texts(&mut misfits.chain(drawn)),
        "excursions": excursions(&solver),
        "overlaps": texts(&mut overlaps.map(|overlap| overlap.describe(mechanism))),
    });
    let shapes = shapes(mechanism, &solver.pose().parameters);
    if !shapes.is_empty() {
        found["shapes"] = shapes.into();
    }
    if mechanism.has_dynamics() {
        let forces = Forces::at_rest(&mut solver)?;
        let values = forces.values.iter();
        let values = values.map(
            |(name, value, unit)| json!({ "name": name, "value": value, "unit": unit.as_str() }),
        );
        found["forces"] = values.collect();
        found["indeterminate"] = json!(forces.indeterminate);
        let slow = forces.slow.iter().map(|slow| {
            json!({
                "driver": slow.driver,
                "efforts": slow.efforts,
                "self_locking": slow.is_self_locking(),
            })
        });
        found["slow_motion"] = slow.collect();
    }
    if modes {
        let modes = solver.modes()?;
        let others = modes.others.iter().map(|mode| {
            json!({
                "bodies": poses(mechanism, &mode.q),
                "rcond": mode.rcond,
            })
        });
        found["modes"] = json!({
            "complete": modes.complete,
            "others": others.collect::<Vec<_>>(),
        });
    }
    Ok((found, cannot_rest(&mut solver)))
}

fn gaps(joints: &[OpenJoint]) -> Value {
    let joints = joints.iter();
    joints
        .map(|joint| json!({ "element": joint.origin, "gap": joint.gap, "angle": joint.angle }))
        .collect()
}

fn poses(mechanism: &Mechanism, q: &[f64]) -> Value {
    let bodies = mechanism.bodies.iter().zip(q.chunks_exact(3));
    bodies
        .map(|(body, q)| json!({ "name": body.name, "x": q[0], "y": q[1], "phi": q[2] }))
        .collect()
}
