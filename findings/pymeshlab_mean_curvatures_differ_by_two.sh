#!/bin/sh
# pymeshlab 2025.7.post1: two filters' "Mean" curvature of one sphere differ by a factor of 2, and "RMS Curvature" is
# no root of a mean.
#
# compute_scalar_by_discrete_curvature_per_vertex gives 1 / radius, the mean of the principal curvatures;
# compute_curvature_and_color_apss_per_vertex gives their sum. The first filter's RMS is the root of the sum of their
# squares, larger by the root of 2 than the root of their mean square. Nothing in the filters' texts tells. Halve
# APSS's mean, and divide RMS by the root of 2.
#
# Seen: for radii of .01, 1 and 100, times the radius: 1.000 and 1.999; RMS 1.411. Both Gaussian curvatures, times its
# square, are 1.00.
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

    mean = curvature(discrete, "Mean Curvature") * radius, curvature(apss, "Mean") * radius
    rms = curvature(discrete, "RMS Curvature") * radius
    gauss = curvature(discrete, "Gaussian Curvature") * radius**2, curvature(apss, "Gauss") * radius**2
    print(f"radius {radius}: mean {mean[0]:.3f} {mean[1]:.3f}, RMS {rms:.3f}, Gauss {gauss[0]:.3f} {gauss[1]:.3f}")
    assert np.allclose(mean, (1, 2), atol=0.02), "this has changed"
    assert np.isclose(rms, 2**0.5, atol=0.02), "this has changed"
    assert np.allclose(gauss, 1, atol=0.02), "this has changed"
END
