"""The filters free the memory that they take: many runs in one process do not make it grow."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import python
from meshlab_spectral.plugin.loading import FILTERS

RUNS, WARM_UP = 40, 10
SLOW, FEWER_RUNS = "get_geometry_spectrum", 25  # half a second each
# Thirty leaks of a matrix of the cow's harmonics would be 14 MiB. Memory kept by malloc would add
# noise of 10 MiB, hence `malloc_trim` and one arena. A MeshSet's history of runs takes 20 kB each.
MEBIBYTES_OF_NOISE = 4.0
ONE_ARENA = {"MALLOC_ARENA_MAX": "1"}

PROGRAM = """
import ctypes, json, re, sys
from pathlib import Path
import meshlab_spectral, pymeshlab

def resident_mebibytes():
    ctypes.CDLL(None).malloc_trim(0)
    status = Path("/proc/self/status").read_text()
    return int(re.findall(r"VmRSS:\\s+([0-9]+)", status)[0]) / 1024

meshlab_spectral.load()
ms = pymeshlab.MeshSet()
ms.load_new_mesh(sys.argv[1])
name = sys.argv[2]
ms.compute_scalar_by_function_per_vertex(q="sin(9 * x)")
ms.compute_color_from_scalar_per_vertex()
known = ms.filter_parameter_values(name)
used = []
for run in range(int(sys.argv[3])):
    varied = {
        "feature_size": pymeshlab.PercentageValue(2 + run % 10),
        "basis_size": 20 + run % 10,
        "store_basis": run % 2 == 0,
        "steps": 1,
        "stop_gain": 0.9,
        "gain_2x": 0.5,
    }
    ms.apply_filter(name, **{key: varied[key] for key in varied.keys() & known.keys()})
    used.append(resident_mebibytes())
print(json.dumps(used))
"""


@pytest.mark.parametrize("name", FILTERS.values())
def test_forty_runs_need_no_more_memory_than_the_first_ten(name: str, cow: Path) -> None:
    runs = FEWER_RUNS if name == SLOW else RUNS
    done = python("-c", PROGRAM, cow, name, runs, **ONE_ARENA)
    assert done.returncode == 0, done.stderr
    used = json.loads(done.stdout.splitlines()[-1])
    assert max(used[WARM_UP:]) - max(used[:WARM_UP]) < MEBIBYTES_OF_NOISE, used
