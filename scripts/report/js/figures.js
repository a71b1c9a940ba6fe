// Plots over parameters, and bars of what errors, frames and memory are made of.
const MOST_BARS = 20;
const shortLabel = (text) => (text.length > (isNarrow() ? 26 : 76) ? text.slice(0, isNarrow() ? 25 : 75) + "…" : text);

/// Rows of a scene that bars show: the frontier first, then by time.
function barRows(scene, has) {
  const front = new Set(scene.pareto), rows = scene.rows.filter((k) => data.rows[k].status === "ok" && has(data.rows[k]));
  rows.sort((a, b) => front.has(b) - front.has(a) || (data.rows[a].frame ?? 0) - (data.rows[b].frame ?? 0));
  return {rows: rows.map((k) => data.rows[k]), shown: rows.slice(0, MOST_BARS).map((k) => data.rows[k])};
}

/// Horizontal bars, one line a row; `series`: [name, value of a row]; as shares of `whole`, if it is given.
function bars(parent, label, {rows, shown}, series, title, mode, unit, whole = null) {
  if (!rows.length) return void parent.append(el("p", {class: "how"}, `No row of this scene tells ${label.toLowerCase()}.`));
  if (rows.length > shown.length) parent.append(el("p", {class: "how"}, `${shown.length} of ${rows.length} rows: those of the frontier first, then the fastest. The table has all.`));
  const place = figureBox(parent, label, ["row", ...series.map(([name]) => `${name}, ${unit}`)], rows.map((row) => [row.label, ...series.map(([, value]) => value(row))]));
  const y = shown.map((_, k) => k);
  const traces = series.map(([name, value], n) => ({type: "bar", orientation: "h", name: plotText(name), y, x: shown.map((row) => (value(row) ?? 0) / (whole ? whole(row) / 100 : 1)),
    marker: {color: palette[n % palette.length], pattern: {shape: ["", "/", ".", "x", "\\", "-", "+", "|"][(n + 3 * Math.floor(n / 8)) % 8], fillmode: "overlay", fgcolor: "#ffffff", fgopacity: 0.55, solidity: 0.25, size: 7}}}));
  const per = mode === "group" ? Math.max(24, 9 * series.length + 10) : 24;
  return draw(place, traces, layout({barmode: mode, bargap: 0.25, height: 110 + per * shown.length, margin: {l: 10, r: 16, t: 8, b: 40}, showlegend: series.length > 1,
    legend: {orientation: "h", y: 1.01, yanchor: "bottom", x: 0, traceorder: "normal"},
    xaxis: axis(title, {rangemode: "tozero"}), yaxis: axis("", {tickvals: y, ticktext: shown.map((row) => plotText(shortLabel(row.label) + (whole ? `, ${msText(whole(row))}` : ""))), range: [shown.length - 0.4, -0.6]})}));
}

function partsBars(parent, scene) {
  const names = ["texels", "spheres in place of the mesh", "the technique itself"];
  const part = (n) => (row) => {
    const found = row.parts.find(([name]) => (n < 2 ? name === names[n] : !names.slice(0, 2).includes(name)));
    return found?.[1] == null ? null : 100 * found[1];
  };
  bars(parent, "Parts of the error", barRows(scene, (row) => row.parts.length), names.map((name, n) => [name, part(n)]), "error that each part has alone, %", "group", "%");
  const steps = [...new Set(scene.rows.flatMap((k) => data.rows[k].steps.map(([name]) => name)))];
  if (steps.length)
    bars(parent, "Steps of the technique's own error", barRows(scene, (row) => row.steps.length), steps.map((name) => [name, (row) => {
      const found = row.steps.find(([n]) => n === name);
      return found?.[2] == null ? null : 100 * found[2];
    }]), "share of the error against spheres, %", "relative", "%");
}

function stageBars(parent, scene) {
  const of = (row) => (row.stages.length ? row.stages : [["update", row.update], ["shade", row.shade]]);
  const names = [...new Set(scene.rows.flatMap((k) => of(data.rows[k]).map(([name]) => name)))];
  bars(parent, "Stages of a frame", barRows(scene, (row) => row.frame !== null), names.map((name) => [name, (row) => of(row).find(([n]) => n === name)?.[1] ?? null]), "share of the frame, %", "stack", "ms", (row) => row.frame);
}

function memoryDots(parent, scene) {
  const {rows, shown} = barRows(scene, (row) => row.bytes !== null);
  if (!rows.length) return void parent.append(el("p", {class: "how"}, "No row of this scene tells its memory."));
  const parts = [...new Set(rows.flatMap((row) => Object.keys(row.footprint)))];
  const place = figureBox(parent, "Memory", ["row", "MB", ...parts.map((name) => `${name}, MB`)], rows.map((row) => [row.label, row.bytes / 1e6, ...parts.map((name) => (row.footprint[name] ?? 0) / 1e6)]));
  const lines = shown, y = lines.map((_, k) => k);
  draw(place, [{type: "scatter", mode: "markers", x: lines.map((row) => Math.max(row.bytes, 1) / 1e6), y, marker: {size: 9, color: lines.map((row) => colourOf(row.technique)), symbol: lines.map((row) => markerOf(row.technique, row.backend))}}],
    layout({height: 80 + 22 * lines.length, showlegend: false, margin: {l: 10, r: 16, t: 8, b: 40}, xaxis: logAxis("MB", {range: logRange(lines.map((row) => Math.max(row.bytes, 1) / 1e6))}), yaxis: axis("", {tickvals: y, ticktext: lines.map((row) => plotText(shortLabel(row.label))), range: [lines.length - 0.4, -0.6]})}));
}

