"""USD scenes, read and written with Pixar's library: .usda, .usdc, .usd, and packages, .usdz.

Points, normals and extents are replaced where a file, or a layer in its package, gives them. The
library drops comments of texts. Scenes of several files are refused.
"""

from __future__ import annotations

import posixpath
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from meshlab_spectral.errors import SpectralError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.formats.budget import Budget, guarded
from meshlab_spectral.formats.causes import unreadable, unsupported
from meshlab_spectral.formats.digits import precision_warnings
from meshlab_spectral.formats.document import Array, Document, Indices, checked_part
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.placement import Placement, placement_of
from meshlab_spectral.formats.polygons import corners_of_triangles
from meshlab_spectral.formats.side_files import copy_side_files
from meshlab_spectral.warned import Warned

_OF_USD = 256 << 20  # bytes of its own, such as its schemas
_BINARY = b"PXR-USDC"
_LAYERS = (".usd", ".usda", ".usdc")
_FLATTEN = "flatten the scene first, with `usdcat --flatten`"
_CONTENTS = {"normals": "normals", "st": "texture coordinates", "displayColor": "colours"}


@dataclass
class _Mesh:
    """A mesh: its points as they are given, and the prims that show them."""

    prims: list[Any] = field(default_factory=list)  # UsdGeom.Mesh
    matrices: list[Array] = field(default_factory=list)  # of prims, to the scene
    is_shown: bool = False
    placement: Placement = field(init=False)

    def read(self) -> None:
        """Read its numbers; raises ValueError."""
        prim = self.prims[0]
        self.own = _values(prim.GetPointsAttr()).astype(np.float64).reshape(-1, 3)
        self.indices = _values(prim.GetFaceVertexIndicesAttr()).astype(np.int64)
        sizes = _values(prim.GetFaceVertexCountsAttr()).astype(np.int64)
        if len(self.indices) != sizes.sum() or (sizes < 0).any():
            raise ValueError(
                f"{shown(prim.GetPath())} claims {sizes.sum()} corners, and has {len(self.indices)}"
            )
        self.owners = np.repeat(np.arange(len(sizes)), sizes)  # the polygon of each corner
        # Of its triangles, positions in `indices`.
        self.corners = corners_of_triangles(self.indices, sizes, self.own)
        if prim.GetOrientationAttr().Get() == "leftHanded":
            self.corners = self.corners[:, [0, 2, 1]]
        self.faces = self.indices[self.corners]


@dataclass(kw_only=True)
class _UsdDocument(Document):
    stage: Any
    entries: list[str]  # of a package
    names: list[str]  # of files that it refers to
    meshes: list[_Mesh] = field(default_factory=list)

    def add(self, mesh: _Mesh) -> None:
        """Add a mesh as a part, unless it has no faces."""
        from pxr import UsdGeom, UsdSkel

        mesh.read()
        prim, warnings = mesh.prims[0], self.warnings
        name = shown(prim.GetPath())
        if not len(mesh.faces):
            return
        mesh.placement = placement_of(name, mesh.matrices, warnings)
        faces = mesh.placement.oriented(mesh.faces)
        part = checked_part(self.path, mesh.placement.placed(mesh.own), faces, name)
        self.parts.append(replace(part, copies=mesh.placement.copies, is_shown=mesh.is_shown))
        self.meshes.append(mesh)
        scheme = prim.GetSubdivisionSchemeAttr().Get()
        if scheme != "none":
            text = f"{name} is subdivided when it is shown ({scheme}): its cage is filtered"
            warnings.append(Warned("subdivided", text))
        if prim.GetPrim().HasAPI(UsdSkel.BindingAPI):
            text = f"{name} has a skeleton: lengths are measured without its pose"
            warnings.append(Warned("skeleton", text))
        primvars = UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithValues()
        authored = {one.GetPrimvarName() for one in primvars}
        authored |= {"normals"} if _given(prim.GetNormalsAttr()) is not None else set()
        self.contents += [text for key, text in _CONTENTS.items() if key in authored]

    def side_files(self) -> list[str]:
        return self.names

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        warnings: list[Warned] = []
        layers = [one for one in self.stage.GetUsedLayers() if not one.anonymous]
        try:
            for mesh, part, new in zip(self.meshes, self.parts, moved, strict=True):
                after = mesh.placement.back(mesh.own, part.vertices, new)
                warnings += precision_warnings(mesh.own, after, target.name)
                for prim in mesh.prims:
                    _put(prim, mesh, after)
            if self.entries:
                self._pack(target, layers)
            else:
                _export(self.stage.GetRootLayer(), target, self.path.read_bytes())
        finally:  # the library would give the next reader of the file what is changed here
            for layer in layers:
                if layer.dirty:
                    layer.Reload(force=True)
        return warnings + copy_side_files(self.path, target, self.names)

    def _pack(self, target: Path, layers: list[Any]) -> None:
        """Write a package with its files in their order, and layers as they are now."""
        from pxr import Sdf

        changed = {layer.identifier.rpartition("[")[2].rstrip("]"): layer for layer in layers}
        changed[self.entries[0]] = self.stage.GetRootLayer()
        writer = Sdf.ZipFileWriter.CreateNew(str(target))
        with (
            zipfile.ZipFile(self.path) as archive,
            tempfile.TemporaryDirectory(dir=target.parent) as folder,
        ):
            for number, name in enumerate(self.entries):
                file, content = Path(folder) / f"{number}{Path(name).suffix}", archive.read(name)
                if name in changed and changed[name].dirty:
                    _export(changed[name], file, content)
                else:
                    file.write_bytes(content)
                writer.AddFile(str(file), name)
            writer.Save()


