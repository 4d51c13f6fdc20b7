// The sheet on which a mechanism is drawn: its picture, the grid below it and the marks above it.

import { add } from "./controls.js";

// Pixels between two lines of the grid, at least.
const LEAST_GRID = 22;
// Pixels per metre, at least and at most.
const SCALES = [1e-1, 1e6];
const STEPS = [1, 2, 5, 10];

/** Returns the round number that is not below a number: 1, 2 or 5 times a power of ten. */
export function roundUp(number) {
  const power = 10 ** Math.floor(Math.log10(number));
  return Number((STEPS.find((step) => step * power >= number * (1 - 1e-9)) * power).toPrecision(3));
}

export class Sheet {
  /** `place` is the element for the sheet; `redraw` is called when its scale changes. */
  constructor(place, redraw) {
    this.place = place;
    this.redraw = redraw;
    this.grid = addTo(place, "svg");
    this.paper = add(place, "div", { className: "drawing" });
    this.marks = addTo(place, "svg");
    this.grid.setAttribute("class", "grid");
    this.marks.setAttribute("class", "marks");
    for (const svg of [this.grid, this.marks]) {
      svg.setAttribute("aria-hidden", "true");
    }
    // Middle of the sheet [m], and pixels per metre.
    this.center = [0.2, 0.1];
    this.scale = 1000;
    this.fits = [];
    new ResizeObserver(() => this.look()).observe(place);
  }

  get size() {
    return [this.place.clientWidth || 1, this.place.clientHeight || 1];
  }

  /** Decimals of lengths [m] that the sheet can show. */
  get decimals() {
    return Math.max(0, Math.min(9, Math.ceil(Math.log10(this.scale) + 0.5)));
  }

  /** Returns a length [m] as fine as the sheet shows it. */
  rounded(length) {
    return Number(length.toFixed(this.decimals));
  }

  /** Distance of the lines of the grid [m], to which points snap. */
  get step() {
    return roundUp(LEAST_GRID / this.scale);
  }

  /** Returns the place on the sheet [pixels] of a point [m]. */
  toScreen([x, y]) {
    const [width, height] = this.size;
    return [0.5 * width + (x - this.center[0]) * this.scale, 0.5 * height - (y - this.center[1]) * this.scale];
  }

  /** Returns the point [m] at a place on the sheet [pixels]. */
  toPoint([u, v]) {
    const [width, height] = this.size;
    return [this.center[0] + (u - 0.5 * width) / this.scale, this.center[1] - (v - 0.5 * height) / this.scale];
  }

