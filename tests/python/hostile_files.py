"""Files as a stranger may send them, each of one kind, made to size by a seed.

They name files elsewhere, grow when they are read, or take time out of all proportion. None is
dangerous by itself: at the sizes that the tests ask for, a reader that obeys takes a second or some
100 MB more than one that does not.
"""

from __future__ import annotations

import base64
import gzip
import json
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Rng = np.random.Generator
Writer = Callable[[Path, int, Rng], None]

TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
SIDES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
SECRET = "for nobody's eyes"  # in what is named, and must not be read
CONTROL = "\x1b[31mred\x1b]0;title\x07\r\n\u202e"

# Kind -> extension, and what writes it to a path, of about so many bytes.
KINDS: dict[str, tuple[str, Writer]] = {}


def _kind(name: str, *endings: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    def decorate(write: Callable[..., None]) -> Callable[..., None]:
        for ending in endings:
            KINDS[f"{name}.{ending}"] = (ending, write)
        return write

    return decorate


def write_hostile(name: str, folder: Path, size: int, seed: int) -> Path:
    """Write a file of a kind, with what it names beside it; return its path."""
    ending, write = KINDS[name]
    path = folder / f"{name.split('.')[0].replace(' ', '_')}.{ending}"
    write(path, size, np.random.default_rng(seed))
    return path


# --- files that name others


def outside(path: Path, rng: Rng, content: bytes = b"") -> str:
    """Return a name that leads out of the folder of a file, to one with a secret or to a device."""
    secret = path.parent.parent / "secret.bin"
    secret.write_bytes(content or np.zeros(300, "<f4").tobytes() + SECRET.encode())
    link = path.parent / "link.bin"
    link.unlink(missing_ok=True)
    kind = rng.integers(5)
    if kind < 2:
        link.symlink_to("/dev/zero" if kind else secret)
        return link.name
    return [f"../{secret.name}", str(secret), "/dev/zero"][kind - 2]


def gltf(buffer: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A tetrahedron whose numbers are in a buffer: positions, and indices as bytes."""
    views = [(0, 48), (48, 12)]
    return {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 60, **buffer}],
        "bufferViews": [{"buffer": 0, "byteOffset": a, "byteLength": b} for a, b in views],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        **more,
    }


BLOB = np.array(TETRAHEDRON, "<f4").tobytes() + np.array(SIDES, "u1").tobytes()
INLINE = {"uri": "data:;base64," + base64.b64encode(BLOB).decode()}


@_kind("buffer outside", "gltf")
def _buffer_outside(path: Path, size: int, rng: Rng) -> None:
    path.write_text(json.dumps(gltf({"uri": outside(path, rng, BLOB)})))


@_kind("image outside", "gltf")
def _image_outside(path: Path, size: int, rng: Rng) -> None:
    path.write_text(json.dumps(gltf(INLINE, images=[{"uri": outside(path, rng)}])))


@_kind("texture outside", "ply")
def _texture_outside(path: Path, size: int, rng: Rng) -> None:
    path.write_bytes(ply(f"comment TextureFile {outside(path, rng)}\n"))


def ply(header: str = "", vertices: int = 4, body: str = "") -> bytes:
    rows = [" ".join(map(str, row)) for row in (*TETRAHEDRON, *((3, *side) for side in SIDES))]
    return (
        f"ply\nformat ascii 1.0\n{header}element vertex {vertices}\nproperty float x\n"
        "property float y\nproperty float z\nelement face 4\n"
        "property list uchar int vertex_indices\nend_header\n" + (body or "\n".join(rows)) + "\n"
    ).encode()


USD = (
    f'#usda 1.0\ndef Mesh "m" {{ point3f[] points = {TETRAHEDRON}\n'
    f"int[] faceVertexCounts = {[3] * 4}\n"
    f"int[] faceVertexIndices = {[k for side in SIDES for k in side]}\n}}\n"
)
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRAHEDRON) + "".join(
    f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in SIDES
)


@_kind("library outside", "obj")
def _library_outside(path: Path, size: int, rng: Rng) -> None:
    path.write_text(f"mtllib {outside(path, rng, b'newmtl a' + bytes([10]))}\n{OBJ}")


@_kind("map outside", "obj")
def _map_outside(path: Path, size: int, rng: Rng) -> None:
    path.with_name("near.mtl").write_text(f"newmtl a\nmap_Kd {outside(path, rng)}\n")
    path.write_text(f"mtllib near.mtl\n{OBJ}")


@_kind("many libraries", "obj")
def _many_libraries(path: Path, size: int, rng: Rng) -> None:
    path.with_name("many.mtl").write_text("newmtl a\nmap_Kd no.png\n" * (size // 20))
    path.write_text("mtllib many.mtl\n" * (size // 16) + OBJ)


def gifti(*arrays: str) -> str:
    return f'<?xml version="1.0"?><GIFTI Version="1.0">{"".join(arrays)}</GIFTI>'


def array(data: np.ndarray[Any, Any], intent: str, encoding: str = "", **more: object) -> str:
    """An array of GIFTI: packed, unless attributes and text say otherwise."""
    text = more.pop("text", base64.b64encode(zlib.compress(data.tobytes())).decode())
    kind = {"f": "FLOAT32", "i": "INT32"}[data.dtype.kind]
    given = {
        "Intent": f"NIFTI_INTENT_{intent}",
        "DataType": f"NIFTI_TYPE_{kind}",
        "ArrayIndexingOrder": "RowMajorOrder",
        "Dimensionality": data.ndim,
        **{f"Dim{k}": length for k, length in enumerate(data.shape)},
        "Encoding": encoding or "GZipBase64Binary",
        "Endian": "LittleEndian",
        **more,
    }
    words = " ".join(f'{key}="{value}"' for key, value in given.items())
    return f"<DataArray {words}><Data>{text}</Data></DataArray>"


POINTS = array(np.array(TETRAHEDRON, "<f4"), "POINTSET")
TRIANGLES = array(np.array(SIDES, "<i4"), "TRIANGLE")


@_kind("array outside", "surf.gii")
def _array_outside(path: Path, size: int, rng: Rng) -> None:
    name = outside(path, rng, BLOB)
    points = array(
        np.array(TETRAHEDRON, "<f4"),
        "POINTSET",
        "ExternalFileBinary",
        text="",
        ExternalFileName=name,
        ExternalFileOffset=0,
    )
    path.write_text(gifti(points, TRIANGLES))


@_kind("scene outside", "x3d")
def _scene_outside(path: Path, size: int, rng: Rng) -> None:
    other = path.parent.parent / "secret.x3d"
    path.with_name("unused.txt").write_text("")
    shape = (
        '<Shape><IndexedFaceSet coordIndex="0 2 1 -1 0 1 3 -1 0 3 2 -1 1 2 3 -1">'
        '<Coordinate point="0 0 0 1 0 0 0 1 0 0 0 1"/></IndexedFaceSet></Shape>'
    )
    other.write_text(f"<X3D><Scene>{shape}</Scene></X3D>")
    inline = f"""<Inline url='"../{other.name}"'/>"""
    path.write_text(f"<X3D><Scene>{shape if rng.integers(2) else ''}{inline}</Scene></X3D>")


@_kind("image outside", "usda")
def _image_of_usd_outside(path: Path, size: int, rng: Rng) -> None:
    paint = f'def Shader "a" {{ asset inputs:file = @{outside(path, rng)}@\n}}\n'
    path.write_text(USD + paint)


@_kind("composed", "usda", "usdz")
def _composed(path: Path, size: int, rng: Rng) -> None:
    """A scene that has what it shows in another file, in one of the ways to say so."""
    other = path.parent.parent / "secret.usda"
    other.write_text(USD)
    name = ["../secret.usda", str(other), "/dev/zero"][rng.integers(3)]
    head, clips = (
        "#usda 1.0\n",
        "dictionary clips = {{ dictionary a = {{ asset[] assetPaths = [@{0}@] }} }}",
    )
    ways = [
        'def "a" (references = @{0}@) {{}}',
        'def "a" (payload = @{0}@) {{}}',
        f'def "a" ({clips}) {{{{}}}}',
    ]
    text = head + ways[rng.integers(3)].format(name)
    if rng.integers(4) == 0:
        text = f"{head}(subLayers = [@{name}@])"
    if path.suffix == ".usda":
        path.write_text(text)
    else:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("a.usda", text)
            archive.writestr("../b.usda", USD)


# --- files that grow


RELATIONSHIPS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="a" Target="/3D/3dmodel.model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MESH = (
    "<mesh><vertices>"
    + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in TETRAHEDRON)
    + "</vertices><triangles>"
    + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in SIDES)
    + "</triangles></mesh>"
)
TETRAHEDRON_OBJECT = f'<object id="1" type="model">{MESH}</object>'


def three_mf(
    path: Path, objects: str, tail: str = "", packed: int = zipfile.ZIP_DEFLATED, item: int = 1
) -> None:
    model = (
        f'<?xml version="1.0" encoding="UTF-8"?><model xmlns="{CORE}"><resources>{objects}'
        f'</resources><build><item objectid="{item}"/></build></model>{tail}'
    )
    with zipfile.ZipFile(path, "w", packed) as archive:
        archive.writestr("_rels/.rels", RELATIONSHIPS)
        archive.writestr("3D/3dmodel.model", model)


@_kind("blanks", "usdz")
def _blanks_of_usd(path: Path, size: int, rng: Rng) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.usda", USD + " " * (1000 * size))


@_kind("blanks", "3mf")
def _blanks(path: Path, size: int, rng: Rng) -> None:
    three_mf(path, TETRAHEDRON_OBJECT, " " * (1000 * size))


@_kind("empty elements", "3mf")
def _empty_elements(path: Path, size: int, rng: Rng) -> None:
    three_mf(path, TETRAHEDRON_OBJECT.replace("</vertices>", "<vertex/>" * (50 * size)))


@_kind("wrong size", "3mf")
def _wrong_size(path: Path, size: int, rng: Rng) -> None:
    """An entry that unpacks to a thousand times what its head says."""
    packed = [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA][rng.integers(3)]
    tail = " " * (1000 * size)
    three_mf(path, TETRAHEDRON_OBJECT, tail, packed)
    data = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as archive:
        (whole,) = [one.file_size for one in archive.infolist() if one.filename.endswith("model")]
    for place in range(len(data) - 4):
        if data[place : place + 4] == struct.pack("<I", whole):
            data[place : place + 4] = struct.pack("<I", whole - len(tail))
    path.write_bytes(data)


@_kind("claimed rows", "3mf")
def _claimed_rows(path: Path, size: int, rng: Rng) -> None:
    claimed = '<vertex begin="0" end="4"></vertex>' * size
    three_mf(path, TETRAHEDRON_OBJECT.replace("</vertices>", f"{claimed}</vertices>"))


@_kind("no indices", "gltf")
def _no_indices(path: Path, size: int, rng: Rng) -> None:
    asset = gltf(INLINE)
    count = 20 * size
    del asset["accessors"][0]["bufferView"]
    asset["accessors"][0]["count"] = count - count % 3
    asset["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}}] * (size // 40 + 1)}]
    path.write_text(json.dumps(asset))


@_kind("many meshes", "gltf")
def _many_meshes(path: Path, size: int, rng: Rng) -> None:
    asset = gltf(INLINE)
    asset["meshes"] *= size // 2000 + 1
    path.write_text(json.dumps(asset))


@_kind("zeros", "surf.gii", "surf.gii.gz")
def _zeros(path: Path, size: int, rng: Rng) -> None:
    """Either more than the dimensions say, or all that they say."""
    zeros = np.zeros((250 * size // 3, 3), "<f4")
    points = array(zeros, "POINTSET", Dim0=4 if rng.integers(2) else len(zeros))
    path.write_text(gifti(points, TRIANGLES))
    if path.suffix == ".gz":
        text = gifti(POINTS, TRIANGLES) + " " * (1000 * size)
        path.write_bytes(gzip.compress(text.encode()))


@_kind("dimensions", "surf.gii")
def _dimensions(path: Path, size: int, rng: Rng) -> None:
    path.write_text(
        gifti(
            array(np.array(TETRAHEDRON, "<f4"), "POINTSET", Dimensionality=2_000 * size), TRIANGLES
        )
    )


@_kind("many arrays", "surf.gii")
def _many_arrays(path: Path, size: int, rng: Rng) -> None:
    path.write_text(gifti(POINTS, TRIANGLES, "<DataArray></DataArray>" * (size // 24)))


@_kind("entities", "surf.gii")
def _entities(path: Path, size: int, rng: Rng) -> None:
    names = [f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(7)]
    head = f'<!DOCTYPE GIFTI [<!ENTITY e0 "{"a" * 100}">{"".join(names)}]>'
    text = gifti(
        "<MetaData><MD><Name>a</Name><Value>&e7;</Value></MD></MetaData>", POINTS, TRIANGLES
    )
    path.write_text(text.replace("?>", "?>" + head))


@_kind("counts", "vtp", "vtu")
def _counts(path: Path, size: int, rng: Rng) -> None:
    kind = {".vtp": "PolyData", ".vtu": "UnstructuredGrid"}[path.suffix]
    quote, word = ("'", '"')[rng.integers(2)], ["NumberOfPoints", "NumberOfPolys"][rng.integers(2)]
    path.write_text(
        f'<?xml version="1.0"?><VTKFile type="{kind}" version="0.1" byte_order="LittleEndian">'
        f"<{kind}><Piece {word} = {quote}{1000 * size}{quote}><Points>"
        '<DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0'
        f"</DataArray></Points></Piece></{kind}></VTKFile>"
    )


@_kind("counts", "vtk")
def _legacy_counts(path: Path, size: int, rng: Rng) -> None:
    many = 1000 * size
    tail = [
        f"POINT_DATA {many}\nSCALARS a float 1\nLOOKUP_TABLE default\n1 2 3",
        f"POINT_DATA 4\nSCALARS a\nfloat {many}\nLOOKUP_TABLE default\n1 2 3",
        f"POINT_DATA 4\nFIELD f 1\nname {many // 4} 4 float\n1 2 3",
        f"FIELD f {many}\nname 1 1 float\n1",
        f"POINT_DATA 4\nSCALARS a float 1\nLOOKUP_TABLE b\n1 2 3 4\nLOOKUP_TABLE b {many}\n1 1 1 1",
        f"LINES {many} {3 * many}\n2 0 1",
    ][rng.integers(6)]
    points = "\n".join(" ".join(map(str, row)) for row in TETRAHEDRON)
    sides = "\n".join("3 " + " ".join(map(str, row)) for row in SIDES)
    path.write_text(
        "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\n"
        f"POINTS 4 float\n{points}\nPOLYGONS 4 16\n{sides}\n{tail}\n"
    )


@_kind("packed zeros", "vtp")
def _packed_zeros(path: Path, size: int, rng: Rng) -> None:
    count = 80 * size
    block = zlib.compress(bytes(12 * count))
    head = struct.pack("<4I", 1, 12 * count, 0, len(block))
    text = base64.b64encode(head).decode() + base64.b64encode(block).decode()
    path.write_text(
        '<?xml version="1.0"?><VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" '
        'compressor="vtkZLibDataCompressor"><PolyData>'
        f'<Piece NumberOfPoints="{count}" NumberOfPolys="0"><Points><DataArray type="Float32" '
        f'NumberOfComponents="3" format="binary">{text}</DataArray></Points></Piece></PolyData>'
        "</VTKFile>"
    )


@_kind("words", "ply")
def _words(path: Path, size: int, rng: Rng) -> None:
    """A mesh whose words are all in one line."""
    count = size // 6
    faces = "3 0 1 2 3 0 1 3 3 0 2 3 3 1 2 3"
    path.write_bytes(ply(vertices=count, body="1 " * 3 * count + faces))


@_kind("empty lists", "ply")
def _empty_lists(path: Path, size: int, rng: Rng) -> None:
    head = ply().partition(b"end_header\n")[0].replace(b"ascii", b"binary_little_endian")
    head = head.replace(b"face 4", f"face {size}".encode()) + b"end_header\n"
    path.write_bytes(head + np.array(TETRAHEDRON, "<f4").tobytes() + bytes(size))


# --- files that take long


@_kind("blanks", "ply")
def _comment_of_blanks(path: Path, size: int, rng: Rng) -> None:
    path.write_bytes(ply(f"comment TextureFile{' ' * size}\n"))


@_kind("elements", "ply")
def _elements(path: Path, size: int, rng: Rng) -> None:
    names = ["element vertex 0\n", "element e{} 0\n", "property float p{}\n", "comment {}\n"]
    line = names[rng.integers(len(names))]
    path.write_bytes(ply("".join(line.format(k) for k in range(size // len(line)))))


@_kind("elements without end", "ply")
def _elements_without_end(path: Path, size: int, rng: Rng) -> None:
    path.write_text("ply\nformat ascii 1.0\n" + "element vertex 1\n" * (size // 17))


@_kind("comments", "off")
def _comments(path: Path, size: int, rng: Rng) -> None:
    path.write_text("# " * size + "\n" * size + "OOF\n4 4 0\n")


@_kind("newlines", "obj")
def _newlines(path: Path, size: int, rng: Rng) -> None:
    path.write_text(OBJ + "\n" * size + " # " + "\r" * size)


@_kind("nested objects", "3mf")
def _nested_objects(path: Path, size: int, rng: Rng) -> None:
    depth = size // 40
    nested = "".join(f'<object id="{k}">' for k in range(2, depth + 2)) + "</object>" * depth
    three_mf(path, TETRAHEDRON_OBJECT + nested, packed=zipfile.ZIP_STORED)


@_kind("doubled components", "3mf")
def _doubled_components(path: Path, size: int, rng: Rng) -> None:
    depth = size // 140 + 2
    doubled = "".join(
        f'<object id="{k}"><components><component objectid="{k - 1}"/>'
        f'<component objectid="{k - 1}" transform="1 0 0 0 1 0 0 0 1 {k} 0 0"/></components>'
        "</object>"
        for k in range(2, depth)
    )
    three_mf(path, TETRAHEDRON_OBJECT + doubled, packed=zipfile.ZIP_STORED, item=depth - 1)


@_kind("many objects", "3mf")
def _many_objects(path: Path, size: int, rng: Rng) -> None:
    one = TETRAHEDRON_OBJECT.replace('id="1"', 'id="{}"')
    count = size // (4 * len(one)) + 1
    objects = "".join(one.format(k + 1) for k in range(count))
    three_mf(path, objects, packed=zipfile.ZIP_STORED)


def star(size: int, rng: Rng) -> np.ndarray[Any, Any]:
    """The corners of a polygon that no fan divides: a star, or one that crosses itself."""
    angles = np.arange(size) * 2 * np.pi / size
    if rng.integers(2):
        return rng.uniform(size=(size, 2))
    radii = np.where(np.arange(size) % 2, 1.0, 0.5)
    return radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


@_kind("star", "obj", "off")
def _star(path: Path, size: int, rng: Rng) -> None:
    corners = star(max(5, size // 25), rng)
    rows = [f"{x:.6g} {y:.6g} 0" for x, y in corners.tolist()]
    if path.suffix == ".off":
        face = f"{len(rows)} {' '.join(map(str, range(len(rows))))}"
        path.write_text("\n".join([f"OFF\n{len(rows)} 1 0", *rows, face, ""]))
    else:
        face = f"f {' '.join(map(str, range(1, len(rows) + 1)))}"
        path.write_text("\n".join([*(f"v {row}" for row in rows), face, ""]))


@_kind("nesting", "gltf", "surf.gii", "3mf", "vtp")
def _nesting(path: Path, size: int, rng: Rng) -> None:
    depth = size // 8
    tags = "<a>" * depth + "</a>" * depth
    if path.suffix == ".gltf":
        path.write_text(
            json.dumps(gltf(INLINE))[:-1] + ', "extras": ' + "[" * size + "]" * size + "}"
        )
    elif path.suffix == ".3mf":
        three_mf(path, TETRAHEDRON_OBJECT + tags)
    elif path.suffix == ".vtp":
        path.write_text(
            f'<VTKFile type="PolyData" version="0.1"><PolyData>{tags}</PolyData></VTKFile>'
        )
    else:
        path.write_text(gifti(POINTS, TRIANGLES, f"<MetaData>{tags}</MetaData>"))


@_kind("tags", "dae", "x3d", "wrl")
def _tags(path: Path, size: int, rng: Rng) -> None:
    """Nodes without an end, in the folder of a large file that has nothing to do with them."""
    with path.with_name("beside.raw").open("wb") as file:
        file.truncate(1 << 33)  # without a block on the disk
    heads = {
        ".dae": ("<COLLADA>", "<node "),
        ".x3d": ("<X3D><Scene>", "<node "),
        ".wrl": ("#VRML V2.0 utf8\n", ["Group { children [ ", "Shape { "][rng.integers(2)]),
    }
    head, node = heads[path.suffix]
    path.write_text(head + node * (size // len(node)))


# --- names


def bad_name(size: int, rng: Rng) -> str:
    return CONTROL + "long" * (size // 4 if rng.integers(2) else 1)


@_kind("names", "gltf")
def _names(path: Path, size: int, rng: Rng) -> None:
    name = bad_name(size, rng)
    asset = gltf(INLINE, images=[{"uri": name}])
    asset["meshes"] = [{**asset["meshes"][0], "name": f"{name}{k}"} for k in range(2)]
    asset["nodes"] = [{"mesh": k, "translation": [5 * k, 0, 0]} for k in range(2)]
    path.write_text(json.dumps(asset))


@_kind("names", "3mf")
def _names_of_objects(path: Path, size: int, rng: Rng) -> None:
    name = bad_name(size, rng).translate({27: "E", 7: "G", 13: " ", 10: " "})
    one = TETRAHEDRON_OBJECT.replace('id="1"', 'id="{0}" name="' + name + '{0}"')
    item = '<item objectid="2"/>'
    three_mf(path, one.format(1) + one.format(2) + f"</resources><build>{item}</build><resources>")


@_kind("names", "ply")
def _names_of_properties(path: Path, size: int, rng: Rng) -> None:
    name = "a\x1b[31m" + "b" * (size if rng.integers(2) else 1)
    path.write_bytes(ply(f"element {name} 0\nproperty float {name}\ncomment TextureFile {name}\n"))


@_kind("names", "obj")
def _names_of_libraries(path: Path, size: int, rng: Rng) -> None:
    path.write_text(f"mtllib a\x1b[31m{'b' * (size if rng.integers(2) else 1)}.mtl\n{OBJ}")
