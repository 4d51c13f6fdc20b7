"""Commands of the program that need no mechanism."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _biela
from .arguments import path_argument, text_argument
from .errors import warn
from .mechanism import Mechanism, loads
from .texts import written


def new(name: str, template: str = "four_bar", folder: str | os.PathLike = ".") -> Path:
    """Writes a commented mechanism to start from, a copy of one of `library()`, and returns its path."""
    return _biela.new(text_argument("name", name), text_argument("template", template), path_argument("folder", folder))


def import_mechanism(
    source: str | os.PathLike, path: str | os.PathLike | None = None, length: str | None = None
) -> Mechanism:
    """Reads a mechanism of another program: an assembly of FreeCAD and OndselSolver, a document of
    Linkage, JSON of pylinkage, a drawing in DXF, or a link of PMKS+ itself.

    `path` is the mechanism file to write, which is also written if it has errors. `length` is the unit
    of the lengths of a source that does not tell it: `m`, `cm`, `mm` or `inch`. A warning tells what is
    left out or was taken in one of several ways; the text has them as comments.
    """
    length = None if length is None else text_argument("length", length)
    name, content, notes = _biela.import_mechanism(path_argument("source", source), length)
    if path is not None:
        written(path, content)
    warn(notes)
    return loads(content, f"{name}.toml" if path is None else os.fspath(path))


@dataclass(frozen=True)
class Platform:
    """Platform that exported FMUs run on."""

    name: str
    system: str
    """Operating system and processor."""
    glibc: str | None
    """Oldest version of the C library of Linux that the runtime library runs with."""
    library: str | None
    """Place of the runtime library; `None` without one."""


def platforms(runtime: str | os.PathLike | None = None) -> tuple[Platform, ...]:
    """Returns the platforms that exported FMUs run on, with the libraries of this package or those of
    the folder `runtime`."""
    folder = None if runtime is None else path_argument("runtime", runtime)
    return tuple(Platform(*row) for row in _biela.platforms(folder))


def schema() -> dict[str, Any]:
    """Returns a JSON Schema (2020-12) of mechanism files.

    >>> schema()["$schema"]
    'https://json-schema.org/draft/2020-12/schema'
    """
    return json.loads(_biela.schema())
