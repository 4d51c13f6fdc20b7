// Completion in a mechanism file, with the schema that the program prints: `node --test tests/studio`.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

import { completions } from "../../crates/studio/scripts/complete.js";

const root = fileURLToPath(new URL("../../", import.meta.url));
const built = ["release", "debug"].map((profile) => `${root}target/${profile}/biela`);
const program = process.env.BIELA_BIN ?? built.find((path) => existsSync(path));
assert.ok(program, "build the program first: `make build`");
const schema = JSON.parse(execFileSync(program, ["schema"], { encoding: "utf8" }));

const names = {
  markers: ["ground.O2", "ground.O4", "crank.O", "crank.A", "coupler.A"],
  bodies: ["crank", "coupler"],
  parameters: ["crank_length", "base"],
  joints: ["O2", "A"],
  drivers: ["crank_angle"],
  measures: ["travel"],
};

/** Completes where the text has a bar. */
function at(text) {
  const offset = text.indexOf("|");
  const plain = text.replace("|", "");
  const found = completions(plain, offset, schema, names);
  const labels = found?.options.map(({ label }) => label) ?? [];
  const accept = (label) => {
    const option = found.options.find((one) => one.label === label);
    const { apply = label, caret = apply.length } = option;
    const [before, after] = [plain.slice(0, found.from), plain.slice(option.to ?? found.to)];
    return `${before}${apply.slice(0, caret)}|${apply.slice(caret)}${after}`;
  };
  return { found, labels, accept };
}

test("an empty file offers the keys of the whole, required ones first", () => {
  const { labels } = at("|");
  assert.deepEqual(labels.slice(0, 2), ["format", "name"]);
  assert.ok(!labels.includes("joints"), "tables have headers");
});

test("keys that are there are left out, before the caret and behind it", () => {
  assert.ok(!at('format = 1\n|\nname = "a"').labels.some((label) => label === "format" || label === "name"));
  const { labels } = at("[bodies.crank]\nmass = 1\n|\ninertia = 2\n[joints]\n");
  assert.ok(!labels.includes("mass") && !labels.includes("inertia") && labels.includes("center"));
});

test("a key has its meaning, and says if it is required", () => {
  const { found } = at("[drivers]\na = { | }");
  const coordinate = found.options.find(({ label }) => label === "coordinate");
  assert.equal(coordinate.detail, "required");
  assert.match(coordinate.info, /measured from marker i to marker j/);
});

test("a key comes with the start of its value, and the caret in it", () => {
  assert.equal(at("[joints]\nA = { ty| }").accept("type"), '[joints]\nA = { type = "|" }');
  assert.equal(
    at('[joints]\nA = { type = "link", | }').accept("markers"),
    '[joints]\nA = { type = "link", markers = ["|", ""] }',
  );
  assert.equal(at("[bodies.b]\n|").accept("mass"), "[bodies.b]\nmass = |");
  assert.equal(at("[bodies.b]\n|").accept("estimate"), "[bodies.b]\nestimate = [|]");
  assert.equal(at("[bodies.b]\n|").accept("markers"), "[bodies.b]\nmarkers = { | }");
  assert.equal(at("[outputs]\n|").accept("markers"), '[outputs]\nmarkers = ["|"]');
});

test("a key that has its value is replaced alone", () => {
  assert.equal(at("[bodies.b]\nma|ss = 1").accept("mass"), "[bodies.b]\nmass| = 1");
});

test("headers are offered behind a bracket, without those that are there", () => {
  const { labels } = at("[joints]\n[|");
  assert.ok(labels.includes("drivers") && labels.includes("bodies.") && labels.includes("ground.markers"));
  assert.ok(!labels.includes("joints") && !labels.includes("name"));
});

test("a header ends with its bracket, which may be there", () => {
  assert.equal(at("[dri|").accept("drivers"), "[drivers]|");
  assert.equal(at("[bo|").accept("bodies."), "[bodies.|");
  assert.equal(at("[dri|]").accept("drivers"), "[drivers]|");
  assert.equal(at("[bo|]").accept("bodies."), "[bodies.|]");
  assert.equal(at("[ground.|]").accept("markers"), "[ground.markers]|");
});

test("a header of a body goes on to its markers and shapes", () => {
  assert.deepEqual(at("[bodies.crank]\nmass = 1\n[bodies.|").labels, ["crank."]);
  assert.deepEqual(at("[bodies.crank]\nmass = 1\n[bodies.crank.|").labels, ["markers", "shapes"]);
});

test("the type of a joint decides its keys", () => {
  assert.deepEqual(at("[joints]\nA = { | }").labels, ["type"]);
  assert.ok(at('[joints]\nA = { type = "cam", | }').labels.includes("profile"));
  assert.ok(!at('[joints]\nA = { type = "revolute", | }').labels.includes("profile"));
  assert.ok(at('[joints]\nA = { |, type = "gear" }').labels.includes("teeth"), "also one behind the caret");
});

