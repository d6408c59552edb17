"""What is to be done with one file, and what came of it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

Outcome = Literal["filtered", "measured", "failed", "unchanged"]


@dataclass(frozen=True)
class Job:
    """What a worker needs to know to deal with one file; plain values, so that it can be sent.

    Attributes
    ----------
    source, target
        Places of the input and the output: absolute paths, or URLs. No target: nothing is written,
        the report is the result.
    name
        Of the output, relative to the folder of the outputs.
    work
        The job of `child`, without its files: "task", and what belongs to it.
    options
        What the work depends on, for the report: two jobs with equal options and equal inputs have
        equal results.
    seconds
        That it may take at most; None: any.
    overwrite
        Whether the output may replace a file that is at its place by then.
    """

    source: str
    target: str | None
    name: str
    work: dict[str, Any] = field(hash=False)
    options: dict[str, Any] = field(hash=False)
    seconds: float | None = None
    overwrite: bool = False


@dataclass(frozen=True)
class FileResult:
    """What came of one file: a line of the report.

    Attributes
    ----------
    outcome
        "filtered": the output is there, whole; "failed": it is as it was before; "unchanged": an
        earlier run had made it, as its report proves. "measured": done, and without an output.
    input, output
        Places: absolute paths, or URLs.
    name
        Of the output, relative to the folder of the outputs.
    reason
        Why it failed, and how to mend it; None if it did not.
    options
        Of the filter; for a MeshLab script its name, SHA-256 and filters.
    report
        Of the filter: numbers and lists, lengths in the units of the mesh. None if it failed.
    warnings
        Where the result fell short of what was asked for, and what to do.
    input_sha256, output_sha256
        Of the files; None where there was none.
    side_files
        What the format keeps beside the output, such as materials and textures: name, relative to
        the output's folder -> SHA-256.
    attempts
        How often it was tried.
    seconds
        That it took, reading and writing included.
    peak_memory
        Bytes that MeshLab's process held at most; None where it was not started or died.
    versions
        Of the package, the plugin, pymeshlab and Python, where it was filtered.
    """

    outcome: Outcome
    input: str
    output: str | None
    name: str
    reason: str | None = None
    options: dict[str, Any] = field(default_factory=dict)
    report: dict[str, Any] | None = None
    warnings: list[str] = field(default_factory=list)
    input_sha256: str | None = None
    output_sha256: str | None = None
    side_files: dict[str, str] = field(default_factory=dict)
    attempts: int = 0
    seconds: float = 0.0
    peak_memory: int | None = None
    versions: dict[str, str] = field(default_factory=dict)

    def as_record(self) -> dict[str, Any]:
        """Give all of it as plain values that JSON can hold."""
        record: dict[str, Any] = _finite(asdict(self))
        return record


def _finite(value: Any) -> Any:
    """Replace what JSON has no word for, NaN and infinities, by None."""
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
