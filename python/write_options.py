"""Write filters/options.py and filters/reports.py, as the core describes its filters.

usage: write_options.py [--check]

With --check nothing is written; the exit code is 1 if a file is not up to date. ruff gives them
their form.
"""

from __future__ import annotations

import subprocess
import sys
import textwrap
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from meshlab_spectral import _core

FOLDER = Path(__file__).parent / "src" / "meshlab_spectral" / "filters"
SETTINGS = Path(__file__).with_name("pyproject.toml")

# Class -> filter, name of the table in a recipe, parameters that are left out.
TABLES = {
    "FilterOptions": ("apply_coord_spectral_filter_fractional", "filter", ()),
    "DenoiseOptions": ("apply_coord_spectral_denoise", "denoise", ()),
    "SpectrumOptions": ("get_geometry_spectrum", "spectrum", ()),
    "TextureOptions": ("compute_scalar_surface_texture_per_vertex", "texture", ()),
    "BasisOptions": (
        "compute_scalar_manifold_harmonic_per_vertex",
        "basis",
        ("mode", "store_basis"),
    ),
}
# Parameters with choices of their own -> the name of their type.
CHOICES = {
    "filter_type": "FilterType",
    "response": "Response",
    "basis_update": "BasisUpdate",
    "spectrum": "Spectrum",
    "laplacian": "LaplacianKind",
    "boundary": "Boundary",
    "weight": "Weight",
    "result": "Result",
    "form": "Form",
}
FLAGS = {
    "BasisOptions": {"basis_size": ("--basis-size", "-k")},
    "TextureOptions": {
        "waviness": ("--waviness", "--nesting-index-l"),
        "noise": ("--noise", "--nesting-index-s"),
    },
}
# Of FilterOptions: what defines the transfer function and the Laplacian.
SIGNALS = "apply_scalar_spectral_filter_per_vertex"
HEAD = '''"""The options of the filters by name, with their types; the core has all else.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

from meshlab_spectral.filters.option_types import Length, Options, table_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

'''

# Class -> filter, what has such a report.
REPORTS = {
    "FilterReport": ("apply_coord_spectral_filter_fractional", "`filter_mesh`"),
    "DenoiseReport": ("apply_coord_spectral_denoise", "`denoise_mesh`"),
    "ScalarsReport": (SIGNALS, "`filter_scalars`"),
    "ColorsReport": ("apply_color_spectral_filter_per_vertex", "`filter_colors`"),
    "TextureReport": ("compute_scalar_surface_texture_per_vertex", "`SurfaceTexture`"),
}
# Reports -> the class of the entries that just these have.
BASES = {
    ("FilterReport", "DenoiseReport"): "_ShapeReport",
    ("FilterReport", "ColorsReport"): "_SolvedReport",
    ("FilterReport", "DenoiseReport", "ColorsReport"): "_SurfaceReport",
}
# Entries that Python adds, in place of all others but the warnings.
COLUMNS = {"ScalarsReport": ("columns", "of values n x k, their k reports, in place of these")}
# Entries that Python adds, besides the others, and their types.
ADDED = {
    "DenoiseReport": (
        "noise_heights",
        "with `store_noise_height`, height of the noise at each of the n vertices, length; 0: none",
        "list[float]",
    ),
    "TextureReport": ("unit", "what a length is, if the file says so", "str"),
}
# With these, where a filter has them, its report has all entries that there may be.
MORE = {"spectrum": "truncated", "basis_size": 20, "steps": 1, "form": "sphere"}
REPORTS_HEAD = '''"""The reports of the filters: entries, their meaning, their units.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from typing import TypedDict

'''


def _filter_named(name: str) -> dict[str, Any]:
    return next(one for one in _core.filters() if one["python_name"] == name)


def _parameters_of(table: str) -> list[dict[str, Any]]:
    name, _, hidden = TABLES[table]
    parameters = _filter_named(name)["parameters"]
    return [one for one in parameters if one["name"] not in hidden]


