"""The tables of options are as the core describes its filters."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

WRITER = Path(__file__).parents[3] / "python" / "write_options.py"


def test_the_tables_of_options_are_those_of_the_core() -> None:
    if not WRITER.exists():
        pytest.skip("there is no source tree")
    command = [sys.executable, str(WRITER), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
