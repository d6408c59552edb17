"""Child processes that read and filter meshes, on this machine or by the workers of a Dask cluster.

`process` starts and watches one child, whose program is `meshlab_spectral.child`; `single_file`
uses one per call. `processes` keeps several for many jobs, within the `memory` that there is;
`pool` runs jobs by `local` ones, or those of a Dask `cluster`.
"""
