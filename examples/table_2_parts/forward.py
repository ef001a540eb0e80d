"""Virtual tests in the frequency domain: what one campaign is read as, and how that answers to every tolerance and every effect.

Channels = (A0 + A1 H) u of `validation.prediction`, exact lines instead of records, read as the paper reads (`reading`). Sensors,
cells and FMD are the reconstruction's: where the pick-ups of 2002 sat is not printed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from geometry.frames import Array, Pose
from geometry.sensors import ChannelTable
from identification.campaign import Campaign, Recording, Run
from identification.spectra.line_spectra import Spectra
from table_2_parts import reading
from table_2_parts.candidates import LITTLE, SWINGING, Candidate, candidates
from table_2_parts.reading import ALL
from validation.effects.catalogue import Named
from validation.estimation.problem import Predicted
from validation.model.model import BEAM, RIGID, Added, Model
from validation.model.setups import mounted
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import Plan
from validation.virtual_test.shaker import middles_of_cells

TARE, CLUMOD = "fmd+disc+cuboid", "fmd+clumod-1"

STIFFNESS = (4e8, 4e8, 2e9)
"""[N/m] of the cells of the FMD on which virtual tests stand."""

START, RIGID_STOP = 4.0, 5.0
"""[Hz] where the paper's sweeps begin; where a band ends whose end does not matter, because nothing bends."""

LINES = 5
"""Of a band, in the middle of as many equal pieces: the dynamic mass is smooth there."""

COVER, TABLE = "cover", "table"
"""Groups of accelerometers."""

OF_CLUMOD = ("rigid-inertia", "orientation", "mounting-offset", "joint-compliance")
"""Families that are faults of Clumod or of the way it was mounted: nothing of them is in the tare."""


@dataclass(frozen=True, kw_only=True)
class Test:
    """One campaign and how it is read.

    Attributes
    ----------
    article : the stack
    stop : [Hz] upper end of the band in which it is taken for rigid; 0 where its elasticity is taken off exactly
    angle : [rad] by which it is turned about z
    rows : of `reading.ROWS`
    pick_ups : group of accelerometers from which the motion is taken
    changes : dimensions of the article that are others, by key
    among : names of the candidates whose derivatives are wanted; all where it is empty
    """

    article: str
    stop: float
    angle: float = 0.0
    rows: str = ALL
    pick_ups: str = COVER
    changes: tuple[tuple[str, float], ...] = ()
    among: frozenset[str] = frozenset()

    @property
    def records(self) -> Test:
        """The same test, whichever way its records are read."""
        return replace(self, rows=ALL, pick_ups=COVER)


@dataclass(frozen=True, eq=False, kw_only=True)
class Read:
    """What a test is read as, about F.

    Attributes
    ----------
    told : (m,) the ten parameters, FMD included; or another outcome of the same records
    tolerances : by name (m,) for one standard deviation of each
    effects : by name of a candidate (m,) for a unit of its size
    """

    told: Array
    tolerances: Mapping[str, Array] = field(default_factory=dict)
    effects: Mapping[str, Array] = field(default_factory=dict)


@lru_cache(maxsize=256)
def read(test: Test) -> Read:
    """The ten of a laboratory in which nothing is wrong, with all derivatives."""
    of, predicted = _predicted(test.records)
    near = _linear(test, of, predicted.rows)
    return _through(test, near.changed, ten(test))


@lru_cache(maxsize=256)
def checks(test: Test) -> Read:
    """What is redundant in the records: two combinations of accelerometers, two of force channels, for each driven axis (24,).

    In m/s² and N at the nominal level of the axis; nothing where all is well.
    """
    of, _ = _predicted(test.records)
    rows = reading.redundant(table(), of.measured.channels)

    def changed(channels: Sequence[int], change: ComplexArray) -> Array:
        return np.asarray((rows[:, list(channels)] @ change.real.mean(axis=0) * reading.LEVEL).ravel())

    return _through(test, changed, np.zeros(rows.shape[0] * len(MOTIONS)))


def _through(test: Test, changed: Callable[[Sequence[int], ComplexArray], Array], told: Array) -> Read:
    """An outcome, and `changed` of all derivatives of the records."""
    tolerances, effects = dict[str, Array](), dict[str, Array]()
    for frequency in SWINGING:
        changes = _predicted(test.records, frequency)[1].changes
        lot = [one for one in _lot(test, frequency) if one.parameter in changes]
        effects |= {one.name: changed(changes[one.parameter].channels, changes[one.parameter].rows) / _unit(one) for one in lot}
    first = _predicted(test.records)[1].changes
    for one in stand(test).parameters:
        tolerances[one.name] = one.tolerance * changed(first[one.name].channels, first[one.name].rows)
    return Read(told=told, tolerances=tolerances, effects=effects)


