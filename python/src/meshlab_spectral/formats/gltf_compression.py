"""Compressed geometry of glTF: decoded, or left for the uncompressed copy beside it."""

from __future__ import annotations

from typing import Any

import numpy as np

from meshlab_spectral.extras import check_extras
from meshlab_spectral.formats.causes import unsupported
from meshlab_spectral.formats.gltf_accessors import Asset, Json
from meshlab_spectral.warned import Warned

_DRACO = "KHR_draco_mesh_compression"
_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_TRIANGLES = 4


def uncompress(asset: Asset) -> list[Warned]:
    """Let an asset have its geometry without compression; return a warning that says so.

    Draco is decoded by DracoPy, the extra "draco". Where a file has an uncompressed copy for
    readers that cannot decode it, that is taken. Raises MeshFileError for meshopt without one, and
    MissingPackageError.
    """
    tree = asset.tree
    used = [name for name in (_DRACO, *_MESHOPT) if name in tree.get("extensionsUsed", [])]
    required = set(tree.get("extensionsRequired", []))
    if required.intersection(_MESHOPT):
        remedy = "export it again without compression, or with `gltf-transform copy` of its tools"
        raise unsupported(asset.path, f"is compressed with {_MESHOPT[0]}", remedy)
    for view in tree.get("bufferViews", []):
        for name in _MESHOPT:
            _without(view, name)
    for mesh in tree.get("meshes", []):
        for primitive in mesh["primitives"]:
            packed = _without(primitive, _DRACO)
            if packed is not None and _lacks_data(tree, primitive):
                _decode(asset, primitive, packed)
    for key in ("extensionsUsed", "extensionsRequired"):
        rest = [name for name in tree.get(key, []) if name not in used]
        if key in tree:
            tree[key] = rest
        if not rest:
            tree.pop(key, None)
    text = f"it is written without its compression, {', '.join(used)}"
    return [Warned("uncompressed", text)] if used else []


def _without(entry: Json, name: str) -> Any:
    """Take an extension from an entry; return it, or None."""
    extensions = entry.get("extensions", {})
    found = extensions.pop(name, None)
    if found is not None and not extensions:
        entry.pop("extensions", None)
    return found


def _lacks_data(tree: Json, primitive: Json) -> bool:
    accessors = list(primitive["attributes"].values())
    accessors += [primitive["indices"]] if "indices" in primitive else []
    return any("bufferView" not in tree["accessors"][number] for number in accessors)


def _decode(asset: Asset, primitive: Json, packed: Json) -> None:
    check_extras("draco")
    import DracoPy

    view = asset.entry("bufferViews", packed["bufferView"])
    begin = view.get("byteOffset", 0)
    data = bytes(asset.buffers[view["buffer"]][begin : begin + view["byteLength"]])
    mesh = DracoPy.decode(data)
    for name, number in packed["attributes"].items():
        values = mesh.get_attribute_by_unique_id(number)["data"]
        asset.fill(primitive["attributes"][name], values.reshape(len(mesh.points), -1))
    if "indices" not in primitive:
        accessor = {"componentType": 5125, "type": "SCALAR", "count": 0}
        asset.tree["accessors"].append(accessor)
        primitive["indices"] = len(asset.tree["accessors"]) - 1
    asset.fill(primitive["indices"], np.asarray(mesh.faces).reshape(-1, 1))
    primitive["mode"] = _TRIANGLES
