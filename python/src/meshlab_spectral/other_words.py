"""What other libraries call an option, and what to give here instead."""

from __future__ import annotations

_STEPS = "feature_size says which details to smooth, such as '2%' or '6e'; steps are automatic"
_BAR = "give progress=True"
_COPY = "the result is a new mesh"
# Of pymeshlab, PyVista, trimesh, Open3D, LaPy, pyFM and libigl.
_INSTEAD = {
    "iterations": _STEPS,
    "iteration": _STEPS,
    "n_iter": _STEPS,
    "niter": _STEPS,
    "number_of_iterations": _STEPS,
    "stepsmoothnum": _STEPS,
    "lamb": _STEPS,
    "lambda": _STEPS,
    "lambda_": _STEPS,
    "lambda_filter": _STEPS,
    "mu": _STEPS,
    "nu": _STEPS,
    "pass_band": _STEPS,
    "relaxation_factor": _STEPS,
    "featuresize": "give feature_size",
    "k": "give basis_size, or count for shape_dna",
    "num_eigs": "give basis_size",
    "n_ev": "give basis_size",
    "progress_bar": _BAR,
    "show_progress": _BAR,
    "verbose": _BAR,
    "inplace": _COPY,
    "in_place": _COPY,
    "n_jobs": "give threads",
    "num_threads": "give threads",
    "force": "give overwrite",
    "no_color": "set the environment variable NO_COLOR=1",
}


def instead_of(name: str) -> str | None:
    """Return what to give instead of a name that no option has, or None."""
    return _INSTEAD.get(name.lower())
