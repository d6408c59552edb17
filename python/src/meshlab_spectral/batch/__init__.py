"""Filtering many meshes in worker processes, with a report on each.

`settings` holds what a user may choose. In order of processing, `inputs` finds the files, `outputs`
names the results, `resume` recognizes what an earlier run has done, and `plan` turns all this into
the remaining `jobs`, each of which `task` does in a worker; `report` records the results. `files`
combines these, `storage` handles paths and URLs, `spectra` measures instead of filtering.
"""
