// The page: a mesh, a filter, its result. Dialogs are loops over the tables of the filters.
import {SpectralError, applyFilter, filters, followingNormals} from './spectral-mesh/index.js';
import {fieldsOf, optionsOf} from './fields.js';
import {kFormats, readMesh} from './files/formats.js';
import {normalsOf, scaledValues, sizesOf} from './measures.js';
import {sameRun} from './same_run.js';
import {sampleMesh} from './sample.js';
import {View} from './view.js';

const DENOISE = 'apply_coord_spectral_denoise';
const kOffered = [DENOISE, 'apply_coord_spectral_filter_fractional', 'apply_coord_spectral_equalizer',
                  'compute_scalar_surface_texture_per_vertex'];
const kPreviewDelay = 400;  // milliseconds without another change

const at = (id) => document.getElementById(id);
let tables = [], mesh = null, result = null, stop = null, timer = 0, view = null;

at('served').hidden = true;
/** Goes on without pictures. */
function hideView(why) {
  view = null;
  at('hint').textContent = why;
  at('hint').hidden = false;
  at('canvas').hidden = at('legend').hidden = true;
}

try {
  view = new View(at('canvas'));
} catch (error) {
  hideView(error.message);
}
// As of a mesh that a slow graphics processor, or none, draws for too long.
at('canvas').addEventListener('webglcontextlost', () => hideView('The browser has stopped drawing 3D pictures; everything else works.'));

function say(text, kind = '') {
  const line = document.createElement('p');
  line.className = kind;
  line.textContent = text;
  at('log').append(line);
}

const chosen = () => tables.find((one) => one.pythonName === at('filter').value);
const plain = (text) => text.replace(/[*|]/g, '');

function showFields() {
  at('help').textContent = plain(chosen().help);
  at('fields').replaceChildren(...fieldsOf(chosen(), mesh?.sizes));
}

function setBusy(busy) {
  at('cancel').disabled = !busy;
  at('run').disabled = busy || !mesh || tables.length === 0;
  at('save').disabled = busy || !result?.vertices;
  at('progress').value = 0;
  at('stage').textContent = '';
}

async function open(name, load) {
  stop?.abort();
  at('log').replaceChildren();
  at('facts').textContent = `Reading ${name}`;
  await new Promise((resolve) => setTimeout(resolve));  // shows it
  try {
    mesh = {name, ...(await load())};
  } catch (error) {
    at('facts').textContent = '';
    say(error.message, 'error');
    return;
  }
  mesh.sizes = sizesOf(mesh.V, mesh.F);
  result = null;
  at('hint').hidden = Boolean(view);
  const count = (number, what) => `${number.toLocaleString('en')} ${what}`;
  const facts = `${name}: ${count(mesh.V.length / 3, 'vertices')}, ${count(mesh.F.length / 3, 'triangles')}`;
  at('facts').textContent = [`${facts}.`, ...mesh.notes, mesh.save ? 'Saved in the same format, where only what moved is changed.' : ''].join(' ');
  at('canvas').setAttribute('aria-label', `${facts}, before and after. Arrow keys turn it, plus and minus enlarge it.`);
  at('save').textContent = `Save ${name.split('.').pop().toUpperCase()}`;
  view?.show(mesh.V, mesh.F);
  at('legend').hidden = true;
  if (tables.length === 0) return setBusy(false);
  showFields();
  return run();
}

async function run() {
  if (!mesh || tables.length === 0) return;
  stop?.abort();
  const own = (stop = new AbortController());
  const filter = chosen(), options = optionsOf(filter, at('fields'));
  at('log').replaceChildren();
  setBusy(true);
  const progress = (fraction, stage) => {
    if (own.signal.aborted) return;
    at('progress').value = fraction;
    at('stage').textContent = stage;
  };
  const more = filter.pythonName === DENOISE ? {store_noise_height: true} : {};
  try {
    const done = await applyFilter(filter.pythonName, mesh.V, mesh.F, {...options, ...more}, {signal: own.signal, progress});
    if (own.signal.aborted) return;
    result = {...done, filter};
    show(options);
  } catch (error) {
    if (stop !== own) return;
    say(error === own.signal.reason ? 'Cancelled: the mesh is as before.' : error.message, 'error');
    if (!(error instanceof SpectralError) && error !== own.signal.reason) console.error(error);
  }
  if (stop === own) setBusy(false);
}

