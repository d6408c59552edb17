"""What commands refuse: the exit code, one message that says why, and every file as it was."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
import trimesh
from batches import contents
from commands import PRECIOUS, assert_fails, command, write_ply
from helpers import loaded

MESH_ENDINGS = ("ply", "obj", "stl", "off")
SCRIPTS = {"text.mlx": "no script", "html.mlx": "<html/>", "empty.mlx": "<FilterScript/>"}
RECIPES = {
    "denoise.toml": "[denoise]\n",
    "filter.toml": "[filter]\n",
    "several.toml": "[denoise]\n[filter]\n",
    "unknown.toml": "[denoise]\nfeature_size = '2%'\n",
    "negative.toml": "[denoise]\nstrength = -1\n",
    "outside.toml": "strength = 1\n",
    "misnamed.toml": "[denoising]\n",
}
TRIANGLE = "0 0 0\n1 0 0\n0 1 0"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, samples: Path) -> Path:
    """A folder with files to read, and outputs that were there before."""
    folder = tmp_path_factory.mktemp("refused")
    for name in ("out.ply", "basis.npz"):
        (folder / name).write_bytes(PRECIOUS)
    for ending in MESH_ENDINGS:
        (folder / f"empty.{ending}").touch()
        (folder / f"text.{ending}").write_text("this is no mesh\n")
    for name, text in (SCRIPTS | RECIPES | {"three.txt": "1 0 1", "yes.txt": "yes no"}).items():
        (folder / name).write_text(text)
    write_ply(folder / "nothing.ply", "", "")
    write_ply(folder / "cloud.ply", TRIANGLE, "")
    (folder / "flat.off").write_text("OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n")
    (folder / "notes.txt2").write_text("notes\n")
    trimesh.creation.icosphere(3).export(folder / "sphere.ply")
    mesh_set = loaded(samples / "cow.obj")
    mesh_set.save_current_mesh(str(folder / "cow.ply"))
    (folder / "cut.ply").write_bytes((folder / "cow.ply").read_bytes()[:20_000])
    return folder


# Options are named before any file is touched: none.ply does not exist.
OPTIONS = {
    "filter": {
        "--feature-size 0": "feature-size",
        "--feature-size -5%": "feature-size",
        "--feature-size 150%": "100%",
        "--filter-type lowpass": "low-pass",
        "--order 0": "order",
        "--order 2.5": "order",
        "--band-width 0": "--band-width 0",
        "--pass-gain -1": "--pass-gain -1",
        "--stop-gain nan": "--stop-gain nan",
        "--steps -1": "steps",
        "--basis-size 0": "--basis-size 0",
        "--basis-update sometimes": "conformal",
        "--equalizer 1,2": "1,2",
        "--equalizer 1,1,1,1,1,-1": "1,1,1,1,1,-1",
        "--equalizer 1,1,1,1,1,x": "1,1,1,1,1,x",
        "--equalizer 1,1,1,1,1,nan": "1,1,1,1,1,nan",
        "--equalizer 1,1,1,1,1,1 --filter-type high-pass": "--equalizer replaces --filter-type",
        "--transfer-function w --equalizer 1,1,1,1,1,1": "replaces --transfer-function",
        "--preset beautify": "caricature",
    },
    "denoise": {
        "--strength -1": "strength",
        "--strength strong": "strength",
        "--noise-height -0.2e": "noise-height",
        "--noise-height 0": "noise-height",
        "--boundary loose": "fixed",
        "--feature-size 2%": "--feature-size",
    },
}
# Words of a command; the exit code; words of its message.
REFUSED: list[tuple[str, int, tuple[str, ...]]] = [
    *(
        (f"{verb} none.ply out.ply --overwrite {options}", 2, (words,))
        for verb, table in OPTIONS.items()
        for options, words in table.items()
    ),
    *(
        (f"filter {content}.{ending} out.ply -f", 1, (f"{content}.{ending}", cause))
        for ending in MESH_ENDINGS
        for content, cause in (("empty", "is empty"), ("text", "is not"))
    ),
    # Meshes and outputs
    ("filter none.ply out.ply -f", 1, ("none.ply", "does not exist")),
    ("filter cut.ply out.ply -f", 1, ("cut.ply", "was cut off")),
    ("filter notes.txt2 out.ply -f", 1, (".txt2", ".ply")),
    ("filter nothing.ply out.ply -f", 1, ("empty",)),
    ("filter cloud.ply out.ply -f", 1, ("point cloud", "Surface Reconstruction")),
    ("filter cow.ply out.ply -f --feature-size 50", 2, ("--feature-size 50: is", "mean 50%?")),
    ("denoise cow.ply out.ply -f --noise-height 15", 2, ("--noise-height 15: is", "mean 15%?")),
    ("filter cow.ply out.ply -f --feature-size 5000", 2, ("give at most 100%",)),
    ("filter cow.ply out.ply -f --spectrum truncated --basis-size 5000", 2, ("2904", "full")),
    ("filter cow.ply http://example.org/out.ply", 1, ("to which only `meshlab-spectral batch`",)),
    ("filter cow.ply -", 2, ("--format: name the format",)),
    ("filter cow.ply - --format ply --json", 2, ("--json",)),
    ("filter cow.ply nowhere/out.ply", 1, ("nowhere", "create it first")),
    ("filter cow.ply .", 1, ("name a file",)),
    ("filter cow.ply result.xyzzy --steps 1000", 2, ("result.xyzzy", ".ply")),
    ("filter cow.ply result --steps 1000", 2, ("result", ".ply")),
    ("filter cow.ply new.ply --picture new.jpg", 2, ("PNG",)),
    ("filter cow.ply new.ply --color-displacement new.ply", 2, ("is OUTPUT",)),
    ("filter cow.ply new.obj --result details", 2, ("new.obj", ".ply")),
    ("denoise cow.ply new.obj --store-noise-height", 2, ("new.obj", ".ply")),
    ("info -", 1, ("only filter and denoise read",)),
    ("info cloud.ply", 1, ("point cloud",)),
    ("info none.ply", 1, ("does not exist",)),
    # Dry runs
    ("filter cow.ply new.nothing --dry-run", 2, ("cannot write",)),
    ("filter none.ply new.ply --dry-run", 1, ("does not exist",)),
    ("filter cow.ply new.ply --dry-run --where 'x > 99'", 2, ("no vertex is there",)),
    ("filter cow.ply new.ply --dry-run --mesh left", 2, ("has no mesh",)),
    ("filter cow.ply none/new.ply --dry-run", 1, ("does not exist",)),
    ("filter cow.ply new.obj --dry-run --result details", 2, ("cannot hold details",)),
    ("filter cow.ply new.ply --dry-run --tiles 2 --laplacian uniform", 1, ("uniform",)),
    # Regions
    ("filter sphere.ply new.ply --box 1,2,3", 2, ("give six numbers",)),
    ("filter sphere.ply new.ply --box 8,8,8,9,9,9", 2, ("no vertex is there",)),
    ("filter sphere.ply new.ply --component 0", 2, ("give largest, or a number from 1",)),
    ("filter sphere.ply new.ply --component 2", 2, ("there are 1",)),
    ("filter sphere.ply new.ply --where 'z = 3'", 2, ("compare with ==",)),
    ("filter sphere.ply new.ply --where '0 < z < 3'", 2, ("join two by &&",)),
    ("filter sphere.ply new.ply --where '__import__(1)'", 2, ("give a condition of x, y, z",)),
    ("filter sphere.ply new.ply --where 'q > 1'", 2, ("if the mesh has it",)),
    ("filter sphere.ply new.ply --mask three.txt", 2, ("has 3 numbers for 642 vertices",)),
    ("filter sphere.ply new.ply --mask yes.txt", 2, ("is not one number for each vertex",)),
    ("filter sphere.ply new.ply --mask none.npy", 2, ("cannot be read",)),
    ("filter sphere.ply new.ply --box 0,0,0,1,1,1 --selected", 2, ("leave one out",)),
    ("filter sphere.ply new.ply --box 0,0,0,1,1,1 --tiles 2", 1, ("only the whole is filtered",)),
    ("filter sphere.ply new.ply --mesh part --tiles 2", 1, ("leave out mesh, or tiles",)),
    # Batches
    ("batch cow.ply -o new --order 0", 2, ("order",)),
    ("batch cow.ply -o new --name {size}", 2, ("{stem}",)),
    ("batch cow.ply -o new --format mesh3", 2, ("ply",)),
    ("batch cow.ply -o new --workers 0", 2, ("--workers",)),
    ("batch cow.ply -o new --memory-limit much", 2, ("4GB",)),
    ("batch cow.ply -o new --memory-limit 0", 2, ("4GB",)),
    ("batch cow.ply -o new --recipe none.toml", 2, ("none.toml",)),
    ("batch cow.ply -o new --script none.mlx", 2, ("none.mlx",)),
    ("batch cow.ply -o new --scheduler tcp://127.0.0.1:1 --workers 1", 2, ("with a scheduler",)),
    ("batch cow.ply none.ply -o new", 2, ("none.ply",)),
    ("batch cow.ply -o out.ply", 2, ("out.ply is a file",)),
    *((f"batch cow.ply -o new --script {name}", 2, ("script",)) for name in SCRIPTS),
    ("batch cow.ply -o new --denoise --feature-size 2%", 2, ("is not an option of denoise",)),
    ("batch cow.ply -o new --denoise --preset sharpen", 2, ("the preset sharpen is for filter",)),
    ("batch cow.ply -o new --recipe denoise.toml --steps 3", 2, ("not an option of denoise",)),
    ("batch cow.ply -o new --recipe filter.toml --denoise", 2, ("is for filter, not for denoise",)),
    ("batch cow.ply -o new --recipe filter.toml --strength 2", 2, ("not an option of filter",)),
    ("batch cow.ply -o new --strength 2", 2, ("is not an option of filter", "add --denoise")),
    ("batch cow.ply -o new --recipe several.toml", 2, ("several.toml", "has several tables")),
    ("batch cow.ply -o new --recipe unknown.toml", 2, ("there is no option feature_size",)),
    ("batch cow.ply -o new --recipe negative.toml", 2, ("negative.toml", "strength = -1")),
    ("batch cow.ply -o new --recipe outside.toml", 2, ("strength outside it",)),
    ("batch cow.ply -o new --recipe misnamed.toml", 2, ("[filter] or [denoise]",)),
    ("filter cow.ply new.ply --recipe denoise.toml", 2, ("is for denoise, not for filter",)),
    # Harmonics and spectra
    ("basis cow.ply -f -k 5000", 2, ("--basis-size 5000",)),
    ("basis cow.ply -f -k 0", 2, ("--basis-size 0",)),
    ("basis cow.ply -f --boundary loose", 2, ("fixed",)),
    ("basis cow.ply -f -k 10 --modes 3,10", 2, ("mode 10",)),
    ("basis cow.ply -f --modes first", 2, ("first",)),
    ("basis cow.ply -f --pictures sheet.jpg", 2, (".png",)),
    ("basis cow.ply -f --output basis.txt", 2, (".npz",)),
    ("basis cow.ply -f --output nowhere/basis.npz", 1, ("nowhere",)),
    ("basis cow.ply -f --pictures nowhere/sheet.png", 1, ("create it first",)),
    ("spectrum none.ply", 1, ("none.ply",)),
    ("spectrum cow.ply --output plot.jpg", 2, (".png, .pdf or .svg",)),
    ("spectrum cow.ply --output plot", 2, (".png, .pdf or .svg",)),
    ("spectrum cow.ply --output nowhere/plot.png", 1, ("does not exist",)),
    ("spectrum cow.ply --basis-size -1", 2, ("basis-size",)),
    ("spectrum cow.ply --basis-size 100000", 2, ("choose at most",)),
    ("spectrum cow.ply --feature-size 0", 2, ("above zero",)),
    ("spectrum cow.ply --laplacian graph", 2, ("intrinsic delaunay",)),
    ("spectrum cow.ply --steps 3", 2, ("--steps",)),
    # Textures and comparisons
    ("texture sphere.ply --waviness 0.3 --noise 0.4", 2, ("--noise 0.4",)),
    ("texture sphere.ply --waviness=0", 2, ("Error: --waviness: 0: give",)),
    ("texture sphere.ply --nesting-index-l=0", 2, ("Error: --nesting-index-l: 0: give",)),
    ("texture nothing.ply", 1, ("has no faces",)),
    ("texture sphere.ply --output sphere.ply", 2, ("would be lost",)),
    ("compare sphere.ply cow.ply --output cow.ply", 2, ("would be lost",)),
    ("compare sphere.ply cow.ply --output new.obj", 2, (".ply",)),
    ("compare sphere.ply cow.ply --picture new.svg", 2, (".png",)),
    ("compare sphere.ply none.ply", 1, ("none.ply",)),
    ("compare sphere.ply flat.off", 1, ("no face with an area",)),
]


@pytest.mark.parametrize(("line", "code", "words"), REFUSED, ids=[row[0] for row in REFUSED])
def test_a_command_is_refused_with_the_reason(
    line: str, code: int, words: tuple[str, ...], folder: Path
) -> None:
    before = contents(folder)
    assert_fails(command(*shlex.split(line), folder=folder), code, *words)
    assert contents(folder) == before
