"""`Plan`: everything that decides a virtual test. The same plan gives the same campaign, to the last bit.

What is shared by a series - FMD, load cells, sensors, the parts of Clumod - hangs on `seed` alone; noise and cross motion hang on
the article and on the run as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import isfinite
from types import MappingProxyType

from fem.damping import Damping
from geometry import keys
from geometry.errors import BadInput
from geometry.tolerances import Tolerances
from validation.virtual_test.hooks import Effect

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

    def scaled(self, factor: float) -> Scatter:
        """All of them times `factor` [1]."""
        return Scatter(**{one.name: factor * getattr(self, one.name) for one in fields(self)})


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
    dimensions : a user's own of built-in articles, as `geometry.articles.changes` names them
    """

    article: str
    seed: int = 0
    model: str = BEAM
    tolerances: Tolerances = field(default_factory=Tolerances)
    scatter: Scatter = field(default_factory=Scatter)
    damping: Damping | None = None
    effects: tuple[Effect, ...] = ()
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

    def __post_init__(self) -> None:
        for name in ("noise_rms", "mains"):
            object.__setattr__(self, name, MappingProxyType({**NONE, **getattr(self, name)}))
            for quantity, value in getattr(self, name).items():
                keys.one_of(quantity, tuple(NONE), source=SOURCE, where=name)
                _require(value, f"{name}.{quantity}", zero=True)
        keys.one_of(self.pattern, PATTERNS, source=SOURCE, where="pattern")
        keys.one_of(self.model, MODELS, source=SOURCE, where="model")
        for name in ("octaves_per_minute", "rate", "simulation_rate", "quiet", "ringing", "highest", "gravity"):
            _require(getattr(self, name), name)
        _require(self.cross, "cross", zero=True)
        _require_levels(self.levels)
        _require_seed(self.seed)

    @property
    def on_fmd(self) -> str:
        """What stands on the FMD; empty for the FMD alone."""
        return self.article.partition("+")[2]


def exact(plan: Plan) -> Plan:
    """`plan` in a laboratory without any error: nothing drawn, no noise, no mains. Its table still moves across."""
    return replace(plan, tolerances=Tolerances().scaled(0.0), scatter=Scatter().scaled(0.0), noise_rms=NONE, mains=NONE)


def _require(value: float, name: str, *, zero: bool = False) -> None:
    if not (isfinite(value) and (value > 0 or (zero and value == 0))):
        what = "finite and not negative" if zero else "positive and finite"
        raise BadInput(source=SOURCE, field=name, problem=f"must be {what}, found {value:g}", remedy="Give it in SI units")


def _require_levels(levels: tuple[float, ...]) -> None:
    if not levels:
        raise BadInput(source=SOURCE, field="levels", problem="is empty", remedy="Give 1 for the nominal level")
    for level in levels:
        _require(level, "levels")
    if len(set(levels)) < len(levels):
        listed = ", ".join(f"{level:g}" for level in levels)
        raise BadInput(source=SOURCE, field="levels", problem=f"names one twice, found {listed}", remedy="Name each once")


def _require_seed(seed: int) -> None:
    if seed < 0:
        problem = f"must not be negative, found {seed}"
        raise BadInput(source=SOURCE, field="seed", problem=problem, remedy="Give a whole number from 0 on")
