//! Setting and getting variables, all of which are scalars; clocks are none.

use super::types::{
    fmi3Binary, fmi3Boolean, fmi3Clock, fmi3Float32, fmi3Float64, fmi3Int8, fmi3Int16, fmi3Int32,
    fmi3Int64, fmi3IntervalQualifier, fmi3String, fmi3UInt8, fmi3UInt16, fmi3UInt32, fmi3UInt64,
    fmi3ValueReference,
};
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
        value_references: *const fmi3ValueReference,
        n_value_references: usize,
        values: *mut fmi3Float64,
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
        value_references: *const fmi3ValueReference,
        n_value_references: usize,
        values: *const fmi3Float64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        instance.set_real(&references, &slice("values", values, n_values)?)
    };
    /// `fmi3GetInt64`: the choices.
    fmi3GetInt64(
        value_references: *const fmi3ValueReference,
        n_value_references: usize,
        values: *mut fmi3Int64,
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
        value_references: *const fmi3ValueReference,
        n_value_references: usize,
        values: *const fmi3Int64,
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
                    value_references: *const fmi3ValueReference,
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
    fmi3GetFloat32(GetFloat32, "Float32", *mut fmi3Float32);
    fmi3SetFloat32(SetFloat32, "Float32", *const fmi3Float32);
    fmi3GetInt8(GetInt8, "Int8", *mut fmi3Int8);
    fmi3SetInt8(SetInt8, "Int8", *const fmi3Int8);
    fmi3GetUInt8(GetUInt8, "UInt8", *mut fmi3UInt8);
    fmi3SetUInt8(SetUInt8, "UInt8", *const fmi3UInt8);
    fmi3GetInt16(GetInt16, "Int16", *mut fmi3Int16);
    fmi3SetInt16(SetInt16, "Int16", *const fmi3Int16);
    fmi3GetUInt16(GetUInt16, "UInt16", *mut fmi3UInt16);
    fmi3SetUInt16(SetUInt16, "UInt16", *const fmi3UInt16);
    fmi3GetInt32(GetInt32, "Int32", *mut fmi3Int32);
    fmi3SetInt32(SetInt32, "Int32", *const fmi3Int32);
    fmi3GetUInt32(GetUInt32, "UInt32", *mut fmi3UInt32);
    fmi3SetUInt32(SetUInt32, "UInt32", *const fmi3UInt32);
    fmi3GetUInt64(GetUInt64, "UInt64", *mut fmi3UInt64);
    fmi3SetUInt64(SetUInt64, "UInt64", *const fmi3UInt64);
    fmi3GetBoolean(GetBoolean, "Boolean", *mut fmi3Boolean);
    fmi3SetBoolean(SetBoolean, "Boolean", *const fmi3Boolean);
    fmi3GetString(GetString, "String", *mut fmi3String);
    fmi3SetString(SetString, "String", *const fmi3String);
    fmi3GetBinary(GetBinary, "Binary", *mut usize, *mut fmi3Binary);
    fmi3SetBinary(SetBinary, "Binary", *const usize, *const fmi3Binary);
}

/// Defines the functions of clocks, which touch none of their arrays: right for an empty list only.
macro_rules! without_clocks {
    ($($function:ident($call:ident, $($array:ty),+);)*) => {
        instance_calls! {
                    $(
                #[doc = concat!("`", stringify!($function), "`: there are no clocks.")]
                $function(
                    value_references: *const fmi3ValueReference,
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
    fmi3GetClock(GetClock, *mut fmi3Clock);
    fmi3SetClock(SetClock, *const fmi3Clock);
    fmi3GetIntervalDecimal(GetIntervalDecimal, *mut fmi3Float64, *mut fmi3IntervalQualifier);
    fmi3GetIntervalFraction(
        GetIntervalFraction, *mut fmi3UInt64, *mut fmi3UInt64, *mut fmi3IntervalQualifier
    );
    fmi3GetShiftDecimal(GetShiftDecimal, *mut fmi3Float64);
    fmi3GetShiftFraction(GetShiftFraction, *mut fmi3UInt64, *mut fmi3UInt64);
    fmi3SetIntervalDecimal(SetIntervalDecimal, *const fmi3Float64);
    fmi3SetIntervalFraction(SetIntervalFraction, *const fmi3UInt64, *const fmi3UInt64);
    fmi3SetShiftDecimal(SetShiftDecimal, *const fmi3Float64);
    fmi3SetShiftFraction(SetShiftFraction, *const fmi3UInt64, *const fmi3UInt64);
}

instance_calls! {
    /// `fmi3ActivateModelPartition`: always refused, since there are no clocks.
    fmi3ActivateModelPartition(
        _clock_reference: fmi3ValueReference,
        _activation_time: fmi3Float64,
    ) = |instance| instance.allow(Call::ActivateModelPartition);
}
