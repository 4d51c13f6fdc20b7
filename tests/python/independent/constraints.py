"""Equations of joints and coordinates, written down from docs/constraints.md."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from .digits import mp, whole_turns
from .frames import Frame, Vector, direction


class Entry(NamedTuple):
    """Joint, constraint, driver or measure with its markers where they stand; a coupling has none,
    and ground in their place."""

    keys: dict
    """Keys of the entry in the file."""
    i: Frame
    j: Frame
    axes: Frame
    """Marker on whose axes `x` and `y` are measured: i, if the file names none."""
    carrier: Frame
    """Body on which two wheels have their pivots."""
    number: Callable[[Any], Any]
    """Evaluates a number or an expression with the parameters in force."""
    profile: Callable[[Any], Any] | None
    """Polar radius of a cam's contour."""
    contact: Any
    """Polar angle of the contact, an unknown of its own."""
    formula: Callable[[str], Any]
    """Evaluates an expression over parameters, coordinates by their names, and the own `law`."""
    curve: Callable[[Any], Any] | None = None
    """Point of a curve at a place from 0 to 1."""
    way: list = []
    """Points and centres over which a rope runs, with the radii there."""

    def __getitem__(self, key):
        return self.number(self.keys[key])


COORDINATES = {
    "angle": lambda at: at.j.angle - at.i.angle,
    "x": lambda at: (at.j.point - at.i.point).in_axes(at.axes.axis).x,
    "y": lambda at: (at.j.point - at.i.point).in_axes(at.axes.axis).y,
    "distance": lambda at: (at.j.point - at.i.point).length(),
}
"""Coordinates, measured from marker i to marker j."""


def coordinate(at: Entry):
    """Returns the coordinate that the entry names."""
    return COORDINATES[at.keys["coordinate"]](at)


def held(at: Entry):
    """Returns the residual of a coordinate at its value; an angle holds up to whole turns."""
    rest = coordinate(at) - at["value"]
    return rest - whole_turns(rest) if at.keys["coordinate"] == "angle" else rest


# Each of these returns the residuals of the rows of the joint that it is named after.


def revolute(at: Entry):
    return [*(at.j.point - at.i.point)]


def parallel(at: Entry):
    """Returns the residual of the angle between two markers, which holds up to whole turns."""
    angle = COORDINATES["angle"](at)
    return [angle - whole_turns(angle)]


def slot(at: Entry):
    return [COORDINATES["y"](at)]


def translational(at: Entry):
    return slot(at) + parallel(at)


def weld(at: Entry):
    return revolute(at) + parallel(at)


def link(at: Entry):
    return [COORDINATES["distance"](at) - at["length"]]


def revolute_translational(at: Entry):
    return [COORDINATES["y"](at) - at["offset"]]


def wheels(at: Entry, sign: int):
    """Returns the residual of two wheels whose ratio has this sign."""
    radius_i, radius_j = map(at.number, at.keys.get("radii") or at.keys["teeth"])
    ratio = sign * radius_i / radius_j
    return [(at.j.angle - at.carrier.angle) - ratio * (at.i.angle - at.carrier.angle)]


def gear(at: Entry):
    return wheels(at, 1 if at.keys.get("internal") else -1)


def belt(at: Entry):
    return wheels(at, -1 if at.keys.get("crossed") else 1)


def side(at: Entry):
    """Returns the sign of the side of the track on which the wheel i runs."""
    return {"above": 1, "below": -1}[at.keys.get("side", "above")]


def rack_and_pinion(at: Entry):
    travel = at.j.local(at.i.point).x
    return [travel + side(at) * at["radius"] * (at.i.angle - at.j.angle)]


def rolling(at: Entry):
    height = at.j.local(at.i.point).y
    return rack_and_pinion(at) + [side(at) * height - at["radius"]]


def coupling(at: Entry):
    left, right = map(at.formula, at.keys["equation"].split("="))
    return [left - right]


def cam(at: Entry):
    return FOLLOWERS[at.keys["follower"]](at)


def contour(at: Entry) -> Vector:
    """Returns the contact on the contour, on the axes of the cam's marker."""
    return direction(at.contact) * at.profile(at.contact)


def tangent(at: Entry) -> Vector:
    """Returns the contour's unit tangent at the contact, counter-clockwise."""
    outward = direction(at.contact)
    # The difference has twice the digits, so that all digits of the derivative hold.
    slope = mp.diff(at.profile, at.contact)
    along = outward * slope + outward.turned() * at.profile(at.contact)
    return along * (1 / along.length())


def knife(at: Entry):
    # The polar angle of the point is an unknown here, which saves the arctangent of the page.
    return [*(at.i.local(at.j.point) - contour(at))]


def roller(at: Entry):
    t = tangent(at)
    to_centre = at.i.local(at.j.point) - contour(at)
    normal = Vector(t.y, -t.x)
    return [t @ to_centre, normal @ to_centre - at["radius"]]


def flat(at: Entry):
    face = at.j.axis.in_axes(at.i.axis)
    to_contact = contour(at) - at.i.local(at.j.point)
    return [face.turned() @ tangent(at), face.turned() @ to_contact]


def curve(at: Entry):
    """The place on the curve is an unknown of its own, from 0 to 1 on closed curves too."""
    on = at.curve(at.contact)
    along = Vector(*(mp.diff(lambda s: at.curve(s)[axis], at.contact) for axis in (0, 1)))
    along *= 1 / along.length()
    on += along.turned() * at.number(at.keys.get("offset", 0))
    rows = [*(at.i.local(at.j.point) - on)]
    if at.keys.get("follow"):
        rows.append(along.turned() @ at.j.axis.in_axes(at.i.axis))
    return rows


def rope(at: Entry):
    """The ends of a leg lie on the two circles, in the direction in which both have one normal."""
    parts = [at.number(part) for part in at.keys.get("parts", [1] * (len(at.way) - 1))]
    length, before = mp.zero, None
    for part, (p, r), (q, s) in zip(parts, at.way, at.way[1:]):
        along = (q - p) * (1 / (q - p).length())
        cosine = (s - r) / (q - p).length()
        # Towards the side on which pulleys are on the left.
        normal = along * cosine + along.turned() * mp.sqrt(1 - cosine**2)
        length += part * ((q - normal * s) - (p - normal * r)).length()
        if r:
            side = 1 if mp.re(r) > 0 else -1
            turn = mp.acos(before @ normal)
            turns_back = mp.re(before.turned() @ normal) * side < 0
            length += part * side * r * (2 * mp.pi - turn if turns_back else turn)
        before = normal
    return [length - at["length"]]


def gap(at: Entry):
    """Returns the distance from the contact on the contour to the follower's face or point, or from a
    place on a curve to the point."""
    if at.curve:
        return (at.i.local(at.j.point) - at.curve(at.contact)).length()
    to_contact = contour(at) - at.i.local(at.j.point)
    if at.keys["follower"] == "flat":
        return abs(to_contact.in_axes(at.j.axis.in_axes(at.i.axis)).y)
    return to_contact.length()


FOLLOWERS = {"knife": knife, "roller": roller, "flat": flat}
"""Residuals of each kind of follower."""
JOINTS = {
    function.__name__: function
    for function in (
        revolute, translational, slot, link, revolute_translational, weld,
        gear, belt, rack_and_pinion, rolling, coupling, cam, rope, curve,
    )
}  # fmt: skip
"""Residuals of each type of joint."""
