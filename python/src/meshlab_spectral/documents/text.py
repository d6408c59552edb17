"""Lines of text files: reading numbers, and replacing them in place."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from itertools import chain
from pathlib import Path

import numpy as np

from meshlab_spectral.documents.document import Array, unreadable

Words = Sequence[bytes]


def numbers(path: Path, rows: Sequence[Words], first: int = 0, count: int = 3) -> Array:
    """Return the words `first` to `first + count - 1` of each row as numbers, n x count.

    Raises MeshFileError, which names the row, when a word is missing or is not a number.
    """
    chosen = [row[first : first + count] for row in rows]
    try:
        values = np.array(list(map(float, chain.from_iterable(chosen))))
        return values.reshape(len(rows), count)
    except ValueError:
        for number, words in enumerate(chosen):
            if len(words) < count or not all(map(_is_number, words)):
                told = b" ".join(rows[number]).decode(errors="replace")[:80]
                raise unreadable(
                    path, f"row {number} is {told!r}, which lacks the {count} numbers required"
                ) from None
        raise


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def with_numbers(
    line: bytes, first: int, before: Sequence[float], after: Sequence[float], digits: int
) -> bytes:
    """Return a line in which those of three numbers that have changed are replaced.

    They begin at word `first`, from 0; other words and all whitespace are kept. `before` are the
    three numbers in the line, `after` the new ones, written with `digits` significant digits.
    """
    found = _three_words(first).match(line)
    assert found is not None
    pieces = list(found.groups())
    for k in range(3):
        if before[k] != after[k]:
            pieces[2 * k + 1] = b"%.*g" % (digits, after[k])
    return b"".join(pieces) + line[found.end() :]


def replace_numbers(
    lines: list[bytes], where: Sequence[int], first: int, before: Array, after: Array, digits: int
) -> None:
    """Replace the three numbers from word `first` on in those lines where they have changed."""
    rows = np.flatnonzero((before != after).any(axis=1))
    for k, old, new in zip(rows.tolist(), before[rows].tolist(), after[rows].tolist(), strict=True):
        lines[where[k]] = with_numbers(lines[where[k]], first, old, new, digits)


@cache
def _three_words(first: int) -> re.Pattern[bytes]:
    return re.compile(rb"(\s*(?:\S+\s+){%d})(\S+)(\s+)(\S+)(\s+)([^\s#]+)" % first)
