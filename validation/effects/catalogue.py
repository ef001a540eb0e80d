"""Where effects are found: the files of `validation/effects/families`, entry points ``massline.effects``, folders of a user.

A file is a family when it holds a `FAMILY`. The catalogue of a process only grows: `load` adds what a user brings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from types import MappingProxyType

from validation.effects.family import Family

ORDER = [
    "point-mass",
    "rigid-inertia",
    "modulus",
    "joint-compliance",
    "structural-damping",
    "layer-damping",
    "appendage",
    "absorber",
    "slosh",
    "cable",
    "orientation",
    "mounting-offset",
    "gravity",
    "force-gain",
    "load-path-shunt",
    "force-delay",
    "board-delay",
    "force-highpass",
    "force-crosstalk",
    "force-plane-offset",
    "fmd-compliance",
    "cell-stiffness",
    "accelerometer-gain",
    "accelerometer-delay",
    "accelerometer-position",
    "accelerometer-misalignment",
    "accelerometer-tilt",
    "cover-plate-flexibility",
    "polarity",
    "channel-swap",
    "unit",
    "friction",
    "gap",
    "saturation",
    "sweep-bias",
    "noise",
    "mains",
    "pendulum-amplitude",
    "pendulum-damping",
    "rope-mass",
    "rope-elasticity",
    "air-inertia",
    "off-centre-suspension",
]
"""Of the catalogue's page; what is not in it follows."""


def _built_in() -> Iterator[Family]:
    for name in ORDER:
        yield import_module(f"validation.effects.families.{name.replace('-', '_')}").FAMILY


_found: dict[str, Family] = {}

FAMILIES: Mapping[str, Family] = MappingProxyType(_found)
"""Every family by name, in the order of the catalogue."""

_found.update({family.name: family for family in _built_in()})
