"use strict";
// An image viewer: one image or two beside a divider, their errors, and the numbers of a pixel. gestures.js moves it.

const MODES = { image: "Image", error: "Relative error", difference: "Difference", flip: "FLIP" };
const ERROR_NAMES = { relmse: "relMSE", relmse_trimmed: "relMSE, trimmed", mse: "MSE", rmse: "RMSE", mape: "MAPE", smape: "sMAPE", flip: "FLIP" };
const MOST_LAYERS = 12; // images that are kept ready to be flipped to

/** What viewers with the same link share. `view` is null (the whole picture) or its centre and width in parts of the picture. */
class Link {
  static known = new Map();

  constructor() {
    Object.assign(this, { viewers: new Set(), view: null, exposure: 0, mark: null });
  }

  static of(name) {
    if (!name) return new Link();
    if (!Link.known.has(name)) Link.known.set(name, new Link());
    return Link.known.get(name);
  }
}

class Viewer {
  constructor(figure, spec) {
    Object.assign(this, { figure, spec, images: spec.images, mode: "image", split: false, splitAt: 0.5 });
    Object.assign(this, { visible: false, turn: 0, shown: [], layers: new Map(), planes: new Map(), decoded: new Map() });
    this.reference = this.images.findIndex((image) => image.name === spec.reference); // -1: none
    this.a = this.images.length > 1 && this.reference === 0 ? 1 : 0;
    this.b = this.reference >= 0 && this.reference !== this.a ? this.reference : (this.a + 1) % this.images.length;
    const places = this.images.map((image) => image.pixels);
    const left = Math.min(...places.map((place) => place.x)), top = Math.min(...places.map((place) => place.y));
    this.frame = {
      left,
      top,
      width: Math.max(...places.map((place) => place.x + place.width)) - left,
      height: Math.max(...places.map((place) => place.y + place.height)) - top,
    };
    this.full = { width: places[0].fullWidth, height: places[0].fullHeight };
    this.link = Link.of(spec.link);
    this.link.viewers.add(this);
    buildControls(this);
    attachGestures(this);
    new IntersectionObserver(([entry]) => this.appear(entry.isIntersecting), { rootMargin: "150px" }).observe(this.stage);
    new ResizeObserver(() => this.draw()).observe(this.stage);
    this.refresh();
  }

  /** Pixels are kept while the viewer can be seen. */
  appear(visible) {
    this.visible = visible;
    if (visible) {
      this.refresh();
    } else {
      for (const kept of [this.layers, this.planes, this.decoded]) kept.clear();
    }
  }

  // What is looked at.

  select(index) {
    this.a = (index + this.images.length) % this.images.length;
    this.refresh();
  }

  selectB(index) {
    this.b = index;
    this.split = true;
    this.refresh();
  }

  setSplit(split) {
    this.split = split && this.images.length > 1;
    this.refresh();
  }

  setSplitAt(part) {
    this.splitAt = Math.min(1, Math.max(0, part));
    this.draw();
  }

  setMode(mode) {
    if (!this.why(mode)) this.mode = mode;
    this.refresh();
  }

  setExposure(exposure) {
    this.link.exposure = Math.min(10, Math.max(-10, exposure));
    this.link.viewers.forEach((viewer) => viewer.refresh());
  }

  /** Mark a pixel in all linked viewers; null for none. */
  setMark(mark) {
    this.link.mark = mark && { u: (mark.x + 0.5) / this.full.width, v: (mark.y + 0.5) / this.full.height };
    this.link.viewers.forEach((viewer) => {
      viewer.draw();
      showNumbers(viewer);
    });
  }

  get mark() {
    const { mark } = this.link;
    return mark && { x: Math.floor(mark.u * this.full.width), y: Math.floor(mark.v * this.full.height) };
  }

