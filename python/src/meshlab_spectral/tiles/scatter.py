"""Handing each face to every tile that needs it: one pass over the faces."""

from __future__ import annotations

import numpy as np

from meshlab_spectral.formats.rows import MeshRows, chunks
from meshlab_spectral.tiles.cells import near_cells
from meshlab_spectral.tiles.plan import Plan, StageCallback, Workspace


def scatter(mesh: MeshRows, plan: Plan, work: Workspace, on_progress: StageCallback) -> None:
    """Append the corners of each face to the file of every tile whose cell it is near.

    If there is a selection, also whether the face is selected.
    """
    has_flags = plan.has_selection and mesh.flags[1]
    for i, j in chunks(mesh.faces):
        on_progress("dividing the mesh", i / mesh.faces)
        F = mesh.triangles(i, j)
        a, b, c = mesh.corners_of(F)
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        chosen = mesh.selected_faces(i, j) if has_flags else None
        for tile, rows in near_cells(plan.tree, low, high, plan.reach):
            if not len(rows):
                continue
            with work.file(tile, "faces").open("ab") as file:
                file.write(F[rows].astype("<u4").data)
            if chosen is not None:
                with work.file(tile, "chosen").open("ab") as file:
                    file.write(chosen[rows].data)
        mesh.forget()
    work.set_scattered()
