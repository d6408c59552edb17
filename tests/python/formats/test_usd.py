"""USD: where points are, who shows them, and what is said; everything else is in test_formats."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from format_samples import CUT, write_usd
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.opening import open_document
from meshlab_spectral.formats.usd import read

pytest.importorskip("pxr", reason="usd-core has no wheel for this system")
from pxr import Usd, UsdGeom, Vt


def quadrilateral(stage: Any, where: str) -> Any:
    mesh = UsdGeom.Mesh.Define(stage, where)
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    return mesh


@pytest.mark.parametrize("ending", ["usda", "usdc", "usd"])
def test_a_prototype_is_one_mesh_with_copies(ending: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / f"a.{ending}"))
    UsdGeom.Xform.Define(stage, "/a")
    quadrilateral(stage, "/a/b").CreateSubdivisionSchemeAttr("none")
    for k in range(2):
        other = UsdGeom.Xform.Define(stage, f"/other{k}")
        other.AddTranslateOp().Set((3 * k + 3, 0, 0))
        other.GetPrim().GetReferences().AddInternalReference("/a")
        other.GetPrim().SetInstanceable(k == 1)
    stage.GetRootLayer().Save()
    document = read(tmp_path / f"a.{ending}")
    (part,) = document.parts
    assert (len(part.copies), document.warnings) == (2, [])
    assert sorted(one[0, 3] for one in part.copies) == [3, 6]
    target = tmp_path / f"out.{ending}"
    document.save(target, [part.vertices + np.array([0, 0, 1])])
    assert target.read_bytes()[:4] == document.path.read_bytes()[:4]
    moved = Usd.Stage.Open(str(target))
    places = [*moved.Traverse(Usd.TraverseInstanceProxies())]
    shown = [UsdGeom.Mesh(prim).GetPointsAttr().Get() for prim in places if prim.IsA(UsdGeom.Mesh)]
    assert len(shown) == 3
    assert all(np.array(points)[:, 2].tolist() == [1] * 4 for points in shown)
    (again,) = read(document.path).parts  # the library has not kept what moved
    np.testing.assert_array_equal(again.vertices, part.vertices)


@pytest.mark.parametrize("kind", ["uniform", "faceVarying", "indexed"])
def test_normals_of_polygons_and_corners_follow(kind: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    mesh = quadrilateral(stage, "/a")
    mesh.CreateSubdivisionSchemeAttr("none")
    if kind == "indexed":
        primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
            "normals", mesh.CreateNormalsAttr().GetTypeName(), "faceVarying"
        )
        primvar.Set([(0, 0, 1)])
        primvar.SetIndices(Vt.IntArray([0, 0, 0, 0]))
    else:
        mesh.CreateNormalsAttr([(0, 0, 1)] * (1 if kind == "uniform" else 4))
        mesh.SetNormalsInterpolation(kind)
    stage.GetRootLayer().Save()
    document = read(tmp_path / "a.usda")
    assert "normals" in document.contents
    vertices = document.parts[0].vertices
    document.save(tmp_path / "b.usda", [vertices[:, [0, 2, 1]]])  # stands up
    stood = Usd.Stage.Open(str(tmp_path / "b.usda"))
    turned = UsdGeom.Mesh(stood.GetPrimAtPath("/a"))
    primvar = UsdGeom.PrimvarsAPI(turned).GetPrimvar("normals")
    normals = primvar.Get() if kind == "indexed" else turned.GetNormalsAttr().Get()
    np.testing.assert_allclose(normals, [(0, -1, 0)] * len(normals), atol=1e-6)


def test_what_is_not_as_it_seems_is_told(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    quadrilateral(stage, "/cage")
    walks = quadrilateral(stage, "/walks").GetPointsAttr()
    still = quadrilateral(stage, "/still")
    still.MakeInvisible()
    still.GetPointsAttr().Set(still.GetPointsAttr().Get(), 7.0)  # always as at that time
    for time in (1.0, 2.0):
        walks.Set([(time, 0, 0)] * 4, time)
    stage.GetRootLayer().Save()
    document = read(tmp_path / "a.usda")
    assert [(part.name, part.is_shown) for part in document.parts] == [
        ("/cage", True),
        ("/still", False),
    ]
    told = "\n".join(document.warnings)
    assert "/cage is subdivided when it is shown (catmullClark): its cage is filtered" in told
    assert "/walks is animated by its points: it stays as it is" in told
    document.save(tmp_path / "b.usda", [part.vertices + 1 for part in document.parts])
    moved = Usd.Stage.Open(str(tmp_path / "b.usda"))
    after = UsdGeom.Mesh(moved.GetPrimAtPath("/still"))
    assert after.GetPointsAttr().GetTimeSamples() == [7.0]
    np.testing.assert_array_equal(after.GetPointsAttr().Get(7.0)[0], [1, 1, 1])


def test_a_package_keeps_the_order_and_the_bytes_of_its_files(tmp_path: Path) -> None:
    write_usd(tmp_path / "a.usdz")
    document = open_document(tmp_path / "a.usdz")
    document.save(tmp_path / "same.usdz", [document.parts[0].vertices])
    assert (tmp_path / "same.usdz").read_bytes() == (tmp_path / "a.usdz").read_bytes()
    assert len(document.parts[0].vertices) == len(CUT)
    document.save(tmp_path / "moved.usdz", [document.parts[0].vertices + 1])
    with ZipFile(tmp_path / "a.usdz") as old, ZipFile(tmp_path / "moved.usdz") as new:
        assert new.namelist() == old.namelist()
        for name in new.namelist()[1:]:
            assert new.read(name) == old.read(name)
        content = (tmp_path / "moved.usdz").read_bytes()
        for name in new.namelist():  # where readers map it
            assert content.find(new.read(name)) % 64 == 0


@pytest.mark.parametrize("arc", ["references", "payload", "subLayers"])
def test_a_scene_of_several_files_is_refused_with_the_remedy(arc: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "part.usda"))
    stage.SetDefaultPrim(quadrilateral(stage, "/a").GetPrim())
    stage.GetRootLayer().Save()
    head = "(subLayers = [@part.usda@])" if arc == "subLayers" else ""
    body = "" if head else f'def "a" ({arc} = @part.usda@) {{}}'
    (tmp_path / "all.usda").write_text(f"#usda 1.0\n{head}\n{body}")
    with pytest.raises(MeshFileError, match=r"composed with part.usda.*usdcat --flatten"):
        read(tmp_path / "all.usda")


def test_a_scene_of_other_shapes_is_refused_with_their_names(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text('#usda 1.0\ndef Cube "a" {}\ndef TetMesh "b" {}')
    with pytest.raises(MeshFileError, match="holds no mesh, only Cube and TetMesh"):
        read(tmp_path / "a.usda")


@pytest.mark.parametrize("counts", ["[5]", "[-4]", "[4, 4]"])
def test_counts_that_do_not_fit_are_told(counts: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    quadrilateral(stage, "/a")
    text = stage.GetRootLayer().ExportToString()
    (tmp_path / "b.usda").write_text(text.replace("Counts = [4]", f"Counts = {counts}"))
    with pytest.raises(MeshFileError, match=r"/a claims .* corners, and has 4"):
        read(tmp_path / "b.usda")
