"""Start-up code of Python, by PYTHONPATH: keeps meshlab_spectral from importing POSIX modules.

Only its own imports are refused: the libraries that it builds on use them here, and do without
them on Windows. Of `select` and `selectors` Windows supports sockets, but not pipes.
"""

import builtins
from collections.abc import Mapping, Sequence
from typing import Any

POSIX_ONLY = {
    "_posixsubprocess",
    "crypt",
    "fcntl",
    "grp",
    "nis",
    "posix",
    "pty",
    "pwd",
    "readline",
    "resource",
    "select",
    "selectors",
    "spwd",
    "syslog",
    "termios",
    "tty",
}

_import = builtins.__import__


def _refusing(
    name: str,
    globals_: Mapping[str, Any] | None = None,
    locals_: Mapping[str, Any] | None = None,
    fromlist: Sequence[str] = (),
    level: int = 0,
) -> Any:
    importer = (globals_ or {}).get("__package__") or ""
    if importer.partition(".")[0] == "meshlab_spectral" and name in POSIX_ONLY:
        raise ModuleNotFoundError(f"{importer} imports {name}, which Windows has not", name=name)
    return _import(name, globals_, locals_, fromlist, level)


builtins.__import__ = _refusing
