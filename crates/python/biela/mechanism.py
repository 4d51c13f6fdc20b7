"""Mechanisms: files that were read, and the questions that can be asked of them."""

from __future__ import annotations

import html
import json
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _biela
from .arguments import (
    Bounds,
    Drive,
    Parameters,
    bounds_of,
    count_of,
    courses_of,
    given_values,
    is_timeless,
    joined,
    mapping,
    motions_of,
    names_of,
    number,
    numbers,
    orders_of_courses,
    path_argument,
    start_of,
    text_argument,
)
from .errors import (
    AssemblyError,
    Diagnostic,
    FileError,
    MechanismWarning,
    MissingFileError,
    StoppedError,
    UsageError,
    diagnostics,
    warn,
)
from .optional import needed
from .parts import (
    Driver,
    Force,
    Freedom,
    Input,
    Measure,
    Parameter,
    SweepEvents,
    events_of,
)
from .results import (
    ChangePoint,
    Drawing,
    End,
    Equilibrium,
    Extreme,
    JointForce,
    Mode,
    Modes,
    Range,
    Report,
    Result,
    StateSpace,
    Sweep,
    places,
)
from .texts import Source, table, text_of, written

CHUNKS = 100
"""Number of parts of a long sweep, after each of which the progress is shown."""


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
    name = path_argument("path", path)
    with _reading(name):
        inner = _biela.Mechanism(name, None, name)
    return Mechanism(inner, name)


def loads(source: Source, name: str = "mechanism.toml") -> Mechanism:
    """Reads the text of a mechanism file, called `name` in messages, or the mapping that such a text
    stands for.

    >>> data = {"format": 1, "name": "lever", "ground": {"markers": {"O": [0, 0]}},
    ...     "bodies": {"arm": {"markers": {"A": [0, 0], "P": [0.3, 0]}}},
    ...     "joints": {"O": {"type": "revolute", "markers": ["ground.O", "arm.A"]}},
    ...     "drivers": {"angle": {"coordinate": "angle", "markers": ["ground.O", "arm.A"], "start": 0.5}}}
    >>> print(loads(data).run(variables=["arm.phi"], drive={"angle": [0.5]})["arm.phi"])
    [0.5]
    """
    return Mechanism(_biela.Mechanism(text_argument("name", name), text_of(source), None))


@overload
def library() -> tuple[str, ...]: ...
@overload
def library(name: str) -> Mechanism: ...
def library(name=None):
    """Returns a mechanism that comes with biela; without a name the names of all.

    >>> library("four_bar").bodies
    ['crank', 'coupler', 'rocker']
    """
    if name is None:
        return tuple(_biela.shipped())
    return _reread(_biela.shipped_text(name), None, True, name)


def check(source: str | os.PathLike | Mapping, modes: bool = False) -> Report:
    """Checks a mechanism file, a text of several lines, or a mapping, and reports all problems.

    >>> report = check('format = 1\\nname = "a"')
    >>> report.ok, [problem.code for problem in report.diagnostics]
    (False, ['no-bodies'])
    """
    name = text_of(source) if isinstance(source, Mapping) else path_argument("source", source)
    if "\n" in name:
        found = _biela.Mechanism.check("mechanism.toml", name, None, modes)
    else:
        with _reading(name):
            found = _biela.Mechanism.check(name, None, name, modes)
    return Report(json.loads(found))


