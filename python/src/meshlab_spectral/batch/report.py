"""The report of a batch: one JSON object per line, safe on disk at any time.

Each line has a "kind": "run" when a batch starts, "file" for each file as soon as it is done (the
attributes of `FileResult`), "summary" at the end: the number of files by outcome, and the warnings
with the names of their files. Later batches append to it.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

from meshlab_spectral.batch.jobs import FileResult, Outcome
from meshlab_spectral.errors import BatchError, InputError
from meshlab_spectral.warned import Warned, warned

DEFAULT_NAME = "batch_report.jsonl"

_BEGIN = b'{"kind": '  # start of every line
_END_OF_TIME = 1e12  # seconds since 1970; comparison with it also rejects NaN and infinity


def read_report(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the lines of a report in order.

    Skips incomplete lines, as left by a power failure. Raises BatchError when the file exists but
    cannot be read, or has a line that was not written by a batch.
    """
    try:
        with path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                record, wrong = None, None
                try:
                    record = json.loads(line.decode("utf-8", errors="surrogateescape"))
                except RecursionError:
                    wrong = "too nested"
                except ValueError:
                    continue
                if isinstance(record, dict):
                    wrong = _foreign_value(record)
                    yield from [] if wrong else [record]
                if wrong:
                    raise BatchError(
                        f"line {number} of the report {path} was not written by a batch "
                        f"({wrong}): delete that line, or choose another report with --report"
                    )
    except FileNotFoundError:
        return
    except OSError as error:
        raise BatchError(f"the report {path} cannot be read ({error.strerror})") from error


class Report:
    """A report open for appending, by one process at a time; else BatchError is raised.

    Every line is on disk when `add` returns; several threads may call it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._turn = threading.Lock()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("a+b", buffering=0)
        except OSError as error:
            raise BatchError(
                f"the report {path} cannot be written ({error.strerror}): choose another with "
                "--report"
            ) from error
        try:
            self._lock()
            self._end_line()
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> Report:
        return self

    def __exit__(self, *error: object) -> None:
        with self._turn:
            self._file.close()

    def add(self, kind: str, content: dict[str, Any]) -> None:
        """Append a line."""
        line = json.dumps({"kind": kind, **content}, ensure_ascii=False, allow_nan=False)
        with self._turn:
            self._write(line.encode("utf-8", errors="surrogateescape") + b"\n")

    def add_result(self, result: FileResult) -> None:
        """Append the line of a file."""
        self.add("file", result.as_record())

    def _write(self, text: bytes) -> None:
        try:
            rest = memoryview(text)
            while rest:  # a nearly full disk may accept only part of it
                rest = rest[self._file.write(rest) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            raise BatchError(
                f"the report {self.path} cannot be written ({error.strerror}): free some space, "
                "then run the same command with --resume"
            ) from error

    def _lock(self) -> None:
        from filelock import lock_descriptor  # a slow import

        locked = True
        with contextlib.suppress(OSError):  # a file system that does not support locks
            locked = lock_descriptor(self._file.fileno(), blocking=False)
        if not locked:
            raise BatchError(
                f"another batch is writing the report {self.path}: wait for it to end, or choose "
                "another report with --report"
            )

    def _end_line(self) -> None:
        """Terminate an incomplete last line, so that it does not spoil the next one."""
        if self._file.seek(0, io.SEEK_END) == 0:
            return
        self._file.seek(-1, io.SEEK_END)
        if self._file.read(1) != b"\n":
            self._write(b"\n")


def grouped_warnings(warnings: Mapping[str, Sequence[Warned]]) -> list[dict[str, Any]]:
    """Group warnings of many files that differ in numbers alone, most frequent first.

    `warnings` maps the name of each file to its warnings. Each group has "code", "warning", the
    text in the first file, and "files", the names of all of them.
    """
    groups: dict[tuple[str, str], dict[str, Any]] = {}
    for name, texts in sorted(warnings.items()):
        for text in texts:
            new = {"code": text.code, "warning": text, "files": []}
            group = groups.setdefault(text.kind, new)
            if group["files"][-1:] != [name]:  # several meshes of a file may share it
                group["files"].append(name)
    return sorted(groups.values(), key=lambda group: -len(group["files"]))


class Tally:
    """Counts the results of a batch, and collects their warnings."""

    def __init__(self) -> None:
        self.counts = dict.fromkeys(get_args(Outcome), 0)  # by outcome
        self.warnings: dict[str, list[Warned]] = {}  # by the name of the file

    def add(self, result: FileResult) -> None:
        """Count a result."""
        self.counts[result.outcome] += 1
        if found := warned(vars(result)):
            self.warnings[result.name] = found

    def warnings_by_kind(self) -> dict[str, Any]:
        """Return the number of files with warnings, and the warnings as from `grouped_warnings`."""
        grouped = grouped_warnings(self.warnings)
        return {"with_warnings": len(self.warnings), "warnings": grouped}

    def summary(self, done: Outcome) -> str:
        """Format the counts; `done` is the outcome of a successful file."""
        text = f"{self.counts[done]} {done}, {self.counts['failed']} failed"
        for outcome in ("unchanged", "already done"):
            if self.counts[outcome]:
                text += f", {self.counts[outcome]} {outcome}"
        return text + (f", {len(self.warnings)} with warnings" if self.warnings else "")


def check_report(path: Path) -> None:
    """Raise InputError if `path` is a file not written by a batch."""
    if not path.is_file():  # anything else is reported by `Report`
        return
    try:
        with path.open("rb") as file:
            begin = file.read(len(_BEGIN))
    except OSError:  # reported by `read_report`
        return
    if not _BEGIN.startswith(begin):  # an incomplete line may be shorter
        raise InputError(
            f"{path} is not a batch report, so nothing is appended to it: choose another file with "
            "--report"
        )


def _foreign_value(record: dict[str, Any]) -> str | None:
    """Return what in a line was not written by a batch, or None."""
    kind = record.get("kind")
    if kind == "run" and "begun" not in record:
        return "begun is missing"
    for name, fits in _FITTING.items():
        if kind in ("run", "file") and name in record and not fits(record[name]):
            return f"{name} has a wrong value"
    return None


def _is_time(value: Any) -> bool:
    return isinstance(value, int | float) and 0 <= value < _END_OF_TIME


def _is_name(value: Any) -> bool:
    """Whether a value can be part of a path."""
    try:
        return isinstance(value, str) and b"\0" not in os.fsencode(value)
    except UnicodeEncodeError:
        return False


def _is_digests(value: Any) -> bool:
    return isinstance(value, dict) and all(map(_is_name, value))


# Checks of the values that other modules rely on.
_FITTING: dict[str, Callable[[Any], bool]] = {
    "begun": _is_time,
    "name": _is_name,
    "outcome": lambda value: isinstance(value, str),
    "side_files": _is_digests,
    "warnings": lambda value: isinstance(value, list),
    "warning_codes": lambda value: isinstance(value, list),
    "report": lambda value: value is None or isinstance(value, dict),
}
