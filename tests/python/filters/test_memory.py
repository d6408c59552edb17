"""The plugin gives back the memory that it took: many runs in one process do not let it grow."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

RUNS, WARM_UP = 40, 10
# The matrices of one run on the bunny take 40 MiB.
MEBIBYTES_OF_NOISE = 8.0

PROGRAM = """
import json, re, sys
from pathlib import Path
import meshlab_spectral, pymeshlab

def resident_mebibytes():
    status = Path("/proc/self/status").read_text()
    return int(re.findall(r"VmRSS:\\s+([0-9]+)", status)[0]) / 1024

meshlab_spectral.load()
ms = pymeshlab.MeshSet()
ms.load_new_mesh(sys.argv[1])
used = []
for run in range(int(sys.argv[2])):
    size = pymeshlab.PercentageValue(2 + run % 10)
    ms.apply_coord_spectral_filter_fractional(feature_size=size, steps=1, stop_gain=0.9)
    used.append(resident_mebibytes())
print(json.dumps(used))
"""


def test_forty_runs_need_no_more_memory_than_the_first_ten(samples: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(samples / "bunny.obj"), str(RUNS)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    used = json.loads(done.stdout.splitlines()[-1])
    assert max(used[WARM_UP:]) - max(used[:WARM_UP]) < MEBIBYTES_OF_NOISE, used
