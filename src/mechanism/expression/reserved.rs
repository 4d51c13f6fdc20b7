//! Names that are reserved.

use super::function::{CONSTANTS, function_names};

/// Names that the FMU or the language of the file uses, besides constants and functions.
const TAKEN: [&str; 9] = [
    "ground",
    "solver",
    "rates",
    "extrapolation",
    "energy",
    "time",
    "t",
    "position",
    "velocity",
];

/// Returns the names that parameters, bodies, joints and the like cannot have.
pub(in crate::mechanism) fn taken() -> impl Iterator<Item = &'static str> {
    let constants = CONSTANTS.iter().map(|(constant, _)| *constant);
    TAKEN.into_iter().chain(constants).chain(function_names())
}

/// Returns whether parameters, bodies, joints and the like cannot be called `name`.
pub fn is_taken(name: &str) -> bool {
    taken().any(|taken| taken == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taken_names_include_constants_and_functions() {
        for name in ["ground", "t", "pi", "rpm", "inch", "sin", "max", "energy"] {
            assert!(is_taken(name), "{name}");
        }
        assert!(!is_taken("crank"));
    }
}
