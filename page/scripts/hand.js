// A hand that pulls bodies, by mouse or finger; by a spring while freedoms move.

/** Lets the pointer pull the bodies of a picture; `live` solves and draws. */
export function giveHand(paper, live) {
  let held = null;
  let waiting = false;

  paper.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || held) {
      return;
    }
    const body = live.picture.bodyAt(event.clientX, event.clientY);
    if (body === null) {
      return;
    }
    event.preventDefault();
    paper.setPointerCapture(event.pointerId);
    if (!live.flies) {
      live.play.stop();
      live.keep();
    }
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
  }
  paper.addEventListener("pointerup", release);
  paper.addEventListener("pointercancel", release);
}
