"""The plot of a geometry spectrum: amplitude by feature size, a filter's gain, noise."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from meshlab_spectral.extras import check_extras
from meshlab_spectral.figures.sheet import FONT_SIZE, INK
from meshlab_spectral.filters.arrays import check_class
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.spectrum import Array, GeometrySpectrum
from meshlab_spectral.filters.transfer import MeshLengths, gain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = (".png", ".pdf", ".svg")

_SIZE = (9.0, 7.5)  # inches
_HEIGHTS = (3, 2)  # ratio of the two plots
_DOTS_PER_INCH = 150
_OCTAVES, _HARMONICS, _FILTER, _NOISE = "#3b6ea5", "#7a7a7a", "#c0504d", "#8a6d1d"

_LEGEND: dict[str, Any] = {
    "fontsize": FONT_SIZE - 1,
    "loc": "lower left",
    "frameon": True,
    "framealpha": 0.9,
    "edgecolor": "none",
    "labelcolor": INK,
}

# The last octaves, below this fraction of the largest amplitude, come from a few slivers of the
# mesh and would take up half the plot.
_SHOWN = 1e-5


def filter_name(options: FilterOptions) -> str:
    """Describe a filter: `low-pass 15 %`."""
    if options.filter_type == "custom":
        return f"custom {options.transfer_function}"
    size = str(options.feature_size).replace("%", " %")
    name = f"{options.filter_type} {size}"
    if options.stop_gain == 1:
        name = f"{options.filter_type} \N{MULTIPLICATION SIGN} {options.pass_gain:g} at {size}"
    return name if options.power == 1 else f"{name}, power {options.power:g}"


def feature_size_of(options: FilterOptions, spectrum: GeometrySpectrum) -> float:
    """Return the filter's feature size in the units of the mesh."""
    diagonal = spectrum.diagonal
    size = options.sizes(diagonal, spectrum.mean_edge, diagonal)["feature_size"]
    if size is None or options.feature_size.automatic:
        return spectrum.default_feature_size
    return size


def octave_gains(spectrum: GeometrySpectrum, options: FilterOptions) -> Array:
    """Return the gains of a filter at the centres of the octaves."""
    return _gains_at(spectrum.octave_feature_sizes, spectrum, options)


def _gains_at(sizes: Array, spectrum: GeometrySpectrum, options: FilterOptions) -> Array:
    cutoff = feature_size_of(options, spectrum)
    lengths = MeshLengths(cutoff, spectrum.diagonal, spectrum.mean_edge)
    return gain(options, cutoff / sizes, lengths)


def draw_spectrum(
    spectrum: GeometrySpectrum, options: FilterOptions, title: str, path: Path
) -> None:
    """Draw the spectrum of a mesh with a filter's transfer function to a file; see `plot_spectrum`.

    The extension of `path`, one of FORMATS, sets the format.
    """
    figure = plot_spectrum(spectrum, options, title)
    figure.savefig(path, format=path.suffix.lower().removeprefix("."))


