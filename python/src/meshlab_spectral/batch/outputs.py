"""Naming the outputs of a batch by a pattern, without collisions or replaced inputs."""

from __future__ import annotations

import os
import posixpath
import string
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from meshlab_spectral.batch.inputs import Input
from meshlab_spectral.batch.storage import is_url, location_in
from meshlab_spectral.errors import FormatError, InputError
from meshlab_spectral.files.extensions import FALLBACK, POINTS_ONLY, WRITABLE
from meshlab_spectral.formats.names import ending_of
from meshlab_spectral.formats.opening import PATCHED

DEFAULT_PATTERN = "{stem}"
_FIELDS = ("stem", "ending", "folder")
_NAMED_AT_MOST = 5


@dataclass(frozen=True)
class Output:
    """The output for an input."""

    source: str  # path or URL of the input
    name: str  # relative to the output folder, with "/" as separator
    target: str  # path or URL


def plan_outputs(
    inputs: Sequence[Input], folder: str, pattern: str = DEFAULT_PATTERN, ending: str | None = None
) -> list[Output]:
    """Name the output of each input found by `find_inputs`.

    The inputs' subfolders are recreated in `folder`, a path or URL; a "/" in the `pattern` creates
    folders, too. `ending` is by default that of the input, or ply if it cannot be written with
    faces.

    Raises InputError when the pattern is invalid, outputs would share a name, or one would replace
    an input, and FormatError when MeshLab cannot write files with that extension.
    """
    check_pattern(pattern)
    if ending is not None:
        ending = ending.removeprefix(".")
        kept = {ending_of(file.name).lower() for file in inputs} == {ending.lower()} <= PATCHED
        if ending.lower() not in WRITABLE and not kept:
            raise FormatError(
                f"MeshLab cannot write .{ending} files: choose {', '.join(sorted(WRITABLE))}"
            )
    outputs = [_output(file, folder, pattern, ending) for file in inputs]
    _refuse_collisions(outputs)
    refuse_inputs((output.target for output in outputs), (file.location for file in inputs))
    return outputs


def check_pattern(pattern: str) -> None:
    """Raise InputError unless a pattern gives names inside the output folder."""
    try:
        parts = list(string.Formatter().parse(pattern))
    except ValueError as error:
        raise InputError(f"the name {pattern!r} is invalid ({error})") from error
    for _, field, spec, conversion in parts:
        if field is not None and (field not in _FIELDS or spec or conversion):
            known = ", ".join(f"{{{name}}}" for name in _FIELDS)
            raise InputError(f"the name {pattern!r} has a field {{{field}}}: choose from {known}")
    _check_name(pattern.strip(), pattern)


def _check_name(name: str, pattern: str) -> None:
    if any(step in ("", ".", "..") or "\0" in step for step in name.split("/")):
        made = "" if name == pattern else f", here {name!r},"
        raise InputError(
            f"the name {pattern!r}{made} does not name a file inside the output folder: give "
            "something like {stem}_smooth or {folder}/{stem}"
        )


def _output(file: Input, folder: str, pattern: str, ending: str | None) -> Output:
    own = ending_of(file.name)
    stem = file.name.removesuffix(f".{own}") if own else file.name
    if ending is None:
        kept = own.lower() in (WRITABLE - POINTS_ONLY) | PATCHED or file.is_free_surfer
        ending = own if kept else FALLBACK
    parent = posixpath.basename(posixpath.dirname(file.location))
    made = pattern.format(stem=stem, ending=own, folder=parent)
    _check_name(made, pattern)  # a field may be empty: no extension, or the root folder
    name = posixpath.join(file.folder, f"{made}.{ending}" if ending else made)
    return Output(file.location, name, location_in(folder, name))


def _refuse_collisions(outputs: Sequence[Output]) -> None:
    groups: dict[str, list[Output]] = {}
    for output in outputs:
        # Names that differ only in case are the same file there.
        ignores_case = sys.platform in ("win32", "darwin") and not is_url(output.target)
        key = output.target.casefold() if ignores_case else output.target
        groups.setdefault(key, []).append(output)
    collisions = [group for group in groups.values() if len(group) > 1]
    if collisions:
        sources = [output.source for output in collisions[0]]
        raise InputError(
            f"{', '.join(sources[:_NAMED_AT_MOST])} would all be written to "
            f"{collisions[0][0].target} "
            f"({len(collisions)} such names): distinguish them with --name, such as "
            "{stem}_{ending} or {folder}_{stem}, or filter them into different folders"
        )


def refuse_inputs(targets: Iterable[str], sources: Iterable[str]) -> None:
    """Raise InputError if an output is one of the inputs, even under another name."""
    sources = list(sources)
    locations = {source for source in sources if is_url(source)}
    files = {key for source in sources for key in _identities(source)}
    for target in targets:
        if target in locations or not files.isdisjoint(_identities(target)):
            raise InputError(
                f"{target} is an input itself and would be lost: give the output another name or "
                "another folder"
            )


def _identities(location: str) -> list[object]:
    """Return keys that identify a file under any name, through hard and symbolic links."""
    if is_url(location):
        return []
    known: list[object] = [os.path.realpath(location)]
    try:
        status = Path(location).stat()
    except OSError:
        return known
    return [*known, (status.st_dev, status.st_ino)]
