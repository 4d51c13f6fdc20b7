"""CoreXY: sum and difference of the motors' angles; the tool goes round an ellipse."""

from __future__ import annotations

from . import Case, one_turn
from .plane import body, point

WIDTH, LENGTH, RADIUS = 0.220, 0.130, 0.020
CARRIAGE, GANTRY, ROTOR = 0.450, 0.900, 5e-5


def truth(_time, drivers):
    a, b = drivers["motor_a"], drivers["motor_b"]
    x, y = RADIUS / 2 * (a + b), RADIUS / 2 * (a - b)
    tool = x + 1j * y
    return (
        body("rotor_a", -WIDTH / 2 + 1j * LENGTH, a)
        | body("rotor_b", WIDTH / 2 + 1j * LENGTH, b)
        | body("gantry", 1j * y - WIDTH / 2, 0)
        | body("carriage", tool, 0)
        | point("carriage.tool", tool)
        | {"x": x, "y": y}
    )


def drivers(time):
    """An ellipse of the tool, from rest to rest."""
    turn = one_turn(0.3)(time)
    x, y = 0.06 * turn.cos(), 0.045 * turn.sin()
    return {"motor_a": (x + y) / RADIUS, "motor_b": (x - y) / RADIUS}


def properties(motion):
    """Newton's law along x and y gives the pulls of the belts, these the torques."""
    a, b = motion["motor_a.acceleration"], motion["motor_b.acceleration"]
    along_x = CARRIAGE * RADIUS / 2 * (a + b)
    along_y = (CARRIAGE + GANTRY) * RADIUS / 2 * (a - b)
    pull_a, pull_b = (along_x + along_y) / 2, (along_x - along_y) / 2
    largest = abs(along_x).max() + abs(along_y).max()
    return {
        "belt a": (motion["belt_a.effort"] + pull_a) / largest,
        "belt a along x": (motion["belt_a.x.effort"] - pull_a) / largest,
        "belt a along y": (motion["belt_a.y.effort"] - pull_a) / largest,
        "belt b": (motion["belt_b.effort"] + pull_b) / largest,
        "belt b along x": (motion["belt_b.x.effort"] - pull_b) / largest,
        "belt b along y": (motion["belt_b.y.effort"] + pull_b) / largest,
        "motor a": (motion["motor_a.effort"] - ROTOR * a - RADIUS * pull_a) / (largest * RADIUS),
        "motor b": (motion["motor_b.effort"] - ROTOR * b - RADIUS * pull_b) / (largest * RADIUS),
    }


CASE = Case(
    source="closed form: sum and difference of two angles; Newton's law",
    drivers=drivers,
    truth=truth,
    properties=properties,
)
