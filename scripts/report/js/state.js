// What is chosen on the page; it lives behind the # of the address, so that an address shows what its sender saw.
const state = {limit: 0.02, technique: null, backend: null, prepare: null, memory: null, moves: false, picks: [], view: {}};
const listeners = [];

function changed(what) {
  for (const listener of listeners) listener(what);
  saveSoon();
}

const limitAt = (place) => Number((0.001 * 1000 ** (place / 1000)).toPrecision(3));
const placeOf = (limit) => Math.round(1000 * Math.log(limit / 0.001) / Math.log(1000));

function hashOf() {
  const q = new URLSearchParams();
  if (state.limit !== 0.02) q.set("error", state.limit);
  for (const name of ["technique", "backend"]) if (state[name]) for (const value of state[name].size ? state[name] : [""]) q.append(name, value);
  for (const name of ["prepare", "memory"]) if (state[name]) q.set(name, state[name]);
  if (state.moves) q.set("moves", 1);
  if (state.picks.length) q.set("picked", state.picks.join("-"));
  for (const [name, value] of Object.entries(state.view)) if (value !== null) q.set(name, value);
  return q.toString();
}

function readHash() {
  const q = new URLSearchParams(location.hash.slice(1));
  const number = (name) => (Number(q.get(name)) > 0 ? Number(q.get(name)) : null);
  state.limit = Math.min(1, Math.max(0.001, number("error") ?? 0.02));
  for (const name of ["technique", "backend"]) state[name] = q.has(name) ? new Set(q.getAll(name)) : null;
  state.prepare = number("prepare"), state.memory = number("memory"), state.moves = q.has("moves");
  state.picks = (q.get("picked") ?? "").split("-").filter((x) => /^\d+$/.test(x) && Number(x) < data.rows.length).map(Number).slice(0, 2);
  state.view = {};
  for (const name of ["scene", "a", "b", "mode", "ev"]) if (q.has(name)) state.view[name] = q.get(name);
}

let saveTimer = null, saved = null;
/// Browsers allow few changes of the address a second.
function saveSoon() {
  clearTimeout(saveTimer);
  saveTimer = setTimeout(() => {
    saved = hashOf();
    if (saved !== location.hash.slice(1)) history.replaceState(null, "", saved ? "#" + saved : location.pathname + location.search);
  }, 250);
}
