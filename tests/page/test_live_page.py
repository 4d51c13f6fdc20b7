"""Mechanisms moved by hand on pages, in a real browser."""

import base64
import json
import math
import re
import subprocess
import zlib

import pytest
from harness import ROOT, SHIPPED, program
from looking import look

# The four-bar of the mechanisms folder, by its lengths [m].
CRANK, COUPLER, ROCKER, BASE = 0.10, 0.25, 0.30, 0.40


def rocker_angle(crank):
    """Angle of the rocker for an angle of the crank: the circles about A and O4 meet in B."""
    ax, ay = CRANK * math.cos(crank), CRANK * math.sin(crank)
    dx, dy = BASE - ax, -ay
    apart = math.hypot(dx, dy)
    along = (COUPLER**2 - ROCKER**2 + apart**2) / (2 * apart)
    aside = math.sqrt(COUPLER**2 - along**2)
    bx = ax + (along * dx - aside * dy) / apart
    by = ay + (along * dy + aside * dx) / apart
    return math.atan2(by, bx - BASE)


@pytest.mark.smoke
def test_dragging_the_crank_follows_the_closed_form(page_of, tmp_path):
    # The pointer is off the crank's circle: the crank points at it, seen from its pivot.
    ends = [math.radians(angle) for angle in (100, 170, 260, 20)]
    start = [CRANK * math.cos(math.pi / 3), CRANK * math.sin(math.pi / 3)]
    for end in ends:
        path = [start]
        for k in range(1, 13):
            angle = math.pi / 3 + (end - math.pi / 3) * k / 12
            path.append([1.2 * CRANK * math.cos(angle), 1.2 * CRANK * math.sin(angle)])
        crank, rocker = look(
            tmp_path,
            page_of("four_bar"),
            f"""
            const path = {path};
            await drag(...path);
            return [number("crank_angle.position"), number("rocker.phi")];
            """,
        )
        # The grip is at A to within a pixel; the crank turns by the angle of the pointer but for
        # the angle of the grip, which a pixel bounds, and the loop closes to rounding.
        assert abs(math.remainder(crank - end, math.tau)) < 0.05
        assert abs(math.remainder(rocker - rocker_angle(crank), math.tau)) < 1e-9


def test_the_hand_is_as_near_as_the_mechanism_can_come(page_of, tmp_path):
    target = [0.17, 0.11]
    q = look(
        tmp_path,
        page_of("four_bar"),
        f"""
        const body = 0;
        const grip = [{CRANK}, 0];
        const scale = live.picture.parts.scale;
        live.move({{ do: "drag", body, grip, at: [{target[0]} * scale, -{target[1]} * scale] }});
        return number("crank_angle.position");
        """,
    )
    assert abs(q - math.atan2(target[1], target[0])) < 1e-9


def test_a_dead_point_stops_the_hand(page_of, tmp_path):
    # The rocker drives: its ends are where crank and coupler are in line.
    text = (ROOT / "mechanisms" / "four_bar.toml").read_text(encoding="utf-8")
    start = rocker_angle(math.pi / 3)
    driver = 'crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "60*deg" }'
    assert driver in text
    file = tmp_path / "rocker_drives.toml"
    file.write_text(
        text.replace(
            driver,
            f'rocker_angle = {{ coordinate = "angle", markers = ["ground.O4", "rocker.O"], start = {start} }}',
        ).replace('name = "four_bar"', 'name = "rocker_drives"'),
        encoding="utf-8",
    )
    # Crank and coupler in line: a triangle of their sum or difference, the base and the rocker.
    reach = CRANK + COUPLER
    inner = math.acos((BASE**2 + ROCKER**2 - reach**2) / (2 * BASE * ROCKER))
    limit = math.pi - inner
    value, text, marked, back, slid = look(
        tmp_path,
        page_of(file),
        """
        // The reason stays when the slider is let go.
        const { slider } = live.drivers[0];
        slider.value = slider.min;
        const slid = ["input", "change"].map((event) => {
          slider.dispatchEvent(new Event(event));
          return message();
        });
        live.move({ do: "drive", driver: 0, value: 0.5 });
        const stopped = [number("rocker_angle.position"), message(), live.picture.marker.style.display === ""];
        live.move({ do: "drive", driver: 0, value: stopped[0] + 0.1 });
        return [...stopped, number("rocker_angle.position") - stopped[0], slid];
        """,
    )
    assert abs(value - limit) < 1e-9
    assert "dead point" in text and "with rocker_angle at" in text
    assert marked
    assert abs(back - 0.1) < 1e-9
    assert "dead point" in slid[0] and slid[1] == slid[0]


