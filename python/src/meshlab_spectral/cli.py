"""The command `meshlab-spectral`."""

from __future__ import annotations

import contextlib
import inspect
import json
import platform
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import fields
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from meshlab_spectral import __version__
from meshlab_spectral.errors import FormatError, OptionError, SpectralError
from meshlab_spectral.figures import FIGURES, draw_figures
from meshlab_spectral.figures.harmonics import check_modes, check_picture, draw_basis_file
from meshlab_spectral.harmonics import DEFAULT_BASIS_SIZE
from meshlab_spectral.options import Boundary, FilterOptions, LaplacianKind, Length
from meshlab_spectral.report import report_table, report_warnings
from meshlab_spectral.worker import ProgressCallback, basis_file_in_child, filter_file_in_child

EXIT_FAILED, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130

_EXIT_CODES = (
    "Exit codes: 0 all done; 1 a file could not be read, filtered or written; 2 the command line "
    "is wrong; 130 interrupted."
)

# "\b" keeps a paragraph's lines as they are.
_FILTER_HELP = """Filter one mesh by the size of its details.

\b
Smooth a scan, away with what is smaller than 1 % of it:
  meshlab-spectral filter scan.ply smooth.ply --feature-size 2%
Sharpen it:
  meshlab-spectral filter scan.ply sharp.ply --filter-type high-pass \\
    --stop-gain 1 --pass-gain 2
"""

_FIGURES_HELP = """Draw the figures of the paper (Kovnatsky et al. 2012) from your meshes.

\b
1  one shot of a strong filter, and ten fractional steps of it
4  eigenfunctions before a filter, after its 1/10 power, after all of it
5  the fractional powers of two filters, and the shapes that they make

Every mesh gets its own pictures. The paper's meshes, the dragon and the angel, are in the Stanford
3D Scanning Repository, https://graphics.stanford.edu/data/3Dscanrep/.

\b
  meshlab-spectral figures dragon.ply angel.ply --output pictures
  meshlab-spectral figures scan.ply --only 1,5
"""

_BASIS_HELP = """Compute the manifold harmonics of a mesh, for scripts and as pictures.

The output is an archive of NumPy with the arrays eigenvalues (k), frequencies (k, their square
roots), harmonics (n x k), masses (n, the areas of the vertices: with these as weights the harmonics
are orthonormal), and the mesh that their rows belong to, vertices (n x 3) and faces (m x 3).

\b
  meshlab-spectral basis scan.ply --basis-size 200 --output scan.npz
  meshlab-spectral basis scan.ply --pictures scan.png --modes 1,2,3,5,8
"""

