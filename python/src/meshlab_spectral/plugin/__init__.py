"""The plugin: its libraries and everything that is not about a single filter.

`loading` makes it known to pymeshlab, `installation` to MeshLab; `limits` sets its number of
threads and its memory, `versions` identifies it, `library` has its functions that are no filters.
"""
