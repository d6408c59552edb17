// OBJ: the numbers of vertices and normals are replaced in the text, all else stays as it is.
import {FileError, addPolygon, bytesOf, digitsOf, hasMoved, patched, textOf} from './mesh_file.js';

export function readObj(bytes) {
  const text = textOf(bytes);
  const V = [], N = [], places = {v: [], vn: []}, F = [], which = [];
  let hasNormals = true;
  for (const line of text.matchAll(/^[ \t]*(v|vn|f)[ \t]+(.*)$/gm)) {
    const begin = line.index + line[0].length - line[2].length;
    if (line[1] === 'f') {
      const corners = line[2].trim().split(/\s+/).map((corner) => corner.split('/'));
      const indexOf = (word, count) => (Number(word) < 0 ? count + Number(word) : Number(word) - 1);
      addPolygon(corners.map(([v]) => indexOf(v, V.length / 3)), F);
      hasNormals &&= corners.every((corner) => corner[2]);
      if (hasNormals) addPolygon(corners.map((corner) => indexOf(corner[2], N.length / 3)), which);
      continue;
    }
    const row = line[2].match(/^\s*(\S+\s+\S+\s+\S+)/);
    if (!row) throw new FileError(`this OBJ file has a vertex without three numbers: ${line[0].slice(0, 80)}`);
    (line[1] === 'v' ? V : N).push(...row[1].split(/\s+/).map(Number));
    places[line[1]].push([begin, begin + row[0].length]);
  }
  if (V.length === 0) throw new FileError('this OBJ file has no vertices');
  const mesh = {V: Float64Array.from(V), F: Int32Array.from(F), notes: [],
                normals: hasNormals && which.length > 0 ? {N: Float64Array.from(N), which: Int32Array.from(which)} : null};
  mesh.save = (after, normals) => {
    const changes = [];
    for (const [before, now, where] of [[mesh.V, after, places.v], [mesh.normals?.N, normals, places.vn]])
      for (let i = 0; now && i < where.length; i++)
        if (hasMoved(before, now, i))
          changes.push([...where[i], Array.from(now.subarray(3 * i, 3 * i + 3), (x) => digitsOf(x, false)).join(' ')]);
    return bytesOf(patched(text, changes.sort((one, other) => one[0] - other[0])));
  };
  return mesh;
}
