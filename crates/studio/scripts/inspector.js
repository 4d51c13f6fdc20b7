// @ts-check
// The numbers of what is selected, and what can be done with it.

import { add, say, shown } from "./controls.js";
import { TOOLS, icon } from "./tools.js";
import { inPlaceOf, lengthOf } from "./units.js";

export class Inspector {
  constructor(studio, place) {
    this.studio = studio;
    this.place = place;
    // Names of the parts that the reader has opened.
    this.opened = new Set();
  }

  show() {
    const answer = this.studio.ask({ do: "inspect", names: this.studio.selected() });
    const told = JSON.stringify(answer);
    // A field that is being typed in stays as it is.
    if (told === this.told && this.place.contains(document.activeElement)) {
      return;
    }
    this.told = told;
    // While the text has an error, the last form stays where it is.
    this.place.classList.toggle("kept", !answer?.title);
    if (!answer?.title) {
      return;
    }
    this.place.replaceChildren();
    this.place.scrollTop = 0;
    const title = add(this.place, "h2");
    say(title, answer.title);
    this.related(add(this.place, "p", { className: "related" }));
    const actions = add(this.place, "p", { className: "actions" });
    for (const { label, gesture, why } of answer.actions) {
      const button = add(actions, "button", { type: "button", disabled: Boolean(why), title: why ?? "" });
      if (TOOLS[gesture?.kind]) {
        button.append(icon(gesture.kind));
      }
      button.append(label);
      // The second click of two is meant for what stood here before.
      button.addEventListener("click", (event) => event.detail < 2 && this.studio.act(gesture));
    }
    const rows = add(this.place, "div", { className: "rows" });
    const groups = new Map([[undefined, rows]]);
    for (const row of answer.rows) {
      const { group } = row;
      if (!groups.has(group)) {
        groups.set(group, this.fold(rows, group));
      }
      this.row(groups.get(group), row);
    }
  }

  /** Adds a part that is folded away, unless the reader has opened it. */
  fold(place, name) {
    const part = add(place, "details", { open: this.opened.has(name) });
    add(part, "summary", { textContent: name });
    part.addEventListener("toggle", () => this.opened[part.open ? "add" : "delete"](name));
    return part;
  }

  /** Offers to select what belongs to the selection: joints and drivers of a point, all things of none. */
  related(place) {
    const { selection, view } = this.studio;
    const { joints, drivers, forces, stops, friction, contacts, measures, parameters } = view.sketch ?? {};
    const names = (list, fits = (_) => true) => (list ?? []).filter(fits).map(({ name }) => name);
    const groups = selection
      ? [names(joints, (joint) => selection.joints?.includes(joint.name)), names(drivers, (driver) => driver.markers.some((marker) => selection.markers?.includes(marker)))]
      : [drivers, measures, forces, stops, friction, contacts, parameters].map((list) => names(list));
    for (const name of new Set(groups.flat())) {
      const button = add(place, "button", { type: "button", textContent: name });
      button.addEventListener("click", () => this.studio.select({ kind: "thing", name }));
    }
  }

  row(place, { label, path, element, value, shown: told, number, unit, type, choices, help, markers }) {
    const row = add(place, "label", { className: "field", title: help ?? "" });
    const own = { m: this.studio.unit, rad: this.studio.turn }[unit];
    const inUnit = own && typeof number === "number" ? shown(number / own.factor) : null;
    say(add(row, "span"), unit && type !== "read" ? `${label} [${own?.name ?? unit}]` : label);
    if (type === "read") {
      add(row, "output", { textContent: inUnit === null ? value : `${inUnit} ${own.name}` });
      return;
    }
    const put = (next) => {
      if (next !== value) {
        this.studio.gesture({ kind: "put", path, element, value: next });
      }
    };
    if (type === "choice" || type === "flag") {
      const list = add(row, "select");
      for (const choice of type === "flag" ? ["true", "false"] : choices) {
        list.add(new Option(choice.replaceAll('"', ""), choice));
      }
      list.value = value ?? "";
      list.addEventListener("change", () => put(list.value));
      return;
    }
    const isLength = type === "length";
    const isNumber = isLength || (inUnit !== null && /^"?[-+]?[\d._]+(e[-+]?\d+)?(\s*\*\s*[a-z]+)?"?$/i.test(value));
    const brief = isNumber ? String(inUnit) : short(plain(value ?? ""));
    const field = add(row, "input", { type: "text", value: brief, title: plain(value ?? ""), autocomplete: "off", spellcheck: false });
    const beside = inUnit === null ? told : isNumber ? "" : `${inUnit} ${own.name}`;
    add(row, "small", { textContent: beside && beside !== value ? beside : "" });
    let taken = brief;
    const take = () => {
      const text = field.value.trim();
      // Enter, and a field that goes while it has the caret, tell a change twice.
      if (text === taken) {
        return;
      }
      taken = text;
      if (isLength) {
        const long = lengthOf(text, own);
        return long > 0 ? this.studio.design.change({ kind: "length", markers, value: long }) : this.studio.say("A length is above zero");
      }
      const isText = type === "text" && text !== "";
      const length = text.match(/^([-+]?[0-9.]+)\s*(mm|cm|m|inch|deg|rad)$/);
      if (own && text !== "" && Number.isFinite(Number(text))) {
        put(inPlaceOf(value ?? "", Number(text) * own.factor, own));
        return;
      }
      put(length ? `"${length[1]}*${length[2]}"` : isText ? JSON.stringify(text) : text === brief ? value : text);
    };
    field.addEventListener("change", take);
    field.addEventListener("keydown", (event) => {
      if (event.key === "Enter") {
        event.preventDefault();
        take();
      }
    });
  }
}

/** Returns a text with numbers of few digits: a field that nobody changes keeps all of them. */
function short(text) {
  return text.replace(/\d+\.\d{8,}/g, (number) => String(shown(Number(number))));
}

/** Returns a TOML value without the quotes of a string. */
function plain(value) {
  return /^"[^"\\]*"$/.test(value) ? value.slice(1, -1) : value;
}
