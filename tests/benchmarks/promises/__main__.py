"""Asks every promise of this project, and prints one row for each: bound, value, kept or BROKEN.

usage: python -m promises [--only SUBJECT ...] [--list] [--large]

The exit status is 1 if a promise is broken. Promises on meshes that are absent from ../shared next
to the repository are not asked. --large adds a mesh of 2.1 million vertices: a minute more,
and gigabytes. Times are asked last.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import textwrap
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

from promises import (
    accuracy,
    artefacts,
    curves,
    defaults,
    denoising,
    files,
    harmonics,
    memory,
    parts,
    speed,
)
from promises.record import Absent, Found, Promise

SUBJECTS: dict[str, Callable[[], Iterator[Promise]]] = {
    module.__name__.removeprefix("promises."): module.promises
    for module in (
        artefacts,
        accuracy,
        defaults,
        denoising,
        files,
        parts,
        curves,
        harmonics,
        memory,
        speed,
    )
}
STREAMS = (1, 2)  # standard output and errors
MOST_LETTERS = 160  # of the last column
KEPT, BROKEN, NOT_ASKED = "kept", "BROKEN", "not asked"


class Answer(NamedTuple):
    outcome: str
    value: str
    where: str = ""


@contextlib.contextmanager
def without_log() -> Iterator[None]:
    """Send what MeshLab and pymeshlab print to nowhere."""
    kept = [os.dup(stream) for stream in STREAMS]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in STREAMS:
            os.dup2(nowhere, stream)
        yield
    finally:
        for stream, copy in zip(STREAMS, kept, strict=True):
            os.dup2(copy, stream)
        for descriptor in (nowhere, *kept):
            os.close(descriptor)


def answer(one: Promise) -> Answer:
    """Ask a promise; a question that cannot be answered is a broken promise."""
    try:
        with without_log():
            found = one.ask()
    except Absent as absent:
        return Answer(NOT_ASKED, "-", f"no {absent}")
    except Exception as error:
        return Answer(BROKEN, "-", f"{type(error).__name__}: {error}")
    found = found if isinstance(found, Found) else Found(found)
    is_kept = one.bound.low <= found.value <= one.bound.high
    return Answer(KEPT if is_kept else BROKEN, f"{found.value:.3g}", found.where)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=SUBJECTS, default=list(SUBJECTS))
    parser.add_argument("--list", action="store_true", help="print names and bounds, ask nothing")
    parser.add_argument("--large", action="store_true", help="also a mesh of 2.1 million vertices")
    arguments = parser.parse_args()

    outcomes: list[str] = []
    begin = time.perf_counter()
    for subject in [name for name in SUBJECTS if name in arguments.only]:
        print(f"\n{subject}", flush=True)
        for one in SUBJECTS[subject]():
            if one.is_large and not arguments.large:
                continue
            row = f"  {one.name:80} {one.bound!s:>10}"
            if arguments.list:
                print(row)
                continue
            found = answer(one)
            outcomes.append(found.outcome)
            where = textwrap.shorten(found.where, MOST_LETTERS, placeholder=" ...")
            print(f"{row} {found.value:>9}  {found.outcome:9} {where}", flush=True)
    if not arguments.list:
        counts = (f"{outcomes.count(one)} {one}" for one in (KEPT, BROKEN, NOT_ASKED))
        print(f"\n{', '.join(counts)}; {time.perf_counter() - begin:.0f} s")
    sys.exit(BROKEN in outcomes)


if __name__ == "__main__":
    main()
