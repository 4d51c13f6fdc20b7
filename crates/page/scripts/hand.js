// @ts-check
// A hand that pulls bodies, by mouse or finger; by a spring while freedoms move. The wheel zooms, and
// what is zoomed is moved by its bare sheet. A click shows the path of the point there.

// Way of the pointer up to which a press is a click [pixels].
const CLICK = 4;

/**
 * Lets the pointer pull the bodies of a picture; `live` solves and draws.
 * @param {import("./live.js").Live} live
 */
export function giveHand(paper, live) {
  let held = null;
  let waiting = false;
  let panned = null;
  // The place at which the pointer was pressed, until it has moved further than in a click.
  let pressed = null;

  paper.addEventListener(
    "wheel",
    (event) => {
      // On a page that scrolls, the wheel alone is the page's.
      if (event.ctrlKey || live.root.closest(".studio")) {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        const at = live.picture.onSheet(event.clientX, event.clientY);
        live.picture.zoom(Math.exp(-0.0015 * lines * event.deltaY), at);
        live.fit();
      }
    },
    { passive: false },
  );
  paper.addEventListener("dblclick", () => live.picture.zoomed && live.redraw(false));

  paper.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || held) {
      return;
    }
    pressed = [event.clientX, event.clientY];
    const body = live.picture.bodyAt(event.clientX, event.clientY);
    if (body === null) {
      if (live.picture.zoomed) {
        event.preventDefault();
        paper.setPointerCapture(event.pointerId);
        panned = { id: event.pointerId, at: live.picture.onSheet(event.clientX, event.clientY) };
      }
      return;
    }
    event.preventDefault();
    paper.setPointerCapture(event.pointerId);
    const at = live.picture.onSheet(event.clientX, event.clientY);
    const answer = live.ask({ do: "grab", body, at });
    held = answer && { id: event.pointerId, body, grip: answer.grip, at };
    paper.classList.add("held");
    if (live.flies) {
      pull();
    }
  });

  // One solution per picture, towards the last place of the pointer.
  function pull() {
    waiting = false;
    if (held) {
      live.move({ do: live.flies ? "hold" : "drag", body: held.body, grip: held.grip, at: held.at });
    }
  }

  paper.addEventListener("pointermove", (event) => {
    if (pressed) {
      if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) <= CLICK) {
        return;
      }
      pressed = null;
      if (held && !live.flies) {
        live.play.stop();
        live.keep();
      }
    }
    if (panned?.id === event.pointerId) {
      live.picture.pan(panned.at, live.picture.onSheet(event.clientX, event.clientY));
      return;
    }
    if (held?.id !== event.pointerId) {
      paper.classList.toggle("near", live.picture.bodyAt(event.clientX, event.clientY) !== null);
      return;
    }
    held.at = live.picture.onSheet(event.clientX, event.clientY);
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(pull);
    }
  });

  function release(event) {
    const clicked = pressed && event.type === "pointerup" ? (held ?? { body: null }) : null;
    pressed = panned = null;
    if (held?.id === event.pointerId) {
      if (waiting) {
        pull();
      }
      held = null;
      if (live.page.is_free) {
        live.ask({ do: "let_go" });
        live.draw();
      }
      paper.classList.remove("held");
      live.settle();
    }
    if (clicked) {
      live.course.trace(clicked);
    }
  }
  paper.addEventListener("pointerup", release);
  paper.addEventListener("pointercancel", release);
}
