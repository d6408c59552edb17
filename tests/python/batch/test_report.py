"""The report of a batch, and what a later run may conclude from it."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from meshlab_spectral import BatchError, InputError
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.report import Report, check_report, read_report
from meshlab_spectral.batch.resume import done_records, proved_done
from meshlab_spectral.batch.storage import digest
from meshlab_spectral.files.request import Request

VERSIONS = {"meshlab_spectral": "1", "core": "2", "pymeshlab": "3", "python": "4"}
AWKWARD = 'a "\\\n\r\té\u2028\udcff{}'
RECORDS = st.lists(
    st.dictionaries(st.sampled_from(["a", "b", "c"]), st.integers() | st.text(AWKWARD)), max_size=5
)
REUSED_FOLDER = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


def write_report(path: Path, records: list[dict[str, Any]]) -> None:
    with Report(path) as report:
        for record in records:
            report.add("file", record)


@REUSED_FOLDER
@given(records=RECORDS, more=RECORDS, cut=st.integers(0, 200))
@example(records=[{"a": "\udcff"}], more=[], cut=1)
def test_a_report_cut_off_anywhere_keeps_its_whole_lines_and_can_be_continued(
    records: list[dict[str, Any]], more: list[dict[str, Any]], cut: int, tmp_path: Path
) -> None:
    path = tmp_path / "report.jsonl"
    path.unlink(missing_ok=True)
    write_report(path, records)
    content = path.read_bytes()
    kept = content[: max(0, len(content) - cut)]
    path.write_bytes(kept)
    write_report(path, more)
    whole = kept.count(b"\n")
    expected = [{"kind": "file"} | record for record in records[:whole]]
    rest = kept.rpartition(b"\n")[2]
    if whole < len(records) and rest and is_json(rest):  # only its line break was cut off
        expected.append({"kind": "file"} | records[whole])
    expected += [{"kind": "file"} | record for record in more]
    assert list(read_report(path)) == expected


def is_json(text: bytes) -> bool:
    try:
        json.loads(text.decode(errors="surrogateescape"))
    except ValueError:
        return False
    return True


def test_a_missing_report_is_empty(tmp_path: Path) -> None:
    assert list(read_report(tmp_path / "none.jsonl")) == []


def test_two_batches_cannot_write_one_report(tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    with Report(path), pytest.raises(BatchError, match="another batch"):
        Report(path)
    with Report(path):
        pass


@pytest.mark.parametrize("content", ["", '{"ki', '{"kind": "run"}\n'])
def test_a_report_is_recognized_by_its_beginning(content: str, tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    check_report(path)
    path.write_text(content)
    check_report(path)


@pytest.mark.parametrize("content", ["ply\nformat ascii 1.0\n", "{}", '{"kinds": 3}', "\n"])
def test_a_file_that_is_not_a_report_is_refused(content: str, tmp_path: Path) -> None:
    path = tmp_path / "precious.ply"
    path.write_text(content)
    with pytest.raises(InputError, match=r"precious\.ply is not a batch report"):
        check_report(path)


def test_a_line_written_in_parts_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    with Report(path) as report:
        file = report._file
        parts = MagicMock(wraps=file)
        parts.write = lambda part: file.write(part[:5])
        report._file = parts
        report.add("file", {"name": "a long one", "reason": "longer than a part"})
    (record,) = read_report(path)
    assert record["name"] == "a long one"


def test_a_report_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BatchError, match=r"file/report\.jsonl"):
        Report(tmp_path / "file" / "report.jsonl")


def test_a_record_holds_only_numbers_that_json_can_represent() -> None:
    report = {"a": math.nan, "b": [1.0, math.inf], "c": {"d": -math.inf}}
    record = FileResult("filtered", "in", "out", "out", report=report).as_record()
    assert record["report"] == {"a": None, "b": [1.0, None], "c": {"d": None}}


FOREIGN_LINES = {
    "run without a begin": '{"kind": "run", "files": 1}',
    "begin that is no time": '{"kind": "run", "begun": "today"}',
    "begin before all times": '{"kind": "run", "begun": -1.0}',
    "begin without end": '{"kind": "run", "begun": NaN}',
    "side files in a list": '{"kind": "file", "name": "a.ply", "side_files": []}',
    "no side files": '{"kind": "file", "name": "a.ply", "side_files": null}',
    "name that is none": '{"kind": "file", "name": ["a.ply"]}',
    "name with a zero byte": '{"kind": "file", "name": "a\\u0000.ply"}',
    "name that no file can have": '{"kind": "file", "name": "\\ud800.ply"}',
    "warnings as a number": '{"kind": "file", "warnings": 3}',
    "report as a list": '{"kind": "file", "report": [1]}',
    "deep nesting": '{"kind": "file", "x": ' + 10_000 * "[" + 10_000 * "]" + "}",
}


@pytest.mark.parametrize("case", FOREIGN_LINES)
def test_a_line_that_no_batch_writes_is_reported_with_the_file(case: str, tmp_path: Path) -> None:
    path = tmp_path / "report.jsonl"
    path.write_text('{"kind": "run", "begun": 3.0}\n' + FOREIGN_LINES[case] + "\n")
    with pytest.raises(BatchError, match="line 2 of the report") as error:
        list(read_report(path))
    assert str(path) in str(error.value)
    assert "--report" in str(error.value)


@pytest.fixture
def done(tmp_path: Path) -> tuple[Job, dict[str, Any]]:
    """A job, and the record that proves it done."""
    source, target = tmp_path / "in.ply", tmp_path / "out.ply"
    source.write_bytes(b"input")
    target.write_bytes(b"output")
    options = {"feature_size": "2%", "steps": 3}
    job = Job(str(source), str(target), "out.ply", Request(Path()), options)
    result = FileResult(
        outcome="filtered",
        input=job.source,
        output=job.target,
        name=job.name,
        options=options,
        report={"steps": 3},
        input_sha256=digest(source),
        output_sha256=digest(target),
        versions=VERSIONS,
    )
    return job, {"kind": "file"} | json.loads(json.dumps(result.as_record()))


def proved(job: Job, *records: dict[str, Any], **versions: str) -> bool:
    return job in proved_done([job], done_records(records), VERSIONS | versions)


def test_a_record_proves_its_job_done_and_gives_its_report(done: tuple[Job, Any]) -> None:
    job, record = done
    result = proved_done([job], done_records([record]), VERSIONS)[job]
    assert result.outcome == "already done"
    assert result.report == {"steps": 3}


@pytest.mark.parametrize("what", ["input", "output", "no input", "no output"])
def test_a_changed_file_proves_nothing(what: str, done: tuple[Job, Any]) -> None:
    job, record = done
    path = Path(job.source if "input" in what else job.target)
    path.unlink()
    if "no " not in what:
        path.write_bytes(b"changed")
    assert not proved(job, record)


def test_other_options_prove_nothing(done: tuple[Job, Any]) -> None:
    job, record = done
    assert not proved(dataclasses.replace(job, options={"feature_size": "3%"}), record)


@pytest.mark.parametrize("name", ["meshlab_spectral", "core", "pymeshlab"])
def test_other_software_proves_nothing(name: str, done: tuple[Job, Any]) -> None:
    assert not proved(*done, **{name: "other"})


def test_another_python_proves_as_well(done: tuple[Job, Any]) -> None:
    assert proved(*done, python="other")


@pytest.mark.parametrize(
    "change",
    [
        {"outcome": "failed"},
        {"kind": "run"},
        {"name": "other.ply"},
        {"versions": None},
        {"input_sha256": None},
        {"output_sha256": None},
    ],
)
def test_a_record_of_something_else_proves_nothing(
    change: dict[str, Any], done: tuple[Job, Any]
) -> None:
    job, record = done
    assert not proved(job, record | change)


@REUSED_FOLDER
@given(order=st.permutations(range(4)))
def test_one_record_that_proves_is_enough_whatever_others_there_are(
    order: list[int], done: tuple[Job, Any]
) -> None:
    job, record = done
    records = [
        record,
        record | {"outcome": "failed"},
        record | {"options": {}},
        record | {"output_sha256": "other"},
    ]
    assert proved(job, *[records[k] for k in order])
