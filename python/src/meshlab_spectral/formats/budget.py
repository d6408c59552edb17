"""How much a file may grow when it is read: one budget for all readers."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from gzip import GzipFile
from pathlib import Path
from typing import IO

from meshlab_spectral import _core
from meshlab_spectral.errors import MemoryLimitError, MeshFileError, SpectralError

# Bytes that a file may grow to, and how many times its own size. Of real files the text of a 3MF
# grows most, to about 10 times; zlib packs zeros into a thousandth.
LEAST, _TIMES = 64 << 20, 40
_SHARE = 0.5  # of the memory there is
_BLOCK = 1 << 20
# Seconds that another library's reader may compute, and for each byte: real files take a hundredth.
_SECONDS, _SECONDS_PER_BYTE = 60, 2e-5


class Budget:
    """Bytes that may come of a file beyond its own: what it unpacks to, and arrays that it claims.

    Every reader takes from it, before the memory, whatever a few bytes of the file may multiply.
    `least` is what the smallest file may take, `share` what any may of the memory there is.
    """

    def __init__(self, path: Path, size: int, least: int = LEAST, share: float = _SHARE) -> None:
        self._path, self._least, self._share = path, least, share
        self.size = self._taken = 0
        self.extend(size)

    def extend(self, size: int) -> None:
        """Count the bytes of another file that this one consists of."""
        self.size += size
        there_is = self._share * min(_core.available_memory(), 1e15)  # infinite if unknown
        usual = self._least + _TIMES * self.size
        self._is_scarce = there_is < usual
        self.most = min(usual, int(there_is))

    def take(self, count: int, what: str) -> None:
        """Take bytes for `what`; raise `exceeded` if the file may not have as many."""
        self._taken += count
        if self._taken > self.most:
            raise self.exceeded(what)

    def exceeded(self, what: str) -> SpectralError:
        """Return the error for a file that takes more, for `what`: by its fault, or the machine's.

        A MeshFileError, or a MemoryLimitError where a file of its size may take what is not there.
        """
        grows = f"{self._path} would grow from {self.size} to more than {self.most} bytes when it"
        if self._is_scarce:
            return MemoryLimitError(
                f"{grows} is read ({what}), {self._share:.0%} of the memory that is free: free "
                "some, or read it on a machine with more"
            )
        return MeshFileError(
            f"{grows} is read ({what}): it is damaged, or made to use up memory; if it is neither, "
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
def guarded(budget: Budget, own: int = 0) -> Iterator[None]:
    """Limit what another library's reader takes for a file: its budget, and processor time.

    `own` are bytes that the library takes for any file. The system ends the process for more time.
    For more memory the library gets none: most end the process then, which the parent reports; from
    others `Budget.exceeded` is raised. No limit is set unless `guard_process` was called, nor on
    systems without such limits.
    """
    try:
        with _limited(budget.size, budget.most + own):
            yield
    except MemoryError as error:
        raise budget.exceeded("what its reader makes of it") from error


@contextlib.contextmanager
def _limited(size: int, memory: float) -> Iterator[None]:
    """Limit the memory to be added and the processor time of this process, for a file's bytes."""
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
