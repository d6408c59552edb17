"""What is wanted of a mesh file, as the child process that does it is told."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshlab_spectral.files.region import Region
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import BasisOptions, SpectrumOptions, TextureOptions
from meshlab_spectral.filters.tables import TABLES

_TABLES = TABLES | {one.TABLE: one for one in (BasisOptions, SpectrumOptions, TextureOptions)}


@dataclass(frozen=True)
class Request:
    """A mesh file, and what to do with it."""

    source: Path
    options: Options | None = None  # of a filter or a measurement; None: a description
    mesh: str | None = None  # the name of the only mesh that counts; None: all
    region: Region | None = None  # what counts, in place of the selection of the file; None: all

    def as_job(self) -> dict[str, Any]:
        """Return plain values; "task" is the name of the options' table, or "info"."""
        task: dict[str, Any] = {"task": "info"}
        if self.options is not None:
            task = {"task": self.options.TABLE, "options": self.options.as_dict()}
        region = None if self.region is None else self.region.given()
        return {**task, "source": str(self.source.absolute()), "mesh": self.mesh, "region": region}

    @classmethod
    def of_job(cls, job: dict[str, Any]) -> Request:
        """Return what `as_job` has turned into plain values."""
        table = _TABLES.get(job["task"])
        options = table.from_dict(job["options"]) if table else None
        region = Region.from_given(job.get("region"))
        return cls(Path(job["source"]), options, job.get("mesh"), region)
