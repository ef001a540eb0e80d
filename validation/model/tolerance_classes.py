"""Classes of laboratories: what is not known of a test, by what a laboratory has in hand, each figure with its source."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import radians
from types import MappingProxyType

from fem.mesh.places import ENERGY_TOO_HIGH
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


ROWS = (
    ClassedTolerance(
        key="gain",
        of="chain",
        name="gain",
        classes=(0.003, 0.005, 0.01),
        largest=1.0,
        what="relative, load cells and accelerometers on cover plate and article",
        source="ISO 16063-21: comparison calibration to 1 % with k = 2; data sheets: sensitivity within 2 %",
    ),
    ClassedTolerance(
        key="table_gain",
        of="chain",
        name="table_gain",
        classes=(0.015, 0.015, 0.02),
        largest=1.0,
        what="relative, accelerometers below the FMD",
        source="pilots of a shaker control: as `gain` of a data sheet, recalibrated at longer intervals",
    ),
    ClassedTolerance(
        key="delay_s",
        of="chain",
        name="delay",
        classes=(20e-6, 20e-6, 40e-6),
        largest=0.01,
        what="of every channel",
        source="match of channels of a front end, 0.1 to 0.2 degrees at 10 Hz; phase of a sensor below a tenth of its resonance",
    ),
    ClassedTolerance(
        key="position_mm",
        of="chain",
        name="position",
        classes=(0.5, 0.5, 1.0),
        largest=100.0,
        what="of a pick-up along each axis",
        source="a steel rule to half a millimetre; seismic centre of a pick-up within 1 to 2 mm of the middle of its housing",
    ),
    ClassedTolerance(
        key="angle_deg",
        of="chain",
        name="angle",
        classes=(0.3, 0.75, 1.3),
        largest=30.0,
        what="of a pick-up about the two axes across its direction",
        source="ISO 5347-11, ISO 16063-31: transverse sensitivity, which reads like an angle, at most 5 % on data sheets, 2 % "
        "where measured, direction unknown: limit / sqrt(6) along each axis, beside 0.3 to 0.6 degrees of gluing",
    ),
    ClassedTolerance(
        key="cell_stiffness",
        of="chain",
        name="cell_stiffness",
        classes=(0.05, 0.05, 0.1),
        largest=5.0,
        what="relative, of each load cell along each axis",
        source="data sheets of quartz cells: rigidity without tolerance; scatter of preload by a tenth (ISO 16047 for bolts)",
    ),
    ClassedTolerance(
        key="crosstalk",
        of="chain",
        name="crosstalk",
        classes=(0.0015, 0.0015, 0.0015),
        largest=1.0,
        what="relative, of each resultant in the others of its kind",
        source="flatness of the measuring plane; what cells hear of other axes is `cell_crosstalk`",
    ),
    ClassedTolerance(
        key="cell_crosstalk",
        of="opened",
        name="cell-crosstalk",
        classes=(0.0, 0.002, 0.012),
        largest=1.0,
        what="relative, what each element of a cell reads of the force on the cell along each axis, its own among them",
        source="data sheets of three-component quartz cells: cross-talk at most 1 to 3 % (x, y in z and z in x, y), sensitivity "
        "of a cell within 2 %; a tenth where a calibration matrix is applied",
    ),
    ClassedTolerance(
        key="highpass_hz",
        of="opened",
        name="force-highpass accelerometer-highpass",
        classes=(0.0, 0.005, 0.03),
        largest=10.0,
        what="corner of the high-pass of every channel that is left when the stated one is divided out",
        source="data sheets of IEPE pick-ups and charge amplifiers: corner 0.1 Hz and below, time constant known to 30 % (5 % "
        "where measured)",
    ),
    ClassedTolerance(
        key="force_plane_mm",
        of="opened",
        name="force-plane-offset",
        classes=(0.0, 0.25, 0.5),
        largest=100.0,
        what="height at which the cells feel a lateral force, along x and along y",
        source="data sheets of three-component cells: middle plane of the quartz within 0.5 to 1 mm, with preload and plates",
    ),
    ClassedTolerance(
        key="mounting_mm",
        of="mounting",
        name="place",
        classes=(0.0, 0.25, 1.0),
        largest=100.0,
        what="place of the article along x and y, anew in every campaign",
        source="ISO 273: clearance of bolts, 0.5 mm with dowels or fine holes, 1 to 2 mm of the medium series at M10 to M16",
    ),
    ClassedTolerance(
        key="height_mm",
        of="mounting",
        name="height",
        classes=(0.0, 0.05, 0.3),
        largest=100.0,
        what="height of the article, anew in every campaign",
        source="ISO 2768-1 m: 0.1 to 0.3 mm on thicknesses of plates up to 120 mm",
    ),
    ClassedTolerance(
        key="turn_deg",
        of="mounting",
        name="turn",
        classes=(0.0, 0.1, 0.3),
        largest=30.0,
        what="turn of the article about z, anew in every campaign",
        source="the clearance of `mounting_mm` over half a pitch circle of 100 to 200 mm",
    ),
    ClassedTolerance(
        key="tilt_deg",
        of="mounting",
        name="tilt",
        classes=(0.0, 0.02, 0.06),
        largest=30.0,
        what="tilt of the article on its seat about x and y, anew in every campaign",
        source="ISO 2768-2 H, K: flatness and perpendicularity of 0.1 to 0.4 mm over 100 to 300 mm",
    ),
    ClassedTolerance(
        key="inertia",
        of="mounting",
        name="inertia",
        classes=(0.0, 0.002, 0.006),
        largest=1.0,
        what="share of the ten parameters of an article, the same wherever it stands, and of all its mass, its modes with it: "
        "bolts and holes not drawn; density",
        source="density of aluminium and steel within an alloy 0.3 to 1 % (EN 573-3, EN 10088-1), weighed parts 0.1 %; bolts of "
        "0.5 % of an article",
    ),
    ClassedTolerance(
        key="damping",
        of="structure",
        name="damping",
        classes=(0.35, 0.35, 0.5),
        largest=10.0,
        what="of every part's loss factor, or of the logarithm of every mode's damping",
        source="scatter of damping ratios between builds of one structure: 10 to 50 % (ECSS-E-HB-32-26A)",
    ),
    ClassedTolerance(
        key="mode_damping",
        of="structure",
        name="mode_damping",
        classes=(0.1, 0.3, 0.5),
        largest=10.0,
        what="of the logarithm of every mode's damping beside the loss factors of the parts",
        source="as `damping`; joints and air give every mode a damping of its own",
    ),
    ClassedTolerance(
        key="loss_coupling",
        of="structure",
        name="loss_coupling",
        classes=(0.0, 0.5, 0.5),
        largest=5.0,
        what="share of what the losses of the parts couple the modes by that is not there, and of what losses told by mode "
        "couple the modes by that an effect has turned",
        source="damping stated by mode, as tests do, couples none (Caughey and O'Kelly 1965), loss factors of parts as much as "
        "their stiffness does: from 0 to 1",
    ),
)
"""Every tolerance that a class may set. Exercised by tests/validation/models/test_tolerance_classes.py."""

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
