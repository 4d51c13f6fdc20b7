"""Expressions of mechanism files, and the parameters that they use."""

from __future__ import annotations

import re
from functools import cache

from .digits import mp, number

CONSTANTS = {
    "pi": +mp.pi,
    "deg": mp.pi / 180,
    "rpm": mp.pi / 30,
    "mm": number("0.001"),
    "cm": number("0.01"),
    "inch": number("0.0254"),
}


def atan2(y, x):
    """Returns the angle of the point (x, y), an analytic function of its coordinates."""
    if abs(x.real) < abs(y.real):
        return mp.sign(y.real) * mp.pi / 2 - mp.atan(x / y)
    return mp.atan(y / x) + (mp.pi * (1 if y.real >= 0 else -1) if x.real < 0 else 0)


ANALYTIC = "sin cos tan asin acos atan sinh cosh tanh exp sqrt ln log10".split()
FUNCTIONS = {name: getattr(mp, name) for name in ANALYTIC} | {
    "atan2": atan2,
    "hypot": lambda x, y: mp.sqrt(x * x + y * y),
    "abs": lambda x: x if x.real >= 0 else -x,
    "sign": lambda x: mp.sign(x.real),
    "floor": lambda x: mp.floor(x.real),
    "ceil": lambda x: mp.ceil(x.real),
    "mod": lambda x, y: x - y * mp.floor((x / y).real),
    "max": lambda *values: max(values, key=lambda value: value.real),
    "min": lambda *values: min(values, key=lambda value: value.real),
}
"""Functions of real and complex numbers. Where a function has pieces, real parts decide."""

DECIMALS = re.compile(r"(?<![\w.])(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@cache
def _code(text: str):
    """Compiles an expression: its grammar is that of Python, but for `^` and exact decimals."""
    exact = DECIMALS.sub(r"_number('\g<0>')", text).replace("^", "**")
    return compile(exact, text, "eval")


def evaluate(value, names):
    """Returns the number that a number or an expression over `names` stands for."""
    if isinstance(value, str):
        return eval(_code(value), {"__builtins__": {}}, names)
    return mp.convert(value)


class Names(dict):
    """Values of constants, functions and parameters; a parameter is evaluated when it is read."""

    def __init__(self, parameters: dict, changed: dict):
        super().__init__(CONSTANTS | FUNCTIONS | {"_number": number} | changed)
        self._parameters = parameters

    def __missing__(self, name: str):
        entry = self._parameters[name]
        value = entry["value"] if isinstance(entry, dict) else entry
        self[name] = evaluate(value, self)
        return self[name]

    def function(self, expression: str, variable: str):
        """Returns an expression as a function of a variable that is no parameter."""

        def value(x):
            self[variable] = x
            return evaluate(expression, self)

        return value
