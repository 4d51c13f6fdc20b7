"""A random hand draws, drags, deletes, undoes and types, among reloads, tabs, links, templates, servers that
are killed and files that other programs change. After each step nothing of it is lost."""

import random

import pytest
from drawing import STUDIO, link_to
from serving import until
from test_random import gesture

SEEDS = 10
GESTURES = 50
EMPTY = 'format = 1\nname = "mechanism"\n'
TEMPLATES = ["four_bar", "slider_crank", "loader"]
MOST_TABS = 3
# What is typed at the end of a line.
TYPED = ["# a word", "  ", "oops", "0", "\n# a line"]
# A page as it is: its draft, the text that is seen, what was said since the last look, and how it is with the
# file on the disk.
LOOK = f"""() => {{
  const studio = {STUDIO};
  if (!studio.told) {{
    studio.told = [studio.find(".said").textContent];
    const say = studio.say.bind(studio);
    studio.say = (text) => {{ studio.told.push(text); say(text); }};
  }}
  const {{ draft, disk, editor, told }} = studio;
  const line = studio.find(".unsaved");
  return {{
    id: draft.id, changed: draft.changed, text: editor.text, said: told.splice(0).join(" "),
    unsaved: line.hidden ? "" : line.innerText,
    disk: disk?.id, waits: Boolean(disk?.waits), busy: Boolean(disk?.busy), conflict: Boolean(disk?.changed),
  }};
}}"""
# Texts of the drafts that this tab and all tabs keep, by their names.
STORE = """() => Object.fromEntries([sessionStorage, localStorage].flatMap((store) =>
  Object.keys(store).filter((key) => key.startsWith("biela.draft.")).map((key) => {
    const { words, text } = JSON.parse(store.getItem(key));
    return [key.slice("biela.draft.".length), words ?? text];
  })))"""
# Presses a button of the bar as often as possible; returns the text.
PRESS = f"""(name) => {{
  const button = {STUDIO}.find(`.bar .${{name}}`);
  while (!button.disabled) button.click();
  return {STUDIO}.editor.text;
}}"""