class Mechanism:
    """Mechanism of a file that has no errors. See `load` and `loads`."""

    def __init__(
        self, inner: _biela.Mechanism, path: str | None = None, shipped: str | None = None
    ):
        self._inner = inner
        self._path = path
        self._shipped = shipped
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
        return {row[0]: Driver(*row[:-1]) for row in self._inner.drivers if row[-1] is None}

    @property
    def freedoms(self) -> dict[str, Freedom]:
        """Freedoms by name."""
        rows = [row for row in self._inner.drivers if row[-1] is not None]
        return {row[0]: Freedom(*row[:4], row[-1]) for row in rows}

    @property
    def inputs(self) -> dict[str, Input]:
        """Inputs of the file, then forces whose sizes a run may give, by the names that they have there."""
        return {row[0]: Input(*row) for row in self._inner.inputs}

    @property
    def measures(self) -> dict[str, Measure]:
        """Measures by name, with their values at the start.

        >>> print(round(four_bar.measures["transmission"].value, 6))
        1.420228
        """
        rows = self._inner.measures
        values = self._at_start([row[3] for row in rows])
        return {row[0]: Measure(*row, values.get(row[3])) for row in rows}

    @property
    def forces(self) -> dict[str, Force]:
        """Forces that follow from the motion, by the names of their variables, with their sizes at the
        start."""
        rows = self._inner.forces
        values = self._at_start([row[0] for row in rows])
        return {row[0]: Force(*row[:3], values.get(row[0])) for row in rows}

    def _at_start(self, variables: Sequence[str]) -> dict[str, float]:
        """Returns values at the start: none where the mechanism does not get there."""
        known = [name for name in variables if name in self.variables]
        names, _, indices = self._chosen(known)
        try:
            raw = self._inner.run(self._start(None), [], indices, [], False)
        except AssemblyError:
            return {}
        return dict(zip(names, raw.take_values().tolist()))

    @property
    def _coordinates(self) -> list[str]:
        """Names of drivers and freedoms, in the order of the file."""
        return [row[0] for row in self._inner.drivers]

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

    def _repr_html_(self) -> str:
        values = [(p.name, f"{p.value:g}", p.unit, p.description) for p in self.parameters.values()]
        title = f"<b>{html.escape(self.name)}</b> {html.escape(self.description)}"
        return f"{title}<br>{self.draw()}{table(('parameter', 'value', 'unit', ''), values)}"

    def __reduce__(self):
        return _reread, (self.text, *self._origin())

    def _origin(self) -> tuple[str | None, bool, str | None]:
        """Returns where the tables of the text are, for `_reread`."""
        return self._path, self._inner.has_tables, self._shipped

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
        Samples without rates are differentiated. Free motion begins at the start of the file, whatever
        the first time. The mechanism starts in the assembly mode of its
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
        if not isinstance(stop, str) or stop not in ("raise", "keep"):
            raise UsageError(f"stop is {stop!r}; expected 'raise' or 'keep'")
        drive = joined(drive, inputs)
        motions = self._motions(t, drive)
        names, units, indices = self._chosen(variables)
        if isinstance(gradient, str) and gradient == "all":
            gradient = [name for name, parameter in self.parameters.items() if not parameter.derived]
        by = names_of("gradient", gradient)
        arguments = motions, given_values(parameters), indices, by
        raw = self._inner.run(*arguments, False)
        rows = raw.rows
        result = Result(
            raw.stop,
            (self, *arguments),
            np.asarray(motions[0])[:rows],
            not is_timeless(t, drive),
            dict(zip(names, units)),
            raw.take_values().reshape(rows, len(names)),
            by,
            raw.take_gradient().reshape(rows, len(by), len(names)),
            self._moving(motions[1]),
            tuple(event for _, event in events_of(raw.events(), self._inner.force_names)),
        )
        warn(raw.notices)
        if raw.stop is not None and stop == "raise":
            raise StoppedError(f"{self.name}: {raw.stop}", result)
        return result

    def sweep(
        self,
        parameters: Mapping[str, ArrayLike] | None = None,
        t: ArrayLike | None = None,
        drive: Drive | None = None,
        variables: Sequence[str] | None = None,
        progress: bool = False,
        inputs: Drive | None = None,
        outer: bool = False,
    ) -> Sweep:
        """Runs a variant of the mechanism per entry of the arrays of `parameters`, on all cores.

        Arrays of any one shape, which single values fit; with `outer` each value of one with each of
        all others, an axis per array in the order of `parameters`, none for a single value. An array in
        `drive` or `inputs` with several axes has a motion per variant: its last axis is over time, or
        of length 1 for constant values, its others are those of the variants, and with `outer` follow
        those of `parameters`. Each variant starts from the file's own
        pose and is followed on its continuous motion, as in `run`. A variant that does not
        assemble, or stops, is no error: `reason` tells why, and its values are not numbers from
        there on. `parameters` may have starts of freedoms too, such as `swing.velocity`. `progress` shows
        a bar (tqdm).

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
        drive, courses, moved = courses_of(joined(drive, inputs))
        motions = self._motions(t, drive)
        timeless = is_timeless(t, drive)
        courses = {
            name: orders_of_courses(name, motions[0], timeless, parts, self._wrapped.get(name))
            for name, parts in courses.items()
        }
        names, units, indices = self._chosen(variables)
        if not names:
            raise UsageError("variables: no variable is named")
        parameters = mapping("parameters", parameters)
        fixed = {n: v for n, v in parameters.items() if isinstance(v, str)}
        arrays = {n: numbers("parameters", v, n) for n, v in parameters.items() if n not in fixed}
        if outer:
            arrays = dict(zip(arrays, _outer(arrays.values(), len(moved))))
        try:
            shape = np.broadcast_shapes(moved, *(array.shape for array in arrays.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            shapes += f", drive {moved}" if moved else ""
            raise UsageError(f"parameters: the shapes do not fit together: {shapes}") from None
        series = {name: np.broadcast_to(array, shape) for name, array in arrays.items()}
        count = int(np.prod(shape, dtype=int))
        flat = {name: values.reshape(-1) for name, values in series.items()}
        full = (*shape, len(motions[0]))
        courses = {
            name: [np.broadcast_to(order, full).reshape(count, -1) for order in orders]
            for name, orders in courses.items()
        }
        parts = []
        rows = np.empty(count, dtype=int)
        reasons: dict[int, str] = {}
        events = SweepEvents(self._inner.force_names)
        bar = _progress_bar(count) if progress else None
        size = max(1, -(-count // CHUNKS)) if bar is not None else max(1, count)
        # Without a variant the names are checked all the same.
        for first in range(0, max(1, count), size):
            part = slice(first, min(first + size, count))
            raw = self._inner.sweep(
                motions,
                list(fixed.items()),
                (
                    [(name, array[part]) for name, array in flat.items()],
                    [(name, [order[part].reshape(-1) for order in orders]) for name, orders in courses.items()],
                ),
                part.stop - first,
                indices,
            )
            parts.append(raw.take_values().reshape(part.stop - first, len(names), len(motions[0])))
            rows[part] = raw.rows
            reasons.update((first + index, reason) for index, reason in raw.reasons)
            events.add(first, raw.events())
            if bar is not None:
                bar.update(part.stop - first)
        if bar is not None:
            bar.close()
        known = {**self.variables, **{name: p.unit for name, p in self.parameters.items()}}
        return Sweep(
            np.asarray(motions[0]),
            not timeless,
            dict(zip(names, units)),
            series,
            {name: known[name] for name in series},
            shape,
            parts[0] if len(parts) == 1 else np.concatenate(parts),
            rows,
            reasons,
            events,
            bool(courses),
        )

    def range(
        self,
        driver: str,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
        between: Bounds = (None, None),
        speed: float | None = None,
    ) -> Range:
        """Finds how far a driver can go both ways, with the others held; `between` two values of it,
        numbers [m or rad] or expressions such as `"30*deg"`, in place of its own `min` and `max`.

        At `speed` [m/s or rad/s], by default at rest, there are the largest effort and the largest force
        in a joint, of a mechanism with masses or forces. Measures computed from velocities have the
        speed 1 without one.

        >>> str(four_bar.range("crank_angle").upper)
        'no limit'
        >>> boom = library("excavator_arm").range("boom_cylinder")
        >>> print(f"{boom.effort.value / 1e3:.0f} kN in the cylinder, most in {boom.reaction.joint}")
        418 kN in the cylinder, most in boom_foot
        """
        speed = None if speed is None else number("speed", speed)
        found = self._inner.range(
            text_argument("driver", driver), self._start(drive), given_values(parameters),
            bounds_of(between), speed,
        )
        lower, upper, crossings, values, transmission, rcond, poses, measures, extremes, forces = found
        effort, reaction, without = forces
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
                if both is not None
            },
            speed,
            None if effort is None else Extreme(*effort),
            None if reaction is None else JointForce(*reaction[0], reaction[1]),
            without,
        )

    def modes(self, drive: Drive | None = None, parameters: Parameters | None = None) -> Modes:
        """Finds the other poses in which the mechanism closes for the same values of its drivers.

        >>> len(four_bar.modes().others)
        1
        """
        others, complete = self._inner.modes(self._start(drive), given_values(parameters))
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
        warning tells each, and `held` has them. Another one tells each freedom that `drive` moves, whose
        states are taken away.
        `variables` narrows the outputs, as for `run`.

        >>> space = pendulum.linearize(balance=True, variables=["rod.phi"])
        >>> print(abs(space.eigenvalues).round(6))
        [5.424942 5.424942]
        """
        names, _, indices = self._chosen(variables)
        start = self._start(drive)
        drivers, q, states, inputs, matrices, held = self._inner.linearize(
            start, given_values(parameters), indices, balance
        )
        warn(f"{text}: what is held does not move in these equations" for _, _, text in held)
        driven = [name for name, _ in start[1] if name in self.freedoms]
        taken = [f"{name}.{rate}" for name in driven for rate in ("position", "velocity")]
        warn(
            f"`drive` moves freedom `{name}`, which has no states then; "
            f"`parameters` sets its start: `{name}.position`"
            for name in driven
        )
        shapes = [(len(rows), len(columns)) for rows in (states, names) for columns in (states, inputs)]
        return StateSpace(
            tuple(states),
            tuple(inputs),
            tuple(names),
            *(np.reshape(matrix, shape) for matrix, shape in zip(matrices, shapes)),
            dict(zip(self._coordinates, drivers)),
            dict(zip(self.bodies, np.reshape(q, (-1, 3)))),
            {name: force for name, force, _ in held},
            tuple(taken),
        )

    def balance(
        self, drive: Drive | None = None, parameters: Parameters | None = None, all: bool = False
    ) -> Equilibrium | tuple[Equilibrium, ...]:
        """Finds the stable equilibrium downhill from the start, with all inputs held.

        With `all` the equilibria downhill from places all over the range of the freedoms, of which
        there may be others. Friction that sticks at the start holds there while it suffices.

        >>> print(round(abs(pendulum.balance(parameters={"swing.position": 1.0}).values["swing"]), 9))
        0.0
        """
        rows = self._inner.balance(self._start(drive), given_values(parameters), bool(all))
        found = tuple(
            Equilibrium(
                dict(zip(self._coordinates, values)),
                dict(zip(self.bodies, np.reshape(q, (-1, 3)))),
                {name: force for name, force, _ in held},
                tuple(left_out),
            )
            for values, q, held, left_out in rows
        )
        return found if all else found[0]

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
        between: Bounds = (None, None),
        path: str | os.PathLike | None = None,
        contacts: bool = False,
    ) -> Drawing:
        """Draws the mechanism at the start values, as SVG that notebooks show; `path` is a file for the
        drawing, whose extension decides: `.svg`, `.png`, or `.dxf` for the workshop.

        `poses` further poses stand as faint outlines along the motion that the traces cover, or
        along the range of `driver`, `between` two values of it. `dimensions` adds letters of joints and
        lengths of bodies, `instant_centres` the instant centre of each body and ground, `forces` arrows
        for what joints and drivers exert, and for springs, dampers and loads, `contacts` the clearance
        of each contact between its nearest places.
        """
        width = None if width is None else count_of("width", width, 1)
        poses = count_of("poses", poses)
        driver = None if driver is None else text_argument("driver", driver)
        file = None if path is None else path_argument("path", path)
        if file is not None and file.lower().endswith(".dxf"):
            pictures = dict(poses=poses, dimensions=dimensions, instant_centres=instant_centres)
            pictures.update(width=width, forces=forces, contacts=contacts, transparent=transparent)
            for option, given in pictures.items():
                if given:
                    raise UsageError(f"{option} is of pictures: leave it out for a drawing in DXF")
        marks = (bool(dimensions), bool(instant_centres), bool(forces), bool(contacts))
        options = (bool(traces), poses, driver, *marks)
        drawing, content, notes = self._inner.draw(
            self._start(drive), given_values(parameters), options, bounds_of(between),
            (file, width, bool(transparent)),
        )
        if file is not None:
            written(file, bytes(content))
        warn(notes)
        return Drawing(drawing)

    def convert(
        self,
        to: str,
        path: str | os.PathLike | None = None,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
    ) -> str:
        """Returns the mechanism for another program, and writes the file `path` if there is one.

        `to` is `pmks` for a link that opens in PMKS+, `pylinkage` for JSON, `linkage` for a document of
        Linkage, `asmt` for an assembly of OndselSolver and FreeCAD. A warning tells what does not come
        over.

        >>> four_bar.convert("pmks").startswith("https://app.pmksplus.com/?")
        True
        """
        start = self._start(drive)
        text, notes = self._inner.convert(text_argument("to", to), start, given_values(parameters))
        if path is not None:
            written(path, text)
        warn(notes)
        return text

    def report(
        self,
        path: str | os.PathLike | None = None,
        drive: Drive | None = None,
        parameters: Parameters | None = None,
    ) -> Path:
        """Writes a report, one page that prints to PDF, and returns its path, by default the mechanism's
        name with `_report.html`."""
        path = Path(f"{self.name}_report.html") if path is None else path
        page, notes = self._inner.page_of_report(self._start(drive), given_values(parameters))
        warn(notes)
        return written(path, page)

    def page(
        self,
        path: str | os.PathLike | None = None,
        solver: str | os.PathLike | None = None,
        share: str | None = None,
        studio: str | None = None,
    ) -> Path:
        """Writes a page on which the mechanism is moved by hand, and returns its path, by default the
        mechanism's name with `.html`.

        `solver` is a solver for pages that replaces that of this package, `share` the name of a script
        beside the page that takes it, `studio` the address of a studio, to which *Edit* leads.
        """
        file = path_argument("path", f"{self.name}.html" if path is None else path)
        files = self._inner.page(
            file,
            None if share is None else text_argument("share", share),
            None if solver is None else path_argument("solver", solver),
            None if studio is None else text_argument("studio", studio),
        )
        paths = [written(name, content) for name, content in files]
        return paths[0]

    def changed(self, parameters: Parameters | None = None, drive: Drive | None = None) -> Mechanism:
        """Returns the mechanism with other parameters and start values of drivers.

        Its file differs in these values and in the estimates, which are those of the pose there;
        comments stay.

        >>> longer = four_bar.changed({"base": 0.42}, drive={"crank_angle": 1.0})
        >>> print(longer.check().poses["rocker"].round(4))
        [0.42   0.     2.1897]
        """
        given = given_values(parameters)
        text = self._inner.edited(self._start(drive), given, None)
        return _reread(text, *self._origin())

    def posed(self, mode: Mode) -> Mechanism:
        """Returns the mechanism in another of its assembly modes: the file with other estimates.

        >>> (other,) = four_bar.modes().others
        >>> mirrored = four_bar.posed(other)
        >>> bool(np.allclose(mirrored.check().poses["rocker"], other.poses["rocker"]))
        True
        """
        estimates = [_pose_of(mode, body) for body in self.bodies]
        text = self._inner.edited(self._start(None), [], np.concatenate(estimates).tolist())
        return _reread(text, *self._origin())

    def write(self, path: str | os.PathLike) -> Path:
        """Writes the mechanism file and returns its path."""
        return written(path, self.text)

    def export(
        self,
        path: str | os.PathLike | None = None,
        platforms: Iterable[str] = (),
        runtime: str | os.PathLike | None = None,
        fmi: int = 2,
        terminals: bool = False,
        page: bool = True,
        ssp: bool = False,
    ) -> Path:
        """Writes the FMU and returns its path, by default the mechanism's name with `.fmu`.

        `fmi` is the version of the standard: 2 or 3; `terminals` adds terminals and an icon to an FMU
        of FMI 2.0. `page` adds the page on which the mechanism is moved by hand. With `ssp` the file
        is a system of SSP 1.0, `.ssp`, which holds the FMU and the values of its parameters.

        `platforms` narrows the FMU to some of those of `biela platforms`; `runtime` is a folder of
        runtime libraries that replace those of this package.
        """
        extension = "ssp" if ssp else "fmu"
        path = Path(f"{self.name}.{extension}") if path is None else path
        folder = None if runtime is None else path_argument("runtime", runtime)
        options = [bool(terminals), not page, bool(ssp)]
        names = names_of("platforms", platforms)
        return written(path, bytes(self._inner.fmu(_version(fmi), options, folder, names)))

    def model_description(self, fmi: int = 2) -> str:
        """Returns the modelDescription.xml of the FMU of a version of FMI: 2 or 3.

        >>> four_bar.model_description()[:38]
        '<?xml version="1.0" encoding="UTF-8"?>'
        """
        return bytes(self._inner.model_description(_version(fmi))).decode("utf-8")

    def _chosen(self, wanted: Sequence[str] | None) -> tuple[list[str], list[str], list[int]]:
        """Returns names, units and indices of variables, or of all variables of owners."""
        columns = self._inner.columns
        if wanted is None:
            indices = list(range(len(columns)))
        else:
            indices = places([name for name, _ in columns], names_of("variables", wanted))
        return [columns[i][0] for i in indices], [columns[i][1] for i in indices], indices

    def _start(self, drive: Drive | None) -> tuple[NDArray, list]:
        """Returns the motions at the file's start time, where drivers have single values."""
        return self._motions(self._inner.simulation[:1], start_of(drive, self.inputs))

    def _motions(self, t: ArrayLike | None, drive: Drive | None) -> tuple[NDArray, list]:
        """Returns times and motions of drivers as the compiled module takes them."""
        return motions_of(t, mapping("drive", drive), self._inner.simulation, self._wrapped)

    @property
    def _wrapped(self) -> dict[str, float]:
        """Start values of the drivers whose values mean angles modulo one turn."""
        return {d.name: d.start for d in self.drivers.values() if d.wrapped and d.start is not None}

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


