// The text editor of the studio. Places are offsets in UTF-16 units, as in JavaScript's strings.

import {
  autocompletion,
  closeBrackets,
  closeBracketsKeymap,
  pickedCompletion,
  startCompletion,
} from "@codemirror/autocomplete";
import { defaultKeymap } from "@codemirror/commands";
import { bracketMatching, indentUnit, syntaxTree } from "@codemirror/language";
import { lintGutter, nextDiagnostic, previousDiagnostic, setDiagnostics } from "@codemirror/lint";
import { search, searchKeymap } from "@codemirror/search";
import { Annotation, Compartment, EditorState, StateEffect, StateField } from "@codemirror/state";
import {
  Decoration,
  EditorView,
  drawSelection,
  dropCursor,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
} from "@codemirror/view";

import { FLASH_TIME, dark, light, look } from "./look.js";
import { toml } from "./toml.js";

/** Marks what the page does, not the user. */
const byPage = Annotation.define();

/** Makes a field of highlighted ranges, and the effect whose function gives others for them. */
function highlights() {
  const change = StateEffect.define();
  const field = StateField.define({
    create: () => Decoration.none,
    update: (shown, { changes, effects }) =>
      effects.reduce((all, effect) => (effect.is(change) ? effect.value(all) : all), shown.map(changes)),
    provide: (field) => EditorView.decorations.from(field),
  });
  return { change, field };
}

const marked = highlights();
const flashed = highlights();
const mark = Decoration.mark({ class: "cm-marked" });
// By turns, for the animation begins again with another element only.
const flashes = [0, 1].map((turn) => Decoration.mark({ class: `cm-flash cm-flash-${turn}` }));

/**
 * Makes an editor in an element, which decides its height. The page keeps the history:
 * `undo` and `redo` say that the user asks for it.
 *
 * - `onChange(text, { from, to, insert, event })`: the user has replaced a range; `event` tells
 *   typing from deleting and pasting: `input.type`, `delete.backward`, `input.paste`
 * - `onCursor(offset)`: the user has moved the caret
 * - `complete(text, offset)`: returns `{ from, to?, options: [{ label, detail?, type?, info?,
 *   apply?, caret?, to? }] }` or null; `caret` is a place in `apply`, where completion goes on
 */
