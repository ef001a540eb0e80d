"""Pictures of structures in space, still and moving: the door to pyvista."""
