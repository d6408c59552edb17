// GLB: positions and normals are replaced in the binary chunk; textures, materials and nodes stay.
import {FileError} from './mesh_file.js';

const kJson = 0x4e4f534a, kFloat = 5126, kTriangles = 4;
const kIndexReads = {5121: ['getUint8', 1], 5123: ['getUint16', 2], 5125: ['getUint32', 4]};
const kIdentity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

// Matrices are column-major, as in the file.
const product = (A, B) => kIdentity.map((_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + A[(i % 4) + 4 * k] * B[k + 4 * Math.floor(i / 4)], 0));

function matrixOf(node) {
  if (node.matrix) return node.matrix;
  const [x, y, z, w] = node.rotation ?? [0, 0, 0, 1], [sx, sy, sz] = node.scale ?? [1, 1, 1];
  return [sx * (1 - 2 * (y * y + z * z)), sx * 2 * (x * y + z * w), sx * 2 * (x * z - y * w), 0,
          sy * 2 * (x * y - z * w), sy * (1 - 2 * (x * x + z * z)), sy * 2 * (y * z + x * w), 0,
          sz * 2 * (x * z + y * w), sz * 2 * (y * z - x * w), sz * (1 - 2 * (x * x + y * y)), 0,
          ...(node.translation ?? [0, 0, 0]), 1];
}

/** M times the difference of two points. */
const turned = (M, d) => [0, 1, 2].map((i) => M[i] * d[0] + M[i + 4] * d[1] + M[i + 8] * d[2]);
const placed = (M, p) => turned(M, p).map((x, i) => x + M[12 + i]);

/** The inverse of the upper 3 x 3 block, for differences. */
function inverseOf(M) {
  const at = (i, j) => M[(i % 3) + 4 * (j % 3)];
  const cofactor = (i, j) => at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1);
  const determinant = [0, 1, 2].reduce((sum, j) => sum + at(0, j) * cofactor(0, j), 0);
  const inverse = [...kIdentity];
  for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) inverse[i + 4 * j] = cofactor(j, i) / determinant;
  return inverse;
}

function chunksOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== 0x46546c67 || view.getUint32(16, true) !== kJson)
    throw new FileError('this is no GLB file of glTF 2.0');
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  if (bytes.length < view.getUint32(8, true)) throw new FileError('this GLB file ends early: it was not wholly copied');
  return {json, rest: 20 + length};
}

/** The matrix of the node that has each mesh; a mesh that several have is taken as the first has it. */
function placesOf(json, notes) {
  const matrices = new Map();
  const visit = (index, parent) => {
    const node = json.nodes[index], matrix = product(parent, matrixOf(node));
    if (node.mesh !== undefined && matrices.has(node.mesh)) notes.add('A mesh that is placed several times is filtered once, as it is placed first.');
    else if (node.mesh !== undefined) matrices.set(node.mesh, matrix);
    for (const child of node.children ?? []) visit(child, matrix);
  };
  const scene = json.scenes?.[json.scene ?? 0];
  for (const root of scene?.nodes ?? []) visit(root, kIdentity);
  return matrices;
}

