"""A picture does not outlive what it shows: its numbers are those that the program computes now."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import draw
import pytest
import shown
from figure_numbers import FILE, Numbers, differences, record, recorded
from shared_types import SharedMesh

SCREENSHOTS = Path(__file__).resolve().parents[3] / "screenshots"
NAMES = [*draw.PICTURES, *shown.PICTURES]


def computed(name: str, mesh: Callable[[str], Path]) -> Numbers:
    if name in shown.PICTURES:
        return shown.PICTURES[name](mesh)
    return draw.PICTURES[name](mesh).numbers


def test_every_picture_is_made_by_a_script_and_has_numbers() -> None:
    pictures = {path.name for path in SCREENSHOTS.glob("*.png")}
    assert pictures == {f"{name}.png" for name in NAMES}
    assert pictures == recorded(SCREENSHOTS).keys()
    assert all(recorded(SCREENSHOTS).values())


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_picture_shows_what_the_program_computes(name: str, shared_mesh: SharedMesh) -> None:
    changed = differences(recorded(SCREENSHOTS)[f"{name}.png"], computed(name, shared_mesh))
    lines = "\n".join(["`make screenshots` redraws it; look at it", *changed])
    assert not changed, lines


def test_numbers_are_recorded_picture_by_picture_to_three_digits(tmp_path: Path) -> None:
    record(tmp_path / "b.png", {"angle": 12.3456})
    record(tmp_path / "a.png", {"angle": 1.0})
    record(tmp_path / "b.png", {"angle": 0.123456})
    assert recorded(tmp_path) == {"a.png": {"angle": 1.0}, "b.png": {"angle": 0.123}}
    assert [path.name for path in tmp_path.iterdir()] == [FILE]
    assert (tmp_path / FILE).read_text().index("a.png") < (tmp_path / FILE).read_text().index("b.")


@pytest.mark.parametrize(
    ("before", "now", "changed"),
    [
        ({"angle": 10.0}, {"angle": 10.1}, False),
        ({"angle": 10.0}, {"angle": 10.3}, True),
        ({"angle": -10.0}, {"angle": 10.0}, True),
        ({"angle": 0.0}, {"angle": 1e-5}, False),
        ({"angle": 0.0}, {"angle": 1e-3}, True),
        ({"angle": 10.0}, {"angle": float("nan")}, True),
        ({"angle": 10.0}, {}, True),
        ({}, {"angle": 10.0}, True),
    ],
)
def test_numbers_differ_where_a_picture_does(before: Numbers, now: Numbers, changed: bool) -> None:
    assert [line.split(":")[0] for line in differences(before, now)] == ["angle"] * changed
