"""Results: motions, sweeps, ranges, reports."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _biela, charts, tables
from .errors import Diagnostic, UnknownNameError, UsageError
from .optional import needed
from .parts import Event
from .texts import table

if TYPE_CHECKING:
    import pandas
    import xarray


def _unknown(name: Any, known: list[str], kind: str = "variable") -> UnknownNameError:
    return UnknownNameError(_biela.unknown_name(kind, str(name), known))


def places(known: Sequence[str], wanted: str | Sequence[str]) -> list[int]:
    """Returns where the wanted variables stand, or all of a body, marker, driver or measure."""
    found: list[int] = []
    for name in [wanted] if isinstance(wanted, str) else wanted:
        own = [i for i, known_name in enumerate(known) if f"{known_name}.".startswith(f"{name}.")]
        if not own:
            raise UsageError(f"variables: {_biela.unknown_name('variable', name, list(known))}")
        found += [place for place in own if place not in found]
    return found


class Drawing(str):
    """SVG document that notebooks show."""

    def _repr_svg_(self) -> str:
        return str(self)


class Result(dict):
    """Motion of a mechanism: a mapping from the FMU's names of variables to arrays over time.

    Values are in SI units; `units` tells which. As a `dict` it is what `pandas.DataFrame` takes; its
    arrays are columns of one array.
    """

    def __init__(self, stopped, run, t, timed, units, values, by, gradient, moving, events):
        super().__init__(zip(units, values.T))
        self._run = run
        self.t: NDArray = t
        """Times [s]; those of the start for poses without times."""
        self.timed: bool = timed
        """Whether the rows have times of their own."""
        self.units: dict[str, str] = units
        """Units by the variables' names."""
        self._values = values
        self._moving = moving
        self.gradient = Gradient(list(units), by, gradient)
        """Derivatives of the variables by parameters: `gradient[variable, parameter]`."""
        self.stopped: str | None = stopped
        """Reason why the motion ends early; `None` for a whole motion."""
        self.events: tuple[Event, ...] = events
        """Events of the free motion, such as impacts, in the order of time."""

    def __missing__(self, name: str) -> NDArray:
        if name == "time":
            return self.t
        raise _unknown(name, list(self))

    def __contains__(self, name: object) -> bool:
        return name == "time" or super().__contains__(name)

    def __reduce__(self):
        # The arrays travel once, as the one whose columns they are.
        return _remade, (self.__dict__,)

    def to_numpy(self) -> NDArray:
        """Returns all values: rows by columns, in the order of the names."""
        return self._values

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the motion as a `pandas.DataFrame` with the times as index, or with numbers for
        poses without times."""
        rows = tables.rows_index(self.t, self.timed)
        return tables.frame(self._values, rows, self.units)

    def to_xarray(self) -> xarray.Dataset:
        """Returns the motion as an `xarray.Dataset` over `time`, or over `pose` for poses without
        times. Each variable has its `units`."""
        return tables.dataset(self.t, self.timed, self, self.units)

    def plot(
        self, variables: str | Sequence[str] | None = None, over: str | None = None, axes=None
    ) -> NDArray:
        """Draws variables over time, in a panel per unit, and returns the axes of Matplotlib.

        `variables` are names, or those of bodies, markers, drivers or measures, by default all;
        variables that are not named themselves are left out if they stay constant. `over` is the
        variable on the x-axis; by default the time, or for poses without times the driver that
        moves, if it is one. `axes` are axes to draw in, one per unit.
        """
        if len(self.t) < 2:
            raise UsageError(f"plot: expected two rows or more; found {len(self.t)}")
        known = list(self)
        wanted = [variables] if isinstance(variables, str) else list(variables or known)
        lines = {known[place]: self[known[place]] for place in places(known, wanted)}
        named = wanted if variables else ()
        moving = charts.changing(lines, self.units)
        lines = {n: v for n, v in lines.items() if n in moving or n in named} or lines
        return charts.panels(self._along(over), lines, self.units, axes)

    def _along(self, over: str | None) -> tuple[str, NDArray]:
        """Returns the label and the values of the x-axis of a chart."""
        if over is not None and over != "time":
            return charts.label(over, self.units.get(over, "")), self[over]
        if self.timed or over == "time":
            return charts.label("time", "s"), self.t
        if self._moving is not None:
            name, unit, values = self._moving
            return charts.label(name, unit), values[: len(self.t)]
        return "pose", np.arange(len(self.t))

    def to_html(self, forces: bool = False) -> str:
        """Returns a page on which the mechanism moves: one HTML file that needs no other.

        `forces` adds arrows for what joints and drivers exert, and for springs, dampers and loads.
        """
        # The same run once more keeps the poses, which would be a second copy of the result.
        mechanism, *arguments = self._run
        raw = mechanism._inner.run(*arguments, True)
        if forces and not raw.has_forces:
            raise UsageError(
                "forces: this run has none; they are among the variables of mechanisms with masses "
                "or `[forces]`"
            )
        return raw.page(forces)

    def _repr_html_(self) -> str:
        page = html.escape(self.to_html(), quote=True)
        return (
            f'<iframe srcdoc="{page}" style="width: 100%; height: 640px; border: 0" '
            'sandbox="allow-scripts" title="motion"></iframe>'
        )

    def __repr__(self) -> str:
        stopped = f", stopped: {self.stopped}" if self.stopped else ""
        return f"<biela.Result: {len(self.t)} rows of {len(self.units)} variables{stopped}>"


def _remade(attributes: dict[str, Any]) -> Result:
    """Returns a result in another process."""
    result = Result.__new__(Result)
    result.__dict__ = attributes
    dict.update(result, zip(result.units, result._values.T))
    return result


class Gradient(Mapping):
    """Derivatives of variables by parameters: a mapping from pairs of their names to arrays over
    time, in SI units."""

    def __init__(self, variables: list[str], parameters: list[str], values: NDArray):
        self.variables = variables
        """Names of the variables."""
        self.parameters = parameters
        """Names of the parameters."""
        self._values = values

    def __getitem__(self, key: tuple[str, str]) -> NDArray:
        if not isinstance(key, tuple) or len(key) != 2:
            raise UsageError("gradient: expected gradient[variable, parameter]")
        variable, parameter = key
        if variable not in self.variables:
            raise _unknown(variable, self.variables)
        if parameter not in self.parameters:
            raise _unknown(parameter, self.parameters, "parameter among `gradient`")
        place = self.parameters.index(parameter), self.variables.index(variable)
        return self._values[:, place[0], place[1]]

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return ((variable, by) for variable in self.variables for by in self.parameters)

    def __len__(self) -> int:
        return len(self.variables) * len(self.parameters)

    def __contains__(self, key: object) -> bool:
        if not isinstance(key, tuple) or len(key) != 2:
            return False
        return key[0] in self.variables and key[1] in self.parameters

    def to_numpy(self) -> NDArray:
        """Returns all derivatives: rows by parameters by variables."""
        return self._values

    def __repr__(self) -> str:
        return f"<biela.Gradient of {len(self.variables)} variables by {', '.join(self.parameters)}>"


class Sweep(Mapping):
    """Motions of many variants: a mapping from names of variables to arrays.

    Each array has the shape of the swept parameters, then one axis over time.
    """

    def __init__(
        self, t, timed, units, parameters, parameter_units, shape, values, rows, reasons, events, moved
    ):
        self.t: NDArray = t
        """Times [s]; those of the start for poses without times."""
        self.timed: bool = timed
        """Whether the rows have times of their own."""
        self.units: dict[str, str] = units
        """Units by the variables' names."""
        self.parameters: dict[str, NDArray] = parameters
        """Swept values by the parameters' names."""
        self._parameter_units = parameter_units
        self.shape: tuple[int, ...] = shape
        """Shape of the variants."""
        self._values = values
        self._places = {name: place for place, name in enumerate(units)}
        self.rows: NDArray = rows.reshape(shape)
        """Number of rows that each variant reached."""
        self._reasons = reasons
        self._events = events
        self._moved = moved

    @property
    def ok(self) -> NDArray:
        """Whether each variant went through the whole motion."""
        return self.rows == len(self.t)

    def reason(self, *variant: int) -> str | None:
        """Returns why a variant stopped; `None` for one that went through."""
        flat = np.ravel_multi_index(variant, self.shape) if self.shape else 0
        return self._reasons.get(int(flat))

    @property
    def reasons(self) -> dict[tuple[int, ...], str]:
        """Reasons of all variants that stopped, by their indices."""
        return {self._place(flat): reason for flat, reason in self._reasons.items()}

    @property
    def events(self) -> dict[tuple[int, ...], tuple[Event, ...]]:
        """Events of the free motions of all variants that have some, by their indices."""
        return {self._place(flat): events for flat, events in self._events.by_variant().items()}

    def _named(self, swept: dict[str, Any]) -> dict[str, Any]:
        """Returns what is swept by its name in tables, where starts stand beside their variables."""
        return {f"start.{name}" if name in self.units else name: value for name, value in swept.items()}

    def _levels(self) -> dict[str, NDArray]:
        """Returns what tells variants apart: parameters, and numbers where motions differ too."""
        if not self._moved:
            return self.parameters
        return {**self.parameters, "variant": np.arange(self.ok.size).reshape(self.shape)}

    def _place(self, flat: int) -> tuple[int, ...]:
        """Returns the indices of a variant."""
        return tuple(int(i) for i in np.unravel_index(flat, self.shape)) if self.shape else ()

    def __getitem__(self, name: str) -> NDArray:
        if name not in self._places:
            raise _unknown(name, list(self._places))
        return self._values[:, self._places[name]].reshape(*self.shape, len(self.t))

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def __len__(self) -> int:
        return len(self.units)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns all rows of all variants as a `pandas.DataFrame`.

        The index has a level per swept parameter, and the times, or numbers for poses without times.
        """
        rows = tables.rows_index(self.t, self.timed)
        values = np.moveaxis(self._values, 1, 2).reshape(-1, len(self.units))
        index = tables.variants_index(self._named(self._levels()), rows)
        return tables.frame(values, index, self.units)

    def to_xarray(self) -> xarray.Dataset:
        """Returns the motions as an `xarray.Dataset`, over the axes of the variants and `time`, or
        `pose` for poses without times.

        An axis along which one parameter varies alone has its name and its values, the start of a
        freedom with `start.` before it; the others are called `variant`, and their parameters are
        coordinates.
        """
        parameters, units = self._named(self.parameters), self._named(self._parameter_units)
        axes = tables.sweep_dimensions(parameters, self.shape)
        coordinates = tables.sweep_coordinates(parameters, units, axes)
        return tables.dataset(self.t, self.timed, self, self.units, axes, coordinates)

    def __repr__(self) -> str:
        whole = int(np.count_nonzero(self.ok))
        return f"<biela.Sweep: {self.ok.size} variants, {whole} whole, {len(self.t)} rows each>"


@dataclass(frozen=True)
class End:
    """End of a driver's range in one direction."""

    kind: str
    """`turns`: none; `singular`: a dead point; `stop`; `blocked`; `not found`: none up to `value`."""
    value: float | None
    """Value of the driver there [m or rad]."""
    text: str
    """Description, as `biela range` prints it."""
    turns: int | None = None
    """Number of turns after which the mechanism is where it was."""

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class JointForce:
    """Largest force in a joint in a range."""

    value: float
    """Force [N], infinite where it grows without bound."""
    at: float
    """Value of the driver there [m or rad]."""
    joint: str | None
    """Name of the joint; `None` for a force without bound."""


