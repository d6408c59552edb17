"""The package spectral-mesh of npm, in Node: the same results and errors as in Python."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from calls_of_filters import CALLS, FILTER, SHAPES, Call, Inputs, inputs_named, inputs_of
from meshlab_spectral import _core
from meshlab_spectral.errors import SpectralError
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parents[3]
PACKAGE = REPOSITORY / "build" / "web" / "spectral-mesh"
RUN = REPOSITORY / "tests" / "web" / "run_calls.mjs"
DENOISE = "apply_coord_spectral_denoise"

# Of the size of what is compared. Instruction sets round differently: denoising differs by 8e-16 at
# most, what other filters find by iteration, to tolerances from 1e-5 on, by 3e-9.
ROUND_OFF = 1e-9
ITERATED = 1e-6

# (options, filter, memory limit, change of the mesh)
MISTAKES: list[tuple[str, dict[str, Any], float, str]] = [
    (FILTER, {"feature_size": -3}, 0, ""),
    (FILTER, {"feature_size": "many"}, 0, ""),
    (FILTER, {"feature_size": 2000.5}, 0, ""),
    (FILTER, {"sizes": 3}, 0, ""),
    (FILTER, {"order": 2.5}, 0, ""),
    (FILTER, {"selected": "yes"}, 0, ""),
    (FILTER, {"filter_type": "lowpass"}, 0, ""),
    (FILTER, {"filter_type": "custom", "transfer_function": "1/(1+w^"}, 0, ""),
    (FILTER, {"filter_type": "custom", "transfer_function": "-w"}, 0, ""),
    (FILTER, {"pass_gain": 1e30, "filter_type": "high-pass"}, 0, ""),
    (FILTER, {"spectrum": "truncated", "basis_size": 100000}, 0, ""),
    (FILTER, {"response": "ideal", "laplacian": "cotangent"}, 0, ""),
    (DENOISE, {"strength": -1}, 0, ""),
    (DENOISE, {"noise_height": "50%"}, 0, ""),
    (DENOISE, {}, 0, "no faces"),
    (DENOISE, {}, 0, "bad index"),
    (DENOISE, {}, 0, "not finite"),
    (DENOISE, {}, 0, "no area"),
    (FILTER, {}, 1, ""),
]


def spoiled(inputs: Inputs, how: str) -> Inputs:
    V, F = inputs.V.copy(), inputs.F.copy()
    if how == "no faces":
        F = F[:0]
    if how == "bad index":
        F[1, 2] = len(V)
    if how == "not finite":
        V[5, 1] = np.nan
    if how == "no area":
        V[:] = V[0]
    return inputs._replace(V=V, F=F)


def in_python(call: Call, inputs: Inputs, memory_limit: float = 0) -> dict[str, Any]:
    levels = inputs.levels.astype(float)
    values = levels if "color" in call.name else inputs.quality[:, None]
    _core.set_memory_limit(memory_limit)
    try:
        done = _core.apply(
            call.name, inputs.V, inputs.F, call.options, selected=inputs.selected, values=values
        )
    except SpectralError as error:
        name, code = type(error).__name__, error.code
        return {"error": str(error), "name": name, "code": code, "limit": error.limit}
    finally:
        _core.set_memory_limit(0)
    pairs = done["warnings"]
    texts, codes = [text for _, text in pairs], [code for code, _ in pairs]
    return {**done, "warnings": texts, "warningCodes": codes}


class Runs:
    """Calls in one process of Node."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.calls: list[dict[str, Any]] = []

    def mesh(self, name: str, inputs: Inputs) -> None:
        for key, array in {
            "V": inputs.V,
            "F": inputs.F,
            "values": inputs.quality,
            "levels": inputs.levels.astype(float),
            "selected": inputs.selected,
        }.items():
            np.ascontiguousarray(array).tofile(self.folder / f"{name}.{key}")

    def add(self, call: Call, mesh: str, **more: Any) -> None:
        self.calls.append({"name": call.name, "options": call.options, "mesh": mesh, **more})

    def outcomes(self) -> Iterator[dict[str, Any]]:
        (self.folder / "calls.json").write_text(json.dumps(self.calls), encoding="utf-8")
        command = ["node", str(RUN), str(PACKAGE), str(self.folder)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        for index in range(len(self.calls)):
            result = json.loads((self.folder / f"{index}.json").read_text(encoding="utf-8"))
            for key in ("vertices", "values", "details", "basis"):
                if (file := self.folder / f"{index}.{key}").exists():
                    result[key] = np.fromfile(file)
            yield result


@pytest.fixture
def runs(tmp_path: Path) -> Runs:
    if shutil.which("node") is None or not (PACKAGE / "index.js").exists():
        pytest.skip("no package for JavaScript here: make web, which needs Emscripten")
    return Runs(tmp_path)


def assert_close(name: str, one: NDArray[Any], other: NDArray[Any], share: float) -> None:
    np.testing.assert_array_equal(np.isnan(one), np.isnan(other), err_msg=name)
    scale = np.nanmax(np.abs(other), initial=0.0)
    np.testing.assert_allclose(one, other, rtol=0, atol=share * scale, err_msg=name)


def settled(texts: list[str]) -> list[str]:
    """Leave out estimates of the error of an iteration, which roundings change."""
    return [re.sub(r"(relative error is about) \S+", r"\1", one) for one in texts]


def warnings_of(result: dict[str, Any]) -> list[tuple[str, str]]:
    pairs = zip(result["warningCodes"], settled(result["warnings"]), strict=True)
    return [(code, text) for code, text in pairs if code != "mixed_sizes"]  # an estimate


def assert_agree(call: Call, there: dict[str, Any], here: dict[str, Any]) -> None:
    assert settled([there.get("error", "")]) == settled([here.get("error", "")])
    if "error" in here:
        assert (there["name"], there["code"]) == (here["name"], here["code"])
        return
    share = ROUND_OFF if call.name == DENOISE else ITERATED
    for key in ("vertices", "values"):
        assert (key in there) == (key in here)
        if key in here:
            assert_close(key, there[key], here[key].ravel(), share)
    known = [warnings_of(result) for result in (there, here)]
    assert known[0] == known[1]
    assert there["report"].keys() == here["report"].keys()


def test_every_filter_gives_in_node_what_it_gives_in_python(
    runs: Runs, decimated: Any, samples: Path
) -> None:
    meshes = {name: inputs_named(name, decimated) for name in SHAPES}
    meshes["finer bone"] = inputs_of(*decimated("bone.ply", 6000))
    for name, inputs in meshes.items():
        runs.mesh(name, inputs)
        for call in CALLS:
            runs.add(call, name)
    outcomes = runs.outcomes()
    for inputs in meshes.values():
        for call in CALLS:
            assert_agree(call, next(outcomes), in_python(call, inputs))


def test_mistakes_have_the_same_text_in_node_and_the_next_run_is_right(
    runs: Runs, decimated: Any
) -> None:
    # Of so many faces that an ideal response needs too many harmonics.
    inputs = inputs_named("bunny", lambda name: decimated(name, 2400))
    right = Call(DENOISE, {})
    for how in {mistake[3] for mistake in MISTAKES}:
        runs.mesh(how or "whole", spoiled(inputs, how))
    for name, options, limit, how in MISTAKES:
        runs.add(Call(name, options), how or "whole", memoryLimit=limit)
        runs.add(right, "whole")
    outcomes = runs.outcomes()
    expected = in_python(right, inputs)
    for name, options, limit, how in MISTAKES:
        call = Call(name, options)
        there, here = next(outcomes), in_python(call, spoiled(inputs, how), limit)
        if limit:  # the free memory is in the text
            assert there["code"] == here["code"] == "out_of_memory"
        else:
            assert "error" in here, options
            assert_agree(call, there, here)
        assert_agree(right, next(outcomes), expected)


def test_a_run_is_cancelled_and_the_next_one_is_right(runs: Runs, decimated: Any) -> None:
    inputs = inputs_named("bunny", decimated)
    right = Call(DENOISE, {})
    runs.mesh("whole", inputs)
    runs.add(Call(FILTER, {"basis_update": "full", "steps": 100}), "whole", cancel=True)
    runs.add(right, "whole")
    cancelled, next_one = runs.outcomes()
    assert cancelled["name"] == "AbortError"
    assert_agree(right, next_one, in_python(right, inputs))


def test_a_run_within_64_mebibytes_says_what_it_would_need(runs: Runs) -> None:
    side = 300  # of a grid whose normals alone take more
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side)))
    corner = (x + side * y)[(x < side - 1) & (y < side - 1)]
    lower = np.column_stack([corner, corner + 1, corner + side])
    upper = np.column_stack([corner + 1, corner + side + 1, corner + side])
    V = np.column_stack([x, y, np.zeros(side**2)]) / side
    inputs = inputs_of(V, np.vstack([lower, upper]))
    runs.mesh("large", inputs)
    runs.add(Call(DENOISE, {}), "large", memoryLimit=2**26)
    runs.add(Call(DENOISE, {}), "large")
    refused, accepted = runs.outcomes()
    assert refused["name"] == "MemoryLimitError"
    assert 0 < refused["limit"] < len(inputs.V)
    assert "error" not in accepted
