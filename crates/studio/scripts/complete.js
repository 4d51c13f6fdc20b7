// Completion in a mechanism file: keys and words from its JSON Schema, names from the file. The
// text may be half written.

import { caretIn, valueAt } from "./caret.js";

const FORMULA_CONSTANTS = {
  deg: "degree",
  mm: "millimetre",
  cm: "centimetre",
  inch: "25.4 mm",
  rpm: "turn per minute",
  pi: "3.14159…",
};

const FORMULA_FUNCTIONS = [
  ..."sin cos tan asin acos atan atan2 sinh cosh tanh exp sqrt ln log10 hypot".split(" "),
  ..."abs sign floor ceil mod min max".split(" "),
];

// Variables of a formula, by its key.
const FORMULA_VARIABLES = {
  motion: () => ["t"],
  profile: () => ["theta"],
  law: () => ["x"],
  value: ([section]) => (section === "forces" ? ["t", "position", "velocity"] : []),
  torque: () => ["t"],
};

// Names that a text may be, by its key.
const NAMES_BY_KEY = {
  bodies: ["bodies"],
  carrier: ["ground", "bodies"],
  reactions: ["joints"],
  joint: ["joints"],
  of: ["drivers", "measures"],
};

/**
 * Returns `{ from, to, options }` for the caret at `offset`, or null. An option has `label`,
 * `type` and, where they say more, `detail`, `info`, `apply` (the text to insert), `caret` (a place in
 * that, where one goes on) and a `to` of its own. `names` has the file's `markers`, `bodies`, `parameters`,
 * `joints`, `drivers` and, if known, `measures`.
 */
export function completions(text, offset, schema, names) {
  const place = caretIn(text, offset);
  if (!place) {
    return null;
  }
  const finder = { header: headersAt, key: keysAt, value: valuesAt, text: textsAt }[place.kind];
  const found = finder({ ...place, document: text, offset, schema, names });
  return found?.options.length ? { from: place.from, to: place.to, ...found } : null;
}

// The completions at the caret.

function headersAt({ document, parts, root, to, schema }) {
  const table = valueAt(root, parts);
  const options = [];
  const isClosed = document[to] === "]";
  // A name with a dot behind it goes on; otherwise the header ends, and a bracket that is there is passed.
  const offer = (label, info, goesOn = false) => {
    const option = { label, type: "namespace", ...(info && { info }) };
    options.push(
      goesOn
        ? { ...option, apply: label, caret: label.length }
        : { ...option, apply: `${label}]`, ...(isClosed && { to: to + 1 }) },
    );
  };
  for (const shape of schemasAt(schema, parts, root)) {
    for (const [name, value] of Object.entries(shape.properties ?? {})) {
      const [first] = alternativesOf(value, undefined, schema).filter(isTable);
      if (!first) {
        continue;
      }
      const info = value.description ?? first.description;
      const named = first.additionalProperties;
      if (typeof named === "object") {
        if (tablesIn(named, schema).length) {
          offer(`${name}.`, info, true);
        }
        if (!valueAt(table, [name])?.isHeader) {
          offer(name, info);
        }
        continue;
      }
      const below = tablesIn(first, schema).map((inner) => [name, inner]);
      for (const path of below.length ? below : [[name]]) {
        if (!valueAt(table, path)?.isHeader) {
          offer(path.join("."), info);
        }
      }
    }
    // Things that are there may have tables of their own: markers of a body.
    if (typeof shape.additionalProperties === "object" && tablesIn(shape.additionalProperties, schema).length) {
      for (const name of table?.entries?.keys() ?? []) {
        offer(`${name}.`, undefined, true);
      }
    }
  }
  return { options };
}

// Keys of a table that are tables.
function tablesIn(shape, schema) {
  const properties = alternativesOf(shape, undefined, schema).flatMap((one) => Object.entries(one.properties ?? {}));
  return properties
    .filter(([, value]) => alternativesOf(value, undefined, schema).every(isTable))
    .map(([name]) => name);
}

