"""Mechanisms: files that were read, and the questions that can be asked of them."""

from __future__ import annotations

import json
import operator
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _biela
from .errors import (
    Diagnostic,
    FileError,
    MechanismWarning,
    MissingFileError,
    StoppedError,
    UsageError,
    diagnostics,
)
from .optional import needed
from .rates import differentiate
from .results import (
    ChangePoint,
    Drawing,
    End,
    Extreme,
    Mode,
    Modes,
    Range,
    Report,
    Result,
    StateSpace,
    Sweep,
    places,
)

Drive = Mapping[str, Any]
"""Motions by the names of drivers, and of freedoms that are to be driven, and sizes of forces by
their names, such as `motor.effort`: an expression in `t`, such as `"60*deg + 2*pi*t"`; positions; or
a tuple of positions, velocities and accelerations. Numbers stand for constant arrays."""
Parameters = Mapping[str, Union[float, str]]
"""Values by the parameters' names: numbers in SI units, or expressions such as `"120*mm"`."""

TURN = 2 * np.pi
CHUNKS = 100
"""Number of parts of a long sweep, after each of which the progress is shown."""


@dataclass(frozen=True)
class Parameter:
    """Parameter of a mechanism, in SI units."""

    name: str
    description: str
    value: float
    unit: str
    min: float | None
    max: float | None
    tolerance: float | None
    """Largest deviation of the real value."""
    derived: bool
    """Whether the value follows from other parameters and cannot be set."""


@dataclass(frozen=True)
class Driver:
    """Driver of a mechanism, in SI units."""

    name: str
    description: str
    unit: str
    start: float | None
    """Value at the start; `None` for a prescribed motion."""
    min: float | None
    max: float | None
    wrapped: bool
    """Whether values mean angles modulo one turn."""


@contextmanager
def _reading(path: str) -> Iterator[None]:
    """Tells a file that does not exist from others that cannot be read."""
    try:
        yield
    except FileError as error:
        if os.path.exists(path):
            raise
        raise MissingFileError(*error.args) from None


def load(path: str | os.PathLike) -> Mechanism:
    """Reads a mechanism file; the tables that it names are beside it.

    Raises `MechanismError` with all errors of the file; its warnings are warnings of Python. A file
    that does not exist raises `MissingFileError`, a `FileNotFoundError`.
    """
    name = os.fspath(path)
    with _reading(name):
        inner = _biela.Mechanism(name, None, name)
    return Mechanism(inner, name)


def loads(text: str, name: str = "mechanism.toml") -> Mechanism:
    """Reads the text of a mechanism file, called `name` in messages."""
    return Mechanism(_biela.Mechanism(name, text, None))


def check(source: str | os.PathLike, modes: bool = False) -> Report:
    """Checks a mechanism file, or a text of several lines, and reports all problems.

    >>> report = check('format = 1\\nname = "a"')
    >>> report.ok, [problem.code for problem in report.diagnostics]
    (False, ['no-bodies'])
    """
    name = os.fspath(source)
    if "\n" in name:
        found = _biela.Mechanism.check("mechanism.toml", name, None, modes)
    else:
        with _reading(name):
            found = _biela.Mechanism.check(name, None, name, modes)
    return Report(json.loads(found))


