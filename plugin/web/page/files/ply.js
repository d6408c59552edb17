// PLY, text and binary: only coordinates and normals of what has moved are replaced.
import {FileError, addPolygon, bytesOf, digitsOf, hasMoved, patched, textOf} from './mesh_file.js';

const kSizes = {char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2,
                int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8};
const kReads = {char: 'Int8', int8: 'Int8', uchar: 'Uint8', uint8: 'Uint8', short: 'Int16', int16: 'Int16',
                ushort: 'Uint16', uint16: 'Uint16', int: 'Int32', int32: 'Int32', uint: 'Uint32', uint32: 'Uint32',
                float: 'Float32', float32: 'Float32', double: 'Float64', float64: 'Float64'};

function headerOf(bytes) {
  const text = textOf(bytes.subarray(0, 1 << 16));
  const end = text.match(/(^|\n|\r)end_header\r?\n?/);
  if (!text.startsWith('ply') || !end) throw new FileError('this is no PLY file: its header is missing or damaged');
  const header = {begin: end.index + end[0].length, format: '', elements: []};
  for (const line of text.slice(0, end.index).split(/[\r\n]+/)) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'format') header.format = words[1];
    if (words[0] === 'element') header.elements.push({name: words[1], count: Number(words[2]), properties: []});
    if (words[0] !== 'property') continue;
    const [type, sizeType] = words[1] === 'list' ? [words[3], words[2]] : [words[1], null];
    if (!kSizes[type] || (sizeType && !kSizes[sizeType])) throw new FileError(`this PLY file has a property of an unknown type: ${line}`);
    header.elements.at(-1)?.properties.push({name: words.at(-1), type, sizeType});
  }
  return header;
}

/** Reads numbers one after the other, and knows where each is. */
function binaryReader(bytes, at, littleEndian) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const gets = Object.fromEntries(Object.entries(kReads).map(([type, name]) => [type, view[`get${name}`].bind(view)]));
  return {
    next(type) {
      this.place = at;
      at += kSizes[type];
      return gets[type](this.place, littleEndian);
    },
  };
}

function textReader(text, at) {
  const word = /\S+/g;
  word.lastIndex = at;
  return {
    next() {
      const found = word.exec(text);
      if (!found) throw new RangeError();
      this.place = found.index;
      this.end = word.lastIndex;
      return Number(found[0]);
    },
  };
}

function readElements(header, reader, mesh) {
  for (const {name, count, properties} of header.elements) {
    const isVertex = name === 'vertex', isFace = name === 'face' || name === 'tristrips';
    const columns = properties.map((one) => (isVertex ? mesh.columns.indexOf(one.name) : -1));
    const hasCorners = properties.map((one) => isFace && /^vertex_ind(ex|ices)$/.test(one.name));
    for (let i = 0; i < count; i++)
      for (let k = 0; k < properties.length; k++) {
        const {type, sizeType} = properties[k];
        if (!sizeType) {
          const number = reader.next(type);
          if (columns[k] >= 0) {
            const at = i * mesh.columns.length + columns[k];
            mesh.numbers[at] = number;
            mesh.places[at] = reader.place;
            if (mesh.ends) mesh.ends[at] = reader.end;
          }
          continue;
        }
        const list = [];
        for (let left = reader.next(sizeType); left > 0; left--) list.push(reader.next(type));
        if (!hasCorners[k]) continue;
        if (name === 'face') addPolygon(list, mesh.F);
        else addStrips(list, mesh.F);
      }
  }
}

function addStrips(list, F) {
  for (let i = 2, start = 0; i < list.length; i++) {
    if (list[i] < 0) { start = i + 1; i += 2; continue; }
    const isOdd = (i - start) % 2 === 1;
    F.push(list[i - 2], list[isOdd ? i : i - 1], list[isOdd ? i - 1 : i]);
  }
}

export function readPly(bytes) {
  const header = headerOf(bytes);
  const vertex = header.elements.find((one) => one.name === 'vertex');
  const names = vertex?.properties.map((one) => one.name) ?? [];
  if (!['x', 'y', 'z'].every((name) => names.includes(name))) throw new FileError('this PLY file has no vertices');
  const columns = ['x', 'y', 'z', 'nx', 'ny', 'nz'].filter((name) => names.includes(name));
  const width = columns.length, isText = header.format === 'ascii';
  if (vertex.count * width * 8 > 2 ** 32) throw new FileError(`this file has ${vertex.count} vertices: more than fit into a page`);
  const size = vertex.count * width;
  const mesh = {columns, F: [], numbers: new Float64Array(size), places: new Float64Array(size), ends: isText ? new Float64Array(size) : null};
  const text = isText ? textOf(bytes) : '';
  const littleEndian = header.format === 'binary_little_endian';
  try {
    readElements(header, isText ? textReader(text, header.begin) : binaryReader(bytes, header.begin, littleEndian), mesh);
  } catch (error) {
    if (error instanceof RangeError) throw new FileError('this PLY file ends early: it is damaged, or was not wholly copied');
    throw error;
  }
  const V = new Float64Array(3 * vertex.count), N = new Float64Array(width === 6 ? 3 * vertex.count : 0);
  for (let i = 0; i < vertex.count; i++) {
    V.set(mesh.numbers.subarray(i * width, i * width + 3), 3 * i);
    if (width === 6) N.set(mesh.numbers.subarray(i * width + 3, i * width + 6), 3 * i);
  }
  const F = Int32Array.from(mesh.F);
  const types = columns.map((name) => vertex.properties.find((one) => one.name === name).type);

  /** Calls write(index in places, column, number) for each number that has changed. */
  function forChanges(after, normals, write) {
    for (let i = 0; i < vertex.count; i++)
      for (const [before, now, from] of [[V, after, 0], [N, normals ?? N, 3]])
        if (now.length > 0 && hasMoved(before, now, i))
          for (let k = 0; k < 3; k++) write(i * width + from + k, from + k, now[3 * i + k]);
  }

  function save(after, normals) {
    if (isText) {
      const changes = [];
      forChanges(after, normals, (at, column, number) =>
        changes.push([mesh.places[at], mesh.ends[at], digitsOf(number, kSizes[types[column]] < 8)]));
      return bytesOf(patched(text, changes.sort((one, other) => one[0] - other[0])));
    }
    const copy = bytes.slice(), view = new DataView(copy.buffer);
    forChanges(after, normals, (at, column, number) => view[`set${kReads[types[column]]}`](mesh.places[at], number, littleEndian));
    return copy;
  }

  return {V, F, normals: width === 6 ? {N, which: F} : null, notes: [], save};
}
