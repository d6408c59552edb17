"""OFF files, and the words and numbers of all text formats that are patched in place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import SINGLE, digits_for
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    Part,
    check_vertices,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.polygons import triangles
from meshlab_spectral.errors import MeshFileError

Bools = NDArray[np.bool_]

_LONGEST = 18  # digits that 64 bits hold
_LARGEST_EXACT = 2**53  # among the integers that are doubles without gaps
_POWERS = np.array([10.0**k for k in range(23)])  # exact
_BLOCK = 2**16
_HEADER = re.compile(rb"(?:ST|[CN4n])*OFF")


class Lines:
    """The words of a text by lines; lines without words are left out.

    Attributes
    ----------
    words
        Where each word begins and ends in the text, n x 2.
    first, count
        The index of each line's first word, and how many words it has.
    """

    def __init__(self, path: Path, text: bytes):
        self.path, self.text = path, text
        self.letters = np.frombuffer(text, np.uint8)
        edges = np.diff(self.letters <= ord(" "), prepend=True, append=True)
        self.words: Indices = np.flatnonzero(edges).reshape(-1, 2)
        ends = np.searchsorted(self.words[:, 0], np.flatnonzero(self.letters == ord("\n")))
        bounds = np.concatenate([[0], ends, [len(self.words)]])
        count = np.diff(bounds)
        self.first, self.count = bounds[:-1][count > 0], count[count > 0]
        self._begin, end = self.words[self.first].T
        self._length = end - self._begin

    def beginning(self, word: bytes) -> Indices:
        """Return the indices of the lines whose first word this is."""
        lines: Indices = np.flatnonzero(self._length == len(word))
        for k, letter in enumerate(word):
            lines = lines[self.letters[self._begin[lines] + k] == letter]
        return lines

    def columns(self, lines: Indices, begin: int, end: int) -> Indices:
        """Return the words `begin` to `end` - 1 of lines, which must have as many."""
        short = self.count[lines] < end
        if short.any():
            line = self.line_number(self._begin[lines[np.argmax(short)]])
            raise unreadable(self.path, f"line {line} has less than {end - begin} numbers")
        columns: Indices = self.first[lines][:, None] + np.arange(begin, end)
        return columns

    def numbers(self, words: Indices) -> Array:
        """Return words as numbers, in an array of the same shape."""
        bounds = self.words[words.ravel()]
        blocks = [self._numbers(*block.T) for block in _blocks(bounds)]
        return np.concatenate(blocks).reshape(words.shape)

    def _numbers(self, begin: Indices, end: Indices) -> Array:
        stop, power = self._exponents(begin, end)
        digits, places, negative, is_decimal = self._decimals(begin, stop)
        shift = np.maximum(places, 0) - power
        most = len(_POWERS) - 1
        # The nearest double, since both the digits and the power of ten are doubles.
        values: Array = (
            digits / _POWERS[np.clip(shift, 0, most)] * _POWERS[np.clip(-shift, 0, most)]
        )
        values[negative] *= -1
        is_exact = is_decimal & (digits <= _LARGEST_EXACT) & (abs(shift) <= most)
        for i in np.flatnonzero(~is_exact).tolist():
            values[i] = self._number(int(begin[i]), int(end[i]))
        return values

    def _exponents(self, begin: Indices, end: Indices) -> tuple[Indices, Indices]:
        """Return where exponents such as e-05, of two or three digits, begin, and their values."""
        stop, power = end.copy(), np.zeros_like(end)
        for size in (4, 5):
            rows = np.flatnonzero(end - begin > size)
            rows = rows[self.letters[end[rows] - size] | 32 == ord("e")]
            sign = self.letters[end[rows] - size + 1]
            digits, places, negative, is_decimal = self._decimals(end[rows] - size + 2, end[rows])
            known = is_decimal & ~negative & (places < 0) & np.isin(sign, list(b"+-"))
            stop[rows[known]] -= size
            power[rows[known]] = np.where(sign == ord("-"), -digits, digits)[known]
        return stop, power

    def _number(self, begin: int, end: int) -> float:
        try:
            return float(self.text[begin:end])
        except ValueError:
            raise self.misplaced(begin, "a number") from None

    def integers(self, begin: Indices, end: Indices) -> Indices:
        """Return the integers between positions of the text."""
        bounds = np.column_stack([begin, end])
        return np.concatenate([self._integers(*block.T) for block in _blocks(bounds)])

    def _integers(self, begin: Indices, end: Indices) -> Indices:
        digits, places, negative, is_decimal = self._decimals(begin, end)
        wrong = ~is_decimal | (places >= 0)
        if wrong.any():
            raise self.misplaced(int(begin[np.argmax(wrong)]), "an integer")
        return np.where(negative, -digits, digits)

    def _decimals(self, begin: Indices, end: Indices) -> tuple[Indices, Indices, Bools, Bools]:
        """Parse words such as -12.5.

        Returns
        -------
        digits
            Without the point, as an integer.
        places
            How many of them follow the point; -1 where there is none.
        negative, is_decimal
            Whether a minus comes first; whether the word is a decimal, and not too long.
        """
        negative = self.letters[begin] == ord("-")
        at = begin + negative
        digits, point = np.zeros_like(at), end.copy()
        empty, wrong = np.ones_like(negative), np.zeros_like(negative)
        for _ in range(min(int((end - at).max(initial=0)), _LONGEST)):
            inside = at < end
            letter = self.letters[np.where(inside, at, begin)]
            digit = letter - np.uint8(ord("0"))
            is_digit = inside & (digit <= 9)
            is_point = inside & (letter == ord(".")) & (point == end)
            digits = np.where(is_digit, 10 * digits + digit, digits)
            point = np.where(is_point, at, point)
            empty &= ~is_digit
            wrong |= inside & ~is_digit & ~is_point
            at += 1
        return digits, end - 1 - point, negative, ~(wrong | empty | (at < end))

    def misplaced(self, position: int, expected: str) -> MeshFileError:
        """Return the error for a word at a position of the text where another belongs."""
        word = self.text[position : position + 40].split()[0].decode(errors="replace")
        line = self.line_number(position)
        return unreadable(self.path, f"line {line} has {word!r} where {expected} belongs")

    def line_number(self, position: int) -> int:
        """Return the number, from 1, of the line with a position of the text."""
        return self.text.count(b"\n", 0, position) + 1


def _blocks(rows: Indices) -> list[Indices]:
    """Split rows into blocks that stay in the processor's cache."""
    return np.array_split(rows, 1 + len(rows) // _BLOCK)


def without_comments(text: bytes) -> bytes:
    """Replace comments, from # to the end of a line, by as many blanks."""
    return re.sub(rb"#[^\n]*", lambda match: b" " * len(match[0]), text)


def ranges(begins: Indices, sizes: Indices) -> Indices:
    """Return begin, ..., begin + size - 1 of all ranges, one after the other."""
    offsets = np.cumsum(sizes) - sizes
    numbers: Indices = np.repeat(begins - offsets, sizes) + np.arange(sizes.sum())
    return numbers


def with_numbers(text: bytes, *changes: tuple[Indices, Array, Array, int]) -> bytes:
    """Return a text in which the numbers that have changed are replaced.

    Parameters
    ----------
    text
        The text.
    changes
        Where numbers begin and end in it, ... x 2; what they were; what they become; and how many
        significant digits that needs.
    """
    changed = [(before != after) & ~np.isnan(after) for _, before, after, _ in changes]
    chosen = list(zip(changes, changed, strict=True))
    places = np.concatenate([place[which] for (place, _, _, _), which in chosen])
    values = np.concatenate([after[which] for (_, _, after, _), which in chosen])
    digits = np.concatenate([np.full(which.sum(), count) for (_, _, _, count), which in chosen])
    order = np.argsort(places[:, 0])
    return b"".join(_pieces(text, places[order], values[order], digits[order]))


def _pieces(text: bytes, places: Indices, values: Array, digits: Indices) -> Iterator[bytes]:
    """Yield what stays of a text and the numbers in between, many at a time."""
    done = 0
    for rows in _blocks(np.arange(len(values))):
        pairs = zip(digits[rows].tolist(), values[rows].tolist(), strict=True)
        numbers = (b"%.*g " * len(rows) % tuple(chain.from_iterable(pairs))).split()
        begins, ends = places[rows].T.tolist()
        kept = [text[b:e] for b, e in zip([done, *ends], begins, strict=False)]
        yield b"".join(chain.from_iterable(zip(kept, numbers, strict=True)))
        done = ends[-1] if ends else done
    yield text[done:]


@dataclass(kw_only=True)
class _Off(Document):
    text: bytes
    places: Indices  # of coordinates and normals in the text, n x 3 x 2 or n x 6 x 2
    normals: Array | None

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,) = self.parts, moved
        before = part.vertices
        digits = digits_for(before, after)
        changes = [(self.places[:, :3], before, after, digits)]
        if self.normals is not None:
            normals = following_normals(before, after, part.faces, self.normals)
            changes.append((self.places[:, 3:], self.normals, normals, SINGLE))
        target.write_bytes(with_numbers(self.text, *changes))
        return []


