"""Results as tables of pandas and as datasets of xarray."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from .optional import needed

TO_PANDAS, TO_XARRAY = "to_pandas", "to_xarray"


def row_name(timed: bool) -> str:
    """Returns the name of the axis of rows, which are poses where there is no time."""
    return "time" if timed else "pose"


def rows_index(t: NDArray, timed: bool):
    """Returns the rows as an index of pandas: times, or numbers of poses."""
    pandas = needed("pandas", TO_PANDAS)
    name = row_name(timed)
    return pandas.Index(t, name=name) if timed else pandas.RangeIndex(len(t), name=name)


def variants_index(parameters: Mapping[str, NDArray], rows):
    """Returns the index of all rows of all variants: a level per parameter, then the rows."""
    pandas = needed("pandas", TO_PANDAS)
    if not parameters:
        return rows
    levels, codes = [], []
    for values in parameters.values():
        # The values of one variant stand in all of its rows: only the codes are repeated.
        code, level = pandas.factorize(values.reshape(-1), sort=True)
        levels.append(level)
        codes.append(np.repeat(code, len(rows)))
    variants = next(iter(parameters.values())).size
    code, level = pandas.factorize(rows)
    levels.append(level)
    codes.append(np.tile(code, variants))
    return pandas.MultiIndex(levels=levels, codes=codes, names=[*parameters, rows.name])


def frame(values: NDArray, index, names: Iterable[str]):
    """Returns values as a table of pandas: rows by columns of these names."""
    return needed("pandas", TO_PANDAS).DataFrame(values, index=index, columns=list(names))


def dataset(
    t: NDArray,
    timed: bool,
    variables: Mapping[str, NDArray],
    units: Mapping[str, str],
    dimensions: tuple[str, ...] = (),
    coordinates: Mapping[str, tuple] | None = None,
):
    """Returns variables as a dataset, with their units. Each has the `dimensions`, then the rows."""
    xarray = needed("xarray", TO_XARRAY)
    name = row_name(timed)
    times = {name: (name, t, {"units": "s"})} if timed else {}
    return xarray.Dataset(
        {
            variable: ((*dimensions, name), values, {"units": units[variable]})
            for variable, values in variables.items()
        },
        {**(coordinates or {}), **times},
    )


def sweep_dimensions(parameters: Mapping[str, NDArray], shape: tuple[int, ...]) -> tuple[str, ...]:
    """Returns a name for each axis of a sweep: that of the one parameter that varies along it, and
    along no other; otherwise `variant`, or `variant_0` and so on where there are several axes.

    >>> base, crank = np.meshgrid([0.40, 0.42, 0.44], [0.1, 0.2], indexing="ij")
    >>> sweep_dimensions({"base": base, "crank": crank}, (3, 2))
    ('base', 'crank')
    >>> sweep_dimensions({"base": base.reshape(-1), "crank": crank.reshape(-1)}, (6,))
    ('variant',)
    """
    names = [name for name, values in parameters.items() if _varies(values)] or list(parameters)
    owners: list[list[str]] = [[] for _ in shape]
    for name in names:
        axes = [axis for axis in range(len(shape)) if _varies_along(parameters[name], axis)]
        if len(axes) == 1:
            owners[axes[0]].append(name)
    numbered = len(shape) > 1
    return tuple(
        found[0] if len(found) == 1 else f"variant_{axis}" if numbered else "variant"
        for axis, found in enumerate(owners)
    )


def sweep_coordinates(
    parameters: Mapping[str, NDArray], units: Mapping[str, str], dimensions: tuple[str, ...]
) -> dict[str, tuple]:
    """Returns the swept parameters as coordinates of a dataset: along their own axis, along all axes,
    or a single value."""
    found: dict[str, tuple] = {}
    for name, values in parameters.items():
        attributes = {"units": units[name]}
        if name in dimensions:
            line = _line(values, dimensions.index(name))
            found[name] = (name, values[line].reshape(-1), attributes)
        elif values.ndim and not _varies(values):
            found[name] = ((), values.flat[0], attributes)
        else:
            found[name] = (dimensions, values, attributes)
    return found


def _varies(values: NDArray) -> bool:
    """Whether an array has different values."""
    return bool(values.size) and bool((values != values.flat[0]).any())


def _varies_along(values: NDArray, axis: int) -> bool:
    """Whether an array has the same values along all axes but one."""
    return bool((values == values[_line(values, axis)]).all())


def _line(values: NDArray, axis: int) -> tuple[slice, ...]:
    """Returns the index of the first line of an array along an axis."""
    return tuple(slice(None if other == axis else 1) for other in range(values.ndim))
