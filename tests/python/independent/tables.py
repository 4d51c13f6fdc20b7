"""Curves through the points of a table, repeated without end."""

from __future__ import annotations

import csv
from bisect import bisect_right

from .digits import mp
from .expressions import evaluate
from .frames import Vector


def polynomial_345(x):
    """Returns the rise of the polynomial 3-4-5, from 0 to 1 over x from 0 to 1."""
    return x**3 * (10 - 15 * x + 6 * x**2)


def modified_sine(x):
    """Returns the rise of the modified sine: quarters of a short sine join half of a long one."""
    if x.real < 0.125:
        start, share, sine = 0, 1, mp.sin(4 * mp.pi * x)
    elif x.real < 0.875:
        start, share, sine = 2, 9, mp.sin(4 * mp.pi * x / 3 + mp.pi / 3)
    else:
        start, share, sine = 4, 1, mp.sin(4 * mp.pi * x)
    return (start + mp.pi * x - share * sine / 4) / (4 + mp.pi)


LAWS = {"polynomial_345": polynomial_345, "modified_sine": modified_sine}


def by_law(points, law):
    """Returns a curve that comes to rest at each point."""

    def piece(place, x):
        (x0, y0), (x1, y1) = points[place : place + 2]
        return y0 + (y1 - y0) * law((x - x0) / (x1 - x0))

    return piece


def spline(points, natural=False):
    """Returns the periodic cubic spline, or the natural one, from the equations of its second
    derivatives."""
    count = len(points) - 1
    width = [points[k + 1][0] - points[k][0] for k in range(count)]
    slope = [(points[k + 1][1] - points[k][1]) / width[k] for k in range(count)]
    matrix, right = mp.zeros(count), mp.zeros(count, 1)
    for k in range(count):
        matrix[k, k - 1 if k else count - 1] += width[k - 1]
        matrix[k, k] += 2 * (width[k - 1] + width[k])
        matrix[k, (k + 1) % count] += width[k]
        right[k] = 6 * (slope[k] - slope[k - 1])
    if natural:
        inner = mp.lu_solve(matrix[1:, 1:], right[1:]) if count > 1 else []
        second = [mp.zero, *inner, mp.zero]
    else:
        second = list(mp.lu_solve(matrix, right))
        second.append(second[0])

    def piece(place, x):
        h, a, b = width[place], points[place + 1][0] - x, x - points[place][0]
        cubic = (second[place] * a**3 + second[place + 1] * b**3) / (6 * h)
        left = points[place][1] / h - second[place] * h / 6
        return cubic + left * a + (points[place + 1][1] / h - second[place + 1] * h / 6) * b

    return piece


def repeated(points, law: str):
    """Returns the curve through `points`; each period goes on from the one before."""
    piece = spline(points) if law == "spline" else by_law(points, LAWS[law])
    (begin, low), (end, high) = points[0], points[-1]
    borders = [x.real for x, _ in points[1:-1]]

    def curve(x):
        periods = mp.floor(((x - begin) / (end - begin)).real)
        x = x - periods * (end - begin)
        return piece(bisect_right(borders, x.real), x) + periods * (high - low)

    return curve


def read_points(table: dict, names, folder):
    """Returns the points of a table or of its CSV file, scaled."""
    if "file" in table:
        text = (folder / table["file"]).read_text(encoding="utf-8").splitlines()
        header, *rows = csv.reader(line for line in text if not line.startswith("#"))
        columns = [header.index(name) for name in table.get("columns", header[:2])]
        rows = [[row[column] for column in columns] for row in rows]
    else:
        rows = table["table"]
    scale = [evaluate(factor, names) for factor in table.get("scale", [1, 1])]
    return [[evaluate(x, names) * factor for x, factor in zip(row, scale)] for row in rows]


def motion(entry, names, folder, variable="t"):
    """Returns a prescribed motion as a function of time [s], or the law of a coupling in `x`."""
    if isinstance(entry, str):
        return names.function(entry, variable)
    if entry.get("ends") != "periodic":
        raise NotImplementedError(f"ends = {entry.get('ends')!r}")
    return repeated(read_points(entry, names, folder), entry.get("law", "spline"))


def curve(joint, names, folder):
    """Returns the point of a curve as a function of a place, from 0 at its first to 1 at its last point."""
    if "x" in joint:
        x, y = (names.function(str(joint[axis]), "s") for axis in "xy")
        begin, end = evaluate(joint.get("from", 0), names), evaluate(joint.get("to", 1), names)
        return lambda place: Vector(*(c(begin + (end - begin) * place) for c in (x, y)))
    points = joint["points"]
    points = read_points({"file": points} if isinstance(points, str) else points, names, folder)
    is_closed = joint.get("closed", False)
    if is_closed and points[0] != points[-1]:
        points.append(points[0])
    chords = [Vector(*b) - Vector(*a) for a, b in zip(points, points[1:])]
    knots = [mp.zero]
    for chord in chords:
        knots.append(knots[-1] + chord.length())
    knots = [knot / knots[-1] for knot in knots]
    pieces = [
        spline([[knot, point[axis]] for knot, point in zip(knots, points)], not is_closed)
        for axis in (0, 1)
    ]

    def on(place):
        if is_closed:
            place -= mp.floor(place.real)
        piece = bisect_right(knots[1:-1], place.real)
        return Vector(*(component(piece, place) for component in pieces))

    return on


def profile(entry, names, folder):
    """Returns the polar radius of a contour [m] as a function of the polar angle [rad]."""
    if isinstance(entry, str):
        return names.function(entry, "theta")
    points = read_points(entry, names, folder)
    turn = points[0][0] + 2 * mp.pi
    if turn - points[-1][0] > mp.mpf("1e-9"):
        points.append([turn, points[0][1]])
    return repeated(points, entry.get("law", "spline"))
