"""Recipes: what is saved is what is loaded, and mistakes are named."""

from __future__ import annotations

from pathlib import Path

import pytest
from commands import PRECIOUS
from hypothesis import given
from hypothesis import strategies as st
from meshlab_spectral import FilterOptions, InputError, OptionError
from meshlab_spectral.files.recipe import load_recipe, saving_recipe
from meshlab_spectral.filters.option_types import Length

OPTIONS = st.builds(
    FilterOptions,
    filter_type=st.sampled_from(["low-pass", "high-pass", "band-pass", "band-stop"]),
    feature_size=st.builds(Length, st.floats(0.001, 100), st.sampled_from(["", "%", "e"])),
    order=st.integers(1, 64),
    stop_gain=st.floats(0, 10),
    steps=st.integers(0, 1000),
    reinject_residual=st.booleans(),
)


@given(options=OPTIONS)
def test_a_recipe_keeps_every_option(
    options: FilterOptions, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("recipe") / "recipe.toml"
    with saving_recipe(path, options):
        pass
    assert FilterOptions.from_dict(load_recipe(path)[1]).as_dict() == options.as_dict()


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "recipe.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_options_missing_in_a_recipe_have_their_defaults(tmp_path: Path) -> None:
    _, options = load_recipe(write(tmp_path, '[filter]\nfeature_size = "2%"\nsteps = 4\n'))
    expected = FilterOptions(feature_size=Length(2, "%"), steps=4)
    assert FilterOptions.from_dict(options) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[filter]\nfeature_siz = 1\n", "did you mean feature_size"),
        ("[filter]\nsize = 1\nsteps = 3\n", "there is no option size"),
        ("steps = 3\n", "steps outside"),
        ("[filter]\n[other]\n", "other outside"),
        ("", "table"),
        (f"[filter]\nx = {5000 * '['}{5000 * ']'}\n", "nested"),
        ("filter = 3\n", "table"),
        ("[filter\n", "not a TOML"),
        ("[filter]\norder = 2.5\n", "order = 2.5"),
        ("[filter]\nsteps = -1\n", "steps = -1"),
        ("[filter]\nsteps = 1e24\n", "steps = 1e"),
        ("[filter]\nsteps = 2147483648\n", "0 to 1000"),
        (f"[filter]\nbasis_size = 1{24 * '0'}\n", "must be an integer, at least 1"),
        (f"[filter]\npass_gain = 1{400 * '0'}\n", "pass_gain = 1000"),
        ("[filter]\nstop_gain = 1e39\n", "stop_gain = 1e"),
        ("[filter]\nband_width = 1e-60\n", "band_width = 1e-60: must be above 0"),
        ("[filter]\nfeature_size = 1e39\n", "feature_size = 1e"),
        ("[filter]\ntolerance = 1e-320\n", "above 0"),
        ("[filter]\nfilter_type = [1]\n", "low-pass"),
        ('[filter]\nfilter_type = "lowpass"\n', "low-pass"),
        ('[filter]\nfeature_size = "big"\n', "feature_size"),
    ],
)
def test_a_mistake_in_a_recipe_is_named_with_the_file(
    text: str, words: str, tmp_path: Path
) -> None:
    path = write(tmp_path, text)
    with pytest.raises(OptionError, match=words) as error:
        load_recipe(path)
    assert str(path) in str(error.value)


def test_a_missing_recipe_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml"):
        load_recipe(tmp_path / "none.toml")


def test_a_recipe_replaces_only_a_recipe(tmp_path: Path) -> None:
    path = write(tmp_path, "[filter]\nsteps = 4\n")
    with saving_recipe(path, FilterOptions(steps=5)):
        assert load_recipe(path)[1]["steps"] == 4
    assert load_recipe(path)[1]["steps"] == 5
    with pytest.raises(ZeroDivisionError), saving_recipe(path, FilterOptions(steps=6)):
        raise ZeroDivisionError  # after a failure nothing is saved
    assert load_recipe(path)[1]["steps"] == 5
    path.write_bytes(PRECIOUS)
    refused = pytest.raises(InputError, match=r"recipe\.toml is not a TOML file.*not replaced")
    with refused, saving_recipe(path, FilterOptions()):
        raise AssertionError("refused too late")
    assert path.read_bytes() == PRECIOUS
