// One comparison on the page: a canvas that shows its pictures in place.

const AMPLIFIED = 60;
const MOST_ZOOM = 64;

/** What all viewers share. `x` and `y` are the point of the picture, 0 to 1, in the middle of the canvas. */
const view = { mode: "picture", show: 0, against: 0, split: 0.5, exposure: 0, zoom: 1, x: 0.5, y: 0.5 };

let screen = displayTable(0);
let screenExposure = 0;

/** The display table of the exposure in use. */
function currentScreen() {
  if (screenExposure !== view.exposure) {
    screen = displayTable(view.exposure);
    screenExposure = view.exposure;
  }
  return screen;
}

class Viewer {
  /** `article` is the comparison's element, `names` the names of the pictures, `changed` tells the page. */
  constructor(article, names, changed) {
    this.article = article;
    this.names = names;
    this.changed = changed;
    this.canvas = article.querySelector("canvas");
    this.context = this.canvas.getContext("2d");
    this.readout = article.querySelector(".readout");
    this.first = Number(article.querySelector("[data-picture]").dataset.picture);
    this.width = Number(article.dataset.width);
    this.height = Number(article.dataset.height);
    this.visible = false;
    this.forget();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    new IntersectionObserver(([entry]) => this.comesOrGoes(entry.isIntersecting), { rootMargin: "50%" }).observe(this.canvas);
    this.listen();
  }

  /** Let go of all pictures: a page of many scenes would fill the memory. */
  forget() {
    this.loading = new Map();
    this.codes = new Map();
    this.flips = new Map();
    this.painted = new Map();
  }

  comesOrGoes(visible) {
    this.visible = visible;
    if (visible) this.draw();
    else this.forget();
  }

  /** The embedded text of a "picture" or "flip", null if there is none. */
  embedded(kind, index) {
    return this.article.querySelector(`[data-${kind}="${index}"]`)?.textContent ?? null;
  }

  has(index) {
    return this.article.querySelector(`[data-picture="${index}"]`) !== null;
  }

  /** The picture on show: where there is no reference, the first method's takes its place. */
  shown() {
    return view.show === 0 && view.mode === "picture" && !this.has(0) ? this.first : view.show;
  }

  /** Unpack picture `index` and its FLIP map, once; draws again when that is done. */
  load(index) {
    if (!this.loading.has(index)) this.loading.set(index, this.unpack(index, this.codes, this.flips));
    return this.loading.get(index);
  }

  async unpack(index, codes, flips) {
    if (index !== 0 && this.has(0)) await this.load(0);
    const flip = this.embedded("flip", index);
    if (index === 0) flips.set(index, new Uint8Array(this.width * this.height));
    else if (flip !== null) flips.set(index, await inflate(flip));
    codes.set(index, await decodePicture(this.embedded("picture", index), this.width, this.height, codes.get(0)));
    this.draw();
  }

  /** The canvas kept under `key`, made by `color` if it is not there yet. */
  keep(key, color) {
    const name = `${key}@${view.exposure}`;
    if (!this.painted.has(name)) {
      if (this.painted.size > 2 * this.names.length) this.painted.clear();
      this.painted.set(name, paint(this.width, this.height, color));
    }
    return this.painted.get(name);
  }

  picture(index) {
    const codes = this.codes.get(index);
    const shown = currentScreen();
    return this.keep(`picture ${index}`, (pixel, channel) => shown[codes[3 * pixel + channel]]);
  }

  difference(first, second) {
    const [one, other] = [this.codes.get(first), this.codes.get(second)];
    const shown = currentScreen();
    return this.keep(`difference ${first} ${second}`, (pixel, channel) => {
      const at = 3 * pixel + channel;
      return AMPLIFIED * Math.abs(shown[one[at]] - shown[other[at]]);
    });
  }

  flip(index) {
    const steps = this.flips.get(index);
    return this.keep(`flip ${index}`, (pixel, channel) => palette[3 * steps[pixel] + channel]);
  }

  /** The pictures that the mode needs. */
  needed() {
    const second = { wipe: view.against, difference: view.against, flip: 0 }[view.mode] ?? this.shown();
    return [...new Set([this.shown(), second])];
  }

  /** What keeps the mode from being shown, in words; empty if nothing does. */
  lacking() {
    const absent = this.needed().filter((index) => !this.has(index));
    if (absent.includes(0)) return "no reference here";
    if (view.mode === "flip" && view.show !== 0 && this.embedded("flip", view.show) === null) absent.push(view.show);
    return absent.length === 0 ? "" : `${absent.map((index) => this.names[index]).join(", ")}: not measured here`;
  }

  draw() {
    if (!this.visible) return;
    const lacking = this.lacking();
    this.article.querySelector(".absent").hidden = lacking === "";
    this.article.querySelector(".absent").textContent = lacking;
    this.label(lacking === "");
    if (lacking !== "") {
      this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
      return;
    }
    const waiting = this.needed().filter((index) => !this.codes.has(index));
    if (waiting.length > 0) {
      waiting.forEach((index) => this.load(index));
      return;
    }
    this.fitCanvas();
    if (view.mode === "wipe") this.drawWipe();
    else if (view.mode === "difference") this.blit(this.difference(view.show, view.against));
    else if (view.mode === "flip") this.blit(this.flip(view.show));
    else this.blit(this.picture(this.shown()));
  }

