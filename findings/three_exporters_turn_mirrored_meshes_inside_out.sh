#!/bin/sh
# three.js 0.187.0: STLExporter, OBJExporter and PLYExporter write a mesh that is mirrored by its scale inside out.
#
# A scale of -1 along an axis, as mirrored halves, left and right shoes or implants have it, is applied to the
# vertices, and the order of the corners stays, so that all faces point inwards. The renderer reverses them by the
# determinant, and so does glTF: on the screen the model is right, and in the file volumes are negative, halves cancel
# each other, and a slicer sees a hollow. Nothing warns. Bake the scale into the geometry and reverse its index first.
#
# Seen: two spheres of radius 1, volume 4.19 each, one of them with scale.x = -1: the volumes of what was written are
# 4.18 and -4.18, in STL, OBJ and PLY.
# Needs: node 18 or later, npm, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm install --silent --no-audit --no-fund three@0.187.0
cat > export.mjs <<'END'
import * as THREE from 'three';
import { OBJExporter } from 'three/addons/exporters/OBJExporter.js';
import { PLYExporter } from 'three/addons/exporters/PLYExporter.js';
import { STLExporter } from 'three/addons/exporters/STLExporter.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';
import { STLLoader } from 'three/addons/loaders/STLLoader.js';

function volume(geometry) {
  const { position } = (geometry.index ? geometry.toNonIndexed() : geometry).attributes;
  const [a, b, c] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  let sum = 0;
  for (let i = 0; i < position.count; i += 3) {
    [a, b, c].forEach((corner, k) => corner.fromBufferAttribute(position, i + k));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

const throughFile = {
  STL: scene => new STLLoader().parse(new STLExporter().parse(scene)),
  OBJ: scene => new OBJLoader().parse(new OBJExporter().parse(scene)).children[0].geometry,
  PLY: scene => new PLYLoader().parse(new PLYExporter().parse(scene, undefined, {})),
};
for (const [format, copy] of Object.entries(throughFile)) {
  const volumes = [1, -1].map(scale => {
    const mesh = new THREE.Mesh(new THREE.IcosahedronGeometry(1, 15));
    mesh.scale.x = scale;
    mesh.updateMatrixWorld(true);
    return volume(copy(mesh));
  });
  console.log(format, volumes);
  if (!(volumes[0] > 4 && volumes[1] < -4)) throw new Error('this has changed');
}
END
node export.mjs
