"""The workbench without its face: what a window may be asked to do, as data and verbs, and its state on disk."""