export function makeEditor(parent, { onChange, onCursor, complete, undo = () => {}, redo = () => {}, label } = {}) {
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  const palette = new Compartment();
  const hooks = { historyUndo: undo, historyRedo: redo };
  const shades = () => (scheme.matches ? dark : light);

  const listen = EditorView.updateListener.of(({ state, changes, docChanged, transactions }) => {
    const ours = transactions.filter((transaction) => !transaction.annotation(byPage));
    if (docChanged && ours.length) {
      onChange?.(String(state.doc), { ...span(changes, state.doc), event: eventOf(ours[0]) });
    }
    if (ours.some((transaction) => transaction.selection || transaction.docChanged)) {
      onCursor?.(state.selection.main.head);
    }
  });

  const extensions = () => [
    palette.of(shades()),
    look,
    toml,
    indentUnit.of("  "),
    // Offsets are those of the page's text, whatever its line ends.
    EditorState.lineSeparator.of("\n"),
    EditorView.clipboardInputFilter.of((text) => text.replace(/\r\n?/g, "\n")),
    EditorState.allowMultipleSelections.of(true),
    EditorView.lineWrapping,
    EditorView.contentAttributes.of({ "aria-label": label ?? "Text" }),
    lintGutter(),
    lineNumbers(),
    drawSelection(),
    dropCursor(),
    highlightActiveLine(),
    highlightActiveLineGutter(),
    bracketMatching(),
    EditorView.inputHandler.of(plain),
    EditorView.inputHandler.of(passOver),
    closeBrackets(),
    search({ top: true }),
    autocompletion({ override: [completions(complete)], icons: false }),
    marked.field,
    flashed.field,
    EditorView.domEventHandlers({
      keydown: (event) => call(hooks[historyKey(event)], event),
      // Menus and phones ask for it without a key.
      beforeinput: (event) => call(hooks[event.inputType], event),
    }),
    keymap.of([
      { key: "Space", run: spread },
      { key: "F8", run: nextDiagnostic, shift: previousDiagnostic },
      ...closeBracketsKeymap,
      ...searchKeymap,
      ...defaultKeymap,
    ]),
    listen,
  ];

  const view = new EditorView({ parent, state: EditorState.create({ extensions: extensions() }) });
  const shade = () => view.dispatch({ effects: palette.reconfigure(shades()) });
  scheme.addEventListener("change", shade);
  const within = (place) => Math.max(0, Math.min(place, view.state.doc.length));
  const rangeOf = ({ from, to }) => ({ from: within(from), to: within(Math.max(from, to)) });
  let turn = 0;
  let fading;

  return {
    get text() {
      return String(view.state.doc);
    },

    /** Puts a text in place of a range, which flashes; caret and scroll stay. */
    replace(from, to, insert) {
      const end = from + insert.length;
      const flash = flashes[(turn = 1 - turn)];
      view.dispatch({
        changes: { from, to, insert },
        effects: flashed.change.of((all) =>
          all.update({
            filter: (start, stop) => stop < from || start > end,
            add: insert ? [flash.range(from, end)] : [],
          }),
        ),
        annotations: byPage.of(true),
      });
      clearTimeout(fading);
      fading = setTimeout(() => view.dispatch({ effects: flashed.change.of(() => Decoration.none) }), FLASH_TIME);
    },

    /** Shows another document, from its start. */
    set(text) {
      clearTimeout(fading);
      view.setState(EditorState.create({ doc: text, extensions: extensions() }));
      view.scrollDOM.scrollTop = 0;
    },

    /** Shows problems in place of those before. Names in messages stand in back quotes. */
    problems(list) {
      const diagnostics = list.map(({ severity, message, help, ...range }) => ({
        ...rangeOf(range),
        severity,
        message: help ? `${message}\n${help}` : message,
        renderMessage: () => paragraphs(message, help),
      }));
      view.dispatch(setDiagnostics(view.state, diagnostics));
    },

    /** Selects a range and brings it into view. */
    show(from, to = from) {
      const range = rangeOf({ from, to });
      view.dispatch({
        selection: { anchor: range.from, head: range.to },
        annotations: byPage.of(true),
      });
      scrollTo(view, range);
    },

    /** Highlights ranges in place of those before. */
    mark(list) {
      const shown = list.map(rangeOf).filter(({ from, to }) => from < to);
      const decorations = Decoration.set(
        shown.map(({ from, to }) => mark.range(from, to)),
        true,
      );
      view.dispatch({ effects: marked.change.of(() => decorations) });
    },

    focus() {
      view.focus();
    },

    destroy() {
      clearTimeout(fading);
      scheme.removeEventListener("change", shade);
      view.destroy();
    },
  };
}

// A blank in empty braces makes one on each side: `{ | }`.
function spread({ state, dispatch }) {
  const { from, empty } = state.selection.main;
  if (!empty || state.sliceDoc(from - 1, from + 1) !== "{}") {
    return false;
  }
  dispatch(state.update({ changes: { from, insert: "  " }, selection: { anchor: from + 1 }, userEvent: "input.type" }));
  return true;
}

