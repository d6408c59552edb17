"""A small file of every mesh format with every kind of content, and what other programs see in it.

The shape is a noisy sphere of quadrilaterals, with triangles at its poles. It is closed, but cut
along a seam where the format has texture coordinates. No reader here comes from the package.
"""

from __future__ import annotations

import json
import shutil
import struct
import zipfile
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import nibabel
import numpy as np
import pyvista
from nibabel import gifti
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement

# Contents by kind: "coordinates", after placement, and "normals" are arrays of n x 3, all others
# are compared by ==.
Seen = dict[str, Any]
Array = NDArray[Any]


class Sample(NamedTuple):
    """How to make a file, and how to see what is in it."""

    format: str
    name: str
    write: Callable[[Path], None]
    read: Callable[[Path], Seen]


AROUND, RINGS = 16, 10
IMAGE = b"\x89PNG\r\n\x1a\n of my skin."
SKIN = "my skin.png"


def sphere(width: int) -> tuple[Array, Array, list[list[int]]]:
    """Points, texture coordinates and polygons; of rings of `width` points, and two poles."""
    u, v = np.meshgrid(np.arange(width) / AROUND, np.arange(1, RINGS + 1) / (RINGS + 1))
    uv = np.vstack([np.column_stack([u.ravel(), v.ravel()]), [[0.5, 0], [0.5, 1]]])
    a, b = 2 * np.pi * (uv[:, 0] % 1), np.pi * uv[:, 1]
    points = np.column_stack([np.sin(b) * np.cos(a), np.sin(b) * np.sin(a), np.cos(b)])
    noise = np.random.default_rng(5).normal(0, 0.01, (RINGS, AROUND))[:, np.arange(width) % AROUND]
    points *= 1 + np.append(noise, [0.01, -0.01])[:, None]
    rings = np.arange(RINGS * width).reshape(RINGS, width)[:, np.arange(AROUND + 1) % width]
    left, right = rings[:, :-1], rings[:, 1:]
    quads = np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=2).reshape(-1, 4)
    north, south = (np.full(AROUND, RINGS * width + pole) for pole in (0, 1))
    caps = np.hstack([[north, left[0], right[0]], [south, right[-1], left[-1]]])
    return points.astype("f4"), uv.astype("f4"), [*quads.tolist(), *caps.T.tolist()]


def triangles(polygons: list[list[int]]) -> list[list[int]]:
    halves = [half for p in polygons for half in (p[:3], [p[0], *p[2:]])]
    return [half for half in halves if len(half) == 3]


def unit(vectors: Array) -> Array:
    return np.array(vectors / np.linalg.norm(vectors, axis=1)[:, None], dtype="f4")


def placed(points: Array) -> Array:
    """Turn points by 90 degrees, double their distances, and shift them."""
    return np.array(points[:, [1, 0, 2]] * [-2, 2, 2] + [5, 0, 0])


ROUND, _, ROUND_POLYGONS = sphere(AROUND)
ROUND_FACES = np.array(triangles(ROUND_POLYGONS), dtype="i4")
CUT, UV, POLYGONS = sphere(AROUND + 1)
CUT_FACES = triangles(POLYGONS)
NORMALS = unit(CUT)
RGB = np.random.default_rng(6).integers(0, 256, (len(CUT), 3)).astype("u1")
AGE = np.random.default_rng(7).random(len(CUT))
LABELS = np.arange(len(CUT), dtype="i4") % 5
LINE = [0, 20, 40]


def joined(*columns: Array) -> list[str]:
    return [" ".join(f"{number:.9g}" for number in row) for row in np.hstack(columns).tolist()]


def beside(path: Path) -> dict[str, bytes]:
    """Images and materials in the folder of a file."""
    files = sorted(file for file in path.parent.rglob("*") if file.suffix in (".png", ".mtl"))
    return {str(file.relative_to(path.parent)): file.read_bytes() for file in files}


