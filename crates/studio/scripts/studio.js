// @ts-check
// The studio: text and drawing of one mechanism, side by side, and the way out.

import { Background } from "./background.js";
import { add, say, showPicture } from "./controls.js";
import { Design } from "./design.js";
import { Menu, askName, buttonRow, byKeys, openWindow } from "./dialogs.js";
import { Disk } from "./disk.js";
import { Drafts, newId } from "./drafts.js";
import { exportFmu, importFile, saveDrawing, saveFile, saveMade, saveVideo, shareLink, showNotes, videoKind } from "./export.js";
import { Guide } from "./guide.js";
import { Inspector } from "./inspector.js";
import { fileOfLink } from "./link.js";
import { Live } from "./live.js";
import { Sheet } from "./sheet.js";
import { Broken, Solver, unpack } from "./solver.js";
import { TOOLS, icon, keyName } from "./tools.js";
import { ANGLES, LENGTHS } from "./units.js";

const EMPTY = 'format = 1\nname = "mechanism"\n';
// Pause after which typing goes on as another change [ms].
const PAUSE = 900;
// Time for which a message stands [ms].
const TOLD = 8000;
// Templates that come first.
const EVERYDAY = ["pendulum", "slider_crank", "four_bar", "tlv", "pendulum_free", "loader", "scotch_yoke", "cam_roller", "planetary_gear", "toggle_press"];
// Gestures whose outcome is selected, by the lists in which it stands.
const MAKERS = {
  bodies: ["duplicate", "mirror"],
  drivers: ["driver", "freedom", "cylinder"],
  forces: ["spring", "damper", "load"],
  stops: ["stop"],
  joints: ["curve", "rope", "coupling"],
  friction: ["friction"],
  contacts: ["contact"],
};
// The lists of a sketch whose things have names.
const NAMED = ["joints", "drivers", "forces", "stops", "measures", "friction", "contacts", "parameters"];

class Studio {
  constructor(root, module, parts, templates) {
    this.root = root;
    this.module = module;
    this.parts = parts;
    /** @type {any} */
    this.schema = null;
    /** @type {Disk | null} */
    this.disk = null;
    this.server = "";
    this.drafts = new Drafts();
    const rank = ({ name }) => (EVERYDAY.includes(name) ? EVERYDAY.indexOf(name) : EVERYDAY.length);
    this.templates = [...templates].sort((a, b) => rank(a) - rank(b));
    this.find = (selector) => root.querySelector(selector);
    this.solver = new Solver(module);
    this.view = {};
    this.selection = null;
    this.mode = "design";
    this.unit = { name: "mm", factor: LENGTHS.mm };
    this.turn = { name: "deg", factor: ANGLES.deg };
    this.menu = new Menu(this.find(".middle"));
    this.sheet = new Sheet(this.find(".sheet"), () => this.redraw());
    this.background = new Background(this, this.sheet);
    this.design = new Design(this, this.sheet);
    this.inspector = new Inspector(this, this.find(".inspector"));
    this.guide = new Guide(this, this.find(".guide"));
    this.makeTools();
    this.makeUnits();
    this.editor = makeEditor(this.find(".editor"), {
      onChange: (text) => this.typed(text),
      onCursor: () => {},
      complete: (text, offset) => completions(text, offset, this.schema, this.names),
      undo: () => this.undo(),
      redo: () => this.redo(),
      label: "The mechanism's file",
    });
    // Said again for programs that do not count what is editable as reached by keys.
    this.find(".editor .cm-content").tabIndex = 0;
    for (const element of root.querySelectorAll("[title]")) {
      element.title = byKeys(element.title);
    }
    this.connect();
    this.design.take("select");
  }

  get isDesign() {
    return this.mode === "design";
  }

  get text() {
    return this.view.text ?? "";
  }

  /** The text as the file has it. */
  get fileText() {
    return this.text.replaceAll("\n", this.lineEnd);
  }

  /** The mechanism's name, for files. */
  get name() {
    return nameIn(this.text);
  }

  /** The thing of a name, for selection; nothing if there is none. */
  thingNamed(name) {
    const { sketch } = this.view;
    if (sketch?.bodies.some((body) => body.name === name)) {
      return { kind: "body", name };
    }
    const isThing = NAMED.some((list) => sketch?.[list]?.some((thing) => thing.name === name));
    return isThing ? { kind: "thing", name } : undefined;
  }

  /** Names in the file, for completion. */
  get names() {
    const { sketch } = this.view;
    return {
      markers: sketch?.points.flatMap((point) => point.markers) ?? [],
      bodies: sketch?.bodies.map((body) => body.name) ?? [],
      joints: sketch?.joints.map((joint) => joint.name) ?? [],
      drivers: sketch?.drivers.map((driver) => driver.name) ?? [],
      parameters: sketch?.parameters.map((parameter) => parameter.name) ?? [],
    };
  }

  // -- the solver ----------------------------------------------------------------------------

  /**
   * Asks the solver; a failure of it makes a new one, with the text as it was.
   * @param {import("../../page/scripts/messages").StudioRequest | import("../../page/scripts/messages").ExportRequest} request
   */
  ask(request) {
    try {
      return this.solver.ask(request);
    } catch (error) {
      if (!(error instanceof Broken)) {
        throw error;
      }
      console.info(error.message);
      this.solver = new Solver(this.module);
      if (request.do !== "begin") {
        this.solver.ask({ do: "begin", ...this.file, text: this.text, history: this.history });
      }
      this.say("This is a defect of biela: it cannot do that. The drawing is as it was before, with its undo");
      return { refused: {} };
    }
  }

