"use strict";
// What stands around a viewer's image: tabs, buttons, the numbers of a pixel, and what made the image.

const KEYS = [
  ["1–9, ← →", "image"], ["Shift 1–9", "image B"], ["S", "A/B"], ["M", "map"], ["e E", "exposure up, down"],
  ["+ −", "zoom"], ["Shift arrows", "pan"], ["F", "fit"],
];

function button(label, title, act) {
  const made = element("button", { type: "button", title }, label);
  made.addEventListener("click", act);
  return made;
}

function dot(image) {
  const made = element("span", { class: "dot", "aria-hidden": "true" });
  made.style.setProperty("--method", methodColour(image.method));
  return made;
}

/** Build the parts of a viewer, and put those that change into it. */
function buildControls(viewer) {
  const { images, spec } = viewer;
  const several = images.length > 1;

  viewer.tabs = images.map((image, index) => {
    const key = index < 9 ? element("kbd", { "aria-hidden": "true" }, String(index + 1)) : null;
    const tab = element("button", { type: "button", role: "tab", title: image.name }, dot(image), image.name, key);
    tab.addEventListener("click", () => viewer.select(index));
    return tab;
  });
  viewer.tablist = element("div", { class: "tabs", role: "tablist", "aria-label": "Image" }, ...viewer.tabs);

  viewer.modes = Object.entries(MODES).map(([mode, label]) => {
    const made = button(label, "", () => viewer.setMode(mode));
    made.dataset.mode = mode;
    return made;
  });

  viewer.splitButton = button("A/B", "Two images beside a divider (S)", () => viewer.setSplit(!viewer.split));
  viewer.choiceB = element("select", { "aria-label": "Image B", title: "Image B, right of the divider" },
    ...images.map((image, index) => element("option", { value: index }, image.name)));
  viewer.choiceB.addEventListener("change", () => {
    viewer.selectB(Number(viewer.choiceB.value));
    if (viewer.choiceB.matches(":hover")) viewer.stage.focus({ preventScroll: true }); // of a mouse: keys go to the image again
  });

  viewer.slider = element("input", { type: "range", min: -8, max: 8, step: 0.25, "aria-label": "Exposure in stops" });
  viewer.slider.addEventListener("input", () => viewer.setExposure(Number(viewer.slider.value)));
  viewer.slider.addEventListener("pointerup", () => viewer.stage.focus({ preventScroll: true }));
  viewer.stops = button("", "Back to an exposure of 0", () => viewer.setExposure(0));

  viewer.canvas = element("canvas", { "aria-hidden": "true" });
  viewer.divider = element("div", {
    class: "divider", role: "slider", tabindex: 0, "aria-label": "Divider between A and B", "aria-valuemin": 0, "aria-valuemax": 100,
  });
  viewer.tags = ["a", "b"].map((side) => element("span", { class: `tag tag-${side}` }));
  viewer.message = element("p", { class: "message" }, "Loading …");
  viewer.stage = element("div", { class: "stage", tabindex: 0, role: "application", "aria-label": `Image: ${spec.title}` },
    viewer.canvas, viewer.divider, ...viewer.tags, viewer.message);
  const aspect = viewer.frame.width / viewer.frame.height;
  viewer.stage.style.aspectRatio = aspect;
  viewer.figure.style.setProperty("--aspect", aspect);

  viewer.legend = element("div", { class: "legend" });
  viewer.pixel = element("p", { class: "pixel" });
  viewer.numbers = element("tbody");
  const head = element("tr", {}, ...["", "R", "G", "B"].map((name) => element("th", { scope: "col" }, name)));
  const readout = element("div", { class: "readout" }, viewer.pixel, element("table", {}, element("thead", {}, head), viewer.numbers));
  viewer.made = element("div", { class: "made" });

  const keys = element("p", { class: "keys keys-mouse" },
    ...KEYS.flatMap(([key, does]) => [element("span", {}, element("kbd", {}, key), ` ${does}`), " "]));
  const touch = element("p", { class: "keys keys-touch" }, "Pinch to zoom, then drag; tap for a pixel's values; tap twice for the whole image.");

  viewer.figure.querySelector(".viewer-body").append(
    viewer.tablist,
    element("div", { class: "tools" },
      element("div", { class: "segments", role: "group", "aria-label": "What is shown" }, ...viewer.modes),
      several ? element("div", { class: "compare" }, viewer.splitButton, viewer.choiceB) : null,
      element("div", { class: "exposure" }, element("span", { "aria-hidden": "true", title: "Exposure" }, "☀"), viewer.slider, viewer.stops),
      element("div", { class: "zoom" },
        button("Fit", "The whole image (F, or double click)", () => viewer.fit()),
        button("1:1", "One pixel of the image on one of the screen", () =>
          viewer.setView({ ...viewer.view, scale: 1 / window.devicePixelRatio })))),
    element("div", { class: "picture" },
      viewer.stage,
      element("div", { class: "side" }, viewer.legend, readout, viewer.made, keys, touch)));
}

