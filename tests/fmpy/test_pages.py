"""Pages on which mechanisms move, in a real browser."""

import re
import shutil
import subprocess

import pytest
from browsing import browser, visit
from harness import ROOT, program


@pytest.fixture(scope="module")
def animated(tmp_path_factory):
    """The four-bar turning once in a second."""
    browser()
    page = tmp_path_factory.mktemp("pages") / "four_bar.html"
    subprocess.run(
        [
            *(program(), "run", ROOT / "mechanisms" / "four_bar.toml"),
            *("--drive", "crank_angle = 60*deg + 2*pi*t", "--stop", "1", "--step", "0.01"),
            *("--animate", page),
        ],
        check=True,
    )
    return page


def test_it_moves_by_itself(animated, tmp_path):
    first, second, playing = visit(
        tmp_path,
        animated,
        """
        const first = places();
        await pause(700);
        return [first, places(), find(".player").matches(".playing")];
        """,
    )
    assert playing
    assert len(first) > 5
    assert first != second
    # Marks on ground have no attachment: each attachment has a place.
    assert all(re.fullmatch(r"translate\(\S+ \S+\) rotate\(\S+\)", place) for place in second)


def test_it_keeps_still_for_those_who_want_it(animated, tmp_path):
    first, second, label = visit(
        tmp_path,
        animated,
        """
        const first = places();
        await pause(700);
        return [first, places(), find(".play").getAttribute("aria-label")];
        """,
        reduced=True,
    )
    assert first == second
    assert label == "Play"


def test_slider_and_buttons(animated, tmp_path):
    seen = visit(
        tmp_path,
        animated,
        """
        find(".play").click();
        const still = find(".play").getAttribute("aria-label");
        seek(25);
        const quarter = [find(".clock").textContent, find(".readings dd").textContent, places()];
        seek(50);
        const half = [find(".clock").textContent, find(".readings dd").textContent, places()];
        const shown = (kind) => all(`.arrows.${kind} path`)
          .filter((path) => path.getBoundingClientRect().width > 0).length;
        const before = [shown("velocity"), shown("acceleration")];
        all(".show").forEach((box) => box.click());
        const after = [shown("velocity"), shown("acceleration"), find(".names").getBoundingClientRect().width];
        find(".play").click();
        await pause(300);
        return { still, quarter, half, before, after, moved: places() };
        """,
    )
    assert seen["still"] == "Play"
    # One turn in a second from 60 degrees on.
    assert seen["quarter"][0] == "0.250 s"
    assert seen["half"][0] == "0.500 s"
    assert float(seen["quarter"][1].split()[0]) == pytest.approx(150, abs=0.06)
    assert float(seen["half"][1].split()[0]) == pytest.approx(240, abs=0.06)
    assert seen["quarter"][2] != seen["half"][2] != seen["moved"]
    assert seen["before"] == [0, 0]
    # The crank's and the rocker's pins and the coupler's point.
    assert seen["after"] == [3, 3, 0]


def test_keys(animated, tmp_path):
    seen = visit(
        tmp_path,
        animated,
        """
        press(" ");
        press("Home");
        const clocks = [find(".clock").textContent];
        for (const key of ["ArrowRight", "ArrowRight", "ArrowLeft", "End"]) {
          press(key);
          clocks.push(find(".clock").textContent);
        }
        press("v");
        return [clocks, find(".player").matches(".show-velocity"), find(".player").matches(".playing")];
        """,
    )
    assert seen == [["0.000 s", "0.010 s", "0.020 s", "0.010 s", "1.000 s"], True, False]


# Headless Chromium's window is at least 500 wide: a frame of the page's own width is not.
def test_a_phone_is_wide_enough(animated, tmp_path):
    frame = tmp_path / "frame.html"
    inner = tmp_path / "inner.html"
    shutil.copy(animated, inner)
    frame.write_text(
        "<!DOCTYPE html><html><head></head><body>"
        '<iframe src="inner.html" style="width:390px;height:800px;border:0"></iframe></body></html>'
    )
    seen = visit(
        tmp_path,
        frame,
        """
        await pause(300);
        const page = find("iframe").contentDocument;
        const parts = [".play", ".time", ".clock", ".speed", ".show", ".paper svg", "h1"];
        return {
          width: page.documentElement.scrollWidth,
          boxes: parts.map((part) => page.querySelector(part).getBoundingClientRect().toJSON()),
        };
        """,
    )
    assert seen["width"] == 390
    for box in seen["boxes"]:
        assert box["left"] >= 0 and box["right"] <= 390 and box["width"] > 0
    button, slider = seen["boxes"][:2]
    assert button["width"] >= 44 and button["height"] >= 44
    assert slider["width"] >= 150


