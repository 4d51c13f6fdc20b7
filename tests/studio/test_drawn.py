"""Mechanisms drawn from an empty sheet by mouse and keys, exported from the page, and run in FMPy
against their closed forms, with the lengths of the file that came out."""

import math

import numpy as np
import pytest
from fmpy import simulate_fmu

# All equations are solved to rounding; numbers are of the size of one.
EXACT = 1e-9


def final(fmu, **inputs):
    """Runs the FMU to inputs reached on straight lines; returns its outputs there."""
    start = {name: pair[0] for name, pair in inputs.items()}
    columns = [("time", np.float64)] + [(f"{name}.position", np.float64) for name in inputs]
    end = [pair[1] for pair in inputs.values()]
    # The last steps hold the inputs: outputs follow them at the end of a step.
    rows = [(0.0, *start.values()), (0.5, *end), (1.0, *end)]
    signals = np.array(rows, dtype=columns)
    result = simulate_fmu(str(fmu), stop_time=1.0, step_size=0.05, output_interval=0.05, input=signals)
    return {name: float(result[name][-1]) for name in result.dtype.names}


def degrees(value):
    """Reads an angle of the file [rad]."""
    if isinstance(value, str):
        number, unit = value.split("*")
        assert unit == "deg"
        return math.radians(float(number))
    return float(value)


def length(file, body):
    """Distance of the two markers of a bar."""
    (a, b) = (file["bodies"][body]["markers"][name] for name in list(file["bodies"][body]["markers"])[:2])
    return math.dist(a[:2], b[:2])


def test_a_pendulum(sheet):
    sheet.tool("link")
    sheet.click((0, 0.2), ground=True)
    sheet.click((0.1, -0.1))
    sheet.tool("driver")
    sheet.click((0, 0.2))
    sheet.tool("trace")
    sheet.click((0.1, -0.1))
    assert sheet.state == "driven"
    file = sheet.file
    start = degrees(file["drivers"]["link_angle"]["start"])
    out = final(sheet.export(), link_angle=(start, start + 1))
    long = length(file, "link")
    assert abs(out["link.B.x"] - long * math.cos(start + 1)) < EXACT
    assert abs(out["link.B.y"] - 0.2 - long * math.sin(start + 1)) < EXACT


def test_a_slider_crank(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1), (0.05, 0.1), (0.4, 0))
    sheet.tool("slider")
    sheet.click((0.4, 0), (0.5, 0))
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven"
    file = sheet.file
    crank, rod = length(file, "link"), length(file, "link_2")
    start = degrees(file["drivers"]["link_angle"]["start"])
    end = start + 2
    out = final(sheet.export("3"), link_angle=(start, end))
    x = crank * math.cos(end) + math.sqrt(rod**2 - (crank * math.sin(end)) ** 2)
    assert abs(out["slider.x"] - x) < EXACT


def test_a_four_bar(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1), (0.05, 0.1), (0.3, 0.25), (0.3, 0.25))
    sheet.click((0.4, 0), ground=True)
    assert sheet.state == "undriven"
    assert "1 degree of freedom" in sheet.status
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven"
    file = sheet.file
    crank, coupler, rocker = (length(file, name) for name in ("link", "link_2", "link_3"))
    base = file["ground"]["markers"]["D"][0]
    start = degrees(file["drivers"]["link_angle"]["start"])
    end = start + 1
    out = final(sheet.export(), link_angle=(start, end))
    ax, ay = crank * math.cos(end), crank * math.sin(end)
    apart = math.dist((ax, ay), (base, 0))
    along = (coupler**2 - rocker**2 + apart**2) / (2 * apart)
    aside = math.sqrt(coupler**2 - along**2)
    bx = ax + (along * (base - ax) - aside * (0 - ay)) / apart
    by = ay + (along * (0 - ay) + aside * (base - ax)) / apart
    # The last link was drawn from B to ground.
    assert abs(out["link_3.x"] - bx) < EXACT
    assert abs(out["link_3.y"] - by) < EXACT