@dataclass(frozen=True)
class ChangePoint:
    """Change point that a motion passes."""

    value: float
    """Value of the driver [m or rad]."""
    bodies: tuple[str, ...]
    """Bodies and connections in `text`."""
    text: str = ""
    """Lines that meet there, as `biela range` prints them."""


@dataclass(frozen=True)
class Extreme:
    """Least or greatest value of a measure in a range."""

    value: float
    """Value of the measure [m or rad]."""
    at: float
    """Value of the driver there [m or rad]."""


@dataclass(frozen=True)
class Range:
    """Range of a driver, with samples of the motion from end to end."""

    driver: str
    lower: End
    upper: End
    crossings: tuple[ChangePoint, ...]
    values: NDArray
    """Values of the driver [m or rad], those at change points and located limits among them."""
    transmission: NDArray
    """Smallest transmission angle at each sample [rad]; not a number without a loop."""
    rcond: NDArray
    """Reciprocal condition at each sample."""
    poses: dict[str, NDArray]
    """Poses of each body: x, y, phi by sample."""
    measures: dict[str, NDArray] = field(default_factory=dict)
    """Values of each measure in SI units; not a number where a computed one has none."""
    extremes: dict[str, tuple[Extreme, Extreme]] = field(default_factory=dict)
    """Least and greatest value of each of them, located to rounding; infinite where it grows without
    bound."""
    speed: float | None = None
    """Speed of the driver at which forces and computed measures are [m/s or rad/s]; without one forces
    are at rest."""
    effort: Extreme | None = None
    """Largest effort of the driver [N or N m], infinite where it grows without bound; `None` without
    forces."""
    reaction: JointForce | None = None
    """Largest force in a joint; `None` without forces."""
    without_forces: str | None = None
    """Places where there are no forces, and why, in words."""

    @property
    def turns(self) -> bool:
        """Whether the driver turns without limit."""
        return self.upper.kind == "turns"

    def __repr__(self) -> str:
        return f"<biela.Range of {self.driver}: {self.lower} to {self.upper}>"


