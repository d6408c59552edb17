"""The plugin's library in this process."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path


def opened(plugin: Path) -> ctypes.CDLL:
    """Open a library; raise OSError unless it is loaded: a second copy would have no warnings."""
    if sys.platform == "win32":
        find = ctypes.WinDLL("kernel32").GetModuleHandleW
        find.argtypes, find.restype = [ctypes.c_wchar_p], ctypes.c_void_p
        handle = find(str(plugin))
        if handle is None:
            raise OSError
        return ctypes.CDLL(str(plugin), handle=handle)
    return ctypes.CDLL(str(plugin), mode=os.RTLD_NOW | os.RTLD_NOLOAD)


def let_signals_interrupt(plugin: Path) -> None:
    """Let the plugin's filters run Python's signal handlers, so that Ctrl-C stops them."""
    function = getattr(opened(plugin), "meshlab_spectral_check_signals", None)
    if function is not None:  # else it is of another version, which is reported elsewhere
        python = ctypes.pythonapi
        steps = (python.PyGILState_Ensure, python.PyErr_CheckSignals, python.PyGILState_Release)
        function.argtypes, function.restype = [ctypes.c_void_p] * len(steps), None
        function(*(ctypes.cast(step, ctypes.c_void_p) for step in steps))