def test_a_variable_side_triangle(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.3, 0.15))
    sheet.tool("cylinder")
    sheet.click((0.4, -0.1), (0.3, 0.15))
    assert sheet.state == "driven"
    file = sheet.file
    side = length(file, "link")
    foot = file["ground"]["markers"]["C"]
    base = math.hypot(*foot)
    start = file["drivers"]["cylinder"]["start"]
    end = start + 0.05
    out = final(sheet.export(), cylinder=(start, end))
    inner = math.acos((side**2 + base**2 - end**2) / (2 * side * base))
    assert abs(out["link.phi"] - (math.atan2(foot[1], foot[0]) + inner)) < EXACT


def test_a_loader_with_two_cylinders(sheet):
    sheet.tool("plate")
    sheet.click((-0.2, 0), ground=True)
    sheet.click((0.35, 0.2), (0, 0))
    sheet.press("Enter")
    sheet.tool("link")
    sheet.click((0.35, 0.2), (0.55, 0.1))
    sheet.tool("cylinder")
    # From the ground to the plate's third corner, and from the plate's middle to the bucket.
    sheet.click((-0.1, -0.2), (0, 0))
    sheet.click((0.075, 0.1), (0.55, 0.1))
    assert sheet.state == "driven", sheet.status
    file = sheet.file
    arm = file["bodies"]["plate"]["markers"]
    starts = [file["drivers"][name]["start"] for name in ("cylinder", "cylinder_2")]
    ends = [starts[0] + 0.03, starts[1] + 0.02]
    out = final(sheet.export(), cylinder=(starts[0], ends[0]), cylinder_2=(starts[1], ends[1]))
    pivot = file["ground"]["markers"]["A"]
    (lift,) = (point for name, point in file["ground"]["markers"].items() if name != "A")
    # The arm: the triangle of its pivot, the cylinder's foot and its third corner.
    reach, base = math.hypot(*arm["C"]), math.dist(pivot, lift)
    inner = math.acos((reach**2 + base**2 - ends[0] ** 2) / (2 * reach * base))
    foot = math.atan2(lift[1] - pivot[1], lift[0] - pivot[0])
    phi = foot + inner - math.atan2(arm["C"][1], arm["C"][0])
    assert abs(out["plate.phi"] - phi) < EXACT
    # The bucket, in the frame of the arm: the triangle of the pin, the second cylinder's foot and end.
    (second,) = (point for name, point in arm.items() if name not in ("A", "B", "C"))
    long, base = length(file, "link"), math.dist(arm["B"], second)
    inner = math.acos((long**2 + base**2 - ends[1] ** 2) / (2 * long * base))
    back = math.atan2(second[1] - arm["B"][1], second[0] - arm["B"][0])
    # As drawn, the bucket is on the right-hand side of the way back to the cylinder's foot.
    assert min(abs(math.remainder(out["link.phi"] - phi - back - s * inner, math.tau)) for s in (1, -1)) < EXACT


def test_a_gear_pair_with_a_crank(sheet):
    sheet.tool("gears")
    sheet.click((0, 0), (0.3, 0), (0.1, 0))
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven", sheet.status
    file = sheet.file
    (joint,) = (joint for joint in file["joints"].values() if joint["type"] == "gear")
    ratio = joint["radii"][0] / joint["radii"][1]
    start = degrees(file["drivers"]["wheel_angle"]["start"])
    out = final(sheet.export(), wheel_angle=(start, start + 3))
    assert math.isclose(joint["radii"][0], 0.1)
    turned = out["wheel_2.phi"] - degrees(file["bodies"]["wheel_2"].get("estimate", [0, 0, 0])[2])
    assert abs(turned + 3 * ratio) < EXACT


@pytest.mark.smoke
def test_undo_goes_back_to_the_first_letters_and_redo_to_the_last(sheet):
    first = sheet.text
    test_a_four_bar(sheet)
    last = sheet.text
    for _ in range(4):
        sheet.page.locator(".bar .undo").click()
    assert sheet.text == first
    for _ in range(4):
        sheet.page.locator(".bar .redo").click()
    assert sheet.text == last


