"""A look at a page on which a mechanism is moved: what scripts use, once it is ready."""

from browsing import visit

READY = """
await until(() => find(".live.ready") || !find(".live .problems")?.hidden);
const live = find(".live").live;
const frame = () => { live.draw(); return live.frame; };
const number = (name) => live.frame[live.places.variables + live.page.variables.findIndex((v) => v.name === name)];
const message = () => find(".message").textContent;
const point = (x, y) => {
  const at = new DOMPoint(x * live.picture.parts.scale, -y * live.picture.parts.scale)
    .matrixTransform(live.picture.svg.getScreenCTM());
  return [at.x, at.y];
};
// The pointer of a person, in steps from one global point to the others.
const drag = async (...points) => {
  const paper = find(".paper");
  paper.setPointerCapture = () => {};
  const send = (kind, [x, y]) => {
    const [clientX, clientY] = point(x, y);
    paper.dispatchEvent(new PointerEvent(kind, { clientX, clientY, pointerId: 1, button: 0, bubbles: true, cancelable: true }));
  };
  send("pointerdown", points[0]);
  for (const at of points.slice(1)) {
    send("pointermove", at);
    await pause(60);
  }
  send("pointerup", points[points.length - 1]);
  await pause(50);
};
"""


def look(tmp_path, page, script):
    return visit(tmp_path, page, READY + script)
