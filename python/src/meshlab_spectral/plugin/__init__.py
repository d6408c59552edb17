"""The plugin: its libraries and everything that is not about a single filter.

`loading` makes it known to pymeshlab, `installation` to MeshLab; `threads` sets its number of
threads, `versions` identifies it, `last_warnings` asks it what fell short.
"""