def ten(test: Test, effects: Sequence[Named] = (), offsets: Mapping[str, float] | None = None) -> Array:
    """(10,) about F of a laboratory with these `effects`, its tolerances at `offsets`; nothing linearised."""
    of = stand(test).with_effects(tuple(Added(named=named, fixed=True) for named in there(test, effects)))
    rows = of.at(offsets or {}, derivatives=False).rows
    return reading.ten(_spectra(of, rows, test.pick_ups), test.rows)


@lru_cache(maxsize=1)
def table() -> ChannelTable:
    """The paper's 22 signals on the reconstructed FMD."""
    return mavis(middles_of_cells(Plan(article=CLUMOD)), {}).table


def campaign(article: str, frequency: Array) -> Campaign:
    """Six sweeps of `article` that nobody has run: what they read is not looked at."""
    empty = np.ones((len(frequency), len(table())), dtype=np.complex128)
    recorded = {axis: Recording(names=table().names, values=empty, frequency=frequency, source=axis) for axis in MOTIONS}
    swept = tuple(Run(name=axis, file="", axis=axis) for axis in MOTIONS)
    return Campaign(title=article, article=article, hardware="2002", table=table(), runs=swept, recordings=recorded)


@lru_cache(maxsize=64)
def stand(test: Test) -> SeriesPrediction:
    """The prediction of a test, whatever is read of it."""
    model = Model(
        source="2002",
        title="as reconstructed",
        article=CLUMOD,
        cell_stiffness=np.array(STIFFNESS),
        kind=BEAM if test.stop else RIGID,
        changes=dict(test.changes),
    )
    (made,) = predictions(model, [campaign(test.article, lines(test))], lines=lines(test))
    return made


def lines(test: Test) -> Array:
    """(n,) [Hz] at which it is read."""
    width = ((test.stop or RIGID_STOP) - START) / LINES
    return np.asarray(START + width * (np.arange(LINES) + 0.5))


def tolerances(tests: Iterable[Test]) -> dict[str, float]:
    """By name, one standard deviation of the offset."""
    return {one.name: one.tolerance for test in tests for one in stand(test).parameters}


@lru_cache(maxsize=1)
def seat() -> Pose:
    """Where an article stands, from F."""
    return mounted(campaign(CLUMOD, np.array([START, RIGID_STOP])))[0]


@lru_cache(maxsize=64)
def _predicted(test: Test, frequency: float = SWINGING[0]) -> tuple[SeriesPrediction, Predicted]:
    """All derivatives at once, every candidate opened where it is as good as not there; resonators swing at `frequency` [Hz]."""
    opened = [one.named for one in _lot(test, frequency) if _reaches(test, one.named)]
    of = stand(test).with_effects(tuple(Added(named=one) for one in there(test, opened)))
    return of, of.at({one.name: one.start for one in of.parameters})


def _lot(test: Test, frequency: float) -> tuple[Candidate, ...]:
    """All candidates that are wanted, and for a second `frequency` [Hz] the resonators alone."""
    lot = candidates() if frequency == SWINGING[0] else [one.swinging_at(frequency) for one in candidates() if one.swings]
    return tuple(one for one in lot if not test.among or one.name in test.among)


def there(test: Test, effects: Iterable[Named]) -> tuple[Named, ...]:
    """Those of `effects` that reach `test`, and its angle."""
    reaching = [one for one in effects if _reaches(test, one)]
    turned = [one for one in reaching if one.family == "orientation"]
    angle = test.angle + sum(one.value for one in turned)
    kept = [one for one in reaching if one not in turned]
    if turned or angle:
        kept.append(Named(family="orientation", targets=("z",), values={"": angle}))
    return tuple(kept)


def _reaches(test: Test, named: Named) -> bool:
    return "clumod" in test.article or named.family not in OF_CLUMOD


def _unit(one: Candidate) -> float:
    """By which a derivative by the logarithm becomes one by the mass."""
    return LITTLE if one.swings else 1.0


def _linear(test: Test, of: SeriesPrediction, rows: ComplexArray) -> reading.Linear:
    H: DynamicMass = reading.dynamic_mass(_spectra(of, rows, test.pick_ups))
    return reading.linear(_spectra(of, rows, test.pick_ups).table, of.measured.channels, rows, H, test.rows)


def _spectra(of: SeriesPrediction, rows: ComplexArray, pick_ups: str) -> Spectra:
    made = reading.spectra(table(), of.measured.channels, of.measured.frequency, rows)
    return made if pick_ups == COVER else reading.without(made, COVER)
