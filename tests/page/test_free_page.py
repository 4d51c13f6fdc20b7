"""Free motion on pages, in a real browser."""

import math
import subprocess
from pathlib import Path

import pytest
from harness import ROOT, program
from looking import look

FREE = [
    path.stem
    for path in sorted((ROOT / "mechanisms").glob("*.toml"))
    if "[freedoms" in path.read_text(encoding="utf-8")
]
LENGTH, GRAVITY = 0.5, 9.81

# The pointer of a person who takes a body at a global point, and may be slow to let go.
TAKE = """
const paper = find(".paper");
paper.setPointerCapture = () => {};
const send = (kind, [x, y]) => {
  const [clientX, clientY] = point(x, y);
  paper.dispatchEvent(new PointerEvent(kind, { clientX, clientY, pointerId: 1, button: 0, bubbles: true, cancelable: true }));
};
const spring = () => live.picture.spring.getAttribute("d");
"""


@pytest.mark.smoke
def test_a_pendulum_swings_and_keeps_its_energy(page_of, tmp_path):
    rows, before, time, message = look(
        tmp_path,
        page_of("pendulum_free"),
        """
        const rows = [];
        const before = number("energy.total");
        press(" ");
        for (let k = 0; k < 12; k += 1) {
          await pause(100);
          rows.push(["swing.position", "swing.velocity", "energy.total"].map(number));
        }
        press(" ");
        const time = frame()[0];
        await pause(100);
        return [rows, before, [time, frame()[0]], message()];
        """,
    )
    assert message == ""
    assert 0.3 < time[0] == time[1]
    assert len({row[0] for row in rows}) > 6
    for angle, velocity, energy in rows:
        assert abs(energy - before) < 1e-6
        # From rest at 120°: the square of the speed by the height.
        square = 3 * GRAVITY / LENGTH * (math.cos(angle) + 0.5)
        assert abs(velocity**2 - square) < 1e-5


def test_steps_and_reset(page_of, tmp_path):
    home, forward, back, again = look(
        tmp_path,
        page_of("double_pendulum"),
        """
        const state = () => [frame()[0], ...places()];
        const home = state();
        press("ArrowRight");
        press("ArrowRight");
        const forward = state();
        press("ArrowLeft");
        const back = state();
        find(".reset").click();
        return [home, forward, back, state()];
        """,
    )
    assert forward[0] == pytest.approx(2 / 60) and back[0] == pytest.approx(1 / 60)
    assert forward[1:] != back[1:] != home[1:]
    assert again == home


def test_a_slider_sets_the_start(page_of, tmp_path):
    held, velocity, acceleration, later, load = look(
        tmp_path,
        page_of("slider_crank_motor"),
        """
        press(" ");
        await pause(300);
        const row = live.drivers[0];
        row.field.value = "90";
        row.field.dispatchEvent(new Event("change"));
        const names = ["crank_angle.position", "crank_angle.velocity", "crank_angle.acceleration"];
        const seen = names.map(number);
        const motor = [...document.querySelectorAll(".rate-rows .row")].find((r) => r.textContent.startsWith("motor"));
        const field = motor.querySelector("[type=number]");
        field.value = "0.5";
        field.dispatchEvent(new Event("change"));
        press(" ");
        await pause(500);
        press(" ");
        return [...seen, number("crank_angle.velocity"), find(".moved").value];
        """,
    )
    assert held == pytest.approx(math.pi / 2, abs=1e-12)
    assert velocity == 0
    assert math.isfinite(acceleration)
    assert later > 0.5
    assert load == "time"


def test_the_mouse_throws_a_body(page_of, tmp_path):
    held, hung, thrown, gone, energies, message = look(
        tmp_path,
        page_of("four_bar_free"),
        TAKE
        + """
        const pin = () => [0.4 + 0.3 * Math.cos(number("rocker.phi")), 0.3 * Math.sin(number("rocker.phi"))];
        // At rest first.
        live.ask({ do: "speed", driver: 0, velocity: 0, acceleration: 0 });
        press(" ");
        await pause(100);
        const before = number("energy.total");
        send("pointerdown", pin());
        const held = spring();
        let thrown = 0;
        for (let k = 1; k <= 12; k += 1) {
          send("pointermove", [0.25 - 0.03 * k, 0.2]);
          await pause(40);
          thrown = Math.max(thrown, Math.abs(number("rocker.omega")));
        }
        const hung = spring();
        send("pointerup", [-0.1, 0.2]);
        await pause(100);
        return [held, hung, thrown, spring(), [before, number("energy.total")], message()];
        """,
    )
    assert held and hung and held != hung
    assert gone == ""
    assert thrown > 0.5
    assert abs(energies[1] - energies[0]) > 1e-2
    assert message == ""


