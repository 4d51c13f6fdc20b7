"""What a hand does at the studio, and what stood in its way."""

import math

import pytest
from drawing import Drawing
from harness import ROOT

STUDIO = "document.querySelector('.studio').studio"


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_the_form_of_a_length_takes_no_click(chromium, folder, tmp_path, size):
    context = chromium.new_context(viewport={"width": size[0], "height": size[1]})
    sheet = Drawing(context.new_page(), folder / "index.html", tmp_path)
    middle = sheet.page.evaluate(f"() => {STUDIO}.sheet.center")
    for k in range(96):
        angle = k * math.tau / 96
        sheet.tool("link")
        sheet.click(middle, (middle[0] + 0.07 * math.cos(angle), middle[1] + 0.07 * math.sin(angle)))
        assert len(sheet.file.get("bodies", {})) == 1, f"{math.degrees(angle)}°"
        sheet.press("Control+z")
    context.close()


def test_a_geared_five_bar_is_drawn_from_the_faces_of_its_wheels(sheet):
    sheet.tool("gears")
    sheet.click((0, 0), (0.2, 0), (0.1, 0))
    sheet.tool("link")
    sheet.click((0.04, 0.04), (0.08, 0.2))
    sheet.click((0.08, 0.2), (0.16, 0.06))
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven", sheet.status
    file = sheet.file
    assert len(file["bodies"]) == 4
    assert len(file["bodies"]["wheel"]["markers"]) == len(file["bodies"]["wheel_2"]["markers"]) == 2


def test_gears_are_fixed_to_links(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.02, 0.08))
    sheet.click((0.2, 0), ground=True)
    sheet.click((0.18, 0.08))
    sheet.tool("gears")
    for at, name in (((0, 0), "link"), ((0.2, 0), "link_2")):
        sheet.click(at)
        sheet.page.get_by_role("menuitem", name=f"A wheel fixed to {name}", exact=True).click()
    sheet.click((0.1, 0))
    assert len(sheet.file["bodies"]) == 2
    sheet.tool("driver")
    sheet.click((0, 0))
    assert sheet.state == "driven", sheet.status


@pytest.mark.parametrize("roller_first", [True, False])
def test_a_cam_and_a_roller_are_joined_in_either_order(sheet, roller_first):
    sheet.tool("link")
    sheet.click((0, 0.1), ground=True)
    sheet.click((0.1, 0.1))
    sheet.page.keyboard.press("Escape")
    sheet.page.keyboard.press("k")
    clicks = [(0.1, 0.1), (0.1, 0.02)]
    sheet.click(*(clicks if roller_first else reversed(clicks)))
    assert sheet.file["joints"]["contact"]["follower"] == "roller"
    sheet.tool("driver")
    sheet.click((0.1, 0.02))
    assert sheet.state == "driven", sheet.status


def test_a_table_that_is_not_there_is_asked_for(sheet):
    file = ROOT / "mechanisms" / "cam_points.toml"
    sheet.page.locator(".opened").set_input_files(file)
    with sheet.page.expect_file_chooser() as chooser:
        sheet.page.locator("dialog button.primary").click()
    assert sheet.state == "broken"
    chooser.value.set_files(ROOT / "mechanisms" / "cam_points.csv")
    sheet.page.wait_for_selector(".studio[data-state=driven], .studio[data-state=free]")


def test_keys_after_windows_names_and_text(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.2, 0.1))
    # A new name keeps the selection.
    sheet.tool("select")
    sheet.click((0.1, 0.05))
    sheet.press("F2")
    sheet.page.locator("dialog input").fill("crank")
    sheet.page.locator("dialog button.primary").click()
    assert sheet.page.locator(".inspector h2").inner_text() == "Body crank"
    assert sheet.page.locator(".marks .selected.bar").count() == 1
    # Saving is a key of the text, too.
    sheet.page.locator(".editor .cm-content").click()
    with sheet.page.expect_download() as saved:
        sheet.page.keyboard.press("Control+s")
    assert saved.value.suggested_filename == "mechanism.toml"
    # Space is not for the button that was clicked last.
    sheet.page.locator("button.export").click()
    sheet.page.locator("dialog button", has_text="Cancel").click()
    sheet.page.keyboard.press("Space")
    sheet.frame()
    assert sheet.page.locator("dialog").count() == 0


