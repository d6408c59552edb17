"""Includes between the folders of plugin/core are acyclic, as plugin/README.md says."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).resolve().parents[2] / "plugin" / "core"
# What a folder may include besides itself.
ARROWS = {
    "support": set(),
    "mesh": {"support"},
    "ldlt": {"support"},
    "laplacian": {"mesh", "ldlt", "support"},
    "transfer": {"mesh", "support"},
    "krylov": {"laplacian", "ldlt", "mesh", "support"},
    "harmonics": {"laplacian", "ldlt", "mesh", "support"},
    "graph": {"mesh", "support"},
    "noise": {"graph", "mesh", "support"},
    "denoise": {"noise", "graph", "krylov", "laplacian", "mesh", "support"},
    "filter": {"transfer", "krylov", "harmonics", "laplacian", "ldlt", "mesh", "support"},
    "analysis": {
        "filter",
        "noise",
        "transfer",
        "krylov",
        "harmonics",
        "laplacian",
        "ldlt",
        "mesh",
        "support",
    },
    "contract": {
        "analysis",
        "denoise",
        "noise",
        "filter",
        "transfer",
        "laplacian",
        "mesh",
        "support",
    },
    "examples": {"filter"},
}


def sources(folder: Path) -> list[Path]:
    return [*folder.rglob("*.h"), *folder.rglob("*.cpp")]


def test_every_folder_of_the_core_is_listed() -> None:
    assert {path.name for path in CORE.iterdir() if path.is_dir()} == ARROWS.keys()


def test_folders_of_the_core_include_only_what_their_arrows_allow() -> None:
    offending = []
    for source in sources(CORE):
        folder = source.parent.name
        for included in re.findall(r'#include "([^"]+)"', source.read_text(encoding="utf-8")):
            root, _, rest = included.partition("/")
            assert root == "core", f"{source}: write {included} from core/ on"
            if rest.partition("/")[0] not in ARROWS[folder] | {folder}:
                offending.append(f"{source.relative_to(CORE)} includes {included}")
    assert offending == []
