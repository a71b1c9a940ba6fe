// Medians over the runs of one machine.
function setUpHistory() {
  const past = data.history;
  if (!past || !data.scenes.length) return () => {};
  const box = $("#history .plots");
  const show = () => {
    box.replaceChildren();
    const scene = data.scenes[$("#history-scene").value || 0];
    const front = new Set(scene.pareto), rows = scene.rows.filter((k) => past.series[k]).sort((a, b) => front.has(b) - front.has(a));
    if (!rows.length) return void box.append(el("p", {class: "how"}, "No run has a row of this scene."));
    const name = (place) => `${past.runs[place].date.replace("T", " ")} ${past.runs[place].commit}`;
    const shown = rows.slice(0, 12);
    if (rows.length > shown.length) box.append(el("p", {class: "how"}, `${shown.length} of ${rows.length} rows, those of the frontier first; the table has all.`));
    const place = figureBox(box, "Medians by run", ["row", "run", "ms", "±"], rows.flatMap((k) => past.series[k].map(([at, ms, spread]) => [data.rows[k].label, name(at), ms, spread])));
    const traces = shown.map((k, n) => ({type: "scatter", mode: "lines+markers", name: plotText(shortLabel(data.rows[k].label)), x: past.series[k].map(([at]) => at), y: past.series[k].map(([, ms]) => ms),
      error_y: {type: "data", array: past.series[k].map(([, , spread]) => spread), thickness: 1}, line: {color: palette[n % palette.length], dash: n < palette.length ? "solid" : "dash"},
      marker: {size: 8, color: palette[n % palette.length], symbol: markers[n % markers.length]}}));
    draw(place, traces, layout({height: 420 + 18 * shown.length, legend: {orientation: "v", y: -0.3, yanchor: "top", x: 0}, showlegend: true,
      xaxis: axis("", {tickvals: past.runs.map((_, k) => k), ticktext: past.runs.map((run) => `${run.date.slice(0, 10)}<br>${plotText(run.commit.slice(0, 7))}`), range: [-0.4, past.runs.length - 0.6]}), yaxis: logAxis("ms a frame", {range: logRange(shown.flatMap((k) => past.series[k].map(([, ms]) => ms)))})}));
  };
  $("#history-scene").addEventListener("change", show);
  $("#history-controls").addEventListener("submit", (event) => event.preventDefault());
  whenNear($("#history"), () => { box.near = true; show(); });
  return () => box.near && show();
}
