"""What is written is what other programs open: faces, normals, colours.

Each program reads the formats that it knows; those that are not installed are skipped by name:
`pip install open3d assimp-py meshlib lib3mf networkx lxml bpy` and, in a folder that NODE_PATH
names, `npm install gltf-validator three` add them.
"""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pymeshlab
import pytest
import pyvista
import trimesh
from helpers import filter_file
from meshlab_spectral import FilterOptions
from numpy.typing import NDArray
from plyfile import PlyData

Array = NDArray[Any]
SMOOTH = FilterOptions.from_dict({"feature_size": "20%"})
RED, BLUE = [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]


class Seen(NamedTuple):
    """What a program sees."""

    vertices: Array
    faces: Array
    normals: Array | None = None  # of the vertices
    colours: Array | None = None  # of the vertices, 0 to 1


def by_trimesh(path: Path) -> Seen:
    if path.suffix == ".3mf":
        pytest.importorskip("networkx")
        pytest.importorskip("lxml")
    mesh = trimesh.load(path, process=False, force="mesh")
    normals = mesh._cache.cache.get("vertex_normals")
    colours = None
    if mesh.visual.kind == "vertex":
        colours = np.asarray(mesh.visual.vertex_colors)[:, :3] / 255
    return Seen(np.asarray(mesh.vertices), np.asarray(mesh.faces), normals, colours)


def by_vtk(path: Path) -> Seen:
    mesh = pyvista.read(path)
    colours = mesh.point_data.get("RGB", mesh.point_data.get("RGBA"))
    return Seen(
        np.asarray(mesh.points),
        mesh.faces.reshape(-1, 4)[:, 1:],
        mesh.point_data.active_normals,
        None if colours is None else np.asarray(colours)[:, :3] / 255,
    )


def by_meshio(path: Path) -> Seen:
    mesh = pytest.importorskip("meshio").read(path)
    names = [name for name in mesh.point_data if name in ("obj:vn", "Normals")]
    normals = mesh.point_data[names[0]] if names else None
    return Seen(mesh.points[:, :3], mesh.cells_dict["triangle"], normals)


def by_open3d(path: Path) -> Seen:
    open3d = pytest.importorskip("open3d")
    mesh = open3d.io.read_triangle_mesh(str(path))
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    colours = np.asarray(mesh.vertex_colors) if mesh.has_vertex_colors() else None
    return Seen(np.asarray(mesh.vertices), np.asarray(mesh.triangles), normals, colours)


def by_assimp(path: Path) -> Seen:
    assimp = pytest.importorskip("assimp_py")
    scene = assimp.import_file(str(path), assimp.Process_Triangulate)
    (mesh,) = scene.meshes  # whose numbers are the scene's
    arrays = [
        None if a is None else np.array(a) for a in (mesh.vertices, mesh.indices, mesh.normals)
    ]
    vertices, faces, normals = (None if a is None else a.reshape(-1, 3) for a in arrays)
    del scene
    return Seen(vertices, faces, normals)


def by_meshlib(path: Path) -> Seen:
    meshlib = pytest.importorskip("meshlib.mrmeshpy")
    if path.suffix == ".off" and path.read_bytes().startswith(b"COFF"):
        pytest.skip("MeshLib reads no OFF with colours of vertices")
    numbers = pytest.importorskip("meshlib.mrmeshnumpy")
    mesh = meshlib.loadMesh(str(path))
    return Seen(numbers.getNumpyVerts(mesh), numbers.getNumpyFaces(mesh.topology))


def by_lib3mf(path: Path) -> Seen:
    model = pytest.importorskip("lib3mf").get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    vertices = [list(one.Coordinates) for one in mesh.GetVertices()]
    return Seen(
        np.array(vertices), np.array([list(one.Indices) for one in mesh.GetTriangleIndices()])
    )


def by_validator(path: Path) -> Seen:
    """The validator of the standard of glTF, which finds no fault; trimesh then reads the file."""
    script = (
        "const check = require('gltf-validator').validateBytes;"
        "check(new Uint8Array(require('fs').readFileSync(process.argv[1]))).then((found) => {"
        "console.log(JSON.stringify(found.issues.messages));"
        "process.exit(found.issues.numErrors + found.issues.numWarnings);})"
    )
    by_node("gltf-validator", script, path)
    return by_trimesh(path)