test("types of joints are offered with their meaning", () => {
  const { found, accept } = at('[joints]\nA = { type = "|" }');
  assert.equal(found.options.length, schema.properties.joints.additionalProperties.properties.type.enum.length);
  assert.match(found.options.find(({ label }) => label === "revolute").info, /two points coincide/);
  assert.equal(accept("revolute"), '[joints]\nA = { type = "revolute"| }');
});

test("a word is completed in quotes where there are none", () => {
  assert.equal(at("[drivers]\na = { coordinate = | }").accept("angle"), '[drivers]\na = { coordinate = "angle"| }');
  assert.equal(at("[drivers]\na = { coordinate = an|").accept("angle"), '[drivers]\na = { coordinate = "angle"|');
});

test("a text that is not closed loses nothing behind the caret", () => {
  const { accept } = at('[drivers]\na = { coordinate = "an|, markers = ["ground.O2", "crank.O"] }');
  assert.equal(accept("angle"), '[drivers]\na = { coordinate = "angle"|, markers = ["ground.O2", "crank.O"] }');
});

test("texts in single quotes keep them", () => {
  assert.equal(at("[drivers]\na = { coordinate = 'an|' }").accept("angle"), "[drivers]\na = { coordinate = 'angle'| }");
});

test("true and false are offered for a switch, one number for a constant", () => {
  assert.deepEqual(at("[parameters]\na = { value = 1, tunable = | }").labels, ["true", "false"]);
  assert.deepEqual(at("format = |").labels, ["1"]);
});

test("markers of a pair are on different bodies", () => {
  assert.deepEqual(at('[joints]\nA = { type = "revolute", markers = ["|"').labels, names.markers);
  assert.deepEqual(at('[joints]\nA = { type = "revolute", markers = ["crank.A", "|"] }').labels, [
    "ground.O2",
    "ground.O4",
    "coupler.A",
  ]);
  assert.deepEqual(at('[joints]\nA = { type = "revolute", markers = ["|", "crank.A"] }').labels, [
    "ground.O2",
    "ground.O4",
    "coupler.A",
  ]);
});

test("markers of a list are offered once each", () => {
  const { labels } = at('[outputs]\nmarkers = ["crank.A", "|"]');
  assert.deepEqual(labels, ["ground.O2", "ground.O4", "crank.O", "coupler.A"]);
});

test("a marker is completed as a whole, over its dot", () => {
  assert.equal(
    at('[drivers]\na = { markers = ["ground.O2", "crank.|"] }').accept("crank.A"),
    '[drivers]\na = { markers = ["ground.O2", "crank.A"|] }',
  );
  assert.equal(
    at("[drivers]\na = { markers = [gro|] }").accept("ground.O2"),
    '[drivers]\na = { markers = ["ground.O2"|] }',
  );
});

test("names are those of what is meant", () => {
  assert.deepEqual(at('[outputs]\nbodies = ["crank", "|"]').labels, ["coupler"]);
  assert.deepEqual(at('[outputs]\nreactions = ["|"]').labels, names.joints);
  assert.deepEqual(at('[friction]\nf = { joint = "|" }').labels, names.joints);
  assert.deepEqual(at('[stops]\ns = { of = "|" }').labels, ["crank_angle", "travel"]);
  assert.deepEqual(at('[joints]\ng = { type = "gear", carrier = "|" }').labels, ["ground", "crank", "coupler"]);
});

test("a formula has parameters, then constants, then functions", () => {
  const { labels, accept } = at('[bodies.b]\nestimate = [0, "cr|/2", 0]');
  assert.equal(labels[0], "crank_length");
  assert.ok(labels.indexOf("deg") < labels.indexOf("sin"));
  assert.equal(accept("crank_length"), '[bodies.b]\nestimate = [0, "crank_length|/2", 0]');
  assert.equal(at('[bodies.b]\nmass = "2*s|"').accept("sqrt"), '[bodies.b]\nmass = "2*sqrt(|)"');
});

test("a unit follows a number times", () => {
  assert.equal(at('[bodies.b]\nestimate = [0, 0, "60*|"]').labels[0], "deg");
  assert.equal(at('[bodies.b]\nestimate = [0, 0, "60*d|"]').accept("deg"), '[bodies.b]\nestimate = [0, 0, "60*deg|"]');
});

test("nothing follows a number at once", () => {
  assert.equal(at('[bodies.b]\nmass = "60|"').found, null);
  assert.equal(at('[bodies.b]\nmass = "60d|"').found, null);
  assert.equal(at("[bodies.b]\nmass = 60|").found, null);
});

