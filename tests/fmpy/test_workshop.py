"""Drawings for the workshop, opened and measured by ezdxf."""

import math

import ezdxf
import pytest
from harness import ROOT, SHIPPED, run_biela

TOLERANCE = 1e-3
"""Of arcs from contours, as docs/commands.md states [mm]."""


@pytest.fixture(scope="module")
def drawing(tmp_path_factory):
    """Returns the drawing of a shipped mechanism, as ezdxf reads it."""
    folder = tmp_path_factory.mktemp("drawings")

    def draw(name, *options):
        path = folder / f"{name}.dxf"
        done = run_biela("draw", ROOT / "mechanisms" / f"{name}.toml", "-o", path, *options)
        assert done.returncode == 0, done.stderr
        return ezdxf.readfile(path)

    return draw


@pytest.mark.parametrize("name", SHIPPED)
def test_every_drawing_opens_without_errors(drawing, name):
    document = drawing(name)
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    assert document.dxfversion == "AC1009"
    assert document.header["$INSUNITS"] == 4
    assert len(document.modelspace()) > 2


def ends(entity):
    return [(p.x, p.y) for p in (entity.dxf.start, entity.dxf.end)]


def of_layer(document, kind, layer):
    return [e for e in document.modelspace().query(kind) if e.dxf.layer == layer]


def test_lengths_are_those_of_the_mechanism(drawing):
    document = drawing("four_bar")
    for layer, length in (("crank", 100), ("rocker", 300)):
        [bar] = of_layer(document, "LINE", layer)
        assert math.dist(*ends(bar)) == pytest.approx(length, abs=1e-6)
    [plate] = of_layer(document, "POLYLINE", "coupler")
    corners = [(v.dxf.location.x, v.dxf.location.y) for v in plate.vertices]
    sides = sorted(math.dist(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True))
    # P is 125 along and 50 across the coupler of 250.
    assert sides == pytest.approx([math.hypot(125, 50)] * 2 + [250], abs=1e-6)
    assert plate.is_closed
    # Each pin is a circle on the layers of both bodies.
    pins = {e.dxf.layer: [] for e in document.modelspace().query("CIRCLE")}
    for circle in document.modelspace().query("CIRCLE"):
        pins[circle.dxf.layer].append((round(circle.dxf.center.x, 6), round(circle.dxf.center.y, 6)))
    assert set(pins["crank"]) & set(pins["coupler"]) == {(50.0, 86.60254)}
    assert {(0.0, 0.0), (400.0, 0.0)} == set(pins["ground"])
    assert {e.dxf.text for e in document.modelspace().query("TEXT")} == {"O2", "A", "B", "O4", "P"}


def arcs(polyline):
    """Centre, radius, start and signed sweep of each arc of a closed polyline."""
    points = [(v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0)) for v in polyline.vertices]
    for (x0, y0, bulge), (x1, y1, _) in zip(points, points[1:] + points[:1], strict=True):
        assert bulge != 0
        sweep = 4 * math.atan(bulge)
        # The centre is left of the chord's middle, by its half over the tangent of half the sweep.
        aside = 1 / (2 * math.tan(sweep / 2))
        cx = (x0 + x1) / 2 - (y1 - y0) * aside
        cy = (y0 + y1) / 2 + (x1 - x0) * aside
        yield (cx, cy), math.hypot(x0 - cx, y0 - cy), math.atan2(y0 - cy, x0 - cx), sweep


def height(polyline, turn, x):
    """Greatest y at which a contour that is turned about the origin has this x."""
    found = []
    for (cx, cy), radius, start, sweep in arcs(polyline):
        ux = cx * math.cos(turn) - cy * math.sin(turn)
        uy = cx * math.sin(turn) + cy * math.cos(turn)
        if abs(x - ux) > radius:
            continue
        for side in (1, -1):
            y = uy + side * math.sqrt(radius**2 - (x - ux) ** 2)
            way = (math.atan2(y - uy, x - ux) - start - turn) * math.copysign(1, sweep)
            if way % math.tau <= abs(sweep) + 1e-9:
                found.append(y)
    return max(found)


ANGLES = [math.radians(angle) for angle in range(0, 360, 7)]


def test_a_knife_on_the_contour_as_cut_moves_as_the_file_says(drawing):
    [contour] = of_layer(drawing("cam_knife"), "POLYLINE", "cam_contour")
    for angle in ANGLES:
        # base + lift/2·(1 − cos θ) where the contour is above the axle; drawn at 30°.
        exact = 30 + 10 * (1 - math.cos(math.pi / 2 - angle))
        cut = height(contour, angle - math.radians(30), 0)
        # The pressure angle is below atan(10/30).
        assert cut == pytest.approx(exact, abs=TOLERANCE * math.hypot(1, 1 / 3))


def test_a_roller_on_the_pitch_curve_as_cut_moves_as_the_file_says(drawing):
    document = drawing("cam_roller")
    [pitch] = of_layer(document, "POLYLINE", "cam_pitch")
    text = (ROOT / "mechanisms" / "cam_roller.toml").read_text(encoding="utf-8")
    [eccentricity] = [
        1000 * float(line.partition("value =")[2].partition(",")[0])
        for line in text.splitlines()
        if line.startswith("eccentricity")
    ]
    for angle in ANGLES:
        # On a circle of 40 + 10 about the disc's centre, 8 beside the axle; drawn at 60°.
        aside = 8 - eccentricity * math.cos(angle)
        exact = eccentricity * math.sin(angle) + math.sqrt(50**2 - aside**2)
        cut = height(pitch, angle - math.radians(60), 8)
        assert cut == pytest.approx(exact, abs=2 * TOLERANCE)
    # The groove's sides are a roller's radius on either side.
    for layer, radius in (("cam_contour", 40), ("cam_outer", 60)):
        [side] = of_layer(document, "POLYLINE", layer)
        assert all(r == pytest.approx(radius, abs=1e-3) for _, r, _, _ in arcs(side))


def test_a_spline_through_points_is_cut_with_few_arcs(drawing):
    [contour] = of_layer(drawing("cam_points"), "POLYLINE", "cam_contour")
    assert contour.is_closed
    assert 32 < len(contour) < 1000
    length = sum(radius * abs(sweep) for _, radius, _, sweep in arcs(contour))
    # Longer than the circle of the least radius, and no polygon.
    assert length > math.tau * min(math.hypot(v.dxf.location.x, v.dxf.location.y) for v in contour.vertices)


def test_a_drawing_comes_back_as_the_mechanism(tmp_path):
    """Pins, points and slides of a drawing make the same mechanism again."""
    for name in ("four_bar", "slider_crank", "jansen_leg"):
        dxf, toml = tmp_path / f"{name}.dxf", tmp_path / f"{name}.toml"
        assert run_biela("draw", ROOT / "mechanisms" / f"{name}.toml", "-o", dxf).returncode == 0
        done = run_biela("import", dxf, "-o", toml)
        assert done.returncode == 0, done.stderr
        checked = run_biela("check", toml)
        assert checked.returncode == 0, checked.stdout + checked.stderr
        assert "degrees of freedom     1" in checked.stdout
