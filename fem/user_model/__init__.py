"""Models that users bring: modal data or matrices from HDF5, npz and Nastran. The door to pyyeti's readers.

=================== ================================================================================================
reading             `read`, `load`, `is_model`: from a path to `Structure` or `Modes`; `load` with name and damping
writing             `write`: a `Structure` or `Modes` into a file that `read` takes
description         the TOML text that says what bare numbers mean
units               systems of units such as mm-t-N-s
contents            the arrays of a file by name, each judged: there, numbers, finite, real, of the right shape
hdf5, npz, nastran  the readers of the files
dof_map             which motion every row is, and what it does when the base moves
matrices, modal     arrays to `Structure` and to `Modes`, with everything that mechanics knows of them
definite, stated    symmetry, signs of eigenvalues, rigid bodies, slips of units
=================== ================================================================================================

The formats are described in ``docs/own-model.md``."""

from fem.user_model.reading import UsersModel, is_model, load, read, write

__all__ = ["UsersModel", "is_model", "load", "read", "write"]
