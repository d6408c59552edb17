"""Filtering many meshes in worker processes, with a report on each.

`settings` holds what a user may choose. In order of processing, `inputs` finds the files, `outputs`
names the results, `resume` recognizes what an earlier run has done, and `plan` turns all this into
the remaining `jobs`; `engine` distributes them to workers, `local` or on a Dask `cluster`, where
`task` does each in a MeshLab process from `processes`; `report` records the results. `files`
combines these, `storage` handles paths and URLs, `spectra` measures instead of filtering.

`tiles` divides one file into `tile_jobs`, for the same workers, when `whole_or_tiles` says so.
"""
