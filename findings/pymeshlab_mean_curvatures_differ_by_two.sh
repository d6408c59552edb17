#!/bin/sh
# pymeshlab 2025.7.post1: two filters' "Mean" curvature of one sphere differ by a factor of 2, and "ABS Curvature" is
# not what its text says.
#
# compute_scalar_by_discrete_curvature_per_vertex gives 1 / radius, the mean of the principal curvatures;
# compute_curvature_and_color_apss_per_vertex gives their sum, and its text does not tell. The first filter's text has
# |H| + |K| for ABS, mean and Gaussian curvature, which have different units; it gives the sum of the absolute principal
# curvatures. Halve APSS's mean before it is compared.
#
# Seen: for radii of .01, 1 and 100: means of 100, 1, .01 and 200, 2, .02; ABS of 200, 2, .02 where the text has 10100,
# 2, .0101. The Gaussian curvatures of both are right: 1 / radius^2.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  pymeshlab==2025.7.post1 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import pymeshlab
import trimesh

discrete = "compute_scalar_by_discrete_curvature_per_vertex"
apss = "compute_curvature_and_color_apss_per_vertex"
for radius in (0.01, 1.0, 100.0):
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=radius)

    def curvature(name, kind):
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(sphere.vertices, sphere.faces))
        meshes.apply_filter(name, curvaturetype=kind)
        return float(np.median(meshes.current_mesh().vertex_scalar_array()))

    mean = curvature(discrete, "Mean Curvature"), curvature(apss, "Mean")
    gauss = curvature(discrete, "Gaussian Curvature"), curvature(apss, "Gauss")
    absolute = curvature(discrete, "ABS Curvature")
    print(f"radius {radius}: mean {mean[0]:.4g} {mean[1]:.4g}, Gauss {gauss[0]:.4g} {gauss[1]:.4g},", end=" ")
    print(f"ABS {absolute:.4g}, |H| + |K| {mean[0] + gauss[0]:.4g}")
    assert np.allclose(np.multiply(mean, radius), (1, 2), atol=0.02), "this has changed"
    assert np.allclose(np.multiply(gauss, radius**2), 1, atol=0.02), "this has changed"
    assert np.isclose(absolute * radius, 2, atol=0.02), "this has changed"
END
