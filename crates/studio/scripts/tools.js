// @ts-check
// The tools by which a mechanism is drawn: what they ask for, click by click, and the gesture that comes
// out. Each click is at a point, on a body, on ground or on the bare sheet; the solver knows the rest.

// Marks of the tools, in a square of 24.
const ICONS = {
  select: "M6 3l12 9-6 1 3 7-3 1-3-7-4 4z",
  link: "M5 19L19 5 M5 19m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0-5 0 M19 5m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0-5 0",
  plate: "M4 19L20 19L12 5Z M4 19m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0 M20 19m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0 M12 5m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  pivot: "M12 6m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0-5 0 M12 8.5L6 17H18Z M4 17H20 M6 17l-2 3 M11 17l-2 3 M16 17l-2 3",
  slider: "M3 17H21 M6 9H18V17H6Z M12 13m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0 M5 17l-2 3 M12 17l-2 3 M19 17l-2 3",
  slot: "M6 8H18a4 4 0 0 1 0 8H6a4 4 0 0 1 0-8Z M14 12m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  cylinder: "M3 15L13 5l5 5L8 20Z M15.500 7.500L21 2 M3 20m-1.500 0a1.500 1.500 0 1 0 3 0a1.500 1.500 0 1 0-3 0",
  wheels: "M9 12m-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0 M18.500 12m-3.500 0a3.500 3.500 0 1 0 7 0a3.500 3.500 0 1 0-7 0 M9 12h.01 M18.500 12h.01",
  rack: "M12 9m-5.500 0a5.500 5.500 0 1 0 11 0a5.500 5.500 0 1 0-11 0 M2 15l2 2h2l2-2 2 2h2l2-2 2 2h2l2-2 M2 20H22 M12 9h.01",
  belt: "M7 12m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0 M19 12m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0 M7 7L19 9 M7 17L19 15",
  cam: "M12 21a6 6 0 0 1-6-6c0-3 3-5 4-8a2 2 0 0 1 4 0c1 3 4 5 4 8a6 6 0 0 1-6 6Z M12 15h.01 M12 2v3",
  spring: "M2 12h3l1.500-4 3 8 3-8 3 8 3-8 1.500 4h3",
  damper: "M2 12h7 M9 7v10 M9 7h7 M9 17h7 M13 9v6 M13 12h9",
  load: "M12 3v14 M7 12l5 6 5-6 M8 21h8",
  mass: "M12 12m-8 0a8 8 0 1 0 16 0a8 8 0 1 0-16 0 M12 4V20 M4 12H20",
  driver: "M19 12a7 7 0 1 1-3-5.700 M16 2v5h-5 M12 12h.01",
  freedom: "M12 3v10 M12 13m-4 4a4 4 0 1 0 8 0a4 4 0 1 0-8 0 M5 6c-2 4-2 8 0 12 M19 6c2 4 2 8 0 12",
  weld: "M4 18L12 10L20 18 M12 10m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0 M9.500 7.500l5 5 M14.500 7.500l-5 5",
  curve: "M2 17c5-14 9-14 11-6s5 6 9-3 M13 11m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  rope: "M12 9m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0 M7 9v11 M17 9v8 M15 17h4v4h-4z M12 9h.01",
  coupling: "M6 12m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0 M18 12m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0 M10.500 10.500h3 M10.500 13.500h3",
  friction: "M3 18H21 M7 10H17V18H7Z M3 18l3 3 M9 18l3 3 M15 18l3 3 M20 7H11 M14 4l-3 3 3 3",
  stop: "M4 4V20 M20 4V20 M8 12H16 M10.500 9.500L8 12l2.500 2.500 M13.500 9.500L16 12l-2.500 2.500",
  bar: "M6.500 21a4.500 4.500 0 0 1-3.500-7.500L13.500 4a4.500 4.500 0 0 1 7 6L10 19.500a4.500 4.500 0 0 1-3.500 1.500Z M6.500 16.500h.01 M17 7h.01",
  disc: "M12 12m-8 0a8 8 0 1 0 16 0a8 8 0 1 0-16 0 M12 12h.01 M12 12L18 7",
  outline: "M4 19L7 6L17 4L20 13L13 20Z",
  hole: "M3 4H21V20H3Z M12 12m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0",
  contact: "M8 12m-5.500 0a5.500 5.500 0 1 0 11 0a5.500 5.500 0 1 0-11 0 M13.500 5V21 M13.500 5H20V21H13.500",
  trace: "M3 18c3-14 9-14 10-5s6 4 8-6 M3 18h.01",
};