def write_ply(path: Path, text: bool, byte_order: str) -> None:
    (path.parent / SKIN).write_bytes(IMAGE)
    names = "nx ny nz red green blue x y z s t age label"
    columns = [*NORMALS.T, *RGB.T, *CUT.T, *UV.T, AGE, LABELS]
    types = [(name, column.dtype) for name, column in zip(names.split(), columns, strict=True)]
    vertex = np.array(list(zip(*columns, strict=True)), types)
    rows = [(np.array(p), UV[p].ravel(), k / 3) for k, p in enumerate(POLYGONS)]
    face = np.array(rows, [("vertex_indices", "O"), ("texcoord", "O"), ("part", "f8")])
    edge = np.array([(0, 20), (20, 40)], [("vertex1", "i4"), ("vertex2", "i4")])
    elements = [
        PlyElement.describe(np.array([(1 / 3,)], [("focal", "f8")]), "camera"),
        PlyElement.describe(vertex, "vertex"),
        PlyElement.describe(face, "face", val_types={"vertex_indices": "i4", "texcoord": "f4"}),
        PlyElement.describe(edge, "edge"),
    ]
    notes = [f"TextureFile {SKIN}", "made by hand"]
    PlyData(elements, text, byte_order, notes, obj_info=["num_cols 7"]).write(path)


def read_ply(path: Path) -> Seen:
    ply = PlyData.read(path, mmap=False)

    def values(*names: str) -> list[Any]:
        return [ply["vertex"][name].tolist() for name in names]

    face = ply["face"]
    faces, wedges = ([one.tolist() for one in face[k]] for k in ("vertex_indices", "texcoord"))
    return {
        "coordinates": np.transpose(values("x", "y", "z")).astype(float),
        "normals": np.transpose(values("nx", "ny", "nz")).astype(float),
        "faces": faces,
        "lines": [*map(len, faces), ply["edge"].data.tolist()],
        "colours": values("red", "green", "blue"),
        "texture": [values("s", "t"), wedges],
        "materials": [ply.comments[0], beside(path)],
        "values": [ply["camera"].data.tolist(), values("age", "label"), face["part"].tolist()],
        "comments": [ply.comments, ply.obj_info],
        "types": [ply.byte_order, [str(one) for element in ply for one in element.properties]],
    }


def write_obj(path: Path) -> None:
    (path.parent / "my maps").mkdir(exist_ok=True)
    (path.parent / "my maps" / SKIN).write_bytes(IMAGE)
    (path.parent / "my paint.mtl").write_text(f"newmtl red paint\nmap_Kd my maps/{SKIN}\n")
    faces = ["f " + " ".join(f"{k + 1}/{k + 1}/{k + 1}" for k in p) for p in POLYGONS]
    numbers = {"v": joined(CUT, RGB / 255), "vn": joined(NORMALS), "vt": joined(UV)}
    lines = [f"{key} {row}" for key, rows in numbers.items() for row in rows]
    lines = ["# made by hand", "mtllib my paint.mtl", "o my part", *lines]
    lines += ["g upper half", "usemtl red paint", "s 1", *faces[:80], "g lower half", *faces[80:]]
    path.write_text("\n".join([*lines, "l 1 21 41", "p 7 # at the rim", ""]))


def read_obj(path: Path) -> Seen:
    lines = [line.split() for line in path.read_text().splitlines()]
    kinds = {"faces": "f", "lines": "f l p", "texture": "vt", "names": "o g s usemtl f"}
    found = {kind: [w for w in lines if w[0] in keys.split()] for kind, keys in kinds.items()}
    vertices, normals = (np.array([w[1:] for w in lines if w[0] == key]) for key in ("v", "vn"))
    return {
        "coordinates": vertices[:, :3].astype(float),
        "normals": normals.astype(float),
        "colours": vertices[:, 3:].tolist(),
        "materials": [[w for w in lines if w[0] in ("mtllib", "usemtl")], beside(path)],
        "comments": [w for w in lines if "#" in w],
        **found,
    }


