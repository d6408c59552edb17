// Spectral filters of triangle meshes, for browsers and Node. Each run has a worker of its own, which
// ends with it, so that its memory is given back; runs wait for each other.

/** What a filter rejects. `name` is OptionError, MeshError, MemoryLimitError or SolverError. */
export class SpectralError extends Error {
  constructor({message, kind, code, limit}) {
    super(message);
    Object.assign(this, {name: kind, code, limit});
  }
}

const isNode = typeof process === 'object' && Boolean(process.versions?.node);
const inNode = (name) => import(/* webpackIgnore: true */ /* @vite-ignore */ `node:${name}`);

async function bytesOf(url) {
  if (isNode) return (await inNode('fs/promises')).readFile(url);
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url} cannot be loaded: ${answer.status}`);
  return answer.arrayBuffer();
}

let compiled;  // stays when a worker ends
function compile() {
  compiled ??= bytesOf(new URL('./spectral.wasm', import.meta.url)).then((bytes) =>
    WebAssembly.compile(bytes).catch((reason) => {
      throw new Error(`WebAssembly with SIMD and exceptions is needed (${reason.message})`);
    }));
  compiled.catch(() => { compiled = undefined; });
  return compiled;
}

async function startWorker(listen) {
  if (isNode) {
    const {Worker: NodeWorker} = await inNode('worker_threads');
    const worker = new NodeWorker(new URL('./worker.js', import.meta.url));
    return worker.on('message', listen.message).on('error', listen.error);
  }
  const worker = new Worker(new URL('./worker.js', import.meta.url), {type: 'module'});
  worker.onmessage = ({data}) => listen.message(data);
  worker.onerror = (event) => listen.error(new Error(event.message || 'the worker cannot be loaded'));
  return worker;
}

async function runAlone(call, {signal, progress, memoryLimit = 0}) {
  signal?.throwIfAborted();
  const module = await compile();
  let worker, abort;
  try {
    const result = await new Promise((resolve, reject) => {
      abort = () => reject(signal.reason);
      signal?.addEventListener('abort', abort);
      const message = (data) =>
        data.stage === undefined ? resolve(data.result) : progress?.(data.fraction, data.stage);
      startWorker({message, error: reject}).then((started) => {
        worker = started;
        if (signal?.aborted) worker.terminate();
        else worker.postMessage({module, memoryLimit, ...call});
      }, reject);
    });
    if (result.error) throw new SpectralError(result.error);
    return result;
  } finally {
    signal?.removeEventListener('abort', abort);
    worker?.terminate();
  }
}

let last = Promise.resolve();
function run(call, context = {}) {
  const result = last.then(() => runAlone(call, context));
  last = result.catch(() => {});
  return result;
}

/** A typed array of this type, rows of so many numbers. */
function rows(Type, array, columns, what) {
  if (array.length % columns)
    throw new TypeError(`${what}: ${array.length} numbers are not rows of ${columns}`);
  return array instanceof Type ? array : Type.from(array);
}

const meshOf = (V, F) => ({
  vertices: rows(Float64Array, V, 3, 'V'),
  faces: rows(Int32Array, F ?? Int32Array.from({length: V.length / 3}, (_, i) => i), 3, 'F'),
});

export const filters = () => run({call: 'filters'}).then((result) => result.filters);

export async function applyFilter(name, V, F, options = {}, context = {}) {
  const mesh = meshOf(V, F);
  const n = mesh.vertices.length / 3;
  for (const [key, Type] of [['selected', Uint8Array], ['values', Float64Array]])
    if (context[key]) mesh[key] = rows(Type, context[key], n, key);
  if (context.gain) mesh.gain = rows(Float64Array, context.gain, 2, 'gain');
  const given = Object.entries(options).filter(([, value]) => value !== undefined);
  return run({call: 'apply', name, mesh, options: Object.fromEntries(given)}, context);
}

export const denoiseMesh = (V, F, options, context) =>
  applyFilter('apply_coord_spectral_denoise', V, F, options, context);

export const filterMesh = (V, F, options, context) =>
  applyFilter('apply_coord_spectral_filter_fractional', V, F, options, context);

export async function followingNormals(before, after, F, normals, which = F) {
  const {vertices, faces} = meshOf(before, F);
  const moved = rows(Float64Array, after, 3, 'after');
  const N = rows(Float64Array, normals, 3, 'normals'), corners = rows(Int32Array, which, 3, 'which');
  if (moved.length !== vertices.length || corners.length !== faces.length)
    throw new TypeError('a row of after for each vertex, and of which for each face');
  const call = {call: 'followingNormals', arrays: [vertices, moved, faces, N, corners]};
  return (await run(call)).normals;
}
