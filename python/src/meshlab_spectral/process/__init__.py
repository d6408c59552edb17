"""A child process in which MeshLab works on files.

`child` is the program that runs there, `parent` starts and watches it, `single_file` uses one for
a single call.
"""
