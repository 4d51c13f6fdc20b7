//! Drawings, charts and animations.

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/generated.rs"]
#[allow(dead_code, reason = "also used by `crates/benches`")]
mod generated;

mod animation;
mod drawing;
