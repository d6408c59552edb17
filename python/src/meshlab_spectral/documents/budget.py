"""How much a file may grow when it is read: one budget for all readers."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from gzip import GzipFile
from pathlib import Path
from typing import IO

from meshlab_spectral import _core
from meshlab_spectral.errors import MeshFileError

# Bytes that a file may grow to, and how many times its own size. Of real files the text of a 3MF
# grows most, to about 10 times; zlib packs zeros into a thousandth.
_LEAST, _TIMES = 64 << 20, 40
_SHARE = 0.5  # of the memory there is
_BLOCK = 1 << 20
# Seconds that another library's reader may compute, and for each byte: real files take a hundredth.
_SECONDS, _SECONDS_PER_BYTE = 60, 2e-5


class Budget:
    """Bytes that may come of a file beyond its own: what it unpacks to, and arrays that it claims.

    Every reader takes from it, before the memory, whatever a few bytes of the file may multiply.
    """

    def __init__(self, path: Path, size: int) -> None:
        self._path, self._size, self._taken = path, 0, 0
        self.extend(size)

    def extend(self, size: int) -> None:
        """Count the bytes of another file that this one consists of."""
        self._size += size
        available = min(_core.available_memory(), 1e15)  # infinite if unknown
        self.most = min(_LEAST + _TIMES * self._size, int(_SHARE * available))

    def take(self, count: int, what: str) -> None:
        """Take bytes for `what`; raise MeshFileError if the file may not have as many."""
        self._taken += count
        if self._taken > self.most:
            raise MeshFileError(
                f"{self._path} would grow from {self._size} to more than {self.most} bytes when "
                f"it is read ({what}): it is damaged, or made to use up memory; if it is neither, "
                "save it without compression, or in another format",
                "too_large",
            )

    def unpacked(self, file: IO[bytes] | GzipFile, what: str) -> bytes:
        """Read all of a file that unpacks itself, in blocks."""
        content = bytearray()
        while block := file.read(_BLOCK):
            self.take(len(block), what)
            content += block
        return bytes(content)


class _Guard:
    """Whether this process may be ended for a file that it reads: that of a child may."""

    is_on = False


def guard_process() -> None:
    """Let `guarded` limit this process; it may end it."""
    _Guard.is_on = True


@contextlib.contextmanager
def guarded(size: int, memory: float) -> Iterator[None]:
    """Limit what another library's reader takes for a file: memory to add, and processor time.

    The system ends the process for more time. For more memory the library gets none, and most end
    it then: the parent reports that. Without effect unless `guard_process` was called, and on
    systems without such limits.
    """
    if sys.platform == "win32" or not _Guard.is_on:
        yield
        return
    try:
        import resource
    except ImportError:
        yield
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    seconds = used.ru_utime + used.ru_stime + _SECONDS + _SECONDS_PER_BYTE * size
    wanted = {resource.RLIMIT_CPU: seconds, resource.RLIMIT_DATA: _data() + memory}
    before = {kind: resource.getrlimit(kind) for kind in wanted}
    for kind, (soft, hard) in before.items():
        limits = [wanted[kind], *(one for one in (soft, hard) if one != resource.RLIM_INFINITY)]
        resource.setrlimit(kind, (int(min(limits)), hard))
    try:
        yield
    finally:
        for kind, limits_before in before.items():
            resource.setrlimit(kind, limits_before)


def _data() -> float:
    """Return the bytes of private memory that this process has; infinite if unknown."""
    try:
        status = Path("/proc/self/status").read_text()
    except OSError:
        return 1e18
    return 1024 * float(status.partition("VmData:")[2].split()[0])