def write_off(path: Path) -> None:
    counts = f"{len(CUT)} {len(POLYGONS) + 1} 0"
    faces = [f"{len(p)} {' '.join(map(str, p))} 9 8 7" for p in POLYGONS]
    lines = ["STCNOFF", "# made by hand", counts, *joined(CUT, NORMALS, RGB, UV), "2 0 20 # edge"]
    path.write_text("\n".join([*lines, *faces, ""]))


def read_off(path: Path) -> Seen:
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices, faces = np.array(lines[3 : 3 + len(CUT)]), lines[3 + len(CUT) :]
    return {
        "coordinates": vertices[:, :3].astype(float),
        "normals": vertices[:, 3:6].astype(float),
        "faces": [words[: int(words[0]) + 1] for words in faces],
        "lines": [words[0] for words in faces],
        "colours": [vertices[:, 6:9].tolist(), [words[-3:] for words in faces]],
        "texture": vertices[:, 9:].tolist(),
        "comments": [words for words in lines if "#" in words],
    }


FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
TEXT_FACET = "facet normal {}\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n"


def write_stl(path: Path, text: bool) -> None:
    rows = np.zeros(len(ROUND_FACES), FACET)
    rows["corners"], rows["colour"] = ROUND[ROUND_FACES], 2**15 + np.arange(len(rows))
    rows["normal"] = unit(rows["corners"].mean(axis=1))
    if text:
        corners = np.reshape(joined(rows["corners"].reshape(-1, 3)), (-1, 3))
        pairs = zip(joined(rows["normal"]), corners, strict=True)
        body = [TEXT_FACET.format(normal, *three) for normal, three in pairs]
        halves = {"upper half": body[:99], "lower half": body[99:]}
        solids = [f"solid {k}\n{''.join(half)}endsolid {k}\n" for k, half in halves.items()]
        path.write_text("".join(solids))
    else:
        head = b"made by hand".ljust(80) + struct.pack("<I", len(rows))
        path.write_bytes(head + rows.tobytes())


def read_stl(path: Path, text: bool) -> Seen:
    data = path.read_bytes()
    seen: Seen
    if text:
        lines = [line.split() for line in data.decode().splitlines()]
        numbers = ([words[-3:] for words in lines if words[0] == k] for k in ("facet", "vertex"))
        normals, points = (np.array(rows, dtype=float) for rows in numbers)
        seen = {"names": [(k, w) for k, w in enumerate(lines) if w[0].endswith("solid")]}
    else:
        facets = np.frombuffer(data, FACET, offset=84)
        normals, points = facets["normal"], facets["corners"].reshape(-1, 3)
        seen = {"colours": facets["colour"].tolist(), "comments": data[:80]}
    places: dict[tuple[float, ...], int] = {}
    connected = [places.setdefault(tuple(point), len(places)) for point in points.tolist()]
    return {"coordinates": points, "normals": normals, "faces": connected, **seen}


CODES = {"|u1": 5121, "<u4": 5125, "<f4": 5126}  # of types of numbers, in glTF
WIDTHS = ["", "SCALAR", "VEC2", "VEC3", "VEC4"]
ASSET = """{"asset": {"version": "2.0", "copyright": "by hand"}, "scenes": [{"nodes": [0]}],
"nodes": [{"children": [1], "translation": [5, 0, 0], "scale": [2, 2, 2]},
{"mesh": 0, "name": "turned", "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]}],
"meshes": [{"name": "my part", "extras": {"age": 7}, "primitives": [
{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3, "_LABEL": 4},
"indices": 5, "material": 0}, {"attributes": {"POSITION": 0}, "indices": 6, "mode": 3}]}],
"materials": [{"name": "red paint", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
"textures": [{"source": 0}], "images": [{"bufferView": 7, "mimeType": "image/png"}]}"""


