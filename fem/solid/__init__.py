"""The solid model: meshes by gmsh, stiffness and mass by scikit-fem. The door to both."""
