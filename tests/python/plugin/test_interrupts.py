"""Ctrl-C stops a filter called from Python, and leaves everything unchanged."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from commands import python

# The call would take minutes. The signal comes from a thread, once the filter is at work.
PROGRAM = """
import os, signal, sys, threading, time
import meshlab_spectral, pymeshlab
meshlab_spectral.load()
mesh_set = pymeshlab.MeshSet()
mesh_set.load_new_mesh(sys.argv[1])
before = mesh_set.current_mesh().vertex_matrix()
faces = mesh_set.current_mesh().face_matrix()
call = eval(sys.argv[2])

def interrupt():
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
began = time.monotonic()
try:
    call()
except KeyboardInterrupt:
    print("stopped after", time.monotonic() - began)
assert (mesh_set.current_mesh().vertex_matrix() == before).all()
mesh_set.load_new_mesh(sys.argv[1])
"""
LONG = "steps=1000, basis_update='full'"


@pytest.mark.parametrize(
    "call",
    [
        f"lambda: meshlab_spectral.filter_mesh(before, faces, {LONG})",
        f"lambda: mesh_set.apply_coord_spectral_filter_fractional({LONG})",
        "lambda: [meshlab_spectral.denoise_mesh(before, faces, strength=2) for _ in range(1000)]",
    ],
)
@pytest.mark.skipif(os.name == "nt", reason="Windows has no signals to send")
def test_an_interrupt_stops_a_filter(call: str, samples: Path) -> None:
    done = python(
        "-c",
        PROGRAM,
        samples / "bunny.obj",
        call,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout.rpartition(" ")[2]) < 30  # alone on a machine 0.55
