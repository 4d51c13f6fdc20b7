// @ts-check
// Design: the pointer and the keys draw, select and move; the solver answers with text and picture.

import { add, shown } from "./controls.js";
import { askLength, askParameter, isMac } from "./dialogs.js";
import { findAt, pointAt, rodsOf } from "./snap.js";
import { TOOLS, ownMarker, unfit, wantedAt } from "./tools.js";
import { angleOf, lengthOf } from "./units.js";

// Way of the pointer from which a press is a drag [pixels].
const DRAG = 4;
// Time for which a finger rests to open the menu [ms].
const LONG_PRESS = 550;

// Clicks above which Enter ends a tool.
const MANY = 10;
// Followers of a cam, in words and in the file.
const FOLLOWERS = [
  ["A follower with a point", "knife"],
  ["A follower with a roller", "roller"],
  ["A follower with a flat face", "flat"],
];

// Tools that take hold of the face of a wheel.
const FACED = ["link", "plate", "cylinder", "spring", "damper", "bar", "disc", "outline", "hole"];

export class Design {
  /** `studio` asks the solver and shows its views; `sheet` is drawn on. */
  constructor(studio, sheet) {
    this.studio = studio;
    this.sheet = sheet;
    this.tool = "select";
    // Findings at the clicks so far.
    this.found = [];
    this.pointers = new Map();
    this.answers = new Map();
    // Place of the keys on the sheet [m], null while the pointer draws.
    this.caret = null;
    sheet.onLook = () => {
      studio.background.look();
      this.mark();
    };
    this.typed = this.makeTyped();
    this.connect();
  }

  get sketch() {
    return this.studio.view.sketch ?? { points: [], bodies: [], joints: [], drivers: [] };
  }

  /** Takes a tool by its name. */
  take(name) {
    const { caret } = this;
    this.drop();
    this.caret = caret;
    this.tool = name;
    this.studio.showTool(name);
    this.hint();
  }

  /** Gives up what was begun. */
  drop() {
    this.found = [];
    this.over = null;
    this.caret = null;
    this.typed.hidden = true;
    this.forget();
    this.drag = null;
    this.box = null;
    this.mark();
  }

  hint() {
    const { hints } = TOOLS[this.tool];
    const hint = hints[Math.min(this.found.length, hints.length - 1)];
    // A finger has no Ctrl.
    this.studio.hint(matchMedia("(hover: none)").matches ? hint.replace(", with Ctrl it is a pivot on ground", "") : hint);
  }

  // -- the pointer ---------------------------------------------------------------------------

