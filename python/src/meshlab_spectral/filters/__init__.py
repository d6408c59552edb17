"""The plugin's filters, for meshes given as arrays.

`fractional`, `denoise`, `signals`, `artefacts`, `harmonics`, `spectrum` and `texture` call the
filters through `arrays` and `running`; `options` has the tables of their options, `transfer` the
gain of the fractional filter.
"""