def test_a_box_selects_points_that_are_moved_copied_and_deleted_together(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1), (0.05, 0.1), (0.2, 0), (0.3, 0), (0.35, 0.1))
    drawn, before = sheet.text, sheet.file
    sheet.tool("select")

    def choose(start, end):
        sheet.page.keyboard.down("Shift")
        sheet.drag(start, end)
        sheet.page.keyboard.up("Shift")

    rings = sheet.page.locator(".marks circle.selected")
    title = sheet.page.locator(".inspector h2")
    choose((-0.03, -0.03), (0.24, 0.14))
    assert sheet.text == drawn
    assert rings.count() == 3
    assert title.inner_text() == "Bodies link, link_2"
    # Bodies that move as a whole keep their lengths.
    sheet.drag((0.05, 0.1), (0.1, 0.2))
    bodies = sheet.file["bodies"]
    for name, body in before["bodies"].items():
        assert bodies[name]["markers"] == body["markers"]
        way = [a - b for a, b in zip(bodies[name]["estimate"][:2], body["estimate"][:2], strict=True)]
        assert way == pytest.approx([0.05, 0.1] if name != "link_3" else [0, 0], abs=1e-12)
    assert list(sheet.file["ground"]["markers"].values()) == [[0.05, 0.1]]
    sheet.press("Control+d")
    assert len(sheet.file["bodies"]) == 5
    sheet.press("Control+z", "Control+z")
    assert sheet.text == drawn
    choose((0.24, 0.14), (-0.03, -0.03))
    sheet.press("Delete")
    assert list(sheet.file["bodies"]) == ["link_3"]
    assert "joints" not in sheet.file
    sheet.press("Control+z")
    # Ends of bodies that are not wholly in the box are moved alone; Delete takes the pins there.
    choose((0.17, -0.03), (0.33, 0.03))
    assert rings.count() == 2
    sheet.drag((0.3, 0), (0.3, -0.05))
    assert sheet.file["bodies"]["link"] == before["bodies"]["link"]
    at = [point["at"] for point in sheet.page.evaluate(f"() => {STUDIO}.view.sketch.points")]
    for place in ([0.2, -0.05], [0.3, -0.05]):
        assert any(place == pytest.approx(each, abs=1e-12) for each in at)
    choose((-0.03, -0.03), (0.12, 0.14))
    sheet.page.locator(".sheet").focus()
    sheet.press("Delete")
    assert "link" not in sheet.file["bodies"]


@pytest.mark.smoke
def test_a_key_right_after_a_window_or_a_menu_is_for_the_sheet(sheet):
    """The key comes before the browser draws again, as on a machine that is busy."""
    click_and_press = """([selector, init]) => {
      document.querySelector(selector).click();
      document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { bubbles: true, cancelable: true, ...init }));
    }"""
    pressed = sheet.page.locator(".tools button[aria-pressed=true]")
    sheet.page.locator("button.help").click()
    sheet.page.evaluate(click_and_press, ["dialog button", {"key": "l"}])
    assert pressed.get_attribute("value") == "link"
    sheet.page.locator(".file-menu").click()
    sheet.page.evaluate(click_and_press, [".menu button", {"key": "c"}])
    assert pressed.get_attribute("value") == "cylinder"
    sheet.page.locator("button.export").click()
    with sheet.page.expect_download() as saved:
        sheet.page.evaluate(click_and_press, ["dialog button[value='']", {"key": "s", "ctrlKey": True}])
    assert saved.value.suggested_filename == "mechanism.toml"