def _pose_of(mode: Mode, body: str) -> NDArray:
    """Returns x, y and phi of a body."""
    if body not in mapping("posed", getattr(mode, "poses", mode)):
        raise UsageError(f"posed: the mode has no pose of body `{body}`")
    pose = numbers("posed", mode.poses[body], body)
    if pose.shape != (3,) or not np.isfinite(pose).all():
        raise UsageError(f"posed: expected three finite numbers as `{body}`; found {mode.poses[body]!r}")
    return pose


def _version(fmi: int) -> str:
    """Returns a version of FMI."""
    if str(fmi) not in ("2", "3"):
        raise UsageError(f"fmi is {fmi!r}; expected 2 or 3")
    return str(fmi)


def _outer(arrays: Iterable[NDArray], after: int) -> list[NDArray]:
    """Gives each array axes of its own, in order, with others after them."""
    arrays = list(arrays)
    after += sum(array.ndim for array in arrays)
    spread = []
    for array in arrays:
        after -= array.ndim
        spread.append(array.reshape(array.shape + (1,) * after))
    return spread


def _progress_bar(count: int):
    """Returns a bar of tqdm."""
    return needed("tqdm.auto", "progress").tqdm(total=count, unit="variant")


def _reread(text: str, path: str | None, has_tables: bool, shipped: str | None = None) -> Mechanism:
    """Returns the mechanism of another text of its file, or in another process; tables are beside
    the file. Warnings were shown when the file was read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MechanismWarning)
        name = path or f"{shipped or 'mechanism'}.toml"
        inner = _biela.Mechanism(name, text, path if has_tables else None, shipped)
        return Mechanism(inner, path, shipped)
