//! Drawings of mechanisms: the symbols of the scene, and whole pictures.

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
