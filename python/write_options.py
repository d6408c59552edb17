"""Write the tables of options, filters/options.py, as the core describes its filters.

usage: write_options.py [--check]

With --check nothing is written; the exit code is 1 if the file is not up to date. ruff gives it its
form.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from meshlab_spectral import _core

TARGET = Path(__file__).parent / "src" / "meshlab_spectral" / "filters" / "options.py"
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
FLAGS = {("BasisOptions", "basis_size"): ("--basis-size", "-k")}
# Of FilterOptions: what defines the transfer function and the Laplacian.
SIGNALS = "apply_scalar_spectral_filter_per_vertex"
HEAD = '''"""The options of the filters: names, defaults, limits, help.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypedDict

from meshlab_spectral.filters.option_types import LARGEST_INTEGER, Length, Limits, Options, option

'''


def _filter_named(name: str) -> dict[str, Any]:
    return next(one for one in _core.filters() if one["python_name"] == name)


def _parameters_of(table: str) -> list[dict[str, Any]]:
    name, _, hidden = TABLES[table]
    parameters = _filter_named(name)["parameters"]
    return [one for one in parameters if one["name"] not in hidden]


def _help_of(parameter: dict[str, Any]) -> str:
    """Return the help as for a command: other parameters are flags."""

    def flag(match: re.Match[str]) -> str:
        return "--" + match[1].replace("_", "-")

    text = re.sub(r"\|(\w+)\|", flag, parameter["help"]).replace("*", "")
    if parameter["kind"] == "length":
        text += f" Default: {parameter['default_in_words']}."
    return text


def _type_of(parameter: dict[str, Any]) -> str:
    kinds = {"choice": CHOICES.get(parameter["name"], ""), "length": "Length"}
    return kinds.get(parameter["kind"], parameter["kind"])


def _default_of(parameter: dict[str, Any]) -> str:
    default = parameter["default"]
    if parameter["kind"] == "choice":
        return repr(parameter["choices"][default])
    if parameter["kind"] != "length":
        return repr(default)
    if default == "auto":
        return "Length(automatic=True)"
    return f"Length({float(default[:-1])}, {default[-1]!r})"


def _limits_of(parameter: dict[str, Any]) -> str:
    kind = parameter["kind"]
    if kind not in ("int", "float"):
        return ""
    arguments = [f"{parameter['low']:g}"]
    if parameter["high"] is not None:
        arguments.append(f"{parameter['high']:g}")
    elif kind == "int":
        arguments.append("LARGEST_INTEGER")
    if parameter["is_low_open"]:
        arguments.append("low_open=True")
    return f", Limits({', '.join(arguments)})"


def _table_of(table: str) -> str:
    name, short, _ = TABLES[table]
    lines = [
        "@dataclass(frozen=True, kw_only=True)",
        f"class {table}(Options):",
        f'    """Options of {_filter_named(name)["name"]}, named as in MeshLab.',
        "",
        "    Raises",
        "    ------",
        "    OptionError",
        "        When a value is invalid; names the option, the value and what is allowed.",
        '    """',
        "",
        f"    FILTER = {name!r}",
        f"    TABLE = {short!r}",
        "",
    ]
    for one in _parameters_of(table):
        flags = FLAGS.get((table, one["name"]))
        more = f", flags={flags!r}" if flags else ""
        text = _wrapped(_help_of(one))
        lines.append(
            f"    {one['name']}: {_type_of(one)} = option({_default_of(one)}, {text}"
            f"{_limits_of(one)}{more})"
        )
    return "\n".join(lines)


def _wrapped(text: str, width: int = 84) -> str:
    """Return a string literal, in parts that fit on lines."""
    parts, line = [], ""
    for word in text.split(" "):
        if len(repr(line + word)) > width:
            parts.append(line)
            line = ""
        line += word + " "
    parts.append(line.rstrip(" "))
    return " ".join(repr(part) for part in parts)


def _keywords_of(table: str, name: str, left_out: set[str], base: str) -> str:
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
            _keywords_of("FilterOptions", "TransferKeywords", every - of_signals, "TypedDict"),
            _keywords_of("FilterOptions", "FilterKeywords", of_signals, "TransferKeywords"),
            _keywords_of("DenoiseOptions", "DenoiseKeywords", set(), "TypedDict"),
            _keywords_of("TextureOptions", "TextureKeywords", set(), "TypedDict"),
            *map(_table_of, TABLES),
        ]
    )
    command = [sys.executable, "-m", "ruff", "format", "--config", str(SETTINGS), "-"]
    done = subprocess.run(command, input=text + "\n", capture_output=True, text=True, check=True)
    return done.stdout


def _main() -> None:
    text = _written()
    if "--check" not in sys.argv:
        TARGET.write_text(text, encoding="utf-8")
    elif TARGET.read_text(encoding="utf-8") != text:
        sys.exit(f"{TARGET.name} is not up to date: run python/write_options.py")


if __name__ == "__main__":
    _main()
