// What the page itself measures, to show it.

/** The diagonal of the vertices' box, and the mean edge of the triangles. */
export function sizesOf(V, F) {
  const low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
  for (let i = 0; i < V.length; i++) {
    low[i % 3] = Math.min(low[i % 3], V[i]);
    high[i % 3] = Math.max(high[i % 3], V[i]);
  }
  let sum = 0;
  for (let i = 0; i < F.length; i++) {
    const a = 3 * F[i], b = 3 * F[i % 3 === 2 ? i - 2 : i + 1];
    const x = V[a] - V[b], y = V[a + 1] - V[b + 1], z = V[a + 2] - V[b + 2];
    sum += Math.sqrt(x * x + y * y + z * z);  // Math.hypot takes five times as long
  }
  return {diagonal: Math.hypot(...low.map((x, k) => high[k] - x)), meanEdge: sum / F.length};
}

/** Unit normals of the vertices, weighted by areas. */
export function normalsOf(V, F) {
  const N = new Float64Array(V.length);
  for (let f = 0; f < F.length; f += 3) {
    const [a, b, c] = [3 * F[f], 3 * F[f + 1], 3 * F[f + 2]];
    for (let k = 0; k < 3; k++) {
      const [i, j] = [(k + 1) % 3, (k + 2) % 3];
      const n = (V[b + i] - V[a + i]) * (V[c + j] - V[a + j]) - (V[b + j] - V[a + j]) * (V[c + i] - V[a + i]);
      N[a + k] += n;
      N[b + k] += n;
      N[c + k] += n;
    }
  }
  for (let i = 0; i < N.length; i += 3) {
    const length = Math.hypot(N[i], N[i + 1], N[i + 2]) || 1;
    for (let k = 0; k < 3; k++) N[i + k] /= length;
  }
  return N;
}

/** Values as shares of the largest but for outliers, the upper percent; what is no number is 0. */
export function scaledValues(values) {
  const sizes = Float64Array.from(values, (x) => Math.abs(x) || 0).sort();
  const largest = sizes[Math.floor(0.99 * (sizes.length - 1))] || sizes.at(-1) || 0;
  const shares = Float32Array.from(values, (x) => (largest > 0 ? x / largest : 0) || 0);
  return {shares, largest, isSigned: values.some((x) => x < 0)};
}
