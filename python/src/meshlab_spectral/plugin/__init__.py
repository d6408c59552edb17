"""The plugin's libraries, and what concerns each as a whole.

`loading` makes its filters known to pymeshlab, `installation` puts it where MeshLab looks for it,
`threads` and `versions` set and tell what its results do and do not depend on.
"""
