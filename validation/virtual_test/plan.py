"""`Plan`: everything that decides a virtual test. The same plan gives the same campaign, to the last bit.

What is shared by a series - FMD, load cells, sensors, the parts of Clumod - hangs on `seed` alone; noise and cross motion hang on
the article and on the run as well.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from math import isfinite
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig
from fem.damping import Damping
from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.sensors import ChannelTable, Point, Tolerances
from validation.effects.catalogue import Named
from validation.model.model import Model
from validation.virtual_test.layout import CELLS, ChainTruth, Layout, stream

# `Effect`: what is different from an ordinary laboratory, as changes at five places of a virtual test.
#
#     chain     the drawn measurement chain, before anything is computed
#     parts     what was drawn for the parts of the structure
#     rig       what stands on the table, before it is driven
#     signals   what the sensors read, at the rate of the simulation: before delays, anti-alias filter and noise
#     record    what the recorder got, at its own rate: noise and mains are in, and units are what the file will say
#
# An effect leaves alone what it does not name. Several act in their order, each on what the one before left.


T = TypeVar("T")


def same(value: T) -> T:
    """What an effect does where it does nothing."""
    return value


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensed:
    """All channels of one run.

    Attributes
    ----------
    values : (n, c) in the order of `table`, SI; an effect returns another array and never writes into this one
    table : the nominal channels, as in the file
    sampling_rate : [Hz]
    run : name of the run
    level : at which it was driven, as a factor on the nominal one
    response : what table, cover plate and cells really did, at the rate of the simulation; None for what was recorded
    generator : of whatever the effect draws, the run's own
    """

    values: Array
    table: ChannelTable
    sampling_rate: float
    run: str
    level: float
    response: Response | None
    generator: np.random.Generator

    def column(self, channel: str) -> int:
        """Where `channel` stands in `values`."""
        return self.table.names.index(channel)


@dataclass(frozen=True, eq=False, kw_only=True)
class PlantedEffect:
    """One effect; see the head of this file.

    Attributes
    ----------
    id : as in the catalogue
    value : its size in SI by key; `""` is the key of an effect that takes one number
    chain, parts, rig, signals, record : the changes
    """

    id: str
    value: Mapping[str, float] = field(default_factory=dict)
    chain: Callable[[ChainTruth], ChainTruth] = same
    parts: "Callable[[Mapping[str, Part]], Mapping[str, Part]]" = same
    rig: Callable[[Rig], Rig] = same
    signals: Callable[[Sensed], Sensed] = same
    record: Callable[[Sensed], Sensed] = same


def changed_rig(rig: Rig, effects: Sequence[PlantedEffect]) -> Rig:
    """`rig` after all `effects`."""
    for effect in effects:
        rig = effect.rig(rig)
    return rig


SOURCE = "virtual test"

SINGLE, TWICE, DIAGONAL, MULTI = PATTERNS = ("single", "twice", "diagonal", "multi")
"""Six sweeps of one axis each; the same and six more that begin a quarter period later; the same and six of two axes at once;
six sweeps of all axes at once, of different phases."""

BEAM, RIGID = MODELS = ("beam", "rigid")

NOISE: Mapping[str, float] = MappingProxyType({"acceleration": 0.005, "force": 0.3})
"""Broadband rms of every channel by quantity [m/s², N]."""

MAINS: Mapping[str, float] = MappingProxyType({"acceleration": 0.003, "force": 0.2})
"""Amplitude of the hum at 50 Hz by quantity [m/s², N]; its harmonics are weaker."""

NONE: Mapping[str, float] = MappingProxyType({"acceleration": 0.0, "force": 0.0})


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """How far structure and FMD lie from their drawings beside what `Tolerances` says; standard deviations.

    Attributes
    ----------
    modulus : of the logarithm of every part's moduli
    damping : of the logarithm of every part's loss factor, or of every mode's damping ratio where the plan states one
    fmd_cog : [m] of the FMD's centre of gravity along each axis
    """

    modulus: float = 0.025
    damping: float = 0.35
    fmd_cog: float = 0.5e-3

    def __post_init__(self) -> None:
        for one in fields(self):
            _require(getattr(self, one.name), f"scatter.{one.name}", zero=True)

    def scaled(self, factor: float) -> "Scatter":
        """All of them times `factor` [1]."""
        return Scatter(**{one.name: factor * getattr(self, one.name) for one in fields(self)})


LIGHTEST = 0.1
"""Least share that a draw leaves of a mass or of a second moment: a body stays a body whatever the tolerance."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """Relative changes of the moduli and of the loss factor of a part of the structure, and what an effect adds to the latter."""

    modulus: float
    loss: float
    added_loss: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """A virtual test.

    Attributes
    ----------
    article : the stack that is mounted, which begins with the FMD
    seed : of everything that is drawn
    model : "beam", or "rigid" for an article that does not give
    tolerances, scatter : what is drawn
    damping : of the article's modes; None for the loss factors of its parts
    effects : what is different from an ordinary laboratory
    pattern : of `PATTERNS`
    levels : factors on the nominal level; every pattern is driven at each of them
    band : [Hz] of the sweeps
    octaves_per_minute : of the sweeps
    cross : what the table does on average on every other axis, as a share of the driven level
    noise_rms, mains : by quantity [m/s², N]
    rate : [Hz] of the records
    simulation_rate : [Hz] at least of the simulation
    quiet : [s] before every sweep and after its ringing
    ringing : share of the greatest load of a run below which the load of every mode must fall before the record may end
    highest : [Hz] modes above it answer statically, but for the article's first
    gravity : [m/s²]
    dimensions : a user's own of built-in articles, as `geometry.articles.parts` names them
    on_article : points of the article, ``mast-top:x``, that have accelerometers beside the 22 channels
    axis : of a single-axis shaker x, y or z: it is driven along nothing else, and one pilot on the table is all that is read
        beside `on_article`; empty for the six axes
    """

    article: str
    seed: int = 0
    model: str = BEAM
    tolerances: Tolerances = field(default_factory=Tolerances)
    scatter: Scatter = field(default_factory=Scatter)
    damping: Damping | None = None
    effects: tuple[PlantedEffect, ...] = ()
    pattern: str = SINGLE
    levels: tuple[float, ...] = (1.0,)
    band: tuple[float, float] = (4.0, 32.0)
    octaves_per_minute: float = 2.0
    cross: float = 0.03
    noise_rms: Mapping[str, float] = field(default_factory=lambda: NOISE)
    mains: Mapping[str, float] = field(default_factory=lambda: MAINS)
    rate: float = 564.0
    simulation_rate: float = 8192.0
    quiet: float = 1.5
    ringing: float = 1e-5
    highest: float = 160.0
    gravity: float = 9.81
    dimensions: Mapping[str, float] = field(default_factory=dict)
    on_article: tuple[str, ...] = ()
    axis: str = ""

    def __post_init__(self) -> None:
        for name in ("noise_rms", "mains"):
            object.__setattr__(self, name, MappingProxyType({**NONE, **getattr(self, name)}))
            for quantity, value in getattr(self, name).items():
                toml_file.one_of(quantity, tuple(NONE), source=SOURCE, where=name)
                _require(value, f"{name}.{quantity}", zero=True)
        toml_file.one_of(self.pattern, PATTERNS, source=SOURCE, where="pattern")
        toml_file.one_of(self.model, MODELS, source=SOURCE, where="model")
        for name in ("octaves_per_minute", "rate", "simulation_rate", "quiet", "ringing", "highest", "gravity"):
            _require(getattr(self, name), name)
        _require(self.cross, "cross", zero=True)
        levels = self.levels
        if not levels:
            raise BadInput(SOURCE, "levels", "is empty", "Give 1 for the nominal level")
        for level in levels:
            _require(level, "levels")
        if len(set(levels)) < len(levels):
            listed = ", ".join(f"{level:g}" for level in levels)
            raise BadInput(SOURCE, "levels", f"names one twice, found {listed}", "Name each once")
        if self.seed < 0:
            raise BadInput(SOURCE, "seed", f"must not be negative, found {self.seed}", "Give a whole number from 0 on")

    def is_read(self, channel: str) -> bool:
        """Whether `channel` is recorded; of a single-axis shaker the first pilot along its axis and the article alone."""
        upon = [point.replace(":", "-") for point in self.on_article]
        return not self.axis or channel == f"table-{self.axis}1" or channel in upon

    @property
    def on_fmd(self) -> str:
        """What stands on the FMD; empty for the FMD alone."""
        return self.article.partition("+")[2]

    # What the seed draws: the errors of the measurement chain, the FMD that is on the shaker, the parts of the structure. Every
    # figure has a stream of its own name, so that it is the same for every article, and grows with its tolerance alone.

    def drawn_chain(self, layout: Layout) -> ChainTruth:
        """The measurement chain."""
        of, channels = self.tolerances, layout.table.channels
        accelerometers = [channel for channel in channels if channel.quantity == "acceleration"]
        angle = {}
        for one in accelerometers:  # a standard rotation about the two axes across its direction
            direction, vector = one.places[0].direction, self._normal("angle", one.name, size=3)
            angle[one.name] = of.angle * (vector - direction * (direction @ vector))
        return ChainTruth(
            gain={c.name: (of.table_gain if c.group == "table" else of.gain) * self._one("gain", c.name) for c in channels},
            delay={c.name: of.delay * self._one("delay", c.name) for c in channels},
            position={c.name: of.position * self._normal("position", c.name, size=3) for c in accelerometers},
            angle=angle,
            cell_stiffness=np.maximum(of.cell_stiffness * self._normal("cell-stiffness", size=(CELLS, 3)), LIGHTEST - 1),
            crosstalk=of.crosstalk * self._normal("crosstalk", size=(3, 3)) * (1 - np.eye(3)),
            noise_rms={c.name: self.noise_rms[c.quantity] for c in channels},
            mains={c.name: self.mains[c.quantity] for c in channels},
        )

    def drawn_moving_part(self, nominal: Inertia) -> Inertia:
        """The FMD's moving part about F that is on the shaker: `nominal` with other mass, CoG and second moments.

        Second moments are drawn and not moments of inertia, which would break the triangle inequality: the FMD is nearly a plate.
        """
        of = self.tolerances.fmd_inertia
        second = 0.5 * np.trace(nominal.tensor_cog) * np.eye(3) - nominal.tensor_cog
        factors = np.sqrt(np.maximum(1 + of * self._normal("fmd-second-moments", size=3), LIGHTEST))
        drawn = factors[:, None] * second * factors
        return Inertia.from_cog(
            nominal.mass * max(1 + of * self._one("fmd-mass"), LIGHTEST),
            nominal.cog + self.scatter.fmd_cog * self._normal("fmd-cog", size=3),
            np.trace(drawn) * np.eye(3) - drawn,
        )

    def drawn_part(self, name: str) -> Part:
        """What is drawn for the structure's part `name`; the same in every article that has it."""
        modulus, loss = (
            float(np.expm1(sd * self._one(what, name)))
            for sd, what in ((self.scatter.modulus, "modulus"), (self.scatter.damping, "loss-factor"))
        )
        return Part(modulus=modulus, loss=loss)

    def drawn_damping(self, count: int) -> Array:
        """(count,) factors on the damping ratios of an article's modes, where they are stated by mode."""
        names = [f"{self.on_fmd} mode {number}" for number in range(1, count + 1)]
        return np.exp([self.scatter.damping * self._one("damping-ratio", name) for name in names])

    def _one(self, *names: str) -> float:
        return float(stream(self.seed, *names).standard_normal())

    def _normal(self, *names: str, size: int | tuple[int, ...]) -> Array:
        return np.asarray(stream(self.seed, *names).standard_normal(size))


