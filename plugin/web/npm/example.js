// A noisy knot of three.js, and the knot without the noise. In Node: npm install three; node example.js
import {TorusKnotGeometry} from 'three';
import {denoiseMesh} from 'spectral-mesh';

/** Denoises a geometry in place, and returns what was found. */
export async function denoiseGeometry(geometry, options, context) {
  const {position} = geometry.attributes;
  const done = await denoiseMesh(position.array, geometry.index?.array, options, context);
  position.array.set(done.vertices);
  position.needsUpdate = true;
  geometry.computeVertexNormals();
  return done.summary;
}

/** A knot whose vertices are off by a tenth of an edge, in the mean, along their normals. */
export function noisyKnot() {
  const geometry = new TorusKnotGeometry(1, 0.4, 256, 64);
  const {position, normal} = geometry.attributes;
  // Vertices at seams have copies, which must stay where they are: noise that the place determines.
  const noise = (...place) => {
    const x = Math.sin(place.reduce((sum, one, i) => sum + Math.round(one * 1e4) * (12.9898 + 65.2 * i), 0)) * 43758.5453;
    return 0.02 * (2 * (x - Math.floor(x)) - 1);
  };
  for (let i = 0; i < position.count; i++) {
    const place = [position.getX(i), position.getY(i), position.getZ(i)];
    const height = noise(...place);
    position.setXYZ(i, ...place.map((one, k) => one + height * normal.getComponent(i, k)));
  }
  return geometry;
}

console.log(await denoiseGeometry(noisyKnot()));
