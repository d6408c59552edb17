"""Filtering of meshes that do not fit in memory: in overlapping tiles, from file to file.

A filter of a feature size is local: beyond some feature sizes, nothing changes a vertex noticeably.
`survey` measures the whole, `cells` divide space, `halo` says how far a filter reaches, `exchange`
hands every face to each tile that needs it and writes the output, `tile` filters one of them in a
child process, and `plan` knows the folder in which all of that is. `run` does all of it by
`workers`; `whole_or_tiles` says when, and `one_file` is what users call.
"""

MOST_TILES = 4096
