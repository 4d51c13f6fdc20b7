"""Arguments of calls, as the compiled module takes them."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import UsageError
from .rates import differentiate

Drive = Mapping[str, Any]
"""Motions by the names of drivers, and of freedoms that are to be driven, and sizes of forces by
their names, such as `motor.effort`: an expression in `t`, such as `"60*deg + 2*pi*t"`; positions; or
a tuple of positions, velocities and accelerations. Numbers stand for constant arrays."""
Parameters = Mapping[str, Union[float, str]]
"""Values by the parameters' names: numbers in SI units, or expressions such as `"120*mm"`; likewise
the starts of freedoms, `swing.position` and `swing.velocity`."""

Bounds = Sequence[Union[float, str, None]]
"""Two values of a driver, numbers [m or rad] or expressions such as `"30*deg"`; `None` for none."""

TURN = 2 * np.pi
MOST = 2**31 - 1
"""Largest count that the compiled module takes on all systems."""


def mapping(argument: str, value: Any) -> dict[str, Any]:
    """Returns an argument that maps names to values; nothing stands for an empty one."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise UsageError(f"{argument}: expected a mapping such as {{name: value}}; found {value!r}")
    wrong = [name for name in value if not isinstance(name, str)]
    if wrong:
        raise UsageError(f"{argument}: expected names as text; found {wrong[0]!r}")
    return dict(value)


def text_argument(argument: str, value: Any) -> str:
    """Returns an argument that is text."""
    if not isinstance(value, str):
        raise UsageError(f"{argument}: expected text; found {value!r}")
    return value


def path_argument(argument: str, value: Any) -> str:
    """Returns an argument that is a path."""
    try:
        return text_argument(argument, os.fspath(value))
    except TypeError:
        raise UsageError(f"{argument}: expected a path; found {value!r}") from None


def names_of(argument: str, value: Any) -> list[str]:
    """Returns names; a single one may stand for itself."""
    names = [value] if isinstance(value, str) else value
    try:
        names = list(names)
    except TypeError:
        names = [value]
    wrong = [name for name in names if not isinstance(name, str)]
    if wrong:
        raise UsageError(f"{argument}: expected names as text; found {wrong[0]!r}")
    return names


def joined(drive: Drive | None, inputs: Drive | None) -> Drive:
    """Returns the entries of both."""
    drive, inputs = mapping("drive", drive), mapping("inputs", inputs)
    twice = set(drive) & set(inputs)
    if twice:
        raise UsageError(f"inputs: `{min(twice)}` is in `drive` too")
    return {**drive, **inputs}


def is_timeless(t: ArrayLike | None, drive: Drive | None) -> bool:
    """Whether a run has poses without times: values of drivers, and no times for them."""
    return t is None and any(not isinstance(value, str) for value in (drive or {}).values())


def given_values(parameters: Parameters | None) -> list[tuple[str, float | str]]:
    """Returns the parameters' names and values."""
    given: list[tuple[str, float | str]] = []
    for name, value in mapping("parameters", parameters).items():
        try:
            given.append((name, value if isinstance(value, str) else float(value)))
        except (TypeError, ValueError, OverflowError):
            raise UsageError(
                f"parameters: `{name}` is no number; expected one or an expression such as "
                "'120*mm'; `sweep` takes arrays"
            ) from None
    return given


def as_written(start: float, step: float, steps: int) -> NDArray:
    """Returns start + i·step as decimal numbers: 0.7 for seven steps of 0.1, not 0.7000000000000001."""
    times = start + step * np.arange(steps + 1)
    decimals = max(-int(Decimal(repr(number)).as_tuple().exponent) for number in (start, step))
    if decimals > 0 and np.max(np.abs(times)) * 10.0**decimals < 2.0**53:
        times = np.round(times, decimals)
    return times