def _type_of(parameter: dict[str, Any]) -> str:
    kinds = {"choice": CHOICES.get(parameter["name"], ""), "length": "Length"}
    return kinds.get(parameter["kind"], parameter["kind"])


def _table_of(table: str) -> str:
    name, short, _ = TABLES[table]
    flags = "".join(f", {one}={given!r}" for one, given in FLAGS.get(table, {}).items())
    lines = [
        f"@table_of({name!r}, {short!r}{flags})",
        f"class {table}(Options):",
        f'    """Options of {_filter_named(name)["name"]}, named as in MeshLab; see `Options`."""',
        "",
        # A length may be given as a text or a number, and is a `Length` then.
        "    if TYPE_CHECKING:",
        "",
        f"        def __init__(self, **named: Unpack[{_keywords_named(table)}]) -> None: ...",
        "",
    ]
    lines += [f"    {one['name']}: {_type_of(one)}" for one in _parameters_of(table)]
    return "\n".join(lines)


def _keywords_named(table: str) -> str:
    return table.replace("Options", "Keywords")


def _keywords_of(
    table: str, left_out: Collection[str] = (), base: str = "TypedDict", name: str = ""
) -> str:
    name = name or _keywords_named(table)
    lines = [f"class {name}({base}, total=False):", f'    """Fields of `{table}`, by name."""', ""]
    for one in _parameters_of(table):
        kind = "Size" if one["kind"] == "length" else _type_of(one)
        if one["name"] not in left_out:
            lines.append(f"    {one['name']}: {kind}")
    return "\n".join(lines)


def _written() -> str:
    choices = {
        name: one["choices"]
        for table in TABLES
        for one in _parameters_of(table)
        if (name := CHOICES.get(one["name"])) and one["kind"] == "choice"
    }
    types = [f"{name} = Literal{values!r}" for name, values in choices.items()]
    every = {one["name"] for one in _parameters_of("FilterOptions")}
    of_signals = {one["name"] for one in _filter_named(SIGNALS)["parameters"]} - {"selected"}
    text = HEAD + "\n".join([*types, "Size = Length | str | float"]) + "\n\n\n"
    text += "\n\n\n".join(
        [
            _keywords_of("FilterOptions", every - of_signals, name="TransferKeywords"),
            _keywords_of(
                "FilterOptions", {"result", *of_signals}, "TransferKeywords", "ShapeKeywords"
            ),
            _keywords_of("FilterOptions", every - {"result"}, "ShapeKeywords"),
            *(_keywords_of(table) for table in TABLES if table != "FilterOptions"),
            *map(_table_of, TABLES),
        ]
    )
    return text


def _torus(rings: int = 12) -> tuple[Any, Any]:
    """Return a mesh that every filter accepts."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rings), np.arange(rings)))
    a, b = i + rings * j, (i + 1) % rings + rings * j
    c, d = ((corner + rings) % rings**2 for corner in (b, a))
    F = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
    u, v = (index * 2 * np.pi / rings for index in (i, j))
    radius = 1 + 0.7 * np.cos(v)
    return np.column_stack([radius * np.cos(u), radius * np.sin(u), 0.7 * np.sin(v)]), F


def _map(size: int = 24) -> tuple[Any, Any]:
    """Return crossed waves over a regular grid."""
    y, x = (index.ravel() for index in np.indices((size, size)))
    a = np.arange(size * size).reshape(size, size)[:-1, :-1].ravel()
    F = np.vstack([[a, a + 1, a + size], [a + 1, a + size + 1, a + size]])
    F = F.reshape(2, 3, -1).swapaxes(1, 2).reshape(-1, 3).astype(np.int32)
    return np.column_stack([x, y, 0.2 * np.sin(x) + 0.2 * np.sin(y)]), F


def _kinds_of(name: str) -> dict[str, str]:
    """Return the types of a report's entries, from runs."""
    known = {one["name"] for one in _filter_named(name)["parameters"]}
    kinds: dict[str, str] = {}
    runs = [(_torus(), {}), (_torus(), {key: MORE[key] for key in MORE if key in known})]
    if "form" in known:
        runs.append((_map(), {"form": "plane", "waviness": 3.0}))
    for (V, F), more in runs:
        done = _core.apply(name, V, F, more, values=np.abs(V) if "color" in name else V[:, :1])
        for entry, value in done["report"].items():
            kinds[entry] = "list[float]" if np.ndim(value) else type(value).__name__
        if done["summary"]:
            kinds["summary"] = "str"
    return kinds


