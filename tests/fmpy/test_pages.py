"""Pages on which mechanisms move, in a real browser.

They run where a Chromium or Chrome is found (BIELA_CHROMIUM names another one) and are skipped
elsewhere. The browser loads the page with a script added, which uses it as a person does and
sends back what it saw.
"""

import functools
import http.server
import json
import os
import queue
import re
import shutil
import subprocess
import threading

import pytest
from harness import ROOT, program

BROWSERS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]

# Errors are collected from the start; the visit ends with sending its findings.
BEFORE = """<script>
const errors = [];
addEventListener("error", (event) => errors.push(event.message));
console.error = console.warn = (...words) => errors.push(words.join(" "));
</script>"""
AFTER = """<script>
const find = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
const pause = (time) => new Promise((done) => setTimeout(done, time));
const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const places = () => all("[data-rider]").map((part) => part.getAttribute("transform"));
const seek = (moment) => {
  find(".time").value = moment;
  find(".time").dispatchEvent(new Event("input", { bubbles: true }));
};
const inside = (part) => {
  const box = part.getBoundingClientRect();
  return box.left >= 0 && box.right <= innerWidth && box.width > 0;
};
(async () => {
  let seen;
  try {
    seen = await visit();
  } catch (error) {
    errors.push(String(error));
  }
  fetch("/seen", { method: "POST", body: JSON.stringify({ seen, errors }) });
})();
</script>"""


def browser():
    named = os.environ.get("BIELA_CHROMIUM")
    found = [named] if named else filter(None, map(shutil.which, BROWSERS))
    found = next(iter(found), None)
    if found is None:
        pytest.skip("no Chromium or Chrome on PATH: pages are not tried in a browser")
    return found


class Server(http.server.SimpleHTTPRequestHandler):
    """Serves a folder on loopback, and takes what a page has to say."""

    def __init__(self, *arguments, answers, **more):
        self.answers = answers
        super().__init__(*arguments, **more)

    def do_POST(self):
        length = int(self.headers["Content-Length"])
        self.answers.put(json.loads(self.rfile.read(length)))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


def visit(tmp_path, page, script, reduced=False):
    """What a script's `visit` returns on a page; the page's errors fail the test."""
    text = page.read_text(encoding="utf-8")
    assert "<head>" in text and "</body>" in text
    changed = tmp_path / "visited.html"
    changed.write_text(
        text.replace("<head>", "<head>" + BEFORE, 1).replace(
            "</body>", f"<script>async function visit() {{ {script} }}</script>{AFTER}</body>"
        ),
        encoding="utf-8",
    )
    answers = queue.Queue()
    handler = functools.partial(Server, answers=answers, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        command = [
            *(browser(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic"),
            *("--no-first-run", "--disable-background-networking", "--disable-component-update"),
            *("--disable-sync", f"--user-data-dir={tmp_path / 'profile'}"),
            *(["--force-prefers-reduced-motion"] if reduced else []),
            f"http://127.0.0.1:{server.server_port}/{changed.name}",
        ]
        quiet = subprocess.DEVNULL
        running = subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet)
        try:
            answer = answers.get(timeout=60)
        finally:
            running.terminate()
            running.wait(timeout=30)
            server.shutdown()
    assert answer["errors"] == []
    return answer["seen"]


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
    # What is on ground is no rider: all that has a place has one.
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


@pytest.mark.parametrize("name", ["four_bar", "tlv", "cam_points"])
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
        };
        """,
    )
    assert seen["moved"]
    assert seen["title"] == name
    # Drivers, then parameters and settings, then the other variables.
    variables = fmu(name).variables.values()
    listed = [v.name for v in variables if v.causality in {"input", "output", "local"}]
    assert seen["names"][-len(listed) :] == listed
    parameters = [v.name for v in variables if v.causality in {"parameter", "calculatedParameter"}]
    assert seen["names"][-len(listed) - len(parameters) : -len(listed)] == parameters
