// @ts-check
// The first mechanism: a four-bar in six steps, each of which the studio can do by itself.

import { add } from "./controls.js";
import { byKeys } from "./dialogs.js";
import { ownMarker } from "./tools.js";

/** Returns the points of the sketch at which exactly one body ends, and that ground does not hold. */
function freeEnds({ points }) {
  return points.filter(({ markers, ground }) => !ground && markers.length === 1);
}

/** Returns a gesture that adds a link from the last free end, or from ground at a point, to a target. */
function nextLink(sketch, target, from = [0, 0]) {
  const end = freeEnds(sketch).pop();
  const begin = end ? { at: end.at, marker: ownMarker(end) } : { at: from, ground: true };
  return { kind: "link", points: [begin, target] };
}

// `is` tells that a step is done, `tool` is the one to take, `act` does it.
const LESSONS = [
  {
    text: "A crank: take Link, press Ctrl and click for its pivot on ground, then click its other end.",
    tool: "link",
    is: ({ bodies }) => bodies.length > 0,
    act: (studio) => studio.gesture(nextLink(studio.view.sketch, { at: [0.05, 0.1] })),
  },
  {
    text: "A coupler: with Link, click the free end of the crank, then a point to its right.",
    tool: "link",
    is: ({ bodies }) => bodies.length > 1,
    act: (studio) => studio.gesture(nextLink(studio.view.sketch, { at: [0.3, 0.25] })),
  },
  {
    text: "A rocker: click the free end of the coupler, then, with Ctrl, its pivot on ground.",
    tool: "link",
    is: ({ bodies }) => bodies.length > 2,
    act: (studio) => studio.gesture(nextLink(studio.view.sketch, { at: [0.4, 0], ground: true })),
  },
  {
    text: "A driver, the input of the FMU: take Driver and click the crank's pivot.",
    tool: "driver",
    is: ({ drivers }) => drivers.length > 0,
    act: (studio) => {
      const pin = studio.view.sketch.joints.find((joint) => joint.is_pin && joint.drives);
      return pin && studio.gesture({ kind: "driver", joint: pin.name });
    },
  },
  {
    text: "A path: take Trace and click the pin between coupler and rocker.",
    tool: "trace",
    is: ({ traced }) => traced?.length > 0,
    act: (studio) => {
      const marker = studio.view.sketch.points.flatMap(({ markers }) => markers).filter((path) => !path.startsWith("ground.")).pop();
      return marker && studio.gesture({ kind: "trace", marker });
    },
  },
  {
    text: "Motion: choose it at the top, and pull a link or press play. Export FMU takes the mechanism along.",
    is: (_, studio) => !studio.isDesign,
    act: (studio) => studio.setMode("motion"),
  },
];

export class Guide {
  constructor(studio, place) {
    this.studio = studio;
    this.place = place;
    this.place.hidden = true;
  }

  /** Begins with the first step that is not done. */
  begin() {
    this.place.hidden = false;
    this.step = undefined;
    this.look();
  }

  /** Goes on where a step was done, by the reader or by the studio. */
  look() {
    const { studio, place } = this;
    if (place.hidden || !studio.view.sketch) {
      return;
    }
    const step = LESSONS.findIndex((each) => !each.is(studio.view.sketch, studio));
    if (step === this.step) {
      return;
    }
    const held = place.contains(document.activeElement);
    this.step = step;
    place.replaceChildren();
    const close = () => (place.hidden = true);
    if (step < 0) {
      add(place, "p", { textContent: "Done: a mechanism that is driven, moved, and ready to be exported." });
    } else {
      const { text, tool, act } = LESSONS[step];
      add(place, "h2", { textContent: `Step ${step + 1} of ${LESSONS.length}` });
      add(place, "p", { textContent: byKeys(text) });
      if (tool) {
        studio.design.take(tool);
      }
      add(place, "button", { type: "button", className: "primary", textContent: "Do this for me" }).addEventListener("click", () => act(studio));
    }
    const button = add(place, "button", { type: "button", textContent: "Close" });
    button.addEventListener("click", close);
    if (held) {
      place.querySelector("button").focus();
    }
  }
}
