// The answer in words, for the error that the slider bears.
function sentenceOf(scene) {
  const row = cheapest(scene.rows, state.limit);
  if (!row) {
    const possible = scene.rows.map((k) => data.rows[k]).filter((r) => counts(r) && passes(r));
    const nearest = possible.reduce((best, r) => (!best || r.error < best.error ? r : best), null);
    return {row, text: nearest ? `nothing is within ${percentText(state.limit)}; the nearest is ${nearest.label} with ${percentText(nearest.error)} at ${msText(costOf(nearest))}.`
      : scene.rows.some((k) => counts(data.rows[k])) ? "no measured row is left by the filters." : "no row has a time and an error."};
  }
  const parts = [`${row.label} takes ${msText(costOf(row))}${row.moves ? " ↻" : ""} and errs by ${percentText(row.error)}`];
  if (row.source) parts[0] += `, ${row.source}`;
  const speed = state.moves ? "" : scene.speed_up[data.rows.indexOf(row)] ?? "";
  if (speed) parts.push(speed);
  return {row, text: parts.join("; ") + "."};
}

/// How an image without a time compares: what is as near, and how fast that is.
function imageSentence(scene, row) {
  const other = cheapest(scene.rows, row.error);
  return ` ${row.label}, an image without a time, errs by ${percentText(row.error)}${row.source ? ", " + row.source : ""}` +
    (other ? `; the fastest that is as near is ${other.label}: ${msText(costOf(other))}, ${percentText(other.error)}.` : ".");
}

const chosen = [];  // by scene, the row that the slider chooses, or null
function answerAll() {
  const spans = answerAll.spans ??= $$("#sentences li span");
  data.scenes.forEach((scene, k) => {
    const {row, text} = sentenceOf(scene);
    chosen[k] = row;
    setText(spans[k], text + untimed(scene).slice(0, 4).map((image) => imageSentence(scene, image)).join(""));
  });
}
