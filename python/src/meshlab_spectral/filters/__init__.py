"""The plugin's filters, for meshes given as arrays.

`fractional`, `signals`, `artefacts`, `harmonics` and `spectrum` each call one filter, through
`calling` and `arrays`; `options` is the table of the fractional filter's options, `transfer` its
gain.
"""
