// Links that hold a mechanism: its file and tables, packed into the fragment of an address.

import { bytesOf, through } from "./solver.js";

/** Returns base64 of bytes. */
export async function base64Of(bytes) {
  const url = await new Promise((done) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    reader.readAsDataURL(new Blob([bytes]));
  });
  return url.slice(url.indexOf(",") + 1);
}

/** Returns the address of a studio with a mechanism in it. */
export async function linkTo(studio, { name, text, files }) {
  const content = JSON.stringify([name, text, files]);
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(content)).arrayBuffer();
  const word = (await base64Of(packed)).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
  return `${studio}#m=${word}`;
}

/** Returns the file that the page's address holds, or null. */
export async function fileOfLink() {
  const word = location.hash.match(/^#m=([A-Za-z0-9_-]+)$/)?.[1];
  if (!word) {
    return null;
  }
  const packed = bytesOf(word.replaceAll("-", "+").replaceAll("_", "/"));
  const [name, text, files] = await through(new DecompressionStream("deflate-raw"), packed).json();
  return { name: String(name), text: String(text), files };
}