def by_node(package: str, script: str, path: Path) -> bytes:
    """What a script prints, unless there is no Node or not the package."""
    node = shutil.which("node")
    if (
        node is None
        or subprocess.run([node, "-e", f"require('{package}')"], check=False).returncode
    ):
        pytest.skip(f"no {package}")
    done = subprocess.run([node, "-e", script, str(path)], capture_output=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def by_three(path: Path) -> Seen:
    """three.js, with the loader of the format; it takes no matrix of a node into account."""
    script = """
        const { readFileSync } = require('fs');
        const { dirname, extname } = require('path');
        const path = process.argv[1], ending = extname(path).slice(1).toUpperCase();
        const name = `${{ GLB: 'GLTF' }[ending] ?? ending}Loader`;
        const folder = `${dirname(require.resolve('three'))}/../examples/jsm/loaders`;
        import(`${folder}/${name}.js`).then(async (loaders) => {
          const bytes = readFileSync(path), loader = new loaders[name]();
          const data = ending === 'OBJ' ? bytes.toString() : new Uint8Array(bytes).buffer;
          const read = ending === 'GLB' ? await loader.parseAsync(data, '') : loader.parse(data);
          let found = read;
          (read.scene ?? read).traverse?.((one) => { if (one.isMesh) found = one.geometry; });
          const { position, normal, color } = found.attributes;
          const arrays = [position, found.index, normal, color];
          const numbers = (one) => Array.from(one.array, (_, k) =>
            one.getComponent(Math.floor(k / one.itemSize), k % one.itemSize));
          console.log(JSON.stringify(arrays.map((one) => one && numbers(one))));
        });"""
    arrays = [one and np.array(one) for one in json.loads(by_node("three", script, path))]
    vertices, faces, normals, colours = arrays
    vertices = vertices.reshape(-1, 3)
    faces = np.arange(len(vertices)) if faces is None else faces
    return Seen(
        vertices,
        faces.reshape(-1, 3),
        None if normals is None or path.suffix == ".stl" else normals.reshape(-1, 3),
        None if colours is None else colours.reshape(len(vertices), -1)[:, :3],
    )


def by_blender(path: Path) -> Seen:
    """Blender, in a process of its own: it and pymeshlab bring libraries of one name."""
    script = """
import json, sys, bpy
path, ending = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
if ending == "glb":
    bpy.ops.import_scene.gltf(filepath=path)
else:
    read = getattr(bpy.ops.wm, ending + "_import")
    read(filepath=path, forward_axis="Y", up_axis="Z")
(mesh,) = bpy.data.meshes
colours = mesh.color_attributes[0].data if mesh.color_attributes else []
found = [[one.co for one in mesh.vertices], [one.vertices for one in mesh.polygons]]
found += [[one.vector for one in mesh.vertex_normals], [one.color for one in colours]]
print("\\n" + json.dumps([[list(row) for row in one] for one in found]))
"""
    if importlib.util.find_spec("bpy") is None:
        pytest.skip("no bpy")
    words = [sys.executable, "-c", script, str(path), path.suffix[1:]]
    done = subprocess.run(words, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    arrays = [np.array(one) for one in json.loads(done.stdout.splitlines()[-1])]
    vertices, faces, normals, colours = arrays
    if path.suffix == ".glb":  # of which y is up
        vertices, normals = (one[:, [0, 2, 1]] * [1, 1, -1] for one in (vertices, normals))
    if len(colours) == faces.size:  # of corners
        _, first = np.unique(faces, return_index=True)
        colours = colours[first]
    return Seen(vertices, faces, normals, colours[:, :3] if len(colours) else None)


def by_meshlab(path: Path) -> Seen:
    mesh_set = pymeshlab.MeshSet(verbose=False)
    mesh_set.load_new_mesh(str(path))
    mesh = mesh_set.current_mesh()
    colours = mesh.vertex_color_matrix()[:, :3] if mesh.has_vertex_color() else None
    return Seen(mesh.vertex_matrix(), mesh.face_matrix(), None, colours)


PROGRAMS: dict[Callable[[Path], Seen], str] = {
    by_trimesh: "3mf glb obj off ply stl",
    by_vtk: "obj ply stl vtk vtp",
    by_meshio: "obj ply stl",
    by_open3d: "glb obj off ply stl",
    by_assimp: "3ds 3mf glb obj off ply stl",
    by_meshlib: "obj off ply stl",
    by_lib3mf: "3mf",
    by_validator: "glb",
    by_three: "glb obj ply stl",
    by_blender: "glb obj ply stl",
    by_meshlab: "3ds 3mf ctm dae obj off ply stl wrl x3d",
}
# Formats whose colours the program reads, too.
COLOURED = {
    by_trimesh: "glb obj ply",
    by_validator: "glb",
    by_vtk: "obj ply vtk vtp",
    by_open3d: "glb obj off ply",
    by_three: "glb obj ply",
    by_blender: "glb obj ply",
    by_meshlab: "dae obj off ply wrl x3d",
}
# Formats that are written only where the input has them, and another program that writes it.
PATCHED = {
    "glb": lambda path, target: trimesh.load(path, process=False).export(target),
    "vtk": lambda path, target: pyvista.read(path).save(target),
    "vtp": lambda path, target: pyvista.read(path).save(target),
}
CASES = [(read, ending) for read, endings in PROGRAMS.items() for ending in endings.split()]


def write_source(path: Path, has_more: bool) -> None:
    """Write a noisy sphere, red above and blue below, or without colours and normals."""
    sphere = pyvista.Icosphere(nsub=3)
    V = np.asarray(sphere.points, float)
    V *= 1 + np.random.default_rng(2).normal(0, 0.01, (len(V), 1))
    F = np.asarray(sphere.faces).reshape(-1, 4)[:, 1:]
    colours = np.where(V[:, [2]] > 0, [RED], [BLUE])
    mesh_set = pymeshlab.MeshSet(verbose=False)
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, v_color_matrix=colours))
    flags = {"save_vertex_color": has_more, "save_vertex_normal": has_more}
    mesh_set.save_current_mesh(str(path), **flags, save_vertex_quality=False)


