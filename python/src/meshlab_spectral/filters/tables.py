"""The filters that files can be processed with, by the names of their tables in recipes."""

from __future__ import annotations

from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions

TABLES: dict[str, type[Options]] = {table.TABLE: table for table in (FilterOptions, DenoiseOptions)}
