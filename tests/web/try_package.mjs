// Tries the packed package as a user has it: in an empty folder, in Node, in a browser, and by TypeScript.
//
// usage: node try_package.mjs BROWSER ARCHIVE FOLDER    FOLDER is empty; next to this file is node_modules
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {cp, readFile, writeFile} from 'node:fs/promises';
import {join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {launch} from './browsers.mjs';
import {serve} from './serve.mjs';

const [name, archive, given] = process.argv.slice(2);
const folder = resolve(given), modules = fileURLToPath(new URL('node_modules', import.meta.url));
const run = (...command) => execFileSync(command[0], command.slice(1), {cwd: folder, encoding: 'utf8'});
await writeFile(join(folder, 'package.json'), '{"type": "module"}');
run('npm', 'install', '--silent', '--offline', resolve(archive));
for (const one of ['three', '@types']) await cp(join(modules, one), join(folder, 'node_modules', one), {recursive: true});
await cp(join(folder, 'node_modules/spectral-mesh/example.js'), join(folder, 'example.js'));
const expected = /noise.*removed/;
assert.match(run('node', 'example.js'), expected);

const usage = `import {denoiseMesh, applyFilter, filterMesh, SpectralError} from 'spectral-mesh';
const V = new Float32Array(9), F = [0, 1, 2];
const {vertices, report, warnings} = await denoiseMesh(V, F, {strength: 0.5, boundary: 'fixed'});
const kind: string = report.noise_kind, moved: Float64Array = vertices, all: string[] = warnings;
const {report: {octave_energies}} = await applyFilter('get_geometry_spectrum', V, null, {basis_size: 10});
const sum: number = octave_energies.reduce((a, b) => a + b);
try { await filterMesh(V, F, {feature_size: '6e'}, {signal: AbortSignal.timeout(9), progress: (done) => done / 2}); }
catch (error) { if (error instanceof SpectralError) console.log(error.code, kind, moved, all, sum); }
`;
const mistakes = ["{strength: 'much'}", "{boundary: 'loose'}", '{sizes: 3}'];
const compile = () => run('node', join(modules, 'typescript/bin/tsc'), '--strict', '--noEmit', '--target', 'es2022', '--module', 'nodenext', 'usage.ts');
await writeFile(join(folder, 'usage.ts'), usage);
compile();
for (const mistake of mistakes) {
  await writeFile(join(folder, 'usage.ts'), usage.replace("{strength: 0.5, boundary: 'fixed'}", mistake));
  assert.throws(compile, undefined, `${mistake} is no error`);
}

const imports = {three: './node_modules/three/build/three.module.js', 'spectral-mesh': './node_modules/spectral-mesh/index.js'};
await writeFile(join(folder, 'index.html'), `<!doctype html><script type="importmap">${JSON.stringify({imports})}</script><script type="module" src="example.js"></script>`);
const site = await serve(folder), browser = await launch(name), page = await browser.newPage();
const said = new Promise((done) => page.on('console', (message) => { if (/noise/.test(message.text())) done(message.text()); }));
await page.goto(site.address);
assert.match(await said, expected);
await browser.close();
site.close();
console.log((await readFile(archive)).length, 'bytes');
