// Starts when the whole file is there.
let data = null;

function start() {
  data = JSON.parse(document.getElementById("data").textContent);
  palette[0] = isDark() ? "#4aa3df" : "#0072b2";
  readHash();
  const showControls = setUpControls();
  answerAll();
  const plots = $$("article.scene").map((article) => new ScenePlot(article));
  setUpRowTables();
  setUpDownloads();
  setUpViewer();
  const redrawFigures = setUpFigures(), redrawHistory = setUpHistory();
  for (const button of $$("button.pictures")) button.addEventListener("click", () => viewExtra(Number(button.dataset.extra)));
  const redraw = () => {
    palette[0] = isDark() ? "#4aa3df" : "#0072b2";
    plots.filter((plot) => plot.graph).forEach((plot) => plot.draw());
    redrawFigures();
    redrawHistory();
  };
  listeners.push((what) => {
    if (what === "limit" || what === "filter" || what === "all") answerAll();
    if (what === "limit") plots.forEach((plot) => plot.choose());
    if (what === "filter" || what === "all") plots.filter((plot) => plot.graph).forEach((plot) => plot.draw());
    if (what === "picks" || what === "all") showPicked(), plots.forEach((plot) => plot.pick());
    if (what === "view" || what === "all") showView();
  });
  setUpTheme(redraw);
  addEventListener("hashchange", () => {
    if (location.hash.slice(1) === saved || (location.hash && !location.hash.includes("="))) return;  // ours, or a link of this page
    readHash();
    showControls();
    changed("all");
  });
  // Links within the page scroll, and leave what is chosen in the address.
  for (const link of $$("a[href^='#']"))
    link.addEventListener("click", (event) => {
      event.preventDefault();
      const part = $(link.getAttribute("href"));
      part.tabIndex = -1;
      part.focus({preventScroll: true});
      part.scrollIntoView();
    });
  showPicked();
  window.report = {data, state, cheapest, flip, imageOf, chosen, csvOf};  // for tests, and for the curious
  document.documentElement.dataset.ready = "yes";
}

if (document.readyState === "loading") addEventListener("DOMContentLoaded", start);
else start();
