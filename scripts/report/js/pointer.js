// Pointing at rows, picking them, and the mark of what the slider chooses: positions over a finished plot, so that moving
// costs no drawing.
class ScenePlot {
  constructor(article) {
    this.article = article;
    this.number = Number(article.dataset.scene);
    this.scene = data.scenes[this.number];
    this.place = $(".plot", article);
    this.place.tabIndex = 0;
    this.place.setAttribute("role", "group");
    this.place.setAttribute("aria-label", `Time against error of ${this.scene.title}: arrow keys walk through the rows, Enter picks one; all are in the table below`);
    this.marks = {};
    this.at = -1;
    const images = untimed(this.scene);
    if (images.length)
      $("details.data", article).before(el("ul", {class: "untimed"}, ...images.map((row) => el("li", {}, `${row.label}, without a time: error ${percentText(row.error)} `,
        row.image === null ? row.missing : el("button", {type: "button", onclick: () => viewRows(null, row)}, "beside the truth")))));
    if (this.scene.rows.some((k) => counts(data.rows[k]))) whenNear(article, () => this.draw());
    else this.place.replaceChildren(el("p", {class: "how"}, "No row of this scene has a time and an error.")), this.place.classList.add("none-to-draw"), this.place.tabIndex = -1;
  }

  async draw() {
    const plot = scenePlot(this.scene);
    this.rows = [...plot.rows].sort((a, b) => costOf(a) - costOf(b));
    this.graph = await draw(this.place, plot.traces, plot.layout);
    if (!this.overlay) this.setUp();
    this.measure();
    this.choose();
    this.pick();
  }

  setUp() {
    this.overlay = el("div", {class: "overlay", "aria-hidden": "true"});
    for (const name of ["limit", "chosen", "pointed", "a", "b"]) this.overlay.append(this.marks[name] = el("div", {class: `mark ${name}`}, name === "a" || name === "b" ? name.toUpperCase() : ""));
    this.place.append(this.overlay);
    this.graph.on("plotly_afterplot", () => { this.measure(); this.choose(); this.pick(); });
    let event = null;
    const point = onFrame(() => this.pointAt(event));
    this.place.addEventListener("pointermove", (e) => { event = e; point(); });
    this.place.addEventListener("pointerleave", () => this.leave());
    let down = null;
    this.place.addEventListener("pointerdown", (e) => { down = [e.clientX, e.clientY]; }, true);
    addEventListener("pointerup", (e) => {
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 5) {
        this.pointAt(e);
        if (this.at >= 0) togglePick(this.rows[this.at]);
      }
      down = null;
    }, true);
    this.place.addEventListener("keydown", (e) => this.key(e));
    this.place.addEventListener("blur", () => this.leave());
  }

  /// Where the rows are on the screen.
  measure() {
    const {xaxis, yaxis, _size} = this.graph._fullLayout;
    this.box = {l: _size.l, t: _size.t, w: _size.w, h: _size.h};
    this.xy = this.rows.map((row) => [xaxis._offset + xaxis.d2p(costOf(row)), yaxis._offset + yaxis.d2p(100 * leastError(row))]);
    this.yOf = (limit) => yaxis._offset + yaxis.d2p(100 * limit);
    this.open = this.rows.map(passes);
  }

  inside([x, y]) {
    const {l, t, w, h} = this.box;
    return x >= l - 1 && x <= l + w + 1 && y >= t - 1 && y <= t + h + 1;
  }

  mark(name, xy) {
    const node = this.marks[name], shown = xy && this.inside(xy);
    node.style.visibility = shown ? "visible" : "hidden";
    if (shown) node.style.transform = `translate(${xy[0].toFixed(1)}px, ${xy[1].toFixed(1)}px)`;
  }

  pointAt(event) {
    const bounds = this.place.getBoundingClientRect(), x = event.clientX - bounds.left, y = event.clientY - bounds.top;
    let best = -1, least = 40 ** 2;
    for (let k = 0; k < this.xy.length; ++k) {
      if (!this.open[k] || !this.inside(this.xy[k])) continue;
      const d = (this.xy[k][0] - x) ** 2 + (this.xy[k][1] - y) ** 2;
      if (d < least) least = d, best = k;
    }
    this.show(best, event.clientX, event.clientY);
  }

  show(k, x, y) {
    if (k !== this.at) {
      this.at = k;
      this.mark("pointed", k < 0 ? null : this.xy[k]);
      card.fill(k < 0 ? null : this.rows[k]);
    }
    if (k >= 0) card.move(x, y);
  }

  leave() {
    this.show(-1);
  }

  key(event) {
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    if (event.key === "Escape") return this.leave();
    if (event.key === "Enter" && this.at >= 0) return togglePick(this.rows[this.at]);
    if (!step || !this.rows.length) return;
    event.preventDefault();
    let k = this.at;
    do k = (k + step + this.rows.length) % this.rows.length; while (!this.open[k] && this.open.some(Boolean) && k !== this.at);
    const bounds = this.place.getBoundingClientRect();
    this.show(k, bounds.left + this.xy[k][0], bounds.top + this.xy[k][1]);
    setText($(".live", this.article), card.sentence(this.rows[k]));
  }

  /// The line of the bearable error, and a ring around the row that it chooses.
  choose() {
    if (!this.xy) return;
    const row = chosen[this.number], k = row ? this.rows.indexOf(row) : -1, y = this.yOf(state.limit), {l, t, w, h} = this.box;
    this.mark("chosen", k < 0 ? null : this.xy[k]);
    const line = this.marks.limit, shown = y >= t && y <= t + h;
    line.style.visibility = shown ? "visible" : "hidden";
    if (shown) line.style.transform = `translate(${l}px, ${y.toFixed(1)}px)`, line.style.width = `${w}px`;
  }

  pick() {
    if (!this.xy) return;
    ["a", "b"].forEach((name, n) => {
      const k = n < state.picks.length ? this.rows.indexOf(data.rows[state.picks[n]]) : -1;
      this.mark(name, k < 0 ? null : this.xy[k]);
    });
  }
}

