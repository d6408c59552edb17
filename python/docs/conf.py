"""Sphinx: the reference pages, from the plugin and the docstrings. `make docs` builds them."""

import sys
from importlib.metadata import version as installed_version
from pathlib import Path

import pyvista

# The extensions next to this file.
sys.path.insert(0, str(Path(__file__).parent))

project = "Spectral Filter (Fractional)"
author = "meshlab-spectral"
version = release = installed_version("meshlab-spectral")

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    "myst_parser",
    "filter_pages",
    "command_pages",
    "docstrings",
    "guide_code",
    "math_pages",
    "readme_pages",
]
default_role = "py:obj"  # `x` in a docstring: a link where there is an x, else code
smartquotes_action = "D"  # dashes alone: quotes are often those of code
exclude_patterns = ["**/__pycache__", "notebooks", "**sg_execution_times.rst"]
html_math_renderer = "mathml"

# Scripts that are run, with their output and pictures, and offered as notebooks.
pyvista.OFF_SCREEN = pyvista.BUILDING_GALLERY = True
sphinx_gallery_conf = {
    "examples_dirs": "notebooks",
    "gallery_dirs": "built_notebooks",
    "filename_pattern": "",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("figure_scraper", "pyvista"),
    "capture_repr": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "min_reported_time": 60,
}

# Everything is in the pages themselves: they are read from a disk, without a network.
html_theme = "furo"
html_title = f"{project} {version}"
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_copy_source = False

# The page that filters in the browser, where `make web` has built it.
WEB_SITE = Path(__file__).parents[2] / "build" / "web" / "site"
if WEB_SITE.is_dir():
    tags.add("web")  # noqa: F821 -- Sphinx's own
    html_extra_path = [str(WEB_SITE)]
html_show_copyright = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # those of functions are kept as they are written, by docstrings.py
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
napoleon_google_docstring = False
# Attributes may share a line, as feature_size_50, feature_size_90.
napoleon_custom_sections = [("Attributes", "params_style")]
napoleon_use_rtype = False

nitpicky = True
# Other projects' names, and the words that docstrings use for types.
nitpick_ignore_regex = [
    ("py:.*", r"(numpy|np|pymeshlab|pathlib|collections|typing|npt)\..*"),
    ("py:class", r"array|ArrayLike|NDArray|Any|Path|Sequence|Generator|LaplacianKind|Boundary"),
    ("py:class", r"np\..*|scipy\..*|Outcome|Figure|Plotter|Gain|Progress|Mesh"),
    ("py:obj", r".*"),
]
