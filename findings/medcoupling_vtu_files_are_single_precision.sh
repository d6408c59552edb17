#!/bin/sh
# medcoupling 9.15.0: writeVTK saves coordinates and fields as Float32, though meshes and MED files have doubles.
#
# Far from the origin, as in projected coordinates, vertices fall together and slopes become steps, without a message.
# Fields lose their digits, too, and no option chooses the type. Write MED, or subtract an origin first.
#
# Seen: 100 squares of .1 by .1 at (500000, 5000000), where Float32 has steps of .5: 80 have no area after writeVTK, and
# a field of 1/3 is off by 1e-8. The MED file has the same coordinates to the last bit.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  medcoupling==9.15.0 pyvista==0.49.1 vtk==9.6.2 numpy==2.4.6
cd "$folder"
venv/bin/python -W ignore - <<'END'
import medcoupling as mc
import numpy as np
import pyvista

axis = mc.DataArrayDouble(np.linspace(0, 1, 11))
grid = mc.MEDCouplingCMesh("grid")
grid.setCoords(axis + 500000.0, axis + 5000000.0)
mesh = grid.buildUnstructured()
area = mesh.getMeasureField(True).getArray().toNumPyArray()
assert np.allclose(area, 0.01, rtol=1e-6)
field = mc.MEDCouplingFieldDouble(mc.ON_CELLS)
field.setMesh(mesh)
field.setName("field")
field.setArray(mc.DataArrayDouble(np.full(100, 1 / 3)))
field.checkConsistencyLight()
read = pyvista.read(field.writeVTK("field.vtu"))
flat = int((read.compute_cell_sizes()["Area"] < 1e-12).sum())
error = abs(float(read["field"][0]) - 1 / 3)
print(f"vtu: {read.points.dtype}, {flat} of 100 squares without an area, the field of 1/3 is off by {error:.1g}")
mc.WriteMesh("grid.med", mesh, True)
same = np.array_equal(mc.ReadMeshFromFile("grid.med").getCoords().toNumPyArray(), mesh.getCoords().toNumPyArray())
print(f"med: {'the same' if same else 'other'} coordinates")
assert same
assert read.points.dtype == np.float32 and flat == 80, "this has changed"
END
