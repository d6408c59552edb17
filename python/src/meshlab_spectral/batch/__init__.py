"""Filtering many meshes in worker processes, with a report of what happened to each.

In the order of the data: `inputs` finds the files, `outputs` names the results, `jobs` says what is
to be done with one file, `resume` takes out what an earlier run has done, `engine` has Dask run the
rest, `task` is what runs in a worker, `report` keeps the results; `files` puts these together.
"""
