// TOML for highlighting: keys in inline tables too. A header, and a key at the start of a line, end
// what a half-written line left open.

import { StreamLanguage, indentService } from "@codemirror/language";

const HEADER = /^\s*\[\[?\s*[A-Za-z_]/;
const ENTRY = /^[A-Za-z_][\w.-]*\s*=/;
const VALUE = /^(?:true|false)(?![\w-])/;
const NUMBER = /^[+-]?(?:0[xob][\da-fA-F_]+|inf|nan|\d[\d_:.TZz+-]*(?:[eE][+-]?[\d_]+)?|\.\d+)/;

// `open` has the open brackets, `text` the quotes of a text over several lines, `key` says that
// a key is next, `header` that the line is a table's header.
const start = () => ({ open: "", text: "", key: true, header: false });

function token(stream, state) {
  if (stream.sol() && !state.text) {
    if (stream.match(HEADER, false)) {
      Object.assign(state, start(), { header: true });
    } else if (!state.open || stream.match(ENTRY, false)) {
      Object.assign(state, start());
    }
  }
  if (state.text) {
    return rest(stream, state);
  }
  if (stream.eatSpace()) {
    return null;
  }
  const isKey = state.header || state.key;
  const name = state.header ? "heading" : isKey ? "propertyName" : "string";
  if (stream.match(/^(?:"""|''')/)) {
    state.text = stream.current();
    return rest(stream, state);
  }
  if (stream.match(/^"(?:[^"\\]|\\.)*"?/) || stream.match(/^'[^']*'?/)) {
    return name;
  }
  if (isKey && stream.match(/^[\w-]+/)) {
    return name;
  }
  if (stream.match(VALUE)) {
    return "bool";
  }
  if (stream.match(NUMBER)) {
    return "number";
  }
  const character = stream.next();
  if (character === "#") {
    stream.skipToEnd();
    return "comment";
  }
  if (!state.header) {
    follow(character, state);
  }
  return "[]{}".includes(character) ? "bracket" : "punctuation";
}

function follow(character, state) {
  if (character === "[" || character === "{") {
    state.open += character;
    state.key = character === "{";
  } else if (character === "]" || character === "}") {
    state.open = state.open.slice(0, -1);
    state.key = false;
  } else if (character === "=") {
    state.key = false;
  } else if (character === ",") {
    state.key = state.open.endsWith("{");
  }
}

// The rest of a text over several lines, as far as it is in this line.
function rest(stream, state) {
  while (!stream.eol()) {
    if (stream.match(state.text)) {
      state.text = "";
      break;
    }
    if (stream.next() === "\\" && state.text === '"""') {
      stream.next();
    }
  }
  return "string";
}

// A new line keeps the indentation of the one before; behind an open bracket it goes in.
const indentation = indentService.of((context, place) => {
  if (context.simulatedBreak === null) {
    return null;
  }
  const line = context.state.doc.lineAt(place);
  const text = line.text.slice(0, place - line.from);
  const width = /^\s*/.exec(text)[0].length;
  return /[[{(]\s*$/.test(text) ? width + context.unit : width;
});

export const toml = [
  StreamLanguage.define({
    name: "toml",
    startState: start,
    copyState: (state) => ({ ...state }),
    token,
    languageData: { commentTokens: { line: "#" } },
  }),
  indentation,
];
