"""A batch over all of the real meshes next to the project; skipped where they are absent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from batches import REPORT, records
from broken_meshes import make_broken_meshes
from commands import arrays_of, command
from meshlab_spectral.batch.inputs import find_inputs
from shared_types import SharedMesh

# It has vertices only.
POINT_CLOUD = "bunny16k_points.ply"


def test_all_good_meshes_are_filtered_and_all_bad_ones_reported(
    shared_mesh: SharedMesh, samples: Path, tmp_path: Path
) -> None:
    folder = shared_mesh("dragon_40k.ply").parent
    broken, out = tmp_path / "broken", tmp_path / "out"
    broken.mkdir()
    reasons = make_broken_meshes(broken, samples / "bone.ply") | {POINT_CLOUD: "point cloud"}
    arguments = [folder, broken, broken / "unknown.mesh3", "--output", out, "--steps", 1]
    done = command("batch", *arguments, timeout=900)
    assert done.returncode == 1, done.stderr
    by_name = {Path(record["input"]).name: record for record in records(out / REPORT)}
    meshes = {file.name for file in find_inputs([str(folder)])}
    assert by_name.keys() == meshes | reasons.keys()
    for name, record in by_name.items():
        if name in reasons:
            assert record["outcome"] == "failed"
            assert reasons[name] in record["reason"]
        else:
            assert record["outcome"] == "filtered", record["reason"]
            V, _ = arrays_of(out / name)
            assert np.isfinite(V).all()
            assert record["report"]["max_displacement"] > 0