  /**
   * Opens a file, which becomes another draft, or a draft.
   * @param {{ name: string, text: string, files?: [string, string][], id?: string, history?: any, changed?: boolean, words?: string }} file
   */
  open(file, fit = true) {
    const before = { draft: this.draft, file: this.file, lineEnd: this.lineEnd };
    this.draft = { id: file.id ?? newId(), changed: Boolean(file.changed) };
    this.file = { name: file.name, files: file.files ?? [] };
    // The editor has lines of one kind; the file keeps its own.
    this.lineEnd = file.text.includes("\r\n") ? "\r\n" : "\n";
    this.selection = null;
    this.design.answers.clear();
    const text = file.text.replaceAll("\r\n", "\n");
    const answer = this.ask({ do: "begin", ...this.file, text, history: file.history, scale: this.sheet.scale });
    if (answer.refused) {
      // The sheet stays as it was; on a new page it is an empty one.
      Object.assign(this, before);
      const shown = before.draft ? { ...this.file, text: this.text, history: this.history } : { name: "mechanism.toml", text: EMPTY };
      return before.draft ? this.ask({ do: "begin", ...shown }) : this.open(shown);
    }
    this.words = undefined;
    this.savedText = this.draft.changed ? null : file.text;
    this.claims = true;
    // A text with an error leaves its own drawing, not that of another file.
    this.view = {};
    this.sheet.show(null);
    this.show(answer, { anew: true });
    this.background.restore(this.drafts.picture(this.draft.id)).catch(() => {});
    if (fit) {
      this.fit();
    }
    this.setMode("design");
    if (file.words) {
      this.editor.set(file.words);
      this.typed(file.words);
    }
    this.askForTables();
  }

