// A ring with ridges and dents, and noise as of a scanner: something to begin with.
import {readPly} from './files/ply.js';

const kRound = 260, kAcross = 110;

/** Random numbers of a normal distribution, the same ones each time (Box and Muller 1958). */
function normalNumbers() {
  let state = 1;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

export function sampleMesh() {
  const random = normalNumbers(), n = kRound * kAcross;
  const head = `ply\nformat binary_little_endian 1.0\nelement vertex ${n}\nproperty double x\nproperty double y\nproperty double z\n` +
    `element face ${2 * n}\nproperty list uchar int vertex_indices\nend_header\n`;
  const bytes = new Uint8Array(head.length + 24 * n + 26 * n), view = new DataView(bytes.buffer);
  bytes.set(new TextEncoder().encode(head));
  let at = head.length;
  for (let i = 0; i < kRound; i++)
    for (let j = 0; j < kAcross; j++) {
      const u = (2 * Math.PI * i) / kRound, v = (2 * Math.PI * j) / kAcross;
      const tube = 0.42 + 0.03 * Math.tanh(3 * Math.sin(8 * u + 2 * v)) + 0.004 * random();
      const r = 1 + tube * Math.cos(v);
      for (const x of [r * Math.cos(u), r * Math.sin(u), tube * Math.sin(v)]) {
        view.setFloat64(at, x, true);
        at += 8;
      }
    }
  for (let i = 0; i < kRound; i++)
    for (let j = 0; j < kAcross; j++) {
      const next = ((i + 1) % kRound) * kAcross, own = i * kAcross, beside = (j + 1) % kAcross;
      for (const triangle of [[own + j, next + j, next + beside], [own + j, next + beside, own + beside]]) {
        view.setUint8(at++, 3);
        for (const corner of triangle) {
          view.setInt32(at, corner, true);
          at += 4;
        }
      }
    }
  return readPly(bytes);
}
