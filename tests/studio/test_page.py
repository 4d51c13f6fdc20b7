"""The studio's page: text and drawing as one, files and links, other sizes, touch."""

import base64
import json
import subprocess
import zipfile

import pytest
from drawing import Drawing
from harness import ROOT, program


def crank(sheet):
    """Draws a crank on ground with a rod."""
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.05, 0.1), (0.05, 0.1), (0.3, 0.1))


def slider_crank(sheet):
    crank(sheet)
    sheet.tool("slider")
    sheet.click((0.3, 0.1), (0.4, 0.1))
    sheet.tool("driver")
    sheet.click((0, 0))


@pytest.mark.smoke
def test_the_fmu_has_the_bytes_of_the_program(sheet, tmp_path):
    slider_crank(sheet)
    for fmi in ("2", "3"):
        fmu = sheet.export(fmi)
        file = tmp_path / "mechanism.toml"
        file.write_text(sheet.text, encoding="utf-8")
        platforms = sheet.page.evaluate("() => document.querySelector('.studio').studio.parts.filter((p) => p !== 'page')")
        runtimes = ROOT / "target" / "runtimes"
        built = all(list(runtimes.glob(f"{platform}/biela.*")) for platform in platforms)
        command = [program(), "export", file, "-o", tmp_path / "own.fmu", "--fmi", fmi]
        subprocess.run([*command, *(["--runtime", runtimes] if built else [])], check=True, capture_output=True)
        own = (tmp_path / "own.fmu").read_bytes()
        assert zipfile.ZipFile(fmu).namelist() == zipfile.ZipFile(tmp_path / "own.fmu").namelist()
        assert fmu.read_bytes() == own


def test_typing_moves_the_drawing_and_undo_takes_it_back(sheet):
    crank(sheet)
    before = sheet.text
    sheet.page.locator(".editor .cm-line", has_text="link_2").first.click()
    sheet.page.keyboard.press("ArrowDown")
    sheet.page.keyboard.press("End")
    sheet.page.keyboard.press("Enter")
    sheet.page.keyboard.type("mass = 2")
    assert "mass = 2" in sheet.text
    mass = sheet.page.evaluate("() => document.querySelector('.studio').studio.view.sketch.bodies[1].mass")
    assert mass == 2
    # What is typed in one go is one step.
    sheet.page.keyboard.press("Control+z")
    assert sheet.text == before


def test_an_error_keeps_the_drawing_and_names_the_line(sheet):
    crank(sheet)
    sheet.page.locator(".editor .cm-content").click()
    sheet.page.keyboard.press("Control+End")
    sheet.page.keyboard.type("[oops")
    assert sheet.state == "broken"
    assert sheet.status.startswith("Line ")
    assert sheet.page.locator(".studio.stale .drawing svg").count() == 1
    sheet.tool("pivot")
    sheet.click((0.3, 0.1))
    assert "mend it first" in sheet.said


def test_a_link_holds_the_mechanism(sheet, chromium, folder, tmp_path):
    crank(sheet)
    sheet.page.evaluate(
        """() => Object.defineProperty(navigator, "clipboard", {
          value: { writeText: async (text) => { window.copied = text; } },
        })"""
    )
    sheet.page.locator(".file-menu").click()
    sheet.page.get_by_text("Copy a web link").click()
    link = sheet.page.wait_for_function("() => window.copied").json_value()
    context = chromium.new_context()
    page = context.new_page()
    page.goto(link)
    page.wait_for_selector(".studio.ready")
    assert page.evaluate("() => document.querySelector('.studio').studio.text") == sheet.text
    context.close()


def test_a_template_is_opened_and_moves(sheet):
    sheet.open_template("slider_crank")
    sheet.page.locator(".modes button[value=motion]").click()
    live = sheet.page.locator(".live.ready")
    live.locator(".driver-rows input[type=number]").fill("90")
    live.locator(".driver-rows input[type=number]").press("Enter")
    before = sheet.text
    sheet.page.locator(".start-here").click()
    assert sheet.text != before
    assert '"90*deg"' in sheet.text
    sheet.page.locator(".bar .undo").click()
    assert sheet.text == before


