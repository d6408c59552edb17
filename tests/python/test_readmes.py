"""The READMEs: their links lead somewhere, and the equations are computed where they say."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import tomllib
import yaml

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = {"README.md", "CHANGELOG.md", "CONTRIBUTING.md", "RELEASING.md", "SECURITY.md"}
NOT_OURS = {".git", ".venv", "build"}
PLUGIN = REPOSITORY / "plugin" / "README.md"

LINK = re.compile(r"\]\(([^)\s]+)\)")
# [path](path) `function`
PLACE = re.compile(r"\[[^\]]*\]\(([^)\s]+)\) `?(\w+)`?")
NUMBERS = r"\d+(?:(?:, | and | to )\d+)*"
EQUATIONS = re.compile(rf"\bEqs?\. ({NUMBERS})")


def readmes() -> list[Path]:
    """Every README.md of the project, and the pages of .github."""
    found = []
    for folder, folders, files in os.walk(REPOSITORY):
        folders[:] = sorted(set(folders) - NOT_OURS)
        found += [Path(folder, name) for name in files if name in PAGES]
    return found


def links(readme: Path) -> Iterator[str]:
    """The targets of its links within the project; links in code are none."""
    text = re.sub(r"^```.*?^```|`[^`\n]*`", "", readme.read_text(), flags=re.DOTALL | re.MULTILINE)
    return (link for link in LINK.findall(text) if not re.match(r"[a-z]+:", link))


def anchors(readme: Path) -> set[str]:
    """What `#...` may lead to: the headings, as GitHub spells them."""
    headings = re.findall(r"^#+ (.*)$", readme.read_text(), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def numbers(text: str) -> set[int]:
    """The numbers of "4", "4, 6 and 8", "6 to 8"."""
    found = {int(number) for number in re.findall(r"\d+", text)}
    for first, last in re.findall(r"(\d+) to (\d+)", text):
        found |= set(range(int(first), int(last) + 1))
    return found


def definitions(source: Path, function: str) -> str:
    """The bodies of a function of C++ or Python, and the comments right above; comments run on."""
    end = r"^\}$" if source.suffix == ".cpp" else r"\n\n^(?=\S)"
    definition = rf"(?:^//.*\n)*^(?![\s/#}}]).*\b{function}\([^;]*?$[\s\S]*?{end}"
    text = "\n".join(re.findall(definition, source.read_text() + "\n\nend", flags=re.MULTILINE))
    return re.sub(r"\s+", " ", re.sub(r"^\s*///?", "", text, flags=re.MULTILINE))


def equations_cited(source: Path, function: str) -> set[int]:
    """The equations that a function cites where it computes them."""
    text = definitions(source, function)
    assert source.suffix == ".py" or "Kovnatsky et al. 2012, Eq" in text
    return {number for match in EQUATIONS.findall(text) for number in numbers(match)}


def rows(readme: Path, last_column: str) -> list[list[str]]:
    """The cells of all rows of the tables whose last column has this name."""
    found: list[list[str]] = []
    inside = False
    for line in readme.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not line.startswith("|"):
            inside = False
        elif inside and not set(line) <= set("|-: "):
            found.append(cells)
        elif cells[-1] == last_column:
            inside = True
    return found


ROWS = rows(PLUGIN, last_column="computed in")
EQUATION_ROWS = [row for row in ROWS if re.fullmatch(NUMBERS, row[0])]


def place(row: list[str]) -> tuple[Path, str]:
    """The file that the last cell links to, and the function that it names."""
    match = PLACE.fullmatch(row[-1])
    assert match, f"no [file](file) `function` in: {row[-1]}"
    return PLUGIN.parent / match[1], match[2]


@pytest.mark.parametrize("readme", readmes(), ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_every_relative_link_leads_to_a_file_and_a_heading_of_it(readme: Path) -> None:
    broken = []
    for link in links(readme):
        name, _, anchor = link.partition("#")
        target = readme.parent / name if name else readme
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    assert not broken


def test_the_version_is_below_1_until_everything_is_tested_everywhere() -> None:
    changelog = (REPOSITORY / "python" / "CHANGELOG.md").read_text()
    table = changelog.split("## When it is 1.0.0")[1].split("\n## ")[0]
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if line.startswith("| ")]
    cells = {cell for row in rows[1:] for cell in row[1:]}
    assert "tested" in cells
    if cells != {"tested"}:
        cmake = (REPOSITORY / "CMakeLists.txt").read_text()
        assert re.search(r"project\(\w+ VERSION 0\.", cmake)


def test_the_recipe_for_conda_needs_what_the_package_needs() -> None:
    recipe = yaml.safe_load((REPOSITORY / ".github" / "conda" / "recipe.yaml").read_text())
    project = tomllib.loads((REPOSITORY / "python" / "pyproject.toml").read_text())
    cmake = (REPOSITORY / "CMakeLists.txt").read_text()
    assert f"VERSION {recipe['context']['version']} " in cmake
    needed = [
        each if isinstance(each, str) else each["then"] for each in recipe["requirements"]["run"]
    ]
    stated = [each.split(";")[0] for each in project["project"]["dependencies"]]
    assert sorted(each.replace(" ", "") for each in needed) == sorted([*stated, "python"])
    built = {each.replace(" ", "") for each in recipe["requirements"]["host"] if each != "python"}
    assert {
        each for each in project["build-system"]["requires"] if "pymeshlab" not in each
    } <= built


def test_the_table_covers_every_equation_of_the_paper_that_is_used() -> None:
    covered = {number for row in EQUATION_ROWS for number in numbers(row[0])}
    assert covered == {4, 6, 7, 8, 9, 10, 11}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row[0]}, {row[-1].split()[-1]}")
def test_a_function_of_the_table_is_in_the_file_beside_it(row: list[str]) -> None:
    assert definitions(*place(row))


@pytest.mark.parametrize("row", EQUATION_ROWS, ids=lambda row: f"{row[0]}, {row[-1].split()[-1]}")
def test_a_function_cites_the_equation_that_it_computes(row: list[str]) -> None:
    assert numbers(row[0]) <= equations_cited(*place(row))


def test_a_citation_names_the_version_of_the_build() -> None:
    build = (REPOSITORY / "CMakeLists.txt").read_text()
    version = re.findall(r"project\(\w+ VERSION ([\d.]+)", build)
    citation = (REPOSITORY / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.*)$", citation, flags=re.MULTILINE) == version
    assert re.findall(r"version = \{([\d.]+)\}", (REPOSITORY / "README.md").read_text()) == version
