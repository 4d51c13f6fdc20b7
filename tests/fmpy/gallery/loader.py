"""Loader: the law of cosines in each cylinder's triangle, then a circle intersection."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import apex, body, point
from .taylor import Taylor

ARM, ROD, TOP, BOTTOM = 2.40, 1.05, 0.60, 0.55
LIFT_FOOT, TILT_FOOT = 0.05 - 0.80j, 0.05 + 0.45j
LIFT_LUG, BELL = 0.95 - 0.15j, 1.30 + 0.30j
EAR, EDGE = -0.05 + 0.34j, 0.95 - 0.05j
ARM_MASS, ARM_CENTER, ARM_INERTIA = 900.0, 1.20 + 0.05j, 450.0
BUCKET_MASS, BUCKET_CENTER, BUCKET_INERTIA = 700.0, 0.40 + 0.15j, 160.0
G = 9.81


def geometry(lift, tilt):
    """Angles of arm, bell crank and bucket; pivot of the bell crank and pin of the bucket."""
    a, b = abs(LIFT_FOOT), abs(LIFT_LUG)
    opening = ((a**2 + b**2 - lift.square()) / (2 * a * b)).acos()
    arm = np.angle(LIFT_FOOT / LIFT_LUG) + opening
    turn = Taylor.polar(1, arm)
    pivot, pin = turn * BELL, turn * ARM
    foot = TILT_FOOT - pivot
    at_pivot = (foot.length_squared() + TOP**2 - tilt.square()) / (2 * TOP * foot.length())
    bell = foot.angle() - at_pivot.acos()
    bottom = pivot - Taylor.polar(BOTTOM, bell)
    ear = apex(bottom, pin, ROD, abs(EAR), +1)
    return arm, bell, ((ear - pin) / EAR).angle(), pivot, pin


def truth(_time, drivers):
    arm, bell, bucket, pivot, pin = geometry(drivers["lift"], drivers["tilt"])
    edge = pin + Taylor.polar(1, bucket) * EDGE
    return (
        body("arm", 0, arm)
        | body("bell_crank", pivot, bell)
        | body("bucket", pin, bucket)
        | point("bucket.edge", edge)
        | {"height": edge.y, "level": bucket}
    )


def properties(motion):
    """Virtual work of the weights and the inertia, one cylinder moving at a time."""
    lift, tilt = motion["lift.position"], motion["tilt.position"]
    efforts = {}
    for name, moving in (
        ("lift", geometry(Taylor.time(lift), Taylor.of(tilt))),
        ("tilt", geometry(Taylor.of(lift), Taylor.time(tilt))),
    ):
        arm, _, bucket, _, pin = moving
        work = 0.0
        for body_name, origin, phi, mass, center, inertia in (
            ("arm", Taylor.of(0j * lift), arm, ARM_MASS, ARM_CENTER, ARM_INERTIA),
            ("bucket", pin, bucket, BUCKET_MASS, BUCKET_CENTER, BUCKET_INERTIA),
        ):
            centre = origin + Taylor.polar(1, phi) * center
            # The acceleration of the centre, from those of the body that the truth has checked.
            alpha, omega = motion[f"{body_name}.alpha"], motion[f"{body_name}.omega"]
            arm_of_centre = np.exp(1j * motion[f"{body_name}.phi"]) * center
            acceleration = motion[f"{body_name}.ax"] + 1j * motion[f"{body_name}.ay"]
            acceleration = acceleration + (1j * alpha - omega**2) * arm_of_centre
            needed = mass * (acceleration + 1j * G)
            work = work + (np.conj(centre.first) * needed).real + inertia * alpha * phi.first
        efforts[name] = work
    largest = max(np.max(np.abs(effort)) for effort in efforts.values())
    return {
        f"effort of {name}": (motion[f"{name}.effort"] - effort) / largest
        for name, effort in efforts.items()
    }


CASE = Case(
    source="closed form: law of cosines in each triangle, one dyad; virtual work",
    drivers=lambda time: {
        "lift": swing(1.20, 0.24)(time),
        "tilt": swing(1.20, 0.14)(2 * time),
    },
    truth=truth,
    properties=properties,
)
