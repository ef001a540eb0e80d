"""The door to exudyn: bodies, beams and their linearised equations. Nothing else in massline imports it."""

from fem.exudyn.linear import modes, modes_of_plan

__all__ = ["modes", "modes_of_plan"]