def _export(layer: Any, target: Path, before: bytes) -> None:
    """Write a layer as the kind of file, binary or text, that it was before."""
    kind = {"format": "usdc" if before.startswith(_BINARY) else "usda"}
    layer.Export(str(target), args=kind if target.suffix.lower() == ".usd" else {})


def _put(prim: Any, mesh: _Mesh, after: Array) -> None:
    """Write the points of a mesh, its normals and its extent."""
    _set(prim.GetPointsAttr(), after.astype(np.float32))
    for attribute, normals, which in _normals(prim, mesh):
        old = normals.astype(np.float64)
        new = following_normals(mesh.own, after, mesh.faces, old, which)
        _set(attribute, new.astype(normals.dtype))
    if _given(prim.GetExtentAttr()) is not None:
        extent = np.array([after.min(axis=0), after.max(axis=0)], np.float32)
        _set(prim.GetExtentAttr(), extent)


def _set(attribute: Any, values: Any) -> None:
    """Set an attribute where it is given."""
    spec = _given(attribute)
    value = type(attribute.Get(_time_of(attribute))).FromNumpy(np.ascontiguousarray(values))
    if times := spec.layer.ListTimeSamplesForPath(spec.path):
        spec.layer.SetTimeSample(spec.path, times[0], value)
    else:
        spec.default = value


def read(path: Path) -> Document:
    """Read a scene; each mesh whose points do not change in time is a part."""
    check_extras("usd")
    try:
        with guarded(Budget(path, path.stat().st_size), _OF_USD):
            return _document(path)
    except SpectralError:
        raise
    except (ValueError, TypeError, LookupError, RuntimeError, zipfile.BadZipFile) as error:
        try:
            message = str(error).rsplit(" : ", 1)[-1]  # after its own lines
        except UnicodeDecodeError:  # of the library's, which quote what was read
            message = "it holds bytes that are not text"
        raise unreadable(path, message) from error


def _check_layers(path: Path, entries: list[str]) -> list[str]:
    """Return the names of files that a scene refers to, if it is not a package.

    Raises MeshFileError for what the library would read elsewhere, and ValueError.
    """
    from pxr import Sdf, UsdUtils

    packed = [name for name in entries if name.lower().endswith(_LAYERS)]
    for inner in ["", *packed[1:]]:
        layer = Sdf.Layer.FindOrOpen(f"{path}[{inner}]" if inner else str(path))
        if layer is None:
            raise ValueError(f"{shown(inner or path.name)} is not a USD layer")
        layer.Reload()  # it may be an older one

        def check(where: Any, layer: Any = layer) -> None:
            if where.IsPrimPath() and layer.GetPrimAtPath(where).HasInfo("clips"):
                raise unsupported(path, "has values in clips", _FLATTEN)

        layer.Traverse("/", check)
        folder = PurePosixPath(inner or [*entries, ""][0]).parent
        for name in filter(None, layer.GetCompositionAssetDependencies()):
            if posixpath.normpath(folder / name) not in packed:
                raise unsupported(path, f"is composed with {shown(name)}", _FLATTEN)
    names = chain(*UsdUtils.ExtractExternalReferences(str(path)))
    return [] if entries else list(dict.fromkeys(names))