def test_a_paused_mechanism_follows_the_hand(page_of, tmp_path):
    angle, velocity, spring = look(
        tmp_path,
        page_of("pendulum_free"),
        TAKE
        + """
        const angle = (2 / 3) * Math.PI;
        const tip = (turn) => [0.5 * Math.sin(turn), -0.5 * Math.cos(turn)];
        await drag(tip(angle), tip(1.5), tip(1));
        return [number("swing.position"), number("swing.velocity"), spring()];
        """,
    )
    assert angle == pytest.approx(1, abs=0.02)
    assert velocity == 0 and spring == ""


def test_the_chart_has_the_energies_and_follows(page_of, tmp_path):
    titles, first, second = look(
        tmp_path,
        page_of("pendulum_free"),
        """
        find(".chart-part").open = true;
        await until(() => all(".chart svg").length);
        const titles = all(".chart .title").map((title) => title.textContent);
        const first = live.chart.panels[0].low;
        live.move({ do: "time", value: 5 });
        return [titles, first, live.chart.panels[0].low];
        """,
    )
    assert titles == ["energy.kinetic [J]", "energy.potential [J]", "energy.total [J]"]
    assert (first, second) == (0, 5)


def test_the_chart_marks_impacts(page_of, tmp_path):
    events, read = look(
        tmp_path,
        page_of(Path(__file__).with_name("ball.toml")),
        """
        find(".chart-part").open = true;
        await until(() => all(".chart svg").length);
        const lines = [...find(".chart svg").querySelectorAll(".event")];
        const box = find(".chart svg").getBoundingClientRect();
        const clientX = box.left + (Number(lines[0].getAttribute("x1")) / 560) * box.width;
        find(".chart svg").dispatchEvent(new PointerEvent("pointermove", { clientX, clientY: box.top + 50, bubbles: true }));
        return [lines.map((line) => Number(line.getAttribute("x1"))), find(".reading").textContent];
        """,
    )
    # It falls by 1 m; the time to the next impact is as long.
    fall = math.sqrt(2 / GRAVITY)
    assert events == pytest.approx([64 + 486 * fall, 64 + 486 * 2 * fall], abs=0.5)
    assert "impact at stop bottom" in read


def test_a_mass_that_is_missing_is_told(page_of, tmp_path):
    text = (ROOT / "mechanisms" / "pendulum_free.toml").read_text(encoding="utf-8")
    massive = 'inertia = "mass*length^2/12"'
    assert massive in text
    file = tmp_path / "massless.toml"
    file.write_text(text.replace(massive, 'center = ["-length/2", 0]'), encoding="utf-8")
    told, label, moved = look(
        tmp_path,
        page_of(file),
        """
        press(" ");
        await pause(200);
        const told = message();
        live.move({ do: "drive", driver: 0, value: 0.5 });
        return [told, find(".play").getAttribute("aria-label"), number("swing.position")];
        """,
    )
    assert "no body with a mass moves along" in told
    assert label == "Play"
    assert moved == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize("name", FREE)
def test_a_page_agrees_with_the_program(name, page_of, tmp_path):
    """Positions after a part of the simulation, in steps of a page, with those of `biela run`."""
    csv = tmp_path / "run.csv"
    file = ROOT / "mechanisms" / f"{name}.toml"
    subprocess.run([program(), "run", file, "-o", csv], check=True, capture_output=True)
    rows = [line.split(",") for line in csv.read_text(encoding="utf-8").splitlines()]
    row = rows[1 + (len(rows) - 1) // 8]
    values, told = look(
        tmp_path,
        page_of(name),
        f"""
        for (let k = 1; k <= 10; k += 1) live.move({{ do: "time", value: ({row[0]} * k) / 10 }});
        const values = Object.fromEntries(live.page.variables.map((v, k) =>
          [v.name, live.frame[live.places.variables + k]]));
        return [values, message()];
        """,
    )
    assert told == ""
    native = dict(zip(rows[0], map(float, row), strict=True))
    compared = [v for v in values if v in native and v.endswith((".x", ".y", ".phi"))]
    assert compared
    for variable in compared:
        a, b = values[variable], native[variable]
        assert abs(a - b) < 1e-6 * (1 + abs(b)), variable