  /** The tables that the file names and that are not there. */
  get missingTables() {
    const names = (this.view.problems ?? []).map(({ message }) => message.match(/^cannot read the file `([^`]+)`/)?.[1]);
    return names.filter((name) => name && !this.file.files.some(([known]) => known === name));
  }

  /** Asks for the tables that are not there. */
  async askForTables() {
    const names = this.missingTables;
    if (names.length) {
      const answer = await openWindow(this.root, "Tables of the file", (form) => {
        say(add(form, "p"), `The file names ${names.map((name) => `\`${name}\``).join(", ")}: a browser reads only what you choose.`);
        buttonRow(form, ["Choose …", "choose"], ["Later", ""]);
      });
      if (answer) {
        this.find(".opened").click();
      }
    }
  }

  /** Asks before a drawing is given up that is kept nowhere; true if it may go. */
  async mayLeave() {
    this.takeFields();
    const { unkept } = this;
    if (!unkept) {
      return true;
    }
    const answer = await openWindow(this.root, "Give up this drawing?", (form) => {
      say(add(form, "p"), `\`${this.name}\` was changed, and ${unkept}. What is not saved as a file is lost.`);
      buttonRow(form, ["Keep it", ""], ["Give it up", "leave"]);
    });
    return answer === "leave";
  }

  /**
   * Does a gesture; shows its outcome, and says why not.
   * @param {import("../../page/scripts/messages").Gesture} gesture
   */
  gesture(gesture, tells = true) {
    const { scale, decimals } = this.sheet;
    const answer = this.ask({ do: "gesture", keep: true, scale, decimals, gesture });
    if (answer.refused) {
      if (tells && answer.refused.message) {
        this.say(answer.refused.message);
      }
      if (tells && answer.refused.parameter) {
        this.say(`The number is \`${answer.refused.formula}\` in the text: change it there`);
      }
      return answer;
    }
    this.say("");
    const before = this.view.sketch;
    if (gesture.kind === "rename") {
      this.renameSelection(gesture.old, gesture.new);
    }
    this.show(answer);
    if ((gesture.kind === "mass" || gesture.kind === "shape") && gesture.body && gesture.body !== "ground") {
      this.select({ kind: "body", name: gesture.body });
    }
    this.selectMade(gesture.kind, before);
    return answer;
  }

  /** Selects what a gesture has made, if it has numbers of its own. */
  selectMade(kind, before) {
    const list = Object.keys(MAKERS).find((name) => MAKERS[name].includes(kind));
    const known = before?.[list]?.map((thing) => thing.name) ?? [];
    const made = this.view.sketch?.[list]?.find((thing) => !known.includes(thing.name));
    if (kind === "load") {
      this.say("The force is an input of the FMU; in Motion it is set under Speeds and loads");
    }
    if (made) {
      this.select({ kind: list === "bodies" ? "body" : "thing", name: made.name });
    }
  }

  /**
   * Shows what a gesture would draw.
   * @param {import("../../page/scripts/messages").Gesture} gesture
   */
  preview(gesture) {
    const { scale, decimals } = this.sheet;
    const answer = this.ask({ do: "gesture", keep: false, scale, decimals, gesture });
    if (!answer.refused) {
      this.sheet.show(answer.picture, scale);
      this.tellStatus(answer.status);
    }
    return answer;
  }

  /** Draws the document as it is. */
  showAgain() {
    this.sheet.show(this.view.picture, this.drawnScale);
    this.tellStatus(this.view.status);
  }

  /** Draws at the scale of the sheet. */
  redraw() {
    if (this.redrawing || !this.view.text) {
      return;
    }
    this.redrawing = true;
    requestAnimationFrame(() => {
      this.redrawing = false;
      this.draw(this.ask({ do: "view", scale: this.sheet.scale }));
      this.design.mark();
    });
  }

  /** Draws a view, which was asked for at the sheet's scale. */
  draw(view) {
    if (view.text === undefined) {
      return;
    }
    this.view = { ...this.view, ...view };
    this.drawnScale = this.sheet.scale;
    if (view.sketch) {
      this.sheet.show(view.picture, this.drawnScale);
    }
  }

  /** Shows a view; only the part of the text that has changed goes to the editor. */
  show(view, { anew = false, typed = false } = {}) {
    if (view.text === undefined) {
      return;
    }
    const before = this.editor.text;
    this.draw(view);
    if (anew) {
      this.editor.set(view.text);
    } else if (!typed && before !== view.text) {
      const [from, to, insert] = changeOf(before, view.text);
      this.editor.replace(from, to, insert);
    }
    this.editor.problems(view.problems);
    this.root.classList.toggle("stale", view.is_stale);
    this.root.classList.toggle("blank", view.status?.state === "empty");
    this.find(".undo").disabled = !view.can_undo;
    this.find(".redo").disabled = !view.can_redo;
    this.find(".file-name").textContent = this.name;
    document.title = `${this.name} – biela studio`;
    this.chooseUnit();
    this.tellStatus(view.status);
    this.keepSelection();
    this.inspector.show();
    this.design.mark();
    this.keep();
    this.guide.look();
  }

  /** Takes the units that the user has chosen; for lengths otherwise the one of the file. */
  chooseUnit() {
    const [length, angle] = [this.find(".lengths").value, this.find(".angles").value];
    const display = this.text.match(/display\s*=\s*"(mm|cm|m|inch)"/)?.[1];
    const name = length || display || ((this.view.sketch?.size ?? 0) > 3 ? "m" : "mm");
    this.unit = { name, factor: LENGTHS[name] };
    this.turn = { name: angle, factor: ANGLES[angle] };
  }

  /** Offers units, with those that this browser keeps. */
  makeUnits() {
    const lists = [this.find(".lengths"), this.find(".angles")];
    lists[0].add(new Option("unit of the file", ""));
    [LENGTHS, ANGLES].forEach((units, index) => Object.keys(units).forEach((name) => lists[index].add(new Option(name, name))));
    const kept = this.drafts.units ?? [];
    lists.forEach((list, index) => (list.value = kept[index] ?? list.value));
    for (const list of lists) {
      list.addEventListener("change", () => {
        this.chooseUnit();
        this.inspector.told = null;
        this.inspector.show();
        this.design.mark();
        this.drafts.keepUnits(lists.map(({ value }) => value));
      });
    }
  }

  fit() {
    const { sketch } = this.view;
    this.sheet.fit(sketch?.points.map((point) => point.at) ?? []);
  }

  // -- text and undo -------------------------------------------------------------------------

  typed(text) {
    const now = performance.now();
    const joined = now - (this.typedAt ?? -Infinity) < PAUSE;
    this.typedAt = now;
    const answer = this.ask({ do: "type", text, joined, scale: this.sheet.scale });
    // Words that the solver cannot take stay in the text, and wait for others.
    this.words = answer.refused ? text : undefined;
    if (this.words) {
      this.keepDraft();
      return;
    }
    this.show(answer, { typed: true });
    this.stopMotion();
  }

  undo() {
    this.step("text_undo");
  }

  redo() {
    this.step("text_redo");
  }

  /** @param {"text_undo" | "text_redo"} word */
  step(word) {
    this.typedAt = -Infinity;
    this.design.drop();
    this.setMode("design");
    const before = this.text;
    this.show(this.ask({ do: word, scale: this.sheet.scale }));
    this.editor.show(changeOf(before, this.text)[0]);
  }

  // -- what is kept --------------------------------------------------------------------------

  /** The file on the disk, while it is what is shown. */
  get ownDisk() {
    return this.disk?.id === this.draft.id ? this.disk : null;
  }

  /** Keeps the drawing in this browser, and in the file that `biela studio` serves. */
  keep() {
    this.keepDraft();
    if (this.draft.changed) {
      this.ownDisk?.write(this.fileText);
    }
  }

  keepDraft() {
    const { draft, file, view, fileText: text } = this;
    draft.changed ||= view.can_undo || view.can_redo;
    this.history = this.ask({ do: "history" }).history ?? this.history;
    try {
      const { id } = draft;
      const { history, words } = this;
      const disk = this.ownDisk;
      draft.id = this.drafts.keep({ ...draft, ...file, text, history, words, disk: disk?.written }, this.server, this.claims);
      this.claims = false;
      this.storeTrouble = "";
      if (draft.id !== id) {
        disk?.leave();
        this.say(`Another tab has \`${this.name}\`, too: this one is a draft of its own now`);
      }
    } catch (error) {
      const isFull = error.name === "QuotaExceededError";
      this.storeTrouble = isFull
        ? "the store of this browser is full: remove drafts, or save it as a file"
        : "this browser keeps no drafts: save it as a file";
    }
    this.tellUnsaved();
  }

  keepPicture(picture) {
    try {
      this.drafts.keepPicture(this.draft.id, picture);
    } catch {
      this.say("The store of this browser is full: the picture is gone after a reload");
    }
  }

  /** The reason why what is shown is kept nowhere, "" if it is. */
  get unkept() {
    const disk = this.ownDisk;
    const isSaved = this.savedText === this.fileText || (disk && !disk.waits);
    return this.storeTrouble && !isSaved ? this.storeTrouble : "";
  }

  /** The reason why something is not safe, "" if all is: what is shown, or the file on the disk. */
  get unsaved() {
    const { disk } = this;
    return disk?.waits && disk.trouble ? `\`${disk.name}\` was not written: ${disk.trouble}` : this.unkept;
  }

  /** Says what is not safe as long as it is not. */
  tellUnsaved() {
    const line = this.find(".unsaved");
    const { unsaved } = this;
    if (line.dataset.told !== unsaved) {
      line.dataset.told = unsaved;
      say(line.firstElementChild, sentence(unsaved));
      line.hidden = unsaved === "";
    }
    line.querySelector(".choices").hidden = !this.ownDisk?.changed;
  }

  /** Goes on from the file on the disk, or writes over it. */
  async settle(writes) {
    const disk = this.ownDisk;
    if (!writes && !(await this.mayLeave())) {
      return;
    }
    try {
      const file = await disk.renew();
      if (writes) {
        await disk.write(this.fileText);
      } else {
        disk.leave();
        this.drafts.setAside(disk.id);
        this.open({ ...file, id: disk.id });
      }
    } catch (error) {
      this.say(`\`biela studio\` does not answer: ${error.message}`);
    }
    this.tellUnsaved();
  }

  /** Opens the file on the disk again. */
  async backToDisk() {
    const { id, name, written } = this.disk;
    if (await this.mayLeave()) {
      this.open(this.drafts.get(id) ?? { name, text: written, id });
    }
  }

  /** Returns the file on the disk with what was drawn in it, unless another program has changed it since. */
  fileOfDisk(file) {
    const { drafts, disk } = this;
    const kept = drafts.get(disk.id);
    if (kept && kept.text !== file.text && kept.disk !== file.text) {
      drafts.setAside(disk.id);
      this.say(`\`${file.name}\` was changed on the disk: what was drawn before is under Drafts`);
      return { ...file, id: disk.id };
    }
    return { ...file, ...kept, id: disk.id };
  }

  /** Takes what is being typed in a field. */
  takeFields() {
    /** @type {HTMLElement} */
    const field = document.activeElement?.closest(".inspector .field input");
    field?.blur();
  }

  /** Notes that the text was saved as a file. */
  saved() {
    this.savedText = this.fileText;
    this.tellUnsaved();
  }

  /** Opens one of the drafts. */
  async chooseDraft() {
    const id = await openWindow(this.root, "Drafts", (form, close) => {
      const list = add(form, "div", { className: "templates" });
      const shown = this.drafts.all();
      for (const draft of shown) {
        const entry = add(list, "div", { className: "draft" });
        const button = add(entry, "button", { type: "button" });
        add(button, "div", { className: "picture" });
        add(button, "strong", { textContent: nameIn(draft.text) });
        add(button, "span", { textContent: `${new Date(draft.at).toLocaleString()}${draft.disk === undefined ? "" : `, ${draft.name}`}` });
        button.addEventListener("click", () => close(draft.id));
        if (draft.id !== this.draft.id) {
          const gone = add(entry, "button", { type: "button", className: "remove", textContent: "Remove" });
          gone.setAttribute("aria-label", `Remove ${nameIn(draft.text)}`);
          gone.addEventListener("click", () => {
            this.drafts.remove(draft.id);
            entry.remove();
            this.keep();
          });
        }
      }
      if (shown.length === 0) {
        add(form, "p", { className: "note", textContent: "What you draw is kept in this browser, and stands here." });
      }
      buttonRow(form, ["Cancel", ""]);
      this.pictureAll(list, shown);
    });
    const draft = id && this.drafts.get(id);
    if (draft && draft.id !== this.draft.id && (await this.mayLeave())) {
      this.open(draft);
    }
  }

  // -- what is selected ----------------------------------------------------------------------

  select(thing) {
    this.selection = thing;
    this.inspector.show();
    this.design.mark();
    this.markText();
  }

  /** Follows a thing, or a point, to its new name. */
  renameSelection(old, now) {
    const { selection } = this;
    const [last, path] = [old.split(".").pop(), now.split(".").pop()];
    const renamed = (name) => {
      if (name === old) {
        return old.includes(".") ? `${old.slice(0, -last.length)}${path}` : now;
      }
      return name.startsWith(`${old}.`) ? now + name.slice(old.length) : name;
    };
    if (selection?.name) {
      this.selection = { ...selection, name: renamed(selection.name) };
    } else if (selection) {
      this.selection = { ...selection, markers: selection.markers.map(renamed), joints: selection.joints?.map(renamed) };
    }
  }

  /** Forgets what is no longer there. */
  keepSelection() {
    const { selection } = this;
    const { sketch } = this.view;
    const things = NAMED.flatMap((list) => sketch?.[list] ?? []);
    const gone =
      selection &&
      ((selection.kind === "thing" && !things.some((thing) => thing.name === selection.name)) ||
        (selection.kind === "body" && !sketch?.bodies.some((body) => body.name === selection.name)) ||
        (selection.markers &&
          !sketch?.points.some((point) => point.markers.some((marker) => selection.markers.includes(marker)))));
    if (gone) {
      this.selection = null;
    }
    this.markText();
  }

  /** The names of the bodies all of whose points are selected. */
  chosenBodies() {
    const { markers } = this.selection;
    return (this.view.sketch?.bodies ?? []).filter((body) => body.markers.every((marker) => markers.includes(marker))).map(({ name }) => name);
  }

  /** Marks in the text where the selection stands. */
  markText() {
    const words = this.selected().map((name) => name.replace(/^ground\./, ""));
    const ranges = [];
    for (const word of words) {
      const pattern = new RegExp(`(?<![A-Za-z0-9_.])${word.replace(".", "\\.")}(?![A-Za-z0-9_])`, "g");
      for (const match of this.text.matchAll(pattern)) {
        ranges.push({ from: match.index, to: match.index + word.length });
      }
    }
    this.editor.mark(ranges.sort((a, b) => a.from - b.from));
  }

  /** The names of what is selected. */
  selected() {
    const { selection } = this;
    if (selection?.kind === "points") {
      return this.chosenBodies();
    }
    return selection ? (selection.name ? [selection.name] : [...selection.markers]) : [];
  }

  removeSelected() {
    const { selection } = this;
    if (!selection) {
      return;
    }
    const bodies = selection.kind === "points" ? this.chosenBodies() : [];
    const joints = bodies.length ? [] : selection.joints ?? [];
    const names = [bodies, joints].find((list) => list.length) ?? selection.markers ?? [selection.name];
    this.gesture({ kind: "delete", names });
  }

  // -- menus ---------------------------------------------------------------------------------

  closeMenu() {
    this.menu.close();
  }

  /** Opens the menu of what was found. */
  openMenu(found, event) {
    const names = found.point?.markers ?? [found.body ?? found.thing?.name].filter(Boolean);
    const answer = this.ask({ do: "inspect", names });
    const items = (answer.actions ?? []).map(({ label, gesture, why }) => ({
      label,
      why,
      act: why ? null : () => this.act(gesture),
    }));
    if (!found.point && !found.body) {
      items.push({ label: "Show all", act: () => this.fit() });
    }
    if (items.length) {
      this.menu.open(items, [event.clientX, event.clientY]);
    }
  }

  /**
   * Does an action of the inspector; one without a name asks for it.
   * @param {any} gesture
   */
  async act(gesture) {
    if ("name" in gesture && gesture.name === null) {
      const name = await askName(this.root, "Name of the parameter", "length");
      return name ? this.gesture({ ...gesture, name }) : undefined;
    }
    if (gesture.kind === "rename" && !gesture.new) {
      const old = gesture.old.split(".").pop();
      const name = await askName(this.root, `Rename ${old}`, old);
      return name && name !== old ? this.gesture({ ...gesture, new: name }) : undefined;
    }
    return this.gesture(gesture);
  }

  /** Asks for one of several items: pairs of text and value. */
  choose(items, event) {
    return new Promise((done) => {
      this.menu.open(
        items.map(([label, value]) => ({ label, act: () => done(value) })),
        [event.clientX ?? innerWidth / 2, event.clientY ?? innerHeight / 2],
      );
    });
  }

  // -- words ---------------------------------------------------------------------------------

  tellStatus(status) {
    if (status) {
      this.root.dataset.state = status.state;
      const line = this.find(".status .state");
      if (line.dataset.told !== status.text) {
        line.dataset.told = status.text;
        say(line, sentence(status.text));
      }
      say(this.find(".note"), status.note ?? "");
    }
  }

  hint(text) {
    say(this.find(".status .hint"), byKeys(text));
  }

  /** Tells those who do not see the sheet where the keys are on it. */
  tellPlace(text) {
    this.find(".place-words").textContent = text;
  }

  say(text) {
    const line = this.find(".said");
    say(line, sentence(text));
    line.hidden = text === "";
    clearTimeout(this.saying);
    this.saying = setTimeout(() => (line.hidden = true), TOLD);
  }

  // -- modes ---------------------------------------------------------------------------------

  setMode(mode) {
    if (mode === this.mode) {
      return;
    }
    if (mode === "motion" && !this.startMotion()) {
      return;
    }
    this.mode = mode;
    this.root.classList.toggle("design", this.isDesign);
    this.root.classList.toggle("motion", !this.isDesign);
    for (const button of this.root.querySelectorAll(".modes button")) {
      button.setAttribute("aria-pressed", String(button.value === mode));
    }
    if (this.isDesign) {
      this.live.play.stop();
      this.sheet.look();
      this.design.hint();
    } else {
      this.design.drop();
      this.find(".moving").scrollTop = 0;
      this.hint("Pull a body with the mouse or a finger; space plays");
      this.live.fit();
    }
    this.guide.look();
  }

  startMotion() {
    const { state, text } = this.view.status ?? {};
    if (["empty", "broken", "open"].includes(state)) {
      this.say(state === "empty" ? "There is nothing yet that could move: draw a link first" : text);
      return false;
    }
    const file = { ...this.file, text: this.text };
    const root = this.find(".live");
    if (this.live) {
      this.live.open(file);
    } else {
      this.live = new Live(root, this.module, file);
      root.classList.add("ready");
    }
    return true;
  }

  /** A text that was typed while it moved: the motion begins anew from it. */
  stopMotion() {
    if (!this.isDesign && !this.view.is_stale) {
      this.live.open({ ...this.file, text: this.text });
    }
  }

  /** Takes the pose of the motion as the start of the file. */
  startHere() {
    const text = this.live?.ask({ do: "text" })?.text;
    if (text) {
      this.show(this.ask({ do: "type", text, scale: this.sheet.scale }));
      this.say("The file starts at this pose now");
    }
  }

  // -- controls ------------------------------------------------------------------------------

  makeTools() {
    const place = this.find(".tools");
    for (const [name, tool] of Object.entries(TOOLS).filter(([, { label }]) => label)) {
      if (tool.group) {
        add(place, "span", { className: "group", textContent: tool.group });
      }
      const button = add(place, "button", { type: "button", value: name, title: byKeys(`${tool.hints[0]} (${keyName(tool)})`) });
      button.append(icon(name));
      add(button, "span", { textContent: tool.label });
      button.addEventListener("click", () => {
        this.setMode("design");
        this.design.take(name);
        this.sheet.place.focus({ preventScroll: true });
      });
    }
  }

  showTool(name) {
    for (const button of this.root.querySelectorAll(".tools button")) {
      button.setAttribute("aria-pressed", String(button.value === name));
    }
    this.sheet.place.dataset.tool = name;
  }

  connect() {
    const { find, root } = this;
    const click = (selector, act) => find(selector).addEventListener("click", act);
    click(".undo", () => this.undo());
    click(".redo", () => this.redo());
    click(".zoom-in", () => this.sheet.zoom(1.25));
    click(".zoom-out", () => this.sheet.zoom(0.8));
    click(".fit", () => this.fit());
    click(".export", () => exportFmu(this));
    click(".first-build", () => this.guide.begin());
    click(".start-here", () => this.startHere());
    click(".file-menu", (event) => this.fileMenu(event));
    click(".help", () => this.help());
    for (const button of root.querySelectorAll(".modes button")) {
      button.addEventListener("click", () => this.setMode(button.value));
    }
    for (const button of root.querySelectorAll(".sides-choice button")) {
      button.addEventListener("click", () => {
        root.dataset.side = root.dataset.side === button.value ? "" : button.value;
        for (const each of root.querySelectorAll(".sides-choice button")) {
          each.setAttribute("aria-pressed", String(each.value === root.dataset.side));
        }
      });
    }
    for (const kind of ["dragover", "drop"]) {
      root.addEventListener(kind, (event) => {
        event.preventDefault();
        if (kind === "drop" && event.dataTransfer.files.length) {
          this.openFiles([...event.dataTransfer.files]);
        }
      });
    }
    click(".from-disk", () => this.settle(false));
    click(".to-disk", () => this.settle(true));
    addEventListener("hashchange", () => this.openLink());
    addEventListener("pagehide", () => this.takeFields());
    document.addEventListener("visibilitychange", () => document.hidden && this.takeFields());
    addEventListener("beforeunload", (event) => {
      this.takeFields();
      if (this.unsaved || this.disk?.waits) {
        event.preventDefault();
      }
    });
    document.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("keyup", () => this.design.keyUp());
    // A key is for the sheet or the motion, not for the button that was clicked last.
    find(".bar").addEventListener("click", (event) => event.detail && event.target.closest("button")?.blur(), true);
    find(".pictured").addEventListener("change", (event) => {
      this.background.open(event.target.files[0]);
      event.target.value = "";
    });
    find(".opened").addEventListener("change", (event) => {
      this.openFiles([...event.target.files]);
      event.target.value = "";
    });
  }

  key(event) {
    const { target, key } = event;
    const inField = target.closest?.("input, textarea, select, .editor, dialog, .menu");
    const command = event.ctrlKey || event.metaKey;
    const saves = target.closest?.(".editor, .inspector") && /^[se]$/i.test(key);
    if (command && (!inField || saves)) {
      const [undo, redo] = this.isDesign ? [() => this.undo(), () => this.redo()] : [() => this.live.find(".undo").click(), () => this.live.find(".redo").click()];
      const act = {
        z: () => (event.shiftKey ? redo() : undo()),
        y: redo,
        s: () => saveFile(this),
        e: () => exportFmu(this),
        d: () => this.selected().length && this.gesture({ kind: "duplicate", bodies: this.selected(), by: [4 * this.sheet.step, -4 * this.sheet.step] }),
      }[key.toLowerCase()];
      if (act) {
        event.preventDefault();
        // The page of the motion listens for some of them, too.
        event.stopImmediatePropagation();
        act();
      }
      // With Ctrl the keys click on ground.
      if (key !== "Enter") {
        return;
      }
    }
    if (inField) {
      if (key === "Escape" && target.closest(".typed")) {
        this.design.drop();
        this.sheet.place.focus();
      }
      return;
    }
    if (key === "Tab") {
      return;
    }
    if (key === "F1" || key === "?") {
      event.preventDefault();
      this.help();
    } else if (key === "m" && event.altKey) {
      event.preventDefault();
      this.setMode(this.isDesign ? "motion" : "design");
    } else if (this.isDesign && target.closest?.("button, summary, a") && (key === " " || key === "Enter")) {
      return;
    } else if (this.isDesign) {
      const simple = {
        "+": () => this.sheet.zoom(1.25),
        "-": () => this.sheet.zoom(0.8),
        0: () => this.fit(),
        Home: () => this.fit(),
      }[key];
      if (simple && !this.design.found.length) {
        simple();
      } else if (this.design.key(event)) {
        event.preventDefault();
      }
    }
  }

  fileMenu(event) {
    const box = event.currentTarget.getBoundingClientRect();
    this.menu.open(
      [
        { label: "New", act: () => this.begin() },
        { label: "Open a file …", act: () => this.find(".opened").click() },
        { label: "Drafts …", act: () => this.chooseDraft() },
        ...(this.disk && !this.ownDisk ? [{ label: `Back to ${this.disk.name}`, act: () => this.backToDisk() }] : []),
        { label: "Templates …", act: () => this.chooseTemplate() },
        { label: "Background picture …", act: () => this.find(".pictured").click() },
        ...(this.background.image
          ? [
              { label: "Scale of the picture …", act: () => this.background.askScale() },
              { label: "Remove the picture", act: () => this.background.remove() },
            ]
          : []),
        "Save",
        { label: "Mechanism file (TOML)", key: "Ctrl+S", act: () => saveFile(this) },
        { label: "FMU", key: "Ctrl+E", act: () => exportFmu(this) },
        { label: "Picture (SVG)", act: () => saveDrawing(this, "svg"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "Picture (PNG)", act: () => saveDrawing(this, "png"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "Drawing for the workshop (DXF)", act: () => saveMade(this, "dxf", "image/vnd.dxf"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "Linkage (.linkage2)", act: () => saveMade(this, "linkage2", "application/xml"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "FreeCAD, OndselSolver (.asmt)", act: () => saveMade(this, "asmt", "text/plain"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "Moving picture (GIF)", act: () => saveMade(this, "gif", "image/gif"), why: this.sheet.svg ? "" : "Nothing is drawn" },
        { label: "Video (MP4 or WebM)", act: () => saveVideo(this), why: this.sheet.svg ? (videoKind() ? "" : "This browser records none") : "Nothing is drawn" },
        { label: "Copy a web link", act: () => shareLink(this) },
        "",
        { label: "First mechanism, step by step", act: () => this.guide.begin() },
        { label: "Help", key: "F1", act: () => this.help() },
      ],
      [box.left, box.bottom + 2],
    );
  }

  async begin() {
    if (await this.mayLeave()) {
      this.open({ name: "mechanism.toml", text: EMPTY });
    }
  }

  async chooseTemplate() {
    const name = await openWindow(this.root, "Templates", (form, close) => {
      const list = add(form, "div", { className: "templates" });
      for (const template of this.templates) {
        const button = add(list, "button", { type: "button" });
        add(button, "div", { className: "picture" });
        add(button, "strong", { textContent: template.name });
        add(button, "span", { textContent: template.description });
        button.addEventListener("click", () => close(template.name));
      }
      buttonRow(form, ["Cancel", ""]);
      this.pictureAll(list, this.templates);
    });
    const template = this.templates.find((each) => each.name === name);
    if (template && (await this.mayLeave())) {
      this.open({ name: `${template.name}.toml`, text: template.text, files: template.files });
    }
  }

  /** Draws mechanisms as their places in a list come into view. */
  pictureAll(list, mechanisms) {
    const places = [...list.children];
    const watcher = new IntersectionObserver((entries) => {
      for (const { target } of entries.filter((entry) => entry.isIntersecting)) {
        watcher.unobserve(target);
        setTimeout(() => {
          const mechanism = mechanisms[places.indexOf(target)];
          const { name, text, files } = mechanism;
          mechanism.picture ??= this.ask({ do: "svg", name, text, files }).svg ?? "";
          showPicture(target.querySelector(".picture"), mechanism.picture);
        });
      }
    });
    places.forEach((place) => watcher.observe(place));
  }

  /** Returns the file that the page's address holds, which leaves the address; null for none. */
  async fileOfAddress() {
    if (!location.hash.startsWith("#m=")) {
      return null;
    }
    const file = await fileOfLink().catch(() => null);
    history.replaceState(null, "", location.pathname + location.search);
    if (!file) {
      this.say("The link is not whole: its end is missing, or a program has changed it. Copy all of it");
    }
    return file;
  }

  /** Opens the link that was put into the address of this page. */
  async openLink() {
    const file = await this.fileOfAddress();
    if (file && (await this.mayLeave())) {
      this.open(file);
    }
  }

  async openFiles(files) {
    const picture = files.find((file) => file.type.startsWith("image/"));
    if (picture) {
      this.background.open(picture);
      return;
    }
    const other = files.find((file) => /\.(asmt|linkage2|json|dxf|pmks|txt)$/i.test(file.name));
    if (other) {
      if (!(await this.mayLeave())) {
        return;
      }
      const imported = await importFile(this, other);
      if (imported) {
        this.open(imported);
        showNotes(this, other.name, imported.notes);
      }
      return;
    }
    if (files.some((file) => !this.missingTables.includes(file.name)) && !(await this.mayLeave())) {
      return;
    }
    const texts = await Promise.all(files.map(async (file) => /** @type {[string, string]} */ ([file.name, await file.text()])));
    const main = texts.find(([name]) => name.toLowerCase().endsWith(".toml"));
    const missing = texts.filter(([name]) => this.missingTables.includes(name));
    if (!main && missing.length) {
      const { draft, history } = this;
      this.open({ ...draft, ...this.file, text: this.fileText, history, files: [...this.file.files, ...missing] }, false);
      return;
    }
    if (!main) {
      this.say("Open a mechanism file, `.toml`, together with the tables that it names, or a file of another program: `.asmt`, `.linkage2`, `.json`, `.dxf`");
      return;
    }
    this.open({ name: main[0], text: main[1], files: texts.filter((each) => each !== main) });
  }

  help() {
    openWindow(this.root, "Drawing a mechanism", (form) => {
      const list = add(form, "ol");
      for (const step of [
        "Draw **links**: click both ends. On a pin the link joins; with Ctrl the end is a pivot on ground.",
        "Fix points to **ground** with *Pivot*, or let them slide with *Slider*.",
        "Add a **driver** at a pin or slider: it is the FMU's input.",
        "Choose **Motion** and pull: the mechanism moves. *Export FMU* takes it along.",
      ]) {
        add(list, "li", { textContent: byKeys(step.replaceAll("*", "")) });
      }
      const keys = add(form, "dl", { className: "keys-list" });
      const told = [
        ...Object.values(TOOLS).flatMap((tool) => (tool.label ? [[keyName(tool), tool.label]] : [])),
        ["Shift", "without grid and directions; dragging the bare sheet selects in a box"],
        ["digits", "the length of what is drawn"],
        ["arrows, Enter", "move on the sheet and click, with Ctrl on ground"],
        ["PageUp, PageDown", "go to the point before, to the next one"],
        ["Esc", "give up; then Select"],
        ["Delete", "remove what is selected"],
        ["Ctrl+D, F2", "duplicate, rename what is selected"],
        ["wheel, dragging", "zoom, move the bare sheet"],
        ["click on a length", "set it, or make it a parameter by a name"],
        ["right click", "all that can be done with a thing"],
        ["click in Motion", "path and speed of a point"],
        ["Ctrl+Z, Ctrl+Y", "undo, redo"],
        ["0", "show all"],
        ["Alt+M", "Design or Motion"],
      ];
      for (const [key, text] of told) {
        add(keys, "dt", { textContent: byKeys(key) });
        add(keys, "dd", { textContent: text });
      }
      buttonRow(form, ["Close", ""]);
    });
  }
}

/** Returns place and insertion of the one change that makes another text of a text. */
function changeOf(before, after) {
  let from = 0;
  const least = Math.min(before.length, after.length);
  while (from < least && before[from] === after[from]) {
    from += 1;
  }
  let end = 0;
  while (end < least - from && before[before.length - 1 - end] === after[after.length - 1 - end]) {
    end += 1;
  }
  return [from, before.length - end, after.slice(from, after.length - end)];
}

/** Returns the name of a mechanism file. */
function nameIn(text) {
  return text.match(/^name\s*=\s*"([A-Za-z0-9_]+)"/m)?.[1] ?? "mechanism";
}

/** Returns a message as a sentence. */
function sentence(text) {
  return text && text[0].toUpperCase() + text.slice(1);
}

let studio;

async function begin() {
  const root = document.querySelector(".studio");
  const given = JSON.parse(document.getElementById("studio-data").textContent);
  const module = await WebAssembly.compile(await unpack("live-solver").arrayBuffer());
  studio = new Studio(root, module, given.parts, given.templates);
  studio.schema = given.schema;
  root.studio = studio;
  studio.open(await firstFile(studio, given));
  root.classList.add("ready");
}

/** Returns what a page begins with: what its tab has shown last, else the file on the disk, a link or the latest draft. */
async function firstFile(studio, given) {
  const { drafts } = studio;
  studio.server = given.place ?? "";
  const { id, server } = drafts.shown;
  const linked = await studio.fileOfAddress();
  const shown = id && (server === studio.server || !given.place) ? drafts.get(id) : null;
  if (!given.place) {
    return linked ?? shown ?? drafts.all()[0] ?? { name: "mechanism.toml", text: EMPTY };
  }
  const disk = new Disk(given, () => studio.keepDraft());
  studio.disk = disk;
  const file = studio.fileOfDisk(given.file);
  const other = linked ?? (shown?.id === disk.id ? null : shown);
  if (other && file.text !== disk.written) {
    // Changes of the file that nobody has written are written behind another drawing, too.
    disk.write(file.text);
  }
  return other ?? file;
}

begin().catch((error) => {
  /** @type {HTMLElement} */
  const place = document.querySelector(".studio .failed");
  place.hidden = false;
  place.textContent = `This browser cannot run the studio: ${error.message}`;
  throw error;
});
