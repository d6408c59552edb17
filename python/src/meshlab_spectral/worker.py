"""Filtering and measuring in a process of its own.

MeshLab's code cannot be interrupted, tells its progress only on the standard error stream, and a
crash in it takes its whole process along. So the command runs it in a child process: the command
itself stays answerable to Ctrl-C, shows real progress, and reports even a crash.

The child reads one job as JSON from its standard input, and answers on its standard output with
JSON lines: {"stage": ...} as the work goes on, then {"report": ...} or {"error": ...}.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from meshlab_spectral import errors
from meshlab_spectral.harmonics import basis_to_scratch, check_basis_target
from meshlab_spectral.meshfile import (
    StageCallback,
    check_source,
    filter_to_scratch,
    load_arrays,
    plain_report,
    writing_whole,
)
from meshlab_spectral.options import Boundary, FilterOptions, LaplacianKind
from meshlab_spectral.spectrum import GeometrySpectrum, measure, spectrum_parameters

ProgressCallback = Callable[[str, float | None], None]

_LOG_LINE = re.compile(r"^LOG: \d+ (?P<stage>.*?)\s+\[ (?P<percent>\d+)% \]")
_KEPT_LOG_LINES = 30


def filter_file_in_child(
    source: Path,
    target: Path,
    options: FilterOptions,
    on_progress: ProgressCallback = lambda stage, fraction: None,
) -> dict[str, Any]:
    """Do what `meshfile.filter_file` does, in a child process that can be interrupted.

    Parameters
    ----------
    source, target, options
        As for `filter_file`.
    on_progress
        Called, from another thread, with what is being done and the part that is done, from 0 to 1;
        None where MeshLab tells no part.

    Returns
    -------
    dict
        The filter's report.

    Raises
    ------
    SpectralError
        As `filter_file`; also when the child process ended without an answer.
    KeyboardInterrupt
        After the child has been stopped and the scratch files are gone.
    """
    return _write_in_child(
        source, target, {"task": "filter", "options": options.as_dict()}, on_progress
    )


def basis_file_in_child(
    source: Path,
    target: Path,
    basis_size: int,
    laplacian: LaplacianKind,
    boundary: Boundary,
    on_progress: ProgressCallback = lambda stage, fraction: None,
) -> dict[str, Any]:
    """Write the manifold harmonics of a mesh file into an archive of NumPy.

    Parameters
    ----------
    source
        A file that pymeshlab reads, with one mesh in it.
    target
        The .npz file to write, with the arrays of `harmonics.basis_to_scratch`. It appears whole,
        in place of an existing one, or not at all.
    basis_size, laplacian, boundary
        As for `harmonics.manifold_harmonics`.
    on_progress
        As for `filter_file_in_child`.

    Returns
    -------
    dict
        The numbers of "vertices" and "harmonics".

    Raises
    ------
    SpectralError
        When `source` cannot be read, `target` cannot be written or does not end in .npz, or the
        filter refuses the mesh or an option; also when the child ended without an answer.
    KeyboardInterrupt
        After the child has been stopped and the scratch files are gone.
    """
    check_basis_target(target)
    options = {"basis_size": basis_size, "laplacian": laplacian, "boundary": boundary}
    return _write_in_child(source, target, {"task": "basis", "options": options}, on_progress)


def _write_in_child(
    source: Path, target: Path, job: dict[str, Any], on_progress: ProgressCallback
) -> dict[str, Any]:
    check_source(source)
    with writing_whole(target) as scratch:
        job |= {"source": str(source.absolute()), "scratch": str(scratch.absolute())}
        return _run_in_child(job, on_progress)


def measure_spectrum_in_child(
    source: Path,
    basis_size: int,
    laplacian: LaplacianKind,
    boundary: Boundary,
    on_progress: ProgressCallback = lambda stage, fraction: None,
) -> GeometrySpectrum:
    """Measure the geometry spectrum of a mesh file, in a child process that can be interrupted.

    Parameters
    ----------
    source
        A file that pymeshlab reads, with one mesh in it.
    basis_size, laplacian, boundary
        As for `spectrum.geometry_spectrum`.
    on_progress
        As for `filter_file_in_child`.

    Raises
    ------
    SpectralError
        As `load_arrays` and `geometry_spectrum`; also when the child ended without an answer.
    KeyboardInterrupt
        After the child has been stopped.
    """
    check_source(source)
    job = {
        "task": "spectrum",
        "source": str(source.absolute()),
        "parameters": spectrum_parameters(basis_size, laplacian, boundary),
    }
    return GeometrySpectrum.from_report(_run_in_child(job, on_progress))


def _run_in_child(job: dict[str, Any], on_progress: ProgressCallback) -> dict[str, Any]:
    child = subprocess.Popen(
        [sys.executable, "-m", "meshlab_spectral.worker"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    with child:
        try:
            return _converse(child, job, on_progress)
        finally:
            child.kill()  # nothing to a child that has ended


def _converse(
    child: subprocess.Popen[str], job: dict[str, Any], on_progress: ProgressCallback
) -> dict[str, Any]:
    assert child.stdin is not None
    assert child.stdout is not None
    assert child.stderr is not None
    log: list[str] = []
    # Both streams must be emptied at the same time, else a full one would stop the child.
    listener = threading.Thread(target=_follow_log, args=(child.stderr, log, on_progress))
    listener.start()
    answer: dict[str, Any] = {}
    try:
        child.stdin.write(json.dumps(job))
        child.stdin.close()
        for line in child.stdout:
            answer = json.loads(line)
            if "stage" in answer:
                on_progress(answer["stage"], None)
    except BrokenPipeError:
        pass  # the child has died: said below
    except BaseException:
        child.kill()  # so that the listener comes to its end
        raise
    finally:
        listener.join()
    if "report" in answer:
        report: dict[str, Any] = answer["report"]
        return report
    if "error" in answer:
        raise _error_of(answer)
    status = child.wait()
    how = f"by signal {signal.Signals(-status).name}" if status < 0 else f"with status {status}"
    tail = "\n".join(log)
    raise errors.FilterError(
        f"the process that ran MeshLab ended {how} before it had finished. If that was not on "
        "purpose, the mesh may need more memory than there is, or hits a fault in MeshLab or in "
        "this filter: please report it, with the mesh"
    ) from RuntimeError(f"the last lines of its log:\n{tail}")


def _follow_log(stream: IO[str], log: list[str], on_progress: ProgressCallback) -> None:
    for line in stream:
        log.append(line.rstrip())
        del log[:-_KEPT_LOG_LINES]
        match = _LOG_LINE.match(line)
        if match:
            on_progress(match["stage"], int(match["percent"]) / 100)


def _error_of(answer: dict[str, Any]) -> errors.SpectralError:
    kind = getattr(errors, answer["error"], errors.FilterError)
    error: errors.SpectralError = kind(answer["message"])
    # Shown by --debug: where in the child it happened.
    error.__cause__ = RuntimeError(answer["traceback"])
    return error


def _report_of(job: dict[str, Any], on_stage: StageCallback) -> dict[str, Any]:
    """Do a job, in the child."""
    source, task = Path(job["source"]), job["task"]
    if task == "spectrum":
        on_stage("reading")
        V, F = load_arrays(source)
        on_stage("measuring")
        # Its log is the only source of progress.
        return plain_report(measure(V, F, job["parameters"], verbose=True))
    scratch, options = Path(job["scratch"]), job["options"]
    if task == "basis":
        return basis_to_scratch(source, scratch, **options, on_stage=on_stage)
    return filter_to_scratch(source, scratch, FilterOptions.from_dict(options), on_stage)


def _main() -> None:
    """Run in the child: one job, then the end."""
    # Ctrl-C reaches every process of the terminal; the parent decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Whatever C++ prints must not come between the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)

    def answer(**content: Any) -> None:
        answers.write(json.dumps(content) + "\n")

    try:
        job = json.load(sys.stdin)
        answer(report=_report_of(job, lambda stage: answer(stage=stage)))
    except errors.SpectralError as error:
        answer(
            error=type(error).__name__, message=str(error), traceback=traceback.format_exc().strip()
        )
    except Exception as error:
        answer(
            error="FilterError",
            message=f"unexpected error: {error}; please report it",
            traceback=traceback.format_exc().strip(),
        )
    answers.flush()
    # Without the interpreter's tidying up, in which pymeshlab may crash after an error.
    os._exit(0)


if __name__ == "__main__":
    _main()
