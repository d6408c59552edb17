"""The plugin's filters, for meshes given as arrays.

`fractional`, `artefacts`, `harmonics` and `spectrum` each call one filter; `options` is the table
of the fractional filter's options, `transfer` its gain. All of them use `calling` and `arrays`.
"""