/** The element with a tool's mark. */
export function icon(name) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  addTo(svg, "path").setAttribute("d", ICONS[name] ?? "");
  return svg;
}

/** The marker of a point that a joint takes: one of a body rather than of ground. */
export function ownMarker(point) {
  return point.markers.find((marker) => !marker.startsWith("ground.")) ?? point.markers[0];
}

/**
 * What the solver gets for a click: where it is, and what is there.
 * @returns {import("../../page/scripts/messages").Target}
 */
function target(found, { own = false, ground = false } = {}) {
  if (found.point) {
    return { at: found.at, marker: found.fixed || (own ? ownMarker(found.point) : found.point.markers[0]) };
  }
  if (found.body) {
    return { at: found.at, body: found.body };
  }
  return { at: found.at, ground };
}

/** Whether the foot of a point on the line of two others is between these. */
function isBetween([x, y], [u, v], [a, b]) {
  const along = (a - x) * (u - x) + (b - y) * (v - y);
  return along > 0 && along < (u - x) ** 2 + (v - y) ** 2;
}

const NEEDS_POINT = "Choose a pin or the end of a link";

/**
 * The key of a tool as it is told; a capital letter is one with Shift.
 * @param {Tool} tool
 */
export function keyName({ key }) {
  return key === key.toLowerCase() ? key.toUpperCase() : `Shift+${key}`;
}

/**
 * @typedef {{
 *   label: string | null, key?: string, group?: string, hints: string[], only?: string[], typed?: boolean,
 *   least?: number, most?: number, gesture?: (found: any[]) => import("../../page/scripts/messages").Gesture,
 * }} Tool
 */

/**
 * A tool that adds a shape; the last click of one that is round sets its radius.
 * @param {import("../../page/scripts/messages").ShapeKind} shape
 * @returns {(found: any[]) => import("../../page/scripts/messages").Gesture}
 */
function byShape(shape) {
  return (found) => {
    const corners = shape === "outline" ? found : found.slice(0, -1);
    const points = corners.map((each) => target(each, each));
    const { owner } = found[0];
    return { kind: "shape", shape, points, ...(owner ? { body: owner } : {}), ...(shape === "outline" ? {} : { rim: found[found.length - 1].at }) };
  };
}

/**
 * A tool whose clicks are taken as they come.
 * @param {number} count
 * @param {(found: any[]) => import("../../page/scripts/messages").Gesture} gesture
 */
function byClicks(count, gesture) {
  return { most: count, least: count, gesture };
}

/**
 * The tools. `hints` say what to click, one per click; `least` and `most` count the clicks; `only` names
 * what each click must be at; `typed` tells that length and direction can be typed; `gesture` makes the
 * gesture of what was found at the clicks.
 * @type {Record<string, Tool>}
 */
