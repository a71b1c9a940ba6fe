// Which row is the fastest within an error: the rules of harness/results/derived.cpp.
const faster = (a, b) => costOf(a) + a.spread + b.spread < costOf(b);
const nearer = (a, b) => Math.max(a.error, a.floor) < Math.max(b.error, a.floor);
const counts = (row) => row.status === "ok" && row.frame !== null && row.error !== null;

/// Images of other renderers, of which no time is known.
const untimed = (scene) => scene.rows.map((k) => data.rows[k]).filter((row) => row.status === "ok" && row.frame === null && row.error !== null);

/// ms that a frame of a row counts: if the mesh moves, a scene at rest pays for its preparation, too.
const costOf = (row) => row.frame + (state.moves && !row.moves ? row.prepare ?? 0 : 0);

const passes = (row) => (!state.technique || state.technique.has(row.technique)) && (!state.backend || state.backend.has(row.backend)) &&
  (!state.prepare || (row.prepare ?? 0) <= state.prepare) && (!state.memory || (row.bytes ?? 0) <= state.memory);

function cheapest(numbers, limit) {
  const within = numbers.map((k) => data.rows[k]).filter((row) => counts(row) && passes(row) && (row.error <= limit || row.tie));
  if (!within.length) return null;
  const fastest = within.reduce((best, row) => (costOf(row) < costOf(best) ? row : best));
  let best = fastest;
  for (const row of within) if (!faster(fastest, row) && nearer(row, best)) best = row;
  return best;
}
