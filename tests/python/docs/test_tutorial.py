"""Tutorial and gallery are true: their code runs, and prints the numbers that they show."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import Any

import meshlab_spectral
import numpy as np
import plugin_facts
import pyvista

TUTORIAL = Path(plugin_facts.__file__).with_name("tutorial.rst")
GALLERY = TUTORIAL.with_name("gallery.rst")


def test_the_code_of_the_tutorial_runs_and_its_numbers_are_true() -> None:
    text = TUTORIAL.read_text(encoding="utf-8")
    blocks = re.findall(r"\.\. code-block:: python\n\n((?:   .*\n|\n)+)", text)
    assert len(blocks) > 6
    names: dict[str, Any] = {}
    for block in blocks:
        exec(textwrap.dedent(block), names)
    spectrum, error = names["spectrum"], names["error"]
    table = re.findall(r"^ +([\d.]+) % +([\d.]+) %", text, flags=re.MULTILINE)
    heights = 100 * spectrum.octave_amplitudes / spectrum.diagonal
    np.testing.assert_allclose([float(height) for _, height in table], heights, atol=1e-3)
    assert f"{spectrum.noise_height / spectrum.mean_edge:.2f}" == "0.19"
    assert f"{100 * spectrum.noise_feature_size / spectrum.diagonal:.1f}" == "3.2"
    assert [f"{error(names[x]):.2f}" for x in ("scan", "smooth", "clean")] == [
        "0.32",
        "0.27",
        "0.27",
    ]
    assert names["spectral"].geometry_spectrum(names["smooth"], names["F"]).noise_height == 0
    assert np.abs(names["details"] - (names["scan"] - names["smooth"])).max() < 1e-12


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