@pytest.mark.parametrize("has_more", [False, True], ids=["bare", "coloured"])
@pytest.mark.parametrize(("read", "ending"), CASES, ids=lambda one: getattr(one, "__name__", one))
def test_a_second_program_sees_what_was_written(
    read: Callable[[Path], Seen], ending: str, has_more: bool, tmp_path: Path
) -> None:
    source, target = tmp_path / "in.ply", tmp_path / f"out.{ending}"
    write_source(source, has_more)
    own = source
    if ending in PATCHED:
        own = tmp_path / f"in.{ending}"
        PATCHED[ending](source, own)
    report = filter_file(own, target, SMOOTH)
    filter_file(source, tmp_path / "expected.ply", SMOOTH)
    expected = PlyData.read(tmp_path / "expected.ply")
    V = np.column_stack([expected["vertex"][axis] for axis in "xyz"])
    F = np.vstack(expected["face"]["vertex_indices"])
    seen = read(target)
    assert len(seen.faces) == len(F)
    corners = [P[G].mean(axis=1) for P, G in ((V, F), (seen.vertices, seen.faces))]
    distances = np.linalg.norm(corners[1][:, None] - corners[0][None], axis=2).min(axis=1)
    assert distances.max() < 1e-4
    if seen.normals is not None and len(seen.normals):
        directions = seen.vertices / np.linalg.norm(seen.vertices, axis=1)[:, None]
        np.testing.assert_allclose(np.linalg.norm(seen.normals, axis=1), 1, atol=1e-3)
        assert (np.einsum("ij,ij->i", seen.normals, directions) > 0.8).all()
    has_colours = seen.colours is not None and len(np.unique(seen.colours, axis=0)) > 1
    keeps = has_more and ending in COLOURED.get(read, "").split()
    assert has_colours == keeps
    told = any("colours" in warning for warning in report["warnings"])
    assert told == (has_more and ending in ("3ds", "3mf", "stl"))
    if keeps:
        assert seen.colours is not None
        is_above = seen.vertices[:, 2] > 0.05
        np.testing.assert_allclose(seen.colours[is_above], [RED[:3]] * is_above.sum(), atol=0.01)
