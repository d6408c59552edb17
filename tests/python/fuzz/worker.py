"""Runs filters on described meshes and checks what the plugin promises: `python worker.py`.

It reads examples from standard input, one JSON object per line, and answers each with a JSON line:
"outcome" ("result" or "error"), "text" of the error, "warnings", and "failures", which should be
empty. It never destroys a MeshSet, since pymeshlab may crash after an error: end it from time to
time.
"""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import meshlab_spectral
import numpy as np
import pymeshlab
from fuzz.meshes import ATTRIBUTE, mesh_set_of
from fuzz.parameters import for_pymeshlab
from helpers import snapshot
from meshlab_spectral.plugin.library import last_warnings
from meshlab_spectral.plugin.mesh_sets import reason_of

# What a filter may write; nothing else changes, even where it succeeds.
TARGETS = {
    "apply_coord_spectral_filter_fractional": {
        "vertex_matrix",
        "vertex_normal_matrix",
        "face_normal_matrix",
    },
    "apply_coord_spectral_denoise": {"vertex_matrix", "vertex_normal_matrix", "face_normal_matrix"},
    "apply_coord_spectral_equalizer": {
        "vertex_matrix",
        "vertex_normal_matrix",
        "face_normal_matrix",
    },
    "apply_scalar_spectral_filter_per_vertex": {"vertex_scalar_array"},
    "apply_color_spectral_filter_per_vertex": {"vertex_color_matrix"},
    "compute_scalar_spectral_artefacts_per_vertex": {"vertex_scalar_array", "vertex_color_matrix"},
    "compute_scalar_manifold_harmonic_per_vertex": {"vertex_scalar_array", "vertex_color_matrix"},
    "get_geometry_spectrum": set(),
    "compute_scalar_surface_texture_per_vertex": {"vertex_scalar_array", "vertex_color_matrix"},
}
# An error ends with what to do, or names an option with its range.
REMEDY = re.compile(
    r"[Cc]hoose|apply |load or create|scale the mesh|reconstruct|delete them|must be|lies between|"
    r"has the modes|a positive number|must be finite|above zero|[Mm]ust be a value between|"
    r"Possible values|between 0 and 100|select faces or|Select the side|give at most|"
    r"give points as|to one unit"
)
# These have no remedy other than to look at the mesh.
PLAIN = re.compile(r"zero area: the mesh is a line or a point")
NO_NUMBER = re.compile(r"\b(nan|inf|-nan|-inf)\b")

_kept: list[pymeshlab.MeshSet] = []


def _everything(mesh_set: pymeshlab.MeshSet) -> dict[str, np.ndarray]:
    mesh = mesh_set.current_mesh()
    found = snapshot(mesh)
    found["transform"] = np.array(mesh.transform_matrix())
    if mesh.vertex_number() > 0:
        found[ATTRIBUTE] = np.array(mesh.vertex_custom_scalar_attribute_array(ATTRIBUTE))
    return found


def _bits(array: np.ndarray) -> bytes:
    return np.ascontiguousarray(array).tobytes()


def _differences(
    before: dict[str, np.ndarray], after: dict[str, np.ndarray], but: set[str]
) -> list[str]:
    return [
        name
        for name in sorted(before.keys() | after.keys())
        if name not in but
        and (
            name not in before
            or name not in after
            or before[name].shape != after[name].shape
            or _bits(before[name]) != _bits(after[name])
        )
    ]


