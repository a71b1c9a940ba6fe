// FLIP (Andersson et al. 2020) at one exposure with the ACES tone mapper of HDR-FLIP (2021), 67 pixels per degree: what
// harness/results/flip.cpp computes. tests/report compare it with the authors' evaluator.
const flip = (() => {
  const perDegree = 0.7 * 3840 / 0.7 * Math.PI / 180;
  const m = [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794, 2613072 / 12288897, 8788810 / 12288897,
    887015 / 12288897, 1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382];
  const white = [m[0] + m[1] + m[2], m[3] + m[4] + m[5], m[6] + m[7] + m[8]];
  const inverse = (() => {
    const [a, b, c, d, e, f, g, h, i] = m, det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    return [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f, d * h - e * g, b * g - a * h,
      a * e - b * d].map((x) => x / det);
  })();
  const xyz = (r, g, b) => [0, 1, 2].map((k) => (m[3 * k] * r + m[3 * k + 1] * g + m[3 * k + 2] * b) / white[k]);

  const toneMap = (x) => {
    x *= 0.6;
    return Math.min(1, Math.max(0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)));
  };
  const bent = (t) => (t > (6 / 29) ** 3 ? Math.cbrt(t) : t / (3 * (6 / 29) ** 2) + 4 / 29);
  function lab(r, g, b) {  // with Hunt's adjustment
    const [fx, fy, fz] = xyz(r, g, b).map(bent), l = 116 * fy - 16;
    return [l, 0.01 * l * 500 * (fx - fy), 0.01 * l * 200 * (fy - fz)];
  }
  const distance = (a, b) => Math.abs(a[0] - b[0]) + Math.hypot(a[1] - b[1], a[2] - b[2]);

  /// Rows by `across`, columns by `down`; the border's pixels go on outside.
  function filtered(plane, w, h, across, down) {
    const r = across.length >> 1, middle = new Float32Array(w * h), out = new Float32Array(w * h), line = new Float32Array(Math.max(w, h) + 2 * r);
    for (let y = 0; y < h; ++y) {
      for (let x = -r; x < w + r; ++x) line[x + r] = plane[y * w + Math.min(w - 1, Math.max(0, x))];
      for (let x = 0; x < w; ++x) {
        let sum = 0;
        for (let k = 0; k <= 2 * r; ++k) sum += across[k] * line[x + k];
        middle[y * w + x] = sum;
      }
    }
    for (let x = 0; x < w; ++x) {
      for (let y = -r; y < h + r; ++y) line[y + r] = middle[Math.min(h - 1, Math.max(0, y)) * w + x];
      for (let y = 0; y < h; ++y) {
        let sum = 0;
        for (let k = 0; k <= 2 * r; ++k) sum += down[k] * line[y + k];
        out[y * w + x] = sum;
      }
    }
    return out;
  }
  const kernel = (radius, at) => Float64Array.from({length: 2 * radius + 1}, (_, k) => at(k - radius));
  const gaussian = (sigma, radius) => {
    const g = kernel(radius, (x) => Math.exp(-0.5 * x * x / (sigma * sigma))), sum = g.reduce((a, b) => a + b);
    return g.map((x) => x / sum);
  };
  const seenRadius = Math.ceil(3 * Math.sqrt(0.04 / (2 * Math.PI ** 2)) * perDegree);
  const terms = (pairs) => {
    const all = pairs.map(([a, b]) => {
      const sigma = Math.sqrt(0.5 * b) / Math.PI * perDegree;
      const mass = kernel(seenRadius, (x) => Math.exp(-0.5 * x * x / (sigma * sigma))).reduce((p, q) => p + q);
      return {kernel: gaussian(sigma, seenRadius), mass: a * Math.sqrt(Math.PI / b) * mass * mass};
    });
    const sum = all.reduce((total, term) => total + term.mass, 0);
    return all.map((term) => ({kernel: term.kernel, mass: term.mass / sum}));
  };
  const sensitivity = [terms([[1, 0.0047]]), terms([[1, 0.0053]]), terms([[34.1, 0.04], [13.5, 0.025]])];
  function seen(plane, w, h, channel) {
    const out = new Float32Array(w * h);
    for (const term of sensitivity[channel]) {
      const part = filtered(plane, w, h, term.kernel, term.kernel);
      for (let i = 0; i < out.length; ++i) out[i] += term.mass * part[i];
    }
    return out;
  }
  const sigma = 0.5 * 0.082 * perDegree, radius = Math.ceil(3 * sigma), smooth = gaussian(sigma, radius);
  const unit = (g) => {  // positive and negative weights sum to 1 and -1
    const up = g.reduce((s, x) => s + Math.max(0, x), 0), low = g.reduce((s, x) => s - Math.min(0, x), 0);
    return g.map((x) => x / (x > 0 ? up : low));
  };
  const slope = unit(kernel(radius, (x) => -x * Math.exp(-0.5 * x * x / (sigma * sigma))));
  const bend = unit(kernel(radius, (x) => (x * x / (sigma * sigma) - 1) * Math.exp(-0.5 * x * x / (sigma * sigma))));
  function strength(plane, w, h, derivative) {
    const dx = filtered(plane, w, h, derivative, smooth), dy = filtered(plane, w, h, smooth, derivative);
    for (let i = 0; i < dx.length; ++i) dx[i] = Math.hypot(dx[i], dy[i]);
    return dx;
  }

  function prepared(rgb, w, h, exposure) {
    const n = w * h, planes = [0, 1, 2].map(() => new Float32Array(n)), grey = new Float32Array(n);
    for (let i = 0; i < n; ++i) {
      const [x, y, z] = xyz(...[0, 1, 2].map((c) => toneMap(exposure * (Number.isFinite(rgb[3 * i + c]) ? rgb[3 * i + c] : 0))));
      planes[0][i] = 116 * y - 16, planes[1][i] = 500 * (x - y), planes[2][i] = 200 * (y - z);
      grey[i] = y;
    }
    const [s0, s1, s2] = planes.map((plane, c) => seen(plane, w, h, c)), colours = new Float32Array(3 * n);
    const clamp = (x) => Math.min(1, Math.max(0, x));
    for (let i = 0; i < n; ++i) {
      const y = (s0[i] + 16) / 116, X = (y + s1[i] / 500) * white[0], Y = y * white[1], Z = (y - s2[i] / 200) * white[2];
      colours.set(lab(...[0, 1, 2].map((k) => clamp(inverse[3 * k] * X + inverse[3 * k + 1] * Y + inverse[3 * k + 2] * Z))), 3 * i);
    }
    return {colours, edge: strength(grey, w, h, slope), point: strength(grey, w, h, bend)};
  }

  /// FLIP of every pixel.
  return function (image, reference, w, h, exposure) {
    const a = prepared(image, w, h, exposure), b = prepared(reference, w, h, exposure), out = new Float32Array(w * h);
    const largest = distance(lab(0, 1, 0), lab(0, 0, 1)) ** 0.7, knee = 0.4 * largest;
    for (let i = 0; i < out.length; ++i) {
      const d = distance(a.colours.subarray(3 * i, 3 * i + 3), b.colours.subarray(3 * i, 3 * i + 3)) ** 0.7;
      const colour = d < knee ? 0.95 / knee * d : 0.95 + 0.05 * (d - knee) / (largest - knee);
      const feature = Math.sqrt(Math.max(Math.abs(a.edge[i] - b.edge[i]), Math.abs(a.point[i] - b.point[i])) / Math.SQRT2);
      out[i] = colour ** (1 - feature);
    }
    return out;
  };
})();