def test_a_mac_has_cmd_and_ctrl_clicks(sheet, chromium, folder, tmp_path):
    context = chromium.new_context(viewport={"width": 1440, "height": 900})
    context.add_init_script("Object.defineProperty(Navigator.prototype, 'platform', { get: () => 'MacIntel' })")
    mac = Drawing(context.new_page(), folder / "index.html", tmp_path)
    mac.tool("link")
    assert "with Cmd" in mac.page.locator(".status .hint").inner_text()
    assert mac.page.locator(".bar .undo").get_attribute("title") == "Cmd+Z"
    # There Ctrl and a click ask for the menu of a thing; a tool takes them for a click on ground.
    place = mac.page.locator(".sheet")
    place.dispatch_event("contextmenu", {"ctrlKey": True, "clientX": 700, "clientY": 400})
    assert not mac.page.locator(".menu").is_visible()
    mac.click((0, 0), ground=True)
    mac.click((0.2, 0.1))
    assert len(mac.file["joints"]) == 1
    context.close()


@pytest.mark.smoke
def test_a_defect_of_the_solver_loses_neither_undo_nor_words(sheet):
    """The solver ends, as it does in a panic, at the next question."""
    breaks = f"""() => {{
      const {{ solver }} = {STUDIO};
      solver.exports = {{ ...solver.exports, biela_answer() {{ throw new WebAssembly.RuntimeError("unreachable"); }} }};
    }}"""
    empty = sheet.text
    sheet.tool("link")
    sheet.click((0, 0), (0.2, 0.1))
    drawn = sheet.text
    sheet.tool("pivot")
    sheet.page.evaluate(breaks)
    sheet.click((0, 0))
    assert "defect of biela" in sheet.said
    assert "unreachable" not in sheet.said
    assert sheet.text == drawn
    sheet.page.locator(".editor .cm-content").click()
    sheet.page.keyboard.press("Control+End")
    sheet.page.evaluate(breaks)
    sheet.page.keyboard.type("#")
    editor = f"() => {STUDIO}.editor.text"
    assert sheet.page.evaluate(editor) == f"{drawn}#"
    sheet.page.reload()
    sheet.page.wait_for_selector(".studio.ready")
    assert sheet.page.evaluate(editor) == f"{drawn}#"
    for text in (drawn, empty):
        sheet.page.locator(".bar .undo").click()
        assert sheet.text == text


def test_one_unit_is_chosen_for_sheet_forms_and_rows(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.0, 0.1))
    sheet.page.locator(".lengths").select_option("cm")
    sheet.page.locator(".angles").select_option("rad")
    sheet.tool("select")
    sheet.click((0, 0.05))
    assert sheet.page.locator(".marks .dimension").text_content() == "10 cm"
    rows = sheet.page.locator(".inspector .field")
    field = rows.filter(has_text="B x [cm]").locator("input")
    assert field.input_value() == "10"
    assert rows.filter(has_text="length A").locator("input").input_value() == "10"
    turn = rows.filter(has_text="estimate angle [rad]").locator("input")
    assert turn.input_value() == "1.570796"
    field.fill("12.5")
    field.press("Enter")
    assert sheet.file["bodies"]["link"]["markers"]["B"] == [0.125, 0]
    turn = rows.filter(has_text="estimate angle [rad]").locator("input")
    turn.fill("1")
    turn.press("Enter")
    assert sheet.file["bodies"]["link"]["estimate"][2] == "57.2957795130823*deg"
    # A length that is typed is in this unit, and the browser keeps it.
    sheet.page.reload()
    sheet.page.wait_for_selector(".studio.ready")
    sheet.tool("link")
    sheet.click((0.08, 0))
    sheet.page.keyboard.type("7")
    sheet.press("Enter")
    assert sheet.file["bodies"]["link_2"]["markers"]["D"][0] == 0.07
    assert sheet.page.locator(".lengths").input_value() == "cm"
