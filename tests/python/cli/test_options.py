"""The options of `meshlab-spectral filter`: each reaches the filter, wrong ones are named."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from commands import arrays_of, assert_fails, command
from helpers import FILTER, percent
from meshlab_spectral import FilterOptions


def test_every_option_reaches_the_filter(cow: Path, tmp_path: Path) -> None:
    options: dict[str, Any] = {
        "filter_type": "band-pass",
        "feature_size": "12%",
        "selected": False,
        "transfer_function": "5%:1, 1%:0.5",
        "response": "butterworth",
        "order": 3,
        "band_width": 1.5,
        "pass_gain": 2.0,
        "stop_gain": 1.0,
        "power": 0.5,
        "steps": 2,
        "tolerance": "0.1%",
        "basis_update": "conformal",
        "conformal_share": 0.25,
        "spectrum": "truncated",
        "basis_size": 60,
        "reinject_residual": False,
        "laplacian": "cotangent",
        "boundary": "fixed",
        "crease_angle": 120.0,
        "preserve_volume": True,
        "weight": "none",
    }
    assert options.keys() == FilterOptions().as_dict().keys()
    arguments: list[object] = []
    for name, value in options.items():
        option = name.replace("_", "-")
        if isinstance(value, bool):
            arguments.append(f"--{option}" if value else f"--no-{option}")
        else:
            arguments += [f"--{option}", value]
    target = tmp_path / "cow.ply"
    done = command("filter", cow, target, "--json", *arguments)
    assert json.loads(done.stdout)["options"] == options
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(cow))
    mesh_set.apply_filter(
        FILTER, **{**options, "feature_size": percent(12), "tolerance": percent(0.1)}
    )
    V, _ = arrays_of(target)
    np.testing.assert_array_equal(V, mesh_set.current_mesh().vertex_matrix())


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--feature-size", "0"], "feature-size"),
        (["--feature-size", "-5%"], "feature-size"),
        (["--feature-size", "big"], "5%"),
        (["--feature-size", "150%"], "100%"),
        (["--filter-type", "lowpass"], "low-pass"),
        (["--response", "bessel"], "butterworth"),
        (["--order", "0"], "order"),
        (["--order", "2.5"], "order"),
        (["--band-width", "0"], "band_width"),
        (["--pass-gain", "-1"], "pass_gain"),
        (["--stop-gain", "nan"], "stop_gain"),
        (["--steps", "-1"], "steps"),
        (["--basis-size", "0"], "basis_size"),
        (["--basis-update", "sometimes"], "conformal"),
        (["--no-such-option"], "--no-such-option"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_option_is_named_before_any_file_is_touched(
    arguments: list[str], word: str, existing: Path, tmp_path: Path
) -> None:
    done = command("filter", tmp_path / "no such.ply", existing, *arguments)
    assert_fails(done, 2, word)


def test_a_missing_argument_is_a_usage_error(cow: Path) -> None:
    assert_fails(command("filter", cow), 2, "OUTPUT")


def test_help_names_every_option_and_the_exit_codes() -> None:
    done = command("filter", "--help")
    assert done.returncode == 0
    for name in FilterOptions().as_dict():
        assert f"--{name.replace('_', '-')}" in done.stdout
    assert "130 interrupted" in done.stdout
    assert "--debug" not in done.stdout


def test_version_names_the_package_and_pymeshlab() -> None:
    done = command("--version")
    assert done.returncode == 0
    assert re.fullmatch(r"meshlab-spectral \d+\.\d+\.\d+, pymeshlab 2025\.7\.post1\n", done.stdout)


def test_pip_installs_the_command_under_its_name() -> None:
    installed = Path(sys.executable).with_name("meshlab-spectral")
    done = subprocess.run(
        [installed, "--version"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.startswith("meshlab-spectral ")
