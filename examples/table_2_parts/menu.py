"""Which measurement in 2002 would have decided: the information that each of a menu holds about the explanations, given Table 2.

Every explanation, with Table 2, says where tolerances, sizes and the error of the reference lie (a Gaussian), and so what a
further measurement would read. How far these predictions stand apart is the mutual information between explanation and outcome
(Lindley, Ann. Math. Statist. 27, 1956, 986), in nats: at most the doubt that there is, the entropy of the posterior.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.frames import Array
from geometry.inertia import Inertia
from identification.request import scale
from table_2_parts import forward
from table_2_parts.candidates import QUARTER
from table_2_parts.forward import TABLE, Read, Test
from table_2_parts.inference import Explanation
from table_2_parts.published import DEVIATIONS, deviation_of_reading
from table_2_parts.reading import ALL
from table_2_parts.ways import Way, answer, difference

REPEATED = 5e-4
"""Standard deviation of a repeated reading that no tolerance explains, as a share of the size of a parameter."""

CHECKED = 5e-3
"""The same of the redundant channels [m/s²], [N]: noise of a channel."""

CLASSICAL = np.array([0.1, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
"""(7,) standard deviations [%, mm] of weighing, crane and pendulum, assumed."""

BARE = (("clumod.blade.lower-1.length_mm", 150.0), ("clumod.blade.lower-1.width_mm", 110.0))
"""A stub that no longer bends in the place of the blade."""

OF_BODY = ("rigid-inertia", "point-mass")
"""Families that a balance, a crane and a pendulum feel, too."""

SAMPLES = 300
"""Of every explanation's predicted outcome."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """What a further measurement would read by one way, linear in all that is unknown.

    Attributes
    ----------
    nominal : (m,) where nothing is wrong but the quarter turn
    tolerances, effects : by name (m,), for one standard deviation and for a unit of size
    reference : (m, 7) by the error of the reference
    noise : (m,) standard deviation of what is new in it
    """

    nominal: Array
    tolerances: Mapping[str, Array]
    effects: Mapping[str, Array]
    reference: Array
    noise: Array


Measurement = Callable[[Way, frozenset[str]], Outcome]
"""By a way to read, for the effects of these names."""


def fmd_alone(way: Way, among: frozenset[str]) -> Outcome:
    """The FMD with nothing on it, against what the tare says of it."""
    return _against(way, Test(article="fmd", stop=way.stop, rows=way.rows, among=among))


def cuboid_turned(way: Way, among: frozenset[str]) -> Outcome:
    """Disc and Cuboid a quarter turn about z, against how they stood."""
    return _against(way, replace(way.tests[0], angle=QUARTER, among=among))


def disc_alone(way: Way, among: frozenset[str]) -> Outcome:
    """The disc without the Cuboid: a second known body."""
    return _against(way, replace(way.tests[0], article="fmd+disc", among=among))


def clumod_turned(way: Way, among: frozenset[str]) -> Outcome:
    """Clumod a quarter turn further, against how it stood."""
    before = way.tests[1]
    return _compared(replace(before, angle=before.angle + QUARTER, among=among), before)


def blade_removed(way: Way, among: frozenset[str]) -> Outcome:
    """Clumod without its blade, against Clumod with it."""
    return _compared(replace(way.tests[1], changes=BARE, among=among), way.tests[1])


def other_pick_ups(way: Way, among: frozenset[str]) -> Outcome:
    """The records of Clumod read with the accelerometers of the table instead of those of the cover plate."""
    return _compared(replace(way.tests[1], pick_ups=TABLE), way.tests[1])


def other_bands(way: Way, among: frozenset[str]) -> Outcome:
    """The records of Clumod read in two bands, nothing taken off: how the result moves with the band."""
    one, other = (replace(way.tests[1], stop=stop) for stop in (4.5, 6.0))
    return _compared(other, one)


def redundancy(way: Way, among: frozenset[str]) -> Outcome:
    """What is redundant in the records of Clumod: eight accelerometers for six motions, eight force channels for six loads."""
    found = forward.checks(way.tests[1])
    return _outcome(found, np.full(len(found.told), CHECKED))


def classical(way: Way, among: frozenset[str]) -> Outcome:
    """Clumod weighed, hung and swung in the axes in which it stood on the table, against the reference."""
    still = answer(replace(way, stop=0.0, rows=ALL))
    columns = dict(zip((one.name for one in still.candidates), still.effects.T, strict=True))
    effects = {one.name: columns[one.name] for one in still.candidates if one.name in among and one.named.family in OF_BODY}
    return Outcome(nominal=still.nominal, tolerances={}, effects=effects, reference=np.eye(7), noise=CLASSICAL)


MENU: Mapping[str, Measurement] = {
    "Clumod turned by 90° on the FMD": clumod_turned,
    "Clumod weighed, hung and swung as it stood": classical,
    "Clumod without its blade": blade_removed,
    "Cuboid turned by 90° on the FMD": cuboid_turned,
    "disc alone, a second known body": disc_alone,
    "FMD alone": fmd_alone,
    "same records: redundant channels": redundancy,
    "same records: table's accelerometers": other_pick_ups,
    "same records: two bands": other_bands,
}


def entropy(probability: Array) -> float:
    """[nats] of the posterior: how much there is to decide."""
    return float(-np.sum(probability * np.log(probability)))


def information(explanations: Sequence[Explanation], probability: Array, measure: Measurement) -> float:
    """[nats] between explanation and the outcome of a measurement.

    Parameters
    ----------
    probability : (n,) of the `explanations`, summing up to 1
    """
    among = frozenset(fault.name for one in explanations for fault in one.faults)
    predicted = [_predicted(one, measure, among) for one in explanations]
    generator, total = np.random.default_rng(2002), 0.0
    for own, weight in zip(predicted, probability, strict=True):
        drawn = own.mean + generator.standard_normal((SAMPLES, len(own.mean))) @ own.root.T
        density = np.array([other.log_density(drawn) for other in predicted])
        mixed = np.logaddexp.reduce(density + np.log(probability)[:, None], axis=0)
        total += weight * float(np.mean(own.log_density(drawn) - mixed))
    return max(total, 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Predicted:
    """Mean (m,) and lower root (m, m) of the covariance of an outcome."""

    mean: Array
    root: Array

    def log_density(self, at: Array) -> Array:
        """(s,) at the points (s, m)."""
        white = np.linalg.solve(self.root, (at - self.mean).T)
        return np.asarray(-0.5 * np.sum(white**2, axis=0) - np.log(np.diag(self.root)).sum())


def _predicted(of: Explanation, measure: Measurement, among: frozenset[str]) -> _Predicted:
    """What the explanation and Table 2 say of the outcome, in units of its noise."""
    known, outcome = answer(of.way), measure(of.way, among)
    names = tuple(dict.fromkeys([*known.names, *outcome.tolerances]))
    chosen = [known.candidates.index(one) for one in of.faults]
    own = dict(zip(known.names, known.tolerances.T, strict=True))
    told = np.column_stack([*_columns(own, names, 7), known.effects[:, chosen], np.eye(7)])
    faults = tuple(one.name for one in of.faults)
    size = len(outcome.nominal)
    M = np.column_stack([*_columns(outcome.tolerances, names, size), *_columns(outcome.effects, faults, size), outcome.reference])
    mean = np.concatenate([np.zeros(len(names)), [-1.0 if one.switch else 0.0 for one in of.faults], np.zeros(7)])
    plausible = [0.0 if one.switch else one.plausible for one in of.faults]
    sd = np.concatenate([np.ones(len(names)), plausible, deviation_of_reading()])
    T, N = told * sd, M * sd / outcome.noise[:, None]
    gain = np.linalg.solve(T @ T.T, T).T  # (p, 7), in standard deviations
    at = gain @ (DEVIATIONS - known.nominal - told @ mean)
    covariance = N @ N.T - N @ gain @ T @ N.T + np.eye(size)
    return _Predicted(mean=(outcome.nominal + M @ mean) / outcome.noise + N @ at, root=np.linalg.cholesky(covariance))


def _columns(by_name: Mapping[str, Array], names: Sequence[str], size: int) -> list[Array]:
    """Those of `names`, nothing (size,) for one that is not there."""
    return [by_name.get(name, np.zeros(size)) for name in names]


def _against(way: Way, test: Test) -> Outcome:
    """A known body on the FMD, what the tare says of the FMD taken off."""
    return _compared(test, way.tests[0])


def _compared(test: Test, before: Test) -> Outcome:
    """How much more a test reads than the one `before`."""
    one, other = forward.read(test), forward.read(before)
    difference_of = Read(
        told=one.told - other.told,
        tolerances=difference(one.tolerances, other.tolerances),
        effects=difference(one.effects, other.effects),
    )
    return _outcome(difference_of, REPEATED * scale(Inertia(parameters=other.told)))


def _outcome(of: Read, noise: Array) -> Outcome:
    return Outcome(
        nominal=of.told, tolerances=of.tolerances, effects=of.effects, reference=np.zeros((len(of.told), 7)), noise=noise
    )
