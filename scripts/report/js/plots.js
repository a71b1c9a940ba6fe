// Plotly's part: axes, points, lines. Whatever moves with the pointer or the slider is laid over them (pointer.js).
let plotlyLoading = null;
function plotly() {
  plotlyLoading ??= inflated("plotly", "gzip").then((bytes) => {
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(bytes);
    document.head.append(script);
    document.getElementById("plotly").remove();
    return window.Plotly;
  });
  return plotlyLoading;
}

const paint = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const isNarrow = () => innerWidth < 640;

function axis(title, more = {}) {
  return {title: {text: title, standoff: 8}, gridcolor: paint("--grid"), linecolor: paint("--line"), zeroline: false, automargin: true, color: paint("--soft"), ...more};
}
/// Ticks say whole numbers: 1, 2 and 5 of every decade; over many decades 1 alone.
function logAxis(title, more = {}) {
  const [low, high] = more.range ?? [-3, 4], parts = high - low > 3.5 || (isNarrow() && high - low > 2) ? [1] : [1, 2, 5], tickvals = [];
  for (let k = Math.floor(low) - 1; k <= high + 1; ++k) for (const part of parts) tickvals.push(part * 10 ** k);
  return axis(title, {type: "log", tickvals, ticktext: tickvals.map((x) => digits(x)), ...more});
}
function layout(more) {
  return {paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: {color: paint("--ink"), family: "system-ui, sans-serif", size: 12}, margin: {l: 56, r: 12, t: 12, b: 48},
    hovermode: false, dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom", legend: {orientation: "h", y: -0.18, x: 0, xanchor: "left", itemsizing: "constant"}, ...more};
}
const config = {displayModeBar: false, responsive: true, displaylogo: false, showTips: false};

/// [low, high] of positive values as powers of ten, with room at both ends.
function logRange(values, room = 0.08) {
  const some = values.filter((v) => v > 0).map(Math.log10);
  if (!some.length) return [-1, 1];
  const low = Math.min(...some), high = Math.max(...some), edge = Math.max(0.1, room * (high - low));
  return [low - edge, high + edge];
}

const leastError = (row) => Math.max(row.error, 1e-6);  // what a logarithm can show
function familyTraces(rows) {
  const families = new Map();
  for (const row of rows) {
    const key = JSON.stringify([row.technique, row.backend]);
    if (!families.has(key)) families.set(key, []);
    families.get(key).push(row);
  }
  return [...families.entries()].sort(([a], [b]) => a.localeCompare(b)).map(([, of]) => {
    const {technique, backend} = of[0];
    return {type: "scatter", mode: "markers", name: plotText(`${technique} ${backend}`.slice(0, 60)), x: of.map(costOf), y: of.map((r) => 100 * leastError(r)),
      error_x: {type: "data", array: of.map((r) => r.spread), thickness: 1, width: 2, color: colourOf(technique)},
      marker: {color: colourOf(technique), symbol: markerOf(technique, backend), size: 9, line: {width: 1.4, color: colourOf(technique)},
        opacity: of.map((r) => (passes(r) ? 1 : 0.12))}, opacity: 1, cliponaxis: true};
  });
}

function scenePlot(scene) {
  const rows = scene.rows.map((k) => data.rows[k]).filter(counts);
  const points = data.published_points.filter((p) => data.rows[p.row].scene === scene.name && counts(data.rows[p.row]));
  const traces = familyTraces(rows);
  const front = scene.pareto.map((k) => data.rows[k]).filter(counts).sort((a, b) => costOf(a) - costOf(b));
  if (front.length && !state.moves)
    traces.unshift({type: "scatter", mode: "lines", name: "frontier", x: front.map(costOf), y: front.map((r) => 100 * leastError(r)), line: {color: paint("--soft"), width: 1.5, dash: "dot"}});
  if (points.length)
    traces.push({type: "scatter", mode: "markers", name: "published time", x: points.map((p) => p.ms), y: points.map((p) => 100 * leastError(data.rows[p.row])),
      marker: {symbol: "asterisk-open", size: 10, color: paint("--soft"), line: {width: 1.4, color: paint("--soft")}}});
  const xs = logRange([...rows.map(costOf), ...points.map((p) => p.ms)], 0.05), images = untimed(scene).slice(0, 6), ys = logRange([...rows, ...images].map((r) => 100 * leastError(r)), 0.08);
  const shapes = [], annotations = [];
  for (const image of images) {
    shapes.push({type: "line", xref: "paper", x0: 0, x1: 1, y0: 100 * leastError(image), y1: 100 * leastError(image), line: {color: paint("--soft"), width: 1.2, dash: "dashdot"}, layer: "below"});
    annotations.push({xref: "paper", x: 0, xanchor: "left", y: Math.log10(100 * leastError(image)), yanchor: "bottom", text: `${plotText(shortLabel(image.label))}: no time`, showarrow: false, font: {size: 11, color: paint("--soft")}});
  }
  if (scene.floor) {
    ys[0] = Math.min(ys[0], Math.log10(100 * scene.floor) - 0.15);
    shapes.push({type: "rect", xref: "paper", x0: 0, x1: 1, y0: 10 ** (ys[0] - 3), y1: 100 * scene.floor, fillcolor: paint("--band"), line: {width: 0}, layer: "below"});
    annotations.push({xref: "paper", x: 1, xanchor: "right", y: Math.log10(100 * scene.floor), yanchor: "top", text: "the reference's noise: ties", showarrow: false, font: {size: 11, color: paint("--soft")}});
  }
  return {rows, traces, layout: layout({shapes, annotations, height: isNarrow() ? 320 + 19 * traces.length : 460, xaxis: logAxis(state.moves ? "ms a frame, the mesh moves" : "ms a frame", {range: xs}), yaxis: logAxis("error, % of truth", {range: ys})})};
}

/// A plot and its table: what the eye sees, a screen reader reads. Returns where the plot goes.
function figureBox(parent, label, heads, lines) {
  const place = el("div", {class: "plot", role: "img", "aria-label": `${label}; its figures are in the table below`});
  const details = el("details", {class: "data"}, el("summary", {}, `${label} as a table`));
  details.addEventListener("toggle", () => {
    if (details.children.length === 1) details.append(el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": label}, table(heads, lines.map((cells) => ({cells})), {caption: label})));
  });
  parent.append(place, details);
  return place;
}

async function draw(place, traces, how) {
  const P = await plotly();
  const inner = place.firstElementChild ?? place.appendChild(el("div", {"aria-hidden": "true"}));
  await P.react(inner, traces, how, config);
  place.dataset.drawn = "yes";
  return inner;
}
