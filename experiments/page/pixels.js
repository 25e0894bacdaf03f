"use strict";
// Loads the pixels of images. A page from a file may not fetch(), but it may load scripts: each image comes as a script that hands its
// pixels to lampyrisImage as base64 of gzipped half floats, plane after plane.

// The value of each of the 65536 half floats: IEEE 754-2008, binary16.
const halfValues = new Float32Array(65536);
for (let bits = 0; bits < 65536; bits++) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 31) halfValues[bits] = fraction ? NaN : sign * Infinity;
  else if (exponent === 0) halfValues[bits] = sign * fraction * 2 ** -24;
  else halfValues[bits] = sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

const pixels = {
  budget: 384e6, // bytes of decoded images that are kept for when they are shown again
  kept: new Map(), // hash to promise, the one used last at the end
  waiting: new Map(), // hash to what to call when its script has run

  /** Promises {width, height, channels, halfs} of the image with this hash. */
  load(hash) {
    const known = pixels.kept.get(hash);
    const promise = known ?? pixels.fetch(hash);
    pixels.kept.delete(hash);
    pixels.kept.set(hash, promise);
    if (!known) promise.then(pixels.forget, () => pixels.kept.delete(hash));
    return promise;
  },

  fetch(hash) {
    return new Promise((resolve, reject) => {
      const script = document.createElement("script");
      const failed = () => reject(new Error(`page/images/${hash}.js could not be loaded`));
      pixels.waiting.set(hash, (told) => pixels.decode(told).then(resolve, reject));
      script.src = `page/images/${hash}.js`;
      script.onload = () => {
        script.remove();
        if (pixels.waiting.delete(hash)) failed();
      };
      script.onerror = failed;
      document.head.append(script);
    });
  },

  async decode({ width, height, channels, data }) {
    const packed = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const bytes = await new Response(stream).arrayBuffer();
    return { width, height, channels, halfs: new Uint16Array(bytes) };
  },

  /** Drop what was not used for longest, until the rest fits the budget. */
  async forget() {
    let used = 0;
    for (const [hash, promise] of [...pixels.kept].reverse()) {
      const size = await Promise.race([promise, null]).then((image) => image?.halfs.byteLength ?? 0, () => 0);
      used += size;
      if (used > pixels.budget) pixels.kept.delete(hash);
    }
  },
};

window.lampyrisImage = (hash, told) => {
  const resolve = pixels.waiting.get(hash);
  pixels.waiting.delete(hash);
  resolve?.(told);
};
