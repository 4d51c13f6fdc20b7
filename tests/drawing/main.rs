//! Drawings of mechanisms: the symbols of the scene, and whole pictures.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/generated.rs"]
#[allow(dead_code, reason = "each test file uses a part of this")]
mod generated;

mod cams;
mod charts;
mod diagrams;
mod gallery;
mod links;
mod loads;
mod pictures;
mod scenes;
mod sheets;
mod traces;
mod ways;
mod wheels;