@dataclass(frozen=True)
class Mode:
    """Assembly mode."""

    poses: dict[str, NDArray]
    """Pose of each body: x, y, phi."""
    rcond: float
    """Reciprocal condition."""

    def __repr__(self) -> str:
        return f"<biela.Mode of {', '.join(self.poses)}: rcond {self.rcond:.2g}>"


@dataclass(frozen=True)
class Modes:
    """Assembly modes besides the mechanism's own."""

    others: tuple[Mode, ...]
    complete: bool
    """Whether there are no others."""

    def __repr__(self) -> str:
        more = "" if self.complete else ", perhaps more"
        return f"<biela.Modes: {len(self.others)} others{more}>"


@dataclass(frozen=True)
class Equilibrium:
    """Stable equilibrium of a mechanism with freedoms."""

    values: dict[str, float]
    """Values of drivers and freedoms [m or rad]."""
    poses: dict[str, NDArray]
    """Pose of each body: x, y, phi."""
    held: dict[str, float]
    """Contacts that push and friction that holds, with the force along the coordinate of each [N or
    N m]."""
    left_out: tuple[str, ...]
    """Friction that does not suffice on the way: the equilibrium is that of all other forces."""

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in self.values.items())
        return f"<biela.Equilibrium: {values}>"


@dataclass(frozen=True)
class StateSpace:
    """Linear equations of small free motions about a pose: dx/dt = A x + B u, y = C x + D u in SI
    units."""

    states: tuple[str, ...]
    """Names of the states: value and velocity of each freedom."""
    inputs: tuple[str, ...]
    """Names of the inputs: sizes of forces, then value, velocity and acceleration of each driver that
    is an input."""
    outputs: tuple[str, ...]
    A: NDArray
    B: NDArray
    C: NDArray
    D: NDArray
    drivers: dict[str, float]
    """Values of drivers and freedoms at the pose [m or rad]."""
    pose: dict[str, NDArray]
    """x, y and phi of each body at the pose."""
    held: dict[str, float]
    """Closed contacts and friction that sticks, with the force along the coordinate that each holds
    [N or N m]: what is held does not move in these equations."""
    taken: tuple[str, ...] = ()
    """Names of the states of freedoms that `drive` moves, which are no states here."""

    def __repr__(self) -> str:
        counts = f"{len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<biela.StateSpace of {', '.join(self.states)}: {counts}>"

    def to_control(self):
        """Returns the equations as a `control.StateSpace` with the names of states, inputs and outputs,
        in which it permits no dots: `swing_position`.

        Needs the package control.
        """
        control = needed("control", "to_control")
        plain = lambda names: [name.replace(".", "_") for name in names]
        return control.ss(
            *self.matrices,
            states=plain(self.states),
            inputs=plain(self.inputs),
            outputs=plain(self.outputs),
        )

    @property
    def matrices(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """A, B, C and D."""
        return self.A, self.B, self.C, self.D

    @property
    def eigenvalues(self) -> NDArray:
        """Eigenvalues of A [1/s]: decay, and circular frequency of each way to swing."""
        return np.linalg.eigvals(self.A)


class Report:
    """Report on a mechanism: `biela check --format json` in attributes."""

    def __init__(self, data: dict[str, Any]):
        self.data = data
        """All keys of the JSON report."""

    @property
    def ok(self) -> bool:
        """Whether the file has no errors and the mechanism closes."""
        return self.data["ok"]

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Errors or warnings about the file."""
        found = []
        for row in self.data.get("diagnostics", []):
            place = row["labels"][0]["start"] if row["labels"] else {}
            line, column = place.get("line"), place.get("column")
            found.append(
                Diagnostic(row["severity"], row["code"], row["message"], row["help"], line, column)
            )
        return tuple(found)

    @property
    def error(self) -> str | None:
        """Reason why the mechanism does not close."""
        return self.data.get("error", {}).get("message")

    @property
    def poses(self) -> dict[str, NDArray]:
        """Pose of each body: x, y, phi. The nearest one if the mechanism does not close."""
        rows = self._assembled.get("bodies") or self.data.get("error", {}).get("nearest") or []
        return {row["name"]: np.array([row["x"], row["y"], row["phi"]]) for row in rows}

    @property
    def measures(self) -> dict[str, float]:
        """Values of the measures [m or rad]."""
        return {row["name"]: row["value"] for row in self._assembled.get("measures", [])}

    @property
    def degrees_of_freedom(self) -> int | None:
        """Number of degrees of freedom, all of them driven."""
        return self._assembled.get("degrees_of_freedom")

    @property
    def rcond(self) -> float | None:
        """Reciprocal condition: 1 is best, 0 a singular position."""
        return self._assembled.get("rcond")

    @property
    def residual(self) -> float | None:
        """Largest scaled residual of the constraint equations."""
        return self._assembled.get("residual")

    @property
    def warnings(self) -> tuple[str, ...]:
        """Redundant joints, joints that do not fit their own numbers, motions beyond limits."""
        kinds = ("redundancies", "misfits", "excursions")
        return tuple(text for kind in kinds for text in self._assembled.get(kind, ()))

    @property
    def _assembled(self) -> dict[str, Any]:
        return self.data.get("assembled", {})

    def _repr_html_(self) -> str:
        problems = [(d.severity, d.code, d.message, d.help or "") for d in self.diagnostics]
        poses = [(body, *(f"{value:.6f}" for value in pose)) for body, pose in self.poses.items()]
        measures = [(name, f"{value:.6f}") for name, value in self.measures.items()]
        return (
            f"<p>{html.escape(self._state)}</p>"
            + table(("", "code", "problem", "help"), problems)
            + table(("body", "x [m]", "y [m]", "phi [rad]"), poses)
            + table(("measure", "value [m or rad]"), measures)
            + "".join(f"<p>{html.escape(text)}</p>" for text in self.warnings)
        )

    @property
    def _state(self) -> str:
        return "closes" if self.ok else self.error or "has errors"

    def __repr__(self) -> str:
        return f"<biela.Report: {self._state}>"
