// Prints the licences of the packages inside the bundle of scripts/editor.sh, from the folder in
// which it was built: each package with its version and its text, a text of several once.

import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const LINE = "-".repeat(80);
const work = process.argv[2];

const { outputs } = JSON.parse(readFileSync(join(work, "inside.json"), "utf8"));
const files = Object.values(outputs).flatMap(({ inputs }) =>
  Object.entries(inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0),
);
const names = files.map(([file]) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file)?.[1]);
const texts = new Map();
for (const name of [...new Set(names.filter(Boolean))].sort()) {
  const folder = join(work, "node_modules", name);
  const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const file = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  if (license !== "MIT" || !file) {
    throw new Error(`${name} is under ${license}, with the text ${file}: decide whether it may be inside`);
  }
  const lines = readFileSync(join(folder, file), "utf8").trim().split(/\r?\n/);
  const text = lines.map((line) => line.trimEnd()).join("\n");
  texts.set(text, [...(texts.get(text) ?? []), `${name} ${version}`]);
}
const parts = [
  "The text editor of biela's studio contains the packages below, under their licences.",
  ...[...texts].map(([text, packages]) => `${packages.join(", ")}, MIT:\n\n${text}`),
];
process.stdout.write(`${parts.join(`\n\n${LINE}\n\n`)}\n`);
