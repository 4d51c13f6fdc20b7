//! Targets for fuzzing: each takes any bytes and panics where biela is wrong.
//!
//! `corpus/` has a folder a target with inputs from which mutations start, what was found among
//! them.

pub mod attack;
pub mod call_sequence;
pub mod fmu_state;
pub mod import;
pub mod mechanism_file;
pub mod mutation;

use std::sync::Arc;

use biela::fmi::{Category, Interface, MechanismModel, MechanismState, Sink, Status, Version};
use biela::kinematics::Error;
use biela::mechanism::{Mechanism, Source};

/// An instance under test.
type Instance = biela::fmi::Instance<MechanismModel>;
type FmuState = biela::fmi::FmuState<MechanismState>;

/// A log that nobody reads.
struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, _: &str) {}
}

/// A new instance.
fn instance(
    mechanism: &Arc<Mechanism>,
    version: Version,
    interface: Interface,
) -> Result<Instance, Error> {
    let model = MechanismModel::new(Arc::clone(mechanism), interface)?;
    let sink = Box::new(Silent);
    Ok(Instance::of_version(version, model, sink, true))
}

/// Some shipped mechanisms: one input, several, prescribed motions of tables and tunable
/// parameters, a joint's own unknowns, gears, forces.
fn shipped(index: u8) -> Arc<Mechanism> {
    let texts = [
        include_str!("../../../mechanisms/tlv.toml"),
        include_str!("../../../mechanisms/four_bar.toml"),
        include_str!("../../../mechanisms/five_bar_robot.toml"),
        include_str!("../../../mechanisms/pick_and_place.toml"),
        include_str!("../../../mechanisms/cam_roller_arm.toml"),
        include_str!("../../../mechanisms/rack_drive.toml"),
        include_str!("../../../mechanisms/engine.toml"),
        include_str!("../../../mechanisms/swinging_tip.toml"),
        include_str!("../../../mechanisms/slider_crank_motor.toml"),
        include_str!("../../../tests/fmpy/mechanisms/triple_rocker.toml"),
    ];
    let text = texts[usize::from(index) % texts.len()];
    let (mechanism, _) =
        Mechanism::parse(&Source::new("shipped.toml", text)).expect("it has no errors");
    Arc::new(mechanism)
}

/// The value references of all Reals.
fn reals(instance: &Instance) -> Vec<u32> {
    let variables = (1..).zip(instance.variables());
    variables
        .filter(|(_, variable)| variable.kind.is_real())
        .map(|(reference, _)| reference)
        .collect()
}
