"""Mesh files as MeshLab reads and writes them."""

from __future__ import annotations

import html
import locale
import os
import re
import shutil
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from meshlab_spectral.errors import FormatError, MeshFileError
from meshlab_spectral.files.extensions import WRITABLE
from meshlab_spectral.files.whole_files import USUAL_FORMATS, resolved
from meshlab_spectral.formats.budget import Budget, guarded
from meshlab_spectral.formats.causes import other_kind
from meshlab_spectral.formats.digits import in_single_precision, precision_warnings
from meshlab_spectral.formats.document import Array, Document
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.opening import PATCHED
from meshlab_spectral.formats.side_files import beside, is_outside
from meshlab_spectral.formats.stl import HEADER, TRIANGLE
from meshlab_spectral.plugin.mesh_sets import reason_of
from meshlab_spectral.warned import Warned

# Formats in which MeshLab joins triangles back into the polygons that it has read.
_POLYGON_FORMATS = (".obj", ".off")
# The `contents` of a document that MeshLab, having read it, also writes, by format.
_WRITTEN = {
    ".ply": {"face colours", "texture coordinates", "quality", "texture names"},
    ".obj": {"texture coordinates", "materials", "texture names"},
    ".off": {"face colours", "texture coordinates"},
}
# Contents that MeshLab would invent, or write as readers do not expect: the setting, and the
# formats that have it.
_SETTINGS = {
    "normals": ("save_vertex_normal", "dae e57 idtf json nxs nxz obj ply x3d xyz"),
    "colours": ("save_vertex_color", "ctm dae e57 idtf json nxs nxz obj off ply wrl x3d"),
    "face colours": ("save_face_color", "stl"),
}
_OTHER_SETTINGS = {
    ".ctm": {"lossless": True},
    ".off": {"save_vertex_normal": False},  # only MeshLab reads NOFF with normals after colours
}
# What scenes as text hold besides a shape, such as COLLADA, X3D and VRML.
_SCENES = {
    "units": re.compile(rb"<unit\b|<UNIT\b"),
    "transforms": re.compile(
        rb"<(?:matrix|rotate|translate|scale|skew|Transform)\b|\bTransform\s*\{"
    ),
    "lights": re.compile(rb"<light\b|(?:Point|Spot|Directional)Light\b"),
    "cameras": re.compile(rb"<camera\b|\bViewpoint\b"),
    "materials": re.compile(rb"<material\b|<Material\b|\bMaterial\s*\{"),
    "animations": re.compile(rb"<animation\b|Interpolator\b"),
    "skeletons": re.compile(rb"<controller\b|HAnim"),
    "names": re.compile(rb"<(?:geometry|node)\b[^<>]*\bname=|\bDEF\b"),
}
# Scenes that take in others, the elements that do so, and addresses, which MeshLab does not fetch.
_TAKING_IN = (".x3d", ".x3dv", ".wrl")
_INLINED = re.compile(r"\b(?:Inline|ExternProtoDeclare|EXTERNPROTO)\b[^>}]*")
_QUOTED = re.compile(r"[\"'\s]([^\"'\s\0]+)[\"']")
_REMOTE = re.compile("https?:|urn:|#", re.IGNORECASE)
# What MeshLab may take: bytes, of which a texture 4,096 pixels wide takes 64 MiB; and of the memory
# there is.
_MESHLAB_BYTES, _SHARE = 1 << 30, 0.75
# Ends of the names of files that a mesh file takes in; what is before a name; and bytes of it.
_NAMED = re.compile(
    rb"\.(?:png|jpe?g|tga|bmp|gif|tiff?|dds|webp|mtl|bin|x3dv?|wrl)\b", re.IGNORECASE
)
_BEFORE_NAME = re.compile(r"[\"'<>\r\n\0]")
_LONGEST_NAME = 255
_LONGEST = 300  # characters of its reasons
_STL_HEADER = 80  # bytes
_QUALITY = "spectral_quality"  # a passing attribute
_LEAST_ROOM = 1 << 14  # bytes, a few blocks
# MeshLab's substitute for textures not found, such as those with blanks in their names.
DUMMY = "dummy.png"


def check_writable(path: Path) -> None:
    """Raise FormatError, before a long computation, unless MeshLab can write `path`."""
    ending = path.suffix
    if ending[1:].lower() in WRITABLE:
        return
    if ending[1:].lower() in PATCHED:
        raise FormatError(
            f"{path.name} can be written only when the input ends in {ending}, too: choose "
            f"{USUAL_FORMATS}"
        )
    reason = f"ends in {ending}" if ending else "has no extension"
    raise FormatError(f"{path.name} {reason}, which MeshLab cannot write: choose {USUAL_FORMATS}")


