"""Folders and commands that the tests of platforms share."""

import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
LIBRARIES = ROOT / "target" / "runtimes"
WORK = ROOT / "target" / "platforms"
# A folder such as users have.
FOLDER = WORK / "Prüfstand 模型 1"
# Sines and powers come from each system's own library, which differ in the last bit; a mechanism
# multiplies that by the condition of its equations.
LARGEST_DIFFERENCE = 1e-11


class Failure(Exception):
    """A platform that does not do what it should."""


def expect(condition, message):
    if not condition:
        raise Failure(message)


def run(*command, **options):
    done = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, encoding="utf-8", errors="replace", **options
    )
    expect(done.returncode == 0, f"{command[0]} ends with {done.returncode}: {done.stderr[-2000:]}{done.stdout[-500:]}")
    return done.stdout


def environment():
    return {
        **os.environ,
        "WINEPREFIX": str(WORK / "wine"),
        "WINEDEBUG": "-all",
        "WINEDLLOVERRIDES": "mscoree,mshtml=",
        "DISPLAY": "",
    }


def headers():
    text = (ROOT / ".cargo/config.toml").read_text(encoding="utf-8")
    return ROOT / re.search(r'BIELA_FMI_HEADERS = \{ value = "(.*?)"', text)[1]


@dataclass
class Difference:
    """Returns the largest difference of two runs, relative to the usual size of each column."""

    numbers: int = 0
    equal: int = 0
    largest: float = 0.0

    def add(self, ours, reference):
        columns = [sorted(map(abs, column)) for column in zip(*reference)]
        scales = [column[len(column) // 2] or column[-1] or 1.0 for column in columns]
        for row, expected in zip(ours, reference, strict=True):
            for a, b, scale in zip(row, expected, scales, strict=True):
                self.numbers += 1
                self.equal += a == b
                self.largest = max(self.largest, abs(a - b) / scale)

    def check(self, name):
        expect(self.largest <= LARGEST_DIFFERENCE, f"{name}: numbers differ by {self.largest}")

    def __str__(self):
        if self.equal == self.numbers:
            return "identical"
        return f"{100 * self.equal / self.numbers:.1f} % identical, others within {self.largest:.0e}"
