"""The reference pages: complete, as the plugin is. Sphinx itself refuses dead links (conf.py)."""

from __future__ import annotations

import html
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from urllib.parse import unquote, urlsplit

import meshlab_spectral
import numpy as np
import plugin_facts
import pymeshlab
import pytest
from built_pages import Page, Site
from command_pages import command_names
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.plugin.loading import FILTERS
from plugin_facts import DEFAULTS, MEANINGS, filters

SOURCES = Path(plugin_facts.__file__).parent
each_filter = pytest.mark.parametrize("name", FILTERS.values())


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    """The pages as `make docs` builds them."""
    folder = tmp_path_factory.mktemp("docs")
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet"]
    done = subprocess.run(
        [*command, SOURCES, folder], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
    return Site(folder)


def page_of(name: str, site: Site) -> Page:
    return site.pages[f"filters/{name}.html"]


def test_a_browser_loads_nothing_from_the_network(site: Site) -> None:
    loaded = {link for page in site.pages.values() for link in page.files}
    assert {link for link in loaded if urlsplit(link).netloc} == set()


def test_links_to_the_network_are_complete_addresses(site: Site) -> None:
    links = {link for page in site.pages.values() for link in page.links}
    outside = [urlsplit(link) for link in links if urlsplit(link).scheme]
    assert all(parts.scheme == "https" and "." in parts.netloc for parts in outside)


def test_links_within_the_pages_lead_somewhere(site: Site) -> None:
    for name, page in site.pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if not parts.scheme and parts.path:
                assert (page.path.parent / unquote(parts.path)).exists(), f"{name}: {link}"


NOTEBOOKS = sorted(path.stem for path in (SOURCES / "notebooks").glob("*.py"))


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_has_been_run_and_can_be_downloaded(name: str, site: Site) -> None:
    page = site.pages[f"built_notebooks/{name}.html"]
    assert any(f"sphx_glr_{name}_001" in file for file in page.files)
    assert any(link.endswith(f"{name}.ipynb") for link in page.links)
    assert f"built_notebooks/{name}.html" in site.pages["index.html"].links


def test_formulas_are_drawn_by_the_browser(site: Site) -> None:
    text = site.pages["mathematics.html"].path.read_text(encoding="utf-8")
    assert text.count("<math ") > 30
    assert not re.search(r"\\[a-z]{2,}", text)


def test_pages_hold_the_sections_of_the_readmes(site: Site) -> None:
    for name, words in {
        "installing": ("make wheel", "glibc 2.35", "--uninstall"),
        "formats": ("FreeSurfer", "glTF"),
        "limits": ("no undo", "set_memory_limit"),
    }.items():
        text = html.unescape(site.pages[f"{name}.html"].path.read_text(encoding="utf-8"))
        plain = re.sub(r"<[^>]*>", "", text)
        assert all(each in plain for each in words), name


def test_the_plugin_describes_every_filter() -> None:
    described = {each.name: each.python_name for each in filters().values()}
    assert described == FILTERS


@each_filter
def test_a_filter_has_a_page_with_its_name_and_a_picture(name: str, site: Site) -> None:
    page = page_of(name, site)
    assert page.title == filters()[name].name
    assert len(page.pictures) == 1
    assert f"{name}.html" in site.pages["filters/index.html"].links


def test_no_two_filters_have_the_same_picture(site: Site) -> None:
    pictures = [page_of(name, site).pictures[0] for name in FILTERS.values()]
    assert len(set(pictures)) == len(pictures)


@each_filter
def test_a_filter_and_all_its_parameters_have_help(name: str) -> None:
    described = filters()[name]
    assert described.menus
    assert described.help
    for parameter in described.parameters:
        assert parameter.label, parameter.name
        assert len(parameter.help.split()) >= 5, f"{parameter.name}: {parameter.help!r}"
        assert parameter.help.endswith("."), f"{parameter.name}: {parameter.help!r}"
        assert ". mean edges" not in parameter.help  # 2e, but not i.e.


@each_filter
def test_a_page_has_all_parameters_that_pymeshlab_takes(name: str, site: Site) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(subdiv=2)
    taken = mesh_set.filter_parameter_values(name)
    assert [parameter.name for parameter in filters()[name].parameters] == list(taken)
    anchors = {f"{name}.{parameter}".replace("_", "-").replace(".", "-") for parameter in taken}
    assert anchors <= page_of(name, site).ids


def test_help_is_shown_without_markup_or_escapes(site: Site) -> None:
    for name in FILTERS.values():
        assert not re.search(r"</?\w+>|\*\*|\\|&\w+;|``", page_of(name, site).text), name


def all_parameters() -> list[plugin_facts.Parameter]:
    return [parameter for each in filters().values() for parameter in each.parameters]


def test_every_number_has_a_unit() -> None:
    for parameter in all_parameters():
        assert bool(parameter.unit) == parameter.is_number
        assert parameter.unit.startswith("length, ") == parameter.is_length


def test_defaults_in_words_are_those_that_depend_on_the_mesh() -> None:
    in_words = {each.name for each in all_parameters() if each.default == DEFAULTS.get(each.name)}
    assert in_words == DEFAULTS.keys()


def test_defaults_are_those_of_the_options() -> None:
    shown = {each.name: each.default for each in filters()[FilterOptions.FILTER].parameters}
    for name, value in FilterOptions().as_dict().items():
        if name not in DEFAULTS:
            words = {True: "on", False: "off"}.get(value) if isinstance(value, bool) else None
            expected = words or (value if isinstance(value, str) else f"{value:g}")
            if name == "max_displacement":  # a length of 0: no bound
                expected = {"auto": "0"}[expected]
            assert shown[name] == expected.replace("0.05%", "0.05 % of the diagonal")


def test_every_entry_of_a_report_is_explained_and_no_other() -> None:
    texts = {"noise_kind"}  # which pymeshlab does not pass on
    assert MEANINGS.keys() - texts == {key for each in filters().values() for key in each.report}


def test_every_public_name_is_on_the_page_of_the_python_api(site: Site) -> None:
    ids = site.pages["api.html"].ids
    assert {f"meshlab_spectral.{name}" for name in meshlab_spectral.__all__} <= ids


def test_options_are_listed_with_their_help(site: Site) -> None:
    text = " ".join(site.pages["api.html"].text.split())
    for table in (FilterOptions, DenoiseOptions):
        for one in table.__dataclass_fields__.values():
            assert f"{one.name} = " in text
            assert one.metadata["help"].split("|")[0].strip() in text


# In Python's spelling, of the plugin and the package.
NAME = re.compile(r"`([a-z]+(?:_[a-z]+)+)(?: = [^`]+)?`")
# A vertex attribute; the names of the standard for two options of `texture`.
OTHER_NAMES = {"spectral_details", "nesting_index_l", "nesting_index_s"}
GUIDES = ["choosing", "regions", "texture", "troubleshooting"]
PAGES = ["inputs.md", "limits.md", *(f"guides/{name}.md" for name in GUIDES)]
PAGES += ["../../README.md", "../README.md"]


@pytest.mark.parametrize("page", PAGES)
def test_names_in_texts_are_those_of_the_plugin_and_the_package(page: str) -> None:
    known = {*meshlab_spectral.__all__, *filters(), *MEANINGS, *OTHER_NAMES}
    known |= {parameter.name for parameter in all_parameters()}
    text = (SOURCES / page).read_text(encoding="utf-8")
    assert set(NAME.findall(text)) - known == set()


CODE = re.compile(r"^( *)\.\. code-block:: python\n\n((?:\1   .*\n|\n)+)", re.MULTILINE)
EXAMPLES = {
    path: [textwrap.dedent(code) for _, code in CODE.findall(path.read_text())]
    for path in sorted(SOURCES.rglob("*.rst"))
    if "built_notebooks" not in path.parts
}


def test_every_filter_has_an_example() -> None:
    assert {path.stem for path, codes in EXAMPLES.items() if codes} >= set(FILTERS.values())


@pytest.mark.parametrize(
    "path", [path for path, codes in EXAMPLES.items() if codes], ids=lambda path: path.stem
)
def test_examples_run(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(subdiv=4)
    mesh_set.apply_coord_random_displacement(displacement=pymeshlab.PureValue(0.01))
    mesh_set.compute_color_by_function_per_vertex(x="100 * (1 + x)")
    monkeypatch.chdir(tmp_path)
    mesh_set.save_current_mesh("scan.ply")
    names = {"ms": mesh_set, "pymeshlab": pymeshlab, "numpy": np}
    for code in EXAMPLES[path]:  # later blocks of a page go on with the names of earlier ones
        exec(code, names)


def test_every_command_has_its_help_on_the_page_of_commands(site: Site) -> None:
    text = html.unescape(site.pages["commands.html"].path.read_text(encoding="utf-8"))
    names = command_names()
    assert {"filter", "denoise", "batch", "info"} <= set(names)
    for name in names:
        assert f"Usage: meshlab-spectral {name} " in text, name
    assert "--transfer-function" in text
