"""A job for one file, and its result."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from meshlab_spectral.files.request import Request
from meshlab_spectral.plugin.versions import versions

Outcome = Literal["filtered", "unchanged", "measured", "failed", "already done"]


@dataclass(frozen=True)
class Job:
    """Everything a worker needs to process one file, as plain values that can be sent to it."""

    source: str  # absolute path or URL of the input
    target: str | None  # that of the output; None: the report is the result
    name: str  # that of the output, relative to the output folder
    request: Request  # what to do, with whichever file
    # For the report, what the result depends on: equal options and inputs give equal results.
    options: dict[str, Any] = field(hash=False)
    seconds: float | None = None  # time limit
    overwrite: bool = False  # whether the output may replace an existing file

    def result(self, outcome: Outcome, **more: Any) -> FileResult:
        """Return the result of this job; `more` are the attributes not known to the job."""
        return FileResult(
            outcome, self.source, self.target, self.name, options=self.options, **more
        )

    def failed(self, reason: str, attempts: int) -> FileResult:
        """Return the result when no worker could do it."""
        return self.result("failed", reason=reason, attempts=attempts, versions=versions())


@dataclass(frozen=True)
class FileResult:
    """The result for one file: a line of the report.

    Attributes
    ----------
    outcome
        "filtered": the output was written; "unchanged": likewise, but no vertex moved, for example
        because there is no noise; "measured": done, without an output; "failed": the output path is
        untouched; "already done": the report proves that an earlier run wrote the output.
    input, output
        Absolute paths or URLs.
    name
        Name of the output, relative to the output folder.
    reason
        Why it failed and how to fix it; None if it did not fail.
    options
        Options of the filter; for a MeshLab script its name, SHA-256 and filters.
    report
        The filter's report, as from `filter_mesh`; for a script see `script.apply_script`. None if
        the filter failed.
    warnings
        All warnings in the report: problems that were not errors, and what to do about them.
    warning_codes
        For each, what it is about.
    input_sha256, output_sha256
        SHA-256 of the files; None if missing.
    side_files
        Files that belong to the output, such as materials and textures: name relative to the
        output's folder -> SHA-256.
    attempts
        Number of attempts.
    seconds
        Time taken, including reading and writing.
    peak_memory
        Peak memory of MeshLab's process in bytes; None if it did not start or died.
    versions
        Versions of this package, the plugin, pymeshlab and Python that filtered the file.
    """

    outcome: Outcome
    input: str
    output: str | None
    name: str
    reason: str | None = None
    options: dict[str, Any] = field(default_factory=dict)
    report: dict[str, Any] | None = None
    warnings: list[str] = field(default_factory=list)
    warning_codes: list[str] = field(default_factory=list)
    input_sha256: str | None = None
    output_sha256: str | None = None
    side_files: dict[str, str] = field(default_factory=dict)
    attempts: int = 0
    seconds: float = 0.0
    peak_memory: int | None = None
    versions: dict[str, str] = field(default_factory=dict)

    def as_record(self) -> dict[str, Any]:
        """Convert to plain values that JSON can represent."""
        record: dict[str, Any] = _finite(asdict(self))
        return record


def _finite(value: Any) -> Any:
    """Replace NaN and infinities, which JSON cannot represent, by None."""
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
