"""Models that users bring: modal data or matrices from HDF5, npz and Nastran. The door to pyyeti's readers."""
