// 3MF: the numbers of vertices are replaced in the models of the archive, all else stays as it is.
import {FileError, digitsOf, hasMoved, patched} from './mesh_file.js';
import {entriesOf, repacked} from './zip.js';

const kNames = [['x', 'y', 'z'], ['v1', 'v2', 'v3']];

export async function readThreeMf(bytes) {
  const entries = entriesOf(bytes), models = [], V = [], F = [], notes = [];
  for (const entry of entries.filter((one) => one.name.toLowerCase().endsWith('.model'))) {
    const text = new TextDecoder().decode(await entry.bytes());
    const places = [], first = V.length / 3;
    let base = first;  // of the object
    for (const tag of text.matchAll(/<(?:\w+:)?(object|vertex|triangle)\s[^>]*>/g)) {
      const element = tag[1];
      if (element === 'object') { base = V.length / 3; continue; }
      const names = kNames[element === 'vertex' ? 0 : 1];
      const numbers = names.map((name) => {
        const found = tag[0].match(new RegExp(`\\s${name}\\s*=\\s*(["'])([^"']*)\\1`, 'd'));
        if (!found) throw new FileError(`this 3MF file has a ${element} without ${name}`);
        if (element === 'vertex') places.push(found.indices[2].map((k) => tag.index + k));
        return Number(found[2]);
      });
      if (element === 'vertex') V.push(...numbers);
      else F.push(...numbers.map((corner) => corner + base));
    }
    if (/<(?:\w+:)?(item|component)\s[^>]*transform/.test(text)) notes.push('Objects are filtered where they are stored, before they are placed.');
    models.push({name: entry.name, text, places, first});
  }
  if (F.length === 0) throw new FileError('this 3MF file has no triangles');
  const before = Float64Array.from(V);
  async function save(after) {
    const changed = new Map();
    for (const {name, text, places, first} of models) {
      const changes = [];
      for (let i = 0; i < places.length / 3; i++)
        if (hasMoved(before, after, first + i))
          for (let k = 0; k < 3; k++) changes.push([...places[3 * i + k], digitsOf(after[3 * (first + i) + k], false)]);
      if (changes.length > 0) changed.set(name, new TextEncoder().encode(patched(text, changes.sort((one, other) => one[0] - other[0]))));
    }
    return changed.size > 0 ? repacked(entries, changed) : bytes;
  }
  return {V: before, F: Int32Array.from(F), normals: null, notes, save};
}
