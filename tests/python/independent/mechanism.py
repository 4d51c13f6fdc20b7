"""Mechanism as its file says it: residuals and positions as functions of coordinates and time."""

from __future__ import annotations

from collections import ChainMap
from pathlib import Path

try:
    import tomllib
except ModuleNotFoundError:
    import tomli as tomllib

from . import tables
from .constraints import JOINTS, Entry, coordinate, held
from .digits import mp, number
from .expressions import Names, evaluate
from .frames import GROUND, Frame, Vector, frame


def coordinates(file: dict) -> dict:
    """Returns the entries that are coordinates of markers with names: of drivers, freedoms and measures."""
    named = {**moving(file), **file.get("measures", {})}
    return {
        name: entry
        for name, entry in named.items()
        if entry.get("coordinate", "clearance") != "clearance"
    }


def moving(file: dict) -> dict:
    """Returns the coordinates that are driven, freedoms among them: the tests drive these too."""
    return {**file.get("drivers", {}), **file.get("freedoms", {})}


class Mechanism:
    """Mechanism file with numbers for its parameters; those in `changed` replace the file's."""

    def __init__(self, text: str, folder: Path, changed: dict | None = None):
        self.file = file = tomllib.loads(text, parse_float=number)
        self.names = Names(file.get("parameters", {}), changed or {})
        self.bodies = list(file["bodies"])
        self.markers = {
            f"{body}.{name}": (body, self._marker(marker))
            for body, entry in {"ground": file.get("ground", {}), **file["bodies"]}.items()
            for name, marker in entry.get("markers", {}).items()
        }
        self.joints = list(file.get("joints", {}).values())
        self.profiles = {
            place: tables.profile(joint["profile"], self.names, folder)
            for place, joint in enumerate(self.joints)
            if joint["type"] == "cam"
        }
        self.laws = {
            place: tables.motion(joint["law"], self.names, folder, "x")
            for place, joint in enumerate(self.joints)
            if joint["type"] == "coupling" and "law" in joint
        }
        self.curves = {
            place: tables.curve(joint, self.names, folder)
            for place, joint in enumerate(self.joints)
            if joint["type"] == "curve"
        }
        self.motions = {
            name: tables.motion(driver["motion"], self.names, folder)
            for name, driver in moving(file).items()
            if "motion" in driver
        }

    def number(self, value):
        """Returns the number that a number or an expression stands for."""
        return evaluate(value, self.names)

    def _marker(self, marker) -> Frame:
        """Returns a marker in the frame of its body."""
        if isinstance(marker, dict):
            at = frame(mp.zero, mp.zero, self.number(marker["angle"]))
            return Frame(at.axis * self.number(marker["r"]), mp.zero, GROUND.axis)
        return frame(*map(self.number, [*marker, 0][:3]))

    def place(self, q) -> Placed:
        """Returns the mechanism with its bodies where the coordinates say."""
        return Placed(self, q)


class Placed:
    """Mechanism in a pose: x, y, phi of each body in turn, then the places of contacts."""

    def __init__(self, mechanism: Mechanism, q):
        self.mechanism = mechanism
        self.bodies = {"ground": GROUND}
        for place, body in enumerate(mechanism.bodies):
            self.bodies[body] = frame(*q[3 * place : 3 * place + 3])
        # A contact's place that is not known yet is left out.
        contacts = sorted([*mechanism.profiles, *mechanism.curves])
        self.contacts = dict(zip(contacts, q[3 * len(mechanism.bodies) :]))

    def frame(self, marker: str) -> Frame:
        """Returns where a marker stands."""
        body, at = self.mechanism.markers[marker]
        return self.bodies[body].place(at)

    def entry(self, keys: dict, place: int | None = None) -> Entry:
        """Returns an entry of the file in this pose; joints have a place among the joints."""
        ends = [keys["markers"][end] for end in (0, -1)] if "markers" in keys else []
        i, j = map(self.frame, ends) if ends else (GROUND, GROUND)
        return Entry(
            keys,
            i,
            j,
            self.frame(keys["axes"]) if "axes" in keys else i,
            self.bodies[keys.get("carrier", "ground")],
            self.mechanism.number,
            self.mechanism.profiles.get(place),
            self.contacts.get(place),
            lambda text: evaluate(text.strip(), self.names(place)),
            self.mechanism.curves.get(place),
            [self.over(at) for at in keys["markers"]] if keys.get("type") == "rope" else [],
        )

    def names(self, place: int | None) -> ChainMap:
        """Returns the names in the equation of a joint: coordinates, its law, and all others."""
        file = self.mechanism.file
        named = {name: coordinate(self.entry(keys)) for name, keys in coordinates(file).items()}
        return ChainMap(named, {"law": self.mechanism.laws.get(place)}, self.mechanism.names)

    def over(self, at):
        """Returns the point or centre over which a rope runs, and the radius there, negative for a
        pulley on the right."""
        if isinstance(at, str):
            return self.frame(at).point, mp.zero
        side = {"left": 1, "right": -1}[at["side"]]
        return self.frame(at["marker"]).point, side * self.mechanism.number(at["radius"])

    def residual(self, driven: dict) -> list:
        """Returns the residuals of all equations for these values of the drivers."""
        file, rows = self.mechanism.file, []
        for place, joint in enumerate(self.mechanism.joints):
            rows += JOINTS[joint["type"]](self.entry(joint, place))
        for constraint in file.get("constraints", {}).values():
            rows.append(held(self.entry(constraint)))
        for name, driver in moving(file).items():
            rows.append(coordinate(self.entry(driver)) - driven[name])
        return rows

    def positions(self) -> dict:
        """Returns all positions among the variables, by their names."""
        file, found = self.mechanism.file, {}
        outputs = file.get("outputs", {})
        for body in outputs.get("bodies", self.mechanism.bodies):
            point, angle, _ = self.bodies[body]
            found |= {f"{body}.x": point.x, f"{body}.y": point.y, f"{body}.phi": angle}
        for marker in outputs.get("markers", []):
            point = self.frame(marker).point
            found |= {f"{marker}.x": point.x, f"{marker}.y": point.y}
        for name, entry in coordinates(file).items():
            found[f"{name}.position"] = coordinate(self.entry(entry))
        return found
