"""The hand of a person at the studio: clicks on the sheet, keys, windows."""

import base64
import json
import tomllib
import zlib
from pathlib import Path

STUDIO = "document.querySelector('.studio').studio"

# Tools by the keys that choose them.
KEYS = {
    "select": "v",
    "link": "l",
    "plate": "p",
    "pivot": "g",
    "slider": "s",
    "slot": "o",
    "cylinder": "c",
    "gears": "w",
    "driver": "d",
    "freedom": "f",
    "trace": "t",
    "mass": "m",
    "spring": "i",
    "weld": "x",
    "friction": "n",
    "stop": "e",
    "coupling": "z",
    "rope": "y",
    "track": "j",
    "cam": "k",
    "bar": "B",
    "disc": "D",
    "outline": "O",
    "hole": "H",
    "contact": "C",
}


def link_to(text):
    """The part of an address that holds a mechanism."""
    pack = zlib.compressobj(wbits=-15)
    packed = pack.compress(json.dumps(["friend.toml", text, []]).encode()) + pack.flush()
    return "#m=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")


class Drawing:
    """A studio in a browser. Points are in metres."""

    def __init__(self, page, index: Path, folder: Path, address: str | None = None):
        self.page = page
        self.index = index
        self.folder = folder
        self.errors = []
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", lambda line: line.type in ("error", "warning") and self.errors.append(line.text))
        page.goto(address or index.as_uri())
        page.wait_for_selector(".studio.ready")

    def place(self, at):
        """Returns where a point is on the screen."""
        return self.page.evaluate(
            """(at) => {
              const { sheet } = document.querySelector(".studio").studio;
              const box = sheet.place.getBoundingClientRect();
              const [u, v] = sheet.toScreen(at);
              return [u + box.left, v + box.top];
            }""",
            list(at),
        )

    def tool(self, name):
        self.page.locator(".sheet").focus()
        self.page.keyboard.press("Escape")
        self.page.keyboard.press(KEYS[name])

    def click(self, *points, ground=False):
        """Clicks points one after the other, with Ctrl pressed where they are on ground."""
        for at in points:
            u, v = self.place(at)
            self.page.mouse.move(u - 3, v - 2)
            self.page.mouse.move(u, v)
            if ground:
                self.page.keyboard.down("Control")
            self.page.mouse.click(u, v)
            if ground:
                self.page.keyboard.up("Control")

    def drag(self, start, end, steps=8):
        u, v = self.place(start)
        self.page.mouse.move(u, v)
        self.page.mouse.down()
        u, v = self.place(end)
        self.page.mouse.move(u, v, steps=steps)
        self.frame()
        self.page.mouse.up()
        self.frame()

    def frame(self):
        """Waits until what was asked for is drawn."""
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)

    def reload(self):
        self.page.reload()
        self.page.wait_for_selector(".studio.ready")

    def menu(self, name):
        """Chooses from the menu *File*."""
        self.page.locator(".file-menu").click()
        self.page.get_by_role("menuitem", name=name).click()

    @property
    def drafts(self) -> list[str]:
        """Texts of the drafts that the browser keeps."""
        return self.page.evaluate(f"() => {STUDIO}.drafts.all().map((draft) => draft.text)")

    @property
    def text(self) -> str:
        return self.page.evaluate(f"() => {STUDIO}.text")

    @property
    def file(self) -> dict:
        """The mechanism file, read."""
        return tomllib.loads(self.text)

    @property
    def state(self) -> str:
        return self.page.evaluate("() => document.querySelector('.studio').dataset.state")

    @property
    def status(self) -> str:
        return self.page.locator(".status .state").inner_text()

    @property
    def said(self) -> str:
        return self.page.locator(".said").inner_text()

    def export(self, fmi="2") -> Path:
        """Exports by the button and its window; returns the FMU."""
        self.page.locator("button.export").click()
        self.page.locator(f"dialog input[name=fmi][value='{fmi}']").check()
        with self.page.expect_download() as waiting:
            self.page.locator("dialog button.primary").click()
        path = self.folder / waiting.value.suggested_filename
        waiting.value.save_as(path)
        return path

    def list_templates(self):
        self.menu("Templates …")

    def open_template(self, name):
        self.list_templates()
        self.page.locator(".templates button").filter(has_text=name).first.click()
        self.page.wait_for_selector(".studio[data-state=driven]")

    def look(self, name):
        """Keeps a picture of the page."""
        self.page.screenshot(path=self.folder / f"{name}.png")
