// @ts-check
// A chart of variables over time or over a driver, with a cursor at the present pose, and one that
// follows the pointer.

import { angleTicks, ticks } from "./axis.js";
import { add, moveOf, offerMoves, shown } from "./controls.js";

const [WIDTH, HEIGHT] = [560, 150];
const [LEFT, RIGHT, TOP, BOTTOM] = [64, 10, 20, 22];
const SAMPLES = 241;
// Most panels.
const MOST = 6;
// A list that is longer can be narrowed by a text.
const LONG = 12;

export class Chart {
  /** @param {import("./live.js").Live} live */
  constructor(live, find) {
    this.live = live;
    this.place = find(".chart");
    this.over = find(".over");
    this.list = find(".variables");
    this.narrow = find(".narrow");
    this.note = find(".chart-note");
    this.panels = [];
    this.boxes = [];
    this.over.addEventListener("change", () => this.draw());
    this.narrow.addEventListener("input", () => this.show());
  }

  /** Offers the variables of a page; what was chosen before stays. */
  offer(page) {
    const before = this.chosen.map((index) => this.names[index]);
    this.names = page.variables.map((variable) => variable.name);
    offerMoves(this.over, page);
    const told = page.variables.findIndex((variable, index) => variable.is_told && index >= 3 * page.drivers.length);
    const first = told < 0 ? page.variables.length - 3 : told;
    const usual = page.energies.length ? page.energies : [first];
    this.list.replaceChildren();
    this.boxes = page.variables.map((variable, index) => {
      const checked = before.length ? before.includes(variable.name) : usual.includes(index);
      const box = Object.assign(document.createElement("input"), { type: "checkbox", checked });
      box.addEventListener("change", () => this.draw());
      add(this.list, "label", {}, box, ` ${variable.name}`);
      return box;
    });
    this.narrow.parentElement.hidden = page.variables.length <= LONG;
    this.show();
  }

  /** Shows the variables whose names hold the text, and those chosen. */
  show() {
    const text = this.narrow.value.trim().toLowerCase();
    this.boxes.forEach((box, index) => {
      box.parentElement.hidden = !box.checked && !this.names[index].toLowerCase().includes(text);
    });
  }

  get chosen() {
    return this.boxes.flatMap((box, index) => (box.checked ? [index] : []));
  }

  /** Asks for values, of these variables or of those chosen. */
  values(variables = this.chosen, samples = SAMPLES) {
    return this.live.ask({ do: "chart", variables, samples, driver: this.driver });
  }

  /** Returns the driver along the horizontal axis, null for time. */
  get driver() {
    return moveOf(this.over);
  }

  /** Returns the variable along the horizontal axis, with the place of its value in a frame. */
  get axis() {
    const { driver } = this;
    if (driver === null) {
      return { name: "time", unit: "s", factor: 1, at: 0 };
    }
    const { name, unit, factor } = this.live.page.drivers[driver];
    return { name, unit, factor, at: this.live.places.drivers + 3 * driver };
  }

  draw() {
    // Hidden, or nothing to draw.
    if (!this.place.offsetParent) {
      return;
    }
    const { chosen } = this;
    const data = this.values(chosen.slice(0, MOST));
    this.place.replaceChildren();
    this.panels = [];
    const left = chosen.length - MOST;
    this.note.textContent = left > 0 ? `The chart shows the first ${MOST} variables; ${left} more are chosen.` : "";
    if (!data || data.x.length < 2) {
      return;
    }
    const axis = this.axis;
    chosen.slice(0, MOST).forEach((variable, index) => {
      const { name, unit, factor } = this.live.page.variables[variable];
      const y = data.y[index].map((value) => (value === null ? null : value * factor));
      // An energy that is kept has the errors of integration.
      const constant = this.live.page.is_free ? 1e-6 : 1e-9;
      const made = panel(this.place, axis, data.x, { name, unit, y, constant, events: data.events ?? [] });
      made.svg.addEventListener("pointermove", (event) => this.read(made.at(event.clientX)));
      made.svg.addEventListener("pointerleave", () => this.read(null));
      this.panels.push(made);
    });
    this.move();
  }

  /** Reads all panels at a place of the horizontal axis, null for the present pose. */
  read(x) {
    this.panels.forEach((made) => made.read(x));
  }

  /** Moves the cursors to the present pose. */
  move() {
    const now = this.live.frame?.[this.axis.at];
    // Free motion goes on beyond the chart.
    if (this.live.page.is_free && this.panels.some(({ low, high }) => now < low || now > high)) {
      this.draw();
      return;
    }
    for (const made of this.panels) {
      const { low, high } = made;
      // A crank that has turned further is shown in the turn of the chart.
      const turn = high - low;
      const turns = this.live.page.ranges[this.driver]?.turns;
      made.move(turns ? now - turn * Math.floor((now - low) / turn) : now);
    }
  }
}