def exact(plan: Plan) -> Plan:
    """`plan` in a laboratory without any error: nothing drawn, no noise, no mains. Its table still moves across."""
    return replace(plan, tolerances=Tolerances().scaled(0.0), scatter=Scatter().scaled(0.0), noise_rms=NONE, mains=NONE)


def _require(value: float, name: str, *, zero: bool = False) -> None:
    if not (isfinite(value) and (value > 0 or (zero and value == 0))):
        what = "finite and not negative" if zero else "positive and finite"
        raise BadInput(SOURCE, name, f"must be {what}, found {value:g}", "Give it in SI units")


# A virtual test of a structure that stands by itself.

HAMMER, SHAKER, FUNCTIONS, MODES, BASE, BASE_FORCES = KINDS = ("hammer", "shaker", "functions", "modes", "base", "base-forces")
"""Records of blows, records of a random force, response functions, a table of modes; sweeps of a base, its accelerometers and
those on the structure recorded, or load cells below as well."""

STRUCTURAL = (
    *("modulus", "mass", "thickness", "structural-damping", "support-stiffness", "point-mass", "cable", "gravity-stiffness"),
)
OF_ANY = (
    *("accelerometer-gain", "accelerometer-delay", "accelerometer-position", "accelerometer-misalignment"),
    *("force-gain", "force-delay", "polarity", "channel-swap", "unit"),
)
SENSORS = (
    *(*OF_ANY, "force-position", "force-misalignment", "transducer-mass", "exponential-window"),
    *("wrong-direction", "wrong-place", "wrong-reference"),
)
SILENT = {SHAKER: ("exponential-window",), FUNCTIONS: ("exponential-window",), MODES: ("accelerometer-delay", "transducer-mass")}
OF_DRIVES = ("force-position", "force-misalignment", "wrong-reference")
OF_CELLS = ("force-crosstalk", "cell-stiffness", "fmd-compliance", "load-path-shunt")
"""Families that can be hidden: in the structure, in sensors of any test, in those of one by forces, among these what some of such
tests do not tell and where a force acts, and in load cells below a base."""

