"""What other libraries call an option, and what to give here instead."""

from __future__ import annotations

_STEPS = "feature_size says which details to smooth, such as '2%' or '6e'; steps are automatic"
# Words of pymeshlab, PyVista, trimesh, Open3D, LaPy, pyFM and libigl.
_INSTEAD = {
    """iterations iteration n_iter niter number_of_iterations stepsmoothnum lamb lambda lambda_
    lambda_filter mu nu pass_band relaxation_factor""": _STEPS,
    "featuresize": "give feature_size",
    "k": "give basis_size, or count for shape_dna",
    "num_eigs n_ev": "give basis_size",
    "progress_bar show_progress verbose": "give progress=True",
    "inplace in_place": "the result is a new mesh",
    "n_jobs num_threads": "give threads",
    "force": "give overwrite",
    "no_color": "set the environment variable NO_COLOR=1",
}


def instead_of(name: str) -> str | None:
    """Return what to give instead of a name that no option has, or None."""
    return next((text for names, text in _INSTEAD.items() if name.lower() in names.split()), None)
