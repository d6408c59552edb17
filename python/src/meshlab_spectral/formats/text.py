"""Lines of text files: reading numbers, and replacing them in place; both in C++."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.formats.causes import EndsEarlyError, unreadable
from meshlab_spectral.formats.document import Array, Indices

# Ascending byte offsets of n places, words from there to k numbers, the numbers in the text and the
# new ones (n x k), and significant digits.
Change = tuple[Indices, int, Array, Array, int]
BYTE_ORDER_MARK = b"\xef\xbb\xbf"  # of UTF-8; some editors put it before a text
_END = re.compile(rb"[\r\n]")
_COMMENT = re.compile(rb"#[^\r\n]*")
_LONGEST_SIZE = 12  # characters of the size of a list, of at most 32 bits, and a blank
# Elements: which of their numbers are lists, behind their sizes, and how many rows there are.
Layout = Sequence[tuple[Sequence[bool], int]]
NumberList = tuple[Indices, Array]  # the sizes of a list in each line, and all items


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines of a text that have words.

    `starts` are the byte offsets of their first words, `words` how many they have, `kinds` the
    indices of their keywords: the number of keywords for any other first word.
    """

    text: bytes
    starts: Indices
    words: NDArray[np.int32]
    kinds: NDArray[np.uint8]
    comments: bool  # whether # begins a comment
    continued: int = 0  # lines of so many keywords go on after a final backslash

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, which: slice | NDArray[Any]) -> Lines:
        """Return some of the lines."""
        columns = {name: getattr(self, name)[which].copy() for name in ("starts", "words", "kinds")}
        return replace(self, **columns)

    def line(self, number: int) -> bytes:
        """Return one of the lines from its first word on, with its comment."""
        start = int(self.starts[number])
        end = _END.search(self.text, start)
        return self.text[start : end.start() if end else None]

    def words_of(self, number: int) -> list[bytes]:
        """Return the words of one of the lines."""
        line = self.line(number)
        return (line.partition(b"#")[0] if self.comments else line).split()

    def line_number(self, number: int) -> int:
        """Return which line of the text one of the lines is, from 1."""
        newline, carriage_return, both = (
            self.text.count(end, 0, int(self.starts[number])) for end in (b"\n", b"\r", b"\r\n")
        )
        return newline + carriage_return - both + 1

    def table(
        self, are_lists: Sequence[bool], first: int = 0, is_whole: bool = False
    ) -> tuple[Array, list[NumberList], int, int]:
        """Read numbers and lists of numbers, which follow their sizes, from word `first` on.

        Returns n x k numbers, the lists, and the first line that lacks some of them or, with
        `is_whole`, has other words behind them, or -1, with the number or list that it lacks.
        """
        return _core.text_numbers(
            self.text,
            self.starts,
            self.words,
            first,
            are_lists,
            self.comments,
            self.continued,
            is_whole,
        )

    def numbers(self, path: Path, first: int = 0, count: int = 3) -> Array:
        """Return `count` numbers of each line from word `first` on, n x count.

        Raises MeshFileError, which names the line, when a word is missing or is not a number.
        """
        values, _, bad, _ = self.table([False] * count, first)
        if bad >= 0:
            row = b" ".join(self.words_of(bad)).decode(errors="replace")[:80]
            reason = f"row {bad} is {row!r}, which lacks the {count} numbers required"
            raise unreadable(path, self.fault(bad, reason))
        return values

    def fault(self, number: int, reason: str) -> ValueError:
        """Return the error for one of the lines: the text may end within it."""
        ends = _END.search(self.text, int(self.starts[number])) is None
        return EndsEarlyError(reason) if ends else ValueError(reason)


def lines_of(
    text: bytes,
    keywords: Sequence[str] = (),
    *,
    begin: int = 0,
    limit: int = sys.maxsize,
    comments: bool = False,
    any_case: bool = False,
    continued: int = 0,
) -> Lines:
    """Return the lines that have words, at most `limit` of them, from byte offset `begin` on.

    `keywords` are first words to tell apart, in small letters with `any_case`. Lines of the first
    `continued` of them go on after a backslash at their end.
    """
    if not begin and text.startswith(BYTE_ORDER_MARK):
        begin = len(BYTE_ORDER_MARK)
    found = _core.text_lines(text, begin, limit, keywords, comments, any_case, continued)
    return Lines(text, *found, comments, continued)


def rows_in_any_lines(lines: Lines, start: int, *layouts: Layout) -> Iterator[Lines]:
    """Yield the rows of a text by their words from a byte offset on, whatever lines they are in.

    Of each layout that fits all words.
    """
    text = lines.text
    if lines.comments:
        text = _COMMENT.sub(lambda comment: b" " * len(comment[0]), text)
    bytes_ = np.frombuffer(text, np.uint8)[start:]
    is_blank = np.isin(bytes_, np.frombuffer(b" \t\n\r\v\f", np.uint8))
    found = start + np.flatnonzero(~is_blank & np.append(True, is_blank[:-1]))
    del is_blank, bytes_
    for layout in layouts:
        first, words, at = list[Indices](), list[Indices](), 0
        try:
            for are_lists, count in layout:
                if any(are_lists):
                    sizes = np.array(_sizes_of_rows(text, found, at, are_lists, count), np.int64)
                else:
                    sizes = np.full(count, len(are_lists))
                first.append(found[at + np.cumsum(sizes) - sizes])
                words.append(sizes)
                at += int(sizes.sum())
        except (ValueError, IndexError):
            continue
        if at == len(found):
            all_words = np.concatenate(words).astype(np.int32)
            kinds = np.zeros(len(all_words), np.uint8)
            yield replace(lines, starts=np.concatenate(first), words=all_words, kinds=kinds)


def _sizes_of_rows(
    text: bytes, found: Indices, at: int, are_lists: Sequence[bool], count: int
) -> list[int]:
    """Return how many words each of an element's rows has, the first of which is word `at`."""
    sizes = list[int]()
    for _ in range(count):
        begin = at
        for is_list in are_lists:
            if is_list:
                start = int(found[at])
                at += max(0, int(text[start : start + _LONGEST_SIZE].split(maxsplit=1)[0]))
            at += 1
        sizes.append(at - begin)
    return sizes


def numbers_from(text: bytes, begin: int, count: int, what: str) -> Array:
    """Return so many numbers from a byte offset on; raise ValueError if there are fewer."""
    most = min(count, len(text) - begin)  # each takes a byte or more
    words = np.array([most], np.int32)
    all_ = Lines(text, np.array([begin]), words, np.zeros(1, np.uint8), comments=False)
    values, _, bad, found = all_.table([False] * most)
    if bad >= 0 or most < count:
        reason = f"it has {found if bad >= 0 else most} numbers of {count} in {what}"
        at_end = not text[begin:].strip(b"0123456789.+-eE \t\r\n")
        raise EndsEarlyError(reason) if at_end else ValueError(reason)
    numbers: Array = values[0]
    return numbers


def write_patched(file: IO[bytes], text: bytes, changes: Sequence[Change], begin: int = 0) -> None:
    """Write a text, from a byte offset on, with those numbers that have changed replaced.

    A number ends at a blank or #, and one that begins after a quotation mark at the next one.
    """
    _core.write_patched(text, begin, changes, file.write)


def as_integers(numbers: Array) -> Indices:
    """Return numbers as integers; raise ValueError if one is none."""
    with np.errstate(invalid="ignore"):
        integers = numbers.astype(np.int64)
    wrong = integers != numbers
    if wrong.any():
        raise ValueError(f"{numbers[wrong][0]:g} is not an integer")
    return integers
