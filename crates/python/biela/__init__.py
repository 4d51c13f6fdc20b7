"""biela: planar mechanisms as text files, solved exactly and exported as FMUs.

>>> import biela
>>> mechanism = biela.loads(text)
>>> result = mechanism.run(t=[0, 0.25], drive={"crank_angle": "60*deg + 2*pi*t"})
>>> print(result["rocker.phi"].round(6))
[2.143697 2.609213]

The package brings the program of the same name, too; `python -m biela` runs it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ._biela import __version__

if TYPE_CHECKING:
    from .files import Platform, import_mechanism, new, platforms, schema
    from .errors import (
        AssemblyError,
        Diagnostic,
        Error,
        FileError,
        MechanismError,
        MechanismWarning,
        MissingFileError,
        MissingPackageError,
        StoppedError,
        UnknownNameError,
        UsageError,
    )
    from .synthesis import Fit, Target, fit, points
    from .mechanism import Mechanism, check, library, load, loads
    from .parts import Driver, Event, Force, Freedom, Input, Measure, Parameter
    from .results import (
        ChangePoint,
        Drawing,
        End,
        Equilibrium,
        Extreme,
        Gradient,
        JointForce,
        Mode,
        Modes,
        Range,
        Report,
        Result,
        StateSpace,
        Sweep,
    )
    from .tolerances import Tolerances, tolerance

__all__ = [
    "AssemblyError",
    "ChangePoint",
    "Diagnostic",
    "Drawing",
    "Driver",
    "End",
    "Equilibrium",
    "Error",
    "Event",
    "Extreme",
    "FileError",
    "Fit",
    "Force",
    "Freedom",
    "Gradient",
    "Input",
    "JointForce",
    "Measure",
    "Mechanism",
    "MechanismError",
    "MechanismWarning",
    "MissingFileError",
    "MissingPackageError",
    "Mode",
    "Modes",
    "Parameter",
    "Platform",
    "Range",
    "Report",
    "Result",
    "StateSpace",
    "StoppedError",
    "Sweep",
    "Target",
    "Tolerances",
    "UnknownNameError",
    "UsageError",
    "__version__",
    "check",
    "fit",
    "import_mechanism",
    "library",
    "load",
    "loads",
    "new",
    "platforms",
    "points",
    "schema",
    "tolerance",
]

_MODULES = "errors", "parts", "results", "mechanism", "files", "synthesis", "tolerances"
"""Modules that define these names. They are imported when a name is needed: the program needs none,
and no NumPy, which all but the first import."""


def __getattr__(name: str) -> Any:
    if name in __all__:
        for module in _MODULES:
            found = importlib.import_module(f".{module}", __name__)
            if hasattr(found, name):
                return getattr(found, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
