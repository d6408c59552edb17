"""Grouping the warnings of many files."""

from __future__ import annotations

from meshlab_spectral.batch.report import grouped_warnings


def test_warnings_that_differ_in_numbers_are_one() -> None:
    groups = grouped_warnings(
        {
            "b.ply": ["12 vertices are near 1.5e-7 others", "something else"],
            "a.ply": ["3 vertices are near 2 others"],
            "c.glb": ["mesh 0: too coarse", "mesh 1: too coarse"],
        }
    )
    assert groups == [
        {"warning": "3 vertices are near 2 others", "files": ["a.ply", "b.ply"]},
        {"warning": "something else", "files": ["b.ply"]},
        {"warning": "mesh 0: too coarse", "files": ["c.glb"]},
    ]


def test_no_warnings_are_no_groups() -> None:
    assert grouped_warnings({}) == []
    assert grouped_warnings({"a.ply": []}) == []
