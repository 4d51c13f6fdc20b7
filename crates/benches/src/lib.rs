//! Measures biela beside yardsticks in C.
//!
//! | module | content |
//! |---|---|
//! | [`motion`] | the same motion for both sides; a mechanism that biela moves |
//! | [`by_hand`] | single mechanisms in C |
//! | [`chain`] | chains of loops in C |
//! | [`free`] | free motion, by biela and with accelerations in C |
//! | [`cycle`] | FMUs in a host in C |
//! | [`clock`] | the time that this thread has run |
//! | [`cases`] | what can be measured, by name |
//! | [`comparisons`] | which case is measured by which |
//! | [`instructions`] | instructions per step |
//! | [`sizes`] | which sizes are measured |

#[path = "../../../tests/common/generated.rs"]
pub mod generated;

pub mod by_hand;
pub mod cases;
pub mod chain;
pub mod clock;
pub mod comparisons;
pub mod cycle;
pub mod free;
pub mod instructions;
pub mod motion;
pub mod sizes;

/// Text of a shipped mechanism.
#[macro_export]
macro_rules! shipped {
    ($name:literal) => {
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../mechanisms/",
            $name,
            ".toml"
        ))
    };
}
