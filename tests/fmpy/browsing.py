"""A real browser for pages: loads one with a script added, which uses it as a person does and
sends back what it saw.

Tests that ask for a browser run where a Chromium or Chrome is found (BIELA_CHROMIUM names another
one) and are skipped elsewhere.
"""

import functools
import http.server
import json
import os
import queue
import shutil
import subprocess
import threading
import urllib.request

import pytest

BROWSERS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]

# Errors are collected from the start; the visit ends with sending its findings.
BEFORE = """<script>
window.errors = [];
addEventListener("error", (event) => errors.push(event.message));
console.error = console.warn = (...words) => errors.push(words.join(" "));
</script>"""
# In a frame: its errors are those of the page around it.
FRAMED = """<script>
addEventListener("error", (event) => parent.errors.push(event.message));
console.error = console.warn = (...words) => parent.errors.push(words.join(" "));
</script>"""
AFTER = """<script>
const find = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
const pause = (time) => new Promise((done) => setTimeout(done, time));
const until = async (test) => {
  for (let round = 0; round < 600; round += 1) {
    if (test()) return;
    await pause(50);
  }
  throw new Error(`it never came to ${test}`);
};
const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const places = () => all("[data-attachment]").map((part) => part.getAttribute("transform"));
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


def find_browser():
    """Returns the path of a Chromium or Chrome, None if there is none."""
    named = os.environ.get("BIELA_CHROMIUM")
    return named or next(filter(None, map(shutil.which, BROWSERS)), None)


def browser():
    found = find_browser()
    if found is None:
        pytest.skip("no Chromium or Chrome on PATH: pages are not tried in a browser")
    return found


class Server(http.server.SimpleHTTPRequestHandler):
    """Serves a folder on loopback, takes what a page has to say and does what it asks for.

    What is not in the folder comes from `behind`, the address of another server, if there is one;
    so that a page may look into that one's pages.
    """

    def __init__(self, *arguments, answers, actions, behind, **more):
        self.answers, self.actions, self.behind = answers, actions, behind
        super().__init__(*arguments, **more)

    def do_GET(self):
        if self.behind is None or os.path.isfile(self.translate_path(self.path)):
            super().do_GET()
            return
        try:
            with urllib.request.urlopen(self.behind + self.path, timeout=30) as answer:
                kind = answer.headers["Content-Type"]
                body = answer.read().replace(b"<head>", b"<head>" + FRAMED.encode(), 1)
        except OSError:
            # As for a browser whose server has ended.
            self.close_connection = True
            return
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        if self.path == "/seen":
            length = int(self.headers["Content-Length"])
            self.answers.put(json.loads(self.rfile.read(length)))
        else:
            self.actions[self.path.removeprefix("/")]()
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


def visit(tmp_path, page, script, *, reduced=False, actions=None, behind=None):
    """Returns the value of a script's `visit` on a page; the page's errors fail the test.

    The script may POST to the name of one of the `actions`, which is called then.
    """
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
    handler = functools.partial(
        Server, answers=answers, actions=actions or {}, behind=behind, directory=tmp_path
    )
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
    assert answer["errors"] == [], answer
    return answer["seen"]
