"""Classes of laboratories: what is not known of a test, by what a laboratory has in hand, each figure with its source."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import radians
from types import MappingProxyType

from fem.mesh.places import ENERGY_TOO_HIGH
from geometry import toml_file
from geometry.sensors import Tolerances

# `metrology` is a laboratory that has calibrated its own chain against known masses and measured where all stands; `calibrated`
# one with certificates of its sensors; `as-delivered` one with data sheets alone. Of a limit, within which any figure is as
# good as another, the standard deviation is limit / sqrt(3) (GUM, JCGM 100:2008, 4.3.7); of an expanded uncertainty U with k =
# 2 it is U/2. A model file names a class in one line, and what it states itself goes before.


METROLOGY, CALIBRATED, AS_DELIVERED = NAMES = ("metrology", "calibrated", "as-delivered")


@dataclass(frozen=True, kw_only=True)
class StructureTolerances:
    """How well the structure is known beforehand; standard deviations, relative but for those from `damping_law` on
    that are called a share.

    Attributes
    ----------
    modulus : of every part's moduli
    mesh : of how much softer an endless mesh of a part would be, in the energy of the jumps of its strains
    frequency : of every mode's frequency, beside the moduli
    damping : of every part's loss factor, or of the logarithm of every mode's damping where that is given by mode
    mode_damping : of the logarithm of every mode's damping beside the loss factors of the parts
    damping_law : share of what parts lose that follows the velocity instead of the displacement
    loss_coupling : share of what they couple modes by that is not there, or losses told by mode once an effect turns the modes
    participation : of every mode's participation, along each axis, as a share of its largest
    mode_coupling : of the damping that couples two modes, as a share of the geometric mean of theirs
    """

    modulus: float = 0.025
    mesh: float = ENERGY_TOO_HIGH
    frequency: float = 0.0015
    damping: float = 0.35
    mode_damping: float = 0.1
    damping_law: float = 0.5
    loss_coupling: float = 0.0
    participation: float = 0.02
    mode_coupling: float = 0.5


@dataclass(frozen=True, kw_only=True)
class MountingTolerances:
    """How well it is known where and as what an article stands; standard deviations, 0 for what is taken as stated.

    Attributes
    ----------
    place, height : [m] along x and y, and along z, new in every campaign
    turn, tilt : [rad] about z, and about x and y, new in every campaign
    inertia : of the ten parameters of the article, and of all its mass with its modes, as a share; the same wherever it stands
    """

    place: float = 0.0
    height: float = 0.0
    turn: float = 0.0
    tilt: float = 0.0
    inertia: float = 0.0


@dataclass(frozen=True, kw_only=True)
class ClassedTolerance:
    """One tolerance in all classes.

    Attributes
    ----------
    key : by which a model file calls it, with its unit
    of : "chain" for a field of `Tolerances`, "opened" for a family of parameters of the chain, "mounting", "structure"
    name : of that field or family
    classes : (3,) standard deviations in the unit of `key`, in the order of `NAMES`
    largest : in that unit; beyond it a unit was mistaken
    what : in words, with what one number stands for
    source : where the figures come from
    """

    key: str
    of: str
    name: str
    classes: tuple[float, float, float]
    largest: float
    what: str
    source: str

    def si(self, written: float) -> float:
        """The tolerance in SI of a number in the unit of `key`."""
        if self.key.endswith("_mm"):
            return written / 1e3
        return radians(written) if self.key.endswith("_deg") else written


ROWS = tuple(
    ClassedTolerance(**{**row, "classes": tuple(row["classes"])})
    for row in toml_file.shipped("validation.model", "tolerance_classes.toml")["row"]
)
"""Every tolerance that a class may set. Exercised by test_tolerance_classes.py."""

OF_LABORATORY = tuple(row for row in ROWS if row.of != "structure")
"""Those that stand in [tolerances] of a model file; the others in [structure.tolerances]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ToleranceClass:
    """All tolerances of a laboratory.

    Attributes
    ----------
    name : of `NAMES`
    chain : of the measurement chain
    opened : by family of parameters of the chain that are closed otherwise, SI
    mounting : of where and as what articles stand
    structure : of the structure
    """

    name: str = METROLOGY
    chain: Tolerances = field(default_factory=Tolerances)
    opened: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    mounting: MountingTolerances = field(default_factory=MountingTolerances)
    structure: StructureTolerances = field(default_factory=StructureTolerances)

    def setting(self, row: ClassedTolerance, size: float) -> "ToleranceClass":
        """The same with the tolerance of `row` at `size` [SI]."""
        if row.of == "opened":
            return replace(self, opened=MappingProxyType({**self.opened, **dict.fromkeys(row.name.split(), size)}))
        return replace(self, **{row.of: replace(getattr(self, row.of), **{row.name: size})})

    def of(self, row: ClassedTolerance) -> float:
        """The tolerance of `row` [SI]."""
        if row.of == "opened":
            return self.opened.get(row.name.split()[0], 0.0)
        return float(getattr(getattr(self, row.of), row.name))

    @staticmethod
    def named(name: str) -> "ToleranceClass":
        """The class `name` of `NAMES`."""
        made = ToleranceClass(name=name)
        for row in ROWS if name != METROLOGY else ():
            made = made.setting(row, row.si(row.classes[NAMES.index(name)]))
        return made