function keysAt({ document, path, root, table, from, to, schema }) {
  const typed = document.slice(from, to);
  const hasValue = /^[ \t]*=/.test(document.slice(to));
  const present = table?.entries ?? new Map();
  const options = new Map();
  for (const shape of schemasAt(schema, path, root)) {
    const rivals = shape.oneOf?.flatMap(({ required }) => required) ?? [];
    const isChosen = rivals.some((rival) => present.has(rival) && rival !== typed);
    for (const [name, value] of Object.entries(shape.properties ?? {})) {
      const inner = alternativesOf(value, undefined, schema);
      // Tables of the whole file have headers.
      const isSection = path.length === 0 && inner.some(isTable);
      const isThere = present.has(name) && name !== typed;
      if (isThere || options.has(name) || isSection || (isChosen && rivals.includes(name))) {
        continue;
      }
      const { opening, caret } = valueStart(inner, schema);
      const written = hasValue ? {} : { apply: `${name} = ${opening}`, caret: name.length + 3 + caret };
      const info = value.description ?? inner.find(({ description }) => description)?.description;
      const detail = shape.required?.includes(name) ? { detail: "required" } : {};
      options.set(name, { label: name, type: "property", ...detail, ...(info && { info }), ...written });
    }
  }
  const rank = ({ label, detail }) => (detail ? 0 : label === "description" ? 2 : 1);
  return { options: [...options.values()].sort((one, other) => rank(one) - rank(other)) };
}

// The text with which a value begins, and the caret in it.
function valueStart(alternatives, schema) {
  const isText = (value) => alternativesOf(value, undefined, schema).every((one) => one.enum || one.type === "string");
  const [first] = alternatives;
  // A number is simpler than a table.
  if (!first || alternatives.some(isNumber)) {
    return { opening: "", caret: 0 };
  }
  if (first.type === "array") {
    const items = first.prefixItems ?? [first.items ?? {}];
    return items.every(isText)
      ? { opening: `[${items.map(() => '""').join(", ")}]`, caret: 2 }
      : { opening: "[]", caret: 1 };
  }
  if (isTable(first)) {
    return { opening: "{  }", caret: 2 };
  }
  return isText(first) ? { opening: '""', caret: 1 } : { opening: "", caret: 0 };
}

function valuesAt(place) {
  const options = [];
  for (const shape of schemasAt(place.schema, place.path, place.root)) {
    if (shape.type === "boolean") {
      options.push(...["true", "false"].map((label) => ({ label, type: "keyword" })));
    }
    if ("const" in shape) {
      options.push({ label: JSON.stringify(shape.const), type: "constant" });
    }
  }
  const quoted = wordsAt(place).map((option) => ({ ...option, apply: JSON.stringify(option.label) }));
  return { options: [...options, ...quoted] };
}

function textsAt(place) {
  const { document, path, root, schema, offset, quote } = place;
  if (keyOf(path) === "equation" || schemasAt(schema, path, root).some(isNumber)) {
    return formulaAt(place);
  }
  // Each option is the whole text, and passes its closing quote. Of a text that is not closed, only
  // the word at the caret is replaced.
  const end = offset + /^[\w./]*/.exec(document.slice(offset))[0].length;
  return {
    to: document.startsWith(quote, end) ? end + quote.length : end,
    options: wordsAt(place).map((option) => ({ ...option, apply: option.label + quote })),
  };
}

// Texts that a value may be: words, and names in the file.
function wordsAt(place) {
  const { path, root, schema, names, array } = place;
  const alternatives = schemasAt(schema, path, root);
  const listed = alternatives.flatMap((shape) => shape.enum ?? []);
  if (listed.length) {
    const { meanings } = schemasAt(schema, path.slice(0, -1), root).find((shape) => shape.meanings) ?? {};
    return listed.map((label) => ({ label, type: "enum", ...(meanings?.[label] && { info: meanings[label] }) }));
  }
  const variables = (labels) => [...new Set(labels)].map((label) => ({ label, type: "variable" }));
  if (alternatives.some(({ ref }) => ref === "marker")) {
    return variables(markersAt(place));
  }
  const sources = alternatives.some(({ pattern }) => pattern) ? (NAMES_BY_KEY[keyOf(path)] ?? []) : [];
  const found = sources.flatMap((source) => (source === "ground" ? source : (names[source] ?? [])));
  const taken = otherTexts(array);
  return variables(found.filter((name) => !taken.includes(name) && (name !== "ground" || sources.includes("ground"))));
}