/// What each technique's lower envelope takes for an error, and reaches in a time; nothing is told beyond what was measured.
function equalTable(parent, scene) {
  const families = scene.families.filter((f) => f.time_at_error?.length || f.error_at_time?.length);
  if (!families.length) return void parent.append(el("p", {class: "how"}, "No technique of this scene has a curve."));
  const errors = families[0].time_at_error ?? [], times = families[0].error_at_time ?? [];
  const heads = ["technique", ...errors.map((e) => `ms at ${percentText(e.error)}`), ...times.map((t) => `% in ${msText(t.ms)}`)];
  const bounded = (value, bound) => (value == null || !bound ? value ?? null : `${{"at most": "≤ ", "at least": "≥ "}[bound] ?? "~ "}${digits(value)}`);
  const lines = families.map((f) => ({cells: [`${f.technique} ${f.backend}`, ...errors.map((_, k) => bounded(f.time_at_error?.[k]?.ms, f.time_at_error?.[k]?.bound)),
    ...times.map((_, k) => bounded(f.error_at_time?.[k]?.error == null ? null : 100 * f.error_at_time[k].error, f.error_at_time?.[k]?.bound))]}));
  const node = table(heads, lines, {caption: "Time at equal error, error at equal time"});
  families.forEach((f, row) => [...f.time_at_error ?? [], ...f.error_at_time ?? []].forEach((e, k) => { if (e.refused) node.tBodies[0].rows[row].cells[k + 1].title = e.refused; }));
  parent.append(el("p", {class: "how"}, "Between neighbours of a technique's lower envelope, in logarithms. A – lies outside of what was measured; pointing at it says why. ≤, ≥ and ~ rest on errors within the reference's noise."),
    el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": "Time at equal error, error at equal time"}, node));
}

const slopeText = (s) => (s.slope == null ? `no slope: ${s.refused ?? "not told"}` : `${digits(s.slope)}${s.low == null ? "" : ` (${digits(s.low)} to ${digits(s.high)})`}`);
function scalingPlot(parent, name, all) {
  const place = figureBox(parent, `Time over ${name}`, ["technique", "held", name, "ms", "slope (95 %)"],
    all.flatMap((s) => s.points.map(([x, ms]) => [`${s.technique} ${s.backend}`, s.fixed ?? "", x, ms, slopeText(s)])));
  const before = {};  // lines of one technique differ by their dashes
  const traces = all.map((s) => {
    const points = [...s.points].sort((a, b) => a[0] - b[0]), nth = before[s.technique] = (before[s.technique] ?? -1) + 1;
    const slope = s.slope == null ? "" : `slope ${slopeText(s)}, `, text = `${s.technique} ${s.backend}: ${slope}${s.fixed ?? ""}`, most = isNarrow() ? 42 : 74;
    return {type: "scatter", mode: "lines+markers", name: plotText(text.length > most ? text.slice(0, most - 1) + "…" : text), x: points.map((p) => p[0]), y: points.map((p) => p[1]),
      marker: {size: 8, color: colourOf(s.technique), symbol: markerOf(s.technique, s.backend)}, line: {color: colourOf(s.technique), width: 1.5, dash: ["solid", "dash", "dot", "dashdot", "longdash"][nth % 5]}};
  });
  const xs = all.flatMap((s) => s.points.map((p) => p[0]));
  const ticks = [...new Set(xs)].sort((a, b) => a - b);
  const shown = ticks.length <= 8 ? {tickvals: ticks, ticktext: ticks.map((x) => digits(x))} : {};
  draw(place, traces, layout({height: 330 + 19 * traces.length, showlegend: true, legend: {orientation: "v", y: -0.25, yanchor: "top", x: 0},
    xaxis: logAxis(plotText(name), {range: logRange(xs), ...shown}), yaxis: logAxis("ms a frame", {range: logRange(all.flatMap((s) => s.points.map((p) => p[1])))})}));
}

function scalingPlots(parent, scene) {
  const all = [...scene.scaling, ...data.receivers_scaling].map((s) => ({...s, points: (s.points ?? []).filter(([x, ms]) => x > 0 && ms > 0)})).filter((s) => s.points.length);
  const axes = [...new Set(all.map((s) => String(s.axis)))];
  if (!axes.length) parent.append(el("p", {class: "how"}, "No two rows of this scene differ in one number alone: there is nothing to plot over."));
  const grid = el("div", {class: "grid"});
  parent.append(grid);
  for (const name of axes) {
    const box = el("div", {});
    grid.append(box);
    box.append(el("h4", {}, `over ${name}`));
    scalingPlot(box, name, all.filter((s) => String(s.axis) === name));
  }
  const even = scene.break_even;
  if (even.length) {
    parent.append(el("h4", {}, "Where two are equally fast"), el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": "Where two are equally fast"},
      table(["first", "second", "over", "equal at", "faster below"], even.map((e) => ({cells: [e.first ?? "", e.second ?? "", e.axis ?? "", e.at ?? e.refused ?? "", e.faster_below ?? ""]})), {caption: "Where two are equally fast"})));
  }
}

function setUpFigures() {
  const draws = {equal: equalTable, scaling: scalingPlots, parts: partsBars, stages: stageBars, memory: memoryDots};
  const show = (box) => {
    box.replaceChildren();
    if (data.scenes.length) draws[box.dataset.figure](box, data.scenes[$("#figure-scene").value || 0]);
  };
  const boxes = $$("#figures .plots");
  for (const box of boxes) whenNear(box.parentElement, () => { box.near = true; show(box); });
  const again = () => boxes.filter((box) => box.near).forEach(show);
  $("#figure-scene").addEventListener("change", again);
  $("#figure-controls").addEventListener("submit", (event) => event.preventDefault());
  return again;
}