def read_with_meshlab(mesh_set: Any, source: Path) -> None:
    """Load the one mesh of a file into a MeshSet; raises MeshFileError or MemoryLimitError."""
    import pymeshlab

    _check_inlined(source)
    named = named_files(source)
    for library in [Path(name) for name in named if name.lower().endswith(".mtl")]:
        named |= named_files(library)
    budget = Budget(source, source.stat().st_size, _MESHLAB_BYTES, _SHARE)
    budget.extend(sum(map(os.path.getsize, named)))
    try:
        with guarded(budget):
            mesh_set.load_new_mesh(str(source))
    except (pymeshlab.PyMeshLabException, RuntimeError) as error:  # some plugins raise their own
        foreign = other_kind(source)
        if foreign is not None:
            raise foreign from error
        reason = shown(reason_of(error), _LONGEST)
        if reason.startswith("Unknown format"):
            raise MeshFileError(
                f"{source} ends in {source.suffix or 'nothing'}, which MeshLab cannot read as a "
                f"mesh: convert it to {USUAL_FORMATS}",
                "unknown_format",
            ) from error
        raise MeshFileError(
            f"{source} cannot be read by MeshLab ({reason}): convert it to {USUAL_FORMATS} with "
            "the program that made it",
            "damaged",
        ) from error
    if mesh_set.mesh_number() > 1:
        raise MeshFileError(
            f"{source} holds {mesh_set.mesh_number()} meshes: merge them in MeshLab with 'Flatten "
            "Visible Layers', or save them separately",
            "unsupported",
        )


def named_files(source: Path) -> set[str]:
    """Return the files that a mesh file names, each to a quote or a blank in its line."""
    text, names = source.read_bytes(), set[str]()
    for match in _NAMED.finditer(text):
        before = text[max(0, match.end() - _LONGEST_NAME) : match.end()].decode(errors="replace")
        line = unquote(_BEFORE_NAME.split(before)[-1])
        names |= {line, line.partition(" ")[2], line.rpartition(" ")[2]}
    paths = (os.path.join(source.parent, name) for name in names)  # noqa: PTH118
    return {path for path in paths if os.path.isfile(path)}  # noqa: PTH113 - false for any text


def _check_inlined(source: Path) -> None:
    """Raise MeshFileError if a scene takes in a file outside its folder: MeshLab would read it."""
    if source.suffix.lower() not in _TAKING_IN:
        return
    text = html.unescape(source.read_bytes().decode(errors="replace"))
    for element in _INLINED.finditer(text):
        for name in _QUOTED.findall(element[0]):
            if not _REMOTE.match(name) and is_outside(source, name):
                beside(source, name)


def write_with_meshlab(
    mesh_set: Any,
    scratch: Path,
    source: Path,
    contents: Collection[str] | None = None,
    settings: dict[str, bool] | None = None,
) -> None:
    """Save the current mesh of a MeshSet to a file from `writing_whole`; raises MeshFileError.

    `source` is the file that the mesh comes from, `contents` what it holds of normals and colours
    (None: what the mesh has), `settings` are those of `MeshSet.save_current_mesh`.
    """
    import pymeshlab

    settings = {
        **_settings(mesh_set.current_mesh(), scratch, contents),
        **(settings or {}),
        "save_textures": _textures_to_be_saved(mesh_set, scratch, source),
    }
    if settings.get("save_vertex_normal"):
        mesh_set.apply_normal_normalization_per_vertex()
    if scratch.suffix.lower() in _POLYGON_FORMATS and _has_non_manifold_edges(mesh_set):
        # MeshLab would trace its polygons without end and use up all memory.
        settings["save_polygonal"] = False
    words = locale.setlocale(locale.LC_ALL)  # to be restored: MeshLab leaves "C" after a .3mf
    try:
        mesh_set.save_current_mesh(str(scratch), **settings)
        _check_room(scratch)
        if scratch.suffix.lower() == ".stl":
            _mend_stl_colours(scratch, settings["save_face_color"])
    except (pymeshlab.PyMeshLabException, RuntimeError) as error:
        _check_room(scratch)
        reason = reason_of(error).rsplit(": ", 1)[-1]  # without the scratch file's name
        raise MeshFileError(
            f"MeshLab cannot write {scratch.name} ({reason}): choose another format, "
            f"{USUAL_FORMATS}",
            "not_written",
        ) from error
    finally:
        locale.setlocale(locale.LC_ALL, words)


def _settings(mesh: Any, scratch: Path, contents: Collection[str] | None) -> dict[str, bool]:
    """Return which normals and colours are written, of those that the format may have."""
    if contents is None:
        present = {"colours": mesh.has_vertex_color(), "face colours": mesh.has_face_color()}
        contents = {"normals"} | {name for name, is_there in present.items() if is_there}
    ending = scratch.suffix[1:].lower()
    found = {
        setting: name in contents
        for name, (setting, endings) in _SETTINGS.items()
        if ending in endings.split()
    }
    return found | _OTHER_SETTINGS.get(f".{ending}", {})


