"""Signals from and to files: universal files, HDF5, CSV, MATLAB."""
