#!/bin/sh
# pymeshlab 2025.7.post1: "Scale Dependent Laplacian Smooth" moves vertices by a length of its own, whatever the size
# of the mesh, though its only strength, delta, is a percentage of the diagonal.
#
# A step is delta times the sum of the edges' directions over the sum of their lengths: a length over a length. So
# the default, 1 %, hardly touches a mesh in millimetres, flattens the same one in metres, and at 10 % turns a sphere
# of a centimetre, in metres, through its centre. For the same shape, delta must go with the square of the size.
#
# Seen: one step at 1 % moves vertices of spheres of radius 100, 1 and .01 inwards by .00173 each: .000017, .0017 and
# .17 of the radius; at 10 % 1.73 of it for .01. "Laplacian Smooth" moves them by .0098 of the radius, for all three.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  pymeshlab==2025.7.post1 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import pymeshlab
import trimesh


def inwards(radius, name, **options):
    """How far one step moves vertices of a sphere towards its centre, on average."""
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(sphere.vertices, sphere.faces))
    meshes.apply_filter(name, stepsmoothnum=1, **options)
    heights = (meshes.current_mesh().vertex_matrix() * sphere.vertices).sum(axis=1) / radius
    return float(radius - heights.mean())


scale_dependent = "apply_coord_laplacian_smoothing_scale_dependent"
for radius in (100.0, 1.0, 0.01):
    default = inwards(radius, scale_dependent)
    ten = inwards(radius, scale_dependent, delta=pymeshlab.PercentageValue(10))
    laplacian = inwards(radius, "apply_coord_laplacian_smoothing")
    print(f"radius {radius}: 1 % {default:.6f}, 10 % {ten:.6f}, Laplacian {laplacian:.6f}")
    assert abs(default - 0.001732) < 1e-5 and abs(ten - 0.01732) < 1e-4, "this has changed"
    assert abs(laplacian / radius - 0.00976) < 1e-4, "this has changed"
END
