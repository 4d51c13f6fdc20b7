//! Chains of loops in C; `yardstick/chain.h` says what they are.

#![allow(unsafe_code, reason = "calls into C")]

use std::ffi::{c_int, c_uint};
use std::ptr::NonNull;
use std::slice;

use biela::mechanism::Jet;

use crate::generated::{Ground, SPACING};
use crate::motion::Stepper;

#[repr(C)]
struct RawChain {
    _opaque: [u8; 0],
}

unsafe extern "C" {
    fn chain_new(loops: usize, spacing: f64, zigzag: c_int, angle: f64) -> *mut RawChain;
    fn chain_free(chain: *mut RawChain);
    fn chain_step(
        chain: *mut RawChain,
        kind: c_uint,
        angle: f64,
        velocity: f64,
        acceleration: f64,
    ) -> c_uint;
    fn chain_position(chain: *const RawChain) -> *const f64;
    fn chain_velocity(chain: *const RawChain) -> *const f64;
    fn chain_acceleration(chain: *const RawChain) -> *const f64;
    fn chain_rcond(chain: *const RawChain) -> f64;
    fn chain_bytes(loops: usize) -> usize;
}

/// Variant of the chain in C.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u32)]
pub enum Kind {
    /// Sines and cosines at the accepted angles.
    Plain,
    /// Sines and cosines that follow Newton's last correction.
    Updated,
    /// As plain, with the reciprocal condition of each block.
    Condition,
}

/// A chain of loops.
#[derive(Debug)]
pub struct Chain {
    raw: NonNull<RawChain>,
    kind: Kind,
    unknowns: usize,
}

impl Chain {
    /// A chain closed at a crank angle of 60°.
    ///
    /// # Panics
    ///
    /// If there is no memory.
    #[must_use]
    pub fn new(loops: usize, ground: Ground, kind: Kind) -> Self {
        let zigzag = c_int::from(ground == Ground::Zigzag);
        let start = std::f64::consts::FRAC_PI_3;
        // SAFETY: any arguments will do.
        let raw = unsafe { chain_new(loops, SPACING, zigzag, start) };
        Self {
            raw: NonNull::new(raw).expect("there is memory"),
            kind,
            unknowns: 3 * (2 * loops + 1),
        }
    }

    /// Smallest reciprocal condition of a block in the last step of [`Kind::Condition`].
    #[must_use]
    pub fn rcond(&self) -> f64 {
        // SAFETY: the chain lives.
        unsafe { chain_rcond(self.raw.as_ptr()) }
    }

    /// Bytes that a chain takes.
    #[must_use]
    pub fn bytes(loops: usize) -> usize {
        // SAFETY: mere arithmetic.
        unsafe { chain_bytes(loops) }
    }
}

impl Stepper for Chain {
    fn step(&mut self, drivers: &[Jet]) {
        let crank = drivers[0];
        // SAFETY: the chain lives, and nobody else has it.
        let iterations = unsafe {
            chain_step(
                self.raw.as_ptr(),
                self.kind as c_uint,
                crank.value,
                crank.first(),
                crank.second(),
            )
        };
        assert!(iterations > 0, "each loop converges");
    }

    fn state(&self) -> [Vec<f64>; 3] {
        let raw = self.raw.as_ptr();
        // SAFETY: each points to as many numbers, which stay until the next step.
        unsafe {
            [
                chain_position(raw),
                chain_velocity(raw),
                chain_acceleration(raw),
            ]
            .map(|numbers| slice::from_raw_parts(numbers, self.unknowns).to_vec())
        }
    }
}

impl Drop for Chain {
    fn drop(&mut self) {
        // SAFETY: it lives, and is not used again.
        unsafe { chain_free(self.raw.as_ptr()) }
    }
}
