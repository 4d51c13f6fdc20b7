//! The floating-point environment during a call.
//!
//! A host may leave another rounding mode set, flush tiny numbers to zero, or trap exceptions.
//! Decimals, elementary functions and proofs assume rounding to nearest without traps, so that each
//! call sets this environment, and puts that of the host back at its end. The host's logger is
//! called in between.

/// The environment that Rust assumes, for as long as this value lives.
pub(super) struct StandardEnvironment {
    /// The host's control register, where it differs.
    hosts: Option<Register>,
}

impl StandardEnvironment {
    /// Sets the environment.
    #[inline(always)]
    pub(super) fn set() -> Self {
        let present = control();
        let standard = (present & !CONTROL) | STANDARD;
        let differs = present != standard;
        if differs {
            set_control(standard);
        }
        Self {
            hosts: differs.then_some(present),
        }
    }
}

impl Drop for StandardEnvironment {
    #[inline(always)]
    fn drop(&mut self) {
        if let Some(hosts) = self.hosts {
            set_control(hosts);
        }
    }
}

#[cfg(all(target_arch = "x86_64", not(windows)))]
use x86_64::{CONTROL, Register, STANDARD, control, set_control};

/// The register `MXCSR`.
#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use std::arch::asm;

    pub(super) type Register = u32;

    /// Bits that control operations: flush to zero, rounding, masks of exceptions, denormals as
    /// zeros. The others are flags of past exceptions.
    pub(super) const CONTROL: Register = 0xFFC0;
    /// Rounding to nearest, all exceptions masked.
    pub(super) const STANDARD: Register = 0x1F80;

    #[inline(always)]
    pub(super) fn control() -> Register {
        let mut value: Register = 0;
        // SAFETY: the instruction writes the four bytes behind the pointer and nothing else.
        unsafe {
            asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags));
        }
        value
    }

    #[inline(always)]
    pub(super) fn set_control(value: Register) {
        // SAFETY: the value came from this register, or has its standard bits in place of control
        // bits, so that no reserved bit is set.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags));
        }
    }
}

#[cfg(all(target_arch = "x86_64", windows))]
use x86_64_windows::{CONTROL, Register, STANDARD, control, set_control};

/// The register `MXCSR`, and above it the control word of the x87, with which the C library
/// evaluates elementary functions on Windows.
#[cfg(all(target_arch = "x86_64", windows))]
mod x86_64_windows {
    use std::arch::asm;

    use super::x86_64;

    pub(super) type Register = u64;

    /// Place of the control word.
    const X87: u32 = 32;
    /// Also masks of exceptions, precision and rounding of the x87.
    pub(super) const CONTROL: Register = x86_64::CONTROL as Register | 0x0F3F << X87;
    /// Also all exceptions masked, 64 bits of precision and rounding to nearest in the x87.
    pub(super) const STANDARD: Register = x86_64::STANDARD as Register | 0x033F << X87;

    #[inline(always)]
    pub(super) fn control() -> Register {
        let mut x87: u16 = 0;
        // SAFETY: the instruction writes the two bytes behind the pointer and nothing else.
        unsafe {
            asm!("fnstcw [{}]", in(reg) &raw mut x87, options(nostack, preserves_flags));
        }
        Register::from(x86_64::control()) | Register::from(x87) << X87
    }

    #[inline(always)]
    pub(super) fn set_control(value: Register) {
        x86_64::set_control(value as u32);
        let x87 = (value >> X87) as u16;
        // SAFETY: the value came from this register, or has its standard bits in place of control
        // bits. Flags of exceptions are cleared, which would trap if the value unmasks theirs.
        unsafe {
            asm!("fnclex", "fldcw [{}]", in(reg) &raw const x87, options(nostack));
        }
    }
}

#[cfg(target_arch = "aarch64")]
use aarch64::{CONTROL, Register, STANDARD, control, set_control};

/// The register `FPCR`.
#[cfg(target_arch = "aarch64")]
mod aarch64 {
    use std::arch::asm;

    pub(super) type Register = u64;

    /// Bits that control operations on f64: trapped exceptions, rounding, flush to zero, default
    /// NaN.
    pub(super) const CONTROL: Register = 0x03C0_9F00;
    /// Rounding to nearest, no traps.
    pub(super) const STANDARD: Register = 0;

    #[inline(always)]
    pub(super) fn control() -> Register {
        let value: Register;
        // SAFETY: the instruction reads a register that every program may read.
        unsafe {
            asm!("mrs {}, fpcr", out(reg) value, options(nostack, preserves_flags));
        }
        value
    }

    #[inline(always)]
    pub(super) fn set_control(value: Register) {
        // SAFETY: the value came from this register, or has control bits cleared.
        unsafe {
            asm!("msr fpcr, {}", in(reg) value, options(nostack, preserves_flags));
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
use other::{CONTROL, Register, STANDARD, control, set_control};

/// Processors without a control register, or with an unknown one.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod other {
    pub(super) type Register = u32;
    pub(super) const CONTROL: Register = 0;
    pub(super) const STANDARD: Register = 0;

    pub(super) fn control() -> Register {
        STANDARD
    }

    pub(super) fn set_control(_: Register) {}
}
