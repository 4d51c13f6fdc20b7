"""The gallery's mechanisms with the truth that each is held to, one file a mechanism.

A file `tests/fmpy/gallery/NAME.py` belongs to `mechanisms/NAME.toml` and defines `CASE`. The five
whose closed form the demo shows are in `closed_forms.py`. `python -m gallery`, run in this
folder's parent, prints the table of all of them, and with `--page` writes `mechanisms/README.md`.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .taylor import Taylor

#: What the truth says of outputs: positions with their rates by the names of the FMU's outputs,
#: `coupler.x`, `rocker.phi`, `foot.P.y` or `stroke` for a measure, whose velocity and
#: acceleration outputs follow from the name.
Truth = dict[str, Taylor]


@dataclass(frozen=True)
class Case:
    """A mechanism, its full motion and its truth."""

    #: What the truth is, for the table: "closed form: two circle intersections".
    source: str
    #: The value of each driver that is an input, over the time from 0 to `duration`.
    drivers: Callable[[Taylor], dict[str, Taylor]]
    #: What the outputs have to be, given the values of the inputs in force and the time that
    #: they belong to: one step before the outputs, without inputs that of the outputs.
    truth: Callable[[Taylor, dict[str, Taylor]], Truth]
    duration: float = 2.0
    steps: int = 720
    #: Largest error of position, velocity and acceleration, each relative to the largest
    #: magnitude of its kind over the motion; a case that needs more says why.
    limits: tuple[float, float, float] = (1e-12, 1e-11, 1e-10)
    #: Start values of parameters other than the file's.
    parameters: dict[str, float] = field(default_factory=dict)
    #: Exact properties, apart from the truth: what vanishes, made of the recorded inputs and
    #: outputs by their names in the FMU and of order 1 if it did not; held to the first limit.
    properties: Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]] = lambda motion: {}
    #: Positions that the truth leaves out, by the names that it would use.
    left_out: tuple[str, ...] = ()


def cases() -> dict[str, Case]:
    """All cases by the name of their mechanism."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    modules = {
        name: importlib.import_module(f"{__name__}.{name}") for name in names if name != "__main__"
    }
    found = {name: module.CASE for name, module in modules.items() if hasattr(module, "CASE")}
    return dict(sorted((modules["closed_forms"].cases() | found).items()))


def one_turn(start: float) -> Callable[[Taylor], Taylor]:
    """A crank's full turn from `start` over 2 s, from rest to rest (a cycloid)."""
    return lambda time: start + np.pi * time - (np.pi * time).sin()


def swing(middle: float, amplitude: float) -> Callable[[Taylor], Taylor]:
    """There and back between middle - amplitude, at rest, and middle + amplitude over 2 s."""
    return lambda time: middle - amplitude * (np.pi * time).cos()
