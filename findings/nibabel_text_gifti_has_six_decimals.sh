#!/bin/sh
# nibabel 5.4.2: coordinates of a GIFTI surface that is saved as text have six decimals, whatever its size.
#
# A surface whose arrays have the encoding ASCII, as some atlases and old tools write it, loses nothing in
# millimetres. In metres a sphere of 1 cm is off by 5e-5 of its radius, one of 1 mm by 5e-4, and one of 10
# micrometres by 5 %; one of half a micrometre is a point or two. The base64 encodings keep every bit. Nothing
# warns, and to save again a file that was read from text does it, too.
#
# Seen: largest error over the radius 5e-7, 4.6e-4, 4.9e-2, 0.5 for radii of 1, 1e-3, 1e-5, 1e-6; 0 in base64.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check nibabel==5.4.2 numpy==2.4.6 trimesh==5.2.0
cd "$folder"
venv/bin/python - <<'END'
import nibabel
import numpy as np
import trimesh
from nibabel.gifti import GiftiDataArray, GiftiImage

sphere = trimesh.creation.icosphere(subdivisions=2)
seen = {}
for encoding in ("ASCII", "B64BIN", "B64GZ"):
    for radius in (1.0, 1e-3, 1e-5, 1e-6):
        points = (radius * sphere.vertices).astype("f4")
        arrays = [
            GiftiDataArray(points, intent="NIFTI_INTENT_POINTSET", encoding=encoding),
            GiftiDataArray(
                sphere.faces.astype("i4"), intent="NIFTI_INTENT_TRIANGLE", encoding=encoding
            ),
        ]
        GiftiImage(darrays=arrays).to_filename("sphere.surf.gii")
        read = nibabel.load("sphere.surf.gii").darrays[0].data
        seen[encoding, radius] = float(np.abs(read - points).max() / radius)
print(seen)
for radius, error in {1.0: 5e-7, 1e-3: 4.6e-4, 1e-5: 0.049, 1e-6: 0.5}.items():
    assert 0.8 * error < seen["ASCII", radius] < 1.2 * error, "this has changed"
assert all(error == 0 for (one, _), error in seen.items() if one != "ASCII"), "this has changed"
END
