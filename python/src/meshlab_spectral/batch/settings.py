"""Settings of a batch: parameters of `filter_files`, and options of the commands for many files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from meshlab_spectral.batch.outputs import DEFAULT_PATTERN
from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.option_types import option
from meshlab_spectral.filters.options import DenoiseKeywords, FilterKeywords
from meshlab_spectral.plugin.limits import given_memory_limit, threads


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of a batch."""

    name: str = option(
        DEFAULT_PATTERN,
        "Names of the outputs, without extension, made from those of the inputs: {stem}, "
        "{ending}, {folder}; such as {stem}_smooth or {folder}/{stem}.",
        metavar="PATTERN",
    )
    ending: str | None = option(
        None,
        "Format of the outputs, such as ply. By default that of the input, or ply if MeshLab "
        "cannot write that with faces.",
        flags=("--format",),
        metavar="ENDING",
    )
    recursive: bool = option(
        False,
        "Also search subfolders of the inputs, and keep their structure.",
        flags=("--recursive", "-r"),
    )
    joined: bool = option(
        False,
        "The files are one surface cut into parts, such as tiles of a terrain or labels: filter "
        "them together, in one worker; where their borders coincide, they move alike.",
        flags=("--joined",),
    )
    overwrite: bool = option(
        False,
        "Replace existing outputs, even ones created meanwhile; inputs are never replaced.",
        flags=("--overwrite", "--force", "-f"),
    )
    resume: bool = option(
        False,
        "Continue an earlier run: skip what the report proves done with the same input, options "
        "and versions; replace outputs changed since.",
        flags=("--resume",),
    )
    script: Path | None = option(
        None,
        "Apply a MeshLab filter script (.mlx) instead of the options. Sizes in it are lengths, not "
        "percentages.",
        metavar="FILE",
    )
    report: Path | None = option(
        None,
        "The report, one JSON object per line; appended to if it exists. By default next to the "
        "outputs.",
        metavar="FILE",
    )
    workers: int | None = option(
        None, "Files processed at once. By default one per processor.", range="at least 1"
    )
    memory_limit: int | None = option(
        None,
        "Memory limit per worker, such as 4GB (in Python, bytes). By default, the workers share "
        "nine tenths of the machine's, and each keeps to MESHLAB_SPECTRAL_MEMORY.",
        metavar="SIZE",
    )
    timeout: float | None = option(
        None, "Time limit per file in seconds. By default none.", range="at least 1"
    )
    scheduler: str | None = option(
        None,
        "Use the workers of the Dask cluster with a scheduler such as host:8786; they must see the "
        "files under the same paths. Excludes a number of workers and a memory limit.",
        metavar="ADDRESS",
    )

    def check_workers(self) -> None:
        """Raise OptionError when both new workers and those of a cluster are requested.

        Also when a limit of the environment counts, but is invalid, and when a cluster or a script
        is to filter joined files.
        """
        if self.scheduler is not None and (self.workers, self.memory_limit) != (None, None):
            raise OptionError(
                "a cluster configures its own workers: with a scheduler, leave out the number of "
                "workers and the memory limit"
            )
        if self.joined and (self.scheduler, self.script) != (None, None):
            raise OptionError(
                "joined files are filtered in one process of this machine, by the options of the "
                "filter: leave out the scheduler and the script"
            )
        if self.scheduler is None:
            threads()
            if self.memory_limit is None:
                given_memory_limit()


class SettingsKeywords(TypedDict, total=False):
    """All fields of `Settings`."""

    name: str
    ending: str | None
    recursive: bool
    joined: bool
    overwrite: bool
    resume: bool
    script: str | Path | None
    report: str | Path | None
    workers: int | None
    memory_limit: int | None
    timeout: float | None
    scheduler: str | None


class BatchKeywords(FilterKeywords, SettingsKeywords, total=False):
    """Those of `filter_files`."""


class DenoiseBatchKeywords(DenoiseKeywords, SettingsKeywords, total=False):
    """Those of `denoise_files`."""
