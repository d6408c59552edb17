"""Meshes of one file that meet move alike where they do."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import filter_file
from meshlab_spectral import DenoiseOptions, FilterOptions, filter_mesh
from meshlab_spectral.files.measures import mesh_info
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.formats.opening import open_document
from numpy.typing import NDArray

Array = NDArray[Any]
Piece = tuple[Array, Array]  # vertices and faces
NOISY = DenoiseOptions.from_dict({"noise_height": 0.01})
SMOOTH = FilterOptions.from_dict({"feature_size": "15%"})


def noisy_sphere() -> Piece:
    import pyvista

    sphere = pyvista.Icosphere(nsub=4)
    V = np.asarray(sphere.points, float)
    V *= 1 + np.random.default_rng(2).normal(0, 0.01, (len(V), 1))
    return V.astype("f4").astype(float), np.asarray(sphere.faces).reshape(-1, 4)[:, 1:]


def cut(V: Array, F: Array, pieces: int) -> list[Piece]:
    """Cut a mesh into wedges around the z axis."""
    centres = V[F].mean(axis=1)
    wedge = ((np.arctan2(centres[:, 1], centres[:, 0]) / np.pi + 1) * pieces / 2).astype(int)
    result = []
    for number in range(pieces):
        used, index = np.unique(F[wedge == number], return_inverse=True)
        result.append((V[used], index.reshape(-1, 3)))
    return result


def write_glb(path: Path, pieces: Sequence[Piece], shift: bool = False) -> Path:
    """Write a mesh for each piece; with `shift`, placed by a transform."""
    tree: dict[str, Any] = {"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "nodes": []}
    blob, views, accessors, meshes = b"", list[Any](), list[Any](), list[Any]()
    for number, (V, F) in enumerate(pieces):
        origin = V.mean(axis=0) if shift else np.zeros(3)
        tree["nodes"].append({"mesh": number, "translation": origin.tolist()})
        tree["scenes"][0]["nodes"].append(number)
        attributes = {"POSITION": len(accessors)}
        meshes.append(
            {
                "name": f"piece {number}",
                "primitives": [{"attributes": attributes, "indices": len(accessors) + 1}],
            }
        )
        for array, kind, code in (((V - origin).astype("<f4"), "VEC3", 5126), (F, "SCALAR", 5125)):
            data = array.astype("<f4" if kind == "VEC3" else "<u4")
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": data.nbytes})
            count = len(data) if kind == "VEC3" else data.size
            accessors.append(
                {"bufferView": len(views) - 1, "componentType": code, "count": count, "type": kind}
            )
            blob += data.tobytes()
    tree |= {"meshes": meshes, "accessors": accessors, "bufferViews": views}
    tree["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(blob), len(text), b"JSON")
    path.write_bytes(head + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob)
    return path


def write_obj(path: Path, pieces: Sequence[Piece], shift: bool = False) -> Path:
    """Write an object for each piece."""
    lines, begin = list[str](), 1
    for number, (V, F) in enumerate(pieces):
        lines.append(f"o piece {number}")
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*row) for row in V.tolist()]
        lines += ["f {} {} {}".format(*row) for row in (F + begin).tolist()]
        begin += len(V)
    path.write_text("\n".join([*lines, ""]))
    return path


def shape_of(path: Path) -> Array:
    return np.vstack([part.vertices for part in open_document(path).parts])


@pytest.mark.parametrize("options", [SMOOTH, DenoiseOptions()], ids=["filter", "denoise"])
@pytest.mark.parametrize("pieces", [2, 5])
@pytest.mark.parametrize(
    ("write", "ending", "shift"),
    [(write_glb, "glb", False), (write_glb, "glb", True), (write_obj, "obj", False)],
)
def test_pieces_of_a_surface_are_filtered_as_the_whole(
    write: Any, ending: str, shift: bool, pieces: int, options: Options, tmp_path: Path
) -> None:
    V, F = noisy_sphere()
    parts = cut(V, F, pieces)
    source = write(tmp_path / f"in.{ending}", parts, shift)
    whole = write_obj(tmp_path / "whole.obj", [(V, F)])
    report = filter_file(source, tmp_path / f"out.{ending}", options)
    filter_file(whole, tmp_path / "expected.obj", options)
    assert report["components"] == 1
    expected, result = shape_of(tmp_path / "expected.obj"), shape_of(tmp_path / f"out.{ending}")
    origins = np.vstack([V for V, _ in parts])
    places = {tuple(row): k for k, row in enumerate(V.tolist())}
    number = [places[tuple(row)] for row in origins.tolist()]
    np.testing.assert_allclose(result, expected[number], atol=2e-5)


def box(low: float, high: float, cells: int) -> Piece:
    """A closed box with noise that depends on the position alone."""
    import pyvista

    mesh = pyvista.Box(bounds=(low, high, 0, 1, 0, 1), level=cells - 1, quads=False).clean()
    V = np.asarray(mesh.points, float)
    place = np.round(V * cells).astype(int) @ [1, 100, 10000]
    V += np.random.default_rng(1).normal(0, 0.01, (10**6, 3))[place]
    return V.astype("f4").astype(float), np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]


@pytest.mark.parametrize("options", [SMOOTH, NOISY], ids=["filter", "denoise"])
@pytest.mark.parametrize(("write", "ending"), [(write_glb, "glb"), (write_obj, "obj")])
def test_closed_meshes_that_touch_stay_two_and_move_alike_where_they_touch(
    write: Any, ending: str, options: Options, tmp_path: Path
) -> None:
    labels = [box(0, 1, 16), box(1, 2, 16)]
    source, target = write(tmp_path / f"in.{ending}", labels), tmp_path / f"out.{ending}"
    report = filter_file(source, target, options)
    assert sum(one["components"] for one in report.get("meshes", [report])) == 2
    before, after = shape_of(source), shape_of(target)
    _, same = np.unique(before, axis=0, return_inverse=True)
    _, moved = np.unique(np.column_stack([same.ravel(), after]), axis=0, return_inverse=True)
    assert len(np.unique(moved)) == len(np.unique(same)) < len(before)
    assert (before != after).any()


def test_a_mesh_filtered_alone_tells_where_it_parts_from_others(tmp_path: Path) -> None:
    source = write_glb(tmp_path / "in.glb", cut(*noisy_sphere(), 2))
    report = filter_file(source, tmp_path / "out.glb", SMOOTH, mesh="piece 1")
    assert any("meshes part by up to" in warning for warning in report["warnings"])
    before, after = (open_document(path).parts[0] for path in (source, tmp_path / "out.glb"))
    np.testing.assert_array_equal(before.vertices, after.vertices)


@pytest.mark.parametrize("round_off", [1e-8, 1e-6, 1e-5])
def test_an_stl_with_loose_corners_is_one_surface(round_off: float, tmp_path: Path) -> None:
    V, F = noisy_sphere()
    diagonal = float(np.linalg.norm(np.ptp(V, axis=0)))
    corners = V[F] + np.random.default_rng(3).uniform(-1, 1, (len(F), 3, 3)) * round_off * diagonal
    facets = np.zeros(len(F), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    facets["corners"] = corners
    (tmp_path / "in.stl").write_bytes(bytes(80) + struct.pack("<I", len(F)) + facets.tobytes())
    report = filter_file(tmp_path / "in.stl", tmp_path / "out.stl", SMOOTH)
    (part,) = open_document(tmp_path / "in.stl").parts
    assert report["components"] == 1
    assert report["joined_vertices"] == len(part.vertices) - len(V)
    assert mesh_info(Request(tmp_path / "in.stl"), lambda *stage: None)["rims"] == 0
    expected, _ = filter_mesh(V, F, SMOOTH)
    after = np.frombuffer((tmp_path / "out.stl").read_bytes(), facets.dtype, offset=84)
    np.testing.assert_allclose(after["corners"], expected[F], atol=10 * round_off * diagonal + 1e-6)


def shared_glb(path: Path, V: Array, faces: Sequence[Array], shifts: Sequence[float]) -> Path:
    """Write meshes that have all their positions in one accessor, each at a place of its own."""
    write_glb(path, [(V, F) for F in faces])
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    tree, blob = json.loads(data[20 : 20 + size]), data[20 + size :]
    for mesh in tree["meshes"]:
        mesh["primitives"][0]["attributes"]["POSITION"] = 0
    for node, shift in zip(tree["nodes"], shifts, strict=True):
        angle = 0.1 * shift
        node["translation"] = [shift, shift / 3, 0]
        node["rotation"] = [0, 0, float(np.sin(angle)), float(np.cos(angle))]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(blob), len(text), b"JSON")
    path.write_bytes(head + text + blob)
    return path


def tree_of(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    tree: dict[str, Any] = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    return tree


def coarser(V: Array, F: Array) -> Array:
    """Faces of another level of detail at some of the same points."""
    import pyvista

    points = np.asarray(pyvista.Icosphere(nsub=3).points, float)
    directions = V / np.linalg.norm(V, axis=1)[:, None]
    nearest = np.array([np.argmax(directions @ point) for point in points])
    faces = np.asarray(pyvista.Icosphere(nsub=3).faces).reshape(-1, 4)[:, 1:]
    assert len(np.unique(nearest)) == len(points)
    return np.array(nearest[faces])


def test_levels_of_detail_at_the_same_points_do_not_mix(tmp_path: Path) -> None:
    V, F = noisy_sphere()
    alone = filter_mesh(V, F, SMOOTH)[0]
    levels = [F, coarser(V, F)]
    source = shared_glb(tmp_path / "in.glb", V, levels, [0, 0])
    report = filter_file(source, tmp_path / "out.glb", SMOOTH)
    fine, coarse = (part.vertices for part in open_document(tmp_path / "out.glb").parts)
    np.testing.assert_allclose(fine, alone, atol=1e-5)
    assert np.linalg.norm((fine - coarse)[np.unique(levels[1])], axis=1).max() > 0.01
    assert any("vertices in common with piece 0 that move apart" in w for w in report["warnings"])
    # As two objects of a file that has no accessors.
    used, index = np.unique(levels[1], return_inverse=True)
    pieces = [(V, F), (V[used], index.reshape(-1, 3))]
    filter_file(write_obj(tmp_path / "in.obj", pieces), tmp_path / "out.obj", SMOOTH)
    after = open_document(tmp_path / "out.obj").parts[0].vertices
    np.testing.assert_allclose(after[: len(V)], alone, atol=2e-3)


def test_meshes_that_use_parts_of_one_accessor_are_filtered_as_the_whole(tmp_path: Path) -> None:
    V, F = noisy_sphere()
    upper = V[F].mean(axis=1)[:, 2] > 0
    source = shared_glb(tmp_path / "in.glb", V, [F[upper], F[~upper]], [0, 0])
    report = filter_file(source, tmp_path / "out.glb", SMOOTH)
    assert report["components"] == 1
    for part in open_document(tmp_path / "out.glb").parts:
        np.testing.assert_allclose(part.vertices, filter_mesh(V, F, SMOOTH)[0], atol=1e-5)
    assert len(tree_of(tmp_path / "out.glb")["accessors"]) == len(tree_of(source)["accessors"])


def test_an_accessor_of_meshes_at_many_places_stays_one(tmp_path: Path) -> None:
    V, F = noisy_sphere()
    options = FilterOptions.from_dict({"feature_size": 0.4, "steps": 1})
    source = shared_glb(tmp_path / "in.glb", V, [F] * 8, list(range(0, 80, 10)))
    filter_file(source, tmp_path / "out.glb", options)
    before, after = tree_of(source), tree_of(tmp_path / "out.glb")
    assert len(after["accessors"]) == len(before["accessors"])
    assert (tmp_path / "out.glb").stat().st_size <= source.stat().st_size + 200
    np.testing.assert_allclose(
        open_document(tmp_path / "out.glb").parts[0].vertices,
        filter_mesh(V, F, options)[0],
        atol=1e-5,
    )
