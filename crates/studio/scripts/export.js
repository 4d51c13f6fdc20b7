// @ts-check
// The ways out of the studio: the FMU, the file, pictures, a link.

import { add, say, shown } from "./controls.js";
import { buttonRow, openWindow } from "./dialogs.js";
import { save } from "./files.js";
import { base64Of, linkTo } from "./link.js";
import { bytesOf, unzipped } from "./solver.js";

// Longest link that common programs keep whole [letters].
const LONGEST_LINK = 8000;

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
  return unzipped(globalThis.bielaParts[name]).arrayBuffer();
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
  studio.takeFields();
  save(`${studio.name}.toml`, "application/toml", studio.fileText);
  studio.saved();
}

/** Returns what the solver makes of the mechanism: `kind` is `dxf` or `gif`. */
function made(studio, kind) {
  return studio.ask({ do: kind, ...studio.file, text: studio.fileText });
}

/** Saves what the solver makes of the mechanism. */
export function saveMade(studio, kind, type) {
  const answer = made(studio, kind);
  if (answer?.content) {
    save(`${studio.name}.${kind}`, type, bytesOf(answer.content));
  }
  studio.say([answer?.problems, ...(answer?.notes ?? [])].filter(Boolean).join("; "));
}

// Kinds of videos that browsers record, the most widely read first.
const VIDEOS = [
  ["video/mp4", "mp4"],
  ["video/webm", "webm"],
];

/** The kind of video that this browser records, with its ending; undefined if it records none. */
export function videoKind() {
  const records = globalThis.MediaRecorder && globalThis.ImageDecoder;
  return records && VIDEOS.find(([kind]) => MediaRecorder.isTypeSupported(kind));
}

/** Saves the motion as a video, which takes as long as it lasts. */
export async function saveVideo(studio) {
  const answer = made(studio, "gif");
  if (!answer?.content) {
    studio.say(answer?.problems ?? "");
    return;
  }
  const [kind, ending] = videoKind();
  try {
    const video = await record(bytesOf(answer.content), kind, (seconds) =>
      studio.say(`Recording the motion, ${shown(seconds, 2)} s …`),
    );
    save(`${studio.name}.${ending}`, kind, video);
    studio.say(`Saved \`${studio.name}.${ending}\``);
  } catch (error) {
    studio.say(`This browser has not recorded the video: ${error.message}`);
  }
}

/** Returns a moving GIF as a video of a kind; `begun` is told how long it takes [s]. */
async function record(gif, kind, begun) {
  const film = new ImageDecoder({ data: gif, type: "image/gif" });
  await film.tracks.ready;
  await film.completed;
  const count = film.tracks.selectedTrack.frameCount;
  const { image: first } = await film.decode({ frameIndex: 0 });
  const canvas = document.createElement("canvas");
  // Encoders want even sides.
  [canvas.width, canvas.height] = [first.displayWidth, first.displayHeight].map((side) => side + (side % 2));
  const brush = canvas.getContext("2d");
  brush.fillStyle = "#fff";
  brush.fillRect(0, 0, canvas.width, canvas.height);
  const duration = first.duration;
  first.close();
  const recorder = new MediaRecorder(canvas.captureStream(), { mimeType: kind, videoBitsPerSecond: 5e6 });
  const parts = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  recorder.start();
  begun((count * duration) / 1e6);
  for (let frameIndex = 0; frameIndex < count; frameIndex += 1) {
    const { image } = await film.decode({ frameIndex });
    brush.drawImage(image, 0, 0);
    await new Promise((done) => setTimeout(done, image.duration / 1e3));
    image.close();
  }
  await new Promise((done) => {
    recorder.onstop = done;
    recorder.stop();
  });
  return new Blob(parts);
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

/** Shows in a list what did not come over from a file, or came over changed. */
export function showNotes(studio, name, notes) {
  if (!notes.length) {
    studio.say("");
    return;
  }
  openWindow(studio.root, `Notes on ${name}`, (form) => {
    const list = add(form, "ul", { className: "notes" });
    for (const note of notes) {
      add(list, "li", { textContent: note });
    }
    buttonRow(form, ["Close", ""]);
  });
}

/** Copies the link, or shows it. */
export async function shareLink(studio) {
  const file = { ...studio.file, text: studio.fileText };
  const link = await linkTo(location.href.split("#")[0], file);
  try {
    await navigator.clipboard.writeText(link);
    const long = link.length > LONGEST_LINK ? `; with ${link.length} letters it is too long for some programs` : "";
    const where = location.protocol === "file:" ? "; it opens on this computer alone, unlike one of a studio on a web server" : "";
    studio.say(`The link is copied: whoever opens it has this mechanism${long}${where}`);
  } catch {
    await openWindow(studio.root, "Link", (form) => {
      add(form, "textarea", { value: link, rows: 6, readOnly: true }).select();
      buttonRow(form, ["Close", ""]);
    });
  }
}
