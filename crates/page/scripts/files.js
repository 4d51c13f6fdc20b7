// @ts-check
// Saving: the mechanism's file, pictures, values.

import { csv } from "./chart.js";

/** Lets the browser save a file. */
export function save(name, kind, content) {
  const url = URL.createObjectURL(new Blob([content], { type: kind }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/**
 * Connects the buttons of class `save`, whose values name the kinds of files.
 * @param {import("./live.js").Live} live
 */
export function connectSaving(root, live) {
  const savers = {
    toml: () => {
      const answer = live.ask({ do: "text" });
      if (answer?.text) {
        save(`${live.page.name}.toml`, "application/toml", answer.text);
      }
    },
    svg: () => save(`${live.page.name}.svg`, "image/svg+xml", live.ask({ do: "diagram" }).svg),
    png: () => savePng(live),
    csv: () => {
      const all = live.page.variables.map((_, index) => index);
      const data = live.chart.values(all);
      save(`${live.page.name}.csv`, "text/csv", csv(live.page, live.chart.axis, all, data));
    },
  };
  for (const button of root.querySelectorAll("button.save")) {
    button.addEventListener("click", () => savers[button.value]());
  }
}

// Twice as large as on the screen, so that it can be printed.
async function savePng(live) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(live.ask({ do: "diagram" }).svg)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((content) => save(`${live.page.name}.png`, "image/png", content), "image/png");
}