  /** Why the map of a mode cannot be shown for an image; empty where it can. */
  why(mode, index = this.a) {
    const image = this.images[index];
    if (mode === "image" || index === this.reference) return "";
    if (mode === "flip") return image.flipPixels ? "" : `No FLIP map was made of ${image.name}`;
    if (mode === "error" && image.errorPixels) return "";
    return this.reference >= 0 ? "" : "There is no reference to compare with";
  }

  // Where it is looked at. Coordinates of a picture are in its pixels, those of the stage in CSS pixels.

  get fitScale() {
    return Math.min(this.stage.clientWidth / this.frame.width, this.stage.clientHeight / this.frame.height);
  }

  get view() {
    const { view } = this.link;
    if (!view) {
      return { x: this.frame.left + this.frame.width / 2, y: this.frame.top + this.frame.height / 2, scale: this.fitScale };
    }
    return { x: view.u * this.full.width, y: view.v * this.full.height, scale: this.stage.clientWidth / (view.width * this.full.width) };
  }

  setView({ x, y, scale }) {
    const { left, top, width, height } = this.frame;
    const bounded = Math.min(96, Math.max(this.fitScale, scale));
    this.link.view = {
      u: Math.min(left + width, Math.max(left, x)) / this.full.width,
      v: Math.min(top + height, Math.max(top, y)) / this.full.height,
      width: this.stage.clientWidth / (bounded * this.full.width),
    };
    this.link.viewers.forEach((viewer) => viewer.draw());
  }

  fit() {
    this.link.view = null;
    this.link.viewers.forEach((viewer) => viewer.draw());
  }

  /** Zoom so that what is under the point of the stage stays there. */
  zoom(factor, stageX = this.stage.clientWidth / 2, stageY = this.stage.clientHeight / 2) {
    const { x, y, scale } = this.view;
    const next = Math.min(96, scale * factor);
    if (next <= this.fitScale * 1.001) {
      this.fit();
      return;
    }
    const shift = 1 / scale - 1 / next;
    this.setView({ x: x + (stageX - this.stage.clientWidth / 2) * shift, y: y + (stageY - this.stage.clientHeight / 2) * shift, scale: next });
  }

  pan(stageX, stageY) {
    const { x, y, scale } = this.view;
    this.setView({ x: x - stageX / scale, y: y - stageY / scale, scale });
  }

  get isZoomed() {
    return this.view.scale > this.fitScale * 1.001;
  }

  /** The pixel at a point of the stage, or null beside the picture. */
  pixelAt(stageX, stageY) {
    const { x, y, scale } = this.view;
    const column = Math.floor(x + (stageX - this.stage.clientWidth / 2) / scale);
    const row = Math.floor(y + (stageY - this.stage.clientHeight / 2) / scale);
    const { left, top, width, height } = this.frame;
    return column >= left && row >= top && column < left + width && row < top + height ? { x: column, y: row } : null;
  }

  // Drawing.

  /** Load and colour what is to be seen, then draw it, unless something else was asked for meanwhile. */
  async refresh() {
    showControls(this);
    if (!this.visible) return;
    const turn = ++this.turn;
    this.figure.setAttribute("aria-busy", "true");
    try {
      const shown = await Promise.all((this.split ? [this.a, this.b] : [this.a]).map((index) => this.layer(index)));
      if (turn !== this.turn) return;
      this.shown = shown;
      this.message.hidden = true;
    } catch (error) {
      if (turn !== this.turn) return;
      this.shown = [];
      this.message.textContent = error.message;
      this.message.hidden = false;
    }
    this.draw();
    showNumbers(this);
    this.figure.setAttribute("aria-busy", "false");
  }

  async pixelsOf(index) {
    if (!this.decoded.has(index)) this.decoded.set(index, await pixels.load(this.images[index].pixels.hash));
    return this.decoded.get(index);
  }