export function readGlb(bytes) {
  const {json, rest} = chunksOf(bytes);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const notes = new Set();
  for (const name of json.extensionsRequired ?? [])
    if (/compression|quantization/.test(name)) throw new FileError(`this GLB file is compressed (${name}): save it without compression`);

  /** Where the elements of an accessor are: [first byte, stride]. */
  function layoutOf(index, width) {
    const accessor = json.accessors[index], part = json.bufferViews[accessor.bufferView];
    if (!part || accessor.sparse || part.buffer !== 0) throw new FileError('this GLB file has sparse or external data: save it again as one plain file');
    return [rest + 8 + (part.byteOffset ?? 0) + (accessor.byteOffset ?? 0), part.byteStride || width, accessor.count];
  }
  function rowsOf(index, kind) {
    if (json.accessors[index].componentType !== kFloat) throw new FileError(`this GLB file has ${kind} that are no single-precision numbers: save it without compression`);
    const [begin, stride, count] = layoutOf(index, 12);
    return Float64Array.from({length: 3 * count}, (_, i) => view.getFloat32(begin + stride * Math.floor(i / 3) + 4 * (i % 3), true));
  }
  function cornersOf(primitive, count) {
    if (primitive.indices === undefined) return Array.from({length: count}, (_, i) => i);
    const [read, width] = kIndexReads[json.accessors[primitive.indices].componentType];
    const [begin, stride, corners] = layoutOf(primitive.indices, width);
    return Array.from({length: corners}, (_, i) => view[read](begin + stride * i, true));
  }

  const blocks = new Map(), F = [];  // by accessor of positions
  let vertexCount = 0, hasNormals = true;
  for (const [index, matrix] of placesOf(json, notes))
    for (const primitive of json.meshes[index].primitives) {
      const {POSITION: position, NORMAL: normal} = primitive.attributes;
      if ((primitive.mode ?? kTriangles) !== kTriangles || position === undefined) { notes.add('Lines, points and strips stay as they are.'); continue; }
      if (primitive.targets) notes.add('Shapes that the mesh morphs into stay as they are.');
      if (!blocks.has(position)) {
        const rows = rowsOf(position, 'positions');
        blocks.set(position, {position, normal, rows, matrix, first: vertexCount});
        vertexCount += rows.length / 3;
      }
      hasNormals &&= normal !== undefined;
      const block = blocks.get(position);
      for (const corner of cornersOf(primitive, block.rows.length / 3)) F.push(block.first + corner);
    }
  if (vertexCount === 0) throw new FileError('this GLB file has no triangles');
  const V = new Float64Array(3 * vertexCount), N = new Float64Array(hasNormals ? 3 * vertexCount : 0);
  for (const {rows, matrix, first, normal} of blocks.values()) {
    for (let i = 0; i < rows.length; i += 3) V.set(placed(matrix, rows.subarray(i, i + 3)), 3 * first + i);
    if (!hasNormals) continue;
    const given = rowsOf(normal, 'normals');
    for (let i = 0; i < given.length; i += 3) N.set(turned(matrix, given.subarray(i, i + 3)), 3 * first + i);
  }

  function save(after, normals) {
    if (after.every((x, i) => x === V[i])) return bytes;
    const copy = bytes.slice(), target = new DataView(copy.buffer);
    const write = (accessor, i, row) => {
      const [begin, stride] = layoutOf(accessor, 12);
      row.forEach((x, k) => target.setFloat32(begin + stride * i + 4 * k, x, true));
    };
    for (const {position, normal, rows, matrix, first} of blocks.values()) {
      const inverse = inverseOf(matrix), low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
      for (let i = 0; i < rows.length / 3; i++) {
        const at = 3 * (first + i);
        const step = [0, 1, 2].map((k) => after[at + k] - V[at + k]);
        const row = turned(inverse, step).map((x, k) => Math.fround(rows[3 * i + k] + x));
        row.forEach((x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); });
        if (step.some((x) => x !== 0)) write(position, i, row);
        if (!normals || [0, 1, 2].every((k) => normals[at + k] === N[at + k])) continue;
        const turnedBack = turned(inverse, normals.subarray(at, at + 3));
        write(normal, i, turnedBack.map((x) => x / Math.hypot(...turnedBack)));
      }
      Object.assign(json.accessors[position], {min: low, max: high});
    }
    return withJson(copy, json, rest);
  }
  return {V, F: Int32Array.from(F), normals: hasNormals ? {N, which: Int32Array.from(F)} : null, notes: [...notes], save};
}

/** The file with this text of its first chunk, since the bounds of positions stand in it. */
function withJson(bytes, json, rest) {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const length = 4 * Math.ceil(text.length / 4);
  const made = new Uint8Array(20 + length + bytes.length - rest).fill(0x20, 20, 20 + length);
  made.set(bytes.subarray(0, 20));
  made.set(text, 20);
  made.set(bytes.subarray(rest), 20 + length);
  const view = new DataView(made.buffer);
  view.setUint32(8, made.length, true);
  view.setUint32(12, length, true);
  return made;
}