export const TOOLS = {
  select: {
    label: "Select",
    key: "v",
    hints: ["Click something to see its numbers; drag a pin to change the geometry"],
  },
  scale: {
    label: null,
    hints: ["Click a point of the picture", "Click another point, whose distance you know"],
    least: 2,
    most: 2,
  },
  link: {
    label: "Link",
    key: "l",
    group: "Bodies",
    hints: [
      "Click the first end of the link; on a pin it joins there, with Ctrl it is a pivot on ground",
      "Click the other end, or type the length",
    ],
    typed: true,
    ...byClicks(2, (found) => ({ kind: "link", points: found.map((each) => target(each, each)) })),
  },
  plate: {
    label: "Plate",
    key: "p",
    hints: ["Click the first corner of the plate", "Click the next corner", "Click more corners; Enter, or the first corner again, ends"],
    typed: true,
    least: 3,
    most: 40,
    gesture: (found) => ({ kind: "link", points: found.map((each) => target(each, each)) }),
  },
  bar: {
    label: "Bar",
    key: "B",
    group: "Shapes",
    hints: ["Click one end of the bar, on a body", "Click the other end, on the same body", "Click how wide the bar is"],
    only: ["part", "part", "rim"],
    ...byClicks(3, byShape("bar")),
  },
  disc: {
    label: "Disc",
    key: "D",
    hints: ["Click the centre of the disc: on a body, with Ctrl on ground", "Click a point of its rim"],
    only: ["owner", "rim"],
    ...byClicks(2, byShape("disc")),
  },
  outline: {
    label: "Outline",
    key: "O",
    hints: ["Click the first corner: on a body, with Ctrl on ground", "Click the next corner", "Click more corners; Enter, or the first corner again, ends"],
    only: ["owner", "any"],
    least: 3,
    most: 40,
    gesture: byShape("outline"),
  },
  hole: {
    label: "Hole",
    key: "H",
    hints: ["Click the centre of the hole, in a shape", "Click a point of its rim"],
    only: ["owner", "rim"],
    ...byClicks(2, byShape("hole")),
  },
  contact: {
    label: "Contact",
    key: "C",
    hints: ["Click a shape", "Click the shape of another body that it touches"],
    ...byClicks(2, ([a, b]) => ({ kind: "contact", points: [target(a), target(b)] })),
  },
  pivot: {
    label: "Pivot",
    key: "g",
    group: "Joints",
    hints: ["Click the point that a pin holds on ground"],
    only: ["point"],
    ...byClicks(1, ([found]) => ({ kind: "pivot", marker: ownMarker(found.point) })),
  },
  slider: {
    label: "Slider",
    key: "s",
    hints: ["Click the pin that slides, or the bare sheet for a slider alone", "Click where the guide leads"],
    typed: true,
    ...byClicks(2, ([found, to]) => ({
      kind: "slider",
      target: target(found, { own: true }),
      angle: Math.atan2(to.at[1] - found.at[1], to.at[0] - found.at[0]),
    })),
  },
  slot: {
    label: "Slot",
    key: "o",
    hints: ["Click the pin that slides", "Click the bar along which it slides"],
    only: ["point", "body"],
    ...byClicks(2, ([found, bar]) => ({ kind: "slot", marker: ownMarker(found.point), body: bar.body })),
  },
  weld: {
    label: "Weld",
    key: "x",
    hints: ["Click the pin that is to be fixed, or the free end that ground holds"],
    only: ["pin"],
    ...byClicks(1, ([found]) => (found.joint ? { kind: "weld", joint: found.joint } : { kind: "weld_to_ground", marker: ownMarker(found.point) })),
  },
  curve: {
    label: "Track",
    key: "j",
    hints: ["Click the pin that runs in the track", "Click the next point of the track", "Click more points; Enter, or the last point again, ends"],
    only: ["point", "any"],
    least: 3,
    most: 40,
    gesture: ([first, ...others]) => ({ kind: "curve", marker: ownMarker(first.point), points: others.map(({ at }) => at) }),
  },
  rope: {
    label: "Rope",
    key: "y",
    hints: ["Click the first end of the rope; on the bare sheet it is on ground", "Click the next point", "Click more points; Enter, or the last point again, ends"],
    least: 2,
    most: 20,
    gesture: (found) => ({ kind: "rope", points: found.map((each) => target(each, { own: true })) }),
  },
  cylinder: {
    label: "Cylinder",
    key: "c",
    hints: ["Click the cylinder's foot; on the bare sheet it is on ground", "Click the other end: a pin or a bar"],
    ...byClicks(2, (found) => ({ kind: "cylinder", points: found.map((each) => target(each, { own: true })) })),
  },
  wheels: {
    label: "Gears",
    key: "w",
    group: "Machine parts",
    hints: ["Click the centre of the first wheel", "Click the centre of the second wheel", "Click where the teeth meet: between the centres, or beyond one for a ring"],
    ...byClicks(3, ([a, b, at]) => ({
      kind: "wheels",
      type: isBetween(a.at, b.at, at.at) ? "gear" : "internal",
      points: [a, b].map((each) => target(each)),
      fixed: [Boolean(a.fixed), Boolean(b.fixed)],
      contact: at.at,
    })),
  },
  belt: {
    label: "Belt",
    key: "b",
    hints: ["Click the centre of the first wheel", "Click a point of its rim", "Click the centre of the second wheel", "Click a point of its rim"],
    ...byClicks(4, ([a, rimA, b, rimB]) => ({
      kind: "wheels",
      type: "belt",
      points: [a, b].map((each) => target(each)),
      radii: [
        Math.hypot(rimA.at[0] - a.at[0], rimA.at[1] - a.at[1]),
        Math.hypot(rimB.at[0] - b.at[0], rimB.at[1] - b.at[1]),
      ],
    })),
  },
  rack: {
    label: "Rack",
    key: "r",
    hints: ["Click the centre of the pinion", "Click where it touches the rack"],
    ...byClicks(2, ([a, at]) => ({ kind: "rack", point: target(a), contact: at.at })),
  },
  cam: {
    label: "Cam",
    key: "k",
    hints: ["Click the centre of the cam, or the pin of a roller", "Click where its follower touches it, or the pin of a roller"],
    ...byClicks(2, (found) => {
      const roller = [...found].reverse().find(({ point }) => point && !point.ground);
      const [centre, at] = roller === found[0] ? [found[1], roller] : found;
      const of = roller && ownMarker(roller.point);
      return { kind: "cam", point: target(centre, { ground: true }), contact: at.at, ...(of ? { of } : {}), ...(at.follower ? { follower: at.follower } : {}) };
    }),
  },
  coupling: {
    label: "Coupling",
    key: "z",
    hints: ["Click the pin or slider that leads", "Click the one that follows"],
    only: ["joint"],
    ...byClicks(2, ([a, b]) => ({ kind: "coupling", joints: [a.joint, b.joint] })),
  },
  spring: {
    label: "Spring",
    key: "i",
    group: "Forces",
    hints: ["Click one end of the spring", "Click the other end"],
    ...byClicks(2, (found) => ({ kind: "spring", points: found.map((each) => target(each, { own: true })) })),
  },
  damper: {
    label: "Damper",
    key: "u",
    hints: ["Click one end of the damper", "Click the other end"],
    ...byClicks(2, (found) => ({ kind: "damper", points: found.map((each) => target(each, { own: true })) })),
  },
  load: {
    label: "Load",
    key: "a",
    hints: ["Click the point on which the force acts"],
    only: ["point"],
    ...byClicks(1, ([found]) => ({ kind: "load", marker: ownMarker(found.point) })),
  },
  mass: {
    label: "Mass",
    key: "m",
    hints: ["Click the body that has the mass"],
    only: ["body"],
    ...byClicks(1, ([found]) => ({ kind: "mass", body: found.body })),
  },
  friction: {
    label: "Friction",
    key: "n",
    hints: ["Click the pin or slider that has friction"],
    only: ["joint"],
    ...byClicks(1, ([found]) => ({ kind: "friction", joint: found.joint })),
  },
  stop: {
    label: "Stops",
    key: "e",
    hints: ["Click the pin or slider that goes no further"],
    only: ["joint"],
    ...byClicks(1, ([found]) => ({ kind: "stop", joint: found.joint })),
  },
  driver: {
    label: "Driver",
    key: "d",
    group: "Motion",
    hints: ["Click the pin or slider that is driven"],
    only: ["joint"],
    ...byClicks(1, ([found]) => ({ kind: "driver", joint: found.joint })),
  },
  freedom: {
    label: "Free",
    key: "f",
    hints: ["Click the pin or slider that moves by forces"],
    only: ["joint"],
    ...byClicks(1, ([found]) => ({ kind: "freedom", joint: found.joint })),
  },
  trace: {
    label: "Trace",
    key: "t",
    hints: ["Click the point whose path is shown"],
    only: ["point"],
    ...byClicks(1, ([found]) => ({ kind: "trace", marker: ownMarker(found.point) })),
  },
};

/**
 * Returns what the next click of a tool must be at; nothing if it may be anywhere.
 * @param {Tool} tool
 */
export function wantedAt({ only }, index) {
  return only?.[Math.min(index, only.length - 1)];
}

/** Returns why a tool cannot use what was found at its next click, or nothing. */
export function unfit(tool, index, found) {
  const wanted = wantedAt(tool, index);
  if (["point", "pin"].includes(wanted) && !found.point) {
    return NEEDS_POINT;
  }
  if (["part", "owner"].includes(wanted) && !found.point && !found.body && !found.ground) {
    return "A shape is part of a body: click one of its points or its bar";
  }
  if (wanted === "body" && !found.body) {
    return "Choose a body: click on its bar";
  }
  if (wanted === "joint" && !found.point?.joints.length) {
    return "Choose a pin or a slider: there is no joint here";
  }
  return null;
}
