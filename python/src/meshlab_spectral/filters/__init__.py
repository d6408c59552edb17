"""The plugin's filters, for meshes given as arrays.

`fractional`, `signals`, `artefacts`, `harmonics` and `spectrum` each call one filter, through
`calling` and `arrays`; `options` has the tables of their options, `transfer` the gain of the
fractional filter.
"""
