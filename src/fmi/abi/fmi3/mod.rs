//! Every function of `fmi3Functions.h`.

mod access;
mod derivatives;
mod exchange;
mod fmu_state;
mod host;
mod lifecycle;
mod stepping;
#[cfg(test)]
mod tests;
mod types;
