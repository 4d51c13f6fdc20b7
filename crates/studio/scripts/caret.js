// The place of the caret in a TOML text that may be half written.

const TOKENS = {
  space: /[ \t\r]+/y,
  comment: /#[^\n]*/y,
  text: /"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:[^"\\\n]|\\[^\n])*"?|'[^'\n]*'?/y,
  key: /[\w-]+/y,
  word: /[^\s,=#"'[\]{}]+/y,
  // Lines with which something new begins, whatever was left open before.
  header: /[ \t]*\[\[?[ \t]*[A-Za-z_]/y,
  entry: /[A-Za-z_][\w.-]*[ \t]*=/y,
};

const emptyTable = () => ({ entries: new Map(), isHeader: false });

/**
 * Returns where the caret is: in a `header`, at a `key`, at a `value` or in a `text`, with the
 * `path` of it, the `from` and `to` of what is typed there, and the values of the whole file as far
 * as they can be told.
 */
export function caretIn(text, offset) {
  const root = emptyTable();
  let frames = [{ kind: "", value: root, path: [], mode: "key", parts: [] }];
  let header = null;
  let caret;
  let at = 0;

  const match = (pattern) => {
    pattern.lastIndex = at;
    return pattern.exec(text)?.[0];
  };
  const put = (value) => {
    const frame = frames.at(-1);
    if (frame.kind === "[") {
      frame.value.items[frame.index] = value;
    } else if (frame.parts.length) {
      tableAt(frame.value, frame.parts.slice(0, -1)).entries?.set(frame.parts.at(-1), value);
    }
    frame.mode = "after";
  };
  const pathOf = (frame) => [...frame.path, ...(frame.kind === "[" ? [frame.index] : frame.parts)];
  const see = (from, to, more = {}) => {
    const frame = frames.at(-1);
    if (header) {
      caret = { kind: "header", parts: [...header], root, from, to };
    } else if (frame.mode === "key" && !more.kind && (!frame.parts.length || /\.[ \t]*$/.test(text.slice(0, from)))) {
      const table = tableAt(frame.value, frame.parts);
      caret = { kind: "key", path: pathOf(frame), table, root, from, to };
    } else if (frame.mode === "value") {
      const array = frame.kind === "[" ? frame.value : undefined;
      if (array) {
        array.caret = frame.index;
      }
      caret = { kind: "value", path: pathOf(frame), array, root, from, to, ...more };
    } else {
      caret = null;
    }
  };

  const enter = () => {
    const value = tableAt(root, header);
    value.isHeader = true;
    frames = [{ kind: "", value, path: header, mode: "after", parts: [] }];
    header = null;
  };

  while (at <= text.length) {
    if (at === 0 || text[at - 1] === "\n") {
      if (header) {
        enter();
      }
      if (frames.length > 1 && (match(TOKENS.header) || match(TOKENS.entry))) {
        frames = frames.slice(0, 1);
      }
      if (frames.length === 1) {
        Object.assign(frames[0], { mode: "key", parts: [] });
      }
    }
    const frame = frames.at(-1);
    const isKey = header || frame.mode === "key";
    const space = match(TOKENS.space);
    const comment = space ? undefined : match(TOKENS.comment);
    const quoted = space || comment ? undefined : match(TOKENS.text);
    const word = space || comment || quoted ? undefined : match(isKey ? TOKENS.key : TOKENS.word);
    const token = space ?? comment ?? quoted ?? word ?? text.slice(at, at + 1);
    const end = at + token.length;
    const isInside = at < offset && offset < end;
    if (caret === undefined) {
      if (comment && at < offset && offset <= end) {
        caret = null;
      } else if (quoted && at < offset) {
        const [quote] = /^(?:"""|'''|"|')/.exec(token);
        const isClosed = token.length >= 2 * quote.length && token.endsWith(quote);
        if (offset < end || (offset === end && !isClosed)) {
          see(Math.min(at + quote.length, offset), offset, { kind: "text", quote });
        }
      } else if (word && at < offset && offset <= end) {
        see(at, end);
      } else if (offset === at || isInside) {
        see(offset, word ? end : offset);
      }
    }
    if (!token) {
      break;
    }
    at = end;
    if (space || comment || token === "\n") {
      continue;
    }
    const name = quoted ? quoted.replace(/^(["']{3}|["'])([^]*?)\1?$/, "$2") : word;
    if (header) {
      if (name !== undefined) {
        header.push(name);
      } else if (token === "]") {
        enter();
      }
    } else if (name !== undefined) {
      if (frame.mode === "key") {
        frame.parts.push(name);
      } else if (frame.mode === "value") {
        put({ text: name });
      }
    } else if (token === "[" && !frame.kind && frame.mode === "key" && !frame.parts.length) {
      header = [];
    } else if ((token === "[" || token === "{") && frame.mode === "value") {
      const path = pathOf(frame);
      const value = token === "[" ? { items: [] } : emptyTable();
      put(value);
      frames.push({ kind: token, value, path, mode: token === "[" ? "value" : "key", parts: [], index: 0 });
    } else if (token === "]" || token === "}") {
      if (frame.kind === (token === "]" ? "[" : "{")) {
        frames.pop();
      }
    } else if (token === "=" && frame.kind !== "[") {
      frame.mode = "value";
    } else if (token === "," && frame.kind) {
      Object.assign(frame, { mode: frame.kind === "[" ? "value" : "key", parts: [], index: frame.index + 1 });
    }
  }
  return caret ?? null;
}

// The table under a path; those that are not there yet are made.
function tableAt(table, path) {
  return path.reduce((value, step) => {
    const inner = value.entries?.get(step) ?? emptyTable();
    value.entries?.set(step, inner);
    return inner;
  }, table);
}

/** Returns the value under a path of keys and places in arrays, undefined if there is none. */
export function valueAt(root, path) {
  return path.reduce(
    (value, step) => (typeof step === "number" ? value?.items?.[step] : value?.entries?.get(step)),
    root,
  );
}
