"""Sphinx-Gallery: pictures of figures of Matplotlib that pyplot does not know, as the package's."""

from __future__ import annotations

from typing import Any

import pyvista
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_SHOWN = "_shown"  # of a figure: it is in a picture above


def _get_sg_image_scraper() -> Any:  # the name that Sphinx-Gallery calls
    return scrape


def scrape(block: Any, variables: dict[str, Any], gallery: dict[str, Any]) -> str:
    """Save the figures among the variables that have none of their pictures yet."""
    paths = []
    for value in variables["example_globals"].values():
        if isinstance(value, Figure) and not hasattr(value, _SHOWN):
            setattr(value, _SHOWN, True)
            paths.append(next(variables["image_path_iterator"]))
            value.savefig(paths[-1], dpi=100)
    if paths:
        # The figures' meshes were drawn by plotters that are closed: PyVista would save them, too.
        pyvista.close_all()
    return str(figure_rst(paths, gallery["src_dir"]))
