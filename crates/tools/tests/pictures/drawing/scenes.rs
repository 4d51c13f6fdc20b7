//! Scenes of mechanisms, and queries of their symbols.

use biela_tools::drawing::{Scene, Symbol};

use crate::common::{assembled, parse, shipped};

/// Returns the scene of a mechanism file's text.
pub(crate) fn scene_of(text: &str) -> Scene {
    Scene::new(&mut assembled(&parse(text)).0, true)
}

/// Returns the scene of a shipped mechanism.
pub(crate) fn scene(name: &str) -> Scene {
    Scene::new(&mut assembled(&shipped(name)).0, true)
}

/// Returns the points of a body's link, if it has one.
pub(crate) fn link(scene: &Scene, body: usize) -> Option<Vec<[f64; 2]>> {
    scene.symbols.iter().find_map(|s| match s {
        Symbol::Link(link) if link.body.index() == body => Some(link.points.clone()),
        _ => None,
    })
}

pub(crate) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}