def write_gltf(path: Path) -> None:
    """Write a .glb with its image within, or a .gltf with image and numbers in other files."""
    faces, line = (np.reshape(k, (-1, 1)).astype("<u4") for k in (CUT_FACES, LINE))
    rgba, labels = np.column_stack([RGB, RGB[:, 0]]), LABELS[:, None].astype("<f4")
    arrays = [CUT, NORMALS, UV, rgba, labels, faces, line]
    sizes = [*(array.nbytes for array in arrays), len(IMAGE)]
    tree = json.loads(ASSET)
    places = [{"byteOffset": sum(sizes[:k]), "byteLength": sizes[k]} for k in range(8)]
    tree["bufferViews"] = [{"buffer": 0, **place} for place in places]
    tree["accessors"] = [{"bufferView": k, "count": len(a)} for k, a in enumerate(arrays)]
    for accessor, array in zip(tree["accessors"], arrays, strict=True):
        accessor |= {"type": WIDTHS[array.shape[1]], "componentType": CODES[array.dtype.str]}
    tree["accessors"][0] |= {"min": CUT.min(axis=0).tolist(), "max": CUT.max(axis=0).tolist()}
    tree["accessors"][3]["normalized"] = True
    tree["buffers"] = [{"byteLength": sum(sizes)}]
    blob = b"".join(array.tobytes() for array in arrays) + IMAGE
    if path.suffix == ".gltf":
        tree["images"], tree["buffers"][0]["uri"] = [{"uri": "my%20skin.png"}], "my%20data.bin"
        (path.parent / SKIN).write_bytes(IMAGE)
        (path.parent / "my data.bin").write_bytes(blob)
        path.write_text(json.dumps(tree))
    else:
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(blob), len(text), b"JSON")
        path.write_bytes(head + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob)


def read_gltf(path: Path) -> Seen:
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0] if path.suffix == ".glb" else 0
    tree = json.loads(data[20 : 20 + size] or data)
    blob = data[28 + size :] if size else (path.parent / "my data.bin").read_bytes()
    views = [blob[v["byteOffset"] :][: v["byteLength"]] for v in tree["bufferViews"]]
    kinds = {code: kind for kind, code in CODES.items()}
    types = [(one["bufferView"], kinds[one["componentType"]]) for one in tree["accessors"]]
    arrays = [np.frombuffer(views[k], kind) for k, kind in types]
    (mesh,) = tree["meshes"]
    surface, line = mesh["primitives"]
    named = {name: arrays[number] for name, number in surface["attributes"].items()}
    return {
        "coordinates": placed(named["POSITION"].reshape(-1, 3)),
        "normals": named["NORMAL"].reshape(-1, 3),
        "faces": arrays[surface["indices"]].tolist(),
        "lines": [line, arrays[line["indices"]].tolist()],
        "colours": named["COLOR_0"].tolist(),
        "texture": named["TEXCOORD_0"].tolist(),
        "materials": [tree["materials"], tree["images"], views[7], beside(path)],
        "names": [one.get("name") for one in (mesh, *tree["nodes"])],
        "values": named["_LABEL"].tolist(),
        "comments": [tree["asset"], mesh["extras"]],
        "types": [array.dtype.str for array in named.values()],
        "placement": tree["nodes"],
    }


MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="inch" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
 xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" xmlns:s="urn:slicer">
