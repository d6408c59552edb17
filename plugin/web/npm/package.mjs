// Makes the package spectral-mesh of npm out of the compiled module.
//
// usage: node package.mjs MODULE FOLDER    MODULE has spectral.mjs and spectral.wasm
import {copyFile, mkdir, readFile, readdir, rm, writeFile} from 'node:fs/promises';
import {basename, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {declarations} from './types.mjs';

const [module, folder] = process.argv.slice(2).map((path) => resolve(path));
const here = fileURLToPath(new URL('.', import.meta.url));
const project = join(here, '../../..');

await rm(folder, {recursive: true, force: true});
await mkdir(folder, {recursive: true});
const own = ['index.js', 'worker.js', 'README.md', 'example.js'].map((name) => join(here, name));
const compiled = (await readdir(module)).map((name) => join(module, name));
for (const file of [...own, ...compiled, join(project, 'LICENSE')])
  await copyFile(file, join(folder, basename(file)));

const cmake = await readFile(join(project, 'CMakeLists.txt'), 'utf8');
const description = {
  name: 'spectral-mesh',
  version: cmake.match(/VERSION (\d+\.\d+\.\d+)/)[1],
  description: 'Denoises triangle meshes, and filters them by the size of their details',
  license: 'GPL-3.0-or-later',
  keywords: ['mesh', 'denoise', 'smooth', 'spectral', 'three', 'scan', '3d'],
  type: 'module',
  exports: {'.': {types: './index.d.ts', default: './index.js'}, './*': './*'},
  types: './index.d.ts',
  engines: {node: '>=18'},
};
await writeFile(join(folder, 'package.json'), `${JSON.stringify(description, null, 2)}\n`);
const made = await import(pathToFileURL(join(folder, 'index.js')));
await writeFile(join(folder, 'index.d.ts'), await declarations(made));
