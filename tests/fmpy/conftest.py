"""Fixtures of the FMPy tests; the tools behind them are in `harness.py`."""

from __future__ import annotations

import pytest
from harness import Fmu, Messages, Slave, export, mechanism_file

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10: pytest itself brings the same reader along
    import tomli as tomllib


def exporter(folder, version: int):
    """Exports and unpacks each mechanism once; tests that alter an FMU work on a copy."""
    exported: dict[str, Fmu] = {}

    def get(name: str) -> Fmu:
        if name not in exported:
            path = export(mechanism_file(name), folder / f"{name}.fmu", version=version)
            exported[name] = Fmu.unpack(path, folder / name)
        return exported[name]

    return get


@pytest.fixture(scope="session")
def fmu(tmp_path_factory):
    """`fmu(name)`: the FMU of a shipped mechanism, or of one in `tests/fmpy/mechanisms`."""
    return exporter(tmp_path_factory.mktemp("fmus"), 2)


@pytest.fixture(scope="session")
def fmu3(tmp_path_factory):
    """`fmu3(name)`: the same for FMI 3.0."""
    return exporter(tmp_path_factory.mktemp("fmus3"), 3)


@pytest.fixture(scope="session")
def mechanism_data():
    """`mechanism_data(name)`: a mechanism file as plain dictionaries."""
    return lambda name: tomllib.loads(mechanism_file(name).read_text(encoding="utf-8"))


@pytest.fixture
def slave(fmu):
    """`slave(name, …)`: a new instance, freed at the end of the test."""
    instances: list[Slave] = []

    def get(name_or_fmu: str | Fmu, **options) -> Slave:
        chosen = fmu(name_or_fmu) if isinstance(name_or_fmu, str) else name_or_fmu
        instances.append(Slave(chosen, **options))
        return instances[-1]

    yield get
    for instance in instances:
        instance.fmi.freeInstance()


@pytest.fixture
def messages():
    """Collects what `simulate` logs."""
    return Messages()
