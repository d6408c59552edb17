#!/bin/sh
# lib3mf 2.5.0: coordinates are cut off after six decimals, not rounded, whatever the unit of the model.
#
# In a model in metres, which the format allows, that is a micrometre: a bearing ball of 1 mm is off by a thousandth of
# its radius, one of a tenth by a hundredth, and as digits are dropped, every vertex moves towards the origin. In
# millimetres, the default unit, it is a nanometre. Nothing warns. Call SetDecimalPrecision(9) of the writer, or use
# millimetres or micrometres.
#
# Seen: spheres of radius 1, .001 and .0001 m: errors of up to 9.6e-7, 9.4e-4 and 9.9e-3 of the radius, all inwards;
# 2e-6 or less of .001 with a precision of 9.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  lib3mf==2.5.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import re
import zipfile

import lib3mf
import numpy as np
import trimesh


def written(sphere, decimals):
    """The coordinates in the file."""
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(lib3mf.ModelUnit.Meter)
    mesh = model.AddMeshObject()
    positions = [lib3mf.Position() for _ in sphere.vertices]
    for position, vertex in zip(positions, sphere.vertices):
        position.Coordinates[:] = vertex.tolist()
    triangles = [lib3mf.Triangle() for _ in sphere.faces]
    for triangle, face in zip(triangles, sphere.faces):
        triangle.Indices[:] = face.tolist()
    mesh.SetGeometry(positions, triangles)
    model.AddBuildItem(mesh, wrapper.GetIdentityTransform())
    writer = model.QueryWriter("3mf")
    if decimals:
        writer.SetDecimalPrecision(decimals)
    writer.WriteToFile("a.3mf")
    text = zipfile.ZipFile("a.3mf").read("3D/3dmodel.model").decode()
    assert 'unit="meter"' in text
    return np.array(re.findall(r'x="([^"]*)" y="([^"]*)" z="([^"]*)"', text), dtype=float)


errors, outwards = {}, {}
for radius, decimals in ((1, 0), (1e-3, 0), (1e-4, 0), (1e-3, 9)):
    sphere = trimesh.creation.icosphere(subdivisions=2, radius=radius)
    change = written(sphere, decimals) - sphere.vertices
    errors[radius, decimals] = float(np.abs(change).max() / radius)
    outwards[radius, decimals] = float((change * np.sign(sphere.vertices)).max() / radius)
print(errors, outwards)
assert errors[1e-3, 0] > 6e-4 and errors[1e-4, 0] > 6e-3, "this has changed"
assert outwards[1e-3, 0] < 1e-6 and outwards[1e-4, 0] < 1e-6, "this has changed"
assert errors[1e-3, 9] < 2e-6, "this has changed"
END
