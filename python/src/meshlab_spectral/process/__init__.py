"""A child process that runs MeshLab.

`child` is its program, `parent` starts and watches it, `single_file` uses one per call.
"""