  /** Returns the place on the sheet [pixels] of a pointer. */
  placeOf(event) {
    const box = this.place.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // -- view ----------------------------------------------------------------------------------

  pan([du, dv]) {
    this.center = [this.center[0] - du / this.scale, this.center[1] + dv / this.scale];
    this.look();
  }

  /** Zooms by a factor; the point at `place` [pixels] stays. */
  zoom(factor, place = this.size.map((side) => 0.5 * side)) {
    const held = this.toPoint(place);
    this.scale = Math.max(SCALES[0], Math.min(SCALES[1], this.scale * factor));
    const moved = this.toPoint(place);
    this.center = [this.center[0] + held[0] - moved[0], this.center[1] + held[1] - moved[1]];
    this.look();
    this.redraw();
  }

  /** Shows all points [m]. */
  fit(points) {
    if (points.length === 0) {
      this.center = [0.2, 0.1];
      this.scale = 1000;
    } else {
      const [low, high] = [Math.min, Math.max].map((extreme) => [0, 1].map((k) => extreme(...points.map((p) => p[k]))));
      const [width, height] = this.size;
      const sides = [high[0] - low[0], high[1] - low[1]];
      const room = [Math.max(80, width - 160), Math.max(80, height - 160)];
      const largest = Math.max(...sides);
      const scale = largest > 0 ? Math.min(room[0] / Math.max(sides[0], 1e-9), room[1] / Math.max(sides[1], 1e-9)) : this.scale;
      this.scale = Math.max(SCALES[0], Math.min(SCALES[1], scale));
      this.center = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    }
    this.look();
    this.redraw();
  }

  /** Puts picture, grid and marks where the view has them. */
  look() {
    const [width, height] = this.size;
    if (this.svg) {
      // The picture may still be of another scale.
      const zoom = this.drawnAt / this.scale;
      const [x, y] = [this.center[0] * this.drawnAt, -this.center[1] * this.drawnAt];
      const view = [x - 0.5 * width * zoom, y - 0.5 * height * zoom, width * zoom, height * zoom];
      this.svg.setAttribute("viewBox", view.map(fix).join(" "));
    }
    for (const svg of [this.grid, this.marks]) {
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    }
    this.drawGrid();
    this.onLook?.();
  }

  drawGrid() {
    const [width, height] = this.size;
    const { step } = this;
    const [left, top] = this.toPoint([0, 0]);
    const [right, bottom] = this.toPoint([width, height]);
    const lines = { fine: "", coarse: "", axis: "" };
    for (const [from, to, line] of [
      [left, right, (at) => `M${fix(this.toScreen([at, 0])[0])} 0V${height}`],
      [bottom, top, (at) => `M0 ${fix(this.toScreen([0, at])[1])}H${width}`],
    ]) {
      for (let k = Math.ceil(from / step); k * step <= to; k += 1) {
        lines[k === 0 ? "axis" : k % 5 === 0 ? "coarse" : "fine"] += line(k * step);
      }
    }
    this.grid.replaceChildren();
    for (const [kind, path] of Object.entries(lines)) {
      const element = addTo(this.grid, "path");
      element.setAttribute("class", kind);
      element.setAttribute("d", path);
    }
  }

  // -- picture -------------------------------------------------------------------------------

  /** Shows a picture, drawn at a scale; nothing without one. */
  show(picture, scale) {
    this.paper.replaceChildren();
    this.svg = null;
    if (picture) {
      this.paper.innerHTML = picture.svg;
      this.svg = this.paper.querySelector("svg");
      this.svg.classList.remove("wide");
      this.drawnAt = scale;
      this.bodies = picture.bodies;
    }
    this.look();
    if (picture) {
      const moving = new Parts(this.svg, picture);
      const { places } = picture;
      const lengths = places.length - picture.lengths;
      moving.draw(
        (attachment) => places.slice(3 * attachment, 3 * attachment + 3),
        (length) => places[lengths + length],
      );
    }
  }

  /** Returns the bodies drawn at a place of the screen, the uppermost first. */
  bodiesAt(x, y) {
    const found = [];
    for (const element of document.elementsFromPoint(x, y)) {
      const part = element.closest?.("[data-attachment]");
      const body = part && this.svg?.contains(part) ? this.bodies[part.dataset.attachment] : null;
      if (body !== null && body !== undefined && !found.includes(body)) {
        found.push(body);
      }
    }
    return found;
  }

  /** Returns the name written at a place of the screen, or nothing. */
  nameAt(x, y) {
    const texts = document.elementsFromPoint(x, y).filter((element) => element.closest?.(".names") && this.svg?.contains(element));
    return texts[0]?.textContent;
  }

  // -- marks ---------------------------------------------------------------------------------

  /** Clears the marks above the picture. */
  clear() {
    this.marks.replaceChildren();
  }

  /** Adds a mark: an SVG element with attributes, and a text. */
  mark(name, attributes, text) {
    const element = addTo(this.marks, name);
    for (const [key, value] of Object.entries(attributes)) {
      element.setAttribute(key, typeof value === "number" ? fix(value) : value);
    }
    if (text !== undefined) {
      element.textContent = text;
    }
    return element;
  }

  /** Marks a line between two points [m]. */
  line(from, to, className) {
    const [[x1, y1], [x2, y2]] = [this.toScreen(from), this.toScreen(to)];
    return this.mark("line", { x1, y1, x2, y2, class: className });
  }

  /** Marks a point [m] by a ring. */
  ring(at, className, r = 9) {
    const [cx, cy] = this.toScreen(at);
    return this.mark("circle", { cx, cy, r, class: className });
  }

  /** Writes beside a point [m]. */
  words(at, text, className = "words", [du, dv] = [12, -12]) {
    const [x, y] = this.toScreen(at);
    return this.mark("text", { x: x + du, y: y + dv, class: className }, text);
  }
}