def test_what_nothing_drives_is_moved_by_hand(sheet):
    crank(sheet)
    assert "2 degrees of freedom" in sheet.status
    sheet.page.locator(".modes button[value=motion]").click()
    reached = sheet.page.evaluate(
        """() => {
          const { live } = document.querySelector(".studio").studio;
          const { scale } = live.picture.parts;
          const { grip } = live.ask({ do: "grab", body: 1, at: [0.3 * scale, -0.1 * scale] });
          const answer = live.ask({ do: "drag", body: 1, grip, at: [0.2 * scale, -0.05 * scale] });
          return answer.outcome;
        }"""
    )
    assert reached == "reached"
    shown = sheet.page.evaluate("() => document.querySelector('.studio').studio.live.page.drivers.length")
    assert shown == 0


def test_a_file_of_another_program_is_dropped_in(sheet):
    samples = sorted((ROOT / "crates/tools/tests/exchange/samples").rglob("*.linkage2"))
    sheet.page.locator(".opened").set_input_files(samples[0])
    sheet.page.wait_for_function("() => document.querySelector('.studio').studio.view.sketch.bodies.length > 0")
    assert sheet.text.startswith("# From ")


@pytest.mark.parametrize(
    ("entry", "start"),
    [
        ("Mechanism file", b"format = 1"),
        ("Picture (SVG)", b"<svg"),
        ("Picture (PNG)", b"\x89PNG"),
        ("Drawing for the workshop", b"  0\n"),
        ("Moving picture", b"GIF89a"),
    ],
)
def test_what_is_saved_begins_as_it_should(sheet, tmp_path, entry, start):
    slider_crank(sheet)
    sheet.page.locator(".file-menu").click()
    with sheet.page.expect_download() as waiting:
        sheet.page.get_by_role("menuitem", name=entry).click()
    waiting.value.save_as(tmp_path / "saved")
    content = (tmp_path / "saved").read_bytes()
    assert content.startswith(start)
    assert len(content) > 300


def test_a_video_lasts_as_long_as_the_motion(sheet, tmp_path):
    slider_crank(sheet)
    sheet.page.locator(".file-menu").click()
    with sheet.page.expect_download() as waiting:
        sheet.page.get_by_role("menuitem", name="Video").click()
    video = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(video)
    content = video.read_bytes()
    assert content[4:8] == b"ftyp" if video.suffix == ".mp4" else content.startswith(b"\x1a\x45\xdf\xa3")
    shown = sheet.page.evaluate(
        """async (data) => {
          const video = document.createElement("video");
          video.src = data;
          await new Promise((done) => (video.onloadeddata = done));
          // A recording does not tell its length before its end has been sought.
          video.currentTime = 1e6;
          await new Promise((done) => (video.onseeked = done));
          return [video.currentTime, video.videoWidth, video.videoHeight];
        }""",
        f"data:video/{video.suffix[1:]};base64,{base64.b64encode(content).decode()}",
    )
    # A turn takes 4 s; a busy machine records it slower.
    assert 3.5 < shown[0] < 20
    assert min(shown[1:]) > 200


def test_templates_have_pictures(sheet):
    sheet.list_templates()
    sheet.page.wait_for_function("() => document.querySelectorAll('.templates .picture svg path').length > 20")
    pictures = sheet.page.locator(".templates .picture svg").count()
    # Those that have been in view.
    assert 4 <= pictures < sheet.page.locator(".templates button").count()


def test_the_last_click_is_foreseen_and_changes_nothing(sheet):
    sheet.tool("gears")
    before = sheet.text
    sheet.click((0.1, 0.1), (0.25, 0.1))
    u, v = sheet.place((0.2, 0.1))
    sheet.page.mouse.move(u - 3, v)
    sheet.page.mouse.move(u, v)
    sheet.frame()
    assert "1 degree of freedom" in sheet.status
    assert sheet.page.locator(".drawing svg [data-attachment]").count() >= 2
    assert sheet.text == before
    sheet.press("Escape")
    sheet.frame()
    assert "empty sheet" in sheet.status
    assert sheet.text == before


def test_a_click_in_motion_shows_a_path(sheet):
    sheet.open_template("four_bar")
    before = sheet.text
    sheet.page.locator(".modes button[value=motion]").click()
    sheet.page.locator(".live input.poses").check()
    at = sheet.page.evaluate(
        """() => {
          const { picture } = document.querySelector(".studio").studio.live;
          const { scale } = picture.parts;
          const at = new DOMPoint(0.2 * scale, -0.2 * scale).matrixTransform(picture.svg.getScreenCTM());
          return [at.x, at.y];
        }"""
    )
    sheet.page.mouse.click(*at)
    sheet.page.wait_for_selector(".live .before path[d^=M]", state="attached")
    assert sheet.page.locator(".live .traced span").inner_text().startswith("Point of coupler at ")
    assert sheet.page.locator(".live .behind > g").count() == 13
    sheet.page.locator(".live .traced button").click()
    assert sheet.page.locator(".live .before path").count() == 0
    assert sheet.text == before