class Person:
    """One who works in tabs of a browser and expects to find there what was seen last."""

    def __init__(self, hand, sheet, open_tab, server=None, file=None):
        self.hand, self.sheet, self.open_tab, self.server, self.file = hand, sheet, open_tab, server, file
        self.tabs = [sheet]
        self.runs = True
        # Of the drafts that were changed, by their names: the text in which each began, and the last one.
        self.first, self.last = {}, {}
        # The text to which undo leads, by the tabs.
        self.base = {}
        self.steps = []
        self.begun()

    @property
    def page(self):
        return self.sheet.page

    @property
    def on_disk(self):
        return self.file.read_text() if self.file and self.file.exists() else None

    def look(self):
        return self.page.evaluate(LOOK)

    def store(self):
        return self.page.evaluate(STORE)

    # -- what must be ------------------------------------------------------------------------------

    def begun(self, text=None):
        """The tab shows a drawing that was opened."""
        now = self.look()
        assert text is None or now["text"] == text
        self.base[self.sheet] = self.first.get(now["id"], now["text"])
        self.note(now)
        self.check()

    def note(self, now):
        if now["changed"]:
            self.last[now["id"]] = now["text"]
            self.first[now["id"]] = self.base[self.sheet]

    def done(self, before, now=None):
        """The tab shows the outcome of a gesture."""
        now = now or self.look()
        if now["id"] != before["id"]:
            assert "Another tab has" in now["said"]
        # A tab that lags behind another one may be looked at.
        if now["id"] not in self.last or now["text"] != before["text"]:
            self.note(now)

    def check(self):
        kept = self.store()
        assert {name: kept.get(name) for name in self.last} == self.last
        until(self.is_settled)
        now = self.look()
        # While something waits, and only then, a line says so.
        assert (now["unsaved"] != "") == now["waits"], now
        if now["waits"] and now["conflict"]:
            assert "another program" in now["unsaved"]
        elif now["waits"]:
            assert not self.runs
            assert "does not answer" in now["unsaved"]

    def is_settled(self):
        now = self.look()
        return not now["busy"] and (not now["waits"] or now["conflict"] or not self.runs)

    def give_way(self, disk):
        """A drawing that gave way to the file on the disk is a draft of its own."""
        kept = self.store()
        if disk in self.last and kept.get(disk) != self.last[disk]:
            text = self.last.pop(disk)
            name = next(name for name in kept if name not in self.last and kept[name] == text)
            self.last[name], self.first[name] = text, self.first.pop(disk)

    def loaded(self, before=None):
        """A page that was opened shows what was seen last, or what another program has made of the file."""
        self.page.wait_for_selector(".studio.ready")
        now = self.look()
        self.give_way(now["disk"])
        assert before is None or now["id"] == before["id"]
        if now["id"] in self.last:
            self.begun(self.last[now["id"]])
        elif now["id"] == now["disk"]:
            self.begun(self.on_disk)
        else:
            self.begun(before["text"] if before else EMPTY)

    # -- gestures ----------------------------------------------------------------------------------

    def draw(self):
        gesture(self.sheet, self.hand)

    def undo(self):
        self.page.locator(".sheet").focus()
        self.sheet.press(*self.hand.choices(["Control+z", "Control+z", "Control+y"], k=2))

    def type(self):
        self.page.locator(".editor .cm-content").focus()
        self.sheet.press("Control+Home", *["ArrowDown"] * self.hand.randrange(12), "End")
        self.page.keyboard.type(self.hand.choice(TYPED))
        self.sheet.press("Escape")
        if self.sheet.state == "broken" and self.hand.random() < 0.8:
            self.sheet.press("Control+z")

    def walk(self):
        """Goes back to the first bytes, and on to the last."""
        last = self.page.evaluate(PRESS, "redo")
        assert self.page.evaluate(PRESS, "undo") == self.base[self.sheet]
        assert self.page.evaluate(PRESS, "redo") == last

    # -- what comes between ------------------------------------------------------------------------

    def reload(self):
        before = self.look()
        if self.runs:
            self.page.reload()
        else:
            # The page is gone, too, before the next server comes.
            self.page.goto("about:blank")
            self.start()
            self.page.goto(self.server.address)
        self.loaded(before)

    def reload_at_once(self, before):
        """Reloads before the page has done anything after a gesture."""
        with self.page.expect_navigation():
            now = self.page.evaluate(f"() => {{ const now = ({LOOK})(); location.reload(); return now; }}")
        self.done(before, now)
        self.loaded(now)

    def go_to_tab(self):
        if len(self.tabs) == MOST_TABS:
            self.tabs.remove(self.sheet)
            self.page.close()
            self.sheet = self.hand.choice(self.tabs)
        elif self.runs and self.hand.random() < 0.5:
            self.sheet = self.open_tab(self.server.address if self.server else None)
            self.tabs.append(self.sheet)
            self.loaded()
        else:
            self.sheet = self.hand.choice(self.tabs)
        self.page.bring_to_front()

    def new(self):
        self.sheet.menu("New")
        self.begun(EMPTY)

    def template(self):
        self.sheet.open_template(self.hand.choice(TEMPLATES))
        self.begun()

    def link(self):
        text = self.hand.choice([*self.last.values(), EMPTY]) + "# from a friend\n"
        before = self.look()
        self.page.evaluate("(link) => { location.hash = link; }", link_to(text))
        self.page.wait_for_function(f"(id) => {STUDIO}.draft.id !== id", arg=before["id"])
        self.begun(text)

    def draft(self):
        kept = self.page.evaluate(f"() => {STUDIO}.drafts.all().map(({{ id }}) => id)")
        if kept:
            before, name = self.look(), self.hand.choice(kept)
            self.sheet.menu("Drafts")
            self.page.locator(".draft button:first-child").nth(kept.index(name)).click()
            self.page.wait_for_function(f"(id) => {STUDIO}.draft.id === id", arg=name)
            if name != before["id"]:
                self.begun(self.last[name])

    # -- the file on the disk ----------------------------------------------------------------------

    def kill(self):
        self.server.stop()
        self.runs = False

    def start(self):
        if not self.runs:
            self.server.start()
            self.runs = True

    def change_file(self):
        self.file.write_text((self.on_disk or EMPTY) + f"# by another program: {self.hand.random()}\n")

    def settle(self):
        """Chooses between the file and the drawing, where both were changed."""
        now = self.look()
        if not self.page.locator(".unsaved .choices").is_visible() or not self.runs:
            return
        if self.hand.random() < 0.5:
            self.page.locator(".unsaved .from-disk").click()
            self.page.wait_for_function(f"(text) => {STUDIO}.editor.text === text", arg=self.on_disk)
            self.give_way(now["disk"])
            self.begun(self.on_disk)
        else:
            self.page.locator(".unsaved .to-disk").click()
            until(lambda: self.on_disk == now["text"])

    def back(self):
        now = self.look()
        if now["id"] != now["disk"]:
            self.sheet.menu("Back to")
            self.begun(self.last.get(now["disk"]))

    # -- all of it ---------------------------------------------------------------------------------

    def choose(self, *acts):
        act = self.hand.choice(acts)
        self.steps.append(act.__name__)
        return act

    def work(self, gestures):
        between = [self.reload, self.go_to_tab, self.go_to_tab, self.new, self.template, self.link, self.draft]
        if self.server:
            of_disk = [self.kill, self.start, self.start, self.change_file, self.settle, self.settle, self.back]
            between = [*between, *of_disk, *of_disk]
        for _ in range(gestures):
            before = self.look()
            self.done(before, before)
            self.choose(*[self.draw] * 6, self.undo, self.type, self.walk)()
            if self.runs and self.hand.random() < 0.1:
                self.steps.append("at once")
                self.reload_at_once(before)
            else:
                self.done(before)
                self.check()
            if self.hand.random() < 0.4:
                self.choose(*between)()
                self.check()
        if self.server:
            self.start()
        for self.sheet in self.tabs:
            self.reload()
        for name, text in self.last.items():
            self.steps.append(name)
            self.page.evaluate(f"(id) => {STUDIO}.open({STUDIO}.drafts.get(id))", name)
            assert self.look()["text"] == text
            self.base[self.sheet] = self.first[name]
            self.walk()


def work(person, gestures):
    try:
        person.work(gestures)
    except BaseException:
        print("steps:", ", ".join(person.steps))
        raise


@pytest.mark.parametrize("seed", range(0, SEEDS, 2))
def test_nothing_is_lost(sheet, tab, seed):
    work(Person(random.Random(seed), sheet, tab), GESTURES)


# A short one is quick.
@pytest.mark.parametrize(
    ("seed", "gestures"),
    [*((seed, GESTURES) for seed in range(1, SEEDS, 2)), pytest.param(SEEDS + 1, 8, marks=pytest.mark.smoke)],
)
def test_nothing_is_lost_beside_a_server_and_a_file(served, tab, seed, gestures):
    sheet, server, file = served
    work(Person(random.Random(seed), sheet, tab, server, file), gestures)