function panel(place, axis, x, { name, unit, y, constant, events }) {
  const known = y.filter((value) => value !== null);
  const extremes = known.length ? [Math.min(...known), Math.max(...known)] : null;
  let [low, high] = extremes ?? [0, 0];
  // A constant is a line in the middle.
  const least = constant * Math.max(1e-3, Math.abs(low), Math.abs(high));
  if (!(high - low > least)) {
    [low, high] = [low - 1, high + 1];
  }
  const [first, last] = [x[0], x[x.length - 1]];
  const onX = (value) => LEFT + ((value - first) / (last - first)) * (WIDTH - LEFT - RIGHT);
  const onY = (value) => HEIGHT - BOTTOM - ((value - low) / (high - low)) * (HEIGHT - TOP - BOTTOM);
  const svg = addTo(place, "svg");
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  svg.setAttribute("role", "img");
  const text = unit ? `${name} [${unit}]` : name;
  svg.setAttribute("aria-label", `${text} over ${axis.name}, from ${shown(low, 4)} to ${shown(high, 4)}`);
  const draw = (element, attributes, content) => {
    const part = addTo(svg, element);
    for (const [key, value] of Object.entries(attributes)) {
      part.setAttribute(key, value);
    }
    part.textContent = content ?? "";
    return part;
  };
  const round = (kind, ...range) => (kind === "deg" ? angleTicks(...range) : ticks(...range));
  for (const value of round(unit, low, high, 5)) {
    const height = onY(value);
    draw("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: height, y2: height });
    draw("text", { x: LEFT - 6, y: height + 4, "text-anchor": "end" }, String(value));
  }
  for (const value of round(axis.unit, first * axis.factor, last * axis.factor, 6)) {
    const at = onX(value / axis.factor);
    draw("line", { class: "grid", x1: at, x2: at, y1: HEIGHT - BOTTOM, y2: HEIGHT - BOTTOM + 4 });
    // The last one would leave the picture.
    const anchor = at > WIDTH - 2 * RIGHT ? "end" : "middle";
    draw("text", { x: Math.min(at, WIDTH - 2), y: HEIGHT - 6, "text-anchor": anchor }, String(value));
  }
  const title = draw("text", { x: LEFT, y: 12, class: "title" }, text);
  if (extremes) {
    const [least, most] = extremes.map((value) => shown(value, 4));
    draw("text", { x: LEFT + title.getComputedTextLength() + 8, y: 12, class: "extremes" }, `${least} to ${most}`);
  }
  const reading = draw("text", { x: WIDTH - RIGHT, y: 12, "text-anchor": "end", class: "reading" });
  for (const event of events) {
    const line = draw("line", { class: "event", x1: onX(event.x), x2: onX(event.x), y1: TOP, y2: HEIGHT - BOTTOM });
    addTo(line, "title").textContent = event.text;
  }
  let line = "";
  let pen = "M";
  x.forEach((value, index) => {
    if (y[index] === null) {
      pen = "M";
    } else {
      line += `${pen}${onX(value).toFixed(1)} ${onY(y[index]).toFixed(1)}`;
      pen = "L";
    }
  });
  draw("path", { class: "line", d: line });
  const lineAt = (kind) => draw("line", { class: kind, y1: TOP, y2: HEIGHT - BOTTOM, visibility: "hidden" });
  const [pointed, cursor] = [lineAt("pointed"), lineAt("cursor")];
  const put = (mark, value) => {
    mark.setAttribute("x1", onX(value));
    mark.setAttribute("x2", onX(value));
    mark.setAttribute("visibility", "visible");
  };
  let [present, read] = [first, null];
  // The value between the two nearest samples.
  const tell = () => {
    const at = read ?? present;
    const next = Math.min(Math.max(1, x.findIndex((value) => value >= at)), x.length - 1);
    const [a, b] = [y[next - 1], y[next]];
    const part = (at - x[next - 1]) / (x[next] - x[next - 1]);
    const value = a === null || b === null || !(part >= 0 && part <= 1) ? null : a + part * (b - a);
    const near = events.find((event) => read !== null && Math.abs(onX(event.x) - onX(read)) < 3);
    const over = `${axis.name} = ${shown(at * axis.factor, 4)} ${axis.unit}`;
    reading.textContent = near?.text.replaceAll("`", "") ?? `${over}: ${value === null ? "no finite value" : `${shown(value, 5)} ${unit}`}`;
  };
  return {
    svg,
    low: first,
    high: last,
    /** Moves the cursor to the present pose. */
    move(value) {
      present = value;
      put(cursor, value);
      tell();
    },
    /** Reads the values at a place of the horizontal axis, null for the present pose. */
    read(value) {
      read = value;
      if (value === null) {
        pointed.setAttribute("visibility", "hidden");
      } else {
        put(pointed, value);
      }
      tell();
    },
    /** Returns the place of the horizontal axis under a point of the screen, null outside. */
    at(clientX) {
      const { left, width } = svg.getBoundingClientRect();
      const part = (((clientX - left) / width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
      return part >= 0 && part <= 1 ? first + part * (last - first) : null;
    },
  };
}

/** Returns values as CSV, in the units of display. */
export function csv(page, axis, variables, data) {
  const units = variables.map((index) => page.variables[index]);
  const head = [axis, ...units].map(({ name, unit }) => (unit ? `${name} [${unit}]` : name));
  const rows = data.x.map((x, row) =>
    [x * axis.factor, ...units.map(({ factor }, index) => {
      const value = data.y[index][row];
      return value === null ? "" : value * factor;
    })].join(","),
  );
  return `${[head.join(","), ...rows].join("\n")}\n`;
}
