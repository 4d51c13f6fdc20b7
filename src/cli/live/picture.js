// The moving picture: its parts go where the numbers of a frame say.

export const SVG = "http://www.w3.org/2000/svg";
// Length of the longest arrow and of its tip, in units of the picture.
const LONGEST = 90;
const TIP = 7;
// Height of a line of letters over that of capitals.
const LINE = 1.4;
// Distance from the pointer within which a body is found [pixels].
const NEAR = [0, 6, 12, 20, 28];

const fix = (number) => Math.round(number * 100) / 100;

export class Picture {
  constructor(paper) {
    this.paper = paper;
    // The greatest value of each kind of arrow so far, which has the longest arrow.
    this.most = { velocity: 0, acceleration: 0, force: 0 };
  }

  /** Shows other parts; `keep` leaves the visible part of the sheet as it is. */
  show(parts, keep) {
    const view = keep && this.svg ? this.svg.getAttribute("viewBox") : null;
    this.parts = parts;
    this.paper.innerHTML = parts.svg;
    this.svg = this.paper.querySelector("svg");
    if (view) {
      this.svg.setAttribute("viewBox", view);
    } else {
      this.most = { velocity: 0, acceleration: 0, force: 0 };
    }
    const all = (selector) => [...this.svg.querySelectorAll(selector)];
    this.moving = all("[data-attachment]").map((element) => [element, Number(element.dataset.attachment)]);
    for (const [element, attachment] of this.moving) {
      element.classList.toggle("body", parts.bodies[attachment] !== null);
    }
    this.elastic = all("[data-length]").map((path) => ({
      path,
      length: Number(path.dataset.length),
      points: path.dataset.points.split(" ").map(Number),
    }));
    this.names = all(".names text");
    // On small screens letters are larger, and names that would cover others are left out.
    const group = this.svg.querySelector(".names");
    this.larger = group ? parseFloat(getComputedStyle(group).fontSize) / Number(group.getAttribute("font-size")) : 1;
    this.widths = this.names.map((name) => name.getComputedTextLength());
    this.arrows = {};
    for (const kind of ["force", "acceleration", "velocity"]) {
      const group = this.svg.querySelector(`.arrows.${kind}`) ?? this.add("g", `arrows ${kind}`);
      this.arrows[kind] = [group, []];
    }
    this.marker = this.add("g", "stop");
    this.marker.innerHTML = '<circle r="15"/><path d="M-5 -5L5 5M-5 5L5 -5"/>';
    this.mark(null);
  }

  add(name, className) {
    const element = this.svg.appendChild(document.createElementNS(SVG, name));
    element.setAttribute("class", className);
    return element;
  }

  /** Marks the place of what stops the mechanism; none for null. */
  mark(at) {
    this.marker.style.display = at ? "" : "none";
    if (at) {
      this.marker.setAttribute("transform", `translate(${fix(at[0])} ${fix(at[1])})`);
    }
  }