  drawWipe() {
    const { width, height } = this.canvas;
    const edge = Math.round(view.split * width);
    this.blit(this.picture(view.show));
    this.context.save();
    this.context.beginPath();
    this.context.rect(edge, 0, width - edge, height);
    this.context.clip();
    this.blit(this.picture(view.against));
    this.context.restore();
    this.context.fillStyle = "#000";
    this.context.fillRect(edge - 2, 0, 4, height);
    this.context.fillStyle = "#fff";
    this.context.fillRect(edge - 1, 0, 2, height);
  }

  /** Write on the picture what it is. */
  label(whole) {
    const [left, right] = this.article.querySelectorAll(".tag");
    const [shown, against] = [this.names[this.shown()], this.names[view.against]];
    const texts = {
      picture: [shown, ""],
      wipe: [shown, against],
      difference: [`${shown} − ${against}, ×${AMPLIFIED}`, ""],
      flip: [`FLIP of ${shown}`, ""],
    };
    [left.textContent, right.textContent] = whole ? texts[view.mode] : ["", ""];
  }

  fitCanvas() {
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(this.canvas.clientWidth * ratio);
    const height = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
  }

  /** Pixels of the canvas per pixel of the picture, and where the picture's corner lies. */
  placement(width = this.canvas.width, height = this.canvas.height) {
    const scale = Math.min(width / this.width, height / this.height) * view.zoom;
    return { scale, left: width / 2 - view.x * this.width * scale, top: height / 2 - view.y * this.height * scale };
  }

  blit(picture) {
    const { scale, left, top } = this.placement();
    this.context.imageSmoothingEnabled = scale < 1.5;
    this.context.imageSmoothingQuality = "high";
    this.context.fillStyle = "#808080";
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    this.context.drawImage(picture, left, top, this.width * scale, this.height * scale);
  }

  /** The pixel of the picture under a pointer event, or null beside it. */
  pixelAt(event) {
    const { scale, left, top } = this.placement(this.canvas.clientWidth, this.canvas.clientHeight);
    const [x, y] = [Math.floor((event.offsetX - left) / scale), Math.floor((event.offsetY - top) / scale)];
    return x >= 0 && y >= 0 && x < this.width && y < this.height ? { x, y } : null;
  }

  /** Zoom by `factor`, keeping the point at `offsetX`, `offsetY` of the canvas where it is. */
  zoomAt(factor, offsetX, offsetY) {
    const { clientWidth, clientHeight } = this.canvas;
    const before = this.placement(clientWidth, clientHeight);
    view.zoom = Math.min(MOST_ZOOM, Math.max(1, view.zoom * factor));
    const after = this.placement(clientWidth, clientHeight);
    const kept = 1 / before.scale - 1 / after.scale;
    view.x += ((offsetX - clientWidth / 2) * kept) / this.width;
    view.y += ((offsetY - clientHeight / 2) * kept) / this.height;
    this.changed();
  }

  pan(movedX, movedY) {
    const { scale } = this.placement(this.canvas.clientWidth, this.canvas.clientHeight);
    view.x -= movedX / (scale * this.width);
    view.y -= movedY / (scale * this.height);
    this.changed();
  }

  nearSplit(event) {
    return view.mode === "wipe" && Math.abs(event.offsetX - view.split * this.canvas.clientWidth) < 12;
  }

  listen() {
    let dragged = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      dragged = this.nearSplit(event) ? "split" : "picture";
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointerup", () => (dragged = null));
    this.canvas.addEventListener("pointercancel", () => (dragged = null));
    this.canvas.addEventListener("pointermove", (event) => {
      this.canvas.classList.toggle("on-split", dragged === "split" || this.nearSplit(event));
      if (dragged === "split") {
        view.split = Math.min(1, Math.max(0, event.offsetX / this.canvas.clientWidth));
        this.changed();
      } else if (dragged === "picture") this.pan(event.movementX, event.movementY);
      this.read(event);
    });
    this.canvas.addEventListener("wheel", (event) => {
      // Else a page could not be scrolled past its pictures.
      if (!event.ctrlKey && document.activeElement !== this.canvas) return;
      event.preventDefault();
      this.zoomAt(2 ** (-event.deltaY / 250), event.offsetX, event.offsetY);
    }, { passive: false });
  }

  /** Write down the values of the pixel under the pointer. */
  read(event) {
    const pixel = this.pixelAt(event);
    if (!pixel) return;
    const at = pixel.y * this.width + pixel.x;
    const values = (index) => [0, 1, 2].map((channel) => halfValue(this.codes.get(index)[3 * at + channel]).toPrecision(4));
    const lines = [...new Set([this.shown(), view.mode === "picture" ? 0 : view.against, 0])]
      .filter((index) => this.codes.has(index))
      .map((index) => {
        const flip = index === 0 || !this.flips.has(index) ? "" : `   FLIP ${(this.flips.get(index)[at] / 255).toFixed(3)}`;
        return `${this.names[index].padEnd(26)} ${values(index).join("  ")}${flip}`;
      });
    this.readout.textContent = [`x ${pixel.x}  y ${pixel.y}   linear red, green, blue`, ...lines].join("\n");
  }
}