def test_a_geometry_that_does_not_close_is_refused(page_of, tmp_path):
    text, before, after, crank = look(
        tmp_path,
        page_of("four_bar"),
        """
        const before = places();
        const index = live.page.parameters.findIndex((p) => p.name === "coupler_length");
        live.move({ do: "set", parameter: index, value: 0.9 });
        return [message(), before, places(), live.frame[live.places.parameters + index]];
        """,
    )
    assert "cannot close" in text and "stays open by" in text
    assert before == after
    assert crank == COUPLER


@pytest.mark.smoke
def test_a_parameter_by_its_field(page_of, tmp_path):
    base, phi, undone = look(
        tmp_path,
        page_of("four_bar"),
        """
        const row = live.parameters[live.page.parameters.findIndex((p) => p.name === "base")];
        row.field.value = "380";
        row.field.dispatchEvent(new Event("change"));
        const seen = [row.value, number("rocker.phi")];
        find(".undo").click();
        return [...seen, row.value];
        """,
    )
    assert base == pytest.approx(0.38, abs=1e-15)
    ax, ay = CRANK * 0.5, CRANK * math.sin(math.pi / 3)
    bx, by = 0.38 + ROCKER * math.cos(phi), ROCKER * math.sin(phi)
    assert abs(math.hypot(bx - ax, by - ay) - COUPLER) < 1e-12
    assert undone == BASE


def test_speeds_and_loads(page_of, tmp_path):
    arm = tmp_path / "arm.toml"
    arm.write_text(
        """
format = 1
name = "arm"
[ground.markers]
O = [0, 0]
[bodies.arm]
markers = { O = [0, 0], P = [0.5, 0] }
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[forces]
load = { marker = "arm.P" }
[drivers]
angle = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0.3 }
"""
    )
    seen = look(
        tmp_path,
        page_of(arm),
        """
        const give = (name, value) => {
          const rows = [...document.querySelectorAll(".rate-rows .row")];
          const field = rows.find((row) => row.textContent.startsWith(name)).querySelector("[type=number]");
          field.value = value;
          field.dispatchEvent(new Event("change"));
        };
        give("load.fy", -11);
        give("angle.velocity", 2);
        give("angle.acceleration", 3);
        const seen = ["angle.effort", "angle.power", "arm.omega", "arm.alpha"].map(number);
        find(".reset").click();
        return [...seen, number("angle.effort")];
        """,
    )
    # By virtual power: the effort lifts the load, whose arm is 0.5 m cos 0.3.
    effort = 11 * 0.5 * math.cos(0.3)
    # The fields are in degrees per second.
    omega, alpha = math.radians(2), math.radians(3)
    assert seen == pytest.approx([effort, omega * effort, omega, alpha, 0], abs=1e-13)


def test_other_positions(page_of, tmp_path):
    count, phi = look(
        tmp_path,
        page_of("four_bar"),
        """
        find(".find-modes").click();
        const buttons = all(".modes button");
        buttons[0].click();
        return [buttons.length, number("rocker.phi")];
        """,
    )
    assert count == 1
    # The mirror image about the line from A to O4.
    ax, ay = CRANK * 0.5, CRANK * math.sin(math.pi / 3)
    line = math.atan2(-ay, BASE - ax) + math.pi
    assert abs(math.remainder(phi - (2 * line - rocker_angle(math.pi / 3)), math.tau)) < 1e-9


