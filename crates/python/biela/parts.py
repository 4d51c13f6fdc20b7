"""Named things of a mechanism, and what happens to them in a free motion."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

KINDS = ("impact", "rests", "leaves", "sticks", "slides")
"""Kinds of events, in the order of the compiled module."""


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


@dataclass(frozen=True)
class Freedom:
    """Coordinate that the forces move, in SI units."""

    name: str
    description: str
    unit: str
    start: float
    """Value at the start: `name.position` among `parameters`."""
    velocity: float
    """Velocity at the start: `name.velocity` among `parameters`."""


@dataclass(frozen=True)
class Input:
    """Input, or size of a force, that `drive` or `inputs` may give."""

    name: str
    description: str
    unit: str
    start: float
    """Value where nobody gives one, zero for a force."""
    min: float | None
    max: float | None


@dataclass(frozen=True)
class Measure:
    """Measure of a mechanism, in SI units."""

    name: str
    description: str
    unit: str
    variable: str
    """Name of the variable that has its value."""
    value: float | None
    """Value at the start; `None` where the mechanism does not get there."""


@dataclass(frozen=True)
class Force:
    """Force that follows from the motion: of a spring, a damper, a load, a stop or friction."""

    name: str
    """Name of the variable that has its size."""
    description: str
    unit: str
    value: float | None
    """Size at the start [N or N m]; `None` where the mechanism does not get there, or the file leaves
    the variable out."""


@dataclass(frozen=True)
class Event:
    """Event of a free motion."""

    time: float
    """Time [s]."""
    kind: str
    """`impact`, `rests` and `leaves` at a stop, a rope or a joint with play; `sticks` and `slides` of
    friction."""
    name: str
    """Name of the stop, the joint or the friction."""
    speed: float | None
    """Speed with which the coordinate arrives at an impact [m/s or rad/s]; `None` for other kinds."""


def events_of(columns: Sequence, names: Sequence[str]) -> Iterator[tuple[int, Event]]:
    """Returns the events in columns of the compiled module, each with the number of its variant."""
    for variant, time, kind, force, speed in zip(*(np.asarray(column).tolist() for column in columns)):
        event = Event(time, KINDS[kind], names[force], speed if KINDS[kind] == "impact" else None)
        yield variant, event


class SweepEvents:
    """Events of many variants, as columns."""

    def __init__(self, names: Sequence[str]):
        self._names = names
        self._parts: list[tuple] = []

    def add(self, first: int, columns: Sequence) -> None:
        """Adds the events of variants, the first of which has this number."""
        variants, *others = columns
        self._parts.append((variants + first, *others))

    def by_variant(self) -> dict[int, tuple[Event, ...]]:
        """Returns the events of each variant that has some."""
        found = defaultdict(list)
        for part in self._parts:
            for variant, event in events_of(part, self._names):
                found[variant].append(event)
        return {variant: tuple(events) for variant, events in found.items()}
