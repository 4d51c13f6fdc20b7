// Small windows that ask and tell.

import { add, say, shown } from "./controls.js";
import { lengthOf } from "./units.js";

/** Whether the keyboard is that of a Mac, whose Cmd stands for Ctrl. */
export const isMac = /^(Mac|iP)/.test(navigator.platform);

/** Returns a text with the keys of this keyboard. */
export function byKeys(text) {
  return isMac ? text.replaceAll("Ctrl", "Cmd") : text;
}

/**
 * Opens a window with a title; `fill` fills its form, and may close it with a value. Returns that value, or
 * the one of the button, "" for none.
 */
export function openWindow(root, title, fill) {
  return new Promise((done) => {
    const dialog = add(root, "dialog", { className: "window" });
    const form = add(dialog, "form");
    add(form, "h2", { textContent: title });
    // The event `close` comes in a later task; a key before it would find the window's button, and be lost.
    const close = (value) => {
      dialog.close();
      dialog.remove();
      done(value);
    };
    fill(form, close);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      close(/** @type {any} */ (event.submitter)?.value ?? "");
    });
    for (const kind of ["cancel", "close"]) {
      dialog.addEventListener(kind, () => close(""));
    }
    dialog.addEventListener("click", (event) => event.target === dialog && close(""));
    dialog.showModal();
  });
}

/** Adds a row of buttons: pairs of text and value; the first one is the usual one. */
export function buttonRow(form, ...pairs) {
  const row = add(form, "p", { className: "buttons" });
  pairs.forEach(([textContent, value], index) => {
    const className = index === 0 && (value || pairs.length > 1) ? "primary" : "";
    // Giving up needs no valid field.
    add(row, "button", { type: "submit", value, textContent, className, formNoValidate: value === "" });
  });
  return row;
}

/** Asks whether a parameter is to change, or the number in its place; undefined for neither. */
export async function askParameter(root, { parameter, formula, value, unit }) {
  const answer = await openWindow(root, "Change the parameter?", (form) => {
    const text = add(form, "p");
    const fits = value !== null;
    const to = fits ? ` to ${shown(value / unit.factor, 5)} ${unit.name}` : "";
    say(
      text,
      formula === parameter
        ? `This length is the parameter \`${parameter}\`, which others may use, too.`
        : `The file has \`${formula}\` here.`,
    );
    const choices = [
      [`Change ${parameter}${to}`, "parameter"],
      ["Put a number in its place", "number"],
      ["Leave it", ""],
    ];
    buttonRow(form, ...(fits ? choices : choices.slice(1)));
  });
  return answer || undefined;
}

/** Asks for the length between two markers, and for a name if it is to be a parameter. */
export async function askLength(root, { markers, long, unit }) {
  const before = String(shown(long / unit.factor, 7));
  let length;
  let name;
  const answer = await openWindow(root, "Length", (form) => {
    say(add(form, "p"), `From \`${markers[0]}\` to \`${markers[1]}\``);
    const field = (text, value) => {
      const label = add(form, "label", { textContent: text });
      return add(label, "input", { type: "text", value, autocomplete: "off", spellcheck: false });
    };
    length = field(`Length [${unit.name}] `, before);
    name = field("Name, to make it a parameter ", "");
    name.pattern = "[A-Za-z][A-Za-z0-9_]*";
    name.placeholder = "crank_length";
    buttonRow(form, ["Set", "set"], ["Cancel", ""]);
    setTimeout(() => length.select());
  });
  const value = length.value === before ? long : lengthOf(length.value, unit);
  if (answer !== "set" || !(value > 0)) {
    return undefined;
  }
  return name.value ? { value, name: name.value } : { value };
}

/** Asks for a name; "" for none. */
export async function askName(root, title, name) {
  let field;
  const answer = await openWindow(root, title, (form) => {
    const label = add(form, "label", { textContent: "Name " });
    field = add(label, "input", { type: "text", value: name, pattern: "[A-Za-z][A-Za-z0-9_]*", required: true, autocomplete: "off", spellcheck: false });
    add(form, "p", { className: "note", textContent: "A letter, then letters, digits and _." });
    buttonRow(form, ["Set", "set"], ["Cancel", ""]);
    setTimeout(() => field.select());
  });
  return answer === "set" ? field.value : "";
}

/**
 * Opens a list of actions at a place of the screen: pairs of text and act, or of text and reason where
 * it cannot be done. Returns the value chosen, or undefined.
 */
export class Menu {
  constructor(root) {
    this.place = add(root, "div", { className: "menu", hidden: true });
    this.place.setAttribute("role", "menu");
    document.addEventListener("pointerdown", (event) => !this.place.contains(event.target) && this.close(), true);
    this.place.addEventListener("keydown", (event) => this.key(event));
  }

  /** `items` have a `label`, maybe a `key`, and `act` or the reason `why` it cannot be done; a string is a heading. */
  open(items, [x, y]) {
    this.back = document.activeElement;
    this.place.replaceChildren();
    for (const item of items) {
      if (typeof item === "string") {
        add(this.place, "p", { textContent: item });
        continue;
      }
      const button = add(this.place, "button", { type: "button", disabled: !item.act || Boolean(item.why) });
      button.setAttribute("role", "menuitem");
      say(button, item.label);
      if (item.key) {
        add(button, "kbd", { textContent: byKeys(item.key) });
      }
      if (item.why) {
        say(add(button, "small"), item.why);
      }
      button.addEventListener("click", () => {
        this.close();
        item.act();
      });
    }
    this.place.hidden = false;
    const { offsetWidth, offsetHeight } = this.place;
    this.place.style.left = `${Math.max(4, Math.min(innerWidth - offsetWidth - 4, x))}px`;
    this.place.style.top = `${Math.max(4, Math.min(innerHeight - offsetHeight - 4, y))}px`;
    this.place.querySelector("button:not(:disabled)")?.focus();
  }

  key(event) {
    const buttons = [...this.place.querySelectorAll("button:not(:disabled)")];
    const at = buttons.indexOf(document.activeElement);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) {
      event.preventDefault();
      buttons[(at + step + buttons.length) % buttons.length]?.focus();
    } else if (event.key === "Escape") {
      event.stopPropagation();
      this.close();
    }
  }

  close() {
    const { activeElement } = document;
    this.place.hidden = true;
    // The next key is for what had the keys before, at once.
    if (this.place.contains(activeElement)) {
      activeElement.blur();
      this.back?.focus?.();
    }
  }
}
