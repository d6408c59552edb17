"""The gallery is true: every call that it shows runs."""

from __future__ import annotations

import re
from pathlib import Path

import meshlab_spectral
import numpy as np
import plugin_facts
import pyvista

GALLERY = Path(plugin_facts.__file__).with_name("gallery.rst")


def test_every_call_of_the_gallery_runs() -> None:
    text = GALLERY.read_text(encoding="utf-8")
    calls = re.findall(r"^   ``([a-z_]+\(.*?\))``", text, flags=re.MULTILINE | re.DOTALL)
    assert len(calls) == text.count(".. figure::")
    ball = pyvista.Icosphere(nsub=3)
    V, F = np.asarray(ball.points, dtype=np.float64), ball.regular_faces
    names = {name: getattr(meshlab_spectral, name) for name in meshlab_spectral.__all__}
    names |= {"V": V, "F": F, "faces": np.arange(100), "values": V[:, 0], "feature_size": 0.5}
    names["colors"] = np.abs(V)
    for call in calls:
        eval(call.replace("\n", " "), names)
