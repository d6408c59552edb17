"""Numbers in tables are those of the report, in the units beside them."""

from __future__ import annotations

from pathlib import Path

import pytest
from meshlab_spectral.cli import many_files
from meshlab_spectral.cli.report_table import change, length_text


def test_a_length_is_given_in_mean_edges_and_in_percent_of_the_diagonal() -> None:
    assert length_text(0.5, mean_edge=0.25, diagonal=10.0) == "0.5 (2e, 5 %)"


def test_a_change_is_relative_to_what_was_before() -> None:
    assert change(200.0, 150.0) == "200 -> 150 (-25.0%)"
    assert change(0.0, 1.5) == "0 -> 1.5"


@pytest.mark.parametrize(
    ("files", "shown"),
    [(1, "1"), (5, "1 and 4 more (2, 3, 4, 5)"), (6, "1 and 5 more (2, 3, 4, 5, ...)")],
)
def test_dots_stand_for_files_that_a_warning_does_not_name(
    files: int, shown: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    printed: list[str] = []
    monkeypatch.setattr(many_files, "print_warning", printed.append)
    names = [str(number) for number in range(1, files + 1)]
    many_files._print_warnings([{"files": names, "warning": "thin"}], tmp_path)
    assert printed == [f"{shown}: thin"]
