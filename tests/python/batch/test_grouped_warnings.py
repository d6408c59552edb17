"""Grouping the warnings of many files."""

from __future__ import annotations

import json
import pickle
import re
from pathlib import Path

import meshlab_spectral
from meshlab_spectral import _core
from meshlab_spectral.batch.report import grouped_warnings
from meshlab_spectral.warned import KINDS, Warned, warned, with_warnings

SOURCE = Path(meshlab_spectral.__file__).parent


def test_warnings_that_differ_in_numbers_alone_are_one() -> None:
    near, coarse = "nearly_joined", "below_edges"
    unused = [Warned("unused_option", f"{name} has no effect") for name in ("order", "passes")]
    groups = grouped_warnings(
        {
            "b.ply": [Warned(near, "12 vertices near 1.5e-7 others"), Warned("x", "3 vertices")],
            "a.ply": [Warned(near, "3 vertices near 2e-7 others"), *unused],
            "c.glb": [Warned(coarse, "0: too coarse"), Warned(coarse, "1: too coarse")],
        }
    )
    assert groups == [
        {"code": near, "warning": "3 vertices near 2e-7 others", "files": ["a.ply", "b.ply"]},
        *({"code": "unused_option", "warning": one, "files": ["a.ply"]} for one in unused),
        {"code": "x", "warning": "3 vertices", "files": ["b.ply"]},
        {"code": coarse, "warning": "0: too coarse", "files": ["c.glb"]},
    ]


def test_every_code_in_the_source_is_explained_and_no_other() -> None:
    source = "".join(path.read_text() for path in SOURCE.rglob("*.py"))
    assert set(re.findall(r'Warned\(\s*"(\w+)"', source)) == KINDS.keys()
    assert not KINDS.keys() & _core.warning_kinds().keys()


def test_a_warning_keeps_its_code_on_the_way_to_another_process() -> None:
    report = with_warnings({}, [Warned("labels", "are they?").of("a.ply")])
    assert report == {"warnings": ["a.ply: are they?"], "warning_codes": ["labels"]}
    for sent in (pickle.loads(pickle.dumps(report)), json.loads(json.dumps(report))):
        assert [(one, one.code) for one in warned(sent)] == [("a.ply: are they?", "labels")]


def test_no_warnings_are_no_groups() -> None:
    assert grouped_warnings({}) == []
    assert grouped_warnings({"a.ply": []}) == []
