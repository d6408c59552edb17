"""The plugin: its libraries, and everything that is not specific to one filter.

`loading` loads it into pymeshlab, `installation` installs it in MeshLab; `limits` sets its threads
and memory, `versions` identifies it, `library` has its functions other than filters.
"""