def test_saving_and_reading_again(page_of, tmp_path):
    text, poses = look(
        tmp_path,
        page_of("four_bar"),
        """
        const index = live.page.parameters.findIndex((p) => p.name === "base");
        live.move({ do: "set", parameter: index, value: 0.38 });
        live.drive(0, 2.5);
        const pose = () => [...frame()].slice(live.places.variables, live.places.joints);
        const before = pose();
        const { text } = live.ask({ do: "text" });
        find(".text").value = text;
        find(".apply").click();
        return [text, [before, pose()]];
        """,
    )
    assert "# Four-bar linkage" in text and "base           = { value = 0.38," in text
    positions = [(a, b) for a, b in zip(*poses, strict=True) if a is not None and b is not None]
    assert all(abs(a - b) < 1e-9 * (1 + abs(a)) for a, b in positions)
    saved = tmp_path / "saved.toml"
    saved.write_text(text, encoding="utf-8")
    subprocess.run([program(), "check", saved], check=True, capture_output=True)


def test_a_wrong_file_tells_its_problem_and_the_mechanism_stays(page_of, tmp_path):
    text, apart, count, hidden = look(
        tmp_path,
        page_of("four_bar"),
        """
        const good = find(".text").value;
        find(".text").closest("details").open = true;
        find(".text").value = good.replace('"crank.O"', '"cranck.O"');
        find(".apply").click();
        const told = find(".file-problems");
        const apart = told.getBoundingClientRect().top - find(".text").getBoundingClientRect().bottom;
        const text = told.textContent;
        live.drive(0, 1.5);
        find(".text").value = good;
        find(".apply").click();
        return [text, apart, places().length, told.hidden];
        """,
    )
    assert "no body cranck; did you mean crank?" in text
    # Beside the editor.
    assert 0 <= apart < 20
    assert count > 5 and hidden


def test_undo_returns_to_the_file_before(page_of, tmp_path):
    crank, base, text, again = look(
        tmp_path,
        page_of("four_bar"),
        """
        const base = () => live.frame[live.places.parameters + live.page.parameters.findIndex((p) => p.name === "base")];
        live.keep();
        live.move({ do: "drive", driver: 0, value: 1.5 });
        const good = find(".text").value;
        find(".text").value = good.replace("value = 0.40,", "value = 0.42,");
        find(".apply").click();
        const applied = base();
        find(".undo").click();
        const undone = [number("crank_angle.position"), [applied, base()], find(".text").value === good];
        find(".redo").click();
        return [...undone, base()];
        """,
    )
    assert crank == 1.5
    assert base == [0.42, BASE] and text
    assert again == 0.42


def test_a_fast_motion_is_shown_slowly_and_says_so(page_of, tmp_path):
    text = (ROOT / "mechanisms" / "four_bar.toml").read_text(encoding="utf-8")
    start = 'start = "60*deg"'
    assert start in text
    file = tmp_path / "fast.toml"
    # 600 turns a minute.
    file.write_text(text.replace(start, 'motion = "20*pi*t"'), encoding="utf-8")
    steps, clock, slow = look(
        tmp_path,
        page_of(file),
        """
        const steps = [];
        let before = number("crank_angle.position");
        press(" ");
        for (let k = 0; k < 20; k += 1) {
          await new Promise(requestAnimationFrame);
          const now = number("crank_angle.position");
          steps.push(now - before);
          before = now;
        }
        const clock = find(".clock").textContent;
        press(" ");
        find(".speed").value = "0.1";
        find(".speed").dispatchEvent(new Event("change"));
        live.draw();
        return [steps, clock, find(".clock").textContent];
        """,
    )
    # Two turns a second, a tenth of a second per picture at most.
    assert 0 < max(steps) <= 0.4 * math.pi * (1 + 1e-9)
    assert clock.endswith("s, slow motion 1/5")
    assert "slow" not in slow