@pytest.mark.parametrize("name", ["four_bar", "tlv", "cam_points", "planetary_gear"])
def test_an_fmu_documents_itself(fmu, name, tmp_path):
    browser()
    folder = fmu(name).folder
    seen = visit(
        tmp_path,
        folder / "documentation" / "index.html",
        """
        const first = places();
        await pause(500);
        return {
          moved: places().join() !== first.join(),
          title: document.title,
          names: all("td:first-child").map((cell) => cell.textContent),
          values: all("td[data-what=Value]").map((cell) => cell.textContent),
        };
        """,
    )
    assert seen["moved"]
    assert seen["title"] == name
    # Drivers, then parameters and settings, then the other variables.
    variables = fmu(name).variables.values()
    listed = [v.name for v in variables if v.causality in {"input", "output", "local"}]
    # By what they belong to, in the order of the first variable of each.
    owners = list(dict.fromkeys(name.split(".")[0] for name in listed))
    listed.sort(key=lambda name: owners.index(name.split(".")[0]))
    assert seen["names"][-len(listed) :] == listed
    parameters = [v.name for v in variables if v.causality in {"parameter", "calculatedParameter"}]
    assert seen["names"][-len(listed) - len(parameters) : -len(listed)] == parameters
    # Derived ones as well, which have no start value in the model description.
    assert len(seen["values"]) == len(parameters) and all(map(float, seen["values"]))


# A page within a page lives on when the inner one is loaded again.
def test_a_watched_file_is_seen_anew(tmp_path):
    browser()
    good = (ROOT / "mechanisms" / "pendulum.toml").read_text(encoding="utf-8")
    file = tmp_path / "watched.toml"
    texts = {
        "good": good,
        "another": good.replace('name = "pendulum"', 'name = "another"'),
        "broken": good.replace("ground.O", "ground.Oo"),
    }
    actions = {
        name: lambda text=text: file.write_text(text, encoding="utf-8")
        for name, text in texts.items()
    }
    actions["good"]()
    frame = tmp_path / "frame.html"
    frame.write_text(
        '<!DOCTYPE html><html><head></head><body><iframe src="/" '
        'style="width:800px;height:800px;border:0"></iframe></body></html>',
        encoding="utf-8",
    )
    watching = subprocess.Popen(
        [program(), "watch", file], stdout=subprocess.PIPE, text=True, encoding="utf-8"
    )
    actions["end"] = watching.terminate
    try:
        seen = visit(
            tmp_path,
            frame,
            """
            const inner = (selector) => find("iframe").contentDocument.querySelector(selector);
            const titled = (name) => until(() => inner("h1")?.textContent === name && inner(".stage"));
            const poses = () => [...inner(".stage").querySelectorAll("[data-attachment]")]
              .map((part) => part.getAttribute("transform")).join();
            const moves = async () => {
              const before = poses();
              await until(() => poses() !== before);
            };
            const has = (name) => fetch(name, { method: "POST" });
            const seen = {};

            await titled("pendulum");
            await moves();
            inner(".show[value=velocity]").click();
            seen.atFirst = inner(".error");
            const parts = () => inner(".stage").querySelectorAll("[data-attachment]").length;
            seen.parts = [parts()];

            await has("another");
            await titled("another");
            await until(() => inner(".player.playing"));
            await moves();
            seen.velocity = inner(".show[value=velocity]").checked;
            inner(".play").click();

            await has("broken");
            await until(() => inner(".error") && inner(".player"));
            seen.broken = inner(".error").textContent;
            seen.role = inner(".error").getAttribute("role");
            seen.stillTitled = inner("h1").textContent;
            seen.parts.push(parts());

            await has("good");
            await titled("pendulum");
            seen.mended = inner(".error");
            await until(() => inner(".player:not(.playing)"));
            seen.ended = [inner(".ended").hidden];
            await has("end");
            await until(() => !inner(".ended").hidden);
            return seen;
            """,
            actions=actions,
            behind=watching.stdout.readline().strip().rstrip("/"),
        )
    finally:
        watching.kill()
        watching.wait()
    assert seen["atFirst"] is None
    # Switches of the reader stay as they are on the new page.
    assert seen["velocity"]
    # The error with its line, and the last good picture with it.
    assert "no marker `Oo` on `ground`" in seen["broken"] and "watched.toml:" in seen["broken"]
    assert seen["role"] == "alert"
    assert seen["stillTitled"] == "another"
    assert seen["parts"][0] == seen["parts"][1] > 0
    assert seen["mended"] is None
    assert seen["ended"] == [True]


