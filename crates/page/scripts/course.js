// @ts-check
// The path of a point that was clicked, with its speed, and poses laid over each other.

import { say, shown } from "./controls.js";

// Points of a path.
const ON_PATH = 241;
// Poses over each other; those of a full turn are 30° apart.
const POSES = 13;

export class Course {
  /** @param {import("./live.js").Live} live */
  constructor(live, find) {
    this.live = live;
    this.poses = find(".poses");
    this.told = find(".traced");
    this.body = null;
    this.poses.addEventListener("change", () => this.draw());
    this.told.querySelector("button").addEventListener("click", () => this.trace({ body: null }));
  }

  /**
   * Traces the point `grip` of a body, in its frame; none where the body is null.
   * @param {{ body: number | null, grip?: [number, number] }} point
   */
  trace({ body, grip }) {
    if (body === null && this.body === null) {
      return;
    }
    this.body = body;
    this.live.ask({ do: "trace", body, grip });
    this.live.draw();
    this.draw();
  }

  /** Forgets the point: another mechanism is open. */
  forget() {
    this.body = null;
  }

  /** Draws path and poses anew, along what can move. */
  draw() {
    const { live, poses } = this;
    const { picture } = live;
    this.behind?.remove();
    this.before?.remove();
    // Behind all that moves, and before it.
    this.behind = picture.add("g", "behind");
    picture.svg.querySelector("[data-attachment]")?.before(this.behind);
    this.before = picture.add("g", "before");
    const { driver } = live.play;
    if (poses.checked) {
      const { attachments, lengths } = live.places;
      const answer = live.ask({ do: "poses", samples: POSES, driver });
      for (const places of answer?.poses ?? []) {
        this.addPose(places, lengths - attachments);
      }
    }
    this.dot = null;
    if (this.body !== null) {
      const { points = [] } = live.ask({ do: "path", samples: ON_PATH, driver }) ?? {};
      const path = addTo(this.before, "path");
      path.setAttribute("d", points.map(([x, y], index) => `${index ? "L" : "M"}${fix(x)} ${fix(y)}`).join(""));
      this.dot = addTo(this.before, "circle");
      this.dot.setAttribute("r", 4);
    }
    this.move();
  }

  /** Adds the bodies at a pose, of which a list has the places, and from `lengths` on the lengths. */
  addPose(places, lengths) {
    const { moving, parts } = this.live.picture;
    const pose = addTo(this.behind, "g");
    for (const [element, attachment] of moving.groups) {
      if (parts.bodies[attachment] === null) {
        continue;
      }
      const copy = pose.appendChild(element.cloneNode(true));
      copy.removeAttribute("data-attachment");
      placePart(copy, ...places.slice(3 * attachment, 3 * attachment + 3));
      for (const path of copy.querySelectorAll("[data-length]")) {
        stretchPath(path, path.dataset.points.split(" ").map(Number), places[lengths + Number(path.dataset.length)]);
      }
    }
  }

  /** Moves the point to the present pose, and tells its place and speed. */
  move() {
    const { frame, places, page, picture } = this.live;
    this.told.hidden = this.body === null;
    if (this.body === null || !this.dot) {
      return;
    }
    const [x, y, vx, vy] = frame.subarray(places.traced, places.traced + 4);
    this.dot.setAttribute("cx", fix(x * picture.parts.scale));
    this.dot.setAttribute("cy", fix(-y * picture.parts.scale));
    const { unit, factor } = page.length;
    const [left, top] = [x, y].map((value) => shown(value * factor, 5));
    const speed = shown(Math.hypot(vx, vy), 4);
    const end = speed === null ? "no finite speed" : `speed ${speed} m/s`;
    say(this.told.querySelector("span"), `Point of \`${page.bodies[this.body]}\` at ${left}, ${top} ${unit}, ${end}`);
  }
}
