// Slider, filters, colours.
function setUpControls() {
  const slider = $("#limit"), output = $("#limit-text"), ticks = $(".slider .ticks");
  ticks.removeAttribute("aria-hidden");
  for (const limit of data.limits)
    ticks.append(el("button", {type: "button", "data-limit": limit, onclick: () => { state.limit = limit; show(); changed("limit"); }}, percentText(limit)));

  const move = onFrame(() => {
    state.limit = limitAt(Number(slider.value));
    setText(output, percentText(state.limit));
    changed("limit");
  });
  slider.addEventListener("input", move);

  const boxes = (name) => $$(`input[name=${name}]`);
  for (const name of ["technique", "backend"])
    for (const box of boxes(name))
      box.addEventListener("change", () => {
        const on = boxes(name).filter((b) => b.checked).map((b) => b.value);
        state[name] = on.length === boxes(name).length ? null : new Set(on);
        show();
        changed("filter");
      });
  for (const name of ["prepare", "memory"])
    $("#" + name).addEventListener("change", (event) => { state[name] = Number(event.target.value) || null; changed("filter"); });
  $("#moves").addEventListener("change", (event) => { state.moves = event.target.checked; show(); changed("filter"); });
  $("#controls").addEventListener("submit", (event) => event.preventDefault());
  $("#controls").addEventListener("reset", (event) => {
    event.preventDefault();
    Object.assign(state, {technique: null, backend: null, prepare: null, memory: null, moves: false});
    show();
    changed("filter");
  });

  function show() {
    slider.value = placeOf(state.limit);
    slider.setAttribute("aria-valuetext", percentText(state.limit));
    setText(output, percentText(state.limit));
    for (const name of ["technique", "backend"]) {
      for (const box of boxes(name)) box.checked = !state[name] || state[name].has(box.value);
      setText($(`#${name}-filter .count`), `${boxes(name).filter((b) => b.checked).length} of ${boxes(name).length}`);
    }
    $("#prepare").value = state.prepare ?? "", $("#memory").value = state.memory ?? "";
    $("#moves").checked = state.moves;
    $("#moves-note").hidden = !state.moves;
  }
  show();
  return show;
}

const isDark = () => document.documentElement.dataset.theme === "dark" ||
  (!document.documentElement.dataset.theme && matchMedia("(prefers-color-scheme: dark)").matches);
function setUpTheme(repaint) {
  $("#theme").addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    repaint();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
}
