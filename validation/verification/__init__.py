"""The verification table: what the prediction side computes beside closed forms, second sources and rates of convergence.

One module a family of rows; each ends in its `CHECKS`. `families` is the list of them all.
"""

from __future__ import annotations

from importlib import import_module

from validation.verification.check import Check

FAMILIES = {
    "beams": "beam elements",
    "sandwich": "sandwich beam",
    "solids": "solid elements",
    "essentials": "patch test, rigid body, units",
    "plates": "NAFEMS plates",
    "rods": "an article meshed by gmsh",
    "dynamic-mass": "dynamic mass",
    "exudyn": "exudyn's own beams",
    "time": "base excitation in time",
    "pendulum": "rope pendulum",
}
"""Families by the name that the command takes, in the order of the table."""

_MODULES = {"time": "base_excitation", "pendulum": "rope_pendulum", "dynamic-mass": "dynamic_mass", "exudyn": "exudyn_beams"}
"""Where the module of this package is not called like its family."""


def checks(*families: str) -> tuple[Check, ...]:
    """The rows of `families`, of all when none is named."""
    chosen = families or tuple(FAMILIES)
    return tuple(check for family in chosen for check in import_module(f"{__name__}.{_MODULES.get(family, family)}").CHECKS)
