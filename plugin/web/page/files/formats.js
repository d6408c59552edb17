// The formats that the page reads and writes.
import {readGlb} from './glb.js';
import {FileError} from './mesh_file.js';
import {readObj} from './obj.js';
import {readPly} from './ply.js';
import {readStl} from './stl.js';
import {readThreeMf} from './three_mf.js';

const kReaders = {ply: readPly, stl: readStl, obj: readObj, glb: readGlb, '3mf': readThreeMf};

export const kFormats = Object.keys(kReaders);

/** Reads a file: see mesh_file.js. */
export async function readMesh(name, bytes) {
  const ending = name.toLowerCase().split('.').pop();
  const read = kReaders[ending];
  if (!read) throw new FileError(`${name}: this page reads ${kFormats.join(', ').toUpperCase()}`);
  try {
    return await read(bytes);
  } catch (error) {
    if (error instanceof FileError) throw error;
    throw new FileError(`this file is damaged, or of a kind that this page does not read (${error.message})`);
  }
}
