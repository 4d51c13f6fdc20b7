//! Setting and getting variables, all of which are scalars; clocks are none.

use std::ffi::c_char;

use crate::fmi::abi::arguments::{fill, room, slice};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::{Call, Error};

/// Checks that there are as many values as variables.
pub(super) fn check_count(name: &'static str, given: usize, expected: usize) -> Result<(), Error> {
    if given == expected {
        Ok(())
    } else {
        Err(Error::Count {
            name,
            given,
            expected,
        })
    }
}

instance_calls! {
    /// `fmi3GetFloat64`.
    fmi3GetFloat64(
        value_references: *const u32,
        n_value_references: usize,
        values: *mut f64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        let room = room("values", values, n_values)?;
        instance.reals(&references)?.write_to(room);
        Ok(())
    };
    /// `fmi3SetFloat64`.
    fmi3SetFloat64(
        value_references: *const u32,
        n_value_references: usize,
        values: *const f64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        instance.set_real(&references, &slice("values", values, n_values)?)
    };
    /// `fmi3GetInt64`: the choices.
    fmi3GetInt64(
        value_references: *const u32,
        n_value_references: usize,
        values: *mut i64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        let room = room("values", values, n_values)?;
        fill(room, instance.integers(&references)?.map(i64::from));
        Ok(())
    };
    /// `fmi3SetInt64`.
    fmi3SetInt64(
        value_references: *const u32,
        n_value_references: usize,
        values: *const i64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        instance.set_integer(&references, &slice("values", values, n_values)?)
    };
}

/// Defines the access functions of types that no variable has, which touch none of their arrays: right for
/// an empty list only.
macro_rules! without_variables {
    ($($function:ident($call:ident, $type:literal, $($array:ty),+);)*) => {
        instance_calls! {
                    $(
                #[doc = concat!("`", stringify!($function), "`: there are no ", $type, " variables.")]
                $function(
                    value_references: *const u32,
                    n_value_references: usize,
                    $(_: $array,)+
                    n_values: usize
                ) = |instance| {
                    check_count("nValues", n_values, n_value_references)?;
                    let references = slice("valueReferences", value_references, n_value_references)?;
                    instance.no_variables(Call::$call, $type, &references)
                };
            )*
        }
    };
}

without_variables! {
    fmi3GetFloat32(GetFloat32, "Float32", *mut f32);
    fmi3SetFloat32(SetFloat32, "Float32", *const f32);
    fmi3GetInt8(GetInt8, "Int8", *mut i8);
    fmi3SetInt8(SetInt8, "Int8", *const i8);
    fmi3GetUInt8(GetUInt8, "UInt8", *mut u8);
    fmi3SetUInt8(SetUInt8, "UInt8", *const u8);
    fmi3GetInt16(GetInt16, "Int16", *mut i16);
    fmi3SetInt16(SetInt16, "Int16", *const i16);
    fmi3GetUInt16(GetUInt16, "UInt16", *mut u16);
    fmi3SetUInt16(SetUInt16, "UInt16", *const u16);
    fmi3GetInt32(GetInt32, "Int32", *mut i32);
    fmi3SetInt32(SetInt32, "Int32", *const i32);
    fmi3GetUInt32(GetUInt32, "UInt32", *mut u32);
    fmi3SetUInt32(SetUInt32, "UInt32", *const u32);
    fmi3GetUInt64(GetUInt64, "UInt64", *mut u64);
    fmi3SetUInt64(SetUInt64, "UInt64", *const u64);
    fmi3GetBoolean(GetBoolean, "Boolean", *mut bool);
    fmi3SetBoolean(SetBoolean, "Boolean", *const bool);
    fmi3GetString(GetString, "String", *mut *const c_char);
    fmi3SetString(SetString, "String", *const *const c_char);
    fmi3GetBinary(GetBinary, "Binary", *mut usize, *mut *const u8);
    fmi3SetBinary(SetBinary, "Binary", *const usize, *const *const u8);
}

/// Defines the functions of clocks, which touch none of their arrays: right for an empty list only.
macro_rules! without_clocks {
    ($($function:ident($call:ident, $($array:ty),+);)*) => {
        instance_calls! {
                    $(
                #[doc = concat!("`", stringify!($function), "`: there are no clocks.")]
                $function(
                    value_references: *const u32,
                    n_value_references: usize,
                    $(_: $array),+
                ) = |instance| {
                    let references = slice("valueReferences", value_references, n_value_references)?;
                    instance.no_variables(Call::$call, "Clock", &references)
                };
            )*
        }
    };
}

without_clocks! {
    fmi3GetClock(GetClock, *mut bool);
    fmi3SetClock(SetClock, *const bool);
    fmi3GetIntervalDecimal(GetIntervalDecimal, *mut f64, *mut u32);
    fmi3GetIntervalFraction(
        GetIntervalFraction, *mut u64, *mut u64, *mut u32
    );
    fmi3GetShiftDecimal(GetShiftDecimal, *mut f64);
    fmi3GetShiftFraction(GetShiftFraction, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(SetIntervalDecimal, *const f64);
    fmi3SetIntervalFraction(SetIntervalFraction, *const u64, *const u64);
    fmi3SetShiftDecimal(SetShiftDecimal, *const f64);
    fmi3SetShiftFraction(SetShiftFraction, *const u64, *const u64);
}

instance_calls! {
    /// `fmi3ActivateModelPartition`: always refused, since there are no clocks.
    fmi3ActivateModelPartition(
        _clock_reference: u32,
        _activation_time: f64,
    ) = |instance| instance.allow(Call::ActivateModelPartition);
}
