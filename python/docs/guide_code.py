"""Sphinx: runs the code of the guides, each in an empty folder, so that they work as they stand.

The directive `presets` lists the presets.

Blocks of `python` and `sh` are run in the order of the page, `python` in one interpreter; other
blocks are only shown.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from docutils import nodes
from meshlab_spectral.files.presets import PRESETS
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

_BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_RUNNER = """
import json, subprocess, sys
names = {"__name__": "guide"}
for language, code in json.load(sys.stdin):
    print(code, flush=True)  # the last one is that which fails
    if language == "python":
        exec(code, names)
    else:
        subprocess.run(["bash", "-euo", "pipefail", "-c", code], check=True)
"""


def run_page(page: Path) -> None:
    """Run a page's code; raise ExtensionError with what was printed when it fails."""
    blocks = _BLOCK.findall(page.read_text(encoding="utf-8"))
    with TemporaryDirectory() as folder:
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        own = {"PATH": path, "HOME": folder, "XDG_CONFIG_HOME": folder, "MPLBACKEND": "agg"}
        done = subprocess.run(
            [sys.executable, "-c", _RUNNER],
            input=json.dumps(blocks),
            cwd=folder,
            env={**os.environ, **own},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
    if done.returncode != 0:
        raise ExtensionError(f"the code of {page.name} fails:\n{done.stdout}")


def run_guides(app: Sphinx) -> None:
    """Run all of them before the pages are read."""
    for page in sorted(Path(app.srcdir, "guides").glob("*.md")):
        run_page(page)


class Presets(SphinxDirective):
    """A list of all presets: name, command, purpose, options."""

    def run(self) -> list[nodes.Node]:
        """Write the list."""
        listed = nodes.bullet_list()
        for name, (table, purpose, options) in PRESETS.items():
            item = nodes.paragraph()
            item += [nodes.literal(text=name), nodes.Text(f", {table.TABLE}: {purpose} (")]
            item += nodes.literal(
                text=", ".join(f"{key}={value}" for key, value in options.items())
            )
            item += nodes.Text(")")
            listed += nodes.list_item("", item)
        return [listed]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hook and the directive."""
    app.connect("builder-inited", run_guides)
    app.add_directive("presets", Presets)
    return {"parallel_read_safe": True}
