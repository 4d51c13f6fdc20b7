// The ways out of the studio: the FMU, the file, pictures, a link.

import { add, say } from "./controls.js";
import { buttonRow, openWindow } from "./dialogs.js";
import { save } from "./files.js";

// Longest link that common programs keep whole [letters].
const LONGEST_LINK = 8000;

/** Returns bytes of base64. */
function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** Returns base64 of bytes. */
async function base64Of(bytes) {
  const url = await new Promise((done) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    reader.readAsDataURL(new Blob([bytes]));
  });
  return url.slice(url.indexOf(",") + 1);
}

/** Loads what a script beside the page holds as base64 of gzip. */
async function loadPart(name) {
  globalThis.bielaParts ??= {};
  if (!globalThis.bielaParts[name]) {
    await new Promise((done, failed) => {
      const script = add(document.head, "script", { src: `parts/${name}.js` });
      script.onload = done;
      script.onerror = () => failed(new Error(`parts/${name}.js is missing beside this page`));
    });
  }
  const packed = new Blob([bytesOf(globalThis.bielaParts[name])]);
  return new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** Writes the FMU of a file; `platforms` name the libraries that go into it. */
export async function makeFmu(studio, { fmi, platforms, page }) {
  const libraries = [];
  for (const platform of platforms) {
    libraries.push([platform, await base64Of(await loadPart(platform))]);
  }
  const solver = page && studio.parts.includes("page") ? await base64Of(await loadPart("page")) : undefined;
  const { name, files } = studio.file;
  const answer = studio.ask({ do: "export", name, text: studio.fileText, files, fmi, libraries, page: solver });
  if (!answer?.content) {
    throw new Error(answer?.problems ?? "the solver has failed");
  }
  return bytesOf(answer.content);
}

/** Asks how the FMU shall be, and saves it. */
export async function exportFmu(studio) {
  const fields = {};
  const platforms = studio.parts.filter((part) => part !== "page");
  const state = studio.view.status?.state;
  const answer = await openWindow(studio.root, "Export FMU", (form) => {
    if (state !== "driven" && state !== "free") {
      say(add(form, "p", { className: "warning" }), `Not ready yet: ${studio.view.status?.text ?? ""}`);
    }
    const choice = add(form, "fieldset");
    add(choice, "legend", { textContent: "Version" });
    for (const [fmi, text] of [["2", "FMI 2.0, for most hosts"], ["3", "FMI 3.0"]]) {
      const label = add(choice, "label");
      const radio = add(label, "input", { type: "radio", name: "fmi", value: fmi, checked: fmi === "2" });
      label.append(` ${text}`);
      fields[fmi] = radio;
    }
    const on = add(form, "fieldset");
    add(on, "legend", { textContent: "Platforms" });
    fields.platforms = platforms.map((platform) => {
      const label = add(on, "label");
      const box = add(label, "input", { type: "checkbox", value: platform, checked: true });
      label.append(` ${platform}`);
      return box;
    });
    if (platforms.length === 0) {
      add(on, "p", { className: "warning", textContent: "This studio has no runtime library: `make runtimes` builds them." });
    }
    buttonRow(form, ["Export", "export"], ["Cancel", ""]);
  });
  if (answer !== "export") {
    return;
  }
  const chosen = fields.platforms.filter((box) => box.checked).map((box) => box.value);
  studio.say("Writing the FMU …");
  try {
    const fmu = await makeFmu(studio, { fmi: fields["3"].checked ? "3" : "2", platforms: chosen, page: true });
    save(`${studio.name}.fmu`, "application/zip", fmu);
    studio.say(`Saved \`${studio.name}.fmu\`: ${(fmu.length / 1e6).toFixed(1)} MB for ${chosen.join(", ")}`);
  } catch (error) {
    studio.say(error.message);
  }
}

/** Saves the mechanism file. */
export function saveFile(studio) {
  save(`${studio.name}.toml`, "application/toml", studio.fileText);
}

/** Saves what the solver makes of the mechanism: `kind` is `dxf` or `gif`. */
export function saveMade(studio, kind, type) {
  const { name, files } = studio.file;
  const answer = studio.ask({ do: kind, name, text: studio.fileText, files });
  if (answer?.content) {
    save(`${studio.name}.${kind}`, type, bytesOf(answer.content));
  }
  studio.say([answer?.problems, ...(answer?.notes ?? [])].filter(Boolean).join("; "));
}

/** Saves the drawing as SVG, or as PNG of twice its size. */
export async function saveDrawing(studio, kind) {
  const picture = studio.sheet.svg.cloneNode(true);
  const box = studio.sheet.svg.getBBox();
  const room = 24;
  const [width, height] = [box.width + 2 * room, box.height + 2 * room];
  for (const [key, value] of Object.entries({
    xmlns: SVG,
    viewBox: `${box.x - room} ${box.y - room} ${width} ${height}`,
    width,
    height,
    style: "background: #fff",
  })) {
    picture.setAttribute(key, value);
  }
  picture.querySelectorAll(".arrows, .covered").forEach((part) => part.remove());
  const svg = new XMLSerializer().serializeToString(picture);
  if (kind === "svg") {
    save(`${studio.name}.svg`, "image/svg+xml", svg);
    return;
  }
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * width, 2 * height];
  const brush = canvas.getContext("2d");
  brush.fillStyle = "#fff";
  brush.fillRect(0, 0, canvas.width, canvas.height);
  brush.drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((content) => save(`${studio.name}.png`, "image/png", content), "image/png");
}

/** Reads a mechanism of another program; returns a file, or says why not. */
export async function importFile(studio, file) {
  const content = await base64Of(await file.arrayBuffer());
  const answer = studio.ask({ do: "import", name: file.name, content });
  if (!answer?.text) {
    studio.say(`${file.name}: ${answer?.problems ?? "the solver has failed"}`);
    return null;
  }
  return { name: answer.name, text: answer.text, files: [], notes: answer.notes };
}

// -- links ------------------------------------------------------------------------------------

async function through(stream, bytes) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

/** Returns a link that holds the mechanism. */
export async function linkOf(studio) {
  const content = JSON.stringify([studio.file.name, studio.fileText, studio.file.files]);
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(content));
  const word = (await base64Of(packed)).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
  return `${location.href.split("#")[0]}#m=${word}`;
}

/** Returns the file that the page's address holds, or null. */
export async function fileOfLink() {
  const word = location.hash.match(/^#m=([A-Za-z0-9_-]+)$/)?.[1];
  if (!word) {
    return null;
  }
  const packed = bytesOf(word.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = await through(new DecompressionStream("deflate-raw"), packed);
  const [name, text, files] = JSON.parse(new TextDecoder().decode(bytes));
  return { name: String(name), text: String(text), files };
}

/** Copies the link, or shows it. */
export async function shareLink(studio) {
  const link = await linkOf(studio);
  try {
    await navigator.clipboard.writeText(link);
    const long = link.length > LONGEST_LINK ? `; with ${link.length} letters it is too long for some programs` : "";
    studio.say(`The link is copied: whoever opens it has this mechanism${long}`);
  } catch {
    await openWindow(studio.root, "Link", (form) => {
      add(form, "textarea", { value: link, rows: 6, readOnly: true }).select();
      buttonRow(form, ["Close", ""]);
    });
  }
}
