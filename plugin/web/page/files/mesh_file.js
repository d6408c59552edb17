// What readers of mesh files share. A reader returns a mesh that keeps the bytes it came from:
//   V        Float64Array, n x 3
//   F        Int32Array, m x 3
//   normals  {N: Float64Array k x 3, which: Int32Array m x 3} of the file, if it has any
//   notes    what the reader has left out or changed, in sentences
//   save     (V, N) => the bytes of the same file, where only moved vertices and their normals differ

/** Something in a file that cannot be read; the text says what to do. */
export class FileError extends Error {}

export const textOf = (bytes) => new TextDecoder('latin1').decode(bytes);

export function bytesOf(text) {
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** The triangles of a polygon, as a fan. */
export function addPolygon(corners, F) {
  for (let i = 2; i < corners.length; i++) F.push(corners[0], corners[i - 1], corners[i]);
}

/** Whether row i of n x 3 numbers has changed. */
export const hasMoved = (before, after, i) =>
  before[3 * i] !== after[3 * i] || before[3 * i + 1] !== after[3 * i + 1] || before[3 * i + 2] !== after[3 * i + 2];

/** The shortest text for a number; of those that are single precision if `isSingle`. */
export function digitsOf(number, isSingle) {
  if (!isSingle) return String(number);
  const single = Math.fround(number);
  for (let digits = 6; digits < 9; digits++) {
    const text = String(Number(single.toPrecision(digits)));
    if (Math.fround(text) === single) return text;
  }
  return String(Number(single.toPrecision(9)));
}

/** The text with pieces replaced: [begin, end, piece], in ascending order. */
export function patched(text, changes) {
  const pieces = [];
  let from = 0;
  for (const [begin, end, piece] of changes) {
    pieces.push(text.slice(from, begin), piece);
    from = end;
  }
  pieces.push(text.slice(from));
  return pieces.join('');
}

/** Joins corners at the same point: the points that differ, and the point of each corner. */
export function joined(corners) {
  const count = corners.length / 3;
  const bits = new Uint32Array(Float32Array.from(corners, (x) => x + 0).buffer);
  const size = 2 ** Math.ceil(Math.log2(2 * count + 2));
  const table = new Int32Array(size).fill(-1), F = new Int32Array(count), first = [];
  const same = (a, b) => !hasMovedBetween(corners, a, b);
  for (let i = 0; i < count; i++) {
    let at = (Math.imul(bits[3 * i], 73856093) ^ Math.imul(bits[3 * i + 1], 19349663) ^ Math.imul(bits[3 * i + 2], 83492791)) >>> 0;
    at = (at ^ (at >>> 15)) & (size - 1);
    while (table[at] >= 0 && !same(first[table[at]], i)) at = (at + 1) & (size - 1);
    if (table[at] < 0) table[at] = first.push(i) - 1;
    F[i] = table[at];
  }
  const V = new Float64Array(3 * first.length);
  first.forEach((corner, i) => V.set(corners.subarray(3 * corner, 3 * corner + 3), 3 * i));
  return {V, F};
}

const hasMovedBetween = (corners, a, b) =>
  corners[3 * a] !== corners[3 * b] || corners[3 * a + 1] !== corners[3 * b + 1] || corners[3 * a + 2] !== corners[3 * b + 2];

/** The unit normal of a triangle of these three vertices. */
export function facetNormal(V, a, b, c) {
  const [u, v] = [b, c].map((corner) => [0, 1, 2].map((k) => V[3 * corner + k] - V[3 * a + k]));
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...n);
  return length > 0 ? n.map((x) => x / length) : n;
}
