"""Parts that the file knows beyond bars and pins, drawn by mouse, and run in FMPy against closed forms."""

import math

import pytest
from test_drawn import EXACT, degrees, final, length

# A pixel of the empty sheet [m].
PIXEL = 1e-3


def crank(sheet, end=(0.2, 0)):
    """A link on ground that is driven."""
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click(end)
    sheet.tool("driver")
    sheet.click((0, 0))


def start(file, driver="link_angle"):
    return degrees(file["drivers"][driver]["start"])


@pytest.mark.smoke
def test_links_that_are_welded_turn_as_one(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.2, 0), (0.2, 0), (0.25, 0.15))
    sheet.tool("weld")
    sheet.click((0.2, 0))
    assert sheet.file["joints"]["B"]["type"] == "weld"
    sheet.tool("trace")
    sheet.click((0.25, 0.15))
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven", sheet.status
    before = start(sheet.file)
    out = final(sheet.export(), link_angle=(before, before + 1))
    x, y = 0.25 * math.cos(1) - 0.15 * math.sin(1), 0.25 * math.sin(1) + 0.15 * math.cos(1)
    assert abs(out["link_2.C.x"] - x) < EXACT
    assert abs(out["link_2.C.y"] - y) < EXACT


def test_a_free_end_is_welded_to_ground_and_a_driven_pin_is_not(sheet):
    crank(sheet)
    sheet.tool("weld")
    sheet.click((0, 0))
    assert "moves this pin" in sheet.said
    sheet.press("Control+z")
    sheet.click((0.2, 0))
    assert "weld" in {joint["type"] for joint in sheet.file["joints"].values()}
    assert "no degree of freedom" in sheet.status


@pytest.mark.smoke
def test_shapes_touch_where_their_radii_say(sheet):
    crank(sheet)
    sheet.tool("bar")
    sheet.click((0, 0), (0.2, 0), (0.1, 0.01))
    bar = sheet.file["bodies"]["link"]["shapes"]["bar"]
    assert bar == {"bar": ["A", "B"], "radius": pytest.approx(0.01, abs=PIXEL)}
    sheet.tool("disc")
    sheet.click((0, 0.15), ground=True)
    sheet.click((0.02, 0.15))
    disc = sheet.file["ground"]["shapes"]["disc"]
    assert disc["radius"] == pytest.approx(0.02, abs=PIXEL)
    sheet.tool("contact")
    sheet.click((0.1, 0.005), (0.005, 0.155))
    assert sheet.file["contacts"]["contact"]["shapes"] == ["link.bar", "ground.disc"]
    assert sheet.page.locator(".inspector h2").inner_text() == "Contact contact"
    fmu = sheet.export()
    # The bar's middle is at the sum of the radii from the disc's centre, which is 150 mm above the pivot.
    touch = math.acos((bar["radius"] + disc["radius"]) / 0.15)
    assert final(fmu, link_angle=(0, touch - 1e-6))["link.phi"] == pytest.approx(touch - 1e-6, abs=EXACT)
    assert final(fmu, link_angle=(0, touch + 1e-6))["time"] <= 0.5
    # The radius is a number of the body's form, and the shape can be taken away with its contact.
    sheet.tool("select")
    sheet.click((0.15, 0))
    field = sheet.page.locator(".inspector .field", has_text="bar radius").locator("input")
    field.fill("15")
    field.press("Enter")
    assert sheet.file["bodies"]["link"]["shapes"]["bar"]["radius"] == 0.015
    sheet.page.locator(".actions button", has_text="Delete shape bar").click()
    assert "shapes" not in sheet.file["bodies"]["link"]
    assert "contacts" not in sheet.file


def test_an_outline_has_a_hole_and_belongs_to_the_body_that_is_chosen(sheet):
    crank(sheet)
    sheet.tool("outline")
    sheet.click((0, 0))
    sheet.page.get_by_role("menuitem", name="Part of link").click()
    sheet.click((0.2, -0.05), (0.2, 0.1), (0, 0))
    sheet.tool("hole")
    sheet.click((0.15, 0))
    sheet.click((0.17, 0))
    shapes = sheet.file["bodies"]["link"]["shapes"]
    assert len(shapes["outline"]["outline"]) == 3
    assert shapes["hole"]["radius"] == pytest.approx(0.02, abs=PIXEL)
    assert sheet.state == "driven", sheet.status