/** Bring the controls into line with what the viewer shows. */
function showControls(viewer) {
  const { images, a, b, split, mode, link } = viewer;
  const focused = viewer.tablist.contains(document.activeElement);
  viewer.tabs.forEach((tab, index) => {
    tab.setAttribute("aria-selected", index === a);
    tab.classList.toggle("is-b", split && index === b);
    tab.tabIndex = index === a ? 0 : -1;
  });
  if (focused) viewer.tabs[a].focus({ preventScroll: true });
  const { tablist } = viewer;
  const { offsetTop, offsetHeight } = viewer.tabs[a];
  if (offsetTop < tablist.scrollTop || offsetTop + offsetHeight > tablist.scrollTop + tablist.clientHeight) {
    tablist.scrollTop = offsetTop - 24; // not scrollIntoView: the page must stay where it is
  }

  for (const made of viewer.modes) {
    const why = viewer.why(made.dataset.mode);
    made.disabled = Boolean(why);
    made.title = why;
    made.setAttribute("aria-pressed", made.dataset.mode === mode);
  }
  viewer.splitButton.setAttribute("aria-pressed", split);
  viewer.choiceB.value = b;
  viewer.slider.value = link.exposure;
  viewer.stops.textContent = `${link.exposure > 0 ? "+" : ""}${shading.number(link.exposure)} EV`;
  viewer.stops.disabled = link.exposure === 0;
  viewer.divider.hidden = !split;

  [a, b].forEach((index, side) => {
    const tag = viewer.tags[side];
    const missing = viewer.why(mode, index) ? ` (no ${MODES[mode]} map: the image)` : "";
    tag.textContent = (split ? `${"AB"[side]}: ` : "") + images[index].name + missing;
    tag.hidden = side === 1 && !split;
  });

  const shownMap = mode !== "image" && !viewer.why(mode);
  viewer.legend.hidden = !shownMap;
  if (shownMap) {
    const { gradient, labels, meaning } = shading.legend(mode, link.exposure);
    const bar = element("div", { class: "legend-bar" });
    bar.style.background = gradient;
    viewer.legend.replaceChildren(
      element("span", { class: "legend-meaning" }, meaning),
      bar,
      element("div", { class: "legend-labels" }, ...labels.map((label) => element("span", {}, label))));
  }

  const made = `${a} ${split ? b : ""}`;
  if (viewer.made.dataset.of !== made) {
    viewer.made.dataset.of = made;
    viewer.made.replaceChildren(...(split && a !== b ? [a, b] : [a]).map((index) => describeImage(images[index])));
  }
}

/** What an image is and what made it. */
function describeImage(image) {
  const errors = Object.entries(image.errors).map(([name, value]) =>
    element("span", { class: "error" }, `${ERROR_NAMES[name] ?? name} `, element("b", {}, shading.number(value, 3))));
  const behind = image.run
    ? element("button", { type: "button", class: "runs", "data-runs": image.run, "data-heading": image.name }, "run") : null;
  return element("div", { class: "made-image" },
    element("p", { class: "facts" }, element("b", {}, dot(image), image.name), image.facts ? element("span", {}, image.facts) : null, ...errors, behind),
    image.command ? commandBlock(image.command) : null);
}

/** The scene-linear values of the marked pixel: of A, B and the reference. */
function showNumbers(viewer) {
  const { mark, a, b, reference, split, images } = viewer;
  const rows = [["A", a]];
  if (images.length > 1 && (split || b !== reference) && b !== a) rows.push(["B", b]);
  if (reference >= 0 && reference !== a) {
    const same = rows.find(([, index]) => index === reference);
    if (same) same[0] += ", reference";
    else rows.push(["Reference", reference]);
  } else if (reference === a) {
    rows[0][0] = "A, reference";
  }
  if (!viewer.visible) return;

  viewer.numbers.replaceChildren(...rows.map(([label, index]) => {
    const image = viewer.decoded.get(index);
    if (mark && !image) viewer.pixelsOf(index).then(() => viewer.mark && showNumbers(viewer), () => {});
    const values = mark && image ? shading.valuesAt(image, images[index].pixels, mark.x, mark.y) : null;
    const shown = Array.from({ length: 3 }, (_, channel) => (values ? values[channel % values.length] : null));
    return element("tr", { "data-row": label },
      element("th", { scope: "row", title: images[index].name }, dot(images[index]), element("span", { class: "who" }, label),
        label.toLowerCase().endsWith(images[index].name) ? null : images[index].name),
      ...shown.map((value) => element("td", {}, mark ? shading.number(value, 5) : "")));
  }));

  const parts = [mark ? `Pixel ${mark.x}, ${mark.y}` : "Point at a pixel for its values"];
  viewer.shown.forEach(({ index, mode, place }, side) => {
    const plane = viewer.planes.get(`${mode} ${index}`);
    const column = mark && mark.x - place.x, row = mark && mark.y - place.y;
    if (!plane || !mark || column < 0 || row < 0 || column >= place.width || row >= place.height) return;
    parts.push(`${MODES[mode]}${split ? ` ${"AB"[side]}` : ""} ${shading.number(plane[row * place.width + column], 4)}`);
  });
  viewer.pixel.textContent = parts.join(" · ");
}
