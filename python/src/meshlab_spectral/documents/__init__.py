"""Mesh files as documents: coordinates are read and replaced, everything else is kept.

`opening` chooses the module for a file; `document` is their common interface.
"""
