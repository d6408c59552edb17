"""The page's log names no filter of MeshLab."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
ADVICE = REPOSITORY / "plugin" / "core" / "contract" / "advice.cpp"
WORDS = REPOSITORY / "plugin" / "web" / "page" / "words.js"
OF_QUALITIES = ("Per Vertex Quality Function",)  # which the page does not filter
OF_MESHLAB = r"'[A-Z][^']*'"


def test_every_advice_that_names_a_filter_of_meshlab_is_in_the_pages_words() -> None:
    if shutil.which("node") is None:
        pytest.skip("no Node here")
    source = re.sub(r'"\s*\n\s*"', "", ADVICE.read_text(encoding="utf-8"))
    # What is put together from several: the number of vertices that fit stands before the name.
    texts = [
        text for text in re.findall(r'"((?:[^"\\]|\\.)*)"', source) if re.search(OF_MESHLAB, text)
    ]
    texts = [text for text in texts if not any(name in text for name in OF_QUALITIES)]
    assert len(texts) > 5
    script = f"import {{inOwnWords}} from '{WORDS.as_uri()}'; console.log(JSON.stringify("
    script += f"{json.dumps(texts)}.map(inOwnWords)))"
    command = ["node", "--input-type=module", "--eval", script]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert [text for text in json.loads(done.stdout) if re.search(OF_MESHLAB, text)] == []