def plot_spectrum(
    spectrum: GeometrySpectrum, options: FilterOptions | None = None, title: str = ""
) -> Figure:
    """Plot the spectrum of a mesh, optionally with a filter's transfer function over it.

    Large features are on the left, small ones on the right, like low and high notes. The lower plot
    shows the height of the vertex noise that would explain the details of each size; below the
    size at which it rises above the noise that there is, they are more noise than shape (shaded).

    Parameters
    ----------
    spectrum
        Spectrum of the mesh, as from `geometry_spectrum`.
    options
        Options of the filter.
    title
        Title of the plot, plain text.

    Returns
    -------
    matplotlib.figure.Figure
        Not registered with pyplot: a notebook shows it as the value of a cell; ``savefig(path)``
        saves it. Its axes are the amplitudes, the noise, and the gains if any.

    Raises
    ------
    MissingPackageError
        When Matplotlib (extra `plots`) is not installed.

    Examples
    --------
    >>> figure = plot_spectrum(geometry_spectrum(V, F, 100), FilterOptions(), "scan")
    >>> figure.savefig("spectrum.png")
    """
    check_class(spectrum, GeometrySpectrum, "geometry_spectrum")
    check_extras("plots")
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from meshlab_spectral.figures.notebook import NotebookFigure

    figure = NotebookFigure(_SIZE, dpi=_DOTS_PER_INCH, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    axes, noise = figure.subplots(2, 1, sharex=True, height_ratios=_HEIGHTS)
    _plot_amplitudes(axes, spectrum)
    _plot_noise(noise, spectrum)
    for each in (axes, noise):
        if spectrum.noise_feature_size > 0:
            smallest = min(axes.get_xlim())
            each.axvspan(smallest, spectrum.noise_feature_size, color=_NOISE, alpha=0.12, zorder=0)
    _label(axes, noise, spectrum, title)
    curves, names = axes.get_legend_handles_labels()
    if options is not None:
        gains = axes.twinx()
        _plot_gain(gains, spectrum, options, axes.get_xlim())
        gain_curves, gain_names = gains.get_legend_handles_labels()
        curves, names = [*curves, *gain_curves], [*names, *gain_names]
        axes = gains  # in front
    axes.legend(curves, names, **_LEGEND)
    noise.legend(**_LEGEND)
    return figure


def _plot_amplitudes(axes: Axes, spectrum: GeometrySpectrum) -> None:
    amplitudes = spectrum.octave_amplitudes
    shown = np.flatnonzero(amplitudes > _SHOWN * amplitudes.max())
    first, last = shown[0], shown[-1]
    sizes, heights = spectrum.octave_feature_sizes[first : last + 1], amplitudes[first : last + 1]
    edges = np.append(sizes * np.sqrt(2), sizes[-1] / np.sqrt(2))
    floor = 0.3 * heights[heights > 0].min()
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.stairs(heights, edges, baseline=floor, fill=True, color=_OCTAVES, alpha=0.18)
    axes.stairs(heights, edges, baseline=floor, color=_OCTAVES, linewidth=1.8, label="octaves")
    # Separate octaves of equal height.
    axes.vlines(edges[1:-1], floor, np.minimum(heights[:-1], heights[1:]), _OCTAVES, linewidth=0.6)
    waves = spectrum.frequencies > 0
    if waves.any():
        axes.plot(
            2 * np.pi / spectrum.frequencies[waves],
            spectrum.amplitudes[waves],
            ".",
            color=_HARMONICS,
            markersize=3,
            label=f"the {np.count_nonzero(waves)} lowest harmonics",
        )
    axes.set_xlim(edges[0], edges[-1])
    axes.set_ylim(floor, 3 * heights.max())


def _plot_gain(
    axes: Axes, spectrum: GeometrySpectrum, options: FilterOptions, limits: tuple[float, float]
) -> None:
    cutoff = feature_size_of(options, spectrum)
    sizes = np.geomspace(*limits, 1000)
    gains = _gains_at(sizes, spectrum, options)
    axes.plot(sizes, gains, color=_FILTER, linewidth=1.8, label=filter_name(options))
    axes.set_ylim(0, 1.25 * max(1.0, float(gains.max())))
    axes.set_ylabel("gain of the filter", fontsize=FONT_SIZE, color=_FILTER)
    axes.tick_params(labelsize=FONT_SIZE - 1, colors=_FILTER)
    if options.filter_type != "custom" and min(limits) < cutoff < max(limits):
        axes.axvline(cutoff, color=_FILTER, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.annotate(
            f"{cutoff:.3g}\n({100 * cutoff / spectrum.diagonal:.3g} %)",
            (cutoff, 1),
            xycoords=("data", "axes fraction"),
            xytext=(4, -4),
            textcoords="offset points",
            va="top",
            fontsize=FONT_SIZE,
            color=_FILTER,
        )


def _plot_noise(axes: Axes, spectrum: GeometrySpectrum) -> None:
    axes.set_yscale("log")
    if len(spectrum.band_feature_sizes) == 0:
        axes.plot([], [], " ", label="too few harmonics to detect noise")
        return
    axes.plot(
        spectrum.band_feature_sizes,
        spectrum.noise_heights,
        "o-",
        color=_OCTAVES,
        markersize=3.5,
        linewidth=1.4,
        label="noise that would explain the details of this size (third octaves)",
    )
    heights = spectrum.noise_heights[spectrum.noise_heights > 0]
    axes.set_ylim(0.05 * heights.min(), 3 * heights.max())  # room for the legend
    if spectrum.noise_height == 0:
        axes.plot([], [], " ", label="no noise found")
        return
    size, percent = spectrum.noise_feature_size, 100 / spectrum.diagonal
    axes.axhline(
        spectrum.noise_height,
        color=_NOISE,
        linewidth=1.2,
        linestyle=(0, (4, 3)),
        label=f"noise of height {spectrum.noise_height:.3g}"
        f" ({percent * spectrum.noise_height:.2g} %)",
    )
    if size == 0:
        return
    axes.annotate(
        f"noise from {size:.3g} ({percent * size:.2g} %) down",
        (size, 1),
        xycoords=("data", "axes fraction"),
        xytext=(-4, -5),
        textcoords="offset points",
        ha="right",
        va="top",
        fontsize=FONT_SIZE,
        color=_NOISE,
    )


def _label(axes: Axes, noise: Axes, spectrum: GeometrySpectrum, title: str) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    def to_percent(size: Any) -> Any:
        return 100 / spectrum.diagonal * size

    def to_length(percent: Any) -> Any:
        return spectrum.diagonal / 100 * percent

    percent = axes.secondary_xaxis("top", functions=(to_percent, to_length))
    for axis in (noise.xaxis, percent.xaxis):
        axis.set_major_locator(LogLocator(10, subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.10g}"))
        axis.set_minor_formatter(NullFormatter())
    noise.set_xlabel("feature size (wavelength), units of the mesh", fontsize=FONT_SIZE, color=INK)
    percent.set_xlabel("% of the bounding box diagonal", fontsize=FONT_SIZE, color=INK)
    axes.set_ylabel("amplitude (rms height), units of the mesh", fontsize=FONT_SIZE, color=INK)
    noise.set_ylabel("noise height, units of the mesh", fontsize=FONT_SIZE, color=INK)
    axes.set_title(title, fontsize=FONT_SIZE + 1, color=INK, parse_math=False)
    for each in (axes, noise, percent):
        each.tick_params(labelsize=FONT_SIZE - 1, colors=INK)
    for each in (axes, noise):
        each.grid(which="major", color="#e4e4e4", linewidth=0.6)
        each.set_axisbelow(True)