// Comments have no pairs.
function plain({ state, dispatch }, from, to, text) {
  if (!/^[[({"']$/.test(text) || syntaxTree(state).resolveInner(from, -1).name !== "comment") {
    return false;
  }
  dispatch(state.update(state.replaceSelection(text), { userEvent: "input.type" }));
  return true;
}

// A typed quote or bracket passes the one behind the caret, where none is missing: that of a
// completion too, which CodeMirror does not remember.
function passOver({ state, dispatch }, from, to, text) {
  const opening = { '"': '"', "]": "[", "}": "{" }[text];
  if (!opening || from !== to || state.selection.ranges.length > 1) {
    return false;
  }
  const line = state.doc.lineAt(from).text;
  const place = from - state.doc.lineAt(from).from;
  // `spread` has put a blank before a brace, which may have been typed again.
  const blanks = text === "}" ? /^ */.exec(line.slice(place))[0].length : 0;
  const count = (character, part = line) => part.split(character).length - 1;
  const isPaired = text === opening ? count(text) % 2 === 0 : count(opening) === count(text);
  const isClosing = text !== opening || count(text, line.slice(0, place)) % 2 === 1;
  if (line[place + blanks] !== text || !isPaired || !isClosing) {
    return false;
  }
  const isTwice = blanks > 0 && line[place - 1] === " ";
  dispatch(
    state.update({
      changes: isTwice ? { from, to: from + blanks } : undefined,
      selection: { anchor: from + (isTwice ? 0 : blanks) + 1 },
      userEvent: isTwice ? "input.type" : "select",
    }),
  );
  return true;
}

// With capitals locked, Shift makes the letter a small one.
function historyKey({ key, ctrlKey, metaKey, altKey, shiftKey }) {
  const letter = (ctrlKey || metaKey) && !altKey ? key.toLowerCase() : "";
  return { z: shiftKey ? "historyRedo" : "historyUndo", y: "historyRedo" }[letter];
}

// Neither the editor nor the page's own keys do it again.
function call(hook, event) {
  if (hook) {
    event.stopPropagation();
    hook();
  }
  return Boolean(hook);
}

// One range that covers all changes, and its new text.
function span(changes, doc) {
  let [from, to, end] = [Infinity, 0, 0];
  changes.iterChangedRanges((fromBefore, toBefore, _, toAfter) => {
    from = Math.min(from, fromBefore);
    [to, end] = [toBefore, toAfter];
  });
  return { from, to, insert: doc.sliceString(from, end) };
}

const EVENTS = [
  "input.type",
  "input.complete",
  "input.paste",
  "input.drop",
  "delete.backward",
  "delete.forward",
  "delete.cut",
  "move",
];

function eventOf(transaction) {
  return EVENTS.find((event) => transaction.isUserEvent(event)) ?? "input";
}

function completions(complete) {
  return (context) => {
    const answer = complete?.(String(context.state.doc), context.pos);
    if (!answer) {
      return null;
    }
    const typed = context.state.sliceDoc(answer.from, context.pos);
    const before = context.state.sliceDoc(answer.from - 1, answer.from);
    // Unasked it comes with a name's first letter, or in an opened text or header.
    if (!context.explicit && !typed && !/["'.[]/.test(before)) {
      return null;
    }
    // A word that is typed out needs no more keys: Enter ends the line.
    if (!context.explicit && answer.options.some(({ label, apply = label }) => apply === typed)) {
      return null;
    }
    const choices = answer.options.map((option, index) => {
      const to = option.to ?? answer.to ?? context.pos;
      return choice(option, index, Math.max(0, to - context.pos));
    });
    return { from: answer.from, options: choices };
  };
}

// An option of the page as CodeMirror has it. It replaces what is typed and so many characters
// behind the caret, which are not compared with its label.
function choice({ label, detail, type, apply, caret, info }, index, behind) {
  return {
    label,
    detail,
    type,
    // The page's order, not the alphabet's.
    sortText: String(index).padStart(6, "0"),
    info: info ? () => paragraphs(info) : undefined,
    apply(view, completion, from, to) {
      const insert = apply ?? label;
      view.dispatch({
        changes: { from, to: to + behind, insert },
        selection: { anchor: from + (caret ?? insert.length) },
        annotations: pickedCompletion.of(completion),
        scrollIntoView: true,
        userEvent: "input.complete",
      });
      if (caret !== undefined) {
        startCompletion(view);
      }
    },
  };
}

// A text whose names stand in back quotes, with a quieter one below.
function paragraphs(text, help) {
  const element = document.createElement("div");
  say(element, text);
  if (help) {
    const below = element.appendChild(document.createElement("span"));
    below.className = "cm-help";
    say(below, help);
  }
  return element;
}

function say(element, text) {
  text.split("`").forEach((part, index) => {
    if (index % 2) {
      element.appendChild(document.createElement("code")).textContent = part;
    } else {
      element.append(part);
    }
  });
}

// Heights of lines that were never shown are estimates: the last bit goes without gliding.
function scrollTo(view, { from, to }) {
  const scroller = view.scrollDOM;
  const { top, bottom } = view.lineBlockAt(from);
  const end = Math.max(bottom, Math.min(view.lineBlockAt(to).bottom, top + scroller.clientHeight / 2));
  const settle = () => {
    const place = Math.min(from, view.state.doc.length);
    view.dispatch({ effects: EditorView.scrollIntoView(place, { y: "nearest", yMargin: 20 }) });
  };
  if (top >= scroller.scrollTop && end <= scroller.scrollTop + scroller.clientHeight) {
    settle();
    return;
  }
  // Not at the end of a later scroll, which is the user's.
  scroller.addEventListener("scrollend", settle, { once: true, signal: AbortSignal.timeout(1000) });
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  scroller.scrollTo({ top: top - scroller.clientHeight / 3, behavior: still ? "instant" : "smooth" });
}
