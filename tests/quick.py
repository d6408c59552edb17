"""The tests of what has changed since main, and those of the contract: `make quick`.

A changed file has the tests that bear its name, such as test_texture.py for filters/texture.py, and
those that import it; if there are none, those of its folder. Tests above two seconds are left out,
see `slow` in CONTRIBUTING.md.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = Path("python/src/meshlab_spectral")
CONTRACT = {Path("tests/core/contract"), Path("tests/python/core")}
# Sources whose tests are elsewhere.
ELSEWHERE = {
    Path("plugin/meshlab"): Path("tests/python/plugin"),
    Path("plugin/python"): Path("tests/python/core"),
    Path("screenshots"): Path("tests/python/figures"),
}
SECONDS = 40  # of pytest: a minute with the start of everything


def git(*arguments: str) -> list[str]:
    command = ["git", "-C", str(ROOT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()


def changed_files() -> list[Path]:
    base = git("merge-base", "HEAD", "main") or ["HEAD"]
    changed = git("diff", "--name-only", base[0])
    changed += git("ls-files", "--others", "--exclude-standard")
    return [Path(name) for name in changed]


def tests_of(changed: Path) -> Iterable[Path]:
    """Return files and folders with tests, relative to the top folder."""
    if changed.parts[0] == "tests":
        folder = changed.parent
    elif changed.is_relative_to(PACKAGE):
        folder = "tests/python" / changed.parent.relative_to(PACKAGE)
    elif changed.is_relative_to("plugin/core"):
        folder = "tests/core" / changed.parent.relative_to("plugin/core")
    else:
        return [to for start, to in ELSEWHERE.items() if changed.is_relative_to(start)]
    stem = changed.stem.removeprefix("test_").removesuffix("_test")
    named = {*(ROOT / folder).glob(f"test_{stem}*.py"), *(ROOT / folder).glob(f"{stem}_test.cpp")}
    if changed.is_relative_to(PACKAGE):
        module = ".".join(changed.relative_to(PACKAGE.parent).with_suffix("").parts)
        tests = (ROOT / "tests" / "python").rglob("test_*.py")
        named.update(test for test in tests if f"{module} import" in test.read_text())
    if named:
        return [one.relative_to(ROOT) for one in named]
    # Helpers of all tests would mean all of them.
    return [folder] if folder.parts[:1] == ("tests",) and len(folder.parts) > 2 else []


def suites_in(paths: Iterable[Path]) -> list[str]:
    """Return the names of the C++ tests' suites in files and folders."""
    suites: set[str] = set()
    for path in paths:
        for file in [ROOT / path] if path.suffix else (ROOT / path).glob("*_test.cpp"):
            if file.suffix == ".cpp":
                suites.update(re.findall(r"^TEST\w*\((\w+),", file.read_text(), re.MULTILINE))
    return sorted(suites)


def main() -> int:
    found = CONTRACT.union(*(tests_of(changed) for changed in changed_files()))
    present = sorted(path for path in found if (ROOT / path).exists())
    ours = [str(path) for path in present if path.is_relative_to("tests/python")]
    print("Tests of", *present, flush=True)
    processes = str(os.cpu_count() or 1)
    suites = "|".join(suites_in(present))
    ctest = ["ctest", "--test-dir", "build", "--output-on-failure", "--no-tests=error"]
    ctest += ["--parallel", processes, "--label-exclude", "slow"]
    ctest += ["--tests-regex", rf"^({suites})\."]
    pytest = [sys.executable, "-m", "pytest", "-c", "python/pyproject.toml", "--rootdir", "."]
    pytest += ["-q", "--numprocesses", processes, "-m", "not slow", f"--seconds={SECONDS}", *ours]
    return max([subprocess.run(each, cwd=ROOT, check=False).returncode for each in (ctest, pytest)])


if __name__ == "__main__":
    raise SystemExit(main())