def test_a_dead_point_has_no_finite_values_and_the_slider_says_where(page_of, tmp_path):
    text = (ROOT / "mechanisms" / "four_bar.toml").read_text(encoding="utf-8")
    driver = 'crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "60*deg" }'
    other = 'rocker_angle = { coordinate = "angle", markers = ["ground.O4", "rocker.O"], start = 2.1437 }'
    assert driver in text
    file = tmp_path / "rocker_has_dead_points.toml"
    file.write_text(
        text.replace(driver, other).replace("[measures]\n", '[measures]\nturning = { value = "crank.omega" }\n'),
        encoding="utf-8",
    )
    ends, values, note, marked = look(
        tmp_path,
        page_of(file),
        """
        const value = () => all(".readings div").map((row) => row.textContent).find((row) => row.startsWith("turning"));
        const before = value();
        live.move({ do: "drive", driver: 0, value: 0 });
        return [find(".driver-rows .ends").textContent, [before, value()], find(".at-rates").textContent,
          all(".message code").map((code) => code.textContent)];
        """,
    )
    assert ends.count("dead point at") == 2
    assert "no finite value" not in values[0] and "no finite value" in values[1]
    assert "rocker_angle at 90 deg/s" in note and "At this dead point" in note
    # Names stand without back quotes.
    assert "rocker_angle" in marked


def test_messages_have_no_idle_zeros(page_of, tmp_path):
    text = look(
        tmp_path,
        page_of("latch"),
        """
        live.move({ do: "drive", driver: 0, value: 1 });
        return message();
        """,
    )
    assert "throw = 0.02 m" in text and "0.729727656 rad" in text


def test_a_chart_is_read_at_the_pointer(page_of, tmp_path):
    labels, pointed, present, panels, listed = look(
        tmp_path,
        page_of("four_bar"),
        """
        find(".chart-part").open = true;
        const choose = (name) => all(".variables label").find((label) => label.textContent.trim() === name).firstChild.click();
        for (const index of live.chart.chosen) choose(live.page.variables[index].name);
        choose("crank_angle.position");
        await until(() => all(".chart svg").length === 1);
        const svg = find(".chart svg");
        const box = svg.getBoundingClientRect();
        // The axis goes from 64 to 550 of 560: a quarter of the turn.
        const clientX = box.left + ((64 + 0.25 * 486) / 560) * box.width;
        svg.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY: box.top + 50, bubbles: true }));
        const pointed = find(".reading").textContent;
        svg.dispatchEvent(new PointerEvent("pointerleave"));
        const present = find(".reading").textContent;
        const labels = [...svg.querySelectorAll("text")].map((text) => text.textContent);
        choose("rocker.phi");
        find(".narrow").value = "omega";
        find(".narrow").dispatchEvent(new Event("input"));
        const listed = all(".variables label").filter((label) => !label.hidden).map((label) => label.textContent.trim());
        return [labels, pointed, present, all(".chart svg").length, listed];
        """,
    )
    assert {"0", "60", "120", "180", "240", "300", "360"} <= set(labels)
    assert pointed == "crank_angle = 90 deg: 90 deg"
    assert present == "crank_angle = 60 deg: 60 deg"
    assert panels == 2
    # Those chosen, and those whose names hold the text.
    assert "rocker.omega" in listed and "rocker.phi" in listed and "coupler.x" not in listed


