"""Pictures and plots: the figures of the paper, manifold harmonics, geometry spectra.

`pictures` renders meshes, `sheet` lays pictures out on a page. They need the extra `pictures`.
"""
