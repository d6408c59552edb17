"""Reading and writing files: meshes, bases, recipes and filter scripts.

`meshes` reads meshes, `filtering` filters and `measures` measures them, as a `request` says;
`whole_files` writes outputs atomically.
"""
