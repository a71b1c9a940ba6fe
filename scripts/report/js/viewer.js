// Two pictures of one scene, beside, under or after one another, and what differs between them.
const viewer = {mode: "side", share: 0.5, panels: {}, pair: null, flipTimer: null, entries: [], loading: 0};

/// Truth, rows, and images of a base, by scene.
function entriesOf(scene) {
  const entries = scene.truth === null ? [] : [{key: "truth", title: "truth", image: scene.truth, row: null}];
  for (const k of scene.rows) {
    const row = data.rows[k];
    if (row.image !== null) entries.push({key: String(k), title: row.label, image: row.image, row, truth: row.truth});
  }
  data.extra.forEach((extra, k) => {
    if (extra.scene === scene.name) entries.push({key: `base${k}`, title: extra.title, image: extra.image, row: null});
  });
  return entries;
}

function viewRows(a, b) {
  const key = (row) => (row ? String(data.rows.indexOf(row)) : "truth");
  state.view = {...state.view, scene: String(data.scenes.findIndex((s) => s.name === (a ?? b).scene)), a: key(a), b: key(b)};
  changed("view");
  $("#viewer").scrollIntoView({behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth"});
}
function viewExtra(k) {
  const extra = data.extra[k];
  state.view = {...state.view, scene: String(data.scenes.findIndex((s) => s.name === extra.scene)), a: `base${k}`, b: String(extra.row)};
  changed("view");
  $("#viewer").scrollIntoView();
}

function setUpViewer() {
  const shown = data.scenes.map((scene, k) => [k, scene]).filter(([, scene]) => entriesOf(scene).length);
  if (!shown.length) {
    $("#viewer-controls").hidden = $("#pixel").hidden = $("#regions").hidden = true;
    $("#viewer-note").hidden = false;
    setText($("#viewer-note"), "This run left no pictures that can be shown.");
    return;
  }
  $("#view-scene").append(...shown.map(([k, scene]) => el("option", {value: k}, scene.title)));
  const choose = (name) => (event) => {
    state.view = {...state.view, [name]: event.target.value, ...(name === "scene" ? {a: null, b: null} : {})};
    changed("view");
  };
  for (const name of ["scene", "a", "b", "mode"]) $("#view-" + name).addEventListener("change", choose(name));
  $("#exposure").addEventListener("input", onFrame(() => {
    state.view = {...state.view, ev: $("#exposure").value === "0" ? null : $("#exposure").value};
    showExposure();
    paintPair();
    saveSoon();
  }));
  $("#viewer-controls").addEventListener("submit", (event) => event.preventDefault());
  $("#zoom-in").addEventListener("click", () => zoomBy(1.5));
  $("#zoom-out").addEventListener("click", () => zoomBy(1 / 1.5));
  $("#zoom-reset").addEventListener("click", () => zoomBy(1e-3));
  const p = viewer.panels;
  p.a = new Panel("A"), p.b = new Panel("B");
  p.signed = new Panel("B − A", colourBar((t, out, at) => signedColour(2 * t - 1, out, at), "darker: −¼ of white", "0", "brighter: +¼"));
  p.flip = new Panel("FLIP", colourBar(magmaColour, "0: equal", "½", "1: differs most"));
  $("#panels").append(...Object.values(p).map((panel) => panel.node));
  viewer.refresh = onFrame(refreshPanels);
  new ResizeObserver(viewer.refresh).observe($("#panels"));
  whenNear($("#viewer"), () => { viewer.near = true; showView(); });
}

const evOf = () => Math.max(-6, Math.min(10, Number(state.view.ev ?? 0) || 0));
function showExposure() {
  $("#exposure").value = evOf();
  setText($("#exposure-text"), `${evOf() > 0 ? "+" : ""}${evOf()} EV`);
}

async function showView() {
  if (!viewer.near) return;
  const scenes = $$("#view-scene option").map((o) => o.value);
  const k = scenes.includes(state.view.scene) ? state.view.scene : scenes[0], scene = data.scenes[k];
  const entries = entriesOf(scene);
  $("#view-scene").value = k;
  const best = chosen[k] && chosen[k].image !== null ? String(data.rows.indexOf(chosen[k])) : null;
  const find = (key, otherwise) => entries.find((e) => e.key === key) ?? otherwise;
  const a = find(state.view.a, entries[0]), b = find(state.view.b, find(best, entries[1] ?? entries[0]));
  for (const [name, entry] of [["a", a], ["b", b]]) {
    $("#view-" + name).replaceChildren(...entries.map((e) => el("option", {value: e.key}, e.title)));
    $("#view-" + name).value = entry.key;
  }
  viewer.mode = ["side", "slider", "flip"].includes(state.view.mode) ? state.view.mode : "side";
  $("#view-mode").value = viewer.mode;
  showExposure();
  const turn = ++viewer.loading;
  const [imageA, imageB] = await Promise.all([imageOf(a.image), imageOf(b.image)]);
  if (turn !== viewer.loading) return;
  viewer.pair = {a, b, imageA, imageB, same: imageA.w === imageB.w && imageA.h === imageB.h, flip: null};
  note();
  paintPair();
  showRegions();
}

function note() {
  const {imageA, imageB, same, a, b} = viewer.pair, texts = [];
  if (!same) texts.push("The two pictures have different sizes: what differs between them cannot be shown.");
  for (const [image, entry] of [[imageA, a], [imageB, b]]) {
    const {halvings, full, non_finite: bad} = image.about;
    if (halvings) texts.push(`${entry.title}: shown at ${image.w} × ${image.h} of ${full[0]} × ${full[1]} pixels, to keep the page small.`);
    if (bad) texts.push(`${entry.title}: ${bad} pixel${bad === 1 ? " is" : "s are"} not finite${halvings ? "" : ", shown in magenta"}.`);
  }
  $("#viewer-note").hidden = !texts.length;
  setText($("#viewer-note"), texts.join(" "));
}

function paintPair() {
  if (!viewer.pair) return;
  const {a, b, imageA, imageB, same} = viewer.pair, p = viewer.panels, exposure = imageA.about.exposure * 2 ** evOf();
  const shown = (rgb) => (i, out, at) => {
    const r = rgb[3 * i], g = rgb[3 * i + 1], bl = rgb[3 * i + 2];
    if (!Number.isFinite(r + g + bl)) return void (out[at] = 255, out[at + 1] = 0, out[at + 2] = 255);
    out[at] = shownByte(exposure * r), out[at + 1] = shownByte(exposure * g), out[at + 2] = shownByte(exposure * bl);
  };
  clearInterval(viewer.flipTimer);
  p.b.node.hidden = viewer.mode !== "side";
  p.signed.node.hidden = p.flip.node.hidden = !same;
  viewer.turned = false;
  p.a.title(`A: ${a.title}${viewer.mode === "slider" ? " | B: " + b.title : ""}`);
  p.b.title(`B: ${b.title}`), p.signed.title("B − A, signed"), p.flip.title("FLIP of B against A");
  p.a.paint(imageA.w, imageA.h, shown(imageA.rgb));
  p.b.paint(imageB.w, imageB.h, shown(imageB.rgb));
  if (viewer.mode === "flip")
    viewer.flipTimer = setInterval(() => {
      viewer.turned = !viewer.turned;
      p.a.title(viewer.turned ? `B: ${b.title}` : `A: ${a.title}`);
      viewer.refresh();
    }, 700);
  if (same) {
    const lum = (rgb, i) => luminance(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]) || 0;
    p.signed.paint(imageA.w, imageA.h, (i, out, at) => signedColour(exposure / 0.25 * (lum(imageB.rgb, i) - lum(imageA.rgb, i)), out, at));
    clearTimeout(viewer.flipSoon);
    viewer.flipSoon = setTimeout(() => paintFlip(exposure), 30);
  }
  viewer.refresh();
}

function paintFlip(exposure) {
  const {imageA, imageB} = viewer.pair;
  if (imageA.w !== imageB.w || imageA.h !== imageB.h) return;
  const map = viewer.pair.flip = flip(imageB.rgb, imageA.rgb, imageA.w, imageA.h, exposure);
  viewer.panels.flip.paint(imageA.w, imageA.h, (i, out, at) => magmaColour(map[i], out, at));
  const mean = map.reduce((sum, x) => sum + x, 0) / map.length;
  viewer.panels.flip.title(`FLIP of B against A: mean ${digits(mean)}`);
  viewer.panels.flip.node.dataset.mean = mean;
  viewer.refresh();
}

function refreshPanels() {
  const p = viewer.panels;
  if (!viewer.pair) return;
  if (viewer.mode === "slider") p.a.show(p.b, viewer.share);
  else if (viewer.mode === "flip" && viewer.turned) p.a.show(p.b, 0);
  else p.a.show();
  for (const panel of [p.b, p.signed, p.flip]) if (!panel.node.hidden) panel.show();
  readPixel();
}

function readPixel() {
  const {imageA, imageB, same, flip: map} = viewer.pair, p = viewer.panels;
  const texts = {a: "", b: "", signed: "", flip: ""};
  if (look.cross) {
    const [x, y] = look.cross, at = (image) => (x < image.w && y < image.h ? [0, 1, 2].map((c) => image.rgb[3 * (y * image.w + x) + c]) : null);
    const a = at(imageA), b = at(imageB), text = (v) => (v ? v.map((c) => (Number.isFinite(c) ? digits(c) : String(c))).join(" ") : "");
    texts.a = text(a), texts.b = text(b);
    if (same && a && b) texts.signed = text(b.map((v, c) => v - a[c])), texts.flip = map ? digits(map[y * imageA.w + x]) : "";
    setText($("#pixel"), `pixel ${x}, ${y}: A ${texts.a}; B ${texts.b}${same ? `; B − A ${texts.signed}; FLIP ${texts.flip}` : ""} (radiance, W m⁻² sr⁻¹)`);
  }
  for (const [name, text] of Object.entries(texts)) setText(p[name].value, text);
}

function showRegions() {
  const lines = [];
  for (const [letter, entry] of [["A", viewer.pair.a], ["B", viewer.pair.b]]) {
    const about = data.images[entry.image], row = entry.row;
    const bad = about.non_finite + (row?.counters.non_finite ?? 0);
    const whole = row?.rungs.truth;
    const line = (region, e) => lines.push({cells: [`${letter}: ${entry.title}`, region, e?.receivers ?? null, e?.rel_rmse == null ? null : 100 * e.rel_rmse, e?.mean_signed ?? null, e?.max ?? null, e?.ssim ?? null, e?.flip ?? null, region === "all" ? bad : null]});
    line("all", whole);
    if (row) for (const region of ["umbra", "penumbra", "lit"]) line(region, row.regions[region]);
  }
  $("#regions").replaceChildren(table(["picture", "where", "receivers", "error %", "mean signed", "largest", "SSIM", "FLIP", "not finite"], lines, {caption: "Errors against truth of what is shown, by region"}));
}
