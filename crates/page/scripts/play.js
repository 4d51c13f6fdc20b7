// @ts-check
// Motion by itself: time where motions are prescribed or freedoms move, otherwise a driver.

import { moveOf, offerMoves } from "./controls.js";

// Largest angle by which a driver turns per second [rad]: faster ones look as if they stood, or ran
// backwards.
const FASTEST = 4 * Math.PI;

export class Play {
  /**
   * `live` solves and draws; `find` returns an element of the page.
   * @param {import("./live.js").Live} live
   */
  constructor(live, find) {
    this.live = live;
    this.button = find(".play");
    this.speed = find(".speed");
    this.swing = find(".swing");
    this.what = find(".moved");
    this.playing = false;
    this.direction = 1;
    this.slowdown = 1;
    this.speed.addEventListener("change", () => (this.slowdown = 1));
    this.button.addEventListener("click", () => this.toggle());
    this.what.addEventListener("change", () => live.course.draw());
  }

  /** Offers what can move: time, and the drivers that are inputs. */
  offer(page) {
    this.slowdown = 1;
    offerMoves(this.what, page);
    this.button.disabled = this.what.options.length === 0;
    this.swing.parentElement.hidden = page.is_free;
    if (page.is_free) {
      this.swing.checked = false;
      this.direction = 1;
      // The time of the simulation takes a second or more.
      const speeds = [...this.speed.options].map((option) => Number(option.value));
      const most = Math.min(1, Math.max(page.stop - page.start, speeds[0]));
      this.speed.value = Math.max(...speeds.filter((speed) => speed <= most));
    }
  }

  /** The driver that moves, null for time. */
  get driver() {
    return moveOf(this.what);
  }

  toggle() {
    this.set(!this.playing);
  }

  stop() {
    this.set(false);
  }

  set(playing) {
    this.playing = playing && !this.button.disabled;
    this.before = null;
    this.live.root.classList.toggle("playing", this.playing);
    this.button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    if (this.playing) {
      this.live.keep();
      requestAnimationFrame((now) => this.tick(now));
    }
  }

  tick(now) {
    if (!this.playing) {
      return;
    }
    if (this.before !== null) {
      // A page in the background gets no pictures for a while.
      this.advance(Math.min(0.1, (now - this.before) / 1000) * this.pace);
    }
    this.before = now;
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Returns the speed over that of the clock: the one chosen, less where drivers turn too fast to see. */
  get pace() {
    const { frame, places, page } = this.live;
    const chosen = Number(this.speed.value);
    const played = this.driver === null ? page.drivers.keys() : [this.driver];
    const turning = [...played].map((driver) =>
      page.drivers[driver].is_angle ? Math.abs(frame[places.drivers + 3 * driver + 1]) : 0,
    );
    const fastest = chosen * Math.max(0, ...turning);
    while (fastest * this.slowdown > FASTEST && this.slowdown > 1e-6) {
      // 1/2, 1/5, 1/10.
      this.slowdown *= String(this.slowdown).match(/[1-9]/)[0] === "5" ? 0.4 : 0.5;
      this.slowdown = Number(this.slowdown.toPrecision(1));
    }
    return chosen * this.slowdown;
  }

  /** Returns a text about a motion that is shown slower than chosen, empty for none. */
  get slowness() {
    const total = this.slowdown * Number(this.speed.value);
    const told = total < 1 ? `1/${Math.round(1 / total)}` : `×${total}`;
    return this.slowdown < 1 ? `slow motion ${told}` : "";
  }

  /** Moves on by a time [s]. */
  advance(seconds) {
    const { live } = this;
    if (this.driver === null) {
      const { start, stop, is_free } = live.page;
      let time = live.frame[0] + this.direction * seconds;
      // Free motion has no end.
      if (!is_free && (time > stop || time < start)) {
        if (this.swing.checked) {
          this.direction = -this.direction;
          time = Math.min(stop, Math.max(start, time));
        } else {
          time = time > stop ? start : stop;
        }
      }
      if (!live.move({ do: "time", value: time })) {
        this.turnOrStop();
      }
      return;
    }
    const { driver } = this;
    const at = live.places.drivers + 3 * driver;
    const [value, velocity] = live.frame.slice(at, at + 2);
    const range = live.page.ranges[driver];
    const next = value + this.direction * velocity * seconds;
    const [low, high] = [Math.min(range.low, value), Math.max(range.high, value)];
    // The driver turns back shortly before an end.
    const margin = 1e-3 * (range.high - range.low);
    const ends = !range.turns || this.swing.checked;
    if (ends && (next < low + margin || next > high - margin) && (next - value) * (next - 0.5 * (low + high)) > 0) {
      this.direction = -this.direction;
      return;
    }
    if (!live.drive(driver, next)) {
      this.direction = -this.direction;
    }
  }

  turnOrStop() {
    if (this.swing.checked) {
      this.direction = -this.direction;
    } else {
      this.stop();
    }
  }
}