def _document(path: Path) -> Document:
    from pxr import Usd, UsdGeom

    entries: list[str] = []
    if path.suffix.lower() == ".usdz":
        with zipfile.ZipFile(path) as archive:
            found = [info for info in archive.infolist() if not info.is_dir()]
        if not found or not found[0].filename.lower().endswith(_LAYERS):
            raise ValueError("its first file is not a USD layer")
        if any(info.compress_type != zipfile.ZIP_STORED for info in found):
            raise unsupported(
                path, "is compressed, which USD does not allow", "zip it uncompressed"
            )
        entries = [info.filename for info in found]
    names = _check_layers(path, entries)
    stage = Usd.Stage.Open(str(path))
    document = _UsdDocument(path, [], stage=stage, entries=entries, names=names)
    transforms = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
    meshes: dict[tuple[str, str], _Mesh] = {}
    prims = [*stage.Traverse(Usd.TraverseInstanceProxies())]
    for prim in map(UsdGeom.Mesh, prims):
        spec = _given(prim.GetPointsAttr()) if prim else None
        if spec is None:
            continue
        name = shown(prim.GetPath())
        if prim.GetPointsAttr().ValueMightBeTimeVarying():
            text = f"{name} is animated by its points: it stays as it is"
            document.warnings.append(Warned("kept_in_file", text))
            continue
        mesh = meshes.setdefault((spec.layer.identifier, str(spec.path)), _Mesh())
        mesh.prims.append(prim)
        mesh.matrices.append(np.array(transforms.GetLocalToWorldTransform(prim.GetPrim())).T)
        is_drawn = prim.ComputePurpose() in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)
        mesh.is_shown |= is_drawn and prim.ComputeVisibility() != UsdGeom.Tokens.invisible
    for mesh in meshes.values():
        document.add(mesh)
    if not document.parts:
        shapes = sorted({prim.GetTypeName() for prim in prims if prim.IsA(UsdGeom.Gprim)})
        what = "holds only meshes that are animated by their points"
        if "Mesh" not in shapes:
            what = f"holds no mesh, only {' and '.join(shapes) or 'other prims'}"
        raise unsupported(path, what, "name a file with one")
    materials = ["materials"] * any(prim.GetTypeName() == "Material" for prim in prims)
    document.contents = [*dict.fromkeys(["units and axes", *document.contents]), *materials]
    return document


def _given(attribute: Any) -> Any:
    """Return what gives an attribute its value, in a layer; None if nothing does."""
    from pxr import Usd

    stack = attribute.GetPropertyStack(Usd.TimeCode.EarliestTime())
    specs = (one for one in stack if one.HasInfo("default") or one.HasInfo("timeSamples"))
    return next(specs, None) if attribute.HasAuthoredValue() else None


def _time_of(attribute: Any) -> Any:
    """Return when an attribute has its value: its only sample, or always."""
    from pxr import Usd

    times = attribute.GetTimeSamples()
    return Usd.TimeCode(times[0]) if times else Usd.TimeCode.Default()


def _values(attribute: Any) -> Any:
    values = attribute.Get(_time_of(attribute))
    return np.array(values if values is not None else [])


def _normals(prim: Any, mesh: _Mesh) -> Iterator[tuple[Any, Any, Indices]]:
    """Yield attributes of normals, k x 3 numbers, and the index of each corner's, m x 3."""
    from pxr import UsdGeom

    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    named = {"vertex": mesh.indices, "varying": mesh.indices, "uniform": mesh.owners}
    named["faceVarying"] = np.arange(len(mesh.indices))
    for attribute, kind, is_indexed in (
        (prim.GetNormalsAttr(), prim.GetNormalsInterpolation(), False),
        (primvar.GetAttr(), primvar.GetInterpolation(), primvar.IsIndexed())
        if primvar
        else 3 * (0,),
    ):
        if attribute and _given(attribute) is not None and kind in named:
            which = named[kind]
            if is_indexed:
                which = np.array(primvar.GetIndices(), np.int64)[which]
            normals = _values(attribute).reshape(-1, 3)
            if which.size and which.min() >= 0 and which.max() < len(normals):
                yield attribute, normals, which[mesh.corners]
