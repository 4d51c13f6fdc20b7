// A chart of variables over time or over a driver, with a cursor at the present pose.

import { offerMoves, shown } from "./controls.js";

const [WIDTH, HEIGHT] = [560, 150];
const [LEFT, RIGHT, TOP, BOTTOM] = [64, 10, 20, 22];
const SAMPLES = 241;

export class Chart {
  constructor(live, find) {
    this.live = live;
    this.place = find(".chart");
    this.over = find(".over");
    this.choice = find(".variables");
    this.panels = [];
    this.choice.addEventListener("change", () => this.draw());
    this.over.addEventListener("change", () => this.draw());
  }

  /** Offers the variables of a page; what was chosen before stays. */
  offer(page) {
    const before = this.chosen.map((index) => this.names?.[index]);
    this.names = page.variables.map((variable) => variable.name);
    offerMoves(this.over, page);
    this.choice.replaceChildren();
    const told = page.variables.findIndex((variable, index) => variable.is_told && index >= 3 * page.drivers.length);
    const first = told < 0 ? page.variables.length - 3 : told;
    const usual = page.energies.length ? page.energies : [first];
    page.variables.forEach((variable, index) => {
      const chosen = before.length ? before.includes(variable.name) : usual.includes(index);
      this.choice.add(new Option(variable.name, index, chosen, chosen));
    });
  }

  get chosen() {
    return [...this.choice.selectedOptions].map((option) => Number(option.value));
  }

  /** Asks for values, of these variables or of those chosen. */
  values(variables = this.chosen, samples = SAMPLES) {
    const over = this.driver === null ? {} : { driver: this.driver };
    return this.live.ask({ do: "chart", variables, samples, ...over });
  }

  /** Returns the driver along the horizontal axis, null for time. */
  get driver() {
    return ["time", ""].includes(this.over.value) ? null : Number(this.over.value);
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
    const chosen = this.chosen.slice(0, 6);
    const data = this.values(chosen);
    this.place.replaceChildren();
    this.panels = [];
    if (!data || data.x.length < 2) {
      return;
    }
    const axis = this.axis;
    chosen.forEach((variable, index) => {
      const { name, unit, factor } = this.live.page.variables[variable];
      const y = data.y[index].map((value) => (value === null ? null : value * factor));
      // An energy that is kept has the errors of integration.
      const constant = this.live.page.is_free ? 1e-6 : 1e-9;
      this.panels.push(panel(this.place, axis, data.x, { name, unit, y, constant }));
    });
    this.move();
  }

  /** Moves the cursors to the present pose. */
  move() {
    const now = this.live.frame?.[this.axis.at];
    // Free motion goes on beyond the chart.
    if (this.live.page.is_free && this.panels.some(({ low, high }) => now < low || now > high)) {
      this.draw();
      return;
    }
    for (const { cursor, low, high } of this.panels) {
      // A crank that has turned further is shown in the turn of the chart.
      const turn = high - low;
      const turns = this.live.page.ranges[this.driver]?.turns;
      const x = turns ? now - turn * Math.floor((now - low) / turn) : now;
      const at = LEFT + ((x - low) / turn) * (WIDTH - LEFT - RIGHT);
      cursor.setAttribute("x1", at);
      cursor.setAttribute("x2", at);
    }
  }
}

function panel(place, axis, x, { name, unit, y, constant }) {
  const known = y.filter((value) => value !== null);
  let [low, high] = [Math.min(...known), Math.max(...known)];
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
  for (const value of [low, 0.5 * (low + high), high]) {
    const height = onY(value);
    draw("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: height, y2: height });
    draw("text", { x: LEFT - 6, y: height + 4, "text-anchor": "end" }, String(shown(value, 4)));
  }
  for (const [value, anchor] of [[first, "start"], [0.5 * (first + last), "middle"], [last, "end"]]) {
    const label = String(shown(value * axis.factor, 4));
    draw("text", { x: onX(value), y: HEIGHT - 6, "text-anchor": anchor }, label);
  }
  draw("text", { x: LEFT, y: 12, class: "title" }, text);
  draw("text", { x: WIDTH - RIGHT, y: 12, "text-anchor": "end" }, `over ${axis.name} [${axis.unit}]`);
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
  const cursor = draw("line", { class: "cursor", y1: TOP, y2: HEIGHT - BOTTOM });
  return { cursor, low: first, high: last };
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