def _mend_stl_colours(scratch: Path, has_colours: bool) -> None:
    """Write no colours to an STL file that has none, where MeshLab makes every facet black.

    Where there are, the colour of the whole, which MeshLab writes too, becomes opaque white.
    """
    content = bytearray(scratch.read_bytes())
    content[:_STL_HEADER] = (b"COLOR=\xff\xff\xff\xff" if has_colours else b"").ljust(_STL_HEADER)
    # With that header, facets whose highest bit is not set have a colour of their own.
    facets = np.frombuffer(content, TRIANGLE, -1, HEADER)
    facets["attribute"] &= 0x7FFF if has_colours else 0
    scratch.write_bytes(content)


def _check_room(scratch: Path) -> None:
    """Raise MeshFileError if the disk has filled up: MeshLab does not notice."""
    if shutil.disk_usage(scratch.parent).free < _LEAST_ROOM:
        raise MeshFileError(
            f"{scratch.name} cannot be written (no space left on the disk): make room, or choose "
            "another folder",
            "disk_full",
        )


def set_quality(mesh_set: Any, quality: Any) -> None:
    """Give the vertices of the current mesh a quality, unless they have it."""
    mesh = mesh_set.current_mesh()
    if np.array_equal(mesh.vertex_scalar_array(), quality, equal_nan=True):
        return
    mesh.add_vertex_custom_scalar_attribute(quality, _QUALITY)
    mesh_set.compute_scalar_by_function_per_vertex(q=_QUALITY)


def left_by_meshlab(source: Path, target: Path, mesh_set: Any) -> list[Warned]:
    """Return the warning about what a file loses that MeshLab reads and rewrites."""
    content = source.read_bytes()
    lost = [loss for loss, pattern in _SCENES.items() if pattern.search(content)]
    if DUMMY in mesh_set.current_mesh().textures():
        lost.append("textures that MeshLab does not find")
    what = ", ".join(lost or ["what MeshLab does not keep of it, such as units, transforms, names"])
    return [Warned("format_loss", f"{target.name} is rewritten by MeshLab, and loses {what}")]


def left_behind(
    document: Document, target: Path, mesh_set: Any = None, lacking: Collection[str] = ()
) -> list[Warned]:
    """Return the warning, if any, about what `target`, in another format than `document`, loses.

    Placements are in the coordinates of `target`. `mesh_set` is what MeshLab has read of the
    document; None if it got only coordinates and triangles. It lacks `lacking` nevertheless.
    """
    written = {"placement"}
    if mesh_set is not None:
        ending = target.suffix.lower()
        written |= _WRITTEN.get(ending, set())
        written |= {name for name, (_, all_) in _SETTINGS.items() if ending[1:] in all_.split()}
        if (document.path.suffix.lower(), target.suffix.lower()) == (".obj", ".ply"):
            written.remove("normals")  # an OBJ file has them at corners
        written.difference_update(lacking)
    lost = [content for content in document.contents if content not in written]
    if mesh_set is not None and DUMMY in mesh_set.current_mesh().textures():
        lost.append("textures that MeshLab does not find")
    return [Warned("format_loss", f"{target.name} loses {', '.join(lost)}")] if lost else []


def _has_non_manifold_edges(mesh_set: Any) -> bool:
    """Whether any edge has more than two faces."""
    F = mesh_set.current_mesh().face_matrix()
    edges = np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    _, faces = np.unique(edges, axis=0, return_counts=True)
    return bool((faces > 2).any())


def _textures_to_be_saved(mesh_set: Any, scratch: Path, source: Path) -> bool:
    """Whether to save copies of the texture images next to the output.

    Not next to the input, where they already are; not if the mesh refers to an image outside its
    folder, which would overwrite a file outside the scratch folder; and not MeshLab's substitute.
    """
    names = [Path(name) for name in mesh_set.current_mesh().textures()]
    if Path(DUMMY) in names:
        return False
    beside_input = scratch.parent.parent.samefile(resolved(source).parent)
    within = all(not name.is_absolute() and ".." not in name.parts for name in names)
    return within and not beside_input


def _decimals(numbers: Array) -> Array:
    return np.round(numbers, 6)


def _six_digits(numbers: Array) -> Array:
    size = np.where(numbers == 0, 1.0, np.abs(numbers))
    step = 10.0 ** (np.floor(np.log10(size)) - 5)
    return np.asarray(np.round(numbers / step) * step, dtype=np.float64)


# Extensions of formats in which MeshLab writes fewer digits than it has: what is left of
# coordinates, and what that is called.
_ROUNDED: dict[str, tuple[Callable[[Array], Array], str]] = {
    **dict.fromkeys(("stl", "3ds", "ctm", "nxs"), (in_single_precision, "single precision")),
    **dict.fromkeys(("dae", "json", "wrl", "x3d"), (_six_digits, "six digits")),
    **dict.fromkeys(("3mf", "dxf", "idtf", "xyz"), (_decimals, "six decimals")),
}


def rounding_warnings(before: Array, after: Array, scratch: Path) -> list[Warned]:
    """Return the warning, if any, that MeshLab writes this format with too few digits."""
    rounded = _ROUNDED.get(scratch.suffix[1:].lower())
    if rounded is None or before.shape != after.shape:
        return []
    return precision_warnings(before, after, scratch.name, *rounded)
