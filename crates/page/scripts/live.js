// @ts-check
// A mechanism in a page: connects the solver with picture, controls, chart and files.

import { Chart } from "./chart.js";
import { Row, add, say, showPicture, shown } from "./controls.js";
import { Course } from "./course.js";
import { connectSaving } from "./files.js";
import { giveHand } from "./hand.js";
import { linkTo } from "./link.js";
import { Picture } from "./picture.js";
import { Play } from "./play.js";
import { Broken, Solver, unpack } from "./solver.js";

// Units of the arrows.
const ARROW_UNITS = { velocity: "m/s", acceleration: "m/s²", force: "N" };
const LENGTHS_AND_ANGLES = ["m", "cm", "mm", "inch", "rad", "deg"];

export class Live {
  constructor(root, module, file) {
    this.root = root;
    this.module = module;
    this.file = file;
    this.find = (selector) => root.querySelector(selector);
    this.solver = new Solver(module);
    this.picture = new Picture(this.find(".paper"));
    this.play = new Play(this, this.find);
    this.chart = new Chart(this, this.find);
    this.course = new Course(this, this.find);
    this.connect();
    this.open(file);
  }

  // -- the solver ----------------------------------------------------------------------------

  /**
   * Asks the solver; undefined if it has failed, which the page then shows.
   * @param {import("./messages").PageRequest} request
   */
  ask(request) {
    try {
      const answer = this.solver.ask(request);
      if (answer.error) {
        this.tell(answer.error);
      }
      return answer;
    } catch (error) {
      this.recover(error);
      return undefined;
    }
  }

  /**
   * Asks for a move, shows its outcome and draws; true if the mechanism is where it was to go.
   * @param {import("./messages").PageRequest} request
   */
  move(request) {
    const answer = this.ask(request);
    if (!answer) {
      return false;
    }
    this.refused = answer.assembles ? request : null;
    this.tellOutcome(answer);
    if (request.do === "load") {
      this.rowOf(request).set(answer.value);
    }
    this.draw();
    return answer.outcome === "reached";
  }

  /** Moves a driver without words, as many times a second as there are pictures. */
  drive(driver, value) {
    try {
      const reached = this.solver.drive(driver, value);
      this.tellOutcome({ outcome: "reached" });
      this.draw();
      return reached;
    } catch (error) {
      this.recover(error);
      return false;
    }
  }

  /** Keeps the present state for undo. */
  keep() {
    this.ask({ do: "keep" });
  }

  /** Opens a file; `kept`, so that undo returns to the one before. Problems stand in `place`. */
  open(file, place = ".problems", kept = false) {
    const answer = this.ask({ do: "open", kept, ...file });
    if (answer?.problems) {
      say(this.find(place), answer.problems.join("\n\n"));
      this.find(place).hidden = false;
      return false;
    }
    return answer?.page ? this.opened(file, answer.page) : false;
  }

  opened(file, page) {
    for (const place of [".problems", ".file-problems"]) {
      this.find(place).hidden = true;
    }
    this.file = file;
    this.find(".text").value = file.text;
    this.course.forget();
    this.show(page, this.ask({ do: "picture" }), false);
    this.tellOutcome({ outcome: "reached" });
    for (const warning of this.page.warnings) {
      this.tell(warning);
    }
    return true;
  }

  // A defect of the solver: says so, and offers to go on with a new one.
  recover(error) {
    this.play.playing = false;
    if (!(error instanceof Broken)) {
      throw error;
    }
    this.find(".broken").hidden = false;
    this.find(".broken p").textContent = `The solver has failed, which is a defect of biela: ${error.message}`;
  }

  restart() {
    this.find(".broken").hidden = true;
    this.solver = new Solver(this.module);
    this.open(this.file);
  }

  /** Whether freedoms move at present. */
  get flies() {
    return this.page.is_free && this.play.playing;
  }

  // -- what is shown -------------------------------------------------------------------------

  /** Shows a description and a picture. */
  show(page, parts, keep) {
    this.page = page;
    this.places = page.places;
    this.picture.show(parts, keep);
    this.makeRows();
    this.play.offer(page);
    this.chart.offer(page);
    this.draw();
    this.chart.draw();
    this.course.draw();
  }

