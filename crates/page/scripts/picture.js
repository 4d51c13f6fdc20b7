// The moving picture: its parts go where the numbers of a frame say. `Parts`, `addTo`, `arrow` and
// `fix` are those of all pages with moving pictures.

// Distance from the pointer within which a body is found [pixels].
const NEAR = [0, 6, 12, 20, 28];

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
      this.zoomed = false;
      this.most = { velocity: 0, acceleration: 0, force: 0 };
    }
    this.moving = new Parts(this.svg, parts);
    for (const [element, attachment] of this.moving.groups) {
      element.classList.toggle("body", parts.bodies[attachment] !== null);
    }
    this.arrows = {};
    for (const kind of ["force", "acceleration", "velocity"]) {
      const group = this.svg.querySelector(`.arrows.${kind}`) ?? this.add("g", `arrows ${kind}`);
      this.arrows[kind] = [group, []];
    }
    this.spring = this.add("path", "spring");
    this.marker = this.add("g", "stop");
    this.marker.innerHTML = '<circle r="15"/><path d="M-5 -5L5 5M-5 5L5 -5"/>';
    this.mark(null);
  }

  add(name, className) {
    const element = addTo(this.svg, name);
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

  /** Measures the names anew: they have been shown, or the screen has another size. */
  fit() {
    this.moving.fit();
  }

  draw(frame, places) {
    const { attachments, lengths } = places;
    const placed = (attachment) => frame.subarray(attachments + 3 * attachment, attachments + 3 * attachment + 3);
    this.moving.draw(placed, (length) => frame[lengths + length]);
    const [x, y, u, v] = frame.subarray(places.spring, places.spring + 4);
    this.spring.setAttribute("d", Number.isFinite(x) ? `M${fix(x)} ${fix(y)}L${fix(u)} ${fix(v)}` : "");
    const points = this.parts.points.map(({ attachment, at }) => this.moving.outside(attachment, at));
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
      paths.push(addTo(group, "path"));
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

  /** Zooms by a factor; a place on the sheet stays. */
  zoom(factor, [x, y]) {
    const view = this.svg.viewBox.baseVal;
    const [left, top] = [x - (x - view.x) / factor, y - (y - view.y) / factor];
    this.look(left, top, view.width / factor, view.height / factor);
  }

  /** Moves the visible part of the sheet so that one place goes to another. */
  pan([x, y], [u, v]) {
    const view = this.svg.viewBox.baseVal;
    this.look(view.x - (u - x), view.y - (v - y), view.width, view.height);
  }

  look(...view) {
    this.svg.setAttribute("viewBox", view.map(fix).join(" "));
    this.zoomed = true;
  }

  /**
   * Returns the place on the sheet of a point of the screen.
   * @returns {[number, number]}
   */
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
    return this.moving.groups.some(([element]) => {
      const box = element.getBoundingClientRect();
      return box.left < corner.x - 1 || box.top < corner.y - 1 || box.right > other.x + 1 || box.bottom > other.y + 1;
    });
  }
}
