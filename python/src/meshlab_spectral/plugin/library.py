"""Functions that the plugin's library offers besides its filters."""

from __future__ import annotations

import ctypes
import functools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import OptionError, PluginError
from meshlab_spectral.plugin.handle import opened
from meshlab_spectral.plugin.loading import load, loaded_plugin

_NUMBERS = ctypes.POINTER(ctypes.c_double)


def last_warnings() -> list[str]:
    """Return the warnings of the plugin's latest filter run in this thread, in its own words.

    pymeshlab drops the strings of a filter's report.

    Returns
    -------
    list of str
        Sentences without the final full stop; empty before the first run and after a failed one.

    Raises
    ------
    PluginError
        When pymeshlab has loaded another copy of the plugin than `load` would, or the plugin is
        older than this package.
    """
    function = _function(loaded_plugin(), "meshlab_spectral_warnings", ())
    text: bytes = function()
    return text.decode().splitlines()


def last_summary() -> str:
    """Return what the plugin's latest filter run in this thread found and did, in one line.

    Returns
    -------
    str
        Empty where the numbers of the report say it all.

    Raises
    ------
    PluginError
        As `last_warnings`.
    """
    text: bytes = _function(loaded_plugin(), "meshlab_spectral_summary", ())()
    return text.decode()


def transfer_gains(
    filter_type: int,
    response: int,
    shape: Sequence[float],
    text: str,
    lengths: Sequence[float],
    frequencies: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the gains of a transfer function, as the filter applies it.

    Parameters
    ----------
    filter_type, response
        Numbers of the filter's choices.
    shape
        The filter's options order, band_width, pass_gain, stop_gain and power.
    text
        Its option transfer_function.
    lengths
        Feature size, diagonal and mean edge, in the units of the mesh, > 0.
    frequencies
        Relative to that of the feature size, >= 0.

    Returns
    -------
    array
        The gains, >= 0, in the shape of `frequencies`.

    Raises
    ------
    OptionError
        When the text is wrong, or a gain negative or not finite; the message says where.
    PluginError
        When the plugin cannot be loaded, or as `last_warnings`.
    """
    load()
    integer, text_type = ctypes.c_int, ctypes.c_char_p
    types = (integer, integer, _NUMBERS, text_type, _NUMBERS, _NUMBERS, integer, _NUMBERS)
    function = _function(loaded_plugin(), "meshlab_spectral_gains", types)
    gains = np.empty(np.shape(frequencies))
    arrays = [np.ascontiguousarray(one, dtype=np.float64) for one in (shape, lengths, frequencies)]
    numbers = [array.ctypes.data_as(_NUMBERS) for array in (*arrays, gains)]
    mistake: bytes | None = function(
        filter_type, response, numbers[0], text.encode(), *numbers[1:3], gains.size, numbers[3]
    )
    if mistake is not None:
        raise OptionError(mistake.decode())
    return gains


def filter_descriptions() -> list[dict[str, Any]]:
    """Return what the plugin's dialogs say about its filters.

    Returns
    -------
    list of dict
        For each filter its "name" in the menus, "python_name", "menus", "help" in HTML and
        "parameters": for each its "name", "label", "type" (MeshLab's, such as "RichInt"), "help" in
        HTML, whether it "is_advanced", and the "choices" of an enumeration.

    Raises
    ------
    PluginError
        When the plugin cannot be loaded, or as `last_warnings`.
    """
    load()
    text: bytes = _function(loaded_plugin(), "meshlab_spectral_filters", ())()
    described: list[dict[str, Any]] = json.loads(text)
    return described


@functools.cache
def _function(plugin: Path, name: str, arguments: Sequence[Any]) -> Any:
    """Return a function of the loaded plugin that returns a text."""
    try:
        function = getattr(opened(plugin), name)
    except OSError as error:
        raise PluginError(
            f"pymeshlab has loaded another copy of the plugin than {plugin}: call "
            "meshlab_spectral.load() before loading any other copy"
        ) from error
    except AttributeError as error:
        raise PluginError(
            f"the plugin {plugin} is older than this package: rebuild both from the same sources"
        ) from error
    function.restype = ctypes.c_char_p
    function.argtypes = arguments
    return function
