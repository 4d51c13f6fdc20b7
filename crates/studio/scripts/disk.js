// @ts-check
// The file on the disk that `biela studio FILE` keeps in step.

// Time until a server that does not answer is asked again [ms].
const AGAIN = 2000;

export class Disk {
  /**
   * `given` is what the server has told of the file; `tell` is called when there is something to say.
   * @param {{ token: string, version: string, place: string, file: { name: string, text: string } }} given
   */
  constructor(given, tell) {
    this.tell = tell;
    this.id = `disk.${given.place}`;
    this.name = given.file.name;
    this.take(given);
    this.wanted = this.written;
    // The reason why the file was not written, "" for none; `changed` by another program.
    this.trouble = "";
    this.changed = false;
  }

  /** Takes what the server tells of the file. */
  take({ token, version, file }) {
    this.token = token;
    this.version = version;
    this.written = file.text;
  }

  /** Whether the file has not all that is drawn. */
  get waits() {
    return this.wanted !== null && this.wanted !== this.written;
  }

  /** Writes no more: another page goes on with the drawing of this file. */
  leave() {
    this.wanted = null;
    [this.trouble, this.changed] = ["", false];
  }

  /** Writes a text, now or when the server answers again. */
  async write(text) {
    this.wanted = text;
    if (this.busy || this.changed) {
      this.tell();
      return;
    }
    clearTimeout(this.again);
    this.busy = true;
    while (this.waits && !this.changed && (await this.put(this.wanted)));
    this.busy = false;
    if (this.waits && !this.changed) {
      this.again = setTimeout(() => this.write(this.wanted), AGAIN);
    }
    this.tell();
  }

  /** Sends a text; true if it was written. */
  async put(body, renewed = false) {
    try {
      const headers = { "X-Biela-Token": this.token, "X-Biela-Version": this.version };
      // A page that is closed still sends what is short.
      const answer = await fetch("file", { method: "PUT", headers, body, keepalive: body.length < 15_000 });
      const said = await answer.text();
      if (answer.ok) {
        [this.written, this.version, this.trouble] = [body, said, ""];
        return true;
      }
      // Another server may have started in its place, with another token; what was written may have come
      // there without an answer, or from another page.
      if (answer.status === 403 || answer.status === 409) {
        const now = await this.ask();
        if (!renewed && [body, this.written].includes(now.file.text)) {
          this.take(now);
          return await this.put(body, true);
        }
        this.changed = true;
      }
      this.trouble = this.changed ? "another program has changed it on the disk" : said;
    } catch (error) {
      const isGone = error instanceof TypeError;
      this.trouble = isGone ? "`biela studio` does not answer. What you draw waits in this browser until it runs again" : error.message;
    }
    return false;
  }

  /** Asks the server for the file as it is. */
  async ask() {
    const answer = await fetch("file");
    if (!answer.ok) {
      throw new Error(await answer.text());
    }
    return answer.json();
  }

  /** Goes on from the file as it is on the disk; returns it. */
  async renew() {
    const now = await this.ask();
    this.take(now);
    [this.trouble, this.changed] = ["", false];
    return now.file;
  }
}
