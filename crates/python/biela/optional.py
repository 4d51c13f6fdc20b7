"""Packages that some functions need and that are not installed with this one."""

from __future__ import annotations

import importlib
from types import ModuleType

from .errors import MissingPackageError


def needed(module: str, by: str) -> ModuleType:
    """Returns a module of an optional package, which `by` needs.

    >>> needed("numpy", "sweep").__name__
    'numpy'
    """
    package = module.partition(".")[0]
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        # A package that lacks one of its own tells so itself.
        if error.name is None or error.name.partition(".")[0] != package:
            raise
        text = f"{by} needs the package {package}: pip install {package}"
        raise MissingPackageError(text, name=package) from None
