"""`Rung` and `Ladder`: every version of a model that was held against data, and how each came from the one before it.

A rung is a model on data: the whole text of the model file, the data that it was fitted to, and what came out. What a rung says
is never changed and no rung is taken away; undoing goes back to an older one, and adding there branches.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, frozen
from identification.campaign import METHODS
from identification.quality import NORMAL_95, sizes
from validation.statement import COG, inertia_of

START, ADDED, EDITED, OTHER_DATA = CAUSES = ("start", "added", "edited by hand", "other data")
"""Why there is a rung: the model as it was first, an effect that was added, the user's own change of the file, the same model on
other data or with other runs held out."""

SHOWN = ("%", *3 * ("mm",), *6 * ("%",))
"""Units in which distances to the reference are told."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """A campaign folder or a file of classical measurements.

    Attributes
    ----------
    path : from the folder of the ladder, with forward slashes
    digest : SHA-256 of what it holds
    """

    path: str
    digest: str


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """What a rung was held against, and how: errors and evidence of two rungs compare only where these are the same.

    Attributes
    ----------
    data : campaigns and measurements
    hold_out : runs, campaigns and files that were never fitted, as the user named them; empty for the default
    band : (low, high) [Hz]; None for that of the campaigns
    method : of `identification.campaign.METHODS`
    """

    data: tuple[Source, ...] = ()
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str = METHODS[0]

    def same(self, other: Conditions) -> bool:
        """Whether both are, in whatever order the data were named."""
        mine, its = (replace(one, data=tuple(sorted(one.data, key=lambda source: source.path))) for one in (self, other))
        return mine == its


@dataclass(frozen=True, kw_only=True)
class Errors:
    """The four errors of a rung.

    Attributes
    ----------
    nominal, plain : per cent of the judged channels, on the data that were fitted
    held_out_nominal, held_out : the same on data that were not fitted; None where nothing was held out
    chi2, degrees_of_freedom : of the fit in which every tolerance is free
    tolerance_z2, tolerances : sum of squares of its tolerances in standard deviations, and how many there are
    expected_z2, largest_z : that sum where nothing is wrong, and |z| of the tolerance that moved farthest; None in ladders that
        were written before these were kept
    log_evidence : [nats], up to a constant of the data
    converged : whether both fits ended by themselves
    held_out_names : what was held out
    by_channel : plain error of every judged channel on the data that were fitted, their squares adding to its own
    by_fold : plain error on everything that was held out together
    """

    nominal: float
    plain: float
    held_out_nominal: float | None = None
    held_out: float | None = None
    chi2: float
    degrees_of_freedom: int
    tolerance_z2: float
    tolerances: int
    log_evidence: float
    expected_z2: float | None = None
    largest_z: float | None = None
    converged: bool = True
    held_out_names: tuple[str, ...] = ()
    by_channel: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    by_fold: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def chi2_per_dof(self) -> float:
        """The fitted error."""
        return self.chi2 / max(self.degrees_of_freedom, 1)

    @property
    def due_z2(self) -> float:
        """What its tolerances cost where nothing is wrong; at most one each."""
        return float(self.tolerances) if self.expected_z2 is None else self.expected_z2

    @property
    def z2_over_due(self) -> float:
        """What its tolerances cost, as a multiple of what they cost where nothing is wrong."""
        return self.tolerance_z2 / max(self.due_z2, 1.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """What the data say of one article when its ten parameters are free, beside what the model says.

    Attributes
    ----------
    article : what stands on the FMD
    values : (10,) identified: mass [kg], CoG [m] from the article's own origin, moments and products [kg m²] about the CoG
    deviation : (10,) standard deviations of these
    reference : (10,) of the model with its effects
    converged : whether the fit ended by itself
    """

    article: str
    values: Array
    deviation: Array
    reference: Array
    converged: bool = True

    def __post_init__(self) -> None:
        for name in ("values", "deviation", "reference"):
            object.__setattr__(self, name, frozen(getattr(self, name), (10,), name))

    @property
    def half_width(self) -> Array:
        """(10,) half of each 95 % interval."""
        return NORMAL_95 * self.deviation

    @property
    def distance(self) -> Array:
        """(10,) from the reference to what was identified."""
        return self.values - self.reference

    @property
    def shown(self) -> Array:
        """(10,) distance as `SHOWN` tells it: CoG in mm, mass and moments in per cent, products in per cent of √(Θii Θjj)."""
        size = sizes(inertia_of(self.reference))
        size[COG] = 0.1  # [m] of which a millimetre is one per cent
        return 100 * self.distance / size

    @property
    def sigmas(self) -> Array:
        """(10,) distance in standard deviations; 0 where nothing is uncertain and nothing differs."""
        return self.distance / np.where(self.deviation > 0, self.deviation, np.inf)


@dataclass(frozen=True, kw_only=True)
class Size:
    """One size of an effect in the model of a rung.

    Attributes
    ----------
    key : by which it is written; empty for the one that stands alone
    value, unit : SI
    deviation : standard deviation; None where it was not fitted
    """

    key: str
    value: float
    unit: str
    deviation: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Rung:
    """One rung.

    Attributes
    ----------
    number : its place in the ladder, from 0
    parent : the rung it came from; None for the first
    cause : of `CAUSES`
    effect : id of the effect that was added; empty where none was
    effects : by id the sizes of every effect of the model; none of one that is there or not
    model : text of the model file
    conditions : what it was held against, and how
    errors : the four errors; None of a model that was put aside before anybody held it against data
    gain : evidence [nats] over the parent; None where both do not stand on the same data
    bodies : identified inertia of every article
    plain_offsets, fitted_offsets : where both fits ended, by parameter: the next rung begins there
    verdict : in sentences
    when : ISO 8601, UTC
    versions : of the programs
    settings : with which it was made
    """

    number: int
    parent: int | None
    cause: str
    effect: str = ""
    effects: Mapping[str, tuple[Size, ...]] = field(default_factory=lambda: MappingProxyType({}))
    model: str
    conditions: Conditions = field(default_factory=Conditions)
    errors: Errors | None = None
    gain: float | None = None
    bodies: tuple[Body, ...] = ()
    plain_offsets: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    fitted_offsets: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    verdict: tuple[str, ...] = ()
    when: str = ""
    versions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def title(self) -> str:
        """What distinguishes it from its parent, in a few words."""
        return self.effect or {START: "the model at first"}.get(self.cause, self.cause)

    def stands_on(self, conditions: Conditions) -> bool:
        """Whether it was held against these."""
        return self.errors is not None and self.conditions.same(conditions)


@dataclass(frozen=True, eq=False, kw_only=True)
class Ladder:
    """All rungs of one model file.

    Attributes
    ----------
    rungs : in the order in which they were made; each has its number
    current : number of the rung that was written into the model file last; None before there is one
    """

    rungs: tuple[Rung, ...] = ()
    current: int | None = None

    def rung(self, number: int) -> Rung:
        """That with `number`."""
        return self.rungs[number]

    def children(self, number: int | None) -> tuple[Rung, ...]:
        """Those that came from it, in the order in which they were made; None asks for those that came from none."""
        return tuple(one for one in self.rungs if one.parent == number)

    def path(self, number: int) -> tuple[Rung, ...]:
        """From the first rung to that with `number`."""
        found = [self.rung(number)]
        while (parent := found[-1].parent) is not None:
            found.append(self.rung(parent))
        return tuple(reversed(found))

    def of_text(self, model: str) -> Rung | None:
        """The rung whose model has this very text: the current one where several do, else the latest; None without any."""
        alike = [one for one in self.rungs if one.model == model]
        return next((one for one in alike if one.number == self.current), alike[-1] if alike else None)

    def tree(self) -> tuple[tuple[str, Rung], ...]:
        """Every rung behind the branches that lead to it, drawn with lines: parents before their children."""
        return tuple(self._below(None, ""))

    def _below(self, number: int | None, trunk: str) -> list[tuple[str, Rung]]:
        """A child alone continues the line of its parent; only branches are set in."""
        found: list[tuple[str, Rung]] = []
        below = self.children(number)
        for place, one in enumerate(below, start=1):
            last = place == len(below)
            branch, on = ("", "") if len(below) == 1 else ("└─ ", "   ") if last else ("├─ ", "│  ")
            found += [(trunk + branch, one), *self._below(one.number, trunk + on)]
        return found