CROSS = 0.03
"""[share] of the swept motion that a base makes on average along each other axis where nothing is said."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StructurePlan:
    """All that decides such a test; the same plan gives the same files.

    Attributes
    ----------
    model : whose structure it is; its own effects are there
    kind : of `KINDS`
    article : what is tested
    drives, responses : points; of a table its sensors are the responses
    effects : that are hidden
    seed : of all that is drawn
    noise, tolerances : factors on the ordinary noise, and on the tolerances from which moduli, losses and gains are drawn
    band : (low, high) [Hz]
    block : [s] of a block; 0 for one in which the slowest mode rings down
    axis, cross : of a base the one that is swept, all six where it is empty; what it does on average along the others
    doubts : sentences on what is likely a slip
    """

    model: Model
    kind: str
    article: str
    drives: tuple[Point, ...]
    responses: tuple[Point, ...]
    effects: tuple[Named, ...] = ()
    seed: int = 0
    noise: float = 1.0
    tolerances: float = 1.0
    band: tuple[float, float]
    block: float = 0.0
    axis: str = ""
    cross: float = CROSS
    doubts: tuple[str, ...] = ()

    @property
    def on_base(self) -> bool:
        """Whether a base drives it."""
        return self.kind in (BASE, BASE_FORCES)

    @property
    def planted(self) -> tuple[str, ...]:
        """Families that can be hidden in it."""
        cells, silent = OF_CELLS if self.kind == BASE_FORCES else (), SILENT.get(self.kind, ())
        return *STRUCTURAL, *(one for one in ((*OF_ANY, *cells) if self.on_base else SENSORS) if one not in silent)

    def drawn(self, what: str) -> np.random.Generator:
        """A stream of random numbers of its own."""
        return np.random.default_rng([self.seed, *what.encode()])

    def each(self, family: str) -> list[Named]:
        """The hidden effects of a family."""
        return [one for one in self.effects if one.family == family]
