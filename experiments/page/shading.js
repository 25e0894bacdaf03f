"use strict";
// Turns pixels into what is seen: the display transform, error maps, and their legends. All in scene-linear numbers until the last step.

const shading = (() => {
  const NOT_FINITE = [255, 0, 255]; // magenta: no such number may hide
  const ERROR_DECADES = [-4, 1]; // the relative error's colours go from 1e-4 to 10
  const maps = {}; // 256 colours each
  for (const [use, text] of Object.entries(window.lampyris.colourMaps)) {
    maps[use] = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  }

  const luts = new Map(); // exposure to table

  /** From the bits of a half float to a byte of sRGB (IEC 61966-2-1), 256 for what is not finite. */
  function displayTable(exposure) {
    if (luts.has(exposure)) return luts.get(exposure);
    const table = new Uint16Array(65536);
    const factor = 2 ** exposure;
    for (let bits = 0; bits < 65536; bits++) {
      const value = halfValues[bits] * factor;
      if (!Number.isFinite(halfValues[bits])) table[bits] = 256;
      else if (value <= 0) table[bits] = 0;
      else table[bits] = Math.min(255, Math.round(255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055)));
    }
    if (luts.size > 4) luts.clear();
    luts.set(exposure, table);
    return table;
  }

  /** The values of the pixel (x, y) of an image that lies at `place` in its picture, or null outside. */
  function valuesAt(image, place, x, y) {
    const column = x - place.x, row = y - place.y;
    if (column < 0 || row < 0 || column >= image.width || row >= image.height) return null;
    const size = image.width * image.height, index = row * image.width + column;
    return Array.from({ length: image.channels }, (_, channel) => halfValues[image.halfs[channel * size + index]]);
  }

  /** Of one channel. The relative squared error is that of which `lampyris compare` gives the mean as relMSE. */
  const formulas = {
    error: (value, expected) => (value - expected) ** 2 / (expected ** 2 + 0.01),
    difference: (value, expected) => value - expected,
  };

  /** A number per pixel of `image`: the mean over the channels of a formula; NaN where the reference has no such pixel. */
  function compare(mode, image, place, reference, referencePlace) {
    const formula = formulas[mode];
    const plane = new Float32Array(image.width * image.height);
    const referenceSize = reference.width * reference.height;
    for (let row = 0, i = 0; row < image.height; row++) {
      const y = row + place.y - referencePlace.y;
      for (let column = 0; column < image.width; column++, i++) {
        const x = column + place.x - referencePlace.x;
        let sum = x >= 0 && y >= 0 && x < reference.width && y < reference.height ? 0 : NaN;
        for (let channel = 0; channel < image.channels; channel++) {
          const expected = reference.halfs[(channel % reference.channels) * referenceSize + y * reference.width + x];
          sum += formula(halfValues[image.halfs[channel * plane.length + i]], halfValues[expected]);
        }
        plane[i] = sum / image.channels;
      }
    }
    return plane;
  }

  /** The numbers of a map that came as an image of one channel. */
  function planeOf(image) {
    return Float32Array.from({ length: image.width * image.height }, (_, i) => halfValues[image.halfs[i]]);
  }

  function mapPlace(mode, value, exposure) {
    if (mode === "flip") return value;
    if (mode === "difference") return 0.5 + 0.5 * value * 2 ** exposure;
    return (Math.log10(Math.max(value, 1e-30)) - ERROR_DECADES[0]) / (ERROR_DECADES[1] - ERROR_DECADES[0]);
  }

  /** An image as it is, into a canvas of its size. */
  function drawImage(canvas, image, exposure) {
    fill(canvas, image, (bytes, size) => {
      const table = displayTable(exposure);
      const { halfs, channels } = image;
      const green = channels > 1 ? size : 0, blue = channels > 2 ? 2 * size : 0;
      for (let i = 0, at = 0; i < size; i++, at += 4) {
        const r = table[halfs[i]], g = table[halfs[i + green]], b = table[halfs[i + blue]];
        const finite = r < 256 && g < 256 && b < 256;
        bytes[at] = finite ? r : NOT_FINITE[0];
        bytes[at + 1] = finite ? g : NOT_FINITE[1];
        bytes[at + 2] = finite ? b : NOT_FINITE[2];
        bytes[at + 3] = 255;
      }
    });
  }

  /** A plane of numbers in the colours of its mode. */
  function drawMap(canvas, image, plane, mode, exposure) {
    const colours = maps[mode];
    fill(canvas, image, (bytes, size) => {
      for (let i = 0, at = 0; i < size; i++, at += 4) {
        const entry = 3 * Math.max(0, Math.min(255, Math.floor(256 * mapPlace(mode, plane[i], exposure))));
        const finite = Number.isFinite(plane[i]);
        for (let channel = 0; channel < 3; channel++) {
          bytes[at + channel] = finite ? colours[entry + channel] : NOT_FINITE[channel];
        }
        bytes[at + 3] = 255;
      }
    });
  }

  function fill(canvas, { width, height }, write) {
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext("2d");
    const data = context.createImageData(width, height);
    write(data.data, width * height);
    context.putImageData(data, 0, 0);
  }

  /** The legend of a mode: CSS colours from left to right, numbers below them, and what they mean. */
  function legend(mode, exposure) {
    const colours = maps[mode];
    const stops = Array.from({ length: 33 }, (_, i) => 3 * Math.min(255, i * 8))
      .map((entry) => `rgb(${colours[entry]} ${colours[entry + 1]} ${colours[entry + 2]})`);
    const range = 2 ** -exposure;
    const labels = {
      flip: ["0", "0.25", "0.5", "0.75", "1"],
      difference: [-range, -range / 2, 0, range / 2, range].map((value) => number(value, 2)),
      error: ["1e−4", "1e−3", "0.01", "0.1", "1", "10"],
    }[mode];
    const meaning = {
      flip: "FLIP: the difference that is seen",
      difference: "I − R: blue darker, red brighter than the reference",
      error: "(I − R)² / (R² + 0.01)",
    }[mode];
    return { gradient: `linear-gradient(to right, ${stops.join(", ")})`, labels, meaning };
  }

  /** A number with so many significant digits. */
  function number(value, digits = 4) {
    if (value === null || value === undefined) return "–";
    if (Number.isNaN(value)) return "NaN";
    if (!Number.isFinite(value)) return value > 0 ? "Inf" : "−Inf";
    if (value === 0) return "0";
    const size = Math.abs(value);
    const text = size >= 1e-3 && size < 1e6 ? Number(value.toPrecision(digits)).toString() : value.toExponential(digits - 1).replace("e+", "e");
    return text.replaceAll("-", "−");
  }

  return { valuesAt, compare, planeOf, drawImage, drawMap, legend, number };
})();
