#!/bin/sh
# three.js 0.187.0: toCreasedNormals takes vertices that lie less than a hundredth of a unit apart for one.
#
# Corners are brought together by their coordinates times 100, without the decimals, whatever the size of the mesh.
# glTF's unit is the metre: on parts of a few centimetres normals are averages over cells of a centimetre, on smaller
# ones over the whole part, as far as the crease angle reaches. Around 0 cells are twice as wide. Nothing warns, and
# there is no parameter. Scale the geometry up first; normals do not change by it.
#
# Seen: largest angle between normals and radii of a sphere of 5,120 faces: .14 degrees for radii of 1000, 10 and 1,
# 5.3 for .1, 25 for .03.
# Needs: node 18 or later, npm, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm install --silent --no-audit --no-fund three@0.187.0
cat > normals.mjs <<'END'
import * as THREE from 'three';
import { toCreasedNormals } from 'three/addons/utils/BufferGeometryUtils.js';

function largestAngle(radius) {
  const { position, normal } = toCreasedNormals(new THREE.IcosahedronGeometry(radius, 15), Math.PI / 3).attributes;
  const p = new THREE.Vector3(), n = new THREE.Vector3();
  let largest = 0;
  for (let i = 0; i < position.count; i++) {
    largest = Math.max(largest, p.fromBufferAttribute(position, i).angleTo(n.fromBufferAttribute(normal, i)));
  }
  return THREE.MathUtils.radToDeg(largest);
}

const angles = Object.fromEntries([1000, 10, 1, 0.1, 0.03].map(radius => [radius, largestAngle(radius)]));
console.log(angles);
const right = [1000, 10, 1].every(radius => angles[radius] < 0.2);
if (!(right && angles[0.1] > 3 && angles[0.03] > 15)) throw new Error('this has changed');
END
node normals.mjs
