//! The yardsticks in C; their headers in `yardstick/` say what each does.

#![allow(unsafe_code, reason = "calls into C")]

use std::ffi::{CString, c_char, c_int, c_longlong, c_uint, c_ulonglong};
use std::path::Path;
use std::ptr::NonNull;
use std::slice;
use std::time::Duration;

use biela::mechanism::Jet;
use tempfile::TempDir;

use crate::generated::{Ground, SPACING};

/// Outputs of the four-bar: x y phi vx vy omega ax ay alpha of crank, coupler and rocker.
pub const OUTPUTS: usize = 27;

#[repr(C)]
struct Lengths {
    crank: f64,
    coupler: f64,
    rocker: f64,
    base: f64,
}

/// Those of `mechanisms/four_bar.toml`.
const LENGTHS: Lengths = Lengths {
    crank: 0.10,
    coupler: 0.25,
    rocker: 0.30,
    base: 0.40,
};

#[repr(C)]
struct RawChain {
    _opaque: [u8; 0],
}

#[repr(C)]
struct RawCycle {
    _opaque: [u8; 0],
}

unsafe extern "C" {
    fn four_bar_solve(
        lengths: *const Lengths,
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: *mut f64,
    );
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
    fn cycle_open(
        library: *const c_char,
        guid: *const c_char,
        resources: *const c_char,
    ) -> *mut RawCycle;
    fn cycle_close(cycle: *mut RawCycle);
    fn cycle_run(cycle: *mut RawCycle, cycles: c_ulonglong) -> c_longlong;
    fn cycle_inputs(cycle: *const RawCycle) -> *const f64;
    fn cycle_outputs(cycle: *const RawCycle) -> *const f64;
}

/// The four-bar in closed form.
pub fn four_bar(crank: Jet, out: &mut [f64; OUTPUTS]) {
    // SAFETY: reads one `Lengths` and writes `OUTPUTS` numbers.
    unsafe {
        four_bar_solve(
            &LENGTHS,
            crank.value,
            crank.first,
            crank.second,
            out.as_mut_ptr(),
        );
    }
}

/// What a chain computes, and how.
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
    unknowns: usize,
}

impl Chain {
    /// Closed at a crank angle of 60°.
    ///
    /// # Panics
    ///
    /// If there is no memory.
    #[must_use]
    pub fn new(loops: usize, ground: Ground) -> Self {
        let zigzag = c_int::from(ground == Ground::Zigzag);
        let start = std::f64::consts::FRAC_PI_3;
        // SAFETY: any arguments will do.
        let raw = unsafe { chain_new(loops, SPACING, zigzag, start) };
        Self {
            raw: NonNull::new(raw).expect("there is memory"),
            unknowns: 3 * (2 * loops + 1),
        }
    }

    /// Moves the crank. Returns the Newton iterations of all loops together.
    ///
    /// # Panics
    ///
    /// If a loop does not converge.
    pub fn step(&mut self, kind: Kind, crank: Jet) -> usize {
        // SAFETY: the chain lives, and nobody else has it.
        let iterations = unsafe {
            chain_step(
                self.raw.as_ptr(),
                kind as c_uint,
                crank.value,
                crank.first,
                crank.second,
            )
        };
        assert!(iterations > 0, "a loop does not converge");
        iterations as usize
    }

    /// x, y, phi of all bodies, their first and their second rates.
    #[must_use]
    pub fn state(&self) -> [&[f64]; 3] {
        let raw = self.raw.as_ptr();
        // SAFETY: each points to as many numbers, which stay until the next step.
        unsafe {
            [
                chain_position(raw),
                chain_velocity(raw),
                chain_acceleration(raw),
            ]
            .map(|numbers| slice::from_raw_parts(numbers, self.unknowns))
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

impl Drop for Chain {
    fn drop(&mut self) {
        // SAFETY: it lives, and is not used again.
        unsafe { chain_free(self.raw.as_ptr()) }
    }
}

/// An instance of the four-bar's FMU in a host in C.
#[derive(Debug)]
pub struct Cycle {
    raw: NonNull<RawCycle>,
    /// The instance's resources.
    _folder: Option<TempDir>,
}

impl Cycle {
    /// Of the FMU in C.
    ///
    /// # Panics
    ///
    /// If it cannot be run.
    #[must_use]
    pub fn yardstick() -> Self {
        Self::open(Path::new(env!("YARDSTICK_FMU")), "", "", None)
    }

    /// Of biela's library.
    ///
    /// # Panics
    ///
    /// If it cannot be run.
    #[must_use]
    pub fn biela(library: &Path) -> Self {
        let text = include_str!("../../mechanisms/four_bar.toml");
        let guid = biela::fmi::guid(&crate::motion::parse(text));
        let folder = tempfile::tempdir().expect("there is room for temporary files");
        std::fs::write(folder.path().join(biela::fmi::RESOURCE), text).expect("it is ours");
        let resources = format!("file://{}", folder.path().display());
        Self::open(library, &guid, &resources, Some(folder))
    }

    fn open(library: &Path, guid: &str, resources: &str, folder: Option<TempDir>) -> Self {
        let text = |text: &str| CString::new(text).expect("no path holds a zero");
        let path = library.to_str().expect("a path in UTF-8");
        let (path, guid, resources) = (text(path), text(guid), text(resources));
        // SAFETY: three texts, which are not kept.
        let raw = unsafe { cycle_open(path.as_ptr(), guid.as_ptr(), resources.as_ptr()) };
        Self {
            raw: NonNull::new(raw).unwrap_or_else(|| panic!("{} runs", library.display())),
            _folder: folder,
        }
    }

    /// Does so many cycles of setting three inputs, a step and getting 27 outputs. Returns the
    /// time that C measures.
    ///
    /// # Panics
    ///
    /// If a call fails.
    pub fn run(&mut self, cycles: u64) -> Duration {
        // SAFETY: the instance lives, and nobody else has it.
        let nanoseconds = unsafe { cycle_run(self.raw.as_ptr(), cycles) };
        Duration::from_nanos(u64::try_from(nanoseconds).expect("no call fails"))
    }

    /// Inputs of the last cycle.
    #[must_use]
    pub fn inputs(&self) -> Jet {
        // SAFETY: three numbers, which nobody writes now.
        let inputs = unsafe { slice::from_raw_parts(cycle_inputs(self.raw.as_ptr()), 3) };
        Jet {
            value: inputs[0],
            first: inputs[1],
            second: inputs[2],
        }
    }

    /// Outputs of the last cycle.
    #[must_use]
    pub fn outputs(&self) -> &[f64] {
        // SAFETY: as many numbers, which stay until the next run.
        unsafe { slice::from_raw_parts(cycle_outputs(self.raw.as_ptr()), OUTPUTS) }
    }
}

impl Drop for Cycle {
    fn drop(&mut self) {
        // SAFETY: it lives, and is not used again.
        unsafe { cycle_close(self.raw.as_ptr()) }
    }
}
