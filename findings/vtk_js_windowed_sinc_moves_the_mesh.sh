#!/bin/sh
# @kitware/vtk.js 37.4.3: windowed sinc smoothing moves a mesh away from the origin, by .16 % of its distance.
#
# The sum of the filter's weights, the gain of what is constant, should be one; in vtk.js it is 1.0016 with the default
# of 20 iterations and a pass band of .1, so that coordinates grow by that much. In scanner coordinates the smoothed
# surface lies beside the image that it belongs to, without a message. normalizeCoordinates (off by default) moves the
# origin into the mesh, where the same gain is an error of .16 % of its size. VTK itself (9.7.2) has a gain of one.
#
# Seen: a sphere of radius 1: distances from its centre of .995 to 1.003 at the origin, .72 to 1.27 at (100, 100, 100);
# at 100,000 it is 278 away. With normalizeCoordinates .995 to 1.003, and .993 to 1.006 at 100,000.
# Needs: node 20 or later with npm, a package registry.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm init --yes > npm.log
npm install --silent --no-audit --no-fund --ignore-scripts --legacy-peer-deps @kitware/vtk.js@37.4.3
cat > sphere.mjs <<'END'
import assert from 'node:assert';
globalThis.self = globalThis.window = globalThis;
const vtkjs = '@kitware/vtk.js';
const { default: polyData } = await import(`${vtkjs}/Common/DataModel/PolyData.js`);
const { default: windowedSinc } = await import(`${vtkjs}/Filters/General/WindowedSincPolyDataFilter.js`);

// An octahedron, subdivided: closed, with triangles in one orientation.
let points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
for (let level = 0; level < 4; level++) {
  const middles = new Map();
  const middle = (a, b) => {
    const key = a < b ? `${a} ${b}` : `${b} ${a}`;
    if (!middles.has(key)) {
      const sum = points[a].map((x, k) => x + points[b][k]);
      middles.set(key, points.push(sum.map((x) => x / Math.hypot(...sum))) - 1);
    }
    return middles.get(key);
  };
  faces = faces.flatMap(([a, b, c]) => {
    const [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
    return [[a, d, f], [d, b, e], [f, e, c], [d, e, f]];
  });
}

function radii(origin, normalizeCoordinates) {
  const mesh = polyData.newInstance();
  mesh.getPoints().setData(Float64Array.from(points.flat(), (x) => x + origin), 3);
  mesh.getPolys().setData(Uint32Array.from(faces.flatMap((face) => [3, ...face])));
  const filter = windowedSinc.newInstance(normalizeCoordinates ? { normalizeCoordinates: 1 } : {});
  filter.setInputData(mesh);
  filter.update();
  const smooth = filter.getOutputData().getPoints().getData();
  const lengths = points.map((_, i) => Math.hypot(...[0, 1, 2].map((k) => smooth[3 * i + k] - origin)));
  const range = [Math.min(...lengths), Math.max(...lengths)];
  const form = normalizeCoordinates ? ', normalized' : '';
  console.log(`origin ${origin}${form}: ${range.map((r) => r.toFixed(3)).join(' to ')}`);
  return range;
}
assert(radii(0, false).every((r) => Math.abs(r - 1) < 0.01));
assert([0, 100, 100000].every((origin) => radii(origin, true).every((r) => Math.abs(r - 1) < 0.02)));
assert(radii(100, false)[1] > 1.15, 'this has changed');
assert(radii(100000, false)[0] > 100, 'this has changed');
END
node sphere.mjs