function show(options) {
  const lines = result.text.split('\n'), numbers = document.createElement('details');
  lines.slice(0, 2).forEach((line) => say(line.trim()));
  if (lines.length > 2) {
    numbers.append(Object.assign(document.createElement('summary'), {textContent: 'All numbers'}), lines.slice(2).map((line) => line.trim()).join('\n'));
    at('log').append(numbers);
  }
  result.warnings.forEach((warning, i) => result.warningCodes[i] === 'nothing_removed' || say(warning, 'warning'));
  at('same').textContent = sameRun(result.filter, options, mesh.name, mesh.sizes);
  view?.move(result.vertices ?? mesh.V, 1);
  const colors = at('colors').options;
  colors.namedItem('values').textContent = result.filter.pythonName === DENOISE ? 'height of the noise' : 'heights';
  colors.namedItem('values').disabled = !result.values;
  colors.namedItem('moved').disabled = !result.vertices;
  if (at('colors').selectedOptions[0].disabled) at('colors').value = result.values ? 'values' : 'none';
  color();
}

/** Colours both sides, and says what the colours mean. */
function color() {
  const kind = at('colors').value;
  at('legend').hidden = kind === 'none' || !result || !view;
  if (kind === 'none' || !result) return view?.color(null);
  let values = result.values;
  if (kind === 'moved') {
    const N = normalsOf(mesh.V, mesh.F), step = (i) => result.vertices[i] - mesh.V[i];
    values = Float64Array.from({length: N.length / 3}, (_, v) => [0, 1, 2].reduce((sum, k) => sum + step(3 * v + k) * N[3 * v + k], 0));
  }
  const {shares, largest, isSigned} = scaledValues(values);
  const text = largest.toPrecision(3), palette = isSigned || kind === 'moved' ? 'moved' : 'values';
  at('bar').className = palette;
  at('low').textContent = palette === 'moved' ? `−${text}, inwards` : '0, none';
  at('high').textContent = palette === 'moved' ? `${text}, outwards` : text;
  view?.color(shares, palette);
}

async function save() {
  const {normals, V, F, name} = mesh;
  const N = normals && (await followingNormals(V, result.vertices, F, normals.N, normals.which));
  const bytes = await mesh.save(result.vertices, N);
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = name.replace(/(\.[^.]+)?$/, (ending) => `_${result.filter.pythonName === DENOISE ? 'denoised' : 'filtered'}${ending}`);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const openFile = (file) => file && open(file.name, async () => readMesh(file.name, new Uint8Array(await file.arrayBuffer())));
const area = at('view');
area.addEventListener('dragover', (event) => { event.preventDefault(); area.classList.add('over'); });
area.addEventListener('dragleave', () => area.classList.remove('over'));
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
  event.preventDefault();
  area.classList.remove('over');
  openFile(event.dataTransfer.files[0]);
});
at('file').addEventListener('change', () => openFile(at('file').files[0]));
at('file').accept = kFormats.map((ending) => `.${ending}`).join(',');
at('sample').addEventListener('click', () => open('sample.ply', sampleMesh));
at('run').addEventListener('click', run);
at('cancel').addEventListener('click', () => stop?.abort());
at('save').addEventListener('click', () => save().catch((error) => say(error.message, 'error')));
at('colors').addEventListener('change', color);
at('fields').addEventListener('submit', (event) => event.preventDefault());
at('filter').addEventListener('change', () => { showFields(); previewSoon(); });
at('fields').addEventListener('input', previewSoon);

function previewSoon() {
  clearTimeout(timer);
  if (at('preview').checked) timer = setTimeout(run, kPreviewDelay);
}

try {
  const all = await filters();
  tables = kOffered.map((name) => all.find((one) => one.pythonName === name));
  for (const one of tables) at('filter').add(new Option(one.name, one.pythonName));
  at('filter').disabled = false;
  showFields();
  if (mesh) await run();
} catch (error) {
  say(`The filters cannot be loaded: ${error.message}`, 'error');
}
document.body.dataset.ready = 'true';
