"""A user's program: it runs, and `make lint` checks its types with mypy --strict."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from meshlab_spectral import (
    DenoiseOptions,
    FilterOptions,
    Length,
    OptionError,
    TextureOptions,
    denoise_mesh,
    filter_mesh,
    filter_scalars,
    geometry_spectrum,
    manifold_harmonics,
    measure_artefacts,
    surface_texture,
)
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshlab_spectral import DenoiseReport, FilterReport
    from typing_extensions import assert_type
else:

    def assert_type(value: Any, _: Any) -> Any:
        return value


Array = NDArray[np.float64]
Pair = tuple[Array, NDArray[np.int64]]


def torus(rings: int = 16) -> Pair:
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rings), np.arange(rings)))
    a, b = i + rings * j, (i + 1) % rings + rings * j
    c, d = (b + rings) % rings**2, (a + rings) % rings**2
    u, v = 2 * np.pi * i / rings, 2 * np.pi * j / rings
    V = np.column_stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)])
    return V, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def test_every_kind_of_size_is_an_option_of_its_type() -> None:
    sizes = [FilterOptions(feature_size=size) for size in ("2%", "6e", 0.2, Length(2, "%"), "auto")]
    assert [str(one.feature_size) for one in sizes] == ["2%", "6e", "0.2", "2%", "auto"]
    assert_type(sizes[0].feature_size, Length)
    DenoiseOptions(noise_height="auto", strength=0.5)
    TextureOptions(waviness="0.8", noise="auto", form="plane")
    with pytest.raises(TypeError):
        FilterOptions(feature_sise="2%")  # type: ignore[call-arg]
    with pytest.raises(OptionError):
        FilterOptions(boundary="open")  # type: ignore[arg-type]
    V, F = torus()
    with pytest.raises(OptionError):
        filter_mesh(V, F, feature_sise="2%")  # type: ignore[call-overload]
    with pytest.raises(OptionError):
        filter_mesh(V, F, response="gausian")  # type: ignore[call-overload]


def test_what_is_given_is_what_is_returned() -> None:
    V, F = pair = torus()
    moved, report = assert_type(filter_mesh(V, F, feature_size="2%"), tuple[Array, "FilterReport"])
    assert_type(report["max_displacement"], float)
    both, _ = assert_type(filter_mesh(pair, feature_size="2%"), tuple[Pair, "FilterReport"])
    np.testing.assert_array_equal(both[0], moved)
    options = FilterOptions(feature_size="2%", max_displacement=0.1)
    filter_mesh(V, F, options, gain=lambda w: 1 / (1 + w**4), progress=lambda stage, done: True)
    details, _ = assert_type(filter_mesh(pair, result="details"), tuple[Array, "FilterReport"])
    assert details.shape == V.shape
    clean, found = assert_type(denoise_mesh(pair, strength=0.8), tuple[Pair, "DenoiseReport"])
    assert_type(found["summary"], str)
    assert clean[0].shape == V.shape
    assert_type(denoise_mesh(V, F, noise_height="0.2e", weights=np.ones(len(V)))[0], Array)


def test_measures_have_types(tmp_path: Path) -> None:
    V, F = torus()
    assert_type(geometry_spectrum(V, F).area, float)
    assert_type(manifold_harmonics(V, F, 8).harmonics, Array)
    assert_type(measure_artefacts(V, F, "20%").rms, float)
    assert_type(filter_scalars(V, F, V[:, 2], feature_size="10%")[0], Array)
    heights = assert_type(surface_texture(V, F, waviness="10%").height, Array)
    np.save(tmp_path / "heights.npy", heights)
