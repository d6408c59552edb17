"""Any command line and any recipe: a documented exit code and a message, never a traceback."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import tomli_w
from commands import PRECIOUS, command, write_ply
from format_samples import SAMPLES
from fuzz.damages import Damage, damaged, damages
from fuzz.runs import as_many_as
from hypothesis import given
from hypothesis import strategies as st
from meshlab_spectral import FilterOptions

EXIT_CODES = {0, 1, 2, 130}

Answer = tuple[int, str, str]

# No surrogates: a JSON line carries the arguments. No NUL: no program can be given one.
_texts = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=12)
_numbers = st.one_of(
    st.integers().map(str),
    st.floats().map(str),
    st.sampled_from(("0", "1", "-1", "1e400", "0x10", "1_000", "nan", "1e-60", "٣")),
)
_sizes = st.one_of(
    _numbers.map(lambda number: number + "%"), st.sampled_from(("auto", "5 %", "%", "5%%", "6e"))
)
_choices = st.sampled_from(
    ("low-pass", "band-stop", "gaussian", "ideal", "full", "none", "cotangent", "fixed", "LOW-PASS")
)
_values = st.one_of(_numbers, _sizes, _choices, _texts)
_names = st.one_of(
    st.sampled_from(tuple(FilterOptions().as_dict())).map(lambda name: name.replace("_", "-")),
    st.sampled_from(
        ("no-reinject-residual", "json", "mesh", "debug", "help", "no-such-option", "")
    ),
)


def _options() -> st.SearchStrategy[list[str]]:
    with_value = st.tuples(_names, _values).map(lambda pair: [f"--{pair[0]}", pair[1]])
    joined = st.tuples(_names, _values).map(lambda pair: [f"--{pair[0]}={pair[1]}"])
    alone = _names.map(lambda name: [f"--{name}"])
    return st.lists(st.one_of(with_value, with_value, joined, alone), max_size=4).map(
        lambda parts: [text for part in parts for text in part]
    )


_FORMATS = tuple(sorted({sample.name for sample in SAMPLES}))
_INPUTS = (
    *("mesh.ply", "cloud.ply", "text.ply", "empty.obj", "missing.ply", ".", "a b [x].ply", ""),
    *_FORMATS,
)
_OUTPUTS = (
    "out.ply",
    "out.obj",
    "out.xyz",
    "out.abc",
    "no/such/folder/out.ply",
    ".",
    "",
    "mesh.ply",
    *(f"out{Path(name).suffix}" for name in _FORMATS),
)
_inputs, _outputs = st.sampled_from(_INPUTS), st.sampled_from(_OUTPUTS)

_leaves = st.one_of(
    st.integers(-(2**63), 2**63 - 1),
    st.floats(),
    st.booleans(),
    _texts,
    _sizes,
    _choices,
    st.dates(),
)
_tables = st.dictionaries(
    st.one_of(st.sampled_from(tuple(FilterOptions().as_dict())), _texts),
    st.recursive(_leaves, lambda inner: st.lists(inner, max_size=2), max_leaves=4),
    max_size=4,
)
_recipes = st.one_of(
    _tables.map(lambda table: tomli_w.dumps({"filter": table}).encode()),
    _tables.map(lambda table: tomli_w.dumps(table).encode()),
    _texts.map(str.encode),
    st.binary(max_size=20),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with files to read."""
    folder = tmp_path_factory.mktemp("fuzz")
    corners = "0 0 0\n1 0 0\n0 1 0\n0 0 1"
    write_ply(folder / "mesh.ply", corners, "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3")
    write_ply(folder / "cloud.ply", corners, "")
    shutil.copy(folder / "mesh.ply", folder / "a b [x].ply")
    (folder / "text.ply").write_text("Dear all,\n")
    (folder / "empty.obj").touch()
    for sample in SAMPLES:
        sample.write(folder / sample.name)
    return folder


@pytest.fixture(scope="module")
def run(folder: Path) -> Callable[[list[str]], Answer]:
    """Run the command in that folder."""

    def ask(arguments: list[str]) -> Answer:
        done = command(*arguments, folder=folder)
        return done.returncode, done.stdout, done.stderr

    return ask


def assert_civil(answer: Answer) -> None:
    code, output, errors = answer
    assert code in EXIT_CODES, answer
    assert "Traceback" not in output + errors, errors
    assert "unexpected error" not in errors, errors
    assert bool(errors.strip()) or code == 0, "it failed without a word"


@as_many_as(30, share=0.05)
@given(_inputs, _outputs, _options())
def test_any_command_line_filters_or_says_why_not(
    run: Callable[[list[str]], Answer], folder: Path, source: str, target: str, options: list[str]
) -> None:
    written = folder / "out.ply"
    written.write_bytes(PRECIOUS)
    target = source if target == "INPUT" else target
    arguments = ["filter", source, target, *(text for text in options if text != "--debug")]
    shutil.copy(folder / "a b [x].ply", folder / "mesh.ply")  # may be the output of another input
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    if target != source:
        before.pop(folder / target, None)
    answer = run(arguments)
    assert_civil(answer)
    assert {path: path.read_bytes() for path in before} == before
    wrote = answer[0] == 0 and target == "out.ply" and "--help" not in options
    assert (written.read_bytes() != PRECIOUS) == wrote, answer
    assert not list(folder.glob(".*.partial"))


@as_many_as(30, share=0.05)
@given(st.sampled_from(_FORMATS), damages)
def test_any_damaged_file_is_filtered_or_refused(
    run: Callable[[list[str]], Answer], folder: Path, name: str, damages: list[Damage]
) -> None:
    source = folder / f"damaged{Path(name).suffix}"
    target = folder / f"filtered{source.suffix}"
    source.write_bytes(damaged((folder / name).read_bytes(), damages))
    target.write_bytes(PRECIOUS)
    answer = run(["filter", source.name, target.name])
    assert_civil(answer)
    assert (target.read_bytes() != PRECIOUS) == (answer[0] == 0), answer


@as_many_as(50, share=0.1)
@given(st.lists(_inputs, max_size=2), _recipes, _options())
def test_any_recipe_is_planned_or_refused(
    run: Callable[[list[str]], Answer],
    folder: Path,
    sources: list[str],
    recipe: bytes,
    options: list[str],
) -> None:
    (folder / "recipe.toml").write_bytes(recipe)
    before = sorted(folder.rglob("*"))
    answer = run(
        ["batch", *sources, "--output", "smooth", "--recipe", "recipe.toml", "--dry-run"]
        + [text for text in options if text != "--debug"]
    )
    assert_civil(answer)
    assert sorted(folder.rglob("*")) == before, "a dry run wrote a file"


@as_many_as(30, share=0.05)
@given(st.lists(st.one_of(_texts, _names, _values, _inputs), max_size=5))
def test_any_words_are_a_command_or_a_usage_error(
    run: Callable[[list[str]], Answer], words: list[str]
) -> None:
    answer = run(words)
    assert_civil(answer)
    assert answer[0] in (0, 2), answer