def test_memory_is_steady_over_an_hour(sheet):
    """An hour of free motion, sixty pictures a second, and as many drags as one has in it."""
    text = (ROOT / "mechanisms" / "pendulum_free.toml").read_text(encoding="utf-8")
    first, last, time = sheet.page.evaluate(
        """async (text) => {
          const { studio } = document.querySelector(".studio");
          studio.open({ name: "pendulum_free.toml", text });
          const size = () => studio.solver.exports.memory.buffer.byteLength + (studio.live?.solver.exports.memory.buffer.byteLength ?? 0);
          const marker = studio.view.sketch.points.flatMap((point) => point.markers).find((marker) => !marker.startsWith("ground."));
          const drag = (count) => {
            for (let k = 0; k < count; k += 1) {
              studio.preview({ kind: "shift", markers: [marker], by: [1e-4 * (k % 50), 0] });
            }
            studio.showAgain();
          };
          const fly = (from, to) => {
            for (let k = 60 * from; k < 60 * to; k += 1) {
              studio.live.solver.ask({ do: "time", value: (k + 1) / 60 });
            }
          };
          drag(200);
          studio.setMode("motion");
          fly(0, 20);
          const first = size();
          fly(20, 3600);
          const time = studio.live.solver.frame[0];
          studio.setMode("design");
          drag(3000);
          return [first, size(), time];
        }""",
        text,
    )
    assert abs(time - 3600) < 1e-6
    assert last == first


def test_a_length_clicked_becomes_a_parameter(sheet):
    crank(sheet)
    sheet.tool("select")
    sheet.click((0.175, 0.1))
    sheet.page.locator(".marks .dimension").first.dispatch_event("pointerdown")
    sheet.page.locator("dialog input").nth(1).fill("rod_length")
    sheet.page.locator("dialog button.primary").click()
    assert sheet.file["parameters"]["rod_length"]["value"] == pytest.approx(0.25)
    assert "rod_length" in json.dumps(sheet.file["bodies"]["link_2"]["markers"])
    # Dragging the pin asks once whether the parameter shall change.
    sheet.drag((0.3, 0.1), (0.4, 0.1))
    sheet.page.locator("dialog button.primary").click()
    assert sheet.file["parameters"]["rod_length"]["value"] == pytest.approx(0.35)
    sheet.drag((0.4, 0.1), (0.35, 0.1))
    assert sheet.page.locator("dialog").count() == 0
    assert sheet.file["parameters"]["rod_length"]["value"] == pytest.approx(0.3)


def test_the_picture_below_is_there_again_at_its_scale(sheet, tmp_path):
    picture = tmp_path / "photo.svg"
    picture.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="3200" height="1600"><rect width="3200" height="1600" fill="#eed"/></svg>'
    )
    width = """() => {
      const { background } = document.querySelector(".studio").studio;
      return background.image.naturalWidth * background.unit;
    }"""
    sheet.page.locator(".pictured").set_input_files(picture)
    sheet.page.wait_for_selector(".sheet .background")
    sheet.click((0, 0), (0.1, 0))
    sheet.page.locator("dialog input").fill("300")
    sheet.page.locator("dialog button.primary").click()
    sheet.frame()
    before = sheet.page.evaluate(width)
    sheet.page.reload()
    sheet.page.wait_for_selector(".studio.ready .background", state="attached")
    assert sheet.page.evaluate(width) == pytest.approx(before)
    sheet.page.locator(".file-menu").click()
    sheet.page.get_by_role("menuitem", name="Remove the picture").click()
    sheet.page.reload()
    sheet.page.wait_for_selector(".studio.ready")
    assert sheet.page.locator(".sheet .background").count() == 0


def test_an_end_that_the_grid_leads_to_a_point_is_joined_there(sheet):
    step, scale = sheet.page.evaluate(
        """() => {
          const { sheet } = document.querySelector(".studio").studio;
          return [sheet.step, sheet.scale];
        }"""
    )
    sheet.tool("link")
    sheet.click((0, 0), (4 * step, 0))
    # Nearer to the end of the first link than to any other point of the grid, yet further away from it
    # than the pointer finds points.
    beside = 0.45 * step
    assert beside * scale > 12
    sheet.tool("link")
    sheet.click((4 * step + beside, -beside), (8 * step, -3 * step))
    assert len(sheet.file["joints"]) == 1


