"""Random drawing: whatever is clicked, dragged and typed, nothing breaks, and undo returns."""

import random

import pytest
from drawing import STUDIO

# Tools that a random hand takes, with the number of clicks that it makes.
TOOLS = {
    "link": 2,
    "plate": 3,
    "pivot": 1,
    "slider": 2,
    "slot": 2,
    "cylinder": 2,
    "gears": 3,
    "driver": 1,
    "freedom": 1,
    "trace": 1,
    "mass": 1,
}
SEQUENCES = 200
GESTURES = 12
# Sequences on one page after the other.
TOGETHER = 20


def points(sheet):
    return sheet.page.evaluate(f"() => {STUDIO}.view.sketch?.points.map((point) => point.at) ?? []")


def somewhere(sheet, hand):
    """A point that is drawn already, or a place of the sheet."""
    known = points(sheet)
    if known and hand.random() < 0.6:
        return hand.choice(known)
    return (hand.randrange(-4, 12) * 0.05, hand.randrange(-4, 9) * 0.05)


def gesture(sheet, hand):
    if hand.random() < 0.25 and points(sheet):
        sheet.tool("select")
        sheet.drag(hand.choice(points(sheet)), somewhere(sheet, hand), steps=3)
        # A question about a parameter is answered by leaving it.
        if sheet.page.locator("dialog").count():
            sheet.page.keyboard.press("Escape")
        return
    if hand.random() < 0.1 and points(sheet):
        sheet.tool("select")
        sheet.click(hand.choice(points(sheet)))
        sheet.press("Delete")
        return
    name = hand.choice(list(TOOLS))
    sheet.tool(name)
    for _ in range(TOOLS[name]):
        sheet.click(somewhere(sheet, hand), ground=hand.random() < 0.3)
        if sheet.page.locator(".menu:not([hidden])").count():
            sheet.page.locator(".menu button").first.click()
    if name == "plate":
        sheet.press("Enter")


@pytest.mark.parametrize("first_seed", range(0, SEQUENCES, TOGETHER))
def test_undo_and_redo_of_random_drawings(sheet, first_seed):
    empty = sheet.text
    for seed in range(first_seed, first_seed + TOGETHER):
        sheet.page.evaluate(
            f"(text) => {STUDIO}.open({{ name: 'mechanism.toml', text }})", empty
        )
        draw_at_random(sheet, seed)


def draw_at_random(sheet, seed):
    hand = random.Random(seed)
    first = sheet.text
    for _ in range(GESTURES):
        gesture(sheet, hand)
    assert sheet.state in ("empty", "undriven", "driven", "free", "open", "rigid"), seed
    last = sheet.text
    undo, redo = sheet.page.locator(".bar .undo"), sheet.page.locator(".bar .redo")
    steps = 0
    while undo.is_enabled():
        undo.click()
        steps += 1
    assert sheet.text == first, seed
    for _ in range(steps):
        redo.click()
    assert sheet.text == last, seed


def test_dragging_costs_less_than_drawing_anew(sheet):
    """Each picture of a dragged pin, 30 bodies on the sheet, beside the whole view: it leaves out labels
    and what the pointer finds. The quickest of several counts."""
    bars = []
    for k in range(15):
        x = 0.1 * k
        bars.append(
            f"""
[bodies.crank_{k}]
markers = {{ A = [0, 0], B = [0.05, 0] }}
estimate = [{x:.2f}, 0, "60*deg"]

[bodies.rod_{k}]
markers = {{ B = [0, 0], C = [0.09, 0] }}
estimate = [{x + 0.025:.3f}, 0.0433, "-29*deg"]
"""
        )
    ground = "\n".join(f"A{k} = [{0.1 * k:.2f}, 0]" for k in range(15))
    joints = "\n".join(
        f'A{k} = {{ type = "revolute", markers = ["ground.A{k}", "crank_{k}.A"] }}\n'
        f'B{k} = {{ type = "revolute", markers = ["crank_{k}.B", "rod_{k}.B"] }}\n'
        f'C{k} = {{ type = "slot", markers = ["ground.A{k}", "rod_{k}.C"] }}'
        for k in range(15)
    )
    drivers = "\n".join(
        f'turn_{k} = {{ coordinate = "angle", markers = ["ground.A{k}", "crank_{k}.A"], start = "60*deg" }}'
        for k in range(15)
    )
    text = f'format = 1\nname = "many"\n\n[ground.markers]\n{ground}\n{"".join(bars)}\n[joints]\n{joints}\n\n[drivers]\n{drivers}\n'
    times = sheet.page.evaluate(
        """(text) => {
          const { studio } = document.querySelector(".studio");
          studio.open({ name: "many.toml", text });
          const quickest = (act) => {
            let least = Infinity;
            for (let k = 0; k < 40; k += 1) {
              const before = performance.now();
              act(k);
              least = Math.min(least, performance.now() - before);
            }
            return least;
          };
          const drag = (k) => studio.preview({ kind: "shift", markers: ["rod_7.B"], by: [0.0005 * k, 0] });
          const draw = () => studio.show(studio.ask({ do: "view", scale: studio.sheet.scale }));
          return [quickest(drag), quickest(draw)];
        }""",
        text,
    )
    assert sheet.state == "driven", sheet.status
    print("30 bodies: dragged in {:.1f} ms, drawn anew in {:.1f} ms".format(*times))
    assert times[0] < times[1]
