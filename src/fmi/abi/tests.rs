//! Tests of both versions: cases that no host can bring about, or see, by itself, and the standard's
//! headers. `tests/fmi/c_host` has the rest.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::component::{Component, Handle, StatusCode, status_code};
use crate::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status, Version};
use crate::mechanism::{Mechanism, Source};

/// All statuses that an instance answers with.
pub(super) const STATUSES: [Status; 5] = [
    Status::Ok,
    Status::Warning,
    Status::Discard,
    Status::Error,
    Status::Fatal,
];

/// A sink that panics at its first message and counts the fatal ones after it.
#[derive(Default)]
struct Breaking {
    broken: AtomicBool,
    fatal: Arc<AtomicUsize>,
}

impl Sink for Breaking {
    fn write(&self, status: Status, _: Category, _: &str) {
        assert!(self.broken.swap(true, Ordering::Relaxed), "a defect");
        if status == Status::Fatal {
            self.fatal.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Returns a new instance of the pendulum. Its first message is a defect.
pub(super) fn component(version: Version) -> Handle {
    breaking_component(version, Breaking::default(), false)
}

fn breaking_component(version: Version, sink: Breaking, logging_on: bool) -> Handle {
    let text = include_str!("../../../mechanisms/pendulum.toml");
    let (mechanism, _) = Mechanism::parse(&Source::new("pendulum.toml", text)).unwrap();
    let model = MechanismModel::new(mechanism.into(), Interface::CoSimulation).unwrap();
    let instance = Instance::of_version(version, model, Box::new(sink), logging_on);
    Component::hand_over(instance, None)
}

/// One version of the interface, as far as the tests of both call it.
pub(super) struct Abi<Byte> {
    pub(super) version: Version,
    pub(super) enter_initialization_mode: unsafe fn(Handle) -> StatusCode,
    pub(super) set_one_debug_category: unsafe fn(Handle, *const std::ffi::c_char) -> StatusCode,
    pub(super) get: unsafe fn(Handle, *const u32, usize, *mut f64) -> StatusCode,
    pub(super) set: unsafe fn(Handle, *const u32, usize, *const f64) -> StatusCode,
    pub(super) get_state: unsafe extern "C" fn(Handle, *mut Handle) -> StatusCode,
    pub(super) set_state: unsafe extern "C" fn(Handle, Handle) -> StatusCode,
    pub(super) free_state: unsafe extern "C" fn(Handle, *mut Handle) -> StatusCode,
    pub(super) state_size: unsafe extern "C" fn(Handle, Handle, *mut usize) -> StatusCode,
    pub(super) serialize: unsafe extern "C" fn(Handle, Handle, *mut Byte, usize) -> StatusCode,
    pub(super) deserialize:
        unsafe extern "C" fn(Handle, *const Byte, usize, *mut Handle) -> StatusCode,
    pub(super) free: unsafe extern "C" fn(Handle),
}

/// Status codes of the answers, of which both versions have the same.
const OK: StatusCode = 0;
const ERROR: StatusCode = 3;
const FATAL: StatusCode = 4;

/// An argument of a call: zero, null for what is read, room for what is written.
trait Nothing {
    fn nothing() -> Self;
}

macro_rules! zeros {
    ($($type:ty)*) => {
        $(impl Nothing for $type {
            fn nothing() -> Self {
                Self::default()
            }
        })*
    };
}
zeros! { bool i32 u32 usize f64 }

impl<T> Nothing for *const T {
    fn nothing() -> Self {
        null()
    }
}

impl<T> Nothing for *mut T {
    fn nothing() -> Self {
        const { assert!(size_of::<T>() <= 64 && align_of::<T>() <= 8) };
        Box::leak(Box::new([0_u64; 8])).as_mut_ptr().cast()
    }
}

/// A function that goes to an instance.
pub(super) trait OnInstance<Arguments> {
    /// Calls it with nothing.
    ///
    /// # Safety
    ///
    /// As for the function.
    unsafe fn answer(self, c: Handle) -> StatusCode;
}

macro_rules! on_instance {
    ($($argument:ident)*) => {
        impl<$($argument: Nothing),*> OnInstance<($($argument,)*)>
            for unsafe extern "C" fn(Handle, $($argument),*) -> StatusCode
        {
            unsafe fn answer(self, c: Handle) -> StatusCode {
                // SAFETY: promised by the caller; null pointers are legal arguments or refused, and
                // all others have room.
                unsafe { self(c, $($argument::nothing()),*) }
            }
        }
    };
}
on_instance! {}
on_instance! { A }
on_instance! { A B }
on_instance! { A B C }
on_instance! { A B C D }
on_instance! { A B C D E }
on_instance! { A B C D E F }
on_instance! { A B C D E F G }
on_instance! { A B C D E F G H }

/// Lets a function pass that has the type of the header's own, to which `_own` leads.
pub(super) fn like<Binding, F, E>(_own: fn(&Binding) -> &Result<F, E>) -> fn(F) -> F {
    |function| function
}

/// Compares functions and types of a version with the standard's header: the compiler accepts no
/// other signature. All functions that go to an instance are called, with nothing, in a test.
macro_rules! header_tests {
    (@typed $binding:ident $function:ident) => {
        $crate::fmi::abi::tests::like(|own: &header::$binding| &own.$function)($function)
    };
    (@typed $binding:ident $function:ident $type:ty) => {
        $function as $type
    };
    (
        $abi:ident, $binding:ident;
        on an instance: $($on_instance:ident $(as $type:ty)?),*;
        others: $($other:ident $(as $other_type:ty)?),*;
        of $functions:literal;
        types: $($name:ident)*;
        statuses: $($status:ident)*;
    ) => {
        #[test]
        fn after_a_defect_nothing_but_freeing_is_left() {
            // SAFETY: the test hands over an instance that has not been freed.
            $crate::fmi::abi::tests::after_a_defect_nothing_but_freeing_is_left(&$abi, |c| unsafe {
                [$($crate::fmi::abi::tests::OnInstance::answer(
                    header_tests!(@typed $binding $on_instance $($type)?),
                    c,
                )),*]
            });
        }

        $(const _: fn($name) -> header::$name = |value| value;)*

        /// No exported function and no type is left out of the comparisons.
        #[test]
        fn all_functions_and_types_are_compared() {
            $(header_tests!(@typed $binding $other $($other_type)?);)*
            let functions = [$(stringify!($on_instance),)* $(stringify!($other)),*];
            assert_eq!(functions.len(), $functions);
            let types = include_str!("types.rs").matches("\npub type ").count();
            assert_eq!([$(stringify!($name)),*].len(), types);
        }

        #[test]
        fn statuses_are_those_of_the_header() {
            let statuses = $crate::fmi::abi::tests::STATUSES;
            assert_eq!(
                statuses.map($crate::fmi::abi::component::status_code),
                [$(header::$status),*]
            );
        }

        #[test]
        fn memory_to_be_written_need_not_hold_anything() {
            $crate::fmi::abi::tests::memory_to_be_written_need_not_hold_anything(&$abi);
        }

        #[test]
        fn arrays_begin_at_any_address() {
            $crate::fmi::abi::tests::arrays_begin_at_any_address(&$abi);
        }
    };
}
pub(super) use header_tests;

pub(super) fn after_a_defect_nothing_but_freeing_is_left<Byte, const FUNCTIONS: usize>(
    abi: &Abi<Byte>,
    answers: impl Fn(Handle) -> [StatusCode; FUNCTIONS],
) {
    let sink = Breaking::default();
    let fatal = Arc::clone(&sink.fatal);
    // With logging off, FMI 2.0 tells errors all the same, FMI 3.0 does not.
    let c = breaking_component(abi.version, sink, abi.version == Version::Fmi3);
    // SAFETY: the component is a new one.
    let status = unsafe { (abi.set_one_debug_category)(c, c"nonsense".as_ptr()) };
    assert_eq!(status, FATAL);
    assert_eq!(fatal.load(Ordering::Relaxed), 1);
    assert_eq!(answers(c), [ERROR; FUNCTIONS]);
    assert_eq!(fatal.load(Ordering::Relaxed), 1);
    // SAFETY: it is not used any more.
    unsafe { (abi.free)(c) };
}

/// Getters write to memory that holds nothing yet, as much as they should.
pub(super) fn memory_to_be_written_need_not_hold_anything<Byte: Copy>(abi: &Abi<Byte>) {
    let c = component(abi.version);
    let mut values = [MaybeUninit::<f64>::uninit(); 3];
    let mut state = MaybeUninit::uninit();
    let mut size = MaybeUninit::uninit();
    // SAFETY: the component is a new one, arrays are as long as is said, and `state` is read
    // after `deserialize` has written it.
    unsafe {
        assert_eq!((abi.enter_initialization_mode)(c), OK);
        let status = (abi.get)(c, [1, 2].as_ptr(), 2, values.as_mut_ptr().cast());
        assert_eq!(status, OK);
        let written = [values[0].assume_init(), values[1].assume_init()];
        assert_eq!(written[1].to_bits(), 0.0_f64.to_bits());

        let mut got = null_mut();
        assert_eq!((abi.get_state)(c, &mut got), OK);
        assert_eq!((abi.state_size)(c, got, size.as_mut_ptr()), OK);
        let size = size.assume_init();
        let mut bytes = vec![MaybeUninit::<Byte>::uninit(); size];
        let status = (abi.serialize)(c, got, bytes.as_mut_ptr().cast(), size);
        assert_eq!(status, OK);
        let status = (abi.deserialize)(c, bytes.as_ptr().cast(), size, state.as_mut_ptr());
        assert_eq!(status, OK);
        let mut state = state.assume_init();
        assert_eq!((abi.set_state)(c, state), OK);
        for handle in [&mut got, &mut state] {
            assert_eq!((abi.free_state)(c, handle), OK);
            assert!(handle.is_null());
        }
        (abi.free)(c);
    }
}

/// Hosts that pack their data pass pointers that are not aligned.
pub(super) fn arrays_begin_at_any_address<Byte>(abi: &Abi<Byte>) {
    let c = component(abi.version);
    // SAFETY: the component is a new one.
    assert_eq!(unsafe { (abi.enter_initialization_mode)(c) }, OK);
    for offset in 0..8 {
        let mut memory = [[0_u8; 8]; 8];
        let set = f64::from(offset) + 0.1;
        // SAFETY: the memory has room for a reference, two numbers and a state, each with its offset.
        unsafe {
            let memory = memory.as_mut_ptr().cast::<u8>();
            let [references, given, got, state] =
                [0, 16, 32, 48].map(|place| memory.add(place + offset as usize));
            let (references, state) = (references.cast::<u32>(), state.cast::<Handle>());
            let (given, got) = (given.cast::<f64>(), got.cast::<f64>());
            references.write_unaligned(1);
            given.write_unaligned(set);
            assert_eq!((abi.set)(c, references, 1, given), OK);
            assert_eq!((abi.get)(c, references, 1, got), OK);
            assert_eq!(got.read_unaligned().to_bits(), set.to_bits());
            state.write_unaligned(null_mut());
            assert_eq!((abi.get_state)(c, state), OK);
            assert_eq!((abi.set_state)(c, state.read_unaligned()), OK);
            assert_eq!((abi.free_state)(c, state), OK);
            assert!(state.read_unaligned().is_null());
        }
    }
    // SAFETY: it is not used any more.
    unsafe { (abi.free)(c) };
}

#[test]
fn answers_have_the_codes_that_the_tests_expect() {
    let expected = [OK, ERROR, FATAL];
    assert_eq!(
        [Status::Ok, Status::Error, Status::Fatal].map(status_code),
        expected
    );
}
