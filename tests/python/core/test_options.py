"""The tables of options are as the core describes its filters."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from meshlab_spectral import _core

WRITER = Path(__file__).parents[3] / "python" / "write_options.py"


def test_the_tables_of_options_are_those_of_the_core() -> None:
    if not WRITER.exists():
        pytest.skip("there is no source tree")
    command = [sys.executable, str(WRITER), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("word", "names"),
    [
        ("spectral", {one["name"] for one in _core.filters()}),
        ("smooth", {"Spectral Filter (Fractional)", "Spectral Denoise"}),
        ("noise", {"Spectral Denoise"}),
        ("frequency", {"Spectral Filter (Fractional)", "Manifold Harmonics"}),
        ("artifact", {"Spectral Artefacts"}),
    ],
)
def test_meshlabs_search_finds_filters_by_the_words_of_their_users(
    word: str, names: set[str]
) -> None:
    # It knows the words of names and helps, and what they begin with.
    found = {
        one["name"]
        for one in _core.filters()
        for each in re.findall(r"[a-z]+", f"{one['name']} {one['help']}".lower())
        if each.startswith(word)
    }
    assert names <= found
