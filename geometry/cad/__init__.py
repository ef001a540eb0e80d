"""The door to CadQuery and OCC: parametric solids, their exact B-rep inertia, tessellations and STEP files.

OCC's tolerances are absolute, so solids are built in millimetres; metres come back through `geometry.cad.solids.MM`.
Nothing outside this package imports cadquery or OCP.
"""