def test_a_dragged_pin_changes_the_length_and_the_crank_starts_there(sheet):
    test_a_pendulum(sheet)
    sheet.tool("select")
    sheet.drag((0.1, -0.1), (0.2, 0.2))
    file = sheet.file
    assert math.isclose(length(file, "link"), 0.2, abs_tol=1e-4)
    assert abs(degrees(file["drivers"]["link_angle"]["start"])) < 1e-3
    assert sheet.state == "driven"


@pytest.mark.parametrize("long", ["120", "12 cm", "0,12 m"])
def test_a_length_is_typed_while_drawing(sheet, long):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.page.mouse.move(*sheet.place((0.2, 0)))
    sheet.press(*(key if key != " " else "Space" for key in long), "Enter")
    assert math.isclose(length(sheet.file, "link"), 0.12)


class Clicks:
    """Counts clicks on a page and keys pressed in it, Ctrl aside."""

    def __init__(self, page):
        self.page = page
        page.evaluate(
            """() => {
              window.counted = [0, 0];
              ["pointerdown", "keydown"].forEach((kind, place) => {
                addEventListener(kind, (event) => (window.counted[place] += event.isTrusted && event.key !== "Control"), true);
              });
            }"""
        )

    @property
    def clicks_and_keys(self):
        return self.page.evaluate("() => window.counted")


def test_clicks_from_an_empty_sheet_to_the_fmu_of_a_four_bar_with_its_coupler_curve(sheet):
    counted = Clicks(sheet.page)
    sheet.press("l")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1))
    sheet.press("p")
    sheet.click((0.05, 0.1), (0.3, 0.25), (0.1, 0.3))
    sheet.press("Enter", "l")
    sheet.click((0.3, 0.25))
    sheet.click((0.4, 0), ground=True)
    sheet.press("d")
    sheet.click((0, 0))
    sheet.press("t")
    sheet.click((0.1, 0.3))
    fmu = sheet.export()
    assert counted.clicks_and_keys == [11, 6]
    file = sheet.file
    start = degrees(file["drivers"]["link_angle"]["start"])
    crank = length(file, "link")
    out = final(fmu, link_angle=(start, start + 1))
    pin = (crank * math.cos(start + 1), crank * math.sin(start + 1))
    (name,) = [name.removesuffix(".x") for name in out if name.startswith("plate.") and name.count(".") == 2 and name.endswith(".x")]
    point = file["bodies"]["plate"]["markers"][name.split(".")[1]]
    assert abs(math.dist((out[f"{name}.x"], out[f"{name}.y"]), pin) - math.hypot(*point)) < EXACT


def test_clicks_from_an_empty_sheet_to_the_fmu_of_an_excavator_with_three_cylinders(sheet):
    counted = Clicks(sheet.page)
    sheet.press("l")
    sheet.click((0, 0), ground=True)
    sheet.click((0.3, 0.2), (0.3, 0.2), (0.5, 0.05), (0.5, 0.05), (0.45, -0.05))
    sheet.press("c")
    # From ground to the boom, from there to the stick, from there to the bucket.
    sheet.click((0.15, -0.05), (0.15, 0.1), (0.225, 0.15), (0.4, 0.125), (0.36, 0.155), (0.45, -0.05))
    fmu = sheet.export()
    assert counted.clicks_and_keys == [14, 2]
    file = sheet.file
    drivers = file["drivers"]
    ends = {name: (driver["start"], driver["start"] + 0.01) for name, driver in drivers.items()}
    out = final(fmu, **ends)

    def place(path):
        """The global place of a marker."""
        body, name = path.split(".")
        if body == "ground":
            return file["ground"]["markers"][name]
        x, y = file["bodies"][body]["markers"][name]
        phi = out[f"{body}.phi"]
        return (
            out[f"{body}.x"] + x * math.cos(phi) - y * math.sin(phi),
            out[f"{body}.y"] + x * math.sin(phi) + y * math.cos(phi),
        )

    assert len(ends) == 3
    for name, (_, end) in ends.items():
        assert abs(math.dist(*map(place, drivers[name]["markers"])) - end) < EXACT
    for joint in file["joints"].values():
        assert math.dist(*map(place, joint["markers"])) < EXACT