  /** An image or its map in colours, in a canvas of its size. */
  async layer(index) {
    const mode = this.why(this.mode, index) ? "image" : this.mode;
    const exposure = mode === "image" || mode === "difference" ? this.link.exposure : 0;
    const key = `${index} ${mode} ${exposure}`;
    const image = await this.pixelsOf(index);
    const plane = mode === "image" ? null : await this.plane(mode, index);
    const layer = this.layers.get(key) ?? { canvas: document.createElement("canvas"), place: this.images[index].pixels, index, mode };
    if (!this.layers.delete(key)) {
      if (plane) shading.drawMap(layer.canvas, image, plane, mode, exposure);
      else shading.drawImage(layer.canvas, image, exposure);
    }
    this.layers.set(key, layer);
    if (this.layers.size > MOST_LAYERS) this.layers.delete(this.layers.keys().next().value);
    return layer;
  }

  /** The numbers of a map, computed from the images where no file has them. */
  async plane(mode, index) {
    const key = `${mode} ${index}`;
    if (!this.planes.has(key)) this.planes.set(key, await this.computePlane(mode, index));
    return this.planes.get(key);
  }

  async computePlane(mode, index) {
    const { pixels: place, errorPixels, flipPixels } = this.images[index];
    const made = { error: errorPixels, flip: flipPixels }[mode];
    if (made) {
      if (made.width !== place.width || made.height !== place.height) {
        throw new Error(`The map of ${this.images[index].name} is ${made.width} × ${made.height}, the image ${place.width} × ${place.height}`);
      }
      return shading.planeOf(await pixels.load(made.hash));
    }
    const image = await this.pixelsOf(index);
    if (mode === "flip") return new Float32Array(image.width * image.height); // of the reference: it differs nowhere from itself
    return shading.compare(mode, image, place, await this.pixelsOf(this.reference), this.images[this.reference].pixels);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const ratio = window.devicePixelRatio;
    const deviceWidth = Math.round(width * ratio), deviceHeight = Math.round(height * ratio);
    if (this.canvas.width !== deviceWidth || this.canvas.height !== deviceHeight) {
      this.canvas.width = deviceWidth;
      this.canvas.height = deviceHeight;
    }
    const context = this.canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, deviceWidth, deviceHeight);
    const { x, y, scale } = this.view;
    const border = Math.round(this.splitAt * deviceWidth);
    this.shown.forEach((layer, side) => {
      context.save();
      context.beginPath();
      if (this.shown.length > 1) context.rect(side ? border : 0, 0, side ? deviceWidth - border : border, deviceHeight);
      else context.rect(0, 0, deviceWidth, deviceHeight);
      context.clip();
      context.setTransform(scale * ratio, 0, 0, scale * ratio, (width / 2 - x * scale) * ratio, (height / 2 - y * scale) * ratio);
      context.imageSmoothingEnabled = scale * ratio < 1; // magnified, a pixel is a square
      context.imageSmoothingQuality = "high";
      context.drawImage(layer.canvas, layer.place.x, layer.place.y);
      context.restore();
    });
    this.drawMark(context, ratio);
    this.stage.classList.toggle("zoomed", this.isZoomed);
    this.divider.style.left = `${100 * this.splitAt}%`;
    this.divider.setAttribute("aria-valuenow", Math.round(100 * this.splitAt));
  }

  /** Outline the marked pixel, where pixels are large enough to tell apart. */
  drawMark(context, ratio) {
    const { mark } = this;
    const { x, y, scale } = this.view;
    if (!mark || scale < 5) return;
    const left = (this.stage.clientWidth / 2 + (mark.x - x) * scale) * ratio;
    const top = (this.stage.clientHeight / 2 + (mark.y - y) * scale) * ratio;
    for (const [grow, colour] of [[1.5, "black"], [0.5, "white"]]) {
      context.strokeStyle = colour;
      context.lineWidth = 1;
      context.strokeRect(left - grow, top - grow, scale * ratio + 2 * grow, scale * ratio + 2 * grow);
    }
  }
}