def numbers(argument: str, value: Any, name: str | None = None) -> NDArray:
    """Returns the numbers of an argument, or of its part `name`. Text of digits is no number."""
    try:
        found = np.asarray(value) * 1.0
        if np.iscomplexobj(found):
            raise TypeError
        return found.astype(float)
    except (TypeError, ValueError, OverflowError):
        part = f" as `{name}`" if name else ""
        raise UsageError(f"{argument}: expected numbers{part}; found {value!r}") from None


def number(argument: str, value: Any) -> float:
    """Returns an argument that is one number."""
    found = numbers(argument, value)
    if found.ndim:
        raise UsageError(f"{argument}: expected one number; found {value!r}")
    return float(found)


def bounds_of(between: Any) -> list[float | str | None]:
    """Returns the two values of a driver between which it is followed."""
    try:
        bounds = list(between)
        if len(bounds) != 2:
            raise TypeError
        bounds = [b if b is None or isinstance(b, str) else number("between", b) for b in bounds]
        if any(isinstance(bound, float) and not np.isfinite(bound) for bound in bounds):
            raise TypeError
    except TypeError:
        raise UsageError(
            f"between: expected two finite numbers or expressions, or `None` for none; found {between!r}"
        ) from None
    return bounds


def count_of(name: str, value: int, least: int = 0) -> int:
    """Returns a count, a whole number that is not too small."""
    try:
        count = operator.index(value)
    except TypeError:
        count = least - 1
    if count < least:
        raise UsageError(f"{name}: expected a whole number, at least {least}; found {value!r}")
    if count > MOST:
        raise UsageError(f"{name}: expected a whole number, at most {MOST}")
    return count


def orders_of(name: str, value: Any) -> list[NDArray]:
    """Returns position and the given rates of a driver as arrays."""
    parts = value if isinstance(value, tuple) else (value,)
    if not 1 <= len(parts) <= 3:
        raise UsageError(
            f"drive: `{name}` is a tuple of {len(parts)}; "
            "expected (position, velocity, acceleration)"
        )
    orders = [numbers("drive", part, name) for part in parts]
    if any(order.ndim > 1 for order in orders):
        raise UsageError(f"drive: `{name}` has several dimensions; expected one value per time")
    return orders


def motions_of(
    t: ArrayLike | None,
    drive: Mapping[str, Any],
    simulation: tuple[float, float, float],
    wrapped: Mapping[str, float],
) -> tuple[NDArray, list]:
    """Returns times and motions of drivers for the file's start, stop and step [s]; `wrapped` has the
    start values of the drivers whose values mean angles modulo one turn."""
    arrays = {name: value for name, value in drive.items() if not isinstance(value, str)}
    orders = {name: orders_of(name, value) for name, value in arrays.items()}
    lengths = {len(order) for each in orders.values() for order in each if order.ndim}
    if len(lengths) > 1:
        counts = ", ".join(map(str, sorted(lengths)))
        raise UsageError(f"drive: the arrays have different lengths: {counts}")
    timeless = is_timeless(t, drive)
    if t is not None:
        times = np.atleast_1d(numbers("t", t))
        if times.ndim != 1:
            raise UsageError(f"t has {times.ndim} dimensions; expected an array of times")
    elif timeless:
        times = np.full(lengths.pop() if lengths else 1, simulation[0])
    else:
        start, stop, step = simulation
        # A last step shorter than this part of the others is rounding.
        steps = max(0, int(np.ceil((stop - start) / step - 1e-9)))
        times = np.minimum(as_written(start, step, steps), stop)
    motions: list = []
    for name, value in drive.items():
        if isinstance(value, str):
            motions.append((name, value))
            continue
        given = orders[name]
        full = [np.broadcast_to(order, times.shape) if not order.ndim else order for order in given]
        if name in wrapped:
            # The first value is on the turn nearest the start value, as in the FMU.
            full[0] = np.unwrap(np.append(wrapped[name], full[0]), period=TURN)[1:]
        full += _missing_rates(times, full, constant=not given[0].ndim, timeless=timeless)
        motions.append((name, [np.ascontiguousarray(order) for order in full]))
    return times, motions