test("variables are those of the key", () => {
  assert.equal(at('[drivers]\na = { motion = "|" }').labels[0], "t");
  assert.equal(at('[joints]\na = { type = "cam", profile = "|" }').labels[0], "theta");
  assert.deepEqual(at('[forces]\na = { coordinate = "angle", value = "|" }').labels.slice(0, 3), [
    "t",
    "position",
    "velocity",
  ]);
  assert.deepEqual(at('[joints]\na = { type = "coupling", equation = "|" }').labels.slice(0, 2), [
    "crank_angle",
    "travel",
  ]);
});

test("a parameter is not offered for itself", () => {
  assert.ok(!at('[parameters]\nbase = "|"').labels.includes("base"));
  assert.ok(at('[parameters]\nother = { value = "|" }').labels.includes("base"));
});

test("of two keys that exclude each other one is offered", () => {
  const { labels } = at("[drivers]\na = { motion = { table = [[0, 0]], | } }");
  assert.ok(labels.includes("law") && !labels.includes("file"));
  assert.ok(!at("[drivers]\na = { start = 0, | }").labels.includes("motion"));
});

test("keys that are there tell the kind of a measure", () => {
  assert.ok(!at('[measures]\nm = { coordinate = "x", | }').labels.includes("unit"));
  assert.ok(at('[measures]\nm = { value = "1", | }').labels.includes("unit"));
});

test("comments, names of one's own and keys without an equals sign offer nothing", () => {
  for (const text of ["# ty|", "format = 1 # [|", "[joints]\nA|", "[joints]\nA |", "[parameters]\nb|", 'name = "a|"']) {
    assert.equal(at(text).found, null, text);
  }
});

test("lines below close what a half-written line left open", () => {
  assert.ok(at('[joints]\nA = { type = "revolute", markers = [\n[simulation]\n|').labels.includes("stop"));
  assert.ok(at('[joints]\nA = { type = "\nB = { type = "|" }').labels.includes("revolute"));
  assert.ok(at("[bodies.\n[simulation]\n|").labels.includes("stop"));
});

test("arrays and inline tables over several lines are one value", () => {
  assert.deepEqual(at('[joints]\nA = {\n  type = "revolute",\n  markers = [\n    "crank.A",\n    "|"\n  ]\n}').labels, [
    "ground.O2",
    "ground.O4",
    "coupler.A",
  ]);
  assert.ok(at('[joints]\nA = {\n  type = "gear",\n  |\n}').labels.includes("radii"));
});

test("constants and functions are those of the program", () => {
  const reserved = new Set(schema.properties.parameters.propertyNames.not.enum);
  const others = ["ground", "solver", "rates", "extrapolation", "energy", "time", "t", "position", "velocity"];
  const { found } = at('[bodies.b]\nmass = "|"');
  const offered = found.options.filter(({ type }) => type !== "variable").map(({ label }) => label);
  assert.deepEqual([...offered, ...others].sort(), [...reserved].sort());
});

test("no place of any mechanism, cut off there or not, fails", () => {
  const folder = `${root}mechanisms/`;
  const files = readdirSync(folder).filter((file) => file.endsWith(".toml"));
  assert.ok(files.length > 40);
  let offered = 0;
  for (const file of files) {
    const text = readFileSync(folder + file, "utf8");
    for (let offset = 0; offset <= text.length; offset += 37) {
      for (const part of [text, text.slice(0, offset)]) {
        const found = completions(part, offset, schema, names);
        if (found) {
          offered += 1;
          assert.ok(found.from <= offset && offset <= found.to && found.to <= part.length, `${file} ${offset}`);
        }
      }
    }
  }
  assert.ok(offered > 1000);
});

test("each key in an inline table of a mechanism is offered where it stands", () => {
  const known = new Set();
  const learn = (part) => {
    for (const key of Object.keys(part.properties ?? {})) {
      known.add(key);
    }
    Object.values(part)
      .filter((one) => one && typeof one === "object")
      .forEach(learn);
  };
  learn(schema);
  let seen = 0;
  for (const file of readdirSync(`${root}mechanisms`).filter((file) => file.endsWith(".toml"))) {
    // Markers have names of their own, and comments none.
    const text = readFileSync(`${root}mechanisms/${file}`, "utf8").replaceAll(/#.*|^markers = \{.*/gm, "");
    for (const { 0: whole, 1: key, index } of text.matchAll(/[{,][ \t]*([a-z_]+)(?=[ \t]*=)/g)) {
      if (known.has(key)) {
        seen += 1;
        const found = completions(text, index + whole.length, schema, names);
        assert.ok(
          found?.options.some(({ label }) => label === key),
          `${file}: ${key} at ${index}`,
        );
      }
    }
  }
  assert.ok(seen > 1000, `${seen} keys`);
});
