"""`meshlab-spectral filter` at work: its progress, its interruption, the death of its child."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from batches import wait_until
from commands import COMMAND, command, command_on_terminal, messages_in


@pytest.fixture
def long_run(samples: Path, existing: Path) -> Iterator[subprocess.Popen[str]]:
    """A filter that would take a minute, seen at work."""
    process = subprocess.Popen(
        [
            *COMMAND,
            "filter",
            str(samples / "bunny.obj"),
            str(existing),
            "--overwrite",
            "--steps",
            "500",
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell's background jobs, and all that they start, ignore Ctrl-C; this one must not.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        wait_until(lambda: bool(child_of(process)))
        time.sleep(1)
        yield process
    finally:
        process.kill()
        process.communicate()


def child_of(process: subprocess.Popen[str]) -> int:
    """Process id of the command's own child, 0 if there is none yet."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return int(children[0]) if children else 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_ends_with_130_at_once_and_leaves_nothing_behind(
    number: signal.Signals, long_run: subprocess.Popen[str]
) -> None:
    child = child_of(long_run)
    begin = time.monotonic()
    long_run.send_signal(number)
    stdout, stderr = long_run.communicate(timeout=20)
    assert time.monotonic() - begin < 5
    assert long_run.returncode == 130
    assert stdout == ""
    assert messages_in(stderr) == "Interrupted: no output was written.\n"
    # On a busy machine it may still be dying.
    wait_until(lambda: not Path(f"/proc/{child}").exists(), 5)


# Sends the command Ctrl-C when it imports a module; its children have another command line.
INTERRUPT_AT_IMPORT = """
import os, signal, sys

# The background jobs of a shell ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)

class Interrupt:
    def find_spec(name, path=None, target=None):
        if name == os.environ["INTERRUPT_AT"] and "meshlab_spectral.cli" in sys.orig_argv:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt)
"""
IMPORTS = {
    "numpy": ["spectrum", "COW", "--output", "out/cow.png"],
    "typer": ["batch", "COW", "--output", "out"],
    "rich.progress": ["basis", "COW", "--output", "out/cow.npz"],
    "meshlab_spectral.cli.app": ["--help"],
    "meshlab_spectral.workers.opening": ["batch", "COW", "--output", "out"],
    "psutil": ["spectra", "COW", "--output", "out/spectra.csv"],
    "distributed": ["batch", "COW", "--output", "out", "--scheduler", "tcp://127.0.0.1:1"],
    "distributed.worker": [
        "spectra",
        "COW",
        "-o",
        "out/spectra.csv",
        "--scheduler",
        "tcp://127.0.0.1:1",
    ],
    "pyvista": ["basis", "COW", "-k", "10", "--output", "out/cow.npz", "--pictures", "out/cow.png"],
    "matplotlib": ["spectrum", "COW", "--output", "out/cow.png"],
}


@pytest.mark.parametrize("module", IMPORTS)
def test_an_interruption_in_an_import_ends_with_130_and_leaves_nothing_half_written(
    module: str, cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sitecustomize.py").write_text(INTERRUPT_AT_IMPORT)
    out = tmp_path / "out"
    out.mkdir()
    monkeypatch.chdir(tmp_path)
    arguments = [str(cow) if argument == "COW" else argument for argument in IMPORTS[module]]
    done = command(*arguments, PYTHONPATH=str(tmp_path), INTERRUPT_AT=module)
    assert done.returncode == 130, done.stderr
    assert done.stdout == ""
    assert messages_in(done.stderr).startswith("Interrupted: ")
    assert len(messages_in(done.stderr).splitlines()) == 1
    assert not [path for path in out.rglob("*") if not path.name.endswith("report.jsonl")]


def test_the_death_of_the_working_process_is_reported(long_run: subprocess.Popen[str]) -> None:
    os.kill(child_of(long_run), signal.SIGKILL)
    stdout, stderr = long_run.communicate(timeout=20)
    assert long_run.returncode == 1
    assert stdout == ""
    assert "SIGKILL" in stderr
    assert "memory" in stderr
    assert "Traceback" not in stderr


def test_progress_is_shown_on_a_terminal_only(cow: Path, tmp_path: Path) -> None:
    # Enough steps that some are seen, however fast they are.
    arguments = ["filter", str(cow), str(tmp_path / "out.ply"), "--steps", "400"]
    arguments.append("--overwrite")
    code, stdout, shown = command_on_terminal(*arguments)
    assert code == 0
    steps = [int(step) for step in re.findall(rb"step (\d+) of 400", shown)]
    assert steps
    assert steps == sorted(steps)
    assert b"step" not in stdout
    assert re.fullmatch(r"(\[\d+ s\] .*\n)*Warning: .*\n", command(*arguments).stderr)
