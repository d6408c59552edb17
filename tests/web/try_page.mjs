// Tries the page in a real browser, and takes pictures of it.
//
// usage: node try_page.mjs BROWSER PAGE MESHES TARGET
//
// BROWSER is chromium or firefox, of Debian; each mesh in the folder MESHES is opened, denoised and saved, then dropped and the same,
// to TARGET, where the pictures are, too; broken.ply and huge.ply must be told.
import assert from 'node:assert/strict';
import {mkdir, readFile, readdir, writeFile} from 'node:fs/promises';
import {join, resolve} from 'node:path';
import {launch} from './browsers.mjs';
import {serve} from './serve.mjs';

const [name, pageFolder, meshes, target] = process.argv.slice(2);
await mkdir(target, {recursive: true});
const site = await serve(resolve(pageFolder));
const browser = await launch(name);
console.log(await browser.version());
const page = await browser.newPage();
const faults = [];
page.on('pageerror', (error) => faults.push(error.message));
page.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
const sent = [];
page.on('request', (request) => { if (!request.url().startsWith(site.address) && !/^(blob|data):/.test(request.url())) sent.push(request.url()); });
await page.setViewport({width: 1280, height: 720});
await page.goto(site.address);

const shot = (what) => page.screenshot({path: join(target, `${what}.png`), fullPage: true});
const log = () => page.$eval('#log', (element) => element.innerText);
const idle = () => page.waitForFunction(() => document.body.dataset.ready && document.getElementById('cancel').disabled, {timeout: 400000});
const both = async (what) => {
  await shot(`${what}_1280`);
  await page.setViewport({width: 400, height: 800});
  await shot(`${what}_400`);
  await page.setViewport({width: 1280, height: 720});
};

/** Opens a file as by the button. */
const open = (file) => given(file, '#file');

/** Drops a file on the page, as from a window of the system: an input outside the page's own gets it for the drop. */
async function drop(file) {
  await page.evaluate(() => document.body.append(Object.assign(document.createElement('input'), {type: 'file', id: 'dropped', hidden: true})));
  await given(file, '#dropped', () => page.evaluate(() => {
    const input = document.getElementById('dropped'), dataTransfer = new DataTransfer();
    dataTransfer.items.add(input.files[0]);
    input.remove();
    const tell = (type) => document.getElementById('view').dispatchEvent(new DragEvent(type, {bubbles: true, cancelable: true, dataTransfer}));
    if (tell('dragover') || tell('drop')) throw new Error('the browser would show the file instead');
  }));
}

async function given(file, input, then = () => {}) {
  await page.$eval('#facts', (element) => { element.textContent = ''; });
  await (await page.$(input)).uploadFile(join(resolve(meshes), file));
  await then();
  await page.waitForFunction((text) => document.getElementById('facts').textContent.startsWith(text) || document.querySelector('#log .error'), {timeout: 400000}, `${file}:`);
}

/** What the page saves, as bytes. */
async function saved() {
  await page.evaluate(() => {
    window.kept ??= URL.createObjectURL;
    URL.createObjectURL = (blob) => { window.saved = blob; return window.kept(blob); };
    window.saved = null;
  });
  await page.click('#save');
  await page.waitForFunction(() => window.saved, {timeout: 60000});
  const text = await page.evaluate(async () => {
    const bytes = new Uint8Array(await window.saved.arrayBuffer());
    let text = '';
    for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
    return btoa(text);
  });
  return Buffer.from(text, 'base64');
}

await idle();
await both('before');
await page.click('#sample');
await page.waitForFunction(() => !document.getElementById('cancel').disabled);
await shot('during_1280');
await idle();
// Its noise is independent from vertex to vertex, .004 high.
assert.match(await log(), /white noise.*\(0\.003[89]\d*\): removed/);
await both('after');
for (const kind of ['moved', 'values']) {
  await page.select('#colors', kind);
  await both(`colours_${kind}`);
}
await page.select('#colors', 'none');

// A slider's preview, an equalizer, texture, a mistake; and a run that is cancelled.
await page.select('#filter', 'apply_coord_spectral_filter_fractional');
await idle();
await page.$eval('.field input[type=range]', (slider) => { slider.value = Math.log(20); slider.dispatchEvent(new Event('input', {bubbles: true})); });
await new Promise((done) => setTimeout(done, 600));
await idle();
assert.equal(await page.$eval('#field-feature_size', (input) => input.value), '20e');
assert.match(await page.$eval('#same', (element) => element.textContent), /feature_size="20e"/);
await both('filter');
await page.select('#preset', 'caricature');
assert.deepEqual(await page.$$eval('#field-filter_type, #field-feature_size, #field-pass_gain, #field-band_width', (inputs) => inputs.map((input) => input.value)),
  ['band-pass', '25%', '2', '1.5']);
await new Promise((done) => setTimeout(done, 600));
await idle();
assert.match(await log(), /band-pass/);
await page.select('#preset', 'defaults');
assert.equal(await page.$eval('#field-pass_gain', (input) => input.value), '1');
await page.$eval('#field-feature_size', (input) => { input.value = '-3'; });
await page.click('#run');
await idle();
assert.match(await log(), /feature_size = -3: must be above 0: give/);
await page.$eval('#field-feature_size', (input) => { input.value = '300e'; });
await page.click('#run');
await page.waitForFunction(() => !document.getElementById('cancel').disabled);
await page.click('#cancel');
await idle();
assert.match(await log(), /Cancelled/);
for (const filter of ['apply_coord_spectral_equalizer', 'compute_scalar_surface_texture_per_vertex']) {
  await page.select('#filter', filter);
  await new Promise((done) => setTimeout(done, 600));
  await idle();
  assert.equal(await page.$('#log .error'), null, await log());
  await shot(`${filter}_1280`);
}
await page.select('#filter', 'apply_coord_spectral_denoise');
await new Promise((done) => setTimeout(done, 600));
await idle();

/** Opens a file that is refused, and returns what is said. */
async function refused(file) {
  await open(file);
  await idle();
  assert.notEqual(await page.$('#log .error'), null);
  assert.doesNotMatch(await log(), /'[A-Z]/);
  console.log(file, '->', await log());
  return log();
}

for (const file of (await readdir(meshes)).sort()) {
  if (file === 'huge.ply') continue;
  if (file === 'broken.ply') {
    await refused(file);
    continue;
  }
  for (const again of [false, true]) {
    await (again ? drop : open)(file);
    await idle();
    assert.equal(await page.$('#log .error'), null, await log());
    const first = await saved();
    if (again) assert.deepEqual(first, await readFile(join(target, file)));
    await writeFile(join(target, file), first);
  }
  console.log(file, '->', (await log()).split('\n')[0]);
  await shot(file);
}
// Without pictures from here on, which some browsers lack: to draw so many triangles takes a processor half a minute.
await page.$eval('#canvas', (canvas) => canvas.getContext('webgl2')?.getExtension('WEBGL_lose_context').loseContext());
await page.waitForFunction(() => document.getElementById('canvas').hidden);
assert.match(await page.$eval('#hint', (element) => element.textContent), /everything else works/);
assert.match(await refused('huge.ply'), /needs about .* simplify it to .* vertices or fewer/);
assert.deepEqual(faults, []);
assert.deepEqual(sent, []);
await browser.close();
site.close();
