// Starts the mechanisms of a page.

import { Live } from "./live.js";
import { unpack } from "./solver.js";

async function start() {
  const module = await WebAssembly.compile(await unpack("live-solver").arrayBuffer());
  for (const root of document.querySelectorAll(".live")) {
    const file = JSON.parse(root.querySelector(".live-file").textContent);
    root.live = new Live(root, module, file);
    root.classList.add("ready");
  }
}

start().catch((error) => {
  for (const place of document.querySelectorAll(".live .problems")) {
    place.hidden = false;
    place.textContent = `This browser cannot run the solver: ${error.message}`;
  }
  throw error;
});