/// What stands beside the pointer.
const card = {
  sentence: (row) => `${row.label}: ${msText(costOf(row))}, error ${percentText(row.error)}${row.source ? ", " + row.source : ""}`,
  fill(row) {
    const node = $("#card");
    node.hidden = !row;
    if (!row) return;
    this.parts ??= (() => {
      const parts = {image: el("img", {alt: "", width: 128, height: 128}), none: el("p", {class: "none"}), title: el("b"), time: el("p"), error: el("p"), more: el("p")};
      node.append(parts.image, parts.none, el("div", {}, ...["title", "time", "error", "more"].map((k) => parts[k])));
      return parts;
    })();
    const {image, none, title, time, error, more} = this.parts, about = row.image === null ? null : data.images[row.image];
    image.hidden = !about, none.hidden = !!about;
    if (about) image.src = about.thumbnail;
    setText(none, about ? "" : row.missing || "no picture");
    setText(title, row.label);
    setText(time, `${msText(row.frame)} ± ${digits(row.spread, 2)}` + (row.least !== null ? ` (${digits(row.least)} to ${digits(row.greatest)})` : ""));
    setText(error, `error ${percentText(row.error)}${row.source ? ", " + row.source : ""}`);
    setText(more, `prepare ${msText(row.prepare)}, ${sizeText(row.bytes)}`);
    this.size = [node.offsetWidth, node.offsetHeight];
  },
  move(x, y) {
    const [w, h] = this.size, left = x + 18 + w > innerWidth ? Math.max(4, x - w - 18) : x + 18;
    $("#card").style.transform = `translate(${left}px, ${Math.max(4, Math.min(y - h / 2, innerHeight - h - 4))}px)`;
  },
};

/// The last two picks stay; those of another scene go.
function togglePick(row) {
  const k = data.rows.indexOf(row), had = state.picks.includes(k);
  state.picks = state.picks.filter((p) => p !== k && data.rows[p].scene === row.scene);
  if (!had) state.picks = [...state.picks, k].slice(-2);
  changed("picks");
}

function showPicked() {
  for (const article of $$("article.scene")) {
    const scene = data.scenes[article.dataset.scene], box = $(".picked", article);
    const picks = state.picks.map((k) => data.rows[k]).filter((row) => row.scene === scene.name);
    box.hidden = !picks.length;
    box.replaceChildren(...picks.map((row, n) => el("figure", {},
      row.image === null ? el("p", {class: "none"}, row.missing || "no picture") : el("img", {src: data.images[row.image].thumbnail, alt: `Picture of ${row.label}`, width: 256, height: 256}),
      el("figcaption", {}, el("b", {}, "AB"[n]), ` ${card.sentence(row)}`))),
      el("div", {class: "buttons"}, 
        picks.length === 2 ? el("button", {type: "button", class: "open-viewer", onclick: () => viewRows(...picks)}, "both in the viewer")
          : picks.length ? el("button", {type: "button", class: "open-viewer", onclick: () => viewRows(null, picks[0])}, "beside the truth in the viewer") : null,
        picks.length === 1 ? el("span", {}, " or click another row") : null,
        el("button", {type: "button", onclick: () => { state.picks = []; changed("picks"); }}, "none")));
  }
}
