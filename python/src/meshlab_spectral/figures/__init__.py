"""Pictures and plots: the figures of the paper, manifold harmonics, geometry spectra.

`pictures` renders meshes, `sheet` arranges them on a page. Needs the extras
`plots` and `render`.
"""
