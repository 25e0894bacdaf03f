"use strict";
// Mouse, fingers and keys on viewers.

const SCROLL_PAUSE = 350; // ms: a wheel that is scrolling the page goes on doing so when a viewer comes under the pointer
let lastScroll = -Infinity;
addEventListener("scroll", () => { lastScroll = performance.now(); }, { passive: true });

let activeViewer = null; // the one that keys go to: under the pointer, or focused

function attachGestures(viewer) {
  const { stage, divider, figure } = viewer;
  const pointers = new Map();
  let moved = 0;

  const at = (event) => {
    const box = stage.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const centre = () => {
    const all = [...pointers.values()];
    return { x: all.reduce((sum, one) => sum + one.x, 0) / all.length, y: all.reduce((sum, one) => sum + one.y, 0) / all.length };
  };
  const spread = () => {
    const [one, other] = [...pointers.values()];
    return Math.hypot(one.x - other.x, one.y - other.y);
  };

  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    pointers.set(event.pointerId, at(event));
    moved = 0;
    try {
      stage.setPointerCapture(event.pointerId);
    } catch {
      // the pointer is gone already
    }
  });

  stage.addEventListener("pointermove", (event) => {
    const here = at(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      viewer.setMark(viewer.pixelAt(here.x, here.y));
      return;
    }
    moved += Math.hypot(here.x - before.x, here.y - before.y);
    const from = centre(), distance = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, here);
    const to = centre();
    if (pointers.size === 2) {
      if (distance > 0) viewer.zoom(spread() / distance, to.x, to.y);
      if (viewer.isZoomed) viewer.pan(to.x - from.x, to.y - from.y);
    } else if (event.pointerType === "mouse" || viewer.isZoomed) {
      viewer.pan(to.x - from.x, to.y - from.y); // one finger on a whole image scrolls the page
    }
  });

  const release = (event) => {
    const tapped = pointers.delete(event.pointerId) && event.type === "pointerup" && event.pointerType !== "mouse" && moved < 10;
    if (tapped) viewer.setMark(viewer.pixelAt(at(event).x, at(event).y));
  };
  stage.addEventListener("pointerup", release);
  stage.addEventListener("pointercancel", release);
  stage.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && !pointers.size && viewer.setMark(null));
  stage.addEventListener("touchmove", (event) => event.touches.length > 1 && event.preventDefault(), { passive: false });
  stage.addEventListener("dblclick", () => viewer.fit());

  stage.addEventListener("wheel", (event) => {
    const step = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1);
    const scrolling = performance.now() - lastScroll < SCROLL_PAUSE;
    if (!event.ctrlKey && (scrolling || (step > 0 && !viewer.isZoomed))) return;
    event.preventDefault();
    const { x, y } = at(event);
    viewer.zoom(2 ** (-step / (event.ctrlKey ? 60 : 240)), x, y); // with ctrl: a trackpad's pinch, in small steps
    viewer.setMark(viewer.pixelAt(x, y));
  }, { passive: false });

  const drag = (event) => viewer.setSplitAt(at(event).x / stage.clientWidth);
  divider.addEventListener("pointerdown", (event) => {
    event.stopPropagation();
    divider.setPointerCapture(event.pointerId);
  });
  divider.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    if (divider.hasPointerCapture(event.pointerId)) drag(event);
  });
  for (const type of ["pointerup", "dblclick"]) divider.addEventListener(type, (event) => event.stopPropagation());
  divider.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (!step || event.shiftKey) return;
    viewer.setSplitAt(viewer.splitAt + step);
    event.preventDefault();
    event.stopPropagation();
  });

  const focused = () => document.activeElement?.closest(".viewer") === figure;
  figure.addEventListener("pointerenter", () => { activeViewer = viewer; });
  figure.addEventListener("focusin", () => { activeViewer = viewer; });
  figure.addEventListener("pointerleave", () => { if (!focused() && activeViewer === viewer) activeViewer = null; });
  figure.addEventListener("focusout", () => { if (!figure.matches(":hover") && activeViewer === viewer) activeViewer = null; });
}

/** The next mode that can be shown. */
function nextMode(viewer) {
  const modes = Object.keys(MODES).filter((mode) => !viewer.why(mode));
  viewer.setMode(modes[(modes.indexOf(viewer.mode) + 1) % modes.length]);
}

const PAN_KEYS = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };

document.addEventListener("keydown", (event) => {
  const viewer = activeViewer;
  const inField = event.target.matches("select, input:not([type=range])") || (event.target.type === "range" && event.key.startsWith("Arrow"));
  if (!viewer || event.ctrlKey || event.metaKey || event.altKey || inField) return;
  const digit = /^(?:Digit|Numpad)([1-9])$/.exec(event.code);
  const actions = {
    ArrowLeft: () => viewer.select(viewer.a - 1),
    ArrowRight: () => viewer.select(viewer.a + 1),
    s: () => viewer.setSplit(!viewer.split),
    m: () => nextMode(viewer),
    e: () => viewer.setExposure(viewer.link.exposure + 0.5),
    E: () => viewer.setExposure(viewer.link.exposure - 0.5),
    f: () => viewer.fit(),
    "+": () => viewer.zoom(1.5),
    "-": () => viewer.zoom(1 / 1.5),
  };
  let act = actions[event.key];
  if (digit) act = Number(digit[1]) <= viewer.images.length && (() => (event.shiftKey ? viewer.selectB : viewer.select).call(viewer, digit[1] - 1));
  else if (event.shiftKey && PAN_KEYS[event.key]) act = () => viewer.pan(...PAN_KEYS[event.key]);
  if (!act) return;
  act();
  event.preventDefault();
});
