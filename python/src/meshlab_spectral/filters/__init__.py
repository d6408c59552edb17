"""The plugin's filters, for meshes given as arrays.

`fractional`, `denoise`, `signals`, `artefacts`, `harmonics` and `spectrum` call the filters through
`calling` and `arrays`; `options` has the tables of their options, `transfer` the gain of the
fractional filter.
"""
