"""Instruments' maps and terrains are meshes with a vertex for each height that was measured."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import rasterio
import surfalize
from commands import command, succeeded
from meshlab_spectral import MeshFileError, surface_texture
from meshlab_spectral.formats.document import Array, Part
from meshlab_spectral.formats.height_map import _surface, read
from meshlab_spectral.formats.normals import area_vectors
from rasterio.transform import Affine
from scipy.ndimage import gaussian_filter

DX, DY = 0.5, 0.75  # micrometres, or metres
pytestmark = pytest.mark.filterwarnings("ignore:The surface has different pixel size")
WRITTEN = ("al3d", "sdf", "sur", "tmd", "x3p")  # by surfalize


def heights(rows: int = 40, columns: int = 50) -> Array:
    """Return a wave in each direction, and noise; the first row is at the back."""
    y, x = np.indices((rows, columns))
    noise = np.random.default_rng(3).normal(scale=0.02, size=x.shape)
    wave: Array = 0.3 * np.sin(x / 4) + 0.1 * np.cos(y / 3) + noise
    return wave


def saved(z: Array, path: Path) -> Path:
    surfalize.Surface(z, DX, DY).save(path)
    return path


def terrain(z: Array, path: Path, place: Affine, **more: object) -> Path:
    rows, columns = z.shape
    size = {"width": columns, "height": rows, "count": 1, "dtype": "float32"}
    with rasterio.open(path, "w", driver="GTiff", transform=place, **{**size, **more}) as file:
        file.write(z.astype(np.float32), 1)
    return path


def grid(part: Part, shape: tuple[int, int]) -> Array:
    return part.vertices.reshape(*shape, 3)


def refused(path: Path) -> str:
    with pytest.raises(MeshFileError) as error:
        read(path)
    return str(error.value).removeprefix(f"{path} ")


def normals(part: Part) -> Array:
    a, b, c = part.vertices[part.faces].swapaxes(0, 1)
    up: Array = np.cross(b - a, c - a)
    return up


@pytest.mark.parametrize("ending", WRITTEN)
def test_a_map_has_its_heights_at_its_pixels(ending: str, tmp_path: Path) -> None:
    z = heights()
    (part,) = read(saved(z, tmp_path / f"map.{ending}")).parts
    found = grid(part, z.shape)
    np.testing.assert_allclose(found[..., 2] - found[0, 0, 2], z - z[0, 0], atol=2e-5)
    np.testing.assert_allclose(np.diff(found[..., 0], axis=1), DX, rtol=1e-5)
    np.testing.assert_allclose(np.diff(found[..., 1], axis=0), -DY, rtol=1e-5)
    assert len(part.faces) == 2 * 39 * 49
    assert (normals(part)[:, 2] > 0).all()
    assert part.unit == "µm"


def test_a_map_of_gwyddion_has_its_heights_and_holes_where_its_mask_is(tmp_path: Path) -> None:
    z, mask = heights(), np.zeros((40, 50))
    mask[5, 6] = 1

    def field(name: str, array: Array) -> bytes:
        unit = b"GwySIUnit\0" + struct.pack("<I", 10) + b"unitstr\0s" + b"m\0"
        unit = unit.replace(struct.pack("<I", 10), struct.pack("<I", len(b"unitstr\0sm\0")))
        content = b"xres\0i" + struct.pack("<i", 50) + b"yres\0i" + struct.pack("<i", 40)
        content += b"xreal\0d" + struct.pack("<d", 50 * DX * 1e-6)
        content += b"yreal\0d" + struct.pack("<d", 40 * DY * 1e-6)
        content += b"si_unit_xy\0o" + unit + b"si_unit_z\0o" + unit
        content += b"data\0D" + struct.pack("<I", array.size) + array.astype("<f8").tobytes()
        return name.encode() + b"\0oGwyDataField\0" + struct.pack("<I", len(content)) + content

    content = field("/0/data", z * 1e-6) + field("/0/mask", mask) + b"/0/data/title\0sTopo\0"
    path = tmp_path / "map.gwy"
    path.write_bytes(b"GWYPGwyContainer\0" + struct.pack("<I", len(content)) + content)
    (part,) = read(path).parts
    np.testing.assert_allclose(part.vertices[:, 2], np.delete(z.ravel(), 5 * 50 + 6), rtol=1e-9)
    assert len(part.faces) == 2 * 39 * 49 - 4


def test_pixels_that_were_not_measured_are_holes(tmp_path: Path) -> None:
    z = heights()
    z[10, 10] = z[20, 20] = z[20, 21] = z[0, 0] = np.nan
    z[30:33, 30:33] = np.nan
    z[31, 31] = 1  # alone: without a triangle
    (part,) = read(saved(z, tmp_path / "map.sur")).parts
    assert len(part.vertices) == z.size - 13
    # A quad that lacks one corner keeps a triangle, one that lacks two keeps none.
    assert len(part.faces) == 2 * 39 * 49 - (4 + (4 + 2 * 2) + 1 + (4 + 8 * 2 + 4 * 2))
    assert (normals(part)[:, 2] > 0).all()


@pytest.mark.parametrize("rows_go_down", [True, False])
def test_a_terrain_lies_where_its_reference_says(rows_go_down: bool, tmp_path: Path) -> None:
    z = heights()
    z[3, 4] = -9999
    place = Affine(DX, 0, 500_000, 0, -DY if rows_go_down else DY, 4_000_000)
    path = terrain(z, tmp_path / "dem.tif", place, nodata=-9999, crs="EPSG:32633", compress="lzw")
    (part,) = read(path).parts
    assert len(part.vertices) == z.size - 1
    first, last = part.vertices[[0, -1]]
    sign = -1 if rows_go_down else 1
    np.testing.assert_allclose(first[:2], [500_000 + DX / 2, 4_000_000 + sign * DY / 2])
    np.testing.assert_allclose(last[:2] - first[:2], [49 * DX, sign * 39 * DY])
    assert (normals(part)[:, 2] > 0).all()
    assert part.unit == "m"


def test_what_is_no_height_map_over_a_plane_is_refused(tmp_path: Path) -> None:
    z, place = heights(), Affine(DX, 0, 0, 0, -DY, 0)
    degrees = terrain(z, tmp_path / "degrees.tif", place, crs="EPSG:4326")
    assert refused(degrees).startswith("has x and y in degrees")
    bands = tmp_path / "bands.tif"
    with rasterio.open(
        bands, "w", driver="GTiff", width=4, height=4, count=3, dtype="uint8", transform=place
    ) as file:
        file.write(np.zeros((3, 4, 4), np.uint8))
    assert refused(bands).startswith("has 3 bands")
    with pytest.warns(rasterio.errors.NotGeoreferencedWarning):
        picture = terrain(z, tmp_path / "picture.tif", Affine.identity())
    assert refused(picture).startswith("has no size of a pixel")
    empty = terrain(np.full((5, 5), -1.0), tmp_path / "e.tif", place, nodata=-1, crs="EPSG:32633")
    assert refused(empty).startswith("has no three measured heights")
    whole = saved(z, tmp_path / "whole.x3p").read_bytes()
    for name, content, text in (
        ("cut.x3p", whole[:2000], "cannot be read as X3P"),
        ("mesh.sur", b"ply\nformat ascii 1.0\n", "is PLY, not Digital Surf: rename it to .ply"),
        ("text.plu", b"what is this", "cannot be read as Sensofar PLU"),
        ("zero.opd", b"", "is empty"),
    ):
        (tmp_path / name).write_bytes(content)
        assert refused(tmp_path / name).startswith(text), refused(tmp_path / name)


def test_texture_of_a_map_is_that_of_surfalize_in_micrometres(tmp_path: Path) -> None:
    path = saved(heights(200, 240), tmp_path / "map.sur")
    record = json.loads(
        succeeded("texture", path, "--form", "plane", "--waviness", "100%", "--json").stdout
    )
    surface = surfalize.Surface.load(path).level()
    for name in ("Sa", "Sq", "Sz", "Sku", "Sdq"):
        assert record[name] == pytest.approx(getattr(surface, name)(), rel=0.01), name
    assert record["unit"] == "µm"


def test_autocorrelation_lengths_of_a_map_are_those_of_surfalize(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).normal(size=(200, 220))
    z = gaussian_filter(noise, (4, 6), mode="wrap")
    path = saved(z / z.std(), tmp_path / "map.sdf")
    (part,) = read(path).parts
    texture = surface_texture(part.vertices, part.faces, form="plane", waviness="100%")
    surface = surfalize.Surface.load(path).level()
    assert texture.Sal == pytest.approx(surface.Sal(), rel=0.01)
    assert texture.Str == pytest.approx(surface.Str(), rel=0.01)


def test_a_map_becomes_a_mesh_and_is_never_written(tmp_path: Path) -> None:
    path = saved(heights(), tmp_path / "map.x3p")
    succeeded("filter", path, tmp_path / "out.ply", "--feature-size", "6e")
    assert (tmp_path / "out.ply").is_file()
    refusal = command("filter", path, tmp_path / "out.x3p")
    assert refusal.returncode == 2
    assert "out.x3p ends in .x3p, which MeshLab cannot write" in refusal.stderr


@pytest.mark.parametrize(
    ("columns", "rows"),
    [((1, 0), (0, -1)), ((1, 0), (0, 1)), ((0, 1), (-1, 0)), ((0, 1), (1, 0)), ((1, 3), (2, 1))],
)
def test_faces_look_up_however_rows_and_columns_run(
    columns: tuple[float, float], rows: tuple[float, float]
) -> None:
    (a, d), (b, e) = columns, rows
    V, F = _surface(np.zeros((3, 4)), (a, b, 7.0, d, e, -2.0))
    assert len(F) == 12
    assert (area_vectors(V, F)[:, 2] > 0).all()