def courses_of(
    drive: Mapping[str, Any],
) -> tuple[dict[str, Any], dict[str, list[NDArray]], tuple[int, ...]]:
    """Takes the arrays that differ between variants, whose last axis is over time, out of motions.

    Returns the motions of a first variant, the arrays of the others by name, and the shape of the
    variants; arrays of any shapes that fit together.
    """
    swept = {}
    for name, value in drive.items():
        parts = value if isinstance(value, tuple) else (value,)
        if isinstance(value, str) or not any(np.ndim(part) > 1 for part in parts):
            continue
        swept[name] = [numbers("drive", part, name) for part in parts]
    if not swept:
        return dict(drive), {}, ()
    try:
        shape = np.broadcast_shapes(*(part.shape[:-1] for parts in swept.values() for part in parts))
        rows = {part.shape[-1] for parts in swept.values() for part in parts if part.ndim} - {1}
        count = max(rows, default=1)
        full = {
            name: [np.broadcast_to(part, (*shape, count)) for part in parts]
            for name, parts in swept.items()
        }
    except ValueError:
        shapes = ", ".join(f"{name} {part.shape}" for name, parts in swept.items() for part in parts)
        raise UsageError(f"drive: the shapes do not fit together: {shapes}") from None
    zeros = (0,) * len(shape)
    # Without a variant there are times all the same. Single values stand for constant arrays.
    row = lambda part: part[zeros] if part.size else np.zeros(count)
    first = lambda part: row(part)[0] if count == 1 else row(part)
    return {**drive, **{name: tuple(map(first, parts)) for name, parts in full.items()}}, full, shape


def orders_of_courses(
    name: str, times: NDArray, timeless: bool, parts: list[NDArray], wrapped: float | None
) -> list[NDArray]:
    """Returns positions, velocities and accelerations of a driver in all variants, as `motions_of` does
    for one."""
    rows = parts[0].shape[-1]
    if rows not in (1, len(times)):
        raise UsageError(f"drive: `{name}` has {rows} values for {len(times)} times")
    if rows != len(times):
        parts = [np.broadcast_to(part, (*part.shape[:-1], len(times))) for part in parts]
        return [*parts, *[np.zeros(parts[0].shape)] * (3 - len(parts))]
    if wrapped is not None:
        start = np.full((*parts[0].shape[:-1], 1), wrapped)
        parts = [np.unwrap(np.concatenate([start, parts[0]], axis=-1), period=TURN)[..., 1:], *parts[1:]]
    return [*parts, *_missing_rates(times, parts, constant=False, timeless=timeless)]


def start_of(drive: Drive | None, inputs: Iterable[str] = ()) -> dict[str, Any]:
    """Returns motions that have single values: those at the start. Sizes of the `inputs` of forces
    become expressions, which all questions know."""
    constant = {}
    for name, value in mapping("drive", drive).items():
        if not isinstance(value, str):
            number = numbers("drive", value, name)
            if number.ndim:
                raise UsageError(f"drive: expected one number as `{name}`; found {value!r}")
            value = repr(float(number)) if name in inputs else (number, 0.0, 0.0)
        constant[name] = value
    return constant


def _missing_rates(
    times: NDArray, given: list[NDArray], constant: bool, timeless: bool
) -> list[NDArray]:
    """Returns the rates that are not given."""
    missing = 3 - len(given)
    # Without time nothing moves: velocities are zero unless given. Samples that do not fit the times are
    # refused later, and those that have no rates.
    zeros = np.zeros((*given[-1].shape[:-1], len(times)))
    if not missing or constant or timeless or given[-1].shape[-1] != len(times):
        return [zeros] * missing
    if not (np.isfinite(times).all() and np.isfinite(given).all()) or np.any(np.diff(times) < 0):
        return [zeros] * missing
    if np.any(np.diff(times) == 0):
        raise UsageError("drive: samples at equal times cannot be differentiated; give the rates")
    velocity, acceleration = differentiate(times, given[0])
    if missing == 2:
        return [velocity, acceleration]
    return [differentiate(times, given[1])[0]]
