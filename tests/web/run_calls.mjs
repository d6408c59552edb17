// Runs calls of spectral-mesh, and keeps what they give.
//
// usage: node run_calls.mjs PACKAGE FOLDER
//
// FOLDER/calls.json: a list of {name, mesh, options, memoryLimit?, cancel?}, where mesh names files: V, F,
// values, levels, selected. Result i is in FOLDER/i.json, its arrays in FOLDER/i.NAME.
import {readFile, writeFile} from 'node:fs/promises';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [packageFolder, folder] = process.argv.slice(2).map((path) => resolve(path));
const {applyFilter} = await import(pathToFileURL(join(packageFolder, 'index.js')));

async function read(Type, mesh, name) {
  const bytes = await readFile(join(folder, `${mesh}.${name}`));
  return new Type(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
}

async function outcome({name, mesh, options, memoryLimit, cancel}, index) {
  const stop = new AbortController();
  const context = {
    signal: stop.signal, memoryLimit, progress: () => cancel && stop.abort(),
    selected: await read(Uint8Array, mesh, 'selected'),
    values: await read(Float64Array, mesh, name.includes('color') ? 'levels' : 'values'),
  };
  try {
    const result = await applyFilter(
      name, await read(Float64Array, mesh, 'V'), await read(Int32Array, mesh, 'F'), options, context);
    for (const [key, value] of Object.entries(result))
      if (value instanceof Float64Array) {
        await writeFile(join(folder, `${index}.${key}`), value);
        delete result[key];
      }
    return result;
  } catch (error) {
    return {error: error.message, name: error.name, code: error.code, limit: error.limit};
  }
}

const plain = (key, value) => (value instanceof Float64Array ? [...value].map(String) : value);
const calls = JSON.parse(await readFile(join(folder, 'calls.json'), 'utf8'));
for (const [index, call] of calls.entries())
  await writeFile(join(folder, `${index}.json`), JSON.stringify(await outcome(call, index), plain));