// The two markers of a pair are on different bodies.
function markersAt({ path, root, schema, names, array }) {
  const bodyOf = (marker) => marker.split(".")[0];
  const [list] = typeof path.at(-1) === "number" ? schemasAt(schema, path.slice(0, -1), root) : [];
  const taken = otherTexts(array);
  const bodies = list?.prefixItems ? taken.map(bodyOf) : [];
  return (names.markers ?? []).filter((marker) => !taken.includes(marker) && !bodies.includes(bodyOf(marker)));
}

// Texts of an array without the one at the caret.
function otherTexts(array) {
  return (array?.items ?? []).filter((item, index) => index !== array.caret && item?.text).map(({ text }) => text);
}

function formulaAt({ document, path, names, root, schema, from, offset }) {
  const before = document.slice(from, offset);
  const typed = /[A-Za-z_]\w*$/.exec(before)?.[0] ?? "";
  const ahead = before.slice(0, before.length - typed.length);
  if (/[\w.]$/.test(ahead)) {
    return null;
  }
  const key = keyOf(path);
  const hasCoordinates = key === "equation" || (path[0] === "measures" && key === "value");
  const found = [
    ...(FORMULA_VARIABLES[key]?.(path) ?? []),
    ...(hasCoordinates ? [...(names.drivers ?? []), ...(names.measures ?? [])] : []),
    ...(names.parameters ?? []),
  ];
  // Nothing is defined by itself.
  const variables = found.filter((name) => name !== path[1]).map((label) => ({ label, type: "variable" }));
  const listed = schemasAt(schema, path, root)
    .flatMap((shape) => shape.enum ?? [])
    .map((label) => ({ label, type: "enum" }));
  const constants = Object.entries(FORMULA_CONSTANTS).map(([label, detail]) => ({ label, type: "constant", detail }));
  const functions = FORMULA_FUNCTIONS.map((label) => ({
    label,
    type: "function",
    apply: `${label}()`,
    caret: label.length + 1,
  }));
  // A number times is followed by its unit.
  const isUnit = /\d\.?\s*\*\s*$/.test(ahead);
  const to = offset + /^\w*/.exec(document.slice(offset))[0].length;
  return {
    from: offset - typed.length,
    to,
    options: isUnit
      ? [...constants, ...variables, ...functions]
      : [...listed, ...variables, ...constants, ...functions],
  };
}

// The schema.

const keyOf = (path) => path.findLast((step) => typeof step === "string");
const isTable = (shape) => shape.type === "object" || Boolean(shape.properties);
const isNumber = (shape) => shape.ref === "number";

/** Returns the schemas of what stands under a path, as far as they go with what is written there. */
function schemasAt(schema, path, root) {
  let found = alternativesOf(schema, root, schema);
  path.forEach((step, depth) => {
    const value = valueAt(root, path.slice(0, depth + 1));
    const inside = found.map((shape) =>
      typeof step === "number"
        ? (shape.prefixItems?.[step] ?? shape.items)
        : (shape.properties?.[step] ?? shape.additionalProperties),
    );
    found = inside.filter((one) => typeof one === "object").flatMap((one) => alternativesOf(one, value, schema));
  });
  return found;
}

/**
 * Returns the alternatives of a schema, without references and conditions, that go with a value.
 * Where a word decides on the others, `meanings` says what each word means.
 */
function alternativesOf(schema, value, root) {
  const { $ref, anyOf, allOf, ...rest } = schema;
  if ($ref) {
    const ref = $ref.split("/").at(-1);
    return [{ ...root.$defs[ref], ...rest, ref }];
  }
  if (anyOf) {
    const all = anyOf.flatMap((one) => alternativesOf(one, value, root));
    const present = [...(value?.entries?.keys() ?? [])];
    const fits = all.filter(
      (shape) => shape.additionalProperties !== false || present.every((key) => key in shape.properties),
    );
    return fits.length ? fits : all;
  }
  if (!allOf) {
    return [rest];
  }
  const meanings = {};
  let chosen = rest;
  for (const { if: condition, then } of allOf) {
    const [[key, { const: word }]] = Object.entries(condition.properties);
    meanings[word] = then.description;
    if (value?.entries?.get(key)?.text === word) {
      // The choice itself stands outside of the branches.
      chosen = { ...then, properties: { ...then.properties, ...rest.properties } };
    }
  }
  return [{ ...chosen, meanings }];
}
