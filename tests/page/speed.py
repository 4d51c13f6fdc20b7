"""Prints the speed of pages: steps of the solver in a browser beside those of the same code built
for this machine, and the pictures of a mechanism of 31 bodies.

    make build page
    cargo build --release --locked --package yardstick --bin steps
    .venv/bin/python tests/page/speed.py

Of many short rounds the quickest counts: it is disturbed least.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fmpy"))

from browsing import visit  # noqa: E402  (its folder has only just been added)
from harness import ROOT, program  # noqa: E402

CASES = ["four_bar", "jansen_leg", "cam_roller"]
# Steps per turn.
RESOLUTIONS = [10_000, 360]
ROUNDS = 60
# What a browser takes for the rounds of one resolution at most, so that a visit ends in time [ms].
LONGEST = 15_000
# Loops of the large mechanism, each of two bodies besides the crank.
LOOPS = 15

# A browser tells a tenth of a millisecond: a round lasts some milliseconds.
STEPS = """
await until(() => find(".live.ready"));
const live = find(".live").live;
const drive = live.solver.exports.biela_drive;
const times = [];
for (const resolution of %s) {
  const step = (2 * Math.PI) / resolution;
  const count = 10080;
  let value = live.frame[live.places.drivers];
  let least = Infinity;
  const end = performance.now() + %d;
  for (let round = 0; round < %d && performance.now() < end; round += 1) {
    const before = performance.now();
    for (let k = 0; k < count; k += 1) {
      value += step;
      if (drive(0, value) !== 1) throw new Error("it is blocked");
    }
    least = Math.min(least, performance.now() - before);
    await pause(0);
  }
  times.push((1e6 * least) / count);
}
return times;
"""

# A picture is solved, drawn and laid out; painting is the browser's own.
PICTURES = """
await until(() => find(".live.ready"));
const live = find(".live").live;
const svg = find(".live .stage");
let value = live.frame[live.places.drivers];
const times = [];
for (let round = 0; round < 300; round += 1) {
  value += 0.02;
  const before = performance.now();
  live.drive(0, value);
  svg.getBoundingClientRect();
  times.push(performance.now() - before);
  if (round % 10 === 0) await pause(0);
}
times.sort((a, b) => a - b);
return [places().length, times[0], times[150], times[285]];
"""


def chain() -> str:
    """A chain of four-bars: each rocker is the crank of the next one."""
    crank, coupler, rocker, base = 0.10, 0.25, 0.30, 0.40
    lines = ["format = 1", 'name = "chain"', "[ground]"]
    pivots = ", ".join(f"O{k} = [{base * k:.2f}, 0]" for k in range(LOOPS + 1))
    lines.append(f"markers = {{ {pivots} }}")
    # The arm of a rocker that drives the next loop stands as the first crank does.
    angle = math.pi / 3
    ax, ay = crank * math.cos(angle), crank * math.sin(angle)
    apart = math.hypot(base - ax, ay)
    along = (coupler**2 - rocker**2 + apart**2) / (2 * apart)
    aside = math.sqrt(coupler**2 - along**2)
    bx = ax + (along * (base - ax) + aside * ay) / apart
    by = ay + (-along * ay + aside * (base - ax)) / apart
    phi, psi = math.atan2(by - ay, bx - ax), math.atan2(by, bx - base)
    cx, cy = crank * math.cos(angle - psi), crank * math.sin(angle - psi)
    lines += [
        "[bodies.rocker_0]",
        f"markers = {{ O = [0, 0], C = [{crank}, 0] }}",
        f"estimate = [0, 0, {angle}]",
    ]
    for k in range(1, LOOPS + 1):
        x = base * (k - 1)
        lines += [
            f"[bodies.coupler_{k}]",
            f"markers = {{ A = [0, 0], B = [{coupler}, 0] }}",
            f"estimate = [{x + ax}, {ay}, {phi}]",
            f"[bodies.rocker_{k}]",
            f"markers = {{ O = [0, 0], B = [{rocker}, 0], C = [{cx}, {cy}] }}",
            f"estimate = [{base * k}, 0, {psi}]",
        ]
    lines.append("[joints]")
    for k in range(LOOPS + 1):
        pairs = {"O": (f"ground.O{k}", f"rocker_{k}.O")}
        if k:
            pairs["A"] = (f"rocker_{k - 1}.C", f"coupler_{k}.A")
            pairs["B"] = (f"coupler_{k}.B", f"rocker_{k}.B")
        for name, (i, j) in pairs.items():
            lines.append(f'{name}_{k} = {{ type = "revolute", markers = ["{i}", "{j}"] }}')
    lines += [
        "[drivers]",
        'angle = { coordinate = "angle", markers = ["ground.O0", "rocker_0.O"], '
        f"start = {angle} }}",
    ]
    return "\n".join(lines)


def page(file: Path, folder: Path) -> Path:
    written = folder / f"{file.stem}.html"
    subprocess.run([program(), "page", file, "-o", written], check=True, capture_output=True)
    return written


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print("mechanism    steps per turn    native   browser   ratio")
        for case in CASES:
            file = ROOT / "mechanisms" / f"{case}.toml"
            browser = visit(folder, page(file, folder), STEPS % (RESOLUTIONS, LONGEST, ROUNDS))
            for resolution, time in zip(RESOLUTIONS, browser, strict=True):
                command = [ROOT / "target" / "release" / "steps", f"page_{case}@{resolution}"]
                command += ["1", "10080", str(ROUNDS)]
                told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
                native = float(told.split()[0])
                ratio = time / native
                print(f"{case:12} {resolution:14} {native:6.0f} ns {time:6.0f} ns {ratio:7.2f}")
        file = folder / "chain.toml"
        file.write_text(chain(), encoding="utf-8")
        parts, least, median, late = visit(folder, page(file, folder), PICTURES)
        print(
            f"{1 + 2 * LOOPS} bodies in {parts} parts: a picture takes {least:.1f} ms at least, "
            f"{median:.1f} ms in the middle, {late:.1f} ms in 19 of 20 cases"
        )


if __name__ == "__main__":
    main()
