"""The door to exudyn: bodies, beams and their linearised equations. Nothing else in massline imports it."""

from fem.exudyn.frame import floating_frame
from fem.exudyn.linear import dynamic_mass, modes, modes_of_plan, modes_of_solid

__all__ = ["dynamic_mass", "floating_frame", "modes", "modes_of_plan", "modes_of_solid"]
