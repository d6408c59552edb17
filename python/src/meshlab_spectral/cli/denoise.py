"""The command `meshlab-spectral denoise`."""

from __future__ import annotations

from meshlab_spectral.cli.filter import AsJson, Debug, Mesh, Source, Target, filter_one_file
from meshlab_spectral.cli.filter_options import with_options
from meshlab_spectral.filters.denoise import DenoiseOptions

# "\b" keeps a paragraph's lines as they are.
DENOISE_HELP = """Find out what noise a mesh has, of a scanner, spikes or voxels, and remove it.

\b
  meshlab-spectral denoise scan.ply clean.ply
A folder of scans:
  meshlab-spectral batch scans --output clean --denoise
"""


@with_options(DenoiseOptions)
def denoise_command(
    options: DenoiseOptions,
    source: Source,
    target: Target,
    mesh: Mesh = None,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Denoise one mesh: see `meshlab-spectral denoise --help`."""
    filter_one_file(source, target, options, mesh, as_json, debug)
