"""Write pymeshlab's sample meshes, decimated, as the PLY files that the C++ tests read.

usage: export_sample_meshes.py FOLDER

Next to each mesh NAME.ply goes NAME.stiffness, the matrix W of its intrinsic Delaunay Laplacian by
the package robust_laplacian: rows of three doubles (i, j, W_ij).

Exit code 77, which ctest counts as skipped, when a required package is not installed.
"""

import pathlib
import sys
from typing import Any

try:
    import numpy as np
    import pymeshlab
    import robust_laplacian
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

VERTICES = 1000
"""Size of the meshes: a dense eigenproblem of this size takes a second."""

Vertices = Any
Faces = Any

NAMES = ("bunny.obj", "bone.ply", "cow.obj")


def with_fins(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """Add triangles that stand on edges: these edges then have three triangles."""
    rng = np.random.default_rng(3)
    chosen = faces[rng.choice(len(faces), 20, replace=False)]
    tips = vertices[chosen[:, 0]] + 0.1 * rng.standard_normal((20, 3)) * np.ptp(vertices)
    fins = np.column_stack([chosen[:, 0], chosen[:, 1], len(vertices) + np.arange(20)])
    return np.vstack([vertices, tips]), np.vstack([faces, fins])


def keep(vertices: Vertices, faces: Faces, kept: Any) -> tuple[Vertices, Faces]:
    """Cut a mesh down to the faces whose vertices are all kept: it then has a boundary."""
    faces = faces[kept[faces].all(axis=1)]
    used, index = np.unique(faces, return_inverse=True)
    return vertices[used], index.reshape(-1, 3)


def write_ply(target: pathlib.Path, vertices: Vertices, faces: Faces) -> None:
    """Write x, y, z as doubles and triangles, binary."""
    records = np.zeros(len(faces), dtype=[("count", "u1"), ("index", "<i4", 3)])
    records["count"] = 3
    records["index"] = faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    target.write_bytes(header.encode() + vertices.astype("<f8").tobytes() + records.tobytes())
    print(target.name, len(vertices), "vertices", len(faces), "faces")


def write_stiffness(target: pathlib.Path, vertices: Vertices, faces: Faces) -> None:
    """Write the matrix W of the package robust_laplacian."""
    W = robust_laplacian.mesh_laplacian(vertices, faces)[0].tocoo()
    target.write_bytes(np.column_stack([W.row, W.col, W.data]).astype("<f8").tobytes())


def main(folder: pathlib.Path) -> None:
    """Export every mesh."""
    folder.mkdir(parents=True, exist_ok=True)
    samples = pathlib.Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
    meshes = {}
    for name in NAMES:
        mesh_set = pymeshlab.MeshSet()
        mesh_set.load_new_mesh(str(samples / name))
        mesh_set.meshing_remove_duplicate_vertices()
        mesh_set.meshing_remove_unreferenced_vertices()
        mesh_set.meshing_decimation_quadric_edge_collapse(
            targetfacenum=2 * VERTICES, preservetopology=True, qualitythr=0.5
        )
        mesh = mesh_set.current_mesh()
        meshes[pathlib.Path(name).stem] = (mesh.vertex_matrix(), mesh.face_matrix())
    meshes["cow_with_fins"] = with_fins(*meshes["cow"])
    vertices, faces = meshes["bunny"]
    meshes["half_bunny"] = keep(vertices, faces, vertices[:, 0] < np.median(vertices[:, 0]))
    for name, (vertices, faces) in meshes.items():
        write_ply(folder / f"{name}.ply", vertices, faces)
        write_stiffness(folder / f"{name}.stiffness", vertices, faces)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