  draw() {
    this.frame = this.solver.frame.slice();
    const { frame, places, page } = this;
    this.picture.draw(frame, places);
    this.drivers.forEach((row, index) => row?.set(frame[places.drivers + 3 * index]));
    this.velocities.forEach((row, index) => row.set(frame[places.drivers + 3 * index + 1]));
    this.parameters.forEach((row, index) => row.set(frame[places.parameters + index]));
    for (const [output, variable] of this.values) {
      const { unit, factor } = page.variables[variable];
      const at = frame[places.variables + variable];
      // Lengths below a picometre and such angles are rounding.
      const isRounding = Math.abs(at) < 1e-12 && LENGTHS_AND_ANGLES.includes(unit);
      const value = isRounding ? 0 : shown(at * factor, 6);
      output.textContent = value === null ? "no finite value" : `${value} ${unit}`;
    }
    this.tellRates();
    for (const [kind, unit] of Object.entries(ARROW_UNITS)) {
      const most = this.picture.most[kind];
      this.find(`.scale.${kind}`).textContent = most > 1e-9 ? `(longest arrow ${shown(most, 3)} ${unit})` : "";
    }
    const time = page.uses_time ? `${frame[0].toFixed(3)} s` : "";
    this.find(".clock").textContent = [time, this.play.slowness].filter(Boolean).join(", ");
    this.find(".time").value = frame[0];
    this.chart.move();
    this.course.move();
  }

  /** Tells the speeds at which rates and forces are shown. */
  tellRates() {
    const { frame, places, page } = this;
    const inputs = page.is_free ? [] : page.drivers.flatMap((driver, index) => (driver.is_input ? [[driver, index]] : []));
    const rates = inputs.map(([driver, index]) => {
      const [velocity, acceleration] = frame.slice(places.drivers + 3 * index + 1);
      const part = (value, kind) => `${shown(value * driver[`${kind}_factor`], 4)} ${driver[`${kind}_unit`]}`;
      return `\`${driver.name}\` at ${part(velocity, "velocity")}${acceleration ? `, ${part(acceleration, "acceleration")}` : ""}`;
    });
    const end = frame[places.has_rates] ? "" : " At this dead point they have no finite values.";
    const text = rates.length ? `Rates and forces are those of ${rates.join("; ")} (see Speeds and loads).${end}` : "";
    if (text !== this.toldRates) {
      this.toldRates = text;
      say(this.find(".at-rates"), text);
    }
  }

  /** Measures names that have another size on the screen, and draws them. */
  fit() {
    if (this.frame) {
      this.picture.fit();
      this.picture.draw(this.frame, this.places);
    }
  }

  makeRows() {
    const { page } = this;
    this.find(".driver-title").textContent = page.is_free ? "Drivers and freedoms" : "Drivers";
    const drivers = this.find(".driver-rows");
    drivers.replaceChildren();
    this.drivers = page.drivers.map((driver, index) => {
      const range = page.ranges[index];
      if (!range) {
        add(drivers, "p", { className: "prescribed", textContent: `${driver.name}: prescribed motion` });
        return null;
      }
      return new Row(drivers, driver, range, (value, done) => this.slide({ do: "drive", driver: index, value }, done));
    });
    this.makeRateRows();
    const parameters = this.find(".parameter-rows");
    parameters.replaceChildren();
    this.parameters = page.parameters.map((parameter, index) => {
      const [low, high] = parameter.slider;
      const row = new Row(parameters, parameter, { low, high }, (value, done) =>
        this.slide({ do: "set", parameter: index, value }, done),
      );
      row.slider.disabled = row.field.disabled = parameter.is_derived;
      return row;
    });
    this.find(".parameter-part").hidden = page.parameters.length === 0;
    this.find(".time-part").hidden = !page.uses_time;
    Object.assign(this.find(".time"), { min: page.start, max: page.stop });
    this.find('.show[value="force"]').parentElement.hidden = !page.has_forces;
    const readings = this.find(".readings");
    readings.replaceChildren();
    this.values = page.variables.flatMap((variable, index) => {
      if (!variable.is_told) {
        return [];
      }
      const row = add(readings, "div");
      add(row, "dt", { textContent: variable.name });
      return [[add(row, "dd"), index]];
    });
    this.find(".modes").replaceChildren();
    this.find(".modes-text").textContent = "";
  }