<metadata name="Designer">by hand</metadata><!-- by hand --><resources>
<basematerials id="1"><base name="red paint" displaycolor="#FF0000"/></basematerials>
<m:colorgroup id="2">{colours}</m:colorgroup>
<m:texture2d id="3" path="/3D/my%20skin.png" contenttype="image/png"/>
<m:texture2dgroup id="4" texid="3">{uv}</m:texture2dgroup>
<object id="5" name="my part" pid="1" pindex="0"><mesh><vertices>{vertices}</vertices>
<triangles>{triangles}</triangles><b:beamlattice minlength="0.1" radius="0.1"><b:beams>
<b:beam v1="0" v2="20"/></b:beams></b:beamlattice></mesh></object></resources>
<build><item objectid="5" transform="0 2 0 -2 0 0 0 0 2 5 0 0"/></build></model>"""
RELATIONSHIPS = """<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="a" Target="/3D/3dmodel.model"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"""
TRIANGLE = '<triangle v1="{0}" v2="{1}" v3="{2}" pid="{4}" p1="{0}" s:paint="{3}"/>'


def write_3mf(path: Path) -> None:
    model = MODEL.format(
        colours="".join(f'<m:color color="#{bytes(row).hex()}"/>' for row in RGB),
        uv="".join(f'<m:tex2coord u="{u}" v="{v}"/>' for u, v in UV.tolist()),
        vertices="".join(f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in CUT),
        triangles="".join(TRIANGLE.format(*f, k, 2 + k % 2 * 2) for k, f in enumerate(CUT_FACES)),
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", RELATIONSHIPS)
        archive.writestr("3D/3dmodel.model", model)
        archive.writestr("3D/my%20skin.png", IMAGE)
        archive.writestr("Metadata/settings.config", "layer = 0.2")


def read_3mf(path: Path) -> Seen:
    with zipfile.ZipFile(path) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    text = entries.pop("3D/3dmodel.model").decode()
    tree = ElementTree.fromstring(text)
    elements = [(one.tag.rpartition("}")[2], dict(one.attrib)) for one in tree.iter()]
    kinds = {
        "faces": "triangle",
        "lines": "beamlattice beam",
        "colours": "colorgroup color triangle",
        "texture": "texture2dgroup tex2coord triangle",
        "names": "object base",
        "values": "triangle",  # what a slicer has painted
        "placement": "model item",
    }
    found = {kind: [e for e in elements if e[0] in names.split()] for kind, names in kinds.items()}
    vertices = [[float(e[axis]) for axis in "xyz"] for name, e in elements if name == "vertex"]
    materials = [e for e in elements if e[0] in ("basematerials", "base", "texture2d", "object")]
    return {
        "coordinates": placed(np.array(vertices)),
        "materials": [materials, entries["3D/my%20skin.png"]],
        "comments": [text.partition("<resources>")[0], entries["Metadata/settings.config"]],
        **found,
    }


def write_vtk(path: Path, text: bool = False) -> None:
    faces = [number for polygon in POLYGONS for number in (len(polygon), *polygon)]
    mesh = pyvista.PolyData(CUT, faces=faces, lines=[len(LINE), *LINE], verts=[1, 7])
    mesh.point_data["age"], mesh.point_data["rgb"] = AGE, RGB
    mesh.point_data.active_normals = NORMALS
    mesh.point_data.active_texture_coordinates = UV
    mesh.cell_data["part"] = np.arange(mesh.n_cells, dtype="i2")
    mesh.field_data["maker"] = ["by hand"]
    mesh.save(path, binary=not text)


def read_vtk(path: Path) -> Seen:
    mesh = pyvista.read(path)
    points, cells = mesh.point_data, mesh.cell_data
    return {
        "coordinates": np.array(mesh.points, dtype=float),
        "normals": np.array(points.active_normals),
        "faces": mesh.faces.tolist(),
        "lines": [mesh.lines.tolist(), mesh.verts.tolist()],
        "colours": points["rgb"].tolist(),
        "texture": points.active_texture_coordinates.tolist(),
        "values": [points["age"].tolist(), cells["part"].tolist()],
        "comments": [list(mesh.field_data["maker"]), path.read_bytes().splitlines()[:2]],
        "types": [str(one.dtype) for one in (mesh.points, *points.values(), *cells.values())],
    }


def write_gifti(path: Path) -> None:
    n = len(ROUND)
    arrays = {"POINTSET": ROUND, "TRIANGLE": ROUND_FACES, "VECTOR": unit(ROUND)}
    arrays |= {"LABEL": LABELS[:n], "SHAPE": AGE[:n].astype("f4")}
    arrays["RGB_VECTOR"] = (RGB[:n] / 255).astype("f4")
    image = gifti.GiftiImage(meta=gifti.GiftiMetaData({"Subject": "made by hand"}))
    for intent, array in arrays.items():
        system = gifti.GiftiCoordSystem(1, 3, np.diag([2.0, 2, 2, 1]))
        meta, intent = gifti.GiftiMetaData({"Name": f"my {intent}"}), f"NIFTI_INTENT_{intent}"
        data = gifti.GiftiDataArray(array, intent, coordsys=system, meta=meta)
        image.add_gifti_data_array(data)
    label = gifti.GiftiLabel(key=1, red=1.0)
    label.label = "V1"
    image.labeltable.labels.append(label)
    image.to_filename(path)


def read_gifti(path: Path) -> Seen:
    image = nibabel.load(path)
    points, faces, normals, *values, colours = (array.data for array in image.darrays)
    systems = [array.coordsys for array in image.darrays if array.coordsys]
    return {
        "coordinates": np.array(points, dtype=float),
        "normals": normals,
        "faces": faces.tolist(),
        "colours": [colours.tolist(), [label.rgba for label in image.labeltable.labels]],
        "names": image.labeltable.get_labels_as_dict(),
        "values": [array.tolist() for array in values],
        "comments": [dict(image.meta), [dict(array.meta) for array in image.darrays]],
        "types": [(array.datatype, array.encoding, array.endian) for array in image.darrays],
        "placement": [(s.dataspace, s.xformspace, s.xform.tolist()) for s in systems],
    }


def write_freesurfer(path: Path) -> None:
    info: dict[str, Any] = {"head": [2, 0, 20], "valid": "1", "filename": "x.mgz"}
    info |= {"volume": [9, 9, 9], "voxelsize": [1, 1, 1], "xras": [1, 0, 0], "yras": [0, 1, 0]}
    info |= {"zras": [0, 0, 1], "cras": [5, 0, 0]}
    nibabel.freesurfer.write_geometry(path, ROUND, ROUND_FACES, "made by hand", info)


def read_freesurfer(path: Path) -> Seen:
    points, faces, info, stamp = nibabel.freesurfer.read_geometry(path, True, True)
    geometry = {key: np.array(value).tolist() for key, value in info.items()}
    seen = {"faces": faces.tolist(), "comments": stamp, "placement": geometry}
    return {"coordinates": points, **seen}


def write_usd(path: Path) -> None:
    """Write a text, or a package of it with its image; the mesh is left-handed."""
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdUtils, Vt

    folder = path.parent / "packed" if path.suffix == ".usdz" else path.parent
    folder.mkdir(exist_ok=True)
    scene = folder / path.with_suffix(".usda").name
    (folder / SKIN).write_bytes(IMAGE)
    stage = Usd.Stage.CreateNew(str(scene))
    stage.SetMetadata("comment", "made by hand")
    UsdGeom.SetStageMetersPerUnit(stage, 0.0254)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    turned = UsdGeom.Xform.Define(stage, "/turned")
    stage.SetDefaultPrim(turned.GetPrim())
    matrix = np.vstack([placed(np.eye(4, 3)) - [5, 0, 0], [5, 0, 0]])[[0, 1, 2, 4]]
    turned.AddTransformOp().Set(Gf.Matrix4d(np.column_stack([matrix, [0, 0, 0, 1]]).tolist()))
    mesh = UsdGeom.Mesh.Define(stage, "/turned/my_part")
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(CUT))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    mesh.CreateFaceVertexCountsAttr([len(p) for p in POLYGONS])
    mesh.CreateFaceVertexIndicesAttr([k for p in POLYGONS for k in reversed(p)])
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(NORMALS))
    api, types = UsdGeom.PrimvarsAPI(mesh), Sdf.ValueTypeNames
    for name, kind, numbers in (
        ("st", types.TexCoord2fArray, Vt.Vec2fArray.FromNumpy(UV)),
        ("displayColor", types.Color3fArray, Vt.Vec3fArray.FromNumpy((RGB / 255).astype("f4"))),
        ("age", types.DoubleArray, AGE),
    ):
        api.CreatePrimvar(name, kind, UsdGeom.Tokens.vertex).Set(numbers)
    paint = UsdShade.Material.Define(stage, "/turned/red_paint")
    texture = UsdShade.Shader.Define(stage, "/turned/red_paint/skin")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", types.Asset).Set(SKIN)
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(paint)
    stage.GetRootLayer().Save()
    if path != scene:
        UsdUtils.CreateNewUsdzPackage(str(scene), str(path))
        shutil.rmtree(folder)


def read_usd(path: Path) -> Seen:
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/turned/my_part"))
    api = UsdGeom.PrimvarsAPI(mesh)
    values = {name: np.array(api.GetPrimvar(name).Get()) for name in ("st", "displayColor", "age")}
    points = np.array(mesh.GetPointsAttr().Get(), dtype=float)
    extent = np.array([points.min(axis=0), points.max(axis=0)], dtype="f4")
    np.testing.assert_array_equal(mesh.GetExtentAttr().Get(), extent)
    images: object = beside(path)
    if path.suffix == ".usdz":
        with zipfile.ZipFile(path) as archive:
            images = [(one.filename, one.CRC) for one in archive.infolist()[1:]]
    paint = stage.GetPrimAtPath("/turned/red_paint/skin")
    sizes, corners = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()
    place = UsdGeom.Xformable(stage.GetPrimAtPath("/turned")).GetLocalTransformation()
    units = UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)
    return {
        "coordinates": placed(points),
        "normals": np.array(mesh.GetNormalsAttr().Get()),
        "faces": [list(sizes), list(corners), mesh.GetOrientationAttr().Get()],
        "lines": list(sizes),
        "colours": values["displayColor"].tolist(),
        "texture": values["st"].tolist(),
        "materials": [paint.GetAttribute("inputs:file").Get().path, images],
        "names": [str(prim.GetPath()) for prim in stage.Traverse()],
        "values": values["age"].tolist(),
        "comments": stage.GetMetadata("comment"),
        "types": [str(one.GetTypeName()) for one in mesh.GetPrim().GetAttributes()],
        "placement": [units, [list(row) for row in place]],
    }


PLY = [partial(write_ply, text=order == "=", byte_order=order) for order in "=<>"]
STL = [(partial(write_stl, text=text), partial(read_stl, text=text)) for text in (True, False)]
SAMPLES = [
    *(Sample("PLY", "in.ply", write, read_ply) for write in PLY),
    Sample("OBJ", "in.obj", write_obj, read_obj),
    Sample("OFF", "in.off", write_off, read_off),
    *(Sample("STL", "in.stl", write, read) for write, read in STL),
    Sample("glTF, GLB", "in.glb", write_gltf, read_gltf),
    Sample("glTF, GLB", "in.gltf", write_gltf, read_gltf),
    Sample("3MF", "in.3mf", write_3mf, read_3mf),
    Sample("VTK, VTP", "in.vtk", write_vtk, read_vtk),
    Sample("VTK, VTP", "text.vtk", partial(write_vtk, text=True), read_vtk),
    Sample("VTK, VTP", "in.vtp", write_vtk, read_vtk),
    Sample("GIFTI", "in.surf.gii", write_gifti, read_gifti),
    Sample("GIFTI", "in.surf.gii.gz", write_gifti, read_gifti),
    Sample("FreeSurfer", "lh.pial", write_freesurfer, read_freesurfer),
]
if find_spec("pxr"):  # of USD, which not every system has
    SAMPLES += [Sample("USD", name, write_usd, read_usd) for name in ("in.usda", "in.usdz")]