def test_friction_and_stops_of_a_pin(sheet):
    crank(sheet)
    sheet.tool("mass")
    sheet.click((0.1, 0))
    sheet.tool("friction")
    sheet.click((0, 0))
    (friction,) = sheet.file["friction"].values()
    assert friction["joint"] == "A"
    sheet.tool("stop")
    sheet.click((0, 0))
    (stop,) = sheet.file["stops"].values()
    assert (degrees(stop["min"]), degrees(stop["max"])) == pytest.approx((-math.pi / 6, math.pi / 6), abs=1e-3)
    fmu = sheet.export()
    # At constant speed the driver bears the weight and the friction of the pin under its reaction; it ends
    # with the last step before the stop.
    out = final(fmu, link_angle=(0, 1))
    assert out["link.phi"] == pytest.approx(0.5)
    file = sheet.file
    weight = file["bodies"]["link"]["mass"] * 9.81 * 0.1 * math.cos(0.5)
    rubbed = friction["coefficient"] * friction["radius"] * math.hypot(out["A.fx"], out["A.fy"])
    assert abs(out["link_angle.effort"] - weight - rubbed) < EXACT


def test_two_cranks_are_coupled_one_to_one(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.1, 0))
    sheet.click((0.3, 0), ground=True)
    sheet.click((0.3, 0.1))
    sheet.tool("driver")
    sheet.click((0, 0))
    sheet.tool("coupling")
    sheet.click((0, 0), (0.3, 0))
    assert sheet.state == "driven", sheet.status
    before = start(sheet.file)
    out = final(sheet.export(), link_angle=(before, before + 2))
    assert abs(out["link_2.phi"] - math.pi / 2 - 2) < EXACT


def test_a_rope_over_a_point_hands_a_way_on(sheet):
    sheet.tool("slider")
    sheet.click((0, 0.1), (0.1, 0.1))
    sheet.tool("slider")
    sheet.click((0.3, -0.1), (0.3, 0))
    sheet.tool("rope")
    sheet.click((0, 0.1))
    sheet.click((0.3, 0.1), ground=True)
    sheet.click((0.3, -0.1), (0.3, -0.1))
    assert sheet.file["joints"]["rope"]["length"] == pytest.approx(0.5)
    sheet.tool("driver")
    sheet.click((0, 0.1))
    assert sheet.state == "driven", sheet.status
    (driver,) = sheet.file["drivers"]
    out = final(sheet.export(), **{driver: (0, 0.05)})
    assert abs(out["slider_2.y"] - (-0.1 - 0.05)) < EXACT


def test_a_pin_runs_in_a_track_through_points(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.1, 0), (0.1, 0), (0.3, 0.05))
    sheet.tool("track")
    sheet.click((0.3, 0.05), (0.25, 0.1), (0.15, 0.15), (0.15, 0.15))
    sheet.tool("driver")
    sheet.click((0, 0))
    sheet.tool("trace")
    sheet.click((0.3, 0.05))
    assert sheet.state == "driven", sheet.status
    file = sheet.file
    assert file["joints"]["track"]["points"]["table"] == [[0, 0], [-0.05, 0.05], [-0.15, 0.1]]
    # With the crank where the rod reaches the middle point, the pin is there.
    rod, mid = length(file, "link_2"), (0.25, 0.1)
    far = math.hypot(*mid)
    inner = math.acos((0.1**2 + far**2 - rod**2) / (2 * 0.1 * far))
    turn = math.atan2(mid[1], mid[0]) - inner
    out = final(sheet.export(), link_angle=(0, turn))
    assert math.dist((out["link_2.C.x"], out["link_2.C.y"]), mid) < EXACT


def test_the_follower_of_a_cam_is_chosen(sheet):
    sheet.tool("cam")
    sheet.click((0, 0), (0, 0.05))
    sheet.page.get_by_role("menuitem", name="A follower with a flat face").click()
    assert sheet.file["joints"]["contact"]["follower"] == "flat"
    sheet.tool("driver")
    sheet.click((0, 0))
    sheet.page.get_by_role("menuitem", name="Pin").click()
    assert sheet.state == "driven", sheet.status
