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
    from .errors import (
        AssemblyError,
        Diagnostic,
        Error,
        FileError,
        MechanismError,
        MechanismWarning,
        StoppedError,
        UsageError,
    )
    from .synthesis import Fit, Target, fit, points
    from .mechanism import Driver, Mechanism, Parameter, check, load, loads
    from .results import (
        ChangePoint,
        Drawing,
        End,
        Gradient,
        Mode,
        Modes,
        Range,
        Report,
        Result,
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
    "Error",
    "FileError",
    "Fit",
    "Gradient",
    "Mechanism",
    "MechanismError",
    "MechanismWarning",
    "Mode",
    "Modes",
    "Parameter",
    "Range",
    "Report",
    "Result",
    "StoppedError",
    "Sweep",
    "Target",
    "Tolerances",
    "UsageError",
    "__version__",
    "check",
    "fit",
    "load",
    "loads",
    "points",
    "tolerance",
]

_HOMES = {
    "errors": [
        "AssemblyError",
        "Diagnostic",
        "Error",
        "FileError",
        "MechanismError",
        "MechanismWarning",
        "StoppedError",
        "UsageError",
    ],
    "synthesis": ["Fit", "Target", "fit", "points"],
    "mechanism": ["Driver", "Mechanism", "Parameter", "check", "load", "loads"],
    "results": [
        "ChangePoint",
        "Drawing",
        "End",
        "Gradient",
        "Mode",
        "Modes",
        "Range",
        "Report",
        "Result",
        "Sweep",
    ],
    "tolerances": ["Tolerances", "tolerance"],
}
"""Modules by what they define. They are imported when they are needed: the program needs none of
them, and no NumPy."""


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            return getattr(importlib.import_module(f".{home}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
