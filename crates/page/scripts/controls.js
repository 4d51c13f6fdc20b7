// Sliders and number fields, in the units of display.

/** Rounds to the digits that a reader sees. */
export function shown(value, digits = 7) {
  return Number.isFinite(value) ? Number(value.toPrecision(digits)) + 0 : null;
}

/** Adds an element with properties and children. */
export function add(parent, name, properties = {}, ...children) {
  const element = document.createElement(name);
  Object.assign(element, properties);
  element.append(...children);
  return parent.appendChild(element);
}

/** Shows a text whose names stand in back quotes, and whose numbers may end in zeros. */
export function say(element, text) {
  const plain = text.replace(/\d+\.\d*0(?!\d)/g, (number) => String(Number(number)));
  element.replaceChildren();
  plain.split("`").forEach((part, index) => {
    if (index % 2) {
      add(element, "code", { textContent: part });
    } else {
      element.append(part);
    }
  });
}

/**
 * Offers in a list what can move: time, and the drivers that are inputs where no freedoms move by
 * themselves. A choice made before stays.
 */
export function offerMoves(list, page) {
  const before = list.value;
  list.replaceChildren();
  if (page.uses_time) {
    list.add(new Option("time", "time"));
  }
  page.drivers.forEach((driver, index) => {
    if (driver.is_input && !page.is_free) {
      list.add(new Option(driver.name, index));
    }
  });
  if ([...list.options].some((option) => option.value === before)) {
    list.value = before;
  }
}

/** Returns the driver that is chosen in such a list, null for time. */
export function moveOf(list) {
  return ["time", ""].includes(list.value) ? null : Number(list.value);
}

/** Shows a picture that the solver has drawn, an SVG file. */
export function showPicture(element, svg) {
  element.innerHTML = svg.replace(/^<\?xml[^>]*>/, "");
}

/**
 * A row with a slider and a field for one value. `item` has name, description, unit and factor;
 * `low` and `high` bound the slider [SI], and `low_end` and `high_end` say what ends it there;
 * `turns` lets it go round. `change(value, done)` is called
 * while the value changes, and with `done` at the end.
 */
export class Row {
  /**
   * @param {Element} parent
   * @param {any} item
   * @param {{ low: number, high: number, low_end?: string, high_end?: string, turns?: boolean }} ends
   * @param {(value: number, done: boolean) => void} change
   */
  constructor(parent, item, { low, high, low_end, high_end, turns = false }, change) {
    this.item = item;
    this.turns = turns;
    const row = add(parent, "div", { className: "row", title: item.description });
    const unit = item.unit ? ` [${item.unit}]` : "";
    const id = `live-${(Row.count = (Row.count ?? 0) + 1)}`;
    add(row, "label", { htmlFor: id, textContent: `${item.name}${unit}` });
    this.slider = add(row, "input", { type: "range", step: "any" });
    this.slider.setAttribute("aria-label", `${item.name}, slider`);
    this.field = add(row, "input", { type: "number", step: "any", id });
    this.ends = add(row, "small", { className: "ends" });
    this.bound({ low, high, low_end, high_end });
    this.slider.addEventListener("input", () => change(this.unwrapped(Number(this.slider.value)), false));
    // The slider shows the value that was reached.
    this.slider.addEventListener("change", () => change(this.value, true));
    this.field.addEventListener("change", () => {
      if (this.field.value !== "" && Number.isFinite(this.field.valueAsNumber)) {
        change(this.field.valueAsNumber / item.factor, true);
      } else {
        this.set(this.value);
      }
    });
  }

  /** Sets the ends of the slider, with what ends it there. */
  bound({ low, high, low_end, high_end }) {
    [this.low, this.high] = [low, high];
    this.slider.min = low;
    this.slider.max = high;
    const { factor, unit } = this.item;
    const ends = [[low, low_end], [high, high_end]].filter(([, end]) => end);
    const texts = ends.map(([value, end]) => `${end} at ${shown(value * factor, 5)} ${unit}`);
    say(this.ends, texts.join(", "));
  }

  // A crank that has turned further stays in its turn.
  unwrapped(place) {
    if (!this.turns) {
      return place;
    }
    return place + (this.high - this.low) * Math.floor((this.value - this.low) / (this.high - this.low));
  }

  set(value) {
    this.value = value;
    const turn = this.high - this.low;
    this.slider.value = this.turns ? value - turn * Math.floor((value - this.low) / turn) : value;
    if (document.activeElement !== this.field || this.field.dataset.was !== this.field.value) {
      this.field.value = shown(value * this.item.factor);
      this.field.dataset.was = this.field.value;
    }
    this.slider.setAttribute("aria-valuetext", `${this.field.value} ${this.item.unit}`);
  }
}
