// Small helpers. Texts that come from files reach the page through textContent alone.
const $ = (selector, root = document) => root.querySelector(selector);
const $$ = (selector, root = document) => [...root.querySelectorAll(selector)];

function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes))
    if (name === "class") node.className = value;
    else if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

const digits = (value, n = 3) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(n))));
const msText = (ms) => (ms === null ? "–" : ms < 1000 ? `${digits(ms)} ms` : `${digits(ms / 1000)} s`);
const percentText = (x) => (x === null || x === undefined ? "–" : `${digits(100 * x)} %`);
function sizeText(bytes) {
  if (bytes === null) return "–";
  for (const unit of ["B", "kB", "MB"]) {
    if (bytes < 1000) return `${digits(bytes)} ${unit}`;
    bytes /= 1000;
  }
  return `${digits(bytes)} GB`;
}

/// Plotly reads a little HTML in texts; nothing that a file says may be any.
const plotText = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

/// Calls `act` at most once a frame.
function onFrame(act) {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      act();
    });
  };
}

/// Calls `act(node)` when a node comes near the screen, once.
const nearby = new IntersectionObserver((entries) => {
  for (const entry of entries)
    if (entry.isIntersecting) {
      nearby.unobserve(entry.target);
      entry.target.whenNear();
    }
}, {rootMargin: "300px"});
function whenNear(node, act) {
  node.whenNear = act;
  nearby.observe(node);
}

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function download(name, type, parts) {
  const url = URL.createObjectURL(new Blob(parts, {type}));
  el("a", {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