def test_a_spring_is_selected_by_a_click_and_once_it_is_made(sheet):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click((0.2, 0))
    sheet.tool("spring")
    sheet.click((0.1, 0.15), (0.2, 0))
    title = sheet.page.locator(".inspector h2")
    assert title.inner_text() == "Force spring"
    sheet.tool("select")
    sheet.click((0.3, 0.2))
    assert title.inner_text() != "Force spring"
    sheet.click((0.15, 0.075))
    assert title.inner_text() == "Force spring"
    assert sheet.page.locator(".marks .selected.bar").count() == 1
    # A double click on its name does not reach what comes to stand there.
    sheet.click((0.3, 0.2))
    sheet.page.locator(".related button", has_text="spring").dblclick()
    assert "spring" in sheet.file["forces"]


def test_a_named_length_is_changed_by_its_dimension(sheet):
    crank(sheet)
    sheet.tool("select")
    sheet.click((0.175, 0.1))
    for length, name in (("260", "rod_length"), ("280", "")):
        sheet.page.locator(".marks .dimension").first.dispatch_event("pointerdown")
        fields = sheet.page.locator("dialog input")
        fields.nth(0).fill(length)
        fields.nth(1).fill(name)
        sheet.page.locator("dialog button.primary").click()
    sheet.page.locator("dialog button.primary", has_text="Change rod_length").click()
    assert sheet.file["parameters"]["rod_length"]["value"] == 0.28


def test_a_form_takes_a_length_with_its_unit(sheet):
    crank(sheet)
    sheet.tool("select")
    sheet.click((0.175, 0.1))
    field = sheet.page.locator(".inspector .field", has_text="C x").locator("input")
    field.fill("240 mm")
    field.press("Enter")
    assert sheet.file["bodies"]["link_2"]["markers"]["C"][0] == "240*mm"


def test_a_free_end_dropped_on_a_pin_is_joined(sheet):
    crank(sheet)
    sheet.tool("link")
    sheet.click((0.4, 0), ground=True)
    sheet.click((0.5, 0.1))
    sheet.tool("select")
    sheet.drag((0.5, 0.1), (0.3, 0.1))
    assert "1 degree of freedom" in sheet.status, sheet.text


def test_the_menu_says_why_something_cannot_be_done(sheet):
    crank(sheet)
    u, v = sheet.place((0, 0))
    sheet.page.mouse.click(u, v, button="right")
    menu = sheet.page.locator(".menu:not([hidden])")
    assert menu.locator("button:disabled small").count() >= 1
    sheet.page.keyboard.press("Escape")
    assert menu.count() == 0


@pytest.mark.parametrize("size", [(1440, 900), (1280, 720), (390, 844)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_fits_the_screen(chromium, folder, tmp_path, size, scheme):
    context = chromium.new_context(
        viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, has_touch=size[0] < 500
    )
    drawing = Drawing(context.new_page(), folder / "index.html", tmp_path)
    crank(drawing)
    assert drawing.page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    assert drawing.page.evaluate("() => document.documentElement.scrollHeight <= innerHeight")
    for button in drawing.page.locator(".bar button:visible").all():
        box = button.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= size[0]
    context.close()
    assert drawing.errors == []


def test_fingers_draw_and_pinch(chromium, folder, tmp_path):
    context = chromium.new_context(viewport={"width": 390, "height": 844}, has_touch=True)
    page = context.new_page()
    drawing = Drawing(page, folder / "index.html", tmp_path)
    page.locator(".tools button[value=link]").tap()
    for at in ((0.1, 0.1), (0.2, 0.2)):
        u, v = drawing.place(at)
        page.touchscreen.tap(u, v)
    assert len(drawing.file["bodies"]) == 1
    scale = "() => document.querySelector('.studio').studio.sheet.scale"
    before = page.evaluate(scale)
    session = context.new_cdp_session(page)
    for kind, apart in (("touchStart", 40), ("touchMove", 80), ("touchMove", 120)):
        points = [{"x": 195 - apart, "y": 400, "id": 1}, {"x": 195 + apart, "y": 400, "id": 2}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    assert page.evaluate(scale) == pytest.approx(3 * before, rel=0.1)
    context.close()
    assert drawing.errors == []
