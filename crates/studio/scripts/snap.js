// The thing at the pointer: a point, a bar, or a place of the sheet that the grid and directions draw to
// themselves.

// Distance within which the pointer finds a point, with a mouse and with a finger [pixels].
const NEAR_POINT = { mouse: 12, pen: 14, touch: 24 };
// Distance within which it finds a bar, as a part of that.
const NEAR_BAR = 0.8;
// Distance within which a direction or the level of another point draws [pixels].
const LEVEL = 6;
// Distance below which two points are one [pixels].
const SAME = 0.1;
// Angle of the directions that draw [rad].
const DIRECTIONS = Math.PI / 12;

const distance = ([x, y], [u, v]) => Math.hypot(u - x, v - y);

/**
 * Returns what is at a place of the sheet [pixels]: `at` [m], and `point` (of the sketch), `body`
 * (its name), with `things` a `thing` such as a spring, or none of them. `origin`, a point [m], draws to horizontal and vertical and every 15°;
 * `free` leaves grid and directions out, `bars: false` bars; `without` are names of markers that are passed over.
 */
export function findAt(sheet, sketch, place, { kind = "mouse", origin = null, free = false, without = [], things = false, bars: finds = true } = {}) {
  const near = NEAR_POINT[kind] ?? NEAR_POINT.mouse;
  const others = sketch.points.filter((point) => !point.markers.some((marker) => without.includes(marker)));
  const nearest = (items, far) =>
    items.reduce((best, item) => (item.far <= far && (!best || item.far < best.far) ? item : best), null);

  const point = nearest(others.map((each) => ({ each, far: distance(sheet.toScreen(each.at), place) })), near);
  if (point) {
    return { at: point.each.at, point: point.each, guides: [] };
  }
  const bars = sketch.bodies.flatMap((body) =>
    !finds || body.markers.some((marker) => without.includes(marker)) ? [] : body.bars.map(([from, to]) => ({ body, from, to })),
  );
  const rods = things ? rodsOf(sketch) : [];
  const bar = nearest(
    [...bars, ...rods].map(({ body, name, from, to }) => {
      const foot = footOn(sheet.toScreen(from), sheet.toScreen(to), place);
      return { body, name, at: alongFrom(from, to, sheet.rounded(distance(sheet.toPoint(foot), from))), far: distance(foot, place) };
    }),
    NEAR_BAR * near,
  );
  if (bar) {
    const found = bar.body ? { body: bar.body.name } : { thing: { kind: "thing", name: bar.name } };
    return { at: bar.at, ...found, guides: [] };
  }
  if (free) {
    return { at: sheet.toPoint(place).map((x) => sheet.rounded(x)), guides: [] };
  }
  const there = drawn(sheet, others, place, origin);
  // The grid may lead to a point that is further away than the pointer finds one.
  const reached = pointAt(sheet, others, there.at);
  return reached ? { ...there, at: reached.at, point: reached } : there;
}

/** Returns the point of the sketch at a point [m]. */
export function pointAt(sheet, points, at) {
  return points.find((point) => distance(sheet.toScreen(point.at), sheet.toScreen(at)) < SAME);
}

/** Returns the springs, dampers and cylinders, each with its ends [m]. */
export function rodsOf({ forces = [], drivers = [] }) {
  const rods = [...forces, ...drivers].filter(({ coordinate }) => coordinate === "distance");
  return rods.map(({ name, at, to }) => ({ name, from: at, to }));
}

/** Returns the foot of a place on a line between two others. */
function footOn([x, y], [u, v], [a, b]) {
  const [dx, dy] = [u - x, v - y];
  const square = dx * dx + dy * dy;
  const part = square > 0 ? Math.max(0, Math.min(1, ((a - x) * dx + (b - y) * dy) / square)) : 0;
  return [x + part * dx, y + part * dy];
}

/** Returns the point at a length from a point on the way to another. */
function alongFrom([x, y], to, length) {
  const long = distance([x, y], to);
  const part = long > 0 ? Math.min(1, length / long) : 0;
  return [x + part * (to[0] - x), y + part * (to[1] - y)];
}

/** Returns the place to which grid, directions and the levels of other points draw. */
function drawn(sheet, points, place, origin) {
  const { step } = sheet;
  const raw = sheet.toPoint(place);
  const at = raw.map((x) => Number((Math.round(x / step) * step).toPrecision(12)));
  const guides = [];
  for (const k of [0, 1]) {
    const level = points.reduce((best, point) => {
      const far = Math.abs(sheet.toScreen(point.at)[k] - place[k]);
      return far <= LEVEL && (!best || far < best.far) ? { point, far } : best;
    }, null);
    if (level) {
      at[k] = level.point.at[k];
      guides.push(level.point.at);
    }
  }
  if (origin && guides.length === 0) {
    const [dx, dy] = [raw[0] - origin[0], raw[1] - origin[1]];
    const long = Math.hypot(dx, dy);
    const turn = Math.round(Math.atan2(dy, dx) / DIRECTIONS) * DIRECTIONS;
    const aside = Math.abs(long * Math.sin(Math.atan2(dy, dx) - turn)) * sheet.scale;
    if (aside <= Math.min(LEVEL, distance(sheet.toScreen(at), place))) {
      const rounded = Math.max(step, Math.round(long / step) * step);
      return {
        at: [origin[0] + rounded * Math.cos(turn), origin[1] + rounded * Math.sin(turn)],
        guides: [origin],
      };
    }
  }
  return { at, guides };
}
