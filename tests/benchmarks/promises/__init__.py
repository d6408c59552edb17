"""What README, benchmarks and earlier work promise, asked of this tree: `make promises`."""

import os

# Before NumPy is loaded: many small eigenproblems take longer with several threads than with one.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
