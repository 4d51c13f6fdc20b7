//! FMUs of the four-bar in a host in C; `yardstick/cycle.h` says what a cycle does.

#![allow(unsafe_code, reason = "calls into C")]

use std::array;
use std::ffi::{CString, c_char, c_int, c_longlong, c_uint, c_ulonglong};
use std::path::Path;
use std::ptr::NonNull;
use std::slice;
use std::time::Duration;

use biela::mechanism::Jet;
use set_up::runtime_library;
use tempfile::TempDir;

use crate::by_hand::OUTPUTS;
use crate::motion::parse;
use crate::shipped;

#[repr(C)]
struct RawCycle {
    _opaque: [u8; 0],
}

unsafe extern "C" {
    fn cycle_open(
        library: *const c_char,
        version: c_int,
        token: *const c_char,
        resources: *const c_char,
        turn: c_uint,
        order: *const c_uint,
    ) -> *mut RawCycle;
    fn cycle_close(cycle: *mut RawCycle);
    fn cycle_run(cycle: *mut RawCycle, cycles: c_ulonglong) -> c_longlong;
    fn cycle_inputs(cycle: *const RawCycle) -> *const f64;
    fn cycle_outputs(cycle: *const RawCycle) -> *const f64;
}

/// Order in which a cycle gets the outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Ascending value references, which is body by body.
    File,
    /// x of all bodies, then y of all, and so on.
    Quantity,
    /// Descending value references.
    Reversed,
    /// A permutation drawn once.
    Random,
}

/// Drawn once.
const PERMUTATION: [c_uint; OUTPUTS] = [
    11, 4, 22, 0, 16, 9, 25, 13, 2, 20, 7, 18, 26, 5, 14, 1, 23, 10, 19, 6, 12, 3, 24, 17, 8, 21,
    15,
];

impl Order {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::File, Self::Quantity, Self::Reversed, Self::Random];

    /// Numbers of the outputs in this order, 0 for the first in the file.
    #[must_use]
    pub fn outputs(self) -> [c_uint; OUTPUTS] {
        array::from_fn(|place| {
            let number = place as c_uint;
            match self {
                Self::File => number,
                Self::Quantity => 9 * (number % 3) + number / 3,
                Self::Reversed => OUTPUTS as c_uint - 1 - number,
                Self::Random => PERMUTATION[place],
            }
        })
    }
}

/// An instance of the four-bar's FMU in a host in C.
#[derive(Debug)]
pub struct Cycle {
    raw: NonNull<RawCycle>,
    order: Order,
    /// The instance's resources.
    _folder: Option<TempDir>,
}

impl Cycle {
    /// Runs the FMU in C, `turn` steps per turn of the crank.
    ///
    /// # Panics
    ///
    /// If it cannot be run.
    #[must_use]
    pub fn yardstick(turn: u32, order: Order) -> Self {
        let library = Path::new(env!("YARDSTICK_FMU"));
        Self::open((library, 2), "", "", None, turn, order)
    }

    /// Runs biela's [`runtime_library`] by the functions of version 2 or 3 of FMI, `turn` steps per
    /// turn of the crank.
    ///
    /// # Panics
    ///
    /// If it cannot be run.
    #[must_use]
    pub fn biela(version: c_int, turn: u32, order: Order) -> Self {
        let text = shipped!("four_bar");
        let guid = biela::fmi::guid(&parse(text));
        let folder = tempfile::tempdir().expect("there is room for temporary files");
        std::fs::write(folder.path().join(biela::fmi::RESOURCE), text).expect("it is ours");
        // FMI 2.0 asks for a URI, FMI 3.0 for a path.
        let folder_path = folder.path().display();
        let resources = match version {
            2 => format!("file://{folder_path}"),
            _ => format!("{folder_path}/"),
        };
        Self::open(
            (&runtime_library(), version),
            &guid,
            &resources,
            Some(folder),
            turn,
            order,
        )
    }

    fn open(
        (library, version): (&Path, c_int),
        guid: &str,
        resources: &str,
        folder: Option<TempDir>,
        turn: u32,
        order: Order,
    ) -> Self {
        let text = |text: &str| CString::new(text).expect("no path holds a zero");
        let path = library.to_str().expect("a path in UTF-8");
        let (path, guid, resources) = (text(path), text(guid), text(resources));
        // SAFETY: three texts and `OUTPUTS` numbers, which are not kept.
        let raw = unsafe {
            cycle_open(
                path.as_ptr(),
                version,
                guid.as_ptr(),
                resources.as_ptr(),
                turn,
                order.outputs().as_ptr(),
            )
        };
        Self {
            raw: NonNull::new(raw).unwrap_or_else(|| panic!("{} runs", library.display())),
            order,
            _folder: folder,
        }
    }

    /// Does a number of cycles: each sets three inputs, steps and gets 27 outputs. Returns the
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
        Jet::new(inputs[0], [inputs[1], inputs[2]])
    }

    /// Outputs of the last cycle: for each body x y phi vx vy omega ax ay alpha.
    #[must_use]
    pub fn outputs(&self) -> [f64; OUTPUTS] {
        // SAFETY: as many numbers, which stay until the next run.
        let got = unsafe { slice::from_raw_parts(cycle_outputs(self.raw.as_ptr()), OUTPUTS) };
        let mut outputs = [f64::NAN; OUTPUTS];
        for (number, value) in self.order.outputs().into_iter().zip(got) {
            outputs[number as usize] = *value;
        }
        outputs
    }
}

impl Drop for Cycle {
    fn drop(&mut self) {
        // SAFETY: it lives, and is not used again.
        unsafe { cycle_close(self.raw.as_ptr()) }
    }
}
