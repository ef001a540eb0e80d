"""Models that users bring: modal data or matrices from HDF5, npz and Nastran. The door to pyyeti's readers.

============ ===============================================================================================================
reading      `read`, `load`, `is_model`: from a path (HDF5, npz, Nastran) to `Structure` or `Modes`; `write` the other way
description  the TOML text that says what bare numbers mean, systems of units, and the arrays of a file, each judged
nastran      the reader of pyyeti's files
matrices     arrays to `Structure`: which motion every row is, symmetry, signs of eigenvalues, rigid bodies, slips of units
modal        arrays to `Modes`
============ ===============================================================================================================

The formats are described in ``docs/own-model.md``."""

from fem.user_model.reading import UsersModel, is_model, load, read, write

__all__ = ["UsersModel", "is_model", "load", "read", "write"]