def test_a_click_shows_path_and_speed_of_a_point(page_of, tmp_path):
    """The crank's end goes round on a circle; the path is drawn to a hundredth of a unit."""
    found = look(
        tmp_path,
        page_of("four_bar"),
        """
        const angle = () => live.frame[live.places.drivers];
        const before = angle();
        const at = [0.1 * Math.cos(before), 0.1 * Math.sin(before)];
        await drag(at);
        const scale = live.picture.parts.scale;
        const path = find(".before path");
        const radii = [...path.getAttribute("d").matchAll(/[ML](\\S+) ([^LM]+)/g)].map(([, x, y]) => Math.hypot(x, y) / scale);
        const told = find(".traced span").textContent;
        const shown = !find(".traced").hidden;
        live.ask({ do: "undo" });
        const after = angle();
        await drag([0.2, -0.06]);
        return { moved: after - before, low: Math.min(...radii), high: Math.max(...radii), count: radii.length, told, shown,
          gone: find(".traced").hidden && !find(".before path"), scale };
        """,
    )
    assert found["moved"] == 0
    assert found["count"] > 200
    # The pointer is on a pixel, half a pixel away at most, and a pixel is less than 2 units.
    off = 2 / found["scale"]
    assert 0.1 - off < found["low"] <= found["high"] < 0.1 + off
    assert found["shown"] and found["gone"]
    speed = re.search(r"speed ([0-9.]+) m/s", found["told"])
    assert speed and found["told"].startswith("Point of crank at "), found["told"]
    # A turn in 4 s.
    assert abs(float(speed[1]) - math.tau / 4 * 0.1) < math.tau / 4 * off + 1e-4


def test_other_poses_lie_over_each_other(page_of, tmp_path):
    found = look(
        tmp_path,
        page_of("four_bar"),
        """
        find(".poses").click();
        const poses = all(".behind > g");
        const places = poses.map((pose) => pose.firstChild.getAttribute("transform"));
        const parts = [poses[0].childElementCount, live.picture.moving.groups.length];
        const near = live.picture.bodyAt(...point(-0.05, 0));
        find(".poses").click();
        return { places, parts, near, left: all(".behind > g").length };
        """,
    )
    # A turn in steps of 30°: the last pose is the first one.
    assert len(found["places"]) == 13 and len(set(found["places"])) >= 12
    assert 0 < found["parts"][0] <= found["parts"][1]
    assert found["near"] is None and found["left"] == 0


def test_edit_leads_to_the_studio(solver, tmp_path):
    """The link holds the mechanism as it is on the page."""
    page = tmp_path / "page.html"
    file = ROOT / "mechanisms" / "four_bar.toml"
    command = [program(), "page", file, "--solver", solver, "--studio", "studio/index.html", "-o", page]
    subprocess.run(command, check=True, capture_output=True)
    found = look(
        tmp_path,
        page,
        """
        live.move({ do: "drive", driver: 0, value: 2 });
        let link = null;
        document.addEventListener("click", (event) => {
          if (event.target.matches("a[href]")) {
            event.preventDefault();
            link = event.target.getAttribute("href");
          }
        }, true);
        find(".edit").click();
        await until(() => link);
        return { link, seen: find(".edit").checkVisibility() };
        """,
    )
    address, packed = found["link"].split("#m=")
    assert address == "studio/index.html" and found["seen"]
    packed = base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4))
    name, text, files = json.loads(zlib.decompress(packed, -zlib.MAX_WBITS))
    assert name == "four_bar.toml" and files == []
    assert re.search(r'start = "114\.591\d*\*deg"', text), text


def test_playing_and_keys(page_of, tmp_path):
    before, after, still = look(
        tmp_path,
        page_of("four_bar"),
        """
        const value = () => frame()[live.places.drivers];
        const before = value();
        press(" ");
        await pause(600);
        press(" ");
        const after = value();
        await pause(200);
        press("ArrowRight");
        return [before, after, value() - after];
        """,
    )
    assert after > before + 0.1
    assert 0 < still < 0.1


