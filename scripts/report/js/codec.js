// Undoes images.py: bytes of an image become linear pixels.
function bytesOf(id) {
  const text = atob(document.getElementById(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
}

async function inflated(id, format) {
  const stream = new Blob([bytesOf(id)]).stream().pipeThrough(new DecompressionStream(format));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// One plane of 16-bit levels: what the median of the neighbours does not foretell, low bytes before high ones.
function planeFrom(bytes, at, w, h) {
  const plane = new Int16Array(w * h), n = w * h;
  for (let y = 0, i = 0; y < h; ++y)
    for (let x = 0; x < w; ++x, ++i) {
      const z = bytes[at + i] | (bytes[at + n + i] << 8);
      const a = x ? plane[i - 1] : 0, b = y ? plane[i - w] : 0, c = x && y ? plane[i - w - 1] : 0;
      const least = Math.min(a, b), most = Math.max(a, b);
      plane[i] = (c >= most ? least : c <= least ? most : a + b - c) + ((z >>> 1) ^ -(z & 1));
    }
  return plane;
}

function pixelsFrom(bytes, about) {
  const {w, h, scale} = about, n = w * h;
  const [green, red, blue] = [0, 2, 4].map((k) => planeFrom(bytes, k * n, w, h));
  const rgb = new Float32Array(3 * n);
  const value = (level) => Math.sign(level) * scale * (level / 4095) ** 2;
  for (let i = 0; i < n; ++i) {
    rgb[3 * i] = value(green[i] + red[i]);
    rgb[3 * i + 1] = value(green[i]);
    rgb[3 * i + 2] = value(green[i] + blue[i]);
  }
  for (const i of about.bad) rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = NaN;
  return rgb;
}

const decoded = new Map();
/// {w, h, rgb, about} of an image, by its number.
function imageOf(number) {
  if (!decoded.has(number)) {
    const about = data.images[number];
    decoded.set(number, inflated(`image-${number}`, "deflate").then((bytes) => ({w: about.w, h: about.h, rgb: pixelsFrom(bytes, about), about})));
    if (decoded.size > 24) decoded.delete(decoded.keys().next().value);
  }
  return decoded.get(number);
}
