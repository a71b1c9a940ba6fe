// Tables that sort, and rows as files.
const columns = [
  ["row", (r) => r.label], ["ms", (r) => r.frame], ["±", (r) => (r.frame === null ? null : r.spread)], ["error %", (r) => (r.error === null ? null : 100 * r.error)],
  ["from", (r) => r.source], ["FLIP", (r) => r.rungs.truth?.flip ?? null], ["SSIM", (r) => r.rungs.truth?.ssim ?? null],
  ["cube %", (r) => percentOf(r, "cube")], ["spheres %", (r) => percentOf(r, "spheres")], ["prepare ms", (r) => r.prepare],
  ["update ms", (r) => r.update], ["shade ms", (r) => r.shade], ["MB", (r) => (r.bytes === null ? null : r.bytes / 1e6)], ["threads", (r) => r.threads],
];
const percentOf = (row, rung) => (row.rungs[rung]?.rel_rmse == null ? null : 100 * row.rungs[rung].rel_rmse);
const cellText = (value) => (typeof value !== "number" ? value ?? "–" : Number.isInteger(value) ? String(value) : digits(value));

function table(heads, lines, options = {}) {
  const numeric = heads.map((_, k) => lines.some((line) => typeof line.cells[k] === "number"));
  const head = el("tr", {}, ...heads.map((text, k) => el("th", {scope: "col", class: numeric[k] ? "number" : ""}, text)));
  const body = el("tbody");
  for (const line of lines)
    body.append(el("tr", {class: line.className ?? ""}, ...line.cells.map((value, k) =>
      el(k ? "td" : "th", {class: numeric[k] && (typeof value === "number" || value == null) ? "number" : "", "data-value": typeof value === "number" ? value : null, scope: k ? null : "row"}, cellText(value)))));
  const node = el("table", {class: "rows"}, el("caption", {class: "hidden"}, options.caption ?? ""), el("thead", {}, head), body);
  sortable(node);
  return node;
}

/// Clicks on heads sort: numbers by data-value, all else by its text; what is not known stays below.
function sortable(node) {
  const heads = $$("thead th", node);
  heads.forEach((head, column) => {
    const button = el("button", {type: "button"}, ...head.childNodes);
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const key = (row) => {
        const cell = row.cells[column], value = cell.dataset.value;
        return value !== undefined && value !== "" && value !== "None" ? Number(value) : cell.textContent.trim();
      };
      const missing = (value) => value === "" || value === "–";
      const keyed = [...node.tBodies[0].rows].map((row) => [key(row), row]);
      keyed.sort(([a], [b]) => {
        if (missing(a) || missing(b)) return missing(a) - missing(b);
        const order = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b));
        return down ? -order : order;
      });
      node.tBodies[0].append(...keyed.map(([, row]) => row));
    });
  });
}

function setUpRowTables() {
  for (const article of $$("article.scene")) {
    const details = $("details.data", article), scene = data.scenes[article.dataset.scene];
    details.addEventListener("toggle", () => {
      const box = $(".scroll", details);
      if (!details.open || box.firstChild) return;
      const rows = scene.rows.map((k) => data.rows[k]).sort((a, b) => (a.frame ?? Infinity) - (b.frame ?? Infinity));
      box.append(table(columns.map(([name]) => name), rows.map((row) => ({
        className: row.status === "ok" ? "" : "grey",
        cells: columns.map(([name, value]) => (name === "from" && row.status !== "ok" ? row.status : value(row))),
      })), {caption: `Rows of ${scene.title}`}));
    });
  }
  $$("table.sortable").forEach(sortable);
}

/// RFC 4180; a text that a spreadsheet would take for a formula gets an apostrophe before it.
function csvCell(value) {
  if (value === null || value === undefined) return "";
  const text = typeof value === "string" && /^[=+\-@\t\r]/.test(value) ? "'" + value : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
}
function flat(value, name, out) {
  if (value !== null && typeof value === "object") for (const [key, inner] of Object.entries(value)) flat(inner, name ? `${name}.${key}` : key, out);
  else out[name] = value;
  return out;
}
function csvOf(rows) {
  const hidden = new Set(["image", "missing", "label", "truth", "regions", "told"]);
  const lines = rows.map((row) => flat(Object.fromEntries(Object.entries(row).filter(([key]) => !hidden.has(key))), "", {}));
  const names = [...new Set(lines.flatMap((line) => Object.keys(line)))];
  return [names, ...lines.map((line) => names.map((name) => line[name]))].map((cells) => cells.map(csvCell).join(",") + "\r\n").join("");
}

function setUpDownloads() {
  $("#download-json").addEventListener("click", async () => download("results.json", "application/json", [await inflated("raw", "gzip")]));
  $("#download-csv").addEventListener("click", () => download("rows.csv", "text/csv", [csvOf(data.rows)]));
  $("#download-selected").addEventListener("click", () => download("selected.csv", "text/csv", [csvOf(data.rows.filter(passes))]));
}
