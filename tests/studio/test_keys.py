"""The studio without a mouse: keys draw, forms have labels, colours have contrast; and what helps a beginner."""

import math

import pytest
from axe_playwright_python.sync_playwright import Axe
from drawing import Drawing
from test_drawn import EXACT, degrees, final

STUDIO = "document.querySelector('.studio').studio"


def go(sheet, *ways):
    """Moves the keys' place by steps of the grid."""
    for key, count in ways:
        for _ in range(count):
            sheet.press(key)


def test_a_pendulum_is_drawn_by_keys_alone(sheet):
    step = sheet.page.evaluate(f"() => {STUDIO}.sheet.step")
    while not sheet.page.evaluate("() => document.activeElement?.matches('.sheet')"):
        sheet.press("Tab")
    sheet.press("l", "ArrowLeft", "Control+Enter")
    go(sheet, ("ArrowRight", 4), ("ArrowUp", 3))
    sheet.press("Enter")
    (pivot,) = sheet.file["ground"]["markers"].values()
    assert math.isclose(sheet.file["bodies"]["link"]["markers"]["B"][0], 5 * step)
    # The driver at the pivot, which the keys go to by name; then the trace of the other end.
    sheet.press("d", "PageDown")
    assert "ground.A" in sheet.page.locator(".place-words").inner_text()
    sheet.press("Enter", "t", "PageDown", "Enter")
    assert sheet.state == "driven", sheet.status
    before = degrees(sheet.file["drivers"]["link_angle"]["start"])
    sheet.press("Control+e")
    with sheet.page.expect_download() as waiting:
        sheet.press("Enter")
    fmu = sheet.folder / "keys.fmu"
    waiting.value.save_as(fmu)
    out = final(fmu, link_angle=(before, before + 1))
    assert abs(out["link.B.x"] - pivot[0] - 5 * step * math.cos(before + 1)) < EXACT
    # What the keys reach they select, move and delete.
    sheet.press("v", "PageDown", "PageDown", "Enter")
    assert sheet.page.locator(".inspector h2").inner_text() == "Point link.B"
    sheet.press("ArrowUp")
    assert not math.isclose(degrees(sheet.file["drivers"]["link_angle"]["start"]), before)
    sheet.press("Delete")
    assert "B" not in sheet.file["bodies"]["link"]["markers"]


@pytest.mark.smoke
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_view_hides_from_those_who_see_less(chromium, folder, tmp_path, scheme):
    context = chromium.new_context(viewport={"width": 1440, "height": 900}, color_scheme=scheme)
    page = context.new_page()
    sheet = Drawing(page, folder / "index.html", tmp_path)

    problems = []

    def check(view):
        sheet.look(f"{view}-{scheme}")
        for found in Axe().run(page).response["violations"]:
            problems.extend(f"{view}: {found['id']}: {node['html'][:160]}" for node in found["nodes"])

    check("empty")
    page.locator(".first-build").click()
    check("guide")
    page.locator(".guide button", has_text="Close").click()
    sheet.open_template("four_bar")
    check("design")
    sheet.page.locator(".inspector summary").first.click()
    sheet.tool("link")
    sheet.click((0, 0))
    check("drawing")
    sheet.press("Escape", "Escape")
    sheet.click((0, 0))
    check("point")
    u, v = sheet.place((0, 0))
    page.mouse.click(u, v, button="right")
    check("menu")
    sheet.press("Escape")
    page.locator("button.export").click()
    check("export")
    page.keyboard.press("Escape")
    page.keyboard.press("F1")
    check("help")
    page.keyboard.press("Escape")
    sheet.list_templates()
    page.wait_for_selector(".templates .picture svg path")
    check("templates")
    page.keyboard.press("Escape")
    page.locator(".modes button[value=motion]").click()
    page.wait_for_selector(".live.ready")
    check("motion")
    context.close()
    assert not problems
    assert sheet.errors == []


def test_the_first_mechanism_is_built_by_six_buttons(sheet):
    sheet.page.locator(".first-build").click()
    guide = sheet.page.locator(".guide")
    for step in range(1, 7):
        assert guide.locator("h2").inner_text() == f"Step {step} of 6"
        guide.get_by_role("button", name="Do this for me").click()
    assert sheet.page.locator(".studio.motion").count() == 1
    assert sheet.state == "driven", sheet.status
    assert len(sheet.file["bodies"]) == 3
    assert guide.inner_text().startswith("Done")
    guide.get_by_role("button", name="Close").click()
    assert not guide.is_visible()


def test_the_guide_follows_a_hand_that_draws(sheet):
    sheet.page.locator(".first-build").click()
    heading = sheet.page.locator(".guide h2")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.15))
    assert heading.inner_text() == "Step 2 of 6"
    sheet.page.get_by_role("button", name="Do this for me").click()
    assert heading.inner_text() == "Step 3 of 6"
    sheet.press("Control+z")
    assert heading.inner_text() == "Step 2 of 6"


def test_a_line_tells_the_type_of_a_four_bar_while_it_is_drawn(sheet):
    note = sheet.page.locator(".middle > .note")
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0, 0.1), (0, 0.1), (0.3, 0.25), (0.3, 0.25))
    assert note.inner_text() == ""
    u, v = sheet.place((0.4, 0))
    sheet.page.mouse.move(u - 3, v)
    sheet.page.keyboard.down("Control")
    sheet.page.mouse.move(u, v)
    sheet.frame()
    sheet.frame()
    # Sides 100, 335, 269 and 400 mm: 100 + 400 < 335 + 269.
    assert note.inner_text().startswith("crank-rocker: link turns fully")
    sheet.page.mouse.click(u, v)
    sheet.page.keyboard.up("Control")
    # At the rocker's end the coupler, (-300, -150), and the rocker, (100, -250).
    angle = math.degrees(math.acos(7500 / (math.hypot(300, 150) * math.hypot(100, 250))))
    assert note.inner_text().endswith(f"transmission angle {angle:.0f}° here")


def test_all_lengths_of_a_mechanism_are_changed_in_one_table(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1), (0.05, 0.1), (0.3, 0.1))
    sheet.tool("driver")
    sheet.click((0, 0))
    sheet.press("Escape", "Escape")
    rows = sheet.page.locator(".inspector .rows > .field")
    # Drivers stand first; author and licence are folded away.
    assert rows.first.inner_text().startswith("link_angle")
    field = rows.filter(has_text="link_2 B–C").locator("input")
    assert field.input_value() == "250"
    field.fill("12 cm")
    field.press("Enter")
    assert sheet.file["bodies"]["link_2"]["markers"]["C"] == [0.12, 0]
    author = sheet.page.locator(".inspector .field", has_text="author")
    assert not author.is_visible()
    sheet.page.locator(".inspector summary", has_text="About").click()
    assert author.is_visible()
    sheet.press("Control+z")
    assert author.is_visible()