  /** Rows for the rates of the drivers that are inputs, and for the forces that are. */
  makeRateRows() {
    const { page } = this;
    const place = this.find(".rate-rows");
    place.replaceChildren();
    const row = (item, low, high, value, set) => {
      const made = new Row(place, item, { low, high }, (next, done) => {
        if (!item.moves) {
          made.set(next);
        }
        set(next, done);
      });
      made.set(value);
      return made;
    };
    // Those that change by themselves, by driver.
    this.velocities = [];
    page.drivers.forEach((driver, index) => {
      if (!driver.is_input) {
        return;
      }
      const largest = {
        velocity: Math.max(4 * driver.usual_velocity, 2 * Math.abs(driver.velocity)),
        acceleration: 8 * driver.usual_velocity,
      };
      for (const rate of driver.is_free ? ["velocity"] : ["velocity", "acceleration"]) {
        const item = {
          name: `${driver.name}.${rate}`,
          description: driver.description,
          unit: driver[`${rate}_unit`],
          factor: driver[`${rate}_factor`],
        };
        const made = row(item, -largest[rate], largest[rate], driver[rate], (value) => {
          const at = this.places.drivers + 3 * index;
          const [velocity, acceleration] = this.frame.slice(at + 1, at + 3);
          this.give({ do: "speed", driver: index, velocity, acceleration, [rate]: value });
        });
        if (page.is_free && rate === "velocity") {
          this.velocities[index] = made;
        }
      }
    });
    this.loads = page.loads.map((load, index) =>
      row(load, -load.largest, load.largest, load.value, (value, done) => {
        const request = /** @type {const} */ ({ do: "load", input: index, value });
        load.moves ? this.slide(request, done) : this.give(request);
      }),
    );
    this.find(".rate-part").hidden = place.childElementCount === 0;
  }

  /**
   * Gives speeds, or loads that move nothing.
   * @param {import("./messages").PageRequest} request
   */
  give(request) {
    this.ask(request);
    this.draw();
    this.chart.draw();
  }

  /**
   * A slider moves: solves at once, and draws anew what parameters change.
   * @param {import("./messages").PageRequest & { do: "drive" | "set" | "load" }} request
   */
  slide(request, done) {
    if (!this.sliding) {
      this.play.stop();
      this.keep();
      this.sliding = true;
    }
    const row = this.rowOf(request);
    // The end of a slide is no move: what stopped it remains to be read.
    const reached = request.value === row.value || this.move(request);
    if (request.do === "set" && reached) {
      this.redraw(!done);
    }
    if (done) {
      this.sliding = false;
      this.settle();
    }
  }

  /**
   * The row whose slider asks for a move.
   * @param {import("./messages").PageRequest & { do: "drive" | "set" | "load" }} request
   */
  rowOf(request) {
    switch (request.do) {
      case "set":
        return this.parameters[request.parameter];
      case "load":
        return this.loads[request.input];
      default:
        return this.drivers[request.driver];
    }
  }

  /** Draws the picture anew; `keep` leaves its scale. */
  redraw(keep) {
    const answer = this.ask({ do: "redraw", keep });
    if (answer?.page) {
      this.page = answer.page;
      this.places = answer.page.places;
      this.picture.show(answer.picture, keep);
      this.drivers.forEach((row, index) => row?.bound(this.page.ranges[index]));
      this.draw();
      this.course.draw();
    }
  }

  /** After a move: what has left the picture, and charts, are drawn anew. */
  settle() {
    if (!this.picture.zoomed && this.picture.leaves) {
      this.redraw(false);
    } else {
      this.course.draw();
    }
    this.chart.draw();
  }

  /** @param {any} outcome */
  tellOutcome({ outcome, message, at, assembles }) {
    this.picture.mark(at ?? null);
    const line = this.find(".message");
    if (outcome !== "reached" || line.textContent !== "") {
      say(line, message ?? "");
      this.root.classList.toggle("stopped", outcome !== "reached");
    }
    this.find(".anew").hidden = !assembles;
  }

  tell(text) {
    say(this.find(".message"), text);
  }

  // -- controls ------------------------------------------------------------------------------

