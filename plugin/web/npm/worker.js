// One run of the compiled core, on a thread of its own: one message in; progress, and one result out.
import load from './spectral.mjs';

const isNode = typeof process === 'object' && Boolean(process.versions?.node);
const port = isNode
  ? (await import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:worker_threads')).parentPort
  : globalThis;

const kReportInterval = 50;  // milliseconds: what the eye can follow

function listener() {
  let last = -Infinity;
  return (stage, fraction) => {
    const now = performance.now();
    if (now - last < kReportInterval) return;
    last = now;
    port.postMessage({stage, fraction});
  };
}

const calls = {
  filters: (core) => ({filters: core.filters()}),
  apply: (core, {name, mesh, options}) => core.apply(name, mesh, options, listener()),
  followingNormals(core, {arrays}) {
    const normals = core.followingNormals(...arrays);
    return normals.error ? normals : {normals};
  },
};

function errorOf(reason) {
  const isMemory = reason instanceof RangeError;  // of typed arrays
  return {error: {message: String(reason?.message ?? reason), limit: 0,
                  code: isMemory ? 'out_of_memory' : 'internal',
                  kind: isMemory ? 'MemoryLimitError' : 'Error'}};
}

port.addEventListener('message', async ({data}) => {
  let result;
  try {
    const core = await load({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(data.module, imports).then((instance) => done(instance, data.module));
        return {};
      },
    });
    core.setMemoryLimit(data.memoryLimit);
    result = calls[data.call](core, data);
  } catch (reason) {
    result = errorOf(reason);
  }
  const arrays = Object.values(result).filter((value) => value instanceof Float64Array);
  port.postMessage({result}, arrays.map((array) => array.buffer));
});
