"""Models that users bring, modal data or matrices from HDF5, npz and Nastran (``docs/own-model.md``); the door to pyyeti."""
