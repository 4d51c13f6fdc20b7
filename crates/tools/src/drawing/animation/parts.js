"use strict";
// Pictures that move: parts that follow frames, names that stay readable, arrows.

const SVG = "http://www.w3.org/2000/svg";
// Length of the longest arrow, and of its tip, in units of the picture.
const LONGEST = 90;
const TIP = 7;
// Radius of a torque's arc, and the angle of the largest one.
const ARC = 18;
const WIDEST = (5 / 3) * Math.PI;
// Height of a line of letters over that of capitals.
const LINE = 1.4;

/** The parts of a picture that move, and its names. */
class Parts {
  /** `labels` have the places of the names, which have capitals of the height `capitals`. */
  constructor(svg, { labels, capitals }) {
    const all = (selector) => [...svg.querySelectorAll(selector)];
    Object.assign(this, { svg, labels, capitals });
    this.groups = all("[data-attachment]").map((element) => [element, Number(element.dataset.attachment)]);
    this.elastic = all("[data-length]").map((path) => ({
      path,
      length: Number(path.dataset.length),
      points: path.dataset.points.split(" ").map(Number),
    }));
    this.names = all(".names text");
    this.fit();
  }

  /** Measures the names: on small screens they are larger, and each font has its own widths. */
  fit() {
    const group = this.svg.querySelector(".names");
    this.larger = parseFloat(getComputedStyle(group).fontSize) / Number(group.getAttribute("font-size"));
    // Hidden texts have no width.
    this.names.forEach((name) => name.classList.remove("covered"));
    this.widths = this.names.map((name) => name.getComputedTextLength());
  }

  /** Moves all parts: `placed` returns x, y and angle [deg] of an attachment, `long` a length. */
  draw(placed, long) {
    this.placed = placed;
    this.places = [];
    for (const [element, attachment] of this.groups) {
      const { x, y, degrees } = this.place(attachment);
      placePart(element, x, y, degrees);
    }
    for (const { path, length, points } of this.elastic) {
      stretchPath(path, points, long(length));
    }
    // A name that would be over an earlier one is hidden until there is room.
    const seen = [];
    this.names.forEach((name, index) => {
      const box = this.box(index);
      name.setAttribute("x", fix(box.x));
      name.setAttribute("y", fix(box.y + 0.5 * box.height));
      const fits = seen.every((other) => apart(box, other));
      name.classList.toggle("covered", !fits);
      if (fits) {
        seen.push(box);
      }
    });
  }

  place(attachment) {
    this.places[attachment] ??= (([x, y, degrees]) => {
      const angle = (degrees * Math.PI) / 180;
      return { x, y, degrees, cos: Math.cos(angle), sin: Math.sin(angle) };
    })(this.placed(attachment));
    return this.places[attachment];
  }

  /** Returns the place in the picture of a point in the frame of an attachment. */
  outside(attachment, [x, y]) {
    const { x: left, y: top, cos, sin } = this.place(attachment);
    return [left + cos * x - sin * y, top + sin * x + cos * y];
  }

  /** Returns middle and size of a name. */
  box(index) {
    const { attachment, at, side, gap } = this.labels[index];
    let [x, y] = this.outside(attachment, at);
    const [width, height] = [this.widths[index], this.larger * this.capitals];
    if (side) {
      const { cos, sin } = this.place(attachment);
      const [u, v] = side.map((part) => part / 100);
      const [outX, outY] = [cos * u - sin * v, sin * u + cos * v];
      // As far out as the side of the name's box that faces its place.
      const reach = 0.5 * (width * Math.abs(outX) + height * Math.abs(outY));
      x += (gap + reach) * outX;
      y += (gap + reach) * outY;
    }
    const view = this.svg.viewBox.baseVal;
    x = within(x, 0.5 * width, view.x, view.width);
    y = within(y, 0.5 * height, view.y, view.height);
    return { x, y, width, height };
  }
}

function addTo(parent, name) {
  return parent.appendChild(document.createElementNS(SVG, name));
}

function placePart(element, x, y, degrees) {
  element.setAttribute("transform", `translate(${fix(x)} ${fix(y)}) rotate(${fix(degrees)})`);
}

function stretchPath(path, points, long) {
  let line = "";
  for (let at = 0; at < points.length; at += 4) {
    const [x, y, alongX, alongY] = points.slice(at, at + 4);
    line += `${at ? "L" : "M"}${fix(x + long * alongX)} ${fix(y + long * alongY)}`;
  }
  path.setAttribute("d", line);
}

function fix(number) {
  return Math.round(number * 100) / 100;
}

// The middle of what reaches so far to both sides, moved so that all of it is within.
function within(middle, half, start, length) {
  return Math.max(start + half, Math.min(start + length - half, middle));
}

// Whether two names can be told apart.
function apart(a, b) {
  return 2 * Math.abs(a.x - b.x) >= a.width + b.width || 2 * Math.abs(a.y - b.y) >= LINE * (a.height + b.height);
}

// An arrow whose length is a part of the longest; none next to a dead point, where rates grow.
function arrow([x, y], partX, partY) {
  const [u, v] = [LONGEST * partX, LONGEST * partY];
  const length = Math.hypot(u, v);
  if (!(length >= 1) || length > 4 * LONGEST) {
    return "";
  }
  const tip = Math.min(TIP, length) / length;
  const [along, aside] = [1 - tip, 0.45 * tip];
  const to = (a, b) => `${fix(x + a * u - b * v)} ${fix(y + a * v + b * u)}`;
  return `M${to(0, 0)}L${to(1, 0)}M${to(along, aside)}L${to(1, 0)}L${to(along, -aside)}`;
}

// An arc about a point whose angle is a part of the widest, counter-clockwise from below.
function turn([x, y], part) {
  const angle = WIDEST * part;
  if (ARC * Math.abs(angle) < 1) {
    return "";
  }
  const sense = Math.sign(angle);
  const at = (radius, to) => `${fix(x + radius * Math.sin(to))} ${fix(y + radius * Math.cos(to))}`;
  const back = angle - sense * Math.min(TIP / ARC, Math.abs(angle));
  const large = Math.abs(angle) > Math.PI ? 1 : 0;
  const arc = `M${at(ARC, 0)}A${ARC} ${ARC} 0 ${large} ${sense > 0 ? 0 : 1} ${at(ARC, angle)}`;
  return `${arc}M${at(ARC + 0.45 * TIP, back)}L${at(ARC, angle)}L${at(ARC - 0.45 * TIP, back)}`;
}