def test_everything_can_be_used_without_a_mouse(animated, tmp_path):
    """Controls have names, the one in focus is seen, and time does not talk all the while."""
    seen = visit(
        tmp_path,
        animated,
        """
        const controls = all(".player button, .player input, .player select");
        const named = controls.map((control) =>
          control.getAttribute("aria-label") ?? control.closest("label")?.textContent.trim());
        const outlines = controls.map((control) => {
          control.focus({ focusVisible: true });
          const { outlineStyle, outlineWidth } = getComputedStyle(control);
          return [control === document.activeElement, outlineStyle, parseFloat(outlineWidth)];
        });
        seek(50);
        return {
          named, outlines,
          spoken: find(".time").getAttribute("aria-valuetext"),
          live: find(".clock").getAttribute("aria-live"),
        };
        """,
    )
    assert all(seen["named"]) and len(seen["named"]) == 6
    # The crank's pin is the fastest at 2 pi/s * 0.1 m, or the coupler's point is faster.
    velocity = next(name for name in seen["named"] if name.startswith("Velocity, up to"))
    assert 0.1 * 6.283 <= float(velocity.split()[-2]) < 1 and velocity.endswith(" m/s")
    assert seen["outlines"] == [[True, "solid", 3]] * 6
    assert seen["spoken"] == "0.500 s"
    assert seen["live"] == "off"


def test_a_page_with_more_to_read_keeps_its_keys(fmu, tmp_path):
    """Home scrolls the documentation, unless one is at the player."""
    browser()
    moments = visit(
        tmp_path,
        fmu("four_bar").folder / "documentation" / "index.html",
        """
        seek(30);
        press("Home");
        const after = [find(".time").value];
        const key = new KeyboardEvent("keydown", { key: "Home", bubbles: true });
        find(".player").dispatchEvent(key);
        return [...after, find(".time").value];
        """,
    )
    assert moments == ["30", "0"]


@pytest.mark.parametrize("name", ["jansen_leg", "excavator_arm", "rack_drive"])
def test_names_are_apart_and_inside_the_picture_on_a_phone(fmu, name, tmp_path):
    browser()
    shutil.copy(fmu(name).folder / "documentation" / "index.html", tmp_path / "inner.html")
    frame = tmp_path / "frame.html"
    frame.write_text(
        "<!DOCTYPE html><html><head></head><body>"
        '<iframe src="inner.html" style="width:390px;height:800px;border:0"></iframe></body></html>'
    )
    outside, over, cells = visit(
        tmp_path,
        frame,
        """
        await pause(300);
        const page = find("iframe").contentDocument;
        const stage = page.querySelector(".stage").getBoundingClientRect();
        const boxes = [...page.querySelectorAll(".names text")]
          .map((text) => [text.textContent, text.getBoundingClientRect()])
          .filter(([, box]) => box.width > 0);
        // Fonts differ by a little from the letters that the film has measured.
        const slack = 5;
        const outside = boxes.filter(([, box]) => box.left < stage.left - slack || box.right > stage.right + slack);
        const over = boxes.flatMap(([one, a], index) => boxes.slice(0, index)
          .filter(([, b]) => a.left + slack < b.right && b.left + slack < a.right
            && a.top + slack < b.bottom && b.top + slack < a.bottom)
          .map(([other]) => `${one} over ${other}`));
        const cut = [...page.querySelectorAll("td")]
          .filter((cell) => cell.textContent && cell.getBoundingClientRect().right > 390);
        return [outside.map(([name]) => name), over, cut.map((cell) => cell.textContent)];
        """,
        # Names that move may meet.
        reduced=True,
    )
    assert outside == []
    assert over == []
    assert cells == []
