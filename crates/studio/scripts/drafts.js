// @ts-check
// Drafts: the drawings that this browser keeps, each with its history and its picture. One that nobody has
// changed yet is kept for its tab alone.

const DRAFT = "biela.draft.";
const PICTURE = "biela.picture.";
// Name under which a tab keeps the draft that it shows.
const SHOWN = "biela.shown";
const UNITS = "biela.units";
// Names under which earlier studios kept their one drawing and its picture.
const [OLD, OLD_PICTURE] = ["biela.studio", "biela.studio.picture"];

/**
 * `changed` tells whether it was, `by` which page has it; `disk` is the text that the file on the disk is
 * known to have, `words` the text that was typed and that the solver could not take.
 * @typedef {{
 *   id: string, by?: string, at?: number, changed?: boolean, name: string, text: string, words?: string, disk?: string,
 *   files?: [string, string][], history?: import("../../page/scripts/messages").History,
 * }} Draft
 */

export class Drafts {
  constructor() {
    this.self = newId();
    this.moveOld();
  }

  /** The draft that this tab has shown last: its id, and the server that has shown it. */
  get shown() {
    return parsed(attempt(() => sessionStorage.getItem(SHOWN))) ?? {};
  }

  /**
   * Returns a draft, null if there is none. One that another tab has changed is no longer that of this tab.
   * @returns {Draft | null}
   */
  get(id) {
    return parsed(attempt(() => localStorage.getItem(DRAFT + id) ?? sessionStorage.getItem(DRAFT + id)));
  }

  /**
   * Returns all drafts that were changed, the latest first.
   * @returns {Draft[]}
   */
  all() {
    const keys = attempt(() => Object.keys(localStorage)) ?? [];
    const drafts = keys.filter((key) => key.startsWith(DRAFT)).map((key) => this.get(key.slice(DRAFT.length)));
    return drafts.filter((draft) => draft?.text).sort((a, b) => (b.at ?? 0) - (a.at ?? 0));
  }

  /**
   * Keeps a draft as the one that this tab shows. Where another page has it meanwhile, that one keeps its
   * own, and this becomes another draft. Returns the id of the draft.
   * @param {Draft} draft
   */
  keep(draft, server = "", claims = false) {
    const by = this.get(draft.id)?.by;
    const id = claims || by === undefined || by === this.self ? draft.id : newId();
    const content = JSON.stringify({ ...draft, id, by: this.self, at: Date.now() });
    const [place, other] = draft.changed ? [localStorage, sessionStorage] : [sessionStorage, localStorage];
    place.setItem(DRAFT + id, content);
    other.removeItem(DRAFT + id);
    sessionStorage.setItem(SHOWN, JSON.stringify({ id, server }));
    if (id !== draft.id) {
      this.keepPicture(id, this.picture(draft.id));
    }
    return id;
  }

  /** Keeps a draft of the file on the disk under another name, where that file begins anew. */
  setAside(id) {
    const draft = this.get(id);
    const picture = this.picture(id);
    this.remove(id);
    if (draft?.changed) {
      const other = newId();
      localStorage.setItem(DRAFT + other, JSON.stringify({ ...draft, id: other, disk: undefined }));
      this.keepPicture(other, picture);
    }
  }

  remove(id) {
    for (const key of [DRAFT + id, PICTURE + id]) {
      attempt(() => localStorage.removeItem(key));
      attempt(() => sessionStorage.removeItem(key));
    }
  }

  /** Returns what was kept of a draft's picture. */
  picture(id) {
    return parsed(attempt(() => localStorage.getItem(PICTURE + id)));
  }

  /** Keeps a picture of a draft, none without one. */
  keepPicture(id, picture) {
    if (picture) {
      localStorage.setItem(PICTURE + id, JSON.stringify(picture));
    } else {
      attempt(() => localStorage.removeItem(PICTURE + id));
    }
  }

  /** The units that the user has chosen; null for none. */
  get units() {
    return parsed(attempt(() => localStorage.getItem(UNITS)));
  }

  keepUnits(units) {
    attempt(() => localStorage.setItem(UNITS, JSON.stringify(units)));
  }

  /** Makes a draft of the drawing that an earlier studio has kept. */
  moveOld() {
    const old = parsed(attempt(() => localStorage.getItem(OLD)));
    if (!old?.text) {
      return;
    }
    attempt(() => {
      const id = newId();
      this.keepPicture(id, parsed(localStorage.getItem(OLD_PICTURE)));
      localStorage.setItem(DRAFT + id, JSON.stringify({ ...old, id, changed: true, at: Date.now() }));
      localStorage.removeItem(OLD);
      localStorage.removeItem(OLD_PICTURE);
    });
  }
}

/** Returns a name that no other draft or page has. */
export function newId() {
  return Date.now().toString(36) + Math.random().toString(36).slice(2, 10);
}

/** Returns what a call returns, undefined where the browser forbids it. */
function attempt(call) {
  try {
    return call();
  } catch {
    return undefined;
  }
}

/** Returns what a text of JSON says, null for none. */
function parsed(text) {
  return attempt(() => JSON.parse(text ?? "null")) ?? null;
}