class Mechanism:
    """Mechanism of a file that has no errors. See `load` and `loads`."""

    def __init__(self, inner: _biela.Mechanism, path: str | None = None):
        self._inner = inner
        self._path = path
        if inner.warnings:
            warnings.warn(inner.warnings_text, MechanismWarning, stacklevel=3)

    @property
    def name(self) -> str:
        """Name, which is the FMU's model name too."""
        return self._inner.name

    @property
    def description(self) -> str:
        """Description in one line; may be empty."""
        return self._inner.description

    @property
    def text(self) -> str:
        """Text of the file."""
        return self._inner.text

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Warnings about the file."""
        return diagnostics(self._inner.warnings)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters by name, with the values of the file."""
        return {row[0]: Parameter(*row) for row in self._inner.parameters}

    @property
    def drivers(self) -> dict[str, Driver]:
        """Drivers by name."""
        return {row[0]: Driver(*row) for row in self._inner.drivers}

    @property
    def bodies(self) -> list[str]:
        """Names of the moving bodies."""
        return self._inner.bodies

    @property
    def variables(self) -> dict[str, str]:
        """Units of all variables of a run, by the names that they have in the FMU."""
        return dict(self._inner.columns)

    def __repr__(self) -> str:
        return f"<biela.Mechanism {self.name}: {', '.join(self.bodies)}>"

    def _repr_svg_(self) -> str:
        return str(self.draw())

    def __reduce__(self):
        return _reread, (self.text, self._path, self._inner.has_tables)

    def check(self, modes: bool = False) -> Report:
        """Assembles the mechanism at its start values and reports the pose.

        `modes` looks for the other assembly modes, too.
        """
        return Report(json.loads(self._inner.report(modes)))

    def run(
        self,
        t: ArrayLike | None = None,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
        variables: Sequence[str] | None = None,
        gradient: str | Sequence[str] = (),
        stop: str = "raise",
        inputs: Drive | None = None,
    ) -> Result:
        """Moves the mechanism through the times `t` [s] and returns its motion.

        Without `t` the times are those of the file, or there is no time if `drive` has arrays with
        rates or single poses are wanted. Each driver moves as `drive` says; the others follow the
        prescribed motions of the file, or stay at their start values; freedoms move by the forces.
        Samples without rates are differentiated. The mechanism starts in the assembly mode of its
        file and stays on the continuous motion. `inputs` are further entries of `drive`, such as
        `{"motor.effort": "2*sin(t)"}`.

        `variables` narrows the result to these variables, or to all of a body, marker, driver or
        measure. `gradient` names parameters by which the variables are differentiated, exactly, at
        each time, and starts of freedoms such as `swing.velocity`, which `parameters` may set too;
        `"all"` stands for all parameters that can be set.

        A motion that cannot go on raises `StoppedError`, or with `stop="keep"` returns a result
        with fewer rows and its `stopped`.

        >>> result = four_bar.run(t=[0, 0.5, 1], drive={"crank_angle": "60*deg + 2*pi*t"})
        >>> print(result["rocker.phi"].round(6))
        [2.143697 2.803644 2.143697]
        """
        if stop not in ("raise", "keep"):
            raise UsageError(f"stop is {stop!r}; expected 'raise' or 'keep'")
        drive = _joined(drive, inputs)
        motions = self._motions(t, drive)
        names, units, indices = self._chosen(variables)
        if gradient == "all":
            gradient = [name for name, parameter in self.parameters.items() if not parameter.derived]
        by = [gradient] if isinstance(gradient, str) else list(gradient)
        raw = self._inner.run(motions, _given(parameters), indices, by)
        rows = raw.rows
        result = Result(
            raw,
            np.asarray(motions[0])[:rows],
            not _timeless(t, drive),
            dict(zip(names, units)),
            raw.values().reshape(rows, len(names)),
            by,
            raw.gradient().reshape(rows, len(by), len(names)),
            self._moving(motions[1]),
        )
        for notice in raw.notices:
            warnings.warn(notice, MechanismWarning, stacklevel=2)
        if raw.stop is not None and stop == "raise":
            raise StoppedError(f"{self.name}: {raw.stop}", result)
        return result

    def sweep(
        self,
        parameters: Mapping[str, ArrayLike],
        t: ArrayLike | None = None,
        drive: Drive | None = None,
        variables: Sequence[str] | None = None,
        progress: bool = False,
        inputs: Drive | None = None,
    ) -> Sweep:
        """Runs a variant of the mechanism per entry of the arrays of `parameters`, on all cores.

        Arrays of any one shape, which single values fit. Each variant starts from the file's own
        pose and is followed on its continuous motion, as in `run`. A variant that does not
        assemble, or stops, is no error: `reason` tells why, and its values are not numbers from
        there on. `progress` shows a bar (tqdm).

        The values do not depend on the number of cores or on the order of the variants.

        >>> sweep = four_bar.sweep({"base": [0.40, 0.42, 0.80]}, drive={"crank_angle": [1.0, 1.1]},
        ...     variables=["rocker.phi"])
        >>> print(sweep["rocker.phi"].round(4))
        [[2.1391 2.1499]
         [2.1897 2.2019]
         [   nan    nan]]
        >>> sweep.ok
        array([ True,  True, False])
        """
        drive = _joined(drive, inputs)
        motions = self._motions(t, drive)
        names, units, indices = self._chosen(variables)
        if not names:
            raise UsageError("variables: no variable is named")
        fixed = {n: v for n, v in parameters.items() if isinstance(v, str)}
        arrays = {n: _numbers("parameters", v, n) for n, v in parameters.items() if n not in fixed}
        try:
            series = dict(zip(arrays, np.broadcast_arrays(*arrays.values())))
        except ValueError:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise UsageError(f"parameters: the shapes do not fit together: {shapes}") from None
        shape = next(iter(series.values())).shape if series else ()
        count = int(np.prod(shape, dtype=int))
        flat = {name: values.reshape(-1) for name, values in series.items()}
        values = np.empty((count, len(names), len(motions[0])))
        rows = np.empty(count, dtype=int)
        reasons: dict[int, str] = {}
        bar = _progress_bar(count) if progress else None
        size = max(1, -(-count // CHUNKS)) if bar is not None else max(1, count)
        for first in range(0, count, size):
            part = slice(first, min(first + size, count))
            raw = self._inner.sweep(
                motions,
                list(fixed.items()),
                [(name, array[part]) for name, array in flat.items()],
                part.stop - first,
                indices,
            )
            values[part] = raw.take_values().reshape(part.stop - first, *values.shape[1:])
            rows[part] = raw.rows
            reasons.update((first + index, reason) for index, reason in raw.reasons)
            if bar is not None:
                bar.update(part.stop - first)
        if bar is not None:
            bar.close()
        known = self.parameters
        return Sweep(
            np.asarray(motions[0]),
            not _timeless(t, drive),
            dict(zip(names, units)),
            series,
            {name: known[name].unit for name in series},
            shape,
            values,
            rows,
            reasons,
        )

    def range(
        self, driver: str, drive: Drive | None = None, parameters: Parameters | None = None
    ) -> Range:
        """Finds how far a driver can go both ways, with the others held.

        >>> str(four_bar.range("crank_angle").upper)
        'no limit'
        """
        found = self._inner.range(driver, self._start(drive), _given(parameters))
        lower, upper, crossings, values, transmission, rcond, poses, measures, extremes = found
        return Range(
            driver,
            End(*lower),
            End(*upper),
            tuple(ChangePoint(value, tuple(bodies), text) for value, bodies, text in crossings),
            values,
            transmission,
            rcond,
            dict(zip(self.bodies, np.moveaxis(poses.reshape(len(values), -1, 3), 0, 1))),
            {name: measures[place :: len(extremes)] for place, (name, _) in enumerate(extremes)},
            {
                name: tuple(Extreme(value, at) for value, at in both)
                for name, both in extremes
            },
        )

    def modes(self, drive: Drive | None = None, parameters: Parameters | None = None) -> Modes:
        """Finds the other poses in which the mechanism closes for the same values of its drivers.

        >>> len(four_bar.modes().others)
        1
        """
        others, complete = self._inner.modes(self._start(drive), _given(parameters))
        pose = lambda q: dict(zip(self.bodies, np.reshape(q, (-1, 3))))
        return Modes(tuple(Mode(pose(q), rcond) for q, rcond in others), complete)

    def linearize(
        self,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
        variables: Sequence[str] | None = None,
        balance: bool = False,
    ) -> StateSpace:
        """Linearizes the motion of freedoms at the start, exactly.

        With `balance` the mechanism goes to the stable equilibrium downhill from there first.
        Closed contacts and friction that sticks hold their coordinates in these equations: a
        warning tells each, and `held` has them.
        `variables` narrows the outputs, as for `run`.

        >>> space = pendulum.linearize(balance=True, variables=["rod.phi"])
        >>> print(abs(space.eigenvalues).round(6))
        [5.424942 5.424942]
        """
        names, _, indices = self._chosen(variables)
        drivers, q, states, inputs, matrices, held = self._inner.linearize(
            self._start(drive), _given(parameters), indices, balance
        )
        for _, _, text in held:
            notice = f"{text}: what is held does not move in these equations"
            warnings.warn(notice, MechanismWarning, stacklevel=2)
        shapes = [(len(rows), len(columns)) for rows in (states, names) for columns in (states, inputs)]
        return StateSpace(
            tuple(states),
            tuple(inputs),
            tuple(names),
            *(np.reshape(matrix, shape) for matrix, shape in zip(matrices, shapes)),
            dict(zip(self.drivers, drivers)),
            dict(zip(self.bodies, np.reshape(q, (-1, 3)))),
            {name: force for name, force, _ in held},
        )

    def draw(
        self,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
        traces: bool = True,
        width: int | None = None,
        transparent: bool = False,
        poses: int = 0,
        driver: str | None = None,
        dimensions: bool = False,
        instant_centres: bool = False,
        forces: bool = False,
    ) -> Drawing:
        """Draws the mechanism at the start values, as SVG that notebooks show.

        `poses` further poses stand as faint outlines along the motion that the traces cover, or
        along the range of `driver`. `dimensions` adds letters of joints and lengths of bodies,
        `instant_centres` the instant centre of each body and ground, `forces` arrows for what joints
        and drivers exert, and for springs, dampers and loads.
        """
        parameters = _given(parameters)
        start = self._start(drive)
        options = (traces, _count("poses", poses), driver, dimensions, instant_centres, forces)
        return Drawing(self._inner.draw(start, parameters, width, transparent, options))

    def changed(self, parameters: Parameters | None = None, drive: Drive | None = None) -> Mechanism:
        """Returns the mechanism with other parameters and start values of drivers.

        Its file differs in these values and in the estimates, which are those of the pose there;
        comments stay.

        >>> longer = four_bar.changed({"base": 0.42}, drive={"crank_angle": 1.0})
        >>> print(longer.check().poses["rocker"].round(4))
        [0.42   0.     2.1897]
        """
        given = _given(parameters)
        text = self._inner.edited(self._start(drive), given, None)
        return _reread(text, self._path, self._inner.has_tables)

    def posed(self, mode: Mode) -> Mechanism:
        """Returns the mechanism in another of its assembly modes: the file with other estimates.

        >>> (other,) = four_bar.modes().others
        >>> mirrored = four_bar.posed(other)
        >>> bool(np.allclose(mirrored.check().poses["rocker"], other.poses["rocker"]))
        True
        """
        estimates = np.concatenate([mode.poses[body] for body in self.bodies])
        text = self._inner.edited(self._start(None), [], estimates.tolist())
        return _reread(text, self._path, self._inner.has_tables)

    def write(self, path: str | os.PathLike) -> Path:
        """Writes the mechanism file and returns its path."""
        path = Path(path)
        path.write_text(self.text, encoding="utf-8")
        return path

    def export(
        self,
        path: str | os.PathLike | None = None,
        platforms: Iterable[str] = (),
        runtime: str | os.PathLike | None = None,
        fmi: int = 2,
        terminals: bool = False,
    ) -> Path:
        """Writes the FMU and returns its path, by default the mechanism's name with `.fmu`.

        `fmi` is the version of the standard: 2 or 3; `terminals` adds terminals and an icon to an FMU
        of FMI 2.0.

        `platforms` narrows the FMU to some of those of `biela platforms`; `runtime` is a folder of
        runtime libraries that replace those of this package.
        """
        path = Path(path) if path is not None else Path(f"{self.name}.fmu")
        folder = os.fspath(runtime) if runtime is not None else None
        names = [platforms] if isinstance(platforms, str) else list(platforms)
        path.write_bytes(bytes(self._inner.fmu(str(fmi), terminals, folder, names)))
        return path

    def _chosen(self, wanted: Sequence[str] | None) -> tuple[list[str], list[str], list[int]]:
        """Returns names, units and indices of variables, or of all variables of owners."""
        columns = self._inner.columns
        if wanted is None:
            indices = list(range(len(columns)))
        else:
            indices = places([name for name, _ in columns], wanted)
        return [columns[i][0] for i in indices], [columns[i][1] for i in indices], indices

    def _start(self, drive: Drive | None) -> tuple[list[float], list]:
        """Returns the motions at the file's start time, where drivers have single values."""
        start = self._inner.simulation[0]
        constant = {}
        for name, value in (drive or {}).items():
            if not isinstance(value, str):
                number = _numbers("drive", value, name)
                if number.ndim:
                    raise UsageError(f"drive: expected one number as `{name}`; found {value!r}")
                value = (number, 0.0, 0.0)
            constant[name] = value
        return self._motions([start], constant)

    def _motions(self, t: ArrayLike | None, drive: Drive | None) -> tuple[list[float], list]:
        """Returns times and motions of drivers as the compiled module takes them."""
        drive = dict(drive or {})
        arrays = {name: value for name, value in drive.items() if not isinstance(value, str)}
        orders = {name: _orders(name, value) for name, value in arrays.items()}
        lengths = {len(order) for each in orders.values() for order in each if order.ndim}
        if len(lengths) > 1:
            counts = ", ".join(map(str, sorted(lengths)))
            raise UsageError(f"drive: the arrays have different lengths: {counts}")
        timeless = _timeless(t, drive)
        if t is not None:
            times = np.atleast_1d(_numbers("t", t))
            if times.ndim != 1:
                raise UsageError(f"t has {times.ndim} dimensions; expected an array of times")
        elif timeless:
            times = np.full(lengths.pop() if lengths else 1, self._inner.simulation[0])
        else:
            start, stop, step = self._inner.simulation
            # A last step shorter than this part of the others is rounding.
            steps = max(0, int(np.ceil((stop - start) / step - 1e-9)))
            times = np.minimum(_as_written(start, step, steps), stop)
        drivers = self.drivers
        motions: list = []
        for name, value in drive.items():
            if isinstance(value, str):
                motions.append((name, value))
                continue
            given = orders[name]
            full = [np.broadcast_to(order, times.shape) if not order.ndim else order for order in given]
            if name in drivers and drivers[name].wrapped:
                # The first value is on the turn nearest the start value, as in the FMU.
                start = drivers[name].start
                full[0] = np.unwrap(np.append(start, full[0]), period=TURN)[1:]
            full += self._missing_rates(times, full, constant=not given[0].ndim, timeless=timeless)
            motions.append((name, [np.ascontiguousarray(order) for order in full]))
        return times, motions

    def _moving(self, motions: list) -> tuple[str, str, NDArray] | None:
        """Returns name, unit and values of the driver whose values change, if it is one."""
        changing = [
            (name, values[0])
            for name, values in motions
            if not isinstance(values, str) and np.ptp(values[0]) > 0
        ]
        if len(changing) != 1:
            return None
        name, values = changing[0]
        return name, self.variables.get(f"{name}.position", ""), values

    def _missing_rates(
        self, times: NDArray, given: list[NDArray], constant: bool, timeless: bool
    ) -> list[NDArray]:
        """Returns the rates that are not given."""
        missing = 3 - len(given)
        # Without time nothing moves: velocities are zero unless given.
        if not missing or constant or timeless or len(given[-1]) != len(times):
            return [np.zeros(len(times))] * missing
        if np.any(np.diff(times) <= 0):
            raise UsageError("drive: samples at equal times cannot be differentiated; give the rates")
        velocity, acceleration = differentiate(times, given[0])
        if missing == 2:
            return [velocity, acceleration]
        return [differentiate(times, given[1])[0]]


def _joined(drive: Drive | None, inputs: Drive | None) -> Drive:
    """Returns the entries of both."""
    twice = set(drive or ()) & set(inputs or ())
    if twice:
        raise UsageError(f"inputs: `{min(twice)}` is in `drive` too")
    return {**(drive or {}), **(inputs or {})}


def _timeless(t: ArrayLike | None, drive: Drive | None) -> bool:
    """Whether a run has poses without times: values of drivers, and no times for them."""
    return t is None and any(not isinstance(value, str) for value in (drive or {}).values())


def _given(parameters: Parameters | None) -> list[tuple[str, float | str]]:
    """Returns the parameters' names and values."""
    given: list[tuple[str, float | str]] = []
    for name, value in (parameters or {}).items():
        try:
            given.append((name, value if isinstance(value, str) else float(value)))
        except (TypeError, ValueError):
            raise UsageError(
                f"parameters: `{name}` is no number; expected one or an expression such as "
                "'120*mm'; `sweep` takes arrays"
            ) from None
    return given


def _as_written(start: float, step: float, steps: int) -> NDArray:
    """Returns start + i·step as decimal numbers: 0.7 for seven steps of 0.1, not 0.7000000000000001."""
    times = start + step * np.arange(steps + 1)
    decimals = max(-int(Decimal(repr(number)).as_tuple().exponent) for number in (start, step))
    if decimals > 0 and np.max(np.abs(times)) * 10.0**decimals < 2.0**53:
        times = np.round(times, decimals)
    return times


def _numbers(argument: str, value: Any, name: str | None = None) -> NDArray:
    """Returns the numbers of an argument, or of its part `name`. Text of digits is no number."""
    try:
        return (np.asarray(value) * 1.0).astype(float)
    except (TypeError, ValueError):
        part = f" as `{name}`" if name else ""
        raise UsageError(f"{argument}: expected numbers{part}; found {value!r}") from None


def _count(name: str, value: int, least: int = 0) -> int:
    """Returns a count, a whole number that is not too small."""
    try:
        count = operator.index(value)
    except TypeError:
        count = least - 1
    if count < least:
        raise UsageError(f"{name}: expected a whole number, at least {least}; found {value!r}")
    return count


def _orders(name: str, value: Any) -> list[NDArray]:
    """Returns position and the given rates of a driver as arrays."""
    parts = value if isinstance(value, tuple) else (value,)
    if not 1 <= len(parts) <= 3:
        raise UsageError(
            f"drive: `{name}` is a tuple of {len(parts)}; "
            "expected (position, velocity, acceleration)"
        )
    orders = [_numbers("drive", part, name) for part in parts]
    if any(order.ndim > 1 for order in orders):
        raise UsageError(f"drive: `{name}` has several dimensions; expected one value per time")
    return orders


def _progress_bar(count: int):
    """Returns a bar of tqdm."""
    return needed("tqdm.auto", "progress").tqdm(total=count, unit="variant")


def _reread(text: str, path: str | None, has_tables: bool) -> Mechanism:
    """Returns the mechanism of another text of its file, or in another process; tables are beside
    the file. Warnings were shown when the file was read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MechanismWarning)
        inner = _biela.Mechanism(path or "mechanism.toml", text, path if has_tables else None)
        return Mechanism(inner, path)
