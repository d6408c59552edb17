// STL, text and binary: corners at the same point are one vertex; all else stays as it is.
import {FileError, bytesOf, digitsOf, facetNormal, hasMoved, joined, patched, textOf} from './mesh_file.js';

const kHead = 84, kFacet = 50;

export function readStl(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const count = bytes.length >= kHead ? view.getUint32(80, true) : 0;
  if (bytes.length >= kHead + kFacet * count && count > 0) return readBinary(bytes, view, count);
  if (/^\s*solid/.test(textOf(bytes.subarray(0, 1024)))) return readText(textOf(bytes));
  throw new FileError('this STL file ends early, or is none: it is damaged, or was not wholly copied');
}

function readBinary(bytes, view, count) {
  const corners = new Float64Array(9 * count);
  for (let f = 0; f < count; f++)
    for (let k = 0; k < 9; k++) corners[9 * f + k] = view.getFloat32(kHead + kFacet * f + 12 + 4 * k, true);
  const {V, F} = joined(corners);
  function save(after) {
    const copy = bytes.slice(), target = new DataView(copy.buffer);
    for (let f = 0; f < count; f++) {
      const triangle = F.subarray(3 * f, 3 * f + 3), at = kHead + kFacet * f;
      if (!triangle.some((corner) => hasMoved(V, after, corner))) continue;
      facetNormal(after, ...triangle).forEach((x, k) => target.setFloat32(at + 4 * k, x, true));
      triangle.forEach((corner, c) => {
        for (let k = 0; k < 3; k++) target.setFloat32(at + 12 + 12 * c + 4 * k, after[3 * corner + k], true);
      });
    }
    return copy;
  }
  return {V, F, normals: null, notes: [], save};
}

function readText(text) {
  const number = '([-+0-9.eE]+)';
  const row = new RegExp(`(normal|vertex)\\s+${number}\\s+${number}\\s+${number}`, 'dgi');
  const corners = [], places = [], normalPlaces = [];
  for (const found of text.matchAll(row)) {
    const isNormal = found[1].toLowerCase() === 'normal';
    (isNormal ? normalPlaces : places).push([found.indices[2][0], found.indices[4][1]]);
    if (!isNormal) corners.push(...found.slice(2).map(Number));
  }
  if (corners.length === 0 || corners.length % 9) throw new FileError('this STL file has facets without three vertices each');
  const {V, F} = joined(Float64Array.from(corners));
  function save(after) {
    const changes = [];
    for (let f = 0; f < F.length / 3; f++) {
      const triangle = F.subarray(3 * f, 3 * f + 3);
      if (!triangle.some((corner) => hasMoved(V, after, corner))) continue;
      const row3 = (values, isSingle) => Array.from(values, (x) => digitsOf(x, isSingle)).join(' ');
      if (normalPlaces.length === F.length / 3) changes.push([...normalPlaces[f], row3(facetNormal(after, ...triangle), true)]);
      triangle.forEach((corner, c) => {
        if (hasMoved(V, after, corner)) changes.push([...places[3 * f + c], row3(after.subarray(3 * corner, 3 * corner + 3), false)]);
      });
    }
    return bytesOf(patched(text, changes));
  }
  return {V, F, normals: null, notes: [], save};
}
