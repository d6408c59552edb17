"""Mesh files as documents: coordinates are read and replaced, and everything else stays.

`opening` chooses the module for a file; `document` is what all of them offer.
"""
