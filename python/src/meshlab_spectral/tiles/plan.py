"""The folder of a run: its plan, and the files of each tile. An interrupted run goes on from it."""

from __future__ import annotations

import contextlib
import json
import secrets
import shutil
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.tables import TABLES
from meshlab_spectral.tiles.cells import Tree

_PLAN, _SCATTERED = "plan.json", "scattered"


@dataclass(frozen=True)
class Plan:
    """What all tiles have in common."""

    # The input, and its size and time of change.
    source: str
    stamp: list[int]
    # The name of the filter's table, and its options, as from `as_dict`.
    filter: str
    options: dict[str, Any]
    lengths: list[float]  # of the whole mesh: diagonal, mean edge, and diagonal of the surface
    has_selection: bool  # whether only what is selected moves
    # The cells, how many there are, and how far each tile goes beyond its cell.
    tree: Tree
    tiles: int
    reach: float
    versions: dict[str, str]  # what the result depends on

    def options_of_filter(self) -> Options:
        """Return the options of the filter."""
        return TABLES[self.filter].from_dict(self.options)


class Workspace:
    """The files of a run in a folder, which need not exist yet."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def plan(self) -> Plan:
        """Return the plan of the run."""
        return Plan(**json.loads((self.folder / _PLAN).read_text()))

    def has_begun(self, plan: Plan) -> bool:
        """Whether the faces have been handed to the tiles of this very plan."""
        try:
            same = self.plan() == Plan(**json.loads(json.dumps(asdict(plan))))
        except (OSError, ValueError, TypeError):
            return False
        return same and (self.folder / _SCATTERED).exists()

    @contextlib.contextmanager
    def removed_if_not_begun(self) -> Iterator[None]:
        """Remove the folder after an error, unless another run can go on from it."""
        try:
            yield
        except BaseException:
            if not (self.folder / _SCATTERED).exists():
                shutil.rmtree(self.folder, ignore_errors=True)
            raise

    def begin(self, plan: Plan) -> None:
        """Write the plan."""
        write_whole(self.folder / _PLAN, json.dumps(asdict(plan)).encode())

    def set_scattered(self) -> None:
        """Note that all faces have been handed out."""
        (self.folder / _SCATTERED).touch()

    def file(self, tile: int, kind: str) -> Path:
        """Return the file of a tile: "faces", "chosen", "ids", "xyz", "normals" or "json"."""
        return self.folder / f"{tile}.{kind}"

    def report(self, tile: int) -> dict[str, Any] | None:
        """Return the report of a tile; None unless it is done."""
        try:
            report: dict[str, Any] = json.loads(self.file(tile, "json").read_text())
        except (OSError, ValueError):
            return None
        return report


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Write a file, whole or not at all, even if another worker of a cluster writes the same."""
    beside = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
    beside.write_bytes(content)
    beside.replace(path)
