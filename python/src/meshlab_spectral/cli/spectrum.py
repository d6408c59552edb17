"""The command `meshlab-spectral spectrum`."""

from __future__ import annotations

import contextlib
import json
import time
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table
from rich.text import Text

from meshlab_spectral.cli.colour_files import Overwrite, refuse_existing
from meshlab_spectral.cli.filter_options import (
    AsJson,
    OneMesh,
    Recipe,
    Source,
    chosen_options,
    with_options,
)
from meshlab_spectral.cli.messages import errors_reported, one_line, print_result
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.extras import check_extras
from meshlab_spectral.figures.spectrum import (
    FORMATS,
    draw_spectrum,
    feature_size_of,
    octave_gains,
)
from meshlab_spectral.files.extensions import check_ending
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.sources import check_source
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.options import (
    FilterKeywords,
    FilterOptions,
    SpectrumOptions,
    TransferKeywords,
)
from meshlab_spectral.filters.running import plain
from meshlab_spectral.filters.spectrum import GeometrySpectrum
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.workers.single_file import measure_in_child

# The options that the filter's curve and the spectrum depend on.
SHOWN_OPTIONS = tuple(TransferKeywords.__annotations__)


@with_options(FilterOptions, leave_out=FilterKeywords.__annotations__.keys() - SHOWN_OPTIONS)
def spectrum_command(
    explicit: dict[str, Any],
    source: Source,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PLOT",
            help="Plot to write: .png, .pdf or .svg. By default MESH_spectrum.png in the current "
            "folder, which a later plot replaces, or none with --json.",
        ),
    ] = None,
    basis_size: Annotated[
        int, typer.Option(min=0, help="Number of lowest harmonics to show one by one as well.")
    ] = SpectrumOptions.basis_size,
    mesh: OneMesh = None,
    recipe: Recipe = None,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> None:
    """Plot the geometry spectrum of a mesh, to choose a filter.

    The plot shows the amplitude of details, their root mean square height, by feature size: for
    octaves and, at the lowest frequencies, for single harmonics. The filter's gain is drawn over
    it. The lower plot shows the height of random vertex displacements that would explain the
    details of each size: it levels off at the noise, and with detail too fine for the mesh to tell
    from noise. The noise is what `denoise` finds. The boundary of an open mesh contributes at all
    sizes; --boundary fixed leaves it out.

      meshlab-spectral spectrum scan.ply
      meshlab-spectral spectrum scan.ply --feature-size 2% --output scan.svg
      meshlab-spectral spectrum scan.ply --boundary fixed
      meshlab-spectral spectrum scan.ply --json
    """
    if output is None and not as_json:
        output, overwrite = Path(f"{source.stem}_spectrum.png"), True
    begin = time.monotonic()
    with errors_reported(), contextlib.ExitStack() as stack:
        options = chosen_options(FilterOptions, explicit, recipe)
        measured = SpectrumOptions(
            basis_size=basis_size, laplacian=options.laplacian, boundary=options.boundary
        )
        check_source(source)
        scratch = None
        if output is not None:  # fail before the computation if it cannot be written
            check_extras("plots")
            check_ending(output, "a plot is a picture", *FORMATS)
            refuse_existing(output, overwrite)
            scratch = stack.enter_context(writing_whole(output))
        with progress_shown() as on_progress:
            report = measure_in_child("spectrum_of", Request(source, measured, mesh), on_progress)
        spectrum = GeometrySpectrum.from_report(report)
        if scratch is not None:
            draw_spectrum(spectrum, options, source.name, scratch)
    if as_json:
        record = _record(source, output, options, spectrum)
        record |= {"seconds": round(time.monotonic() - begin, 3), "versions": versions()}
        typer.echo(json.dumps(record))
    else:
        print_result(_table(spectrum, options, source.name))
        print_result(output)


def _record(
    source: Path, output: Path | None, options: FilterOptions, spectrum: GeometrySpectrum
) -> dict[str, Any]:
    chosen = options.as_dict()
    return {
        "input": str(source),
        "output": None if output is None else str(output),
        "options": {name: chosen[name] for name in SHOWN_OPTIONS},
        "spectrum": plain(
            {field.name: getattr(spectrum, field.name) for field in fields(spectrum)}
        ),
        "octave_gains": octave_gains(spectrum, options).tolist(),
    }


def _noise_line(spectrum: GeometrySpectrum) -> str:
    line, size = spectrum.noise_summary, spectrum.noise_feature_size
    if size > 0:
        percent = 100 * size / spectrum.diagonal
        line += f"; more than the shape in details smaller than {size:.3g} ({percent:.2g} %)"
    return line[0].upper() + line[1:]


def _table(spectrum: GeometrySpectrum, options: FilterOptions, name: str) -> Table:
    """Format the octaves, with the gain of the filter at their centres."""
    size = feature_size_of(options, spectrum)
    diagonal = f"diagonal {spectrum.diagonal:.6g}"
    # Text, not str: a name such as "[red].ply" is not markup.
    title = Text(f"{one_line(name)}: {diagonal}, {options.filter_type} at {size:.6g}")
    table = Table(title=title, title_justify="left", title_style="bold")
    for heading in (
        "Feature size",
        "% of diagonal",
        "Amplitude",
        "% of diagonal",
        "Energy",
        "Gain",
    ):
        table.add_column(heading, justify="right")
    for L, a, energy, g in zip(
        spectrum.octave_feature_sizes,
        spectrum.octave_amplitudes,
        np.diff(spectrum.cumulative_energy, prepend=0.0),
        octave_gains(spectrum, options),
        strict=True,
    ):
        percent = 100 / spectrum.diagonal
        table.add_row(
            f"{L:.4g}",
            f"{L * percent:.4g}",
            f"{a:.3g}",
            f"{a * percent:.3g}",
            f"{energy:.2e}",
            f"{g:.3f}",
        )
    table.caption = Text(
        f"50, 90, 99 % of the energy is at feature sizes of at least "
        f"{spectrum.feature_size_50:.4g}, {spectrum.feature_size_90:.4g}, "
        f"{spectrum.feature_size_99:.4g}\n{_noise_line(spectrum)}"
    )
    table.caption_justify = "left"
    return table