  connect() {
    const { find, root } = this;
    const click = (selector, act) => find(selector).addEventListener("click", act);
    /** @param {"undo" | "redo" | "reset"} word */
    const step = (word) => () => {
      this.play.stop();
      const answer = this.ask({ do: word });
      if (answer?.page) {
        this.opened({ ...this.file, ...answer.file }, answer.page);
      } else if (answer?.done) {
        this.redraw(false);
        this.makeRateRows();
        this.tellOutcome({ outcome: "reached" });
        this.chart.draw();
      }
    };
    const steps = { undo: step("undo"), redo: step("redo"), reset: step("reset") };
    for (const [name, act] of Object.entries(steps)) {
      click(`.${name}`, act);
    }
    click(".restart", () => this.restart());
    click(".find-modes", () => this.findModes());
    click(".apply", () => this.open({ ...this.file, text: find(".text").value }, ".file-problems", true));
    click(".anew", () => {
      const request = this.refused;
      if (request?.do === "set" && this.move({ ...request, anew: true })) {
        this.redraw(false);
        this.chart.draw();
      }
    });
    find(".time").addEventListener("input", () => {
      this.play.stop();
      this.move({ do: "time", value: Number(find(".time").value) });
    });
    const switches = [...root.querySelectorAll(".show")];
    for (const box of switches) {
      const show = () => {
        root.classList.toggle(`show-${box.value}`, box.checked);
        // Only texts on the page have a width.
        if (box.value === "names" && box.checked) {
          this.fit();
        }
      };
      box.addEventListener("change", show);
      show();
    }
    addEventListener("resize", () => this.fit());
    find(".chart-part").addEventListener("toggle", () => this.chart.draw());
    find(".licences").addEventListener("toggle", async () => {
      find(".licences pre").textContent = await unpack("live-licences").text();
    });
    connectSaving(root, this);
    giveHand(find(".paper"), this);
    const toggle = (value) => () => switches.find((box) => box.value === value).click();
    const keys = {
      " ": () => this.play.toggle(),
      ArrowLeft: () => this.nudge(-1),
      ArrowRight: () => this.nudge(1),
      v: toggle("velocity"),
      a: toggle("acceleration"),
      f: toggle("force"),
      n: toggle("names"),
      o: () => find(".poses").click(),
    };
    document.addEventListener("keydown", (event) => {
      const { target, key } = event;
      if (!root.checkVisibility()) {
        return;
      }
      const inside = root.contains(target);
      if (!inside && (target !== document.body || document.querySelector("main h2"))) {
        return;
      }
      if ((event.ctrlKey || event.metaKey) && key.toLowerCase() === "z" && !target.matches("input, textarea")) {
        event.preventDefault();
        steps[event.shiftKey ? "redo" : "undo"]();
        return;
      }
      const own = target.matches("input, select, textarea, summary") || (target.matches("button") && key === " ");
      if (keys[key] && !own && !event.ctrlKey && !event.metaKey && !event.altKey) {
        event.preventDefault();
        keys[key]();
      }
    });
    this.connectFile();
    this.connectStudio();
  }

  /** Moves what plays by a small step. */
  nudge(direction) {
    this.play.stop();
    const before = this.play.direction;
    this.play.direction = direction;
    this.play.advance(1 / 60);
    this.play.direction = before;
  }

  findModes() {
    const answer = this.ask({ do: "assemblies" });
    const place = this.find(".modes");
    place.replaceChildren();
    if (!answer?.pictures) {
      return;
    }
    const count = answer.pictures.length;
    const others = count === 0 ? "no other position" : `${count} other position${count === 1 ? "" : "s"}`;
    this.find(".modes-text").textContent =
      `With these values the mechanism closes in ${others}${answer.complete ? "" : " that the search has found"}.`;
    answer.pictures.forEach((picture, index) => {
      const button = add(place, "button", { type: "button" });
      button.setAttribute("aria-label", `Position ${index + 1}`);
      showPicture(button, picture);
      button.addEventListener("click", () => {
        this.play.stop();
        if (this.move({ do: "choose", index })) {
          this.redraw(false);
          this.findModes();
          this.chart.draw();
        }
      });
    });
  }

  /** With the address of a studio the mechanism opens there, as it is here. */
  connectStudio() {
    const button = this.find(".edit");
    const { studio } = this.root.dataset;
    button.hidden = !studio;
    button.addEventListener("click", async () => {
      const { text } = this.ask({ do: "text" }) ?? {};
      if (text) {
        const link = await linkTo(studio, { ...this.file, text });
        add(this.root, "a", { href: link, target: "_blank", hidden: true }).click();
      }
    });
  }

  /** Where `biela watch` serves the page, parameters can be written into the file. */
  connectFile() {
    const button = this.find(".write");
    const { token } = this.root.dataset;
    button.hidden = !token;
    button.addEventListener("click", async () => {
      const answer = this.ask({ do: "text", parameters: true });
      if (answer?.text) {
        const sent = await fetch("/file", {
          method: "PUT",
          headers: { "X-Biela-Token": token },
          body: answer.text,
        });
        this.tell(sent.ok ? "The file has these parameters now." : `The file was not written: ${await sent.text()}`);
      }
    });
  }
}
