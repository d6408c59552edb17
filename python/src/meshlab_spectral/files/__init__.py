"""Reading and writing files: meshes, bases, recipes and filter scripts.

`meshes` reads, filters and writes a mesh; `whole_files` writes outputs atomically.
"""
