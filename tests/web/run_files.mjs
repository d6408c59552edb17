// Reads meshes as the page does, moves the vertices with z > 0, and saves them.
//
// usage: node run_files.mjs PAGE FOLDER
//
// Of each file in FOLDER: saved unchanged in FOLDER/same, moved in FOLDER/moved; vertices before and after are
// in FOLDER/NAME.before and NAME.after. What cannot be read: the text of the error, in FOLDER/NAME.error.
import {mkdir, readFile, readdir, writeFile} from 'node:fs/promises';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [page, folder] = process.argv.slice(2).map((path) => resolve(path));
const {readMesh} = await import(pathToFileURL(join(page, 'files', 'formats.js')));
const files = (await readdir(folder, {withFileTypes: true})).filter((one) => one.isFile()).map((one) => one.name);
for (const name of ['same', 'moved']) await mkdir(join(folder, name));
for (const name of files) {
  try {
    const {V, normals, save} = await readMesh(name, new Uint8Array(await readFile(join(folder, name))));
    const after = V.map((x, i) => (V[i - (i % 3) + 2] > 0 ? x + 0.01 * Math.sin(40 * x) : x));
    const N = normals?.N.map((x, i, all) => (V[i - (i % 3) + 2] > 0 ? all[i - (i % 3) + ((i + 1) % 3)] : x));
    await writeFile(join(folder, 'same', name), await save(V, normals?.N));
    await writeFile(join(folder, 'moved', name), await save(after, N));
    await writeFile(join(folder, `${name}.before`), V);
    await writeFile(join(folder, `${name}.after`), after);
  } catch (error) {
    await writeFile(join(folder, `${name}.error`), `${error.constructor.name}: ${error.message}`);
  }
}
