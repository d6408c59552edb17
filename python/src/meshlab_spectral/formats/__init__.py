"""Formats of mesh files: new coordinates are written into a file, all its other bytes are kept.

`opening` chooses the module for a file; `document` is their common interface. They know nothing of
filters.
"""
