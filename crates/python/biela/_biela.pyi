"""Compiled part of the package. Arrays are flat; the package gives them shapes and names."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

_Drive = tuple[str, str | Sequence[Any]]
_Motions = tuple[Any, Sequence[_Drive]]
_Values = Sequence[tuple[str, float | str]]
_Problem = tuple[str, str, str, str | None, tuple[int, int] | None]
_EndRow = tuple[str, float | None, str, int | None]
_Floats = NDArray[np.float64]
_Places = NDArray[np.uintp]
_Named = tuple[str, str, str, str]
_Held = tuple[str, float, str]
_Extreme = tuple[float, float]
_Told = tuple[str, list[str]]
_Events = tuple[_Places, _Floats, _Places, _Places, _Floats]

def program(arguments: Sequence[str]) -> int: ...
def shipped() -> list[str]: ...
def new(name: str, template: str, folder: str) -> str: ...
def import_mechanism(file: str, length: str | None) -> tuple[str, str, list[str]]: ...
def platforms(runtime: str | None) -> list[tuple[str, str, str | None, str | None]]: ...
def schema() -> str: ...
def shipped_text(name: str) -> str: ...
def unknown_name(kind: str, name: str, known: Sequence[str]) -> str: ...

class Mechanism:
    def __init__(
        self,
        name: str,
        text: str | None = None,
        path: str | None = None,
        shipped: str | None = None,
    ) -> None: ...
    @staticmethod
    def check(
        name: str, text: str | None = None, path: str | None = None, modes: bool = False
    ) -> str: ...
    def report(self, modes: bool) -> str: ...
    @property
    def has_tables(self) -> bool: ...
    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def warnings(self) -> list[_Problem]: ...
    @property
    def warnings_text(self) -> str: ...
    @property
    def parameters(
        self,
    ) -> list[
        tuple[str, str, float, str, float | None, float | None, float | None, bool]
    ]: ...
    @property
    def drivers(
        self,
    ) -> list[
        tuple[str, str, str, float | None, float | None, float | None, bool, float | None]
    ]: ...
    @property
    def inputs(self) -> list[tuple[str, str, str, float, float | None, float | None]]: ...
    @property
    def forces(self) -> list[_Named]: ...
    @property
    def measures(self) -> list[_Named]: ...
    @property
    def force_names(self) -> list[str]: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def columns(self) -> list[tuple[str, str]]: ...
    def values(self, set: _Values) -> list[tuple[str, float]]: ...
    @property
    def simulation(self) -> tuple[float, float, float]: ...
    def run(
        self,
        motions: _Motions,
        parameters: _Values,
        columns: Sequence[int],
        by: Sequence[str],
        film: bool,
    ) -> Run: ...
    def sweep(
        self,
        motions: _Motions,
        parameters: _Values,
        swept: tuple[Sequence[tuple[str, Any]], Sequence[tuple[str, Sequence[Any]]]],
        variants: int,
        columns: Sequence[int],
    ) -> Sweep: ...
    def targets(
        self,
        motions: _Motions,
        targets: Sequence[
            tuple[int, tuple[str, bool] | None, Sequence[int], Sequence[float], float]
        ],
        free: Sequence[str],
        turns: str | None,
    ) -> Targets: ...
    def fitted(self, attempt: Attempt, names: Sequence[str]) -> str: ...
    def range(
        self,
        driver: str,
        motions: _Motions,
        parameters: _Values,
        bounds: Sequence[float | str | None],
        speed: float | None,
    ) -> tuple[
        _EndRow,
        _EndRow,
        list[tuple[float, list[str], str]],
        _Floats,
        _Floats,
        _Floats,
        _Floats,
        _Floats,
        list[tuple[str, list[_Extreme] | None]],
        tuple[_Extreme | None, tuple[_Extreme, str | None] | None, str | None],
    ]: ...
    def modes(
        self, motions: _Motions, parameters: _Values
    ) -> tuple[list[tuple[list[float], float]], bool]: ...
    def linearize(
        self, motions: _Motions, parameters: _Values, columns: Sequence[int], balance: bool
    ) -> tuple[
        list[float],
        list[float],
        list[str],
        list[str],
        list[list[float]],
        list[_Held],
    ]: ...
    def balance(
        self, motions: _Motions, parameters: _Values, all: bool
    ) -> list[tuple[list[float], list[float], list[_Held], list[str]]]: ...
    def draw(
        self,
        motions: _Motions,
        parameters: _Values,
        contents: tuple[bool, int, str | None, bool, bool, bool],
        bounds: Sequence[float | str | None],
        picture: tuple[str | None, int | None, bool],
    ) -> tuple[str, Sequence[int] | None, list[str]]: ...
    def convert(self, to: str, motions: _Motions, parameters: _Values) -> _Told: ...
    def page_of_report(self, motions: _Motions, parameters: _Values) -> _Told: ...
    def page(
        self, path: str, share: str | None, solver: str | None, studio: str | None
    ) -> list[tuple[str, str]]: ...
    def edited(
        self, motions: _Motions, parameters: _Values, estimates: Sequence[float] | None
    ) -> str: ...
    def fmu(
        self,
        fmi: str,
        options: Sequence[bool],
        runtime: str | None,
        platforms: Sequence[str],
    ) -> Sequence[int]: ...
    def model_description(self, fmi: str) -> Sequence[int]: ...

class Run:
    rows: int
    stop: str | None
    notices: list[str]
    def take_values(self) -> _Floats: ...
    def take_gradient(self) -> _Floats: ...
    def events(self) -> _Events: ...
    @property
    def has_forces(self) -> bool: ...
    def page(self, forces: bool) -> str | None: ...

class Sweep:
    rows: list[int]
    reasons: list[tuple[int, str]]
    def take_values(self) -> _Floats: ...
    def events(self) -> _Events: ...

class Targets:
    def costs(self, values: Any) -> list[tuple[int, int, float]]: ...
    def attempts(self, values: Any, modes: Sequence[int]) -> list[Attempt]: ...
    def attempt(self, values: Sequence[float]) -> Attempt: ...

class Attempt:
    start: list[float]
    def go(
        self, unknowns: Sequence[float], nearest: bool
    ) -> tuple[_Floats, list[int | None], list[float], _Floats] | None: ...
    def keep(self) -> _Floats | None: ...
