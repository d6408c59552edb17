"""Numbers in text are read as Python's float reads them, and written as % writes them."""

from __future__ import annotations

import html
import io
import locale
import math
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from helpers import mesh_set_of
from hypothesis import example, given
from hypothesis import strategies as st
from meshlab_spectral import _core
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.text import lines_of, write_patched

doubles = st.floats(allow_nan=True, allow_infinity=True)
formats = st.sampled_from(["%r", "%.3g", "%.9g", "%.17g", "%.25e", "%f", "%+.6e", "%E", "0%.4f"])
printed = st.builds(lambda form, value: form % value, formats, doubles)
scribbled = st.text("0123456789+-.eEinfatyx(),", min_size=1, max_size=12)
long = st.builds("".join, st.lists(st.sampled_from(["0", "7", "9" * 40, "0" * 400]), min_size=1))
odd = st.builds(
    lambda sign, whole, part, power: f"{sign}{whole}.{part}e{power}",
    *(st.sampled_from(["", "+", "-"]), long, long, st.integers(-1200, 1200)),
)


def float_of(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def number_in(word: str) -> float | None:
    """Read a word of a line as the documents do; None if it is no number."""
    numbers, _, bad, _ = lines_of(f"{word} \r\n".encode()).table([False], is_whole=True)
    return None if bad >= 0 else float(numbers[0, 0])


@given(printed | scribbled | odd)
@example("+1")
@example("+-1")
@example("++1")
@example("1,5")
@example("0x10")
@example("nan(1)")
@example("1e400")
@example("-1e-400")
@example("5e-324")
@example("1e999999999999")
@example("0e999999999999")
@example("infinity")
def test_a_word_is_the_number_that_python_reads(word: str) -> None:
    expected, found = float_of(word), number_in(word)
    assert (expected is None) == (found is None)
    if expected is not None:
        assert repr(expected) == repr(found)


@given(st.lists(doubles.filter(math.isfinite), min_size=1), st.sampled_from([9, 17]))
def test_a_number_is_written_as_python_writes_it(values: list[float], digits: int) -> None:
    text = "\n".join("v ? # 7" for _ in values).encode()
    before, after = np.full((len(values), 1), math.nan), np.array(values)[:, None]
    written = patched(text, lines_of(text).starts, 1, before, after, digits)
    assert written == b"\n".join(b"v %.*g # 7" % (digits, value) for value in values)
    if digits == 17:
        assert [float(line.split()[1]) for line in written.splitlines()] == values


def patched(
    text: bytes, starts: object, first: int, before: Array, after: Array, digits: int
) -> bytes:
    file = io.BytesIO()
    write_patched(file, text, [(starts, first, before, after, digits)])  # type: ignore[list-item]
    return file.getvalue()


words = st.text("v1#\\x.", min_size=1, max_size=3)
blanks = st.text(" \t\v\f", min_size=1, max_size=2)
ends = st.sampled_from(["\n", "\r\n", "\r", "\n\n", " \n\t"])
texts = st.lists(words | blanks | ends).map("".join)


@given(texts, st.booleans())
def test_lines_and_words_are_those_that_python_splits(text: str, comments: bool) -> None:
    rows = [
        (line.partition(b"#")[0] if comments else line).split()
        for line in text.encode().splitlines()
    ]
    lines = lines_of(text.encode(), ["v", "x"], comments=comments)
    assert [lines.words_of(k) for k in range(len(lines))] == [row for row in rows if row]
    assert lines.words.tolist() == [len(row) for row in rows if row]
    kinds = {b"v": 0, b"x": 1}
    assert lines.kinds.tolist() == [kinds.get(row[0], 2) for row in rows if row]


finite = doubles.filter(math.isfinite)
pairs = st.tuples(finite, finite) | finite.map(lambda x: (x, x))  # before and after
triples = st.lists(st.lists(pairs, min_size=3, max_size=3), min_size=1, max_size=5)
gaps = st.text(" \t\v\f", max_size=3)


@given(triples, gaps, st.sampled_from(["", " 1 2", "#c", " # 1.5"]), ends)
def test_a_patched_text_is_the_old_one_but_for_the_numbers_that_changed(
    rows: list[list[tuple[float, float]]], gap: str, rest: str, end: str
) -> None:
    form = f"{gap}v\t{{}} {{}} {gap}{{}}{rest}{end}"
    old, new = np.moveaxis(np.array(rows), 2, 0).copy()
    text = "".join(form.format(*(repr(a) for a, _ in row)) for row in rows)
    expected = "".join(
        form.format(*(repr(a) if a == b else f"{b:.9g}" for a, b in row)) for row in rows
    )
    lines = lines_of(text.encode(), comments=True)
    np.testing.assert_array_equal(lines.numbers(Path("a"), 1), old)
    assert patched(text.encode(), lines.starts, 1, old, new, 9) == expected.encode()


def test_a_place_outside_of_the_text_is_refused() -> None:
    one = np.ones((1, 1))
    for place in (-1, 3):
        with pytest.raises(ValueError, match="not within"):
            patched(b"1 2", np.array([place]), 0, one, 2 * one, 9)


@given(st.lists(st.sampled_from([0.0, -0.0, 1.0, math.inf]) | doubles, min_size=2).map(np.array))
def test_equal_rows_are_found(values: Array) -> None:
    rows = values[: len(values) // 2 * 2].reshape(-1, 2)
    first = [
        next(j for j in range(i + 1) if np.array_equal(rows[j], rows[i], equal_nan=True))
        for i in range(len(rows))
    ]
    assert _core.first_equal_rows(rows).tolist() == first


def test_equal_rows_are_found_soon_among_short_and_missing_numbers() -> None:
    side = np.arange(700.0)
    rows = np.stack(np.meshgrid(side, side, [0.0, math.nan]), axis=-1).reshape(-1, 3)
    assert (
        _core.first_equal_rows(np.vstack([rows, rows])) == np.tile(np.arange(len(rows)), 2)
    ).all()
    assert not _core.first_equal_rows(np.full((10**6, 3), math.nan)).any()


# A comment, character data and an instruction may hold what looks like elements.
OTHERS = [
    "<a>7</a>",
    "<!--<v x='1'/>-->",
    "<![CDATA[<v x='1'/>]]>",
    "<?a <v x='1'/>?>",
    "<vx/>",
    " ",
]
EMPTY = ["<v x='1' y='2' z='3'/>", '<v\nz="-1e3"\ty = "2" x="&#49;"/>', "<v/>"]
EMPTY += ["<n:v x='.5' a='>' y='/' z='' />"]
FULL = ["<v x='1'></v>", "<v y='1'><a x='2'/></v>", "<n:a v='3'/>", "<a><v/></a>"]
pieces = st.sampled_from([*OTHERS, *EMPTY, *FULL])


@given(st.lists(pieces).map("".join))
def test_elements_are_those_of_the_document(inner: str) -> None:
    text = f"<r xmlns:n='n'>{inner}</r>"
    ((values, places),), rest = _core.xml_elements(text.encode(), [("v", ("x", "y", "z"))])
    elements = [one for one in ElementTree.fromstring(text).iter() if one.tag in ("v", "{n}v")]
    assert len(values) == len(elements)
    for row, (place, element) in enumerate(zip(places.tolist(), elements, strict=True)):
        for k, name in enumerate("xyz"):
            given = element.get(name)
            assert (place[k] < 0) == (given is None)
            if given is not None:
                raw = text[place[k] : text.index(text[place[k] - 1], place[k])]
                assert html.unescape(raw) == given
                number = float_of(raw)
                np.testing.assert_equal(values[row, k], math.nan if number is None else number)
    runs = [one.attrib for one in ElementTree.fromstring(rest).iter() if one.tag in ("v", "{n}v")]
    rows = [row for run in runs for row in range(int(run["begin"]), int(run["end"]))]
    assert rows == list(range(len(values)))


@pytest.mark.parametrize("extra", ["a='\x01'", "a='\xe9'", "a:b='1'", "a='&b;'", "\xe9='1'"])
def test_unusual_characters_stay_for_the_parser(extra: str) -> None:
    text = f"<r><v x='1'/><v x='2' {extra}/><v x='3'/></r>".encode()
    ((values, _),), rest = _core.xml_elements(text, [("v", ("x", "y", "z"))])
    assert values[:, 0].tolist() == [1, 2, 3]
    assert f"""<v begin="1" end="2" x='2' {extra}/>""".encode() in rest


@pytest.mark.parametrize(
    "tag", ["<v x='1' x='2'/>", "<v x='1'y='2'/>", "<v x=1/>", "<v x='1'", "<v x='<'/>"]
)
def test_what_is_not_well_formed_stays_for_the_parser(tag: str) -> None:
    text = f"<r><v x='1'/>{tag}</r>".encode()
    ((values, _),), rest = _core.xml_elements(text, [("v", ("x", "y", "z"))])
    assert len(values) == 1
    assert rest.endswith(f"{tag}</r>".encode())


# The peak is that of the process itself: getrusage's may be its parent's.
STATUS = Path("/proc/self/status")
MEASURED = """
    import re, sys
    from pathlib import Path
    from meshlab_spectral.formats.opening import open_document

    for name in sys.argv[1:]:
        path = Path(name)
        before = int(re.search("VmHWM:(.*)kB", Path("/proc/self/status").read_text())[1])
        document = open_document(path)
        document.save(path.with_stem("out"), [part.vertices * 1.001 for part in document.parts])
    after = int(re.search("VmHWM:(.*)kB", Path("/proc/self/status").read_text())[1])
    print(1024 * (after - before))  # of the last one
"""


def write_sheet(path: Path, side: int) -> int:
    """Let pymeshlab write side x side vertices as text; return its length."""
    index = np.arange(side * side).reshape(side, side)
    F = np.column_stack([index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[:-1, 1:].ravel()])
    meshes = mesh_set_of(np.random.default_rng(1).normal(0, 1, (side * side, 3)), F)
    is_text = {"binary": False} if path.suffix in (".ply", ".stl") else {}
    before = locale.setlocale(locale.LC_ALL)
    meshes.save_current_mesh(str(path), **is_text)
    locale.setlocale(locale.LC_ALL, before)  # after a 3MF file it would be that of C
    if path.suffix != ".3mf":
        return path.stat().st_size
    with zipfile.ZipFile(path) as file:
        return sum(info.file_size for info in file.infolist())


@pytest.mark.skipif(not STATUS.exists(), reason="only Linux tells a process's peak of memory so")
@pytest.mark.parametrize("format_", ["ply", "off", "obj", "stl", "3mf"])
def test_a_large_file_needs_no_more_memory_than_a_few_times_its_size(
    format_: str, tmp_path: Path
) -> None:
    paths = [tmp_path / f"{name}.{format_}" for name in ("small", "large")]
    _, size = (write_sheet(path, side) for path, side in zip(paths, (10, 500), strict=True))
    command = [sys.executable, "-c", textwrap.dedent(MEASURED), *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert size < int(done.stdout) < 5 * size


def test_a_row_that_lacks_a_number_is_told(tmp_path: Path) -> None:
    lines = lines_of(b"v 1 2 3\nv 1 2 # 3\n", comments=True)
    with pytest.raises(MeshFileError, match="row 1 is 'v 1 2', which lacks the 3 numbers"):
        lines.numbers(tmp_path, 1)
