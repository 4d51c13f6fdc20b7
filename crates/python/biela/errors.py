"""Exceptions of biela. Their texts are those of the command line."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass


class Error(Exception):
    """Base of all exceptions of this package."""


class UsageError(Error, ValueError):
    """Exception for a wrong argument: an unknown name, a value beyond its limits."""


class UnknownNameError(UsageError, KeyError):
    """Exception for a name that a result does not have; also a `KeyError`, as of any mapping."""

    # A `KeyError` shows its text in quotes.
    __str__ = Exception.__str__


class MissingPackageError(ImportError, UsageError):
    """Exception for an optional package that is not installed; also an `ImportError`."""


class FileError(Error, OSError):
    """Exception for a file that cannot be read, or an FMU that cannot be made."""


class MissingFileError(FileError, FileNotFoundError):
    """Exception for a mechanism file that does not exist; also a `FileNotFoundError`."""


class AssemblyError(Error):
    """Exception for a mechanism that does not close, or whose drivers do not fit."""


@dataclass(frozen=True)
class Diagnostic:
    """Problem of a mechanism file."""

    severity: str
    """`error` or `warning`."""
    code: str
    """Kind of the problem, such as `unknown-body`."""
    message: str
    """Description of the problem."""
    help: str | None
    """Correction, if one is known."""
    line: int | None
    """Line of the problem, from 1."""
    column: int | None
    """Column of the problem in characters, from 1."""


def diagnostics(rows) -> tuple[Diagnostic, ...]:
    """Returns rows of the compiled module as diagnostics."""
    return tuple(
        Diagnostic(severity, code, message, help, *(place or (None, None)))
        for severity, code, message, help, place in rows
    )


class MechanismError(Error):
    """Exception for a file with errors; its text shows each at its line.

    >>> import biela
    >>> try:
    ...     biela.loads('format = 1')
    ... except biela.MechanismError as error:
    ...     [problem.code for problem in error.diagnostics]
    ['missing-key', 'no-bodies']
    """

    def __init__(self, text: str, rows=()):
        super().__init__(text)
        self.diagnostics = diagnostics(rows)

    def __reduce__(self):
        rows = [(d.severity, d.code, d.message, d.help, (d.line, d.column)) for d in self.diagnostics]
        return type(self), (self.args[0], rows)


class StoppedError(Error):
    """Exception for a motion that cannot go on, such as at a dead point.

    `result` has the rows up to there.
    """

    def __init__(self, text: str, result=None):
        super().__init__(text)
        self.result = result


class MechanismWarning(UserWarning):
    """Warning about a mechanism file, or about a run near a singular position."""


def warn(notices: Iterable[str]) -> None:
    """Warns of each, at the call of the function that calls this one."""
    for notice in notices:
        warnings.warn(notice, MechanismWarning, stacklevel=3)
