// Okabe & Ito's colours, which the colour-blind tell apart too; techniques differ by their marker as well.
// The first is lighter on dark paper.
const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a8a8a", "#b8a800"];
const markers = ["circle", "square", "diamond", "triangle-up", "triangle-down", "cross", "x", "star", "hexagon", "pentagon", "bowtie", "hourglass"];
const colourOf = (technique) => palette[Math.max(0, techniques().indexOf(technique)) % palette.length];
const markerOf = (technique, backend) =>
  markers[Math.max(0, techniques().indexOf(technique)) % markers.length] + ({scalar: "-open", cuda: "-open-dot", external: "-open"}[backend] || "");

let allTechniques = null;
function techniques() {
  allTechniques ??= [...new Set(data.rows.map((row) => row.technique))].sort();
  return allTechniques;
}

const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const encode = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const byteTable = Uint8ClampedArray.from({length: 4097}, (_, k) => 255 * encode(k / 4096) + 0.5);
const shownByte = (x) => byteTable[x <= 0 ? 0 : x >= 1 ? 4096 : (4096 * x + 0.5) | 0];

/// Red is brighter, blue is darker; e = 1 is full colour.
function signedColour(e, out, at) {
  const c = Math.max(-1, Math.min(1, e)), fade = 255 * (1 - Math.abs(c));
  out[at] = c >= 0 ? 255 : fade;
  out[at + 1] = fade;
  out[at + 2] = c >= 0 ? fade : 255;
}

/// The colours "magma" of Smith & van der Walt, every sixteenth.
const magma = ["000004", "0b0924", "20114b", "3b0f70", "57157e", "721f81", "8c2981", "a8327d", "c43c75", "de4968", "f1605d",
  "fa7f5e", "fe9f6d", "febf84", "fddea0", "fcf0b2", "fcfdbf"].map((hex) => [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16)));
function magmaColour(x, out, at) {
  const place = 16 * Math.max(0, Math.min(1, x)), k = Math.min(15, Math.floor(place)), t = place - k;
  for (let c = 0; c < 3; ++c) out[at + c] = magma[k][c] * (1 - t) + magma[k + 1][c] * t;
}
