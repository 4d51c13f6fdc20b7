//! Every function of `fmi2Functions.h`.

mod access;
mod exchange;
mod fmu_state;
mod host;
mod lifecycle;
mod stepping;
#[cfg(test)]
mod tests;
mod types;
