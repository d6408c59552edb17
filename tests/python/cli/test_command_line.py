"""What all commands have in common: help, how much they print, outputs, usage errors."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from batches import make_meshes
from commands import assert_fails, command, messages_in, python, succeeded, write_ply
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.cli import many_files, progress
from meshlab_spectral.cli.app import app
from meshlab_spectral.cli.messages import VERBOSITY
from typer.main import get_command

COMMANDS = sorted(get_command(app).commands)
SECTION = re.compile(r"^(\S.*):$", re.MULTILINE)


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_a_short_option_and_lists_the_common_options(name: str) -> None:
    done = succeeded(name, "--help", COLUMNS="80")
    assert done.stdout == command(name, "-h", COLUMNS="80", LINES="1000").stdout
    for option in ("-q, --quiet", "-v, --verbose", "-h, --help"):
        assert option in done.stdout
    if "--output" in done.stdout:
        assert "-o, --output" in done.stdout
    assert "--debug" not in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_the_manual_page_has_the_help_of_every_command() -> None:
    page = command("--man", COLUMNS="80").stdout
    assert page.startswith(".TH MESHLAB-SPECTRAL 1 ")
    assert re.findall(r"^\.SH (.*)$", page, re.MULTILINE)[2:] == [
        name.upper() for name in get_command(app).commands
    ]
    for option in FilterOptions().as_dict():
        assert "\\-\\-" + option.replace("_", "\\-") in page
    if shutil.which("groff"):
        shown = ["groff", "-man", "-ww", "-z"]
        done = subprocess.run(shown, input=page, capture_output=True, text=True, check=True)
        assert done.stderr == ""


def test_the_short_help_names_every_option_on_one_screen() -> None:
    brief = command("filter", "-h", COLUMNS="80", LINES="40").stdout
    whole = command("filter", "--help", COLUMNS="80", LINES="40").stdout
    assert len(brief.splitlines()) < 40 < len(whole.splitlines())
    assert "explained by meshlab-spectral filter --help" in brief
    options = set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", whole, re.MULTILINE))
    assert len(options) > 40
    assert options <= set(brief.split())
    assert max(map(len, brief.splitlines())) <= 80


@pytest.mark.parametrize("name", ["filter", "denoise", "batch"])
def test_help_has_options_in_groups(name: str) -> None:
    text = command(name, "--help", COLUMNS="80").stdout
    assert "{" not in text.splitlines()[0]
    sections = SECTION.findall(text)
    assert sections[0] == "Arguments"
    assert sections[-1] == "Options"
    assert {"Filter", "Region", "Output"} <= set(sections)
    assert text.rpartition("\nOptions:")[2].count("\n  -") == 3
    tables = (DenoiseOptions,) if name == "denoise" else (FilterOptions,)
    for option in [option for table in tables for option in table().as_dict()]:
        assert text.count(f"\n  --{option.replace('_', '-')} ") == 1, option
    if name == "batch":
        group = text.partition("\nWith --denoise:")[2].partition("\n\n")[0]
        names = DenoiseOptions().as_dict().keys() - FilterOptions().as_dict().keys()
        options = {name.replace("_", "-") for name in names}
        assert set(re.findall(r"^  --([a-z-]+)", group, re.MULTILINE)) == options


def test_quiet_leaves_errors_warnings_and_requested_output(cow: Path, tmp_path: Path) -> None:
    flat = write_ply(tmp_path / "flat.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    out = tmp_path / "out.ply"
    done = command("filter", flat, out, "--boundary", "fixed", "-q")
    assert (done.returncode, done.stdout) == (0, "")
    assert re.fullmatch(r"Warning: nothing can move.*\n", done.stderr)
    done = command("denoise", cow, tmp_path / "cow.obj", "--quiet", "--json")
    assert json.loads(done.stdout)["report"]["components"] > 0
    assert_fails(
        command("filter", tmp_path / "none.ply", tmp_path / "x.ply", "-q"), 1, "does not exist"
    )
    bad = tmp_path / "bad.ply"
    bad.write_text("bad")
    arguments = [cow, flat, bad, "--output", tmp_path / "out", "--steps", 1, "--workers", 1]
    done = command("batch", *arguments, "--boundary", "fixed", "-q")
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(r"Failed: .*bad\.ply.*\nWarning: flat\.ply: .*\n", done.stderr)


def test_verbose_adds_every_number_and_meshlabs_log(cow: Path, tmp_path: Path) -> None:
    arguments = ["filter", cow, tmp_path / "cow.obj", "--overwrite", "--steps", 2]
    report = json.loads(command(*arguments, "--json").stdout)["report"]
    done = command(*arguments, "-v")
    for name in report.keys() - {"warnings", "warning_codes"}:
        assert re.search(rf"\b{name}\b", done.stdout), name
    assert "0.5, 0.5" in done.stdout
    assert "Spectral Filter: low-pass at feature size" in done.stderr
    assert "LOG:" not in done.stderr
    assert "%]" not in done.stderr.replace(" ", "")  # but for progress
    assert "low-pass at" not in command(*arguments).stderr
    assert_fails(command(*arguments, "-v", "-q"), 2, "--quiet: cannot be combined with --verbose")


def test_an_output_is_named_by_position_or_by_option(cow: Path, tmp_path: Path) -> None:
    one, other = tmp_path / "one.obj", tmp_path / "other.obj"
    succeeded("filter", cow, one, "--steps", 1)
    succeeded("filter", cow, "-o", other, "--steps", 1)
    assert one.read_bytes() == other.read_bytes()
    assert_fails(command("filter", cow, one, "-o", other), 2, f"--output: OUTPUT is {one} already")


@pytest.mark.parametrize(
    ("arguments", "first", "help_of"),
    [
        (["filter", "a", "b", "--feature-siz", "1"], "there is no option --feature-siz: did you "
         "mean --feature-size", " filter"),
        (["batch", "a", "-o", "b", "--resum"], "there is no option --resum: did you mean --resume",
         " batch"),
        (["filter", "a", "b", "-x"], "there is no option -x", " filter"),
        (["filter", "a"], "OUTPUT: name the mesh to write", " filter"),
        (["info"], "MESH is missing", " info"),
        (["batch", "a"], "--output is missing", " batch"),
        (["denoise", "a", "b", "c"], "got unexpected extra argument", " denoise"),
        (["filter", "a", "b", "--steps"], "option '--steps' requires an argument", " filter"),
        (["filter", "a", "b", "--steps", "x"], "--steps: ", " filter"),
        (["filter", "a", "b", "--feature-size", "big"], "--feature-size: 'big': give a", " filter"),
        (["filter", "a", "b", "--response", "bell"], "--response: 'bell' is not one of", " filter"),
        (["basis", "a", "--modes", "one"], "--modes: 'one': give numbers", " basis"),
        (["denois", "a", "b"], "no such command 'denois': did you mean 'denoise'", ""),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)  # fmt: skip
def test_a_usage_error_is_one_line_and_the_help_to_read(
    arguments: list[str], first: str, help_of: str
) -> None:
    done = command(*arguments)
    assert_fails(done, 2)
    error, see = done.stderr.splitlines()
    assert error.startswith(f"Error: {first}")
    assert see == f"See: meshlab-spectral{help_of} --help"


def test_without_a_command_the_help_is_shown() -> None:
    done = command()
    assert done.returncode == 2
    assert done.stderr == command("--help").stdout


def test_long_runs_have_plain_progress_every_few_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    with progress.progress_shown() as on_progress:
        for now in (101.0, 104.9, 105.0, 106.0, 112.0, 113.0):
            on_progress("step 3 of 10", (now - 100) / 20)
        now = 118.0
        on_progress("writing", None)
    lines = ["[5 s] step 3 of 10, 25%", "[12 s] step 3 of 10, 60%", "[18 s] writing"]
    assert capsys.readouterr().err.splitlines() == lines
    monkeypatch.setattr(VERBOSITY, "quiet", True)
    with progress.progress_shown() as on_progress:
        now = 200.0
        on_progress("writing", None)
    assert capsys.readouterr().err == ""


def test_a_file_that_does_not_change_counts_as_unchanged(tmp_path: Path) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    make_meshes(source, 2)
    flat = write_ply(source / "flat.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    options = ["--boundary", "fixed", "--steps", 1, "--feature-size", "2e", "--workers", 1]
    done = command("batch", source, "--output", out, *options)
    assert "2 filtered, 0 failed, 1 unchanged, 1 with warnings in " in done.stdout
    assert "] flat.ply: unchanged\n" in done.stderr
    assert re.fullmatch(r"Warning: flat\.ply: nothing can move.*\n", messages_in(done.stderr))
    same = [flat, tmp_path / "flat.ply"]
    done = command("filter", *same, "--boundary", "fixed")
    assert done.stdout.startswith("flat.ply -> flat.ply: unchanged")
    assert same[0].read_bytes() == same[1].read_bytes()


def test_warnings_of_many_files_are_shown_by_name_and_all_in_the_report(tmp_path: Path) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    source.mkdir()
    for number in range(7):
        write_ply(source / f"flat_{number}.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    batch = ["batch", source, "--output", out, "--boundary", "fixed", "--steps", 1, "--workers", 1]
    done = command(*batch)
    (told,) = messages_in(done.stderr).splitlines()
    names = ", ".join(f"flat_{k}.ply" for k in range(1, 5))
    assert told.startswith(f"Warning: flat_0.ply and 6 more ({names}, ...): nothing can move")
    done = command(*batch, "--resume", "--json", "-v")
    assert ", flat_6.ply): nothing can move" in done.stderr
    summary = json.loads(done.stdout)
    assert (summary["already_done"], summary["with_warnings"]) == (7, 7)
    (group,) = summary["warnings"]
    assert group["files"] == [f"flat_{k}.ply" for k in range(7)]
    last = json.loads((out / "batch_report.jsonl").read_text().splitlines()[-1])
    assert (last["with_warnings"], last["warnings"]) == (7, [group])


def test_hundreds_of_warnings_are_cut_short_unless_all_are_asked_for(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    groups = [{"warning": f"kind {k}", "files": ["a.ply", "b.ply"]} for k in "abcdefghijk"]
    many_files._print_warnings(groups, Path("report.jsonl"))
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "Warning: a.ply and 1 more (b.ply): kind a."
    assert lines[10:] == ["Warning: 1 more, see them with --verbose or at the end of report.jsonl."]
    monkeypatch.setattr(VERBOSITY, "verbose", True)
    many_files._print_warnings(groups, Path("report.jsonl"))
    assert len(capsys.readouterr().err.splitlines()) == len(groups)


@pytest.mark.parametrize("name", ["filter", "denoise", "info"])
def test_a_command_starts_without_slow_imports(name: str) -> None:
    """They are left to the child process, which starts at the same time."""
    program = (
        f"import sys; sys.argv = ['meshlab-spectral', '{name}']; import meshlab_spectral.cli.app; "
        "print({'numpy', 'plyfile', 'pyvista', 'matplotlib'} & sys.modules.keys())"
    )
    done = python("-c", program)
    assert done.stdout == "set()\n", done.stderr
