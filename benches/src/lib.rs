//! What biela's speed is measured against, and what both sides are made to do.

#[path = "../../tests/common/generated.rs"]
pub mod generated;
pub mod motion;
pub mod sizes;
pub mod yardstick;
