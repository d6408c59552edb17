"""The report of a batch: one JSON object a line, kept whatever happens.

A line has a "kind": "run" when a batch begins, "file" for every file as soon as it is done (the
attributes of `FileResult`), "summary" at the end. A later batch appends to it.
"""

from __future__ import annotations

import fcntl
import io
import json
import os
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

from meshlab_spectral.errors import BatchError, InputError

DEFAULT_NAME = "batch_report.jsonl"

_BEGIN = b'{"kind": '  # of every line


def read_report(path: Path) -> Iterator[dict[str, Any]]:
    """Give the lines of a report, from the first to the last.

    A line that is cut off, as when the machine stopped while it was written, is left out.

    Raises
    ------
    BatchError
        When the file is there but cannot be read.
    """
    try:
        with path.open("rb") as file:
            for line in file:
                record = _record(line)
                if record is not None:
                    yield record
    except FileNotFoundError:
        return
    except OSError as error:
        raise BatchError(f"the report {path} cannot be read ({error.strerror})") from error


class Report:
    """A report that lines are added to; only one process at a time can.

    Every line is on the disk when `add` returns.

    Raises
    ------
    BatchError
        When it cannot be written, or another batch is writing it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("a+b", buffering=0)
        except OSError as error:
            raise BatchError(
                f"the report {path} cannot be written ({error.strerror}): name another with "
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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def add(self, kind: str, content: dict[str, Any]) -> None:
        """Add a line."""
        line = json.dumps({"kind": kind, **content}, ensure_ascii=False, allow_nan=False)
        self._write(line.encode("utf-8", errors="surrogateescape") + b"\n")

    def _write(self, text: bytes) -> None:
        try:
            rest = memoryview(text)
            while rest:  # a disk that is nearly full takes a part
                rest = rest[self._file.write(rest) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            raise BatchError(
                f"the report {self.path} cannot be written ({error.strerror}): make room, then run "
                "the same command with --resume"
            ) from error

    def _lock(self) -> None:
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BatchError(
                f"another batch is writing the report {self.path}: wait for its end, or name "
                "another with --report"
            ) from None
        except OSError:
            pass  # a file system without locks

    def _end_line(self) -> None:
        """End a line that was cut off, so that the next one stands for itself."""
        if self._file.seek(0, io.SEEK_END) == 0:
            return
        self._file.seek(-1, io.SEEK_END)
        if self._file.read(1) != b"\n":
            self._write(b"\n")


def check_report(path: Path) -> None:
    """Raise InputError when there is a file at `path` that no batch has written."""
    if not path.is_file():  # what else there may be, `Report` complains of
        return
    try:
        with path.open("rb") as file:
            begin = file.read(len(_BEGIN))
    except OSError:  # `read_report` says why
        return
    if not _BEGIN.startswith(begin):  # it may be cut off
        raise InputError(
            f"{path} is no report of a batch, which would be added to it: name another file with "
            "--report"
        )


def _record(line: bytes) -> dict[str, Any] | None:
    try:
        record = json.loads(line.decode("utf-8", errors="surrogateescape"))
    except ValueError:
        return None
    return record if isinstance(record, dict) else None
