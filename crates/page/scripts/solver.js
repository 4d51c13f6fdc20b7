// @ts-check
// The solver, compiled to WebAssembly: requests and answers in JSON, numbers without copying.

/** The solver has ended by a defect of its own; its instance is not to be used any more. */
export class Broken extends Error {}

/** Returns bytes of base64. */
export function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** Returns what has been through a stream that packs or unpacks. */
export function through(stream, bytes) {
  return new Response(new Blob([bytes]).stream().pipeThrough(stream));
}

/** Unpacks base64 of gzip. */
export function unzipped(base64) {
  return through(new DecompressionStream("gzip"), bytesOf(base64));
}

/** Unpacks what an element of the page holds as base64 of gzip. */
export function unpack(id) {
  return unzipped(document.getElementById(id).textContent.trim());
}

export class Solver {
  /** @param {WebAssembly.Module} module */
  constructor(module) {
    // A library in the studio's solver asks for random numbers, which archives do not need.
    const imports = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module)) {
      imports[from] ??= {};
      imports[from][name] = () => {
        throw new Error(`the solver has no ${name}`);
      };
    }
    /** @type {any} */
    this.exports = new WebAssembly.Instance(module, imports).exports;
  }

  /**
   * Sends a request and returns its answer.
   * @param {import("./messages").PageRequest | import("./messages").StudioRequest | import("./messages").ExportRequest} request
   */
  ask(request) {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    return this.guard(() => {
      const at = this.exports.biela_input(bytes.length);
      // Made after the call, which may move the memory.
      new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
      return JSON.parse(this.text(this.exports.biela_answer()));
    });
  }

  /** Moves a driver; false if the mechanism stops before the value. */
  drive(driver, value) {
    return this.guard(() => this.exports.biela_drive(driver, value) === 1);
  }

  /** The numbers of the picture, until the next call. */
  get frame() {
    const { biela_frame, biela_frame_length, memory } = this.exports;
    return new Float64Array(memory.buffer, biela_frame(), biela_frame_length());
  }

  text(length) {
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.biela_output(), length);
    return new TextDecoder().decode(bytes);
  }

  guard(call) {
    // Whoever asks again gets the reason, not what follows from it.
    if (this.failure) {
      throw this.failure;
    }
    try {
      return call();
    } catch (error) {
      // A stack that overflows is an error of the browser.
      if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) {
        const message = this.text(this.exports.biela_output_length());
        this.failure = new Broken(message || String(error));
        throw this.failure;
      }
      throw error;
    }
  }
}
