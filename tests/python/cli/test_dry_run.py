"""`filter --dry-run` and `denoise --dry-run`: what would be done, and nothing is."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from batches import make_meshes
from commands import PRECIOUS, command, succeeded

SIZES = {
    "filter": ["feature_size", "tolerance", "max_displacement"],
    "denoise": ["noise_height", "noise_size", "max_displacement"],
}


@pytest.mark.parametrize("verb", ["filter", "denoise"])
def test_nothing_is_written_and_sizes_have_the_units_of_the_file(verb: str, tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1)
    record = json.loads(succeeded(verb, scan, tmp_path / "out.ply", "--dry-run", "--json").stdout)
    (surface,) = record["intent"]["surfaces"]
    assert list(surface["sizes"]) == SIZES[verb]
    assert (surface["vertices"], surface["faces"]) == (144, 288)
    assert record["output"] == str(tmp_path / "out.ply")
    assert record["intent"]["tiles"] == 0
    assert 0 < record["intent"]["memory"] < record["intent"]["available_memory"]
    assert list(tmp_path.iterdir()) == [scan]


@pytest.mark.parametrize("more", [[], ["--json"]])
def test_a_size_below_the_edges_is_warned_of_as_by_the_run(more: list[str], tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1)
    arguments = ["filter", scan, tmp_path / "out.ply", "--overwrite", *more]
    for dry in ([], ["--dry-run"]):
        done = command(*arguments, "--feature-size", "0.1%", *dry)
        words = r"feature size \S+ is below|feature size \S+, which is below"
        assert re.search(words, done.stderr)
    edge, two = re.findall(r"edge length (\S+): choose at least two edges, (\S+)\.", done.stderr)[0]
    assert float(two) == pytest.approx(2 * float(edge), rel=0.01)
    assert "is below" not in command(*arguments, "--dry-run").stderr


@pytest.mark.parametrize("size", ["auto", "3%", "4e", "0.25"])
def test_the_sizes_are_those_that_the_run_applies(size: str, tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1)
    arguments = ["filter", scan, tmp_path / "out.ply", "--json", "--feature-size", size]
    intent = json.loads(command(*arguments, "--dry-run").stdout)["intent"]
    report = json.loads(command(*arguments).stdout)["report"]
    assert intent["surfaces"][0]["sizes"]["feature_size"] == pytest.approx(
        report["feature_size"], rel=1e-6
    )
    assert intent["surfaces"][0]["mean_edge"] == pytest.approx(report["mean_edge"], rel=1e-6)


def test_in_words_it_says_where_the_output_goes_and_how(tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1)
    out = tmp_path / "out.obj"
    out.write_bytes(PRECIOUS)
    done = succeeded("filter", scan, out, "--dry-run", "--overwrite", "--where", "x > 0", "-q")
    assert f"{out} would be replaced anew by MeshLab, as a whole" in done.stdout
    assert "of 144, and some around them" in done.stdout
    assert out.read_bytes() == PRECIOUS
    same = command("filter", scan, tmp_path / "out.ply", "--dry-run", "--tiles", 2).stdout
    assert "would be written with all else kept, in 2 tiles" in same
    assert {path.name for path in tmp_path.iterdir()} == {scan.name, "out.obj"}
