"""The command `meshlab-spectral texture`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.cli.colour_files import (
    Overwrite,
    Picture,
    coloured_mesh,
    writing_coloured,
)
from meshlab_spectral.cli.filter_options import (
    AsJson,
    OneMesh,
    Source,
    chosen_options,
    with_options,
)
from meshlab_spectral.cli.messages import errors_reported, print_result, print_warning
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import table_of
from meshlab_spectral.figures.texture import draw_texture, write_texture
from meshlab_spectral.filters.options import TextureOptions
from meshlab_spectral.filters.texture import SurfaceTexture
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.process.single_file import texture_in_child

_BEARING = (10, 50, 90)


@with_options(TextureOptions)
def texture_command(
    given: dict[str, Any],
    source: Source,
    output: Annotated[
        Path | None,
        coloured_mesh(
            "the height as quality, and in colours: red peaks, blue valleys, full at three Sq"
        ),
    ] = None,
    picture: Picture = None,
    overwrite: Overwrite = False,
    mesh: OneMesh = None,
    as_json: AsJson = False,
) -> None:
    """Measure how rough a surface is: Sa, Sq, Sz and others of ISO 25178-2.

    Roughness is separated from waviness, form and noise by cutoff wavelengths, with the Gaussian
    filter of ISO 16610-61 on the surface itself, whatever its shape. Lengths are in the units of
    the file.

      meshlab-spectral texture part.stl --waviness 0.8 --noise 0.0025
      meshlab-spectral texture part.stl --waviness 0.8 --output heights.ply
      meshlab-spectral texture bore.ply --form cylinder --selected
      meshlab-spectral texture part.stl --json
    """
    with (
        errors_reported("finished files are complete"),
        writing_coloured(output, picture, overwrite, source) as scratch,
    ):
        options = chosen_options(TextureOptions, given)
        with progress_shown() as on_progress:
            V, F, texture = texture_in_child(
                source, options, on_progress, mesh, whole=bool(output or picture)
            )
        if scratch is not None:
            write_texture(V, F, texture, scratch)
        if picture is not None:
            draw_texture(V, F, texture, picture, source.name)
    for warning in texture.warnings:
        print_warning(warning)
    if as_json:
        record = {"input": str(source), "output": None if output is None else str(output)}
        typer.echo(json.dumps({**record, **texture.report, "versions": versions()}))
        return
    print_result(table_of(_rows(texture), source.name))
    for path in (output, picture):
        if path is not None:
            print_result(path)


def _rows(texture: SurfaceTexture) -> list[tuple[str, str]]:
    noise = f"{texture.noise:.4g}" if texture.noise else "none"
    counts = (
        texture.vertices_evaluated,
        texture.vertices_left_out,
        texture.vertices_too_thin,
    )
    waviness = f"{texture.waviness:.4g}" if texture.waviness else "none"
    above = (f"{texture.bearing_heights[percent]:.4g}" for percent in _BEARING)
    form = [] if texture.form_radius is None else [("Radius of the form", texture.form_radius)]
    return [
        ("Waviness cutoff (L-filter)", waviness),
        ("Noise cutoff (S-filter)", noise),
        ("Sa, mean height", f"{texture.Sa:.4g}"),
        ("Sq, rms height", f"{texture.Sq:.4g}"),
        ("Ssk, skewness", f"{texture.Ssk:.4g}"),
        ("Sku, kurtosis", f"{texture.Sku:.4g}"),
        ("Sp, highest peak", f"{texture.Sp:.4g}"),
        ("Sv, deepest valley", f"{texture.Sv:.4g}"),
        ("Sz, both", f"{texture.Sz:.4g}"),
        ("Sdq, rms slope", f"{texture.Sdq:.4g}"),
        ("Sdr, additional area", f"{100 * texture.Sdr:.4g} %"),
        ("Exceeded by 10 / 50 / 90 % of the area", " / ".join(above)),
        *((name, f"{radius:.4g}") for name, radius in form),
        ("Vertices evaluated, left out, too thin", "{}, {}, {}".format(*counts)),
    ]
