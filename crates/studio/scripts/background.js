// A picture below the sheet: a photo or a scan, at a scale that two clicks set.

import { add } from "./controls.js";
import { buttonRow, openWindow } from "./dialogs.js";
import { lengthOf } from "./units.js";

// Longest side of a picture that this browser keeps [pixels].
const KEPT_SIDE = 1600;

export class Background {
  constructor(studio, sheet) {
    this.studio = studio;
    this.sheet = sheet;
  }

  /** Shows a picture file, so that it fills the sheet; asks for its scale. */
  async open(file) {
    this.close();
    if (!(await this.show(URL.createObjectURL(file)))) {
      this.studio.say(`${file.name} is no picture that this browser shows`);
      return;
    }
    const [width, height] = this.sheet.size;
    const { naturalWidth, naturalHeight } = this.image;
    // Metres per pixel of the picture, and its middle [m].
    this.unit = Math.min((0.9 * width) / naturalWidth, (0.9 * height) / naturalHeight) / this.sheet.scale;
    this.middle = [...this.sheet.center];
    this.look();
    this.keep();
    this.studio.setMode("design");
    this.askScale();
  }

  /** Shows the picture at an address; false if the browser cannot. */
  async show(address) {
    this.image = add(this.sheet.place, "img", { className: "background", alt: "", draggable: false });
    this.sheet.place.prepend(this.image);
    this.image.src = address;
    try {
      await this.image.decode();
      return true;
    } catch {
      this.close();
      return false;
    }
  }

  /** Keeps the picture in this browser, no larger than it has to be. */
  keep() {
    const { naturalWidth, naturalHeight } = this.image;
    const part = Math.min(1, KEPT_SIDE / Math.max(naturalWidth, naturalHeight));
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [naturalWidth, naturalHeight].map((side) => Math.max(1, Math.round(part * side)));
    const brush = canvas.getContext("2d");
    brush.fillStyle = "#fff";
    brush.fillRect(0, 0, canvas.width, canvas.height);
    brush.drawImage(this.image, 0, 0, canvas.width, canvas.height);
    const unit = (this.unit * naturalWidth) / canvas.width;
    this.studio.keepPicture({ address: canvas.toDataURL("image/jpeg", 0.85), unit, middle: this.middle });
  }

  /** Shows a picture that was kept, nothing without one. */
  async restore(kept) {
    this.close();
    const { address, unit, middle } = kept ?? {};
    if (address && (await this.show(address))) {
      Object.assign(this, { unit, middle });
      this.look();
    }
  }

  /** Asks for two points whose distance is known. */
  askScale() {
    this.studio.design.take("scale");
    this.studio.say("Scale of the picture: click two points whose distance you know");
  }

  remove() {
    this.close();
    this.studio.keepPicture(null);
  }

  /** Shows it no longer. */
  close() {
    if (this.image) {
      URL.revokeObjectURL(this.image.src);
      this.image.remove();
      this.image = null;
    }
  }

  /** Puts the picture where the view has it. */
  look() {
    if (!this.image || !this.unit) {
      return;
    }
    const zoom = this.unit * this.sheet.scale;
    const [x, y] = this.sheet.toScreen(this.middle);
    const { naturalWidth, naturalHeight } = this.image;
    this.image.style.width = `${naturalWidth * zoom}px`;
    this.image.style.height = `${naturalHeight * zoom}px`;
    this.image.style.transform = `translate(${x - 0.5 * naturalWidth * zoom}px, ${y - 0.5 * naturalHeight * zoom}px)`;
  }

  /** Asks for the distance of two points [m] of the picture, and scales it about the first one. */
  async scaleBy(from, to) {
    const { unit } = this.studio;
    let field;
    const answer = await openWindow(this.studio.root, "Scale of the picture", (form) => {
      const label = add(form, "label", { textContent: `Distance of the two points [${unit.name}] ` });
      field = add(label, "input", { type: "text", inputMode: "decimal", required: true, autocomplete: "off" });
      buttonRow(form, ["Set", "set"], ["Cancel", ""]);
      setTimeout(() => field.focus());
    });
    const length = answer === "set" ? lengthOf(field.value, unit) : NaN;
    if (!(length > 0)) {
      return;
    }
    const factor = length / Math.hypot(to[0] - from[0], to[1] - from[1]);
    this.unit *= factor;
    this.middle = [0, 1].map((k) => from[k] + factor * (this.middle[k] - from[k]));
    this.look();
    this.keep();
  }
}