  draw(frame, places) {
    const place = (attachment) => {
      const [x, y, degrees] = frame.slice(places.attachments + 3 * attachment);
      const angle = (degrees * Math.PI) / 180;
      return { x, y, degrees, cos: Math.cos(angle), sin: Math.sin(angle) };
    };
    const outside = (attachment, [x, y]) => {
      const { x: left, y: top, cos, sin } = place(attachment);
      return [left + cos * x - sin * y, top + sin * x + cos * y];
    };
    for (const [element, attachment] of this.moving) {
      const { x, y, degrees } = place(attachment);
      element.setAttribute("transform", `translate(${fix(x)} ${fix(y)}) rotate(${fix(degrees)})`);
    }
    for (const { path, length, points } of this.elastic) {
      const now = frame[places.lengths + length];
      let line = "";
      for (let at = 0; at < points.length; at += 4) {
        const [x, y, alongX, alongY] = points.slice(at, at + 4);
        line += `${at ? "L" : "M"}${fix(x + now * alongX)} ${fix(y + now * alongY)}`;
      }
      path.setAttribute("d", line);
    }
    const seen = [];
    this.parts.labels.forEach((label, index) => {
      let [x, y] = outside(label.attachment, label.at);
      const [width, height] = [this.widths[index], this.larger * this.parts.capitals];
      if (label.side) {
        const { cos, sin } = place(label.attachment);
        const [u, v] = label.side.map((part) => part / 100);
        const side = [cos * u - sin * v, sin * u + cos * v];
        const reach = 0.5 * (width * Math.abs(side[0]) + height * Math.abs(side[1]));
        x += (label.gap + reach) * side[0];
        y += (label.gap + reach) * side[1];
      }
      this.names[index].setAttribute("x", fix(x));
      this.names[index].setAttribute("y", fix(y + 0.5 * height));
      const covers = (other) =>
        2 * Math.abs(x - other.x) < width + other.width && 2 * Math.abs(y - other.y) < LINE * (height + other.height);
      const fits = !(this.larger > 1.01) || !seen.some(covers);
      this.names[index].style.visibility = fits ? "" : "hidden";
      if (fits) {
        seen.push({ x, y, width, height });
      }
    });
    const points = this.parts.points.map(({ attachment, at }) => outside(attachment, at));
    const rates = (shift) =>
      points.map((from, index) => {
        const first = places.points + 4 * index + shift;
        return [from, [frame[first], frame[first + 1]]];
      });
    this.drawArrows("velocity", rates(0));
    this.drawArrows("acceleration", rates(2));
    const joints = Array.from({ length: places.joint_count }, (_, joint) => {
      const [x, y, fx, fy] = frame.slice(places.joints + 4 * joint);
      return [
        [x, y],
        [fx, fy],
      ];
    });
    this.drawArrows("force", joints);
  }

  drawArrows(kind, arrows) {
    const [group, paths] = this.arrows[kind];
    while (paths.length < arrows.length) {
      paths.push(group.appendChild(document.createElementNS(SVG, "path")));
    }
    for (const [, [x, y]] of arrows) {
      const size = Math.hypot(x, y);
      // Next to a dead point rates grow without bounds.
      if (size > this.most[kind] && size < 1e6) {
        this.most[kind] = size;
      }
    }
    const most = this.most[kind];
    arrows.forEach(([from, [x, y]], index) => {
      const factor = most > 1e-9 ? 1 / most : 0;
      paths[index].setAttribute("d", arrow(from, factor * x, factor * y));
    });
  }

  /** Returns the place on the sheet of a point of the screen. */
  onSheet(x, y) {
    const point = new DOMPoint(x, y).matrixTransform(this.svg.getScreenCTM().inverse());
    return [point.x, point.y];
  }

  /** Returns the body at or near a point of the screen, or null. */
  bodyAt(x, y) {
    for (const radius of NEAR) {
      for (let step = 0; step < (radius ? 8 : 1); step += 1) {
        const angle = (step * Math.PI) / 4;
        const [u, v] = [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
        for (const element of document.elementsFromPoint(u, v)) {
          const part = element.closest?.("[data-attachment]");
          const body = part && this.svg.contains(part) ? this.parts.bodies[part.dataset.attachment] : null;
          if (body !== null) {
            return body;
          }
        }
      }
    }
    return null;
  }

  /** Whether a part that moves lies outside of what is visible. */
  get leaves() {
    const { x, y, width, height } = this.svg.viewBox.baseVal;
    const toScreen = this.svg.getScreenCTM();
    const corner = new DOMPoint(x, y).matrixTransform(toScreen);
    const other = new DOMPoint(x + width, y + height).matrixTransform(toScreen);
    return this.moving.some(([element]) => {
      const box = element.getBoundingClientRect();
      return box.left < corner.x - 1 || box.top < corner.y - 1 || box.right > other.x + 1 || box.bottom > other.y + 1;
    });
  }
}

// An arrow whose length is a part of the longest.
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
