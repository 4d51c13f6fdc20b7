//! The C interface of `biela::fmi` as a shared library, which exports the functions of
//! `fmi2Functions.h` and `fmi3Functions.h`, and nothing else.

// Naming the crate links it, and its exported functions with it.
use biela as _;
