"""Planning a batch: everything is found and checked before any work is done."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.inputs import Input, find_inputs
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.outputs import Output, plan_outputs
from meshlab_spectral.batch.report import DEFAULT_NAME, check_report, read_report
from meshlab_spectral.batch.resume import Records, done_records, proved_done
from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.errors import InputError, OptionError
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.script import script_filters
from meshlab_spectral.files.sources import check_source
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.versions import versions

# Tolerated difference between the clocks of a file server and this machine, in seconds.
_CLOCK_SLACK = 2.0
_NAMED_AT_MOST = 5


@dataclass(frozen=True)
class Batch:
    """A planned batch."""

    jobs: list[Job]  # those that remain, in the order of the inputs
    done: list[FileResult]  # still valid, from an earlier run
    report: Path
    settings: Settings

    @property
    def folders(self) -> list[str]:
        """Output folders of the jobs."""
        targets = [job.target for job in self.jobs if job.target is not None]
        return sorted({target.rpartition("/")[0] for target in targets})


def plan_batch(
    inputs: Sequence[str | Path],
    output: str | Path,
    settings: Settings,
    options: Options | None = None,
) -> Batch:
    """Find the inputs of a batch, name its outputs, and check that no file would be lost.

    Parameters and errors are those of `files.filter_files`.
    """
    settings.check_workers()
    resume, overwrite = settings.resume, settings.overwrite
    request, described = _request(options, settings.script)
    folder = storage.absolute_location(str(output))
    if not storage.is_url(folder) and Path(folder).is_file():
        raise InputError(f"the output {output} is a file: name a folder for the outputs")
    report_path = _report_path(folder, settings.report)
    check_report(report_path)
    records: Records = {}
    begun = None
    if resume or report_path.is_file():
        lines = list(read_report(report_path))
        records = done_records(lines)
        begun = min((line["begun"] for line in lines if line.get("kind") == "run"), default=None)
    planned = plan_outputs(
        _inputs(inputs, folder, settings.recursive, report_path, records),
        folder,
        settings.name,
        settings.ending,
    )
    if settings.joined:
        if described.get("result") == "details" or described.get("store_noise_height"):
            raise OptionError(
                "joined files cannot hold details or the height of noise: leave out one of them"
            )
        # What becomes of a file depends on the others.
        described = described | {"joined": [output.source for output in planned]}
    jobs = [
        Job(
            output.source,
            output.target,
            output.name,
            request,
            described,
            seconds=settings.timeout,
            overwrite=overwrite or resume,
        )
        for output in planned
    ]
    done = proved_done(jobs, records, versions()) if resume else {}
    if settings.joined and len(done) < len(jobs):
        done = {}
    left = [job for job in jobs if job not in done]
    proved = {job.name for job in done}
    if report_path.as_posix() in (output.target for output in planned):
        raise InputError(
            f"the report {report_path} is also an output: choose another with --report"
        )
    if not overwrite:
        outputs = [output for output in planned if output.name not in proved]
        hint = "continue an earlier run with --resume"
        if resume:
            hint = f"pass the report of the run that made them (--report); {report_path} is not it"
        _refuse_to_replace(outputs, begun if resume else None, hint)
    return Batch(left, list(done.values()), report_path, settings)


def _request(options: Options | None, script: str | Path | None) -> tuple[Request, dict[str, Any]]:
    """Return the `request` and the `options` of every `Job`."""
    if script is None:
        options = options or FilterOptions()
        return Request(Path(), options, verbose=False), options.as_dict()
    if options is not None:
        raise OptionError(
            "a script contains its parameters: give either a script or options of the filter"
        )
    try:
        content = Path(script).read_bytes()
        text = content.decode()
    except OSError as error:
        raise InputError(f"the script {script} cannot be read ({error.strerror})") from error
    except UnicodeDecodeError:
        raise OptionError(f"{script} is not a MeshLab filter script") from None
    described = {
        "script": Path(script).name,
        "script_sha256": hashlib.sha256(content).hexdigest(),
        "filters": script_filters(text),
    }
    return Request(Path(), script=text, verbose=False), described


def _report_path(folder: str, report: str | Path | None) -> Path:
    if report is not None:
        return Path(report).absolute()
    if storage.is_url(folder):
        raise InputError("the outputs go to a URL: name a local file for the report (--report)")
    return Path(folder, DEFAULT_NAME)


def _inputs(
    inputs: Sequence[str | Path],
    folder: str,
    recursive: bool,
    report: Path,
    records: Records,
) -> list[Input]:
    """Find the inputs, excluding outputs of an earlier run."""
    leave_out = [report]
    searched = {storage.absolute_location(str(location)) for location in inputs}
    if not storage.is_url(folder):
        leave_out += [Path(folder, name) for name in records]
        if folder not in searched:
            leave_out.append(Path(folder))
    return find_inputs([str(location) for location in inputs], recursive, leave_out)


def _refuse_to_replace(outputs: Sequence[Output], begun: float | None, hint: str) -> None:
    """Refuse to replace existing files, except those made by the run to be resumed.

    An input that cannot be read is told first: its output would not be written, anyway.
    """
    taken = [
        target
        for target in storage.existing([output.target for output in outputs])
        if begun is None or not _made_since(target, begun)
    ]
    if taken:
        for output in outputs:
            if output.target in taken and not storage.is_url(output.source):
                check_source(Path(output.source))
        more = ", ..." if len(taken) > _NAMED_AT_MOST else ""
        raise InputError(
            f"{len(taken)} of the outputs already exist "
            f"({', '.join(taken[:_NAMED_AT_MOST])}{more}): choose another folder, replace them "
            f"with --overwrite, or {hint}"
        )


def _made_since(target: str, begun: float) -> bool:
    if storage.is_url(target):
        return True  # its modification time may be unreliable
    path = Path(target)
    return path.is_file() and path.stat().st_mtime >= begun - _CLOCK_SLACK
