"""Filtering many meshes in worker processes, with a report on each.

`settings` are what a user may choose. In the order of the data: `inputs` finds the files, `outputs`
names the results, `resume` recognizes what an earlier run has done, `plan` turns all this into the
remaining `jobs`; `engine` sends them through Dask to workers, where `task` runs each in one of
MeshLab's `processes`; `report` records the results. `files` combines these, `storage` handles paths
and URLs, `spectra` measures instead of filtering.
"""
