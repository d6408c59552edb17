"""Filtering many meshes in worker processes, with a report of what happened to each.

In the order of the data: `inputs` finds the files, `outputs` names the results, `resume` tells what
an earlier run has done, `plan` makes of these the `jobs` that are left; `engine` has Dask give each
to a worker, where `task` does it in one of MeshLab's `processes`; `report` keeps the results.
`files` puts these together, `storage` knows paths and URLs, `spectra` measures instead of filters.
"""