def test_a_failure_of_the_solver_is_told_and_survived(page_of, tmp_path):
    text, hidden, count = look(
        tmp_path,
        page_of("four_bar"),
        """
        const answer = live.solver.exports.biela_answer;
        live.solver.exports = { ...live.solver.exports, biela_answer: () => { throw new WebAssembly.RuntimeError("unreachable"); } };
        live.move({ do: "drive", driver: 0, value: 1 });
        const told = find(".broken p").textContent;
        find(".restart").click();
        live.drive(0, 1);
        return [told, find(".broken").hidden, places().length];
        """,
    )
    assert "defect of biela" in text
    assert hidden and count > 5


def test_a_panic_of_the_solver_is_told_and_survived(page_of, tmp_path):
    # No request is as long as the memory of a browser: the list that is to hold it panics.
    text, again, hidden, crank = look(
        tmp_path,
        page_of("four_bar"),
        """
        const exports = live.solver.exports;
        live.solver.exports = { ...exports, biela_input: () => exports.biela_input(-1) };
        const slide = (value) => {
          live.drivers[0].field.value = value;
          live.drivers[0].field.dispatchEvent(new Event("change"));
        };
        slide("90");
        const told = find(".broken p").textContent;
        find(".restart").click();
        const hidden = find(".broken").hidden;
        slide("90");
        return [told, live.solver.exports === exports, hidden, number("crank_angle.position")];
        """,
    )
    assert "defect of biela" in text and "capacity overflow" in text
    assert not again and hidden
    assert abs(crank - math.pi / 2) < 1e-12


def test_memory_is_steady(page_of, tmp_path):
    # An hour of pictures, sixty a second.
    first, last, angle = look(
        tmp_path,
        page_of("jansen_leg"),
        """
        const driver = live.page.drivers.findIndex((d) => d.is_input);
        const size = () => live.solver.exports.memory.buffer.byteLength;
        const turn = (from, count) => {
          for (let k = 0; k < count; k += 1) live.solver.drive(driver, from + k * 0.01);
        };
        // A hand that pulls, and pictures drawn anew as for sliders of parameters.
        const pull = (count) => {
          for (let k = 0; k < count; k += 1) {
            const at = [50 * Math.cos(k / 60), 50 * Math.sin(k / 60)];
            live.solver.ask({ do: "drag", body: 0, grip: [0.1, 0], at });
            if (k % 600 === 0) live.solver.ask({ do: "redraw", keep: true });
          }
        };
        pull(601);
        const start = frame()[live.places.drivers + 3 * driver];
        turn(start, 1000);
        const first = size();
        turn(start + 10, 216000);
        const angle = frame()[live.places.drivers + 3 * driver] - start;
        pull(3600);
        return [first, size(), angle];
        """,
    )
    assert last == first
    assert abs(angle - (10 + 2159.99)) < 1e-9


@pytest.mark.parametrize("name", SHIPPED)
def test_every_mechanism_opens_and_agrees(name, page_of, tmp_path):
    """The numbers of the page against those of the program, at the file's own pose."""
    page = page_of(name)
    values, problems, size = look(
        tmp_path,
        page,
        """
        const values = Object.fromEntries(live.page?.variables.map((v, k) =>
          [v.name, live.frame[live.places.variables + k]]) ?? []);
        return [values, find(".problems").textContent, document.documentElement.scrollWidth - innerWidth];
        """,
    )
    assert problems == ""
    assert size <= 0
    assert len(page.read_bytes()) < 1_750_000
    csv = tmp_path / "run.csv"
    subprocess.run(
        [program(), "run", ROOT / "mechanisms" / f"{name}.toml", "-o", csv],
        check=False,
        capture_output=True,
    )
    rows = csv.read_text(encoding="utf-8").splitlines()
    native = dict(zip(rows[0].split(","), map(float, rows[1].split(",")), strict=True))
    positions = [v for v in values if v.rsplit(".", 1)[-1] in ("x", "y", "phi", "position")]
    compared = [v for v in positions if v in native]
    assert compared
    for variable in compared:
        a, b = values[variable], native[variable]
        assert abs(a - b) < 1e-12 * (1 + abs(b)), variable