class _Log:
    """What MeshLab prints on standard output."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile("w+b")  # noqa: SIM115
        os.dup2(self._file.fileno(), 1)

    def take(self) -> str:
        self._file.seek(0)
        text = self._file.read().decode("utf-8", "replace")
        self._file.seek(0)
        self._file.truncate()
        return text


class Run:
    """One call of a filter on a new mesh."""

    def __init__(self, example: dict[str, Any], log: _Log) -> None:
        name = example["filter"]
        mesh_set = mesh_set_of(example["mesh"])
        _kept.append(mesh_set)
        # Read from a twin: reading a mesh would pack its deleted elements.
        twin = mesh_set_of(example["mesh"])
        self.before = _everything(twin)
        self.report: dict[str, Any] = {}
        self.text, self.is_ours, self.warnings = "", True, []
        log.take()
        try:
            self.report = mesh_set.apply_filter(name, **for_pymeshlab(example["parameters"])) or {}
            self.warnings = last_warnings()
        except pymeshlab.PyMeshLabException as error:
            self.text = reason_of(error) or "NO TEXT"
        except (pymeshlab.InvalidEnumException, pymeshlab.InvalidPercentageException) as error:
            self.text = str(error)
        except Exception as error:
            self.text, self.is_ours = f"{type(error).__name__}: {error}", False
        self.log = log.take()
        self.after = _everything(mesh_set)

    @property
    def numbers(self) -> dict[str, bytes]:
        """All bits of the result, by name."""
        report = {key: np.asarray(value) for key, value in self.report.items()}
        return {key: _bits(value) for key, value in (self.after | report).items()}


def _failures(example: dict[str, Any], run: Run, again: Run) -> list[str]:
    found = []
    if run.text:
        found += [f"changed by an error: {name}" for name in _changed(run, set())]
        if not run.is_ours:
            found.append(f"no exception of pymeshlab: {run.text}")
        elif "unexpected" in run.text or "NO TEXT" in run.text:
            found.append(f"unexpected: {run.text}")
        elif not (REMEDY.search(run.text) or PLAIN.search(run.text)):
            found.append(f"no remedy: {run.text}")
    else:
        found += _failures_of_result(example, run)
    if run.text != again.text or run.numbers.keys() != again.numbers.keys():
        found.append("not repeatable")
    else:
        different = [key for key, bits in run.numbers.items() if bits != again.numbers[key]]
        found += [f"not repeatable: {key}" for key in different]
    return found


def _changed(run: Run, targets: set[str]) -> list[str]:
    return _differences(run.before, run.after, targets)


def _failures_of_result(example: dict[str, Any], run: Run) -> list[str]:
    details = example["parameters"].get("result") == 1
    shown = {"vertex_scalar_array", "vertex_color_matrix"}
    targets = shown if details else TARGETS[example["filter"]]
    found = [f"changed besides the target: {name}" for name in _changed(run, targets)]
    for name in sorted(targets):
        # MeshLab leaves normals of zero-area faces undefined.
        if name not in run.after or "normal" in name:
            continue
        values, before = run.after[name], run.before.get(name)
        if before is not None and values.shape != before.shape:
            found.append(f"another size: {name}")
            continue
        # A quality that lacks, which is NaN, stays.
        if not (np.isfinite(values) | (before is not None and np.isnan(before))).all():
            found.append(f"not finite: {name}")
    for name, value in run.report.items():
        if not np.isfinite(np.asarray(value, float)).all():
            found.append(f"not finite in the report: {name} = {value}")
    if example["filter"].startswith("apply") and not details:
        found += [
            f"changed at an unreferenced vertex: {name}"
            for name in sorted(targets)
            if "normal" not in name and not _unreferenced_stay(run, name)
        ]
    numbers = [line for line in run.log.splitlines() if NO_NUMBER.search(line)]
    # pymeshlab prints the parameters as they were given.
    found += [f"no number in the log: {line}" for line in numbers if not line.startswith("{")]
    found += [f"a poor warning: {text!r}" for text in run.warnings if len(text) < 20]
    return found


def _unreferenced_stay(run: Run, name: str) -> bool:
    F, values = run.before["face_matrix"], run.before[name]
    lonely = np.setdiff1d(np.arange(len(values)), F)
    return _bits(values[lonely]) == _bits(run.after[name][lonely])


def main() -> None:
    """Answer examples until the end of the input."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    log = _Log()
    meshlab_spectral.load()
    for line in sys.stdin:
        example = json.loads(line)
        run = Run(example, log)
        answer = {
            "outcome": "error" if run.text else "result",
            "text": run.text,
            "warnings": run.warnings,
            "failures": _failures(example, run, Run(example, log)),
        }
        answers.write(json.dumps(answer) + "\n")
    answers.flush()
    os._exit(0)  # without destroying a MeshSet


if __name__ == "__main__":
    main()
