"""The five mechanisms of the demo as cases: their closed forms are in `demo/closed_form.py`."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "demo"))

from closed_form import CLOSED_FORMS  # noqa: E402  (its folder has only just been added)
from motions import full_motion  # noqa: E402

from . import Case, Truth  # noqa: E402
from .taylor import Taylor  # noqa: E402

SOURCES = {
    "pendulum": "closed form: a turning vector",
    "slider_crank": "closed form: law of sines",
    "four_bar": "closed form: law of cosines",
    "tlv": "closed form: law of cosines",
    "tlv_crank": "closed form: polar coordinates",
}

#: Suffixes of a position and of its velocity and acceleration.
SUFFIXES = {
    "x": ("vx", "ax"),
    "y": ("vy", "ay"),
    "phi": ("omega", "alpha"),
    "position": ("velocity", "acceleration"),
}


def case(name: str) -> Case:
    """The case of one of the five."""
    form = CLOSED_FORMS[name]

    def truth(_time: Taylor, drivers: dict[str, Taylor]) -> Truth:
        u = drivers[form.driver]
        motion = form().motion(u.value, u.first, u.second)
        found = {}
        for output in motion:
            owner, _, suffix = output.rpartition(".")
            if suffix in SUFFIXES:
                first, second = (motion[f"{owner}.{rate}"] for rate in SUFFIXES[suffix])
                found[output.removesuffix(".position")] = Taylor(motion[output], first, second)
        return found

    return Case(
        source=SOURCES[name],
        drivers=lambda time: {form.driver: Taylor(*full_motion(name, time.value, duration=2.0))},
        truth=truth,
    )


def cases() -> dict[str, Case]:
    """The five cases by name."""
    return {name: case(name) for name in CLOSED_FORMS}