def read(path: Path) -> Document:
    """Read an OFF file, of text, with vertices in three dimensions.

    Raises
    ------
    MeshFileError
        When it is damaged, or of another kind.
    """
    text = path.read_bytes()
    commented = b"#" in text
    lines = Lines(path, without_comments(text) if commented else text)
    header = _header(lines)
    line, vertices, faces = _counts(lines)
    normal, colour, texture = (kind in header for kind in (b"N", b"C", b"ST"))
    width = 3 + 3 * normal + 2 * texture
    words, line = _vertex_words(lines, line, vertices, faces, width, colour)
    values = lines.numbers(words[:, : 3 + 3 * normal])
    V, normals = values[:, :3], values[:, 3:] if normal else None
    check_vertices(path, V)
    corners, sizes, coloured = _polygons(lines, line, faces, vertices)
    held = {
        "normals": normal,
        "colours": colour,
        "texture coordinates": texture,
        "face colours": coloured,
        "polygons": (sizes > 3).any(),
        "lines and points": (sizes < 3).any(),
        "comments": commented,
    }
    return _Off(
        path=path,
        parts=[Part("", V, triangles(corners, sizes, V))],
        contents=[name for name, is_held in held.items() if is_held],
        text=text,
        places=lines.words[words[:, : values.shape[1]]],
        normals=normals,
    )