  connect() {
    const { place } = this.sheet;
    place.addEventListener("pointerdown", (event) => this.down(event));
    place.addEventListener("pointermove", (event) => this.moved(event));
    place.addEventListener("pointerup", (event) => this.up(event));
    place.addEventListener("pointercancel", (event) => this.cancel(event));
    place.addEventListener("pointerleave", () => {
      if (!this.drag) {
        this.over = null;
        this.forget();
        this.mark();
      }
    });
    place.addEventListener("contextmenu", (event) => {
      event.preventDefault();
      // On a Mac Ctrl and a click ask for the menu; a tool takes them for a click on ground.
      if (!(isMac && event.ctrlKey && this.tool !== "select")) {
        this.menu(event);
      }
    });
    place.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        this.sheet.zoom(Math.exp(-0.0015 * lines * event.deltaY), this.sheet.placeOf(event));
      },
      { passive: false },
    );
  }

  /**
   * Finds what is at the pointer.
   * @returns {any}
   */
  look(event) {
    // Over a picture its lines lead the hand, not the grid.
    const chosen = TOOLS[this.tool];
    const isRim = wantedAt(chosen, this.found.length) === "rim";
    this.isFree = isRim || event.shiftKey || event.altKey || Boolean(this.studio.background.image);
    const last = this.found[this.found.length - 1];
    const origin = chosen.typed && last ? last.at : null;
    const found = findAt(this.sheet, this.sketch, this.sheet.placeOf(event), {
      kind: event.pointerType,
      origin: this.drag?.origin ?? origin,
      free: this.isFree,
      bars: !isRim,
      without: this.drag?.without ?? [],
      things: this.tool === "select" && !this.drag,
    });
    if (this.tool === "scale" || this.tool === "contact") {
      const there = { at: this.sheet.toPoint(this.sheet.placeOf(event)), guides: [] };
      return this.tool === "scale" ? there : { ...there, ...this.insideOf(event) };
    }
    if (FACED.includes(this.tool) && !found.point && !found.body && !this.isGround(event)) {
      const { body } = this.insideOf(event);
      const isFace = this.sketch.bodies.some((each) => each.name === body && each.is_wheel);
      return isFace ? { ...found, body } : found;
    }
    const inside = ["select", "mass"].includes(this.tool) && !this.drag && !found.point && !found.body && !found.thing;
    return inside ? { ...found, ...this.insideOf(event) } : found;
  }

  /** Returns the body in whose area a pointer is, or the thing whose name it is at. */
  insideOf(event) {
    const { clientX, clientY } = event;
    const named = this.sheet.nameAt(clientX, clientY);
    const thing = named && this.studio.thingNamed(named);
    if (thing) {
      return { thing };
    }
    const [index] = this.sheet.bodiesAt(clientX, clientY);
    return index === undefined ? {} : { body: this.sketch.bodies[index]?.name };
  }

  down(event) {
    this.sheet.place.focus({ preventScroll: true });
    this.sheet.place.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.sheet.placeOf(event));
    this.studio.closeMenu();
    if (this.pointers.size === 2) {
      this.drop();
      this.press = null;
      return;
    }
    if (event.button === 2) {
      return;
    }
    const at = this.sheet.placeOf(event);
    const found = this.look(event);
    this.press = { at, found, pans: event.button === 1 || this.holds === " " };
    if (event.pointerType === "touch") {
      this.waiting = setTimeout(() => this.press && !this.press.moves && this.menu(event), LONG_PRESS);
    }
  }

  moved(event) {
    this.caret = null;
    const now = this.sheet.placeOf(event);
    const before = this.pointers.get(event.pointerId);
    if (before && this.pointers.size === 2) {
      this.pinch(event.pointerId, before, now);
      return;
    }
    if (before) {
      this.pointers.set(event.pointerId, now);
    }
    const { press } = this;
    if (press && !press.moves && Math.hypot(now[0] - press.at[0], now[1] - press.at[1]) > DRAG) {
      press.moves = true;
      clearTimeout(this.waiting);
      if (this.tool === "select" && !press.pans) {
        this.begin(press.found, event);
      }
    }
    if (this.box) {
      this.box[1] = now;
      this.mark();
      return;
    }
    if (press?.moves && (press.pans || (this.tool === "select" && !this.drag))) {
      this.sheet.pan([now[0] - before[0], now[1] - before[1]]);
      return;
    }
    this.over = this.look(event);
    if (this.drag) {
      this.drag.to = this.over;
    } else {
      this.over.ground = this.isGround(event);
      this.mark();
    }
    this.foresee();
  }

  /** Whether a click is on ground. */
  isGround(event) {
    return event.ctrlKey || event.metaKey || this.holds === "g";
  }

  /** Shows the next gesture, once per picture, for the last place of the pointer. */
  foresee() {
    if (this.foreseeing) {
      return;
    }
    this.foreseeing = true;
    requestAnimationFrame(() => {
      this.foreseeing = false;
      const gesture = this.nextGesture();
      if (gesture && !this.studio.preview(gesture).refused) {
        this.foreseen = true;
      } else if (!this.drag) {
        this.forget();
      }
      this.mark();
    });
  }

  /** Returns what a release, or the last click of a tool, would do where the pointer is; null for nothing. */
  nextGesture() {
    if (this.drag) {
      return { ...this.gestureTo(this.drag.to), through: "parameter" };
    }
    const { found, over } = this;
    const tool = TOOLS[this.tool];
    const isLast = over && found.length > 0 && found.length === tool.most - 1;
    return isLast && tool.gesture && !unfit(tool, found.length, over) ? tool.gesture([...found, over]) : null;
  }

  /** Shows the document again as it is. */
  forget() {
    if (this.foreseen) {
      this.foreseen = false;
      this.studio.showAgain();
    }
  }

  up(event) {
    clearTimeout(this.waiting);
    this.pointers.delete(event.pointerId);
    const { press } = this;
    this.press = null;
    if (!press || event.button === 2) {
      return;
    }
    if (this.box) {
      this.chooseBox();
    } else if (this.drag) {
      this.end();
    } else if (!press.moves || this.tool !== "select") {
      if (press.pans) {
        return;
      }
      const found = press.moves ? this.look(event) : press.found;
      // A press that moves draws from its first place to its last.
      if (press.moves && this.found.length === 0 && TOOLS[this.tool].most > 1) {
        this.click(press.found, event);
      }
      this.click(found, event);
    }
  }

  cancel(event) {
    clearTimeout(this.waiting);
    this.pointers.delete(event.pointerId);
    this.press = null;
    this.drop();
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const far = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
    const middle = [0, 1].map((k) => 0.5 * (now[k] + other[k]));
    this.sheet.pan([0.5 * (now[0] - before[0]), 0.5 * (now[1] - before[1])]);
    this.sheet.zoom(far(now) / Math.max(1, far(before)), middle);
    this.pointers.set(id, now);
  }

  // -- clicks --------------------------------------------------------------------------------

  async click(found, event = {}) {
    const tool = TOOLS[this.tool];
    if (this.tool === "select") {
      this.studio.select(this.thing(found));
      return;
    }
    const first = this.found[0];
    const closes = tool.least > 2 && this.found.length >= tool.least && found.point === first.point && isSame(found.at, first.at);
    if (closes) {
      this.finish();
      return;
    }
    found.ground = this.isGround(event);
    const why = unfit(tool, this.found.length, found);
    if (why) {
      this.studio.say(why);
      return;
    }
    const wanted = wantedAt(tool, this.found.length);
    if (wanted === "joint") {
      found.joint = await this.chooseJoint(found.point.joints, event);
      if (!found.joint) {
        return;
      }
    }
    const pins = this.sketch.joints.filter((joint) => joint.is_pin && found.point?.joints.includes(joint.name));
    if (wanted === "pin" && pins.length) {
      found.joint = await this.chooseJoint(pins.map((pin) => pin.name), event);
    }
    if (wanted === "owner") {
      found.owner = found.body ?? (found.point ? await this.chooseOwner(found.point, event) : "ground");
    }
    if (this.tool === "cam" && first && ![first, found].some(({ point }) => point && !point.ground)) {
      found.follower = await this.studio.choose(FOLLOWERS, event);
    }
    if (this.tool === "wheels" && this.found.length < 2 && found.point) {
      found.fixed = await this.chooseWheel(found.point, event);
    }
    const last = this.found[this.found.length - 1];
    if (last && isSame(last.at, found.at) && !["joint", "part"].includes(wanted)) {
      if (tool.most > MANY && this.found.length >= tool.least) {
        this.finish();
        return;
      }
      this.studio.say("This is the point that was clicked before: click another one");
      return;
    }
    this.found.push(found);
    if (this.found.length >= tool.most) {
      this.finish();
      return;
    }
    this.hint();
    this.mark();
    this.offerTyped();
  }

  /** Ends a tool whose clicks are many. */
  finish() {
    const tool = TOOLS[this.tool];
    if (this.found.length < tool.least) {
      this.studio.say(tool.hints[Math.min(this.found.length, tool.hints.length - 1)]);
      return;
    }
    if (this.tool === "scale") {
      const [from, to] = this.found.map((each) => each.at);
      this.take("select");
      this.studio.background.scaleBy(from, to);
      return;
    }
    const gesture = tool.gesture(this.found);
    const { caret } = this;
    this.drop();
    this.caret = caret;
    this.studio.gesture(gesture);
    this.hint();
  }

  /** Asks whether a wheel is part of a body at its centre; returns the marker of that, "" for none. */
  async chooseWheel(point, event) {
    const bodyOf = (marker) => this.sketch.bodies.find((body) => body.markers.includes(marker));
    const markers = point.markers.filter(bodyOf);
    if (markers.length === 0 || markers.some((marker) => bodyOf(marker).is_wheel)) {
      return "";
    }
    const fixed = markers.map((marker) => [`A wheel fixed to ${bodyOf(marker).name}`, marker]);
    return this.studio.choose([["A wheel that turns here", ""], ...fixed], event);
  }

  /** Asks of which body at a point a shape is part. */
  async chooseOwner(point, event) {
    const owners = [...new Set(point.markers.map((marker) => marker.split(".")[0]))];
    return owners.length === 1 ? owners[0] : this.studio.choose(owners.map((owner) => [`Part of ${owner}`, owner]), event);
  }

  /** Asks which of several joints at a point is meant. */
  async chooseJoint(names, event) {
    const joints = names.map((name) => this.sketch.joints.find((joint) => joint.name === name));
    const moving = joints.filter((joint) => joint?.drives);
    if (moving.length === 0) {
      this.studio.say(`Joint \`${names[0]}\` has no coordinate of its own: choose a pin or a slide`);
      return null;
    }
    if (moving.length === 1) {
      return moving[0].name;
    }
    const items = moving.map((joint) => [
      `${joint.is_pin ? "Pin" : "Slide"} ${joint.name}: ${joint.markers.join(" – ")}`,
      joint.name,
    ]);
    return this.studio.choose(items, event);
  }

  // -- selection -----------------------------------------------------------------------------

  /** Returns the thing at a place, by its names; clicks on one point go through what is there. */
  thing(found) {
    if (found.point) {
      return { kind: "point", markers: found.point.markers, joints: found.point.joints };
    }
    if (found.body) {
      return { kind: "body", name: found.body };
    }
    return found.thing ?? null;
  }

  /** Selects the points in the box. */
  chooseBox() {
    const [from, to] = this.box;
    this.box = null;
    const isIn = (place) => [0, 1].every((k) => Math.min(from[k], to[k]) <= place[k] && place[k] <= Math.max(from[k], to[k]));
    const points = this.sketch.points.filter(({ at }) => isIn(this.sheet.toScreen(at)));
    const [markers, joints] = ["markers", "joints"].map((list) => points.flatMap((point) => point[list]));
    this.studio.select(points.length > 1 ? { kind: "points", markers, joints } : points.length ? this.thing({ point: points[0] }) : null);
  }

  // -- dragging ------------------------------------------------------------------------------

  begin(found, { shiftKey }) {
    const { selection } = this.studio;
    const isChosen = selection?.kind === "points" && [found.body, ...(found.point?.markers ?? [])].some((name) => this.studio.selected().includes(name) || selection.markers.includes(name));
    if (isChosen) {
      const { markers } = selection;
      this.drag = { markers, from: found.at, without: markers, body: found.body };
    } else if (shiftKey && !found.point && !found.body && !found.thing) {
      this.box = [this.press.at, this.press.at];
    } else if (found.point) {
      const { markers } = found.point;
      this.drag = { markers: [ownMarker(found.point)], from: found.at, without: markers, point: found.point };
    } else if (found.body) {
      const body = this.sketch.bodies.find((each) => each.name === found.body);
      this.drag = { markers: body.markers, from: found.at, without: body.markers, body: found.body };
    }
  }

  /** @returns {import("../../page/scripts/messages").Gesture & { kind: "join" | "shift" }} */
  gestureTo(found) {
    const { drag } = this;
    const onto = drag.point && found.point ? found.point.markers[0] : null;
    const way = [0, 1].map((k) => found.at[k] - drag.from[k]);
    // A body is gripped anywhere; its points stay as round as they are.
    const { step } = this.sheet;
    const fine = drag.body && !this.isFree ? (x) => Number((Math.round(x / step) * step).toPrecision(12)) : (x) => x;
    /** @type {[number, number]} */
    const by = [fine(way[0]), fine(way[1])];
    return onto ? { kind: "join", marker: drag.markers[0], onto } : { kind: "shift", markers: drag.markers, by };
  }

  async end() {
    const { drag } = this;
    if (!drag.to) {
      this.drag = null;
      return;
    }
    const gesture = this.gestureTo(drag.to);
    this.drag = null;
    // The outcome takes the place of what was foreseen.
    this.foreseen = false;
    await this.change(gesture);
    this.mark();
  }

  /**
   * Does a gesture that changes a length; asks whether a parameter changes with it.
   * @param {import("../../page/scripts/messages").Gesture & { kind: "join" | "shift" | "length" }} gesture
   */
  async change(gesture) {
    let answer = this.studio.gesture(gesture, false);
    while (answer.refused?.parameter) {
      const { parameter, formula, value } = answer.refused;
      const known = this.answers.get(parameter);
      const through = known && (known !== "parameter" || value !== null) ? known : await askParameter(this.studio.root, { parameter, formula, value, unit: this.studio.unit });
      if (!through) {
        break;
      }
      this.answers.set(parameter, through);
      answer = this.studio.gesture({ ...gesture, through }, false);
    }
    if (answer.refused) {
      this.studio.showAgain();
      if (answer.refused.message) {
        this.studio.say(answer.refused.message);
      }
    }
  }

  // -- typed lengths -------------------------------------------------------------------------

  makeTyped() {
    const form = add(this.sheet.place, "form", { className: "typed", hidden: true });
    const field = (name) => {
      const label = add(form, "label", { textContent: `${name} ` });
      return add(label, "input", { type: "text", inputMode: "decimal", size: 8, autocomplete: "off" });
    };
    this.long = field("Length");
    this.turn = field("Angle");
    add(form, "button", { type: "submit", textContent: "Set" });
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.takeTyped();
    });
    for (const kind of ["pointerdown", "pointermove", "pointerup"]) {
      form.addEventListener(kind, (event) => event.stopPropagation());
    }
    return form;
  }

  offerTyped() {
    const tool = TOOLS[this.tool];
    this.typed.hidden = !(tool.typed && this.found.length);
    this.long.value = "";
    this.turn.value = "";
  }

  takeTyped() {
    const { unit, turn } = this.studio;
    const from = this.found[this.found.length - 1].at;
    const to = this.over?.at ?? [from[0] + 1, from[1]];
    const ahead = [to[0] - from[0], to[1] - from[1]];
    const length = this.long.value.trim() === "" ? Math.hypot(...ahead) : lengthOf(this.long.value, unit);
    const angle = this.turn.value.trim() === "" ? Math.atan2(ahead[1], ahead[0]) : angleOf(this.turn.value, turn);
    if (!(length > 0) || !Number.isFinite(angle)) {
      this.studio.say(`Type a length such as \`120\` or \`12 cm\`, and an angle such as \`30\``);
      return;
    }
    this.sheet.place.focus({ preventScroll: true });
    const at = [from[0] + length * Math.cos(angle), from[1] + length * Math.sin(angle)];
    this.click({ at, point: pointAt(this.sheet, this.sketch.points, at), guides: [] });
  }

  // -- marks ---------------------------------------------------------------------------------

  mark() {
    const { sheet } = this;
    sheet.clear();
    this.studio.root.classList.toggle("begun", this.found.length > 0);
    if (!this.studio.isDesign) {
      return;
    }
    if (!this.drag) {
      const traced = this.sketch.traced ?? [];
      // Points of interest have their names in the picture.
      for (const { at, markers } of this.sketch.points.filter((point) => !point.markers.some((m) => traced.includes(m)))) {
        sheet.words(at, ownMarker({ markers }).split(".")[1], "letter", [-16, -9]);
      }
    }
    this.markSelection();
    if (this.box) {
      const [[x, y], [u, v]] = this.box;
      sheet.mark("path", { d: `M${fix(x)} ${fix(y)}H${fix(u)}V${fix(v)}H${fix(x)}Z`, class: "box" });
    }
    const tool = TOOLS[this.tool];
    const { over } = this;
    if (over && !this.drag && (this.tool !== "select" || over.point || over.body)) {
      this.markFound(over);
    }
    if (this.caret) {
      const [x, y] = sheet.toScreen(this.caret);
      sheet.mark("path", { d: `M${fix(x - 9)} ${fix(y)}h18M${fix(x)} ${fix(y - 9)}v18`, class: "caret" });
    }
    if (this.drag?.to) {
      this.markFound(this.drag.to);
    }
    const points = this.found.map((each) => each.at);
    if (points.length) {
      const ahead = over && points.length < tool.most ? [...points, over.at] : points;
      ahead.slice(1).forEach((at, index) => sheet.line(ahead[index], at, "draft"));
      points.forEach((at) => sheet.ring(at, "draft", 5));
      if (over && ahead.length > points.length) {
        const [from, to] = [points[points.length - 1], over.at];
        const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        const { name, factor } = this.studio.unit;
        const long = Number((Math.hypot(dx, dy) / factor).toPrecision(4));
        const { turn } = this.studio;
        const angle = shown(Math.atan2(dy, dx) / turn.factor, 4);
        sheet.words(to, `${long} ${name}  ${angle}${turn.name === "deg" ? "°" : " rad"}`);
      }
    }
  }

  /** @param {any} found */
  markFound({ at, point, body, guides }) {
    const { sheet } = this;
    for (const from of guides) {
      sheet.line(from, at, "guide");
    }
    if (point) {
      sheet.ring(at, "found", 11);
    } else if (body) {
      sheet.ring(at, "found", 6);
      const bars = this.sketch.bodies.find((each) => each.name === body)?.bars ?? [];
      bars.forEach(([from, to]) => sheet.line(from, to, "found bar"));
    } else if (this.tool !== "select") {
      sheet.ring(at, "place", 3);
    }
  }

  markSelection() {
    const { selection } = this.studio;
    const { sheet, sketch } = this;
    for (const { at, markers } of selection?.markers ? sketch.points : []) {
      if (markers.some((marker) => selection.markers.includes(marker))) {
        sheet.ring(at, "selected", 13);
      }
    }
    if (selection?.kind === "thing") {
      const rod = rodsOf(sketch).find(({ name }) => name === selection.name);
      if (rod) {
        sheet.line(rod.from, rod.to, "selected bar");
      }
    }
    if (selection?.kind === "body") {
      const body = sketch.bodies.find((each) => each.name === selection.name);
      body?.bars.forEach(([from, to]) => sheet.line(from, to, "selected bar"));
      body?.bars.forEach((bar, index) => this.markLength(body, bar, index));
    }
  }

  /** Writes the length of a bar, which a click changes or makes a parameter. */
  markLength(body, [from, to], index) {
    const { name, factor } = this.studio.unit;
    const long = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    const words = this.sheet.words(middle, `${shown(long / factor, 5)} ${name}`, "words dimension", [8, -8]);
    const markers = [body.markers[index], body.markers[(index + 1) % body.markers.length]];
    words.addEventListener("pointerdown", async (event) => {
      event.stopPropagation();
      event.preventDefault();
      const answer = await askLength(this.studio.root, { markers, long, unit: this.studio.unit });
      if (answer) {
        await this.change({ kind: "length", markers, ...answer });
      }
    });
  }

  // -- the keys' place -----------------------------------------------------------------------

  /** Moves the place of the keys, and finds what is there. */
  moveCaret(at, event) {
    this.caret = at;
    this.isFine = event.shiftKey;
    this.over = { ...this.look(this.atCaret(event)), ground: this.isGround(event) };
    this.foresee();
    this.mark();
    const { at: reached, point, body } = this.over;
    const { name, factor } = this.studio.unit;
    const there = reached.map((x) => shown(x / factor, 5)).join(", ");
    this.studio.tellPlace(`${there} ${name}${point ? `: ${point.markers.join(", ")}` : body ? `: ${body}` : ""}`);
  }

  /** Returns an event of the pointer at the place of the keys. */
  atCaret({ ctrlKey, metaKey }) {
    const box = this.sheet.place.getBoundingClientRect();
    const [u, v] = this.sheet.toScreen(this.caret);
    return { clientX: box.left + u, clientY: box.top + v, pointerType: "keys", ctrlKey, metaKey, shiftKey: this.isFine };
  }

  /** Moves from point to point, in the order of the file. */
  nextPoint(step, event) {
    const { points } = this.sketch;
    const here = points.findIndex(({ at }) => this.caret && isSame(at, this.caret));
    const next = here < 0 ? (step > 0 ? 0 : points.length - 1) : (here + step + points.length) % points.length;
    if (points.length) {
      this.moveCaret(points[next].at, event);
    }
  }

  // -- menu and keys -------------------------------------------------------------------------

  menu(event) {
    this.press = null;
    this.drop();
    const found = this.look(event);
    this.studio.select(this.thing(found));
    this.studio.openMenu(found, event);
  }

  /** Takes a key; true if it was one of design. */
  key(event) {
    const { key } = event;
    const clicks = key === "Enter" && this.caret && !event.altKey && event.target === this.sheet.place;
    if ((event.ctrlKey || event.metaKey || event.altKey) && !clicks) {
      return false;
    }
    if (key === "PageDown" || key === "PageUp") {
      this.nextPoint(key === "PageDown" ? 1 : -1, event);
      return true;
    }
    if (clicks) {
      const there = this.atCaret(event);
      this.click(this.look(there), there);
      return true;
    }
    if (key === "ContextMenu" && this.caret) {
      this.menu(this.atCaret(event));
      return true;
    }
    if (key === "Escape") {
      if (this.found.length || this.drag) {
        this.drop();
        this.hint();
      } else {
        this.take("select");
        this.studio.select(null);
        this.studio.say("");
      }
      return true;
    }
    if (key === "Enter" && this.found.length) {
      if (TOOLS[this.tool].most > MANY) {
        this.finish();
      }
      return true;
    }
    if (this.found.length && TOOLS[this.tool].typed && /^[0-9.,]$/.test(key)) {
      this.long.focus();
      this.long.value = key;
      return true;
    }
    if (key === "F2" && this.studio.selected().length && this.studio.selection.kind !== "points") {
      this.studio.act({ kind: "rename", old: this.studio.selected()[0] });
      return true;
    }
    if ((key === "Delete" || key === "Backspace") && this.studio.selection) {
      this.studio.removeSelected();
      return true;
    }
    if (key === " " || key === "g") {
      this.holds = key;
    }
    const names = Object.keys(TOOLS);
    const tool = names.find((name) => TOOLS[name].key === key) ?? names.find((name) => TOOLS[name].key === key.toLowerCase());
    // While something is drawn, G held makes the next point one of ground.
    if (tool && !(key === "g" && this.found.length)) {
      this.take(tool);
      return true;
    }
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (arrows[key]) {
      const by = arrows[key].map((part) => part * this.sheet.step * (event.shiftKey ? 0.1 : 1));
      if (this.studio.selection && this.tool === "select") {
        this.nudge(by);
      } else {
        const from = this.caret ?? this.over?.at ?? this.sheet.center;
        // On the lines of the grid, unless Shift goes in parts of them.
        const { step } = this.sheet;
        const to = [0, 1].map((k) => from[k] + by[k]).map((x) => (event.shiftKey ? x : Number((Math.round(x / step) * step).toPrecision(12))));
        this.moveCaret(to, event);
      }
      return true;
    }
    return false;
  }

  keyUp() {
    this.holds = null;
  }

  /** Moves what is selected by a way [m]. */
  nudge(by) {
    const { selection } = this.studio;
    const body = selection.kind === "body" && this.sketch.bodies.find((each) => each.name === selection.name);
    const markers = body ? body.markers : selection.kind === "points" ? selection.markers : selection.markers?.slice(0, 1);
    if (markers) {
      this.drag = { markers, from: [0, 0], to: { at: by, guides: [] } };
      this.end();
    }
  }
}

function isSame(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-12;
}
