"""Presets: options for a purpose, by name; own ones are recipes in a folder of the user's."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from meshlab_spectral import _core
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.recipe import load_recipe
from meshlab_spectral.filters.option_types import AnyOptions, Options
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions
from meshlab_spectral.filters.tables import TABLES

# Sizes of the equalizer's sliders in mean edges, from coarse to fine, as in MeshLab.
EQUALIZER_EDGES = (96, 48, 24, 12, 6, 3)


def equalizer_points(gains: Sequence[float]) -> str:
    """Return the transfer function of an equalizer's sliders, as points for the filter.

    `gains` has a gain >= 0 for each of `EQUALIZER_EDGES`; larger details keep their height. Raises
    ValueError when their number differs, or one is negative or not finite.
    """
    if len(gains) != len(EQUALIZER_EDGES) or not all(0 <= gain < inf for gain in gains):
        raise ValueError(f"give {len(EQUALIZER_EDGES)} gains from 0 on, such as 1,1,2,1,0.5,0")
    points = zip((2 * EQUALIZER_EDGES[0], *EQUALIZER_EDGES), (1.0, *gains), strict=True)
    return ", ".join(f"{edges}e:{gain:g}" for edges, gain in points)


class Preset(NamedTuple):
    """What a name stands for; of all other options the defaults hold."""

    table: type[Options]
    purpose: str
    options: Mapping[str, Any]


def _preset(of: str, purpose: str, options: dict[str, Any]) -> Preset:
    for table in TABLES.values():
        if of == table.FILTER:
            return Preset(table, purpose, options)
    # Of the equalizer, which is a transfer function here.
    gains = [options[f"gain_{edges // EQUALIZER_EDGES[-1]}x"] for edges in EQUALIZER_EDGES]
    points = equalizer_points(gains)
    return Preset(FilterOptions, purpose, {"filter_type": "custom", "transfer_function": points})


PRESETS = {name: _preset(of, purpose, given) for name, of, purpose, given in _core.presets()}
_NAME = re.compile(r"[\w-]+")


def preset_folder() -> Path:
    """Return the folder of the user's own presets, which need not exist."""
    import typer  # where programs keep their settings differs from system to system

    return Path(typer.get_app_dir("meshlab-spectral")) / "presets"


def preset_names(*tables: type[Options]) -> list[str]:
    """Return the names of the presets of filters, and of all the user's own."""
    own = sorted(path.stem for path in preset_folder().glob("*.toml"))
    return [name for name, preset in PRESETS.items() if preset.table in tables] + own


def preset_place(name: str) -> Path:
    """Return the recipe that a preset of the user's is, and make its folder.

    Raises OptionError when the name is that of another preset, or no word.
    """
    if name in PRESETS or not _NAME.fullmatch(name):
        why = "is there already" if name in PRESETS else "a name has only letters, digits, - and _"
        raise OptionError(f"preset {name}: {why}, choose another one")
    preset_folder().mkdir(parents=True, exist_ok=True)
    return preset_folder() / f"{name}.toml"


def preset_of(name: str) -> tuple[type[Options], dict[str, Any]]:
    """Return the class of a preset's options, and those that it sets.

    Raises OptionError when there is no such preset, or the user's is no recipe.
    """
    if name in PRESETS:
        return PRESETS[name].table, dict(PRESETS[name].options)
    path = preset_folder() / f"{name}.toml"
    if not _NAME.fullmatch(name) or not path.is_file():
        known = ", ".join(preset_names(FilterOptions, DenoiseOptions))
        raise OptionError(f"there is no preset {name}: choose {known}")
    return load_recipe(path)


def filter_preset(name: str, **options: object) -> FilterOptions:
    """Return the options of a preset for `filter_mesh`, `filter_file` and `filter_files`.

    Parameters
    ----------
    name
        `smooth`, `remove-details`, `extract-details`, `sharpen`, `enhance`, `caricature`, `print`,
        `terrain`, `clear`, `relief`, `worn`, or one that `--save-preset` has saved.
    **options
        Options of `FilterOptions` in place of those of the preset.

    Raises
    ------
    OptionError
        When there is no such preset, it is for `denoise_mesh`, or an option is invalid.

    Examples
    --------
    >>> V, report = filter_mesh(vertices, faces, filter_preset("print"))
    """
    return _options(FilterOptions, name, options)


def denoise_preset(name: str, **options: object) -> DenoiseOptions:
    """Return the options of a preset for `denoise_mesh`, `denoise_file` and `denoise_files`.

    Parameters
    ----------
    name
        `scan`, `museum`, `teeth`, or one that `--save-preset` has saved.
    **options
        Options of `DenoiseOptions` in place of those of the preset.

    Raises
    ------
    OptionError
        As from `filter_preset`.

    Examples
    --------
    >>> V, report = denoise_mesh(vertices, faces, denoise_preset("museum", strength=0.5))
    """
    return _options(DenoiseOptions, name, options)


def _options(table: type[AnyOptions], name: str, options: Mapping[str, object]) -> AnyOptions:
    found, values = preset_of(name)
    if found is not table:
        raise OptionError(f"the preset {name} is for {found.TABLE}, not for {table.TABLE}")
    return table.from_dict({**values, **options})
