"""The units of a user's model: three of them, the force as a check, or none that anybody remembers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.toml_file import LARGEST_QUANTITY, is_number, quantity

# The unit system of a user's model, ``mm-t-N-s``, and what its matrices are multiplied with to be SI.
#
# A finite-element program knows no units; it only needs force = mass × length / time². So a system is three units, and naming
# the force as well is a check that catches the commonest slip (kilograms beside millimetres and newtons).
#
# With displacements and rotations of the user u = u_SI / s (s is the unit of length for translations, 1 for rotations) energies
# agree when M_SI = m L² M / (s_i s_j), K_SI = m L² / T² K / (s_i s_j) and C_SI = m L² / T C / (s_i s_j). A generalised
# coordinate has no unit of its own; s = L m^0.5 leaves modes that are normalised to unit mass so.

KNOWN = ("m-kg-N-s", "mm-t-N-s", "mm-kg-mN-s", "mm-kg-kN-ms", "m-t-kN-s", "in-lbf-s", "ft-lbf-s")
"""Systems that a message may propose; any other one that pint can read and that is consistent does as well."""

UNKNOWN = "consistent"
"""Word for a system whose time is the second and whose length and mass nobody knows: frequencies are right all the same."""

CONSISTENT = 1e-6
"""A force may differ by this share from mass × length / time²: the standard inch and pound are exact, digits in names are not."""


@dataclass(frozen=True, kw_only=True)
class UnitSystem:
    """What one unit of a model is in SI.

    Attributes
    ----------
    name : as the user wrote it
    length, mass, time : [m], [kg], [s]
    """

    name: str
    length: float
    mass: float
    time: float

    @property
    def known(self) -> bool:
        """Whether a length, mass or force of this system can be said in SI; else numbers stay those of the file."""
        return self.name != UNKNOWN

    def coordinates(self, components: Integers) -> Array:
        """SI value (n,) of one unit of each degree of freedom, from its component 1 to 6, 0 for a generalised one."""
        scales = np.array([self.length * np.sqrt(self.mass), *3 * [self.length], *3 * [1.0]])
        return np.asarray(scales[components])

    @property
    def energy(self) -> float:
        """[J]"""
        return self.mass * self.length**2 / self.time**2

    @property
    def six(self) -> Array:
        """SI value (6,) of the lever arms of the six motions: none of x, y and z, the unit of length of the rotations."""
        return np.array([1.0, 1.0, 1.0, *3 * [self.length]])


SI = UnitSystem(name="m-kg-N-s", length=1.0, mass=1.0, time=1.0)


def unit_system(text: object, source: str, field: str = "fe_model.units") -> UnitSystem:
    """The system that `text` names: length-mass-force-time, or length-force-time where the mass follows; or `UNKNOWN`.

    Raises
    ------
    BadInput : not of that form, a unit not known or of another dimension, a force that is not mass × length / time².
    """
    if text == UNKNOWN:
        return UnitSystem(name=UNKNOWN, length=1.0, mass=1.0, time=1.0)
    words = [word.strip() for word in text.split("-")] if isinstance(text, str) else []
    if len(words) not in (3, 4):
        problem = f"must be length-mass-force-time, found {text!r}"
        raise BadInput(source, field, problem, f'Write one like {", ".join(KNOWN)}; or "{UNKNOWN}" where only the second is sure')
    dimensions = ("length", "mass", "force", "time") if len(words) == 4 else ("length", "force", "time")
    value = {}
    for name, word in zip(dimensions, words, strict=True):
        size = float(quantity(f"1 {word}", name, source=source, field=field).nominal_value)
        if size <= 0:
            problem = f"one {word!r} is nothing beside the {name} of any structure"
            raise BadInput(source, field, problem, f"Write a system like {', '.join(KNOWN)}")
        value[name] = size
    by_newton = value["force"] * value["time"] ** 2 / value["length"]
    mass = value.get("mass", by_newton)
    if abs(by_newton / mass - 1) > CONSISTENT:
        remedy = f"Name the units that the matrices were made with: {', '.join(KNOWN)} are consistent"
        raise BadInput(source, field, f"the force of {text} is {by_newton / mass:.6g} times mass × length / time²", remedy)
    return UnitSystem(name=str(text), length=value["length"], mass=mass, time=value["time"])


def measured(value: Any, dimension: str, units: UnitSystem, source: str, field: str) -> float:
    """`value` [SI] of `dimension`: text with its unit; in a system that is not `known` a bare number of that system, as it is.

    Raises
    ------
    BadInput : a bare number where units are known, a unit where they are not, no finite number.
    """
    bare = is_number(value)
    if units.known:
        return float(quantity(value, dimension, source=source, field=field).nominal_value)
    if not bare or not abs(value) < LARGEST_QUANTITY:
        problem = f"must be a bare number, as the units of the matrices are not known, found {value!r}"
        raise BadInput(source, field, problem, "Write it in the model's own unit, or name the system in fe_model.units")
    return float(value)