app = typer.Typer(
    help="Smooth, sharpen and band-filter meshes by the size of their details.",
    epilog=_EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_messages = Console(stderr=True)


def main() -> None:
    """Run the command line; ends the process with the exit code."""
    # A polite end (kill, a shutdown) tidies up like Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    app()


def with_filter_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command one option per field of FilterOptions, handed to it as `options`."""
    types = get_type_hints(FilterOptions)
    own = [
        parameter
        for parameter in inspect.signature(command, eval_str=True).parameters.values()
        if parameter.name != "options"
    ]
    added = []
    for option in fields(FilterOptions):
        settings: dict[str, Any] = {"help": option.metadata["help"]}
        type_, default = types[option.name], option.default
        if type_ is Length:
            settings |= {"parser": _length, "metavar": "SIZE"}
            default = str(default)
        added.append(
            inspect.Parameter(
                option.name,
                inspect.Parameter.KEYWORD_ONLY,
                default=default,
                annotation=Annotated[type_, typer.Option(**settings)],
            )
        )

    def run(**arguments: Any) -> None:
        given = {parameter.name: arguments.pop(parameter.name) for parameter in added}
        try:
            options = FilterOptions(**given)
        except OptionError as error:
            raise typer.BadParameter(str(error)) from error
        command(options=options, **arguments)

    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in [*own, *added]]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    run.__doc__ = command.__doc__
    run.__name__ = command.__name__
    return run


def _length(text: str | Length) -> Length:
    try:
        return text if isinstance(text, Length) else Length.parse(text)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from error


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"meshlab-spectral {__version__}, pymeshlab {version('pymeshlab')}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Tell the version."),
    ] = False,
) -> None:
    """Smooth, sharpen and band-filter meshes by the size of their details."""


@app.command("filter", help=_FILTER_HELP, epilog=_EXIT_CODES)
@with_filter_options
def filter_command(
    options: FilterOptions,
    source: Annotated[
        Path, typer.Argument(metavar="INPUT", help="Mesh to read: .ply, .obj, .stl, .off, ...")
    ],
    target: Annotated[
        Path,
        typer.Argument(
            metavar="OUTPUT", help="Mesh to write; its ending says the format. Replaces a file."
        ),
    ],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the report as one JSON object.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Filter one mesh: `meshlab-spectral filter --help` tells how."""
    if target.exists() and source.exists() and target.samefile(source):
        raise typer.BadParameter(
            f"{target} is INPUT itself, and would be lost: choose another name", param_hint="OUTPUT"
        )
    begin = time.monotonic()
    with _errors_reported(debug), _progress_shown() as on_progress:
        report = filter_file_in_child(source, target, options, on_progress)
    for warning in report_warnings(report):
        _messages.print(f"Warning: {warning}.", highlight=False, soft_wrap=True)
    if as_json:
        typer.echo(json.dumps(_record(source, target, options, report, time.monotonic() - begin)))
    else:
        Console().print(report_table(report, f"{source.name} -> {target.name}"))


@app.command("figures", help=_FIGURES_HELP, epilog=_EXIT_CODES)
def figures_command(
    meshes: Annotated[
        list[Path],
        typer.Argument(
            metavar="MESH",
            help="Meshes to show. They are seen along their shortest axis, with y up, or z.",
        ),
    ],
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Where to put the pictures; made if need be.")
    ] = Path(),
    only: Annotated[
        str, typer.Option(metavar="NUMBERS", help="The figures to draw, such as 1,5.")
    ] = ",".join(map(str, FIGURES)),
    scale: Annotated[
        float, typer.Option(min=0.1, max=10, help="Resolution: 2 has twice as many pixels a side.")
    ] = 1.0,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Draw the figures of the paper: `meshlab-spectral figures --help` tells more."""
    numbers = _figure_numbers(only)
    interrupted = "pictures that were finished are there, and whole"
    with _errors_reported(debug, interrupted), _progress_shown() as on_progress:
        pictures = draw_figures(
            meshes, output, numbers, scale, lambda stage: on_progress(stage, None)
        )
    for picture in pictures:
        typer.echo(picture)


def _figure_numbers(text: str) -> list[int]:
    known = {str(number): number for number in FIGURES}
    numbers = [part.strip() for part in text.split(",")]
    if not known.keys() >= set(numbers):
        raise typer.BadParameter(f"{text!r}: choose of {', '.join(known)}", param_hint="--only")
    return [known[number] for number in numbers]


@app.command("basis", help=_BASIS_HELP, epilog=_EXIT_CODES)
def basis_command(
    source: Annotated[
        Path, typer.Argument(metavar="MESH", help="Mesh to read: .ply, .obj, .stl, .off, ...")
    ],
    output: Annotated[
        Path, typer.Option(metavar="FILE", help="Archive of NumPy to write. Replaces a file.")
    ] = Path("basis.npz"),
    basis_size: Annotated[
        int,
        typer.Option("--basis-size", "-k", min=1, help="How many, the constant ones included."),
    ] = DEFAULT_BASIS_SIZE,
    laplacian: Annotated[
        LaplacianKind, typer.Option(help="As for the filter.")
    ] = "intrinsic delaunay",
    boundary: Annotated[
        Boundary,
        typer.Option(help="At the rims of an open surface: free, or fixed to zero."),
    ] = "free",
    pictures: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Sheet of pictures to draw: a .png file.")
    ] = None,
    modes: Annotated[
        str | None,
        typer.Option(metavar="NUMBERS", help="Harmonics in the pictures, such as 1,2,3,5,8."),
    ] = None,
    scale: Annotated[
        float, typer.Option(min=0.1, max=10, help="Resolution of the pictures; 1 fills a screen.")
    ] = 1.0,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Compute manifold harmonics: `meshlab-spectral basis --help` tells more."""
    with _errors_reported(debug, "files that were finished are there, and whole"):
        shown = None if modes is None else _modes(modes, basis_size)
        if pictures is not None:
            check_picture(pictures)
        with _progress_shown() as on_progress:
            basis_file_in_child(source, output, basis_size, laplacian, boundary, on_progress)
            if pictures is not None:
                on_progress("drawing", None)
                draw_basis_file(output, pictures, shown, scale)
    for path in (output, pictures):
        if path is not None:
            typer.echo(path)


def _modes(text: str, basis_size: int) -> list[int]:
    try:
        modes = [int(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(
            f"{text!r}: give numbers such as 1,2,3,5,8", param_hint="--modes"
        ) from None
    check_modes(modes, basis_size)
    return modes


def _record(
    source: Path, target: Path, options: FilterOptions, report: dict[str, Any], seconds: float
) -> dict[str, Any]:
    return {
        "input": str(source),
        "output": str(target),
        "options": options.as_dict(),
        "report": report,
        "seconds": round(seconds, 3),
        "versions": {
            "meshlab_spectral": __version__,
            "pymeshlab": version("pymeshlab"),
            "python": platform.python_version(),
        },
    }


@contextlib.contextmanager
def _errors_reported(
    debug: bool, when_interrupted: str = "no output was written"
) -> Iterator[None]:
    """Turn every error of this package into one message and an exit code."""
    try:
        yield
    except KeyboardInterrupt:
        _messages.print(f"Interrupted: {when_interrupted}.")
        raise typer.Exit(EXIT_INTERRUPTED) from None
    except SpectralError as error:
        if debug:
            _messages.print_exception()
        # No markup, no wrapping: file names hold brackets, and scripts search for messages.
        _messages.print(f"Error: {error}", markup=False, highlight=False, soft_wrap=True)
        usage = isinstance(error, OptionError | FormatError)
        raise typer.Exit(EXIT_USAGE if usage else EXIT_FAILED) from error


@contextlib.contextmanager
def _progress_shown() -> Iterator[ProgressCallback]:
    """Show on a terminal what MeshLab reports of its progress; elsewhere nothing."""
    with Progress(
        SpinnerColumn(),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
        console=_messages,
        transient=True,
        disable=not _messages.is_terminal,
    ) as progress:
        task = progress.add_task("starting", total=None)

        def update(stage: str, fraction: float | None) -> None:
            if fraction is None:
                progress.reset(task, start=False, total=None, description=stage)
                progress.start_task(task)
            else:
                # MeshLab's figure may fall back a little when a step turns out to need more work.
                done = max(fraction, progress.tasks[0].completed)
                progress.update(task, total=1.0, completed=done, description=stage)

        yield update


if __name__ == "__main__":
    main()
