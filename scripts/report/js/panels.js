// Panels that show one part of a picture each: they share zoom, place and cross.
const look = {zoom: 1, x: 0.5, y: 0.5, cross: null};

class Panel {
  constructor(title, bar) {
    this.canvas = el("canvas", {width: 10, height: 10, tabindex: 0, role: "img", "aria-label": title});
    this.value = el("span", {class: "value"});
    this.node = el("figure", {class: "panel"}, el("figcaption", {}, el("span", {class: "title"}, title), this.value), this.canvas, bar ?? null);
    this.source = document.createElement("canvas");
    for (const [name, act] of Object.entries({pointermove: (e) => panelMove(this, e), pointerdown: (e) => panelDown(this, e), pointerleave: () => panelLeave(), wheel: (e) => panelWheel(this, e), keydown: (e) => panelKey(this, e)}))
      this.canvas.addEventListener(name, act, {passive: false});
  }

  title(text) {
    setText($(".title", this.node), text);
    this.canvas.setAttribute("aria-label", text);
  }

  /// `colour(i, out, at)` writes pixel i as three bytes.
  paint(w, h, colour) {
    this.source.width = w, this.source.height = h;
    const context = this.source.getContext("2d"), pixels = context.createImageData(w, h), out = pixels.data;
    for (let i = 0; i < w * h; ++i) {
      colour(i, out, 4 * i);
      out[4 * i + 3] = 255;
    }
    context.putImageData(pixels, 0, 0);
    this.show();
  }

  /// The part of the picture that is seen, in its pixels.
  part() {
    const {width: w, height: h} = this.source, pw = w / look.zoom, ph = h / look.zoom;
    return {x: Math.min(w - pw, Math.max(0, look.x * w - pw / 2)), y: Math.min(h - ph, Math.max(0, look.y * h - ph / 2)), w: pw, h: ph};
  }

  show(over = null, share = 1) {
    const {width: w, height: h} = this.source;
    if (!w || !this.canvas.isConnected) return;
    const shownWidth = Math.max(1, Math.round(this.canvas.clientWidth * devicePixelRatio));
    this.canvas.width = shownWidth, this.canvas.height = Math.max(1, Math.round(shownWidth * h / w));
    const context = this.canvas.getContext("2d"), p = this.part(), W = this.canvas.width, H = this.canvas.height;
    context.imageSmoothingEnabled = W < p.w;
    context.drawImage(this.source, p.x, p.y, p.w, p.h, 0, 0, W, H);
    if (over) {
      const at = Math.round(share * W);
      context.drawImage(over.source, p.x + p.w * share, p.y, p.w * (1 - share), p.h, at, 0, W - at, H);
      context.fillStyle = "#fff", context.fillRect(at - 1, 0, 2, H);
      context.fillStyle = "#000", context.fillRect(at + 1, 0, 1, H);
    }
    if (look.cross) {
      const s = W / p.w, x = (look.cross[0] + 0.5 - p.x) * s, y = (look.cross[1] + 0.5 - p.y) * s, r = Math.max(5, s / 2 + 1);
      for (const [colour, width] of [["#000", 3], ["#fff", 1.2]]) {
        context.strokeStyle = colour, context.lineWidth = width;
        context.strokeRect(x - r, y - r, 2 * r, 2 * r);
      }
    }
  }

  pixelAt(event) {
    const b = this.canvas.getBoundingClientRect(), p = this.part();
    const at = (v, n) => Math.min(n - 1, Math.max(0, Math.floor(v)));
    return [at(p.x + p.w * (event.clientX - b.left) / b.width, this.source.width), at(p.y + p.h * (event.clientY - b.top) / b.height, this.source.height)];
  }
}

/// A bar of colours with what its ends mean.
function colourBar(colour, low, middle, high) {
  const canvas = el("canvas", {width: 128, height: 1, "aria-hidden": "true"});
  const context = canvas.getContext("2d"), pixels = context.createImageData(128, 1);
  for (let i = 0; i < 128; ++i) {
    colour(i / 127, pixels.data, 4 * i);
    pixels.data[4 * i + 3] = 255;
  }
  context.putImageData(pixels, 0, 0);
  return el("div", {class: "bar"}, canvas, el("div", {class: "ends"}, ...[low, middle, high].map((text) => el("span", {}, text))));
}

let drag = null;
function panelMove(panel, event) {
  if (drag) {
    const b = panel.canvas.getBoundingClientRect();
    look.x = Math.min(1, Math.max(0, drag.x - (event.clientX - drag.from[0]) / b.width / look.zoom));
    look.y = Math.min(1, Math.max(0, drag.y - (event.clientY - drag.from[1]) / b.height / look.zoom));
  }
  look.cross = panel.pixelAt(event);
  if (viewer.mode === "slider" && panel === viewer.panels.a && !drag) {
    const b = panel.canvas.getBoundingClientRect();
    viewer.share = Math.min(1, Math.max(0, (event.clientX - b.left) / b.width));
  }
  viewer.refresh();
}
function panelDown(panel, event) {
  if (look.zoom > 1) {
    drag = {from: [event.clientX, event.clientY], x: look.x, y: look.y};
    panel.canvas.setPointerCapture(event.pointerId);
    panel.canvas.addEventListener("pointerup", () => { drag = null; }, {once: true});
  }
}
function panelLeave() {
  if (!drag) look.cross = null, viewer.refresh();
}
function zoomBy(factor, at = null) {
  const before = look.zoom;
  look.zoom = Math.min(32, Math.max(1, look.zoom * factor));
  if (at) look.x += (at[0] - look.x) * (1 - before / look.zoom), look.y += (at[1] - look.y) * (1 - before / look.zoom);
  if (look.zoom === 1) look.x = look.y = 0.5;
  viewer.refresh();
}
function panelWheel(panel, event) {
  if (!event.ctrlKey && look.zoom === 1 && event.deltaY > 0) return;  // the page scrolls on
  event.preventDefault();
  const [x, y] = panel.pixelAt(event);
  zoomBy(event.deltaY < 0 ? 1.25 : 0.8, [x / panel.source.width, y / panel.source.height]);
}
function panelKey(panel, event) {
  const step = {ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1]}[event.key];
  if (event.key === "+" || event.key === "=") return zoomBy(1.5);
  if (event.key === "-") return zoomBy(1 / 1.5);
  if (!step) return;
  event.preventDefault();
  const {width: w, height: h} = panel.source, [x, y] = look.cross ?? [w >> 1, h >> 1];
  look.cross = [Math.min(w - 1, Math.max(0, x + step[0])), Math.min(h - 1, Math.max(0, y + step[1]))];
  if (look.zoom > 1) look.x = look.cross[0] / w, look.y = look.cross[1] / h;
  viewer.refresh();
}
