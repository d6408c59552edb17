"""
How rough is it
===============

The height map of an instrument, measured as ISO 25178 says: from the file to a number that can be
checked.

The map here is written by a formula, so that the truth is known: a ground surface, of grooves 25 µm
apart and 1.2 µm deep to either side, on a part that is wavy and was not level, with some noise and
with pixels that the instrument has not seen. Height maps need the extra ``maps``: ``pip install
'meshlab-spectral[maps]'``.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import meshlab_spectral as spectral
import numpy as np
import pyvista
import surfalize

folder = Path(tempfile.mkdtemp())
random = np.random.default_rng(1)
step = 2.0  # µm
y, x = step * np.indices((240, 240))
grooves = 1.2 * np.sin(2 * np.pi * x / 25)
form = 3 * np.cos(2 * np.pi * y / 1000) + 0.02 * x - 0.01 * y
z = grooves + form + 0.02 * random.normal(size=x.shape)
z[random.random(z.shape) < 0.002] = np.nan
surfalize.Surface(z, step, step).save(folder / "ground.x3p")

# %%
# Measure the file
# ----------------
# The form is a plane, and the nesting index of the L-filter 80 µm: what is larger is waviness. In
# files of instruments lengths have a unit, and so have the numbers. In a shell:
#
# .. code-block:: sh
#
#     meshlab-spectral texture ground.x3p --form plane --nesting-index-l 80 --csv ground.csv


def measured(*options: str) -> str:
    command = [sys.executable, "-m", "meshlab_spectral.cli", "texture"]
    command += [str(folder / "ground.x3p"), "--form", "plane", "--nesting-index-l", "80", *options]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


texture = json.loads(measured("--json", "--output", str(folder / "heights.ply")))
for name in ("Sa", "Sq", "Sz", "Sdq", "Sal", "Sk"):
    print(f"{name:4}{texture[name]:8.3f} {'' if name == 'Sdq' else texture['unit']}")

# %%
# Is it true?
# -----------
# A sine of the amplitude A has Sa = 2 A / pi and Sq = A / sqrt(2), and its autocorrelation, a
# cosine, falls to .2 after arccos(.2) / (2 pi) = .218 of its wavelength. The noise adds its square
# to that of Sq. The filter lets grooves of a third of its nesting index pass.

for name, truth in {
    "Sa": 1.2 * 2 / np.pi,
    "Sq": np.hypot(1.2 / np.sqrt(2), 0.02),
    "Sal": 25 * np.arccos(0.2) / (2 * np.pi),
}.items():
    print(f"{name:4}{texture[name]:8.3f}, by the formula {truth:.3f}")

# %%
# There is no Str, the ratio of the shortest to the longest distance over which heights are alike:
# along the grooves they stay alike up to the rim of the map.

print("Str" in texture)

# %%
# Where is it rough?
# ------------------
# ``--output`` writes the map as a mesh, with its heights as quality. Within a cutoff of its rim
# nothing is measured; pixels that are missing leave nothing out but themselves.

mesh = pyvista.read(folder / "heights.ply")
V, F = np.asarray(mesh.points, dtype=float), mesh.regular_faces
found = spectral.surface_texture(V, F, form="plane", nesting_index_l=80)
figure = spectral.plot_texture(V, F, found, "ground.x3p")
print(found.vertices_evaluated, "of", np.isfinite(z).sum(), "heights are measured")

# %%
# How much of it carries?
# -----------------------
# Smr(c) is the share of the area that is at least as high as c. Of a sine, a third is higher than
# half of its amplitude.

print(f"{100 * float(found.material_ratio(0.6)):.1f} %")

# %%
# A free-form part has no plane: without ``form``, heights are those above its smooth surface, as in
# :doc:`4_roughness_and_comparison`. A bore or a ball is measured with ``form="cylinder"`` or
# ``"sphere"``, and many files at once become one table: ``texture *.sur --csv table.csv``.
