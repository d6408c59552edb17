"""Pictures and plots of manifold harmonics and geometry spectra.

`pictures` renders meshes, `sheet` arranges them on a page. Needs the extras
`plots` and `render`.
"""