def _entries_of(table: str) -> list[tuple[str, str, str, bool]]:
    """Return name, type and meaning of a report's entries, and whether every run has them."""
    name, _ = REPORTS[table]
    kinds = _kinds_of(name)
    entries = sorted(_filter_named(name)["report"])
    if table in COLUMNS:
        entries = [(*one[:2], False) for one in [COLUMNS[table], *entries]]
        kinds["columns"] = f"list[{table}]"
    if table in ADDED:
        added, meaning, kinds[added] = ADDED[table]
        entries.append((added, meaning, False))
    if "summary" in kinds:
        entries.append(("summary", "what was found and done, in one line", True))
    return [(entry, kinds[entry], meaning, is_always) for entry, meaning, is_always in entries]


def _class_of(name: str, bases: str, entries: list[Any], of: str = "") -> str:
    lines = [f"class {name}({bases}):"]
    if of:
        lines.append(f'    """Report of {of}; lengths are in the units of the mesh."""\n')
    for entry, kind, meaning, _ in entries:
        lines.append(f"    {entry}: {kind}\n    {_docstring(meaning)}")
    return "\n".join(lines)


def _reports() -> str:
    warnings = [
        ("warnings", "list[str]", "problems that were not errors, and what to do about them", True),
        ("warning_codes", "list[str]", "for each of them, what it is about", True),
    ]
    classes = [_class_of("_WarningReport", "TypedDict", warnings)]
    entries = {table: _entries_of(table) for table in REPORTS}
    always = {table: {one for one in entries[table] if one[-1]} for table in REPORTS}
    shared: dict[str, set[Any]] = {"_WarningReport": set()}
    for tables, name in BASES.items():
        others = (always[table] for table in REPORTS if table not in tables)
        shared[name] = set.intersection(*(always[table] for table in tables)).difference(*others)
        classes.append(_class_of(name, "_WarningReport", sorted(shared[name])))
    for table, (_, function) in REPORTS.items():
        bases = [name for tables, name in BASES.items() if table in tables] or ["_WarningReport"]
        own = [one for one in entries[table] if not any(one in shared[name] for name in bases)]
        always_own, some = ([one for one in own if one[-1] == is_] for is_ in (True, False))
        of = ", ".join(bases)
        if some and always_own:
            classes.append(_class_of(f"_{table}", of, always_own))
            of = f"_{table}"
        total = ", total=False" if some else ""
        classes.append(_class_of(table, of + total, some or always_own, function))
    return "\n\n\n".join(classes)


def _docstring(meaning: str) -> str:
    text = meaning[0].upper() + meaning[1:] + "."
    quotes = '"""'
    if len(text) < 88:
        return f"{quotes}{text}{quotes}"
    return textwrap.fill(f"{quotes}{text}{quotes}", 96, subsequent_indent="    ")


def _formatted(text: str) -> str:
    command = [sys.executable, "-m", "ruff", "format", "--config", str(SETTINGS), "-"]
    done = subprocess.run(command, input=text + "\n", capture_output=True, text=True, check=True)
    return done.stdout


def _main() -> None:
    reports = REPORTS_HEAD + _reports()
    for name, text in (("options.py", _written()), ("reports.py", reports)):
        target, formatted = FOLDER / name, _formatted(text)
        if "--check" not in sys.argv:
            target.write_text(formatted, encoding="utf-8")
        elif not target.exists() or target.read_text(encoding="utf-8") != formatted:
            sys.exit(f"{name} is not up to date: run python/write_options.py")


if __name__ == "__main__":
    _main()
