//! Assembly, motion, singular positions and forces, against closed forms.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/differences.rs"]
mod differences;
#[path = "../common/generated.rs"]
#[allow(dead_code, reason = "also used by `crates/benches`")]
mod generated;

mod assembly;
mod cam;
mod closed_form;
mod contacts;
mod coupling;
mod curve;
mod drawn;
mod forces;
mod free;
mod functions;
mod integrator;
mod machines;
mod modes;
mod motion;
mod notices;
mod range;
mod redundancy;
mod rope;
mod sensitivity;
mod singular;
mod start;
mod stepping;
mod stops;
mod verdicts;
mod whole_turns;