def _header(lines: Lines) -> bytes:
    """Return the keyword, such as CNOFF; raise MeshFileError for a file that has another layout."""
    begin, end = lines.words[0] if len(lines.words) else (0, 0)
    header = lines.text[begin:end]
    if not _HEADER.fullmatch(header):
        raise unreadable(lines.path, "its first word is not OFF, COFF, NOFF or the like")
    remedy = "save it as OFF with x y z, or as PLY, in the program that made it"
    if b"n" in header or b"4" in header:
        raise unsupported(lines.path, "has vertices of other than three coordinates", remedy)
    if lines.text[end : end + 20].split()[:1] == [b"BINARY"]:
        raise unsupported(lines.path, "is a binary OFF file", remedy)
    return header


def _counts(lines: Lines) -> tuple[int, int, int]:
    """Return the line after the counts, and how many vertices and faces there are."""
    line = 0 if lines.count[0] > 1 else 1
    begin = 1 - line
    if len(lines.first) == line:
        raise unreadable(lines.path, "it ends after its first line")
    words = lines.columns(np.array([line]), begin, begin + 2)[0]
    vertices, faces = lines.integers(*lines.words[words].T).tolist()
    left = int(lines.count[line + 1 :].sum())
    # Each vertex has three numbers at least, and each face one.
    if vertices < 1 or faces < 0 or 3 * vertices + faces > left:
        raise unreadable(
            lines.path, f"it claims {vertices} vertices and {faces} faces, and has {left} numbers"
        )
    return line + 1, vertices, faces


def _vertex_words(
    lines: Lines, line: int, vertices: int, faces: int, width: int, coloured: bool
) -> tuple[Indices, int]:
    """Return the words of vertices, vertices x width, and the line after them."""
    rows = np.arange(line, line + vertices)
    has_lines = line + vertices + faces <= len(lines.first)
    if has_lines and (coloured or (lines.count[rows] >= width).all()):
        return lines.columns(rows, 0, width), line + vertices
    words = lines.first[line] + np.arange(vertices * width).reshape(-1, width)
    # Vertices may share lines, unless they have colours, whose number may differ.
    if coloured or words[-1, -1] >= len(lines.words):
        raise unreadable(lines.path, f"it ends before the last of {vertices} vertices")
    return words, int(np.searchsorted(lines.first, words[-1, -1], side="right"))


def _polygons(lines: Lines, line: int, faces: int, vertices: int) -> tuple[Indices, Indices, bool]:
    """Return the corners of all faces, the number of each face's, and whether there are colours."""
    left = len(lines.first) - line
    if faces > left:
        raise unreadable(lines.path, f"it claims {faces} faces, and has {left} lines of them")
    rows = np.arange(line, line + faces)
    first, count = lines.first[rows], lines.count[rows]
    sizes = lines.integers(*lines.words[first].T)
    wrong = (sizes < 0) | (sizes >= count)
    if wrong.any():
        position = lines.words[first[np.argmax(wrong)], 0]
        raise lines.misplaced(position, "the number of the corners that follow")
    begin, end = lines.words[ranges(first + 1, sizes)].T
    corners = lines.integers(begin, end)
    outside = (corners < 0) | (corners >= vertices)
    if outside.any():
        raise lines.misplaced(begin[np.argmax(outside)], f"one of {vertices} vertices, from 0,")
    return corners, sizes, bool((count > sizes + 1).any())
