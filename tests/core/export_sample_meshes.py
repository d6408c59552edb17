"""Write pymeshlab's sample meshes, decimated, as the PLY files that the C++ tests read.

usage: export_sample_meshes.py FOLDER

Exit code 77, which ctest takes for "skipped", when pymeshlab is not installed.
"""

import importlib.util
import pathlib
import sys

VERTICES = 1500
"""Size of the meshes: a dense eigenproblem of so many unknowns takes seconds."""

NAMES = ("bunny.obj", "bone.ply", "cow.obj")


def main(folder: pathlib.Path) -> int:
    """Export every mesh; return the exit code."""
    if importlib.util.find_spec("pymeshlab") is None:
        print("skipped: pymeshlab is not installed for", sys.executable)
        return 77
    import numpy as np
    import pymeshlab

    folder.mkdir(parents=True, exist_ok=True)
    samples = pathlib.Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
    for name in NAMES:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(samples / name))
        meshes.meshing_remove_duplicate_vertices()
        meshes.meshing_remove_unreferenced_vertices()
        meshes.meshing_decimation_quadric_edge_collapse(
            targetfacenum=2 * VERTICES, preservetopology=True, qualitythr=0.5
        )
        vertices = meshes.current_mesh().vertex_matrix().astype("<f8")
        faces = np.zeros(
            meshes.current_mesh().face_number(), dtype=[("count", "u1"), ("index", "<i4", 3)]
        )
        faces["count"] = 3
        faces["index"] = meshes.current_mesh().face_matrix()
        header = (
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(vertices)}\n"
            "property double x\nproperty double y\nproperty double z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        target = folder / (pathlib.Path(name).stem + ".ply")
        target.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())
        print(target.name, len(vertices), "vertices", len(faces), "faces")
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
