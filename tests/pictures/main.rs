//! Drawings, charts and animations.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/generated.rs"]
#[allow(dead_code, reason = "also used by `benches/`")]
mod generated;

mod animation;
mod drawing;
