"""The ten inertia parameters together with the elastic terms of Eq. 8b, from a measured dynamic mass and nothing else.

Poles are added one by one where they take most out of what is left (`poles`), all parameters are refined together after each
(`refine`), and a pole stays when it pays: when it lowers chi² by more than its eight parameters would by chance and model error
(Schwarz, Ann. Statist. 6 (1978) 461, with the misfit of the best model as the unit of chi²). H(0) = M_F is the extrapolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from geometry.inertia import Inertia
from identification.elastic import model, poles
from identification.elastic.lines import Lines, full, kept, lines_of
from identification.elastic.model import Layout
from identification.elastic.refine import Refined, correlation_time, effective_size, leftover, limits, linearised, refine, unit_of
from identification.elastic.terms import ElasticTerms

FLOOR = 0.002
"""Model error as a share of the level of an entry's row and column."""

MOST = 24
"""Poles at most when their number is not given."""

PATIENCE = 3
"""Poles that are tried beyond the last one that paid: a mode of two directions may need two before either does."""

OVERLAP = 100.0
"""Damping is coupled between poles nearer than this many half-power widths: farther apart a coupling of 0.4 mixes less than 0.2 %
of one mode into another. A lossy layer couples modes that are half the band apart."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """One fit of the search: `vector` of `layout`, with its chi² at the lines that say something new."""

    layout: Layout
    vector: Array
    chi2: float

    @property
    def modes(self) -> int:
        """Number of poles."""
        return self.layout.modes


@dataclass(frozen=True, eq=False, kw_only=True)
class Fitted:
    """Inertia and elastic terms that explain a dynamic mass.

    Attributes
    ----------
    parameters : (10,) of Eq. 4 about the reference point of the dynamic mass
    covariance : (10, 10) with all else estimated: noise and model error at the lines that say something new, times what the
        misfit and the lines that repeat an error make of it. Errors alike at all lines, of gains for instance, are not in it
    terms : elastic terms about the same point
    reference_point : (3,) [m]
    misfit : chi² per degree of freedom with the given noise and floor
    asymmetry : the same of H_ij - H_ji, which are equal in every structure: sensors are off where it is far above 1
    modes : number of poles
    reason : why there are as many
    history : the fits of the search, one pole more each
    residual : (6, 6) what is left over, root mean square over the lines in standard deviations, by entry
    band : (low, high) [Hz] of the lines
    converged : whether the iteration ended by itself
    layout, vector : all that was estimated, as `model.unpack` reads it
    information : (k, k) inverse covariance of the vector, the weak priors of `refine` included
    """

    parameters: Array
    covariance: Array
    terms: ElasticTerms
    reference_point: Array
    misfit: float
    asymmetry: float
    modes: int
    reason: str
    history: tuple[Trial, ...]
    residual: Array
    band: tuple[float, float]
    converged: bool
    layout: Layout
    vector: Array
    information: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", frozen(self.parameters, (10,), "parameters"))
        object.__setattr__(self, "covariance", frozen(self.covariance, (10, 10), "covariance"))
        object.__setattr__(self, "residual", frozen(self.residual, (6, 6), "residual"))

    @property
    def inertia(self) -> Inertia:
        """The ten as a noun."""
        return Inertia(parameters=self.parameters, reference_point=self.reference_point)


def fit(
    dynamic_mass: DynamicMass,
    *,
    weights: npt.ArrayLike | None = None,
    floor: float = FLOOR,
    modes: int | None = None,
    band: tuple[float, float] | None = None,
    start: Fitted | None = None,
    progress: Progress | None = None,
) -> Fitted:
    """Inertia and elastic terms of a measured `dynamic_mass`.

    Parameters
    ----------
    weights : (n, 6, 6) standard deviation of the complex noise of H, E|noise|² = sd², in the units of H; 0 when None
    floor : model error as a share of the level of row and column
    modes : number of poles; 0 takes the structure for rigid (Eq. 1 alone); None lets the data decide
    band : (low, high) [Hz], all lines when None
    start : an earlier fit, of another band for instance, to begin from
    progress : called with the share done

    Raises
    ------
    BadInput : fewer than two lines, weights of another shape or all zero with a floor of zero, a negative number of modes.
    """
    if modes is not None and modes < 0:
        problem = f"a number of poles is at least 0, found {modes}"
        raise BadInput(source="elastic fit", field="modes", problem=problem, remedy="Leave it out and the data decide")
    data = lines_of(dynamic_mass, weights, floor, band)
    thin = data.at(kept(data))
    tell = progress or (lambda share: None)
    found, history, reason = _rigid_only(thin) if modes == 0 else _searched(thin, modes, start, tell)
    tell(1.0)
    return _result(found, history, reason, data, thin, dynamic_mass.reference_point)


# --- the search ------------------------------------------------------------------------------------------------------


def _rigid_only(lines: Lines) -> tuple[Refined, list[Refined], str]:
    rigid = refine(np.zeros(10), Layout(modes=0, residual=False), lines)
    return rigid, [rigid], "rigid, as asked for"


def _searched(lines: Lines, modes: int | None, start: Fitted | None, tell: Progress) -> tuple[Refined, list[Refined], str]:
    first = Layout(modes=0) if start is None else start.layout
    at = refine(np.zeros(first.size) if start is None else start.vector, first, lines)
    tried, most = [at], MOST if modes is None else modes
    while at.layout.modes < most:
        longer = _with_one_more(at, lines)
        if longer is None:
            break
        at = longer
        tried.append(at)
        tell(min(0.95, at.layout.modes / (most if modes else 16)))
        if modes is None and _no_longer_pays(tried, lines):
            break
    return _chosen(tried, lines, modes)


def _with_one_more(at: Refined, lines: Lines) -> Refined | None:
    """The fit with the best pole of the leftover added and everything refined; None when none is one that helps."""
    for pole in poles.next_poles(at, lines):
        longer = _extended(at, pole, lines)
        if longer.chi2 < at.chi2 and np.all(_room(longer, lines) > 0):
            return longer
    return None


def _extended(at: Refined, pole: poles.Candidate, lines: Lines) -> Refined:
    parameters, terms = model.unpack(at.vector, at.layout)
    C = np.zeros((len(terms.frequency) + 1,) * 2)
    C[:-1, :-1], C[-1, -1] = terms.damping, 4 * np.pi * pole.damping_ratio * pole.frequency
    longer = ElasticTerms(
        frequency=np.append(terms.frequency, pole.frequency),
        damping=C,
        participation=np.vstack([terms.participation, pole.participation]),
        residual=terms.residual,
    )
    layout = _coupled(longer, at.layout)
    return refine(model.pack(parameters, longer, layout), layout, lines, iterations=12, accuracy=1e-3)


def _coupled(terms: ElasticTerms, before: Layout) -> Layout:
    """The layout of `terms` with damping coupled where poles overlap, and where it has been `before`."""
    now = model.layout_of(terms, widths=OVERLAP)
    return Layout(modes=now.modes, pairs=tuple(sorted({*now.pairs, *before.pairs})), residual=before.residual)


# --- the choice ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Price:
    """What a parameter must take out of chi².

    Attributes
    ----------
    unit : what one of chi² is worth, at least 1: misfit that remains with the best of the fits, times the lines it repeats itself
    parameter : logarithm of the independent numbers in the data
    """

    unit: float
    parameter: float

    def criterion(self, fit: Refined) -> float:
        """The least wins."""
        return fit.chi2 / self.unit + effective_size(fit) * self.parameter

    @property
    def pole(self) -> float:
        """Of a pole, in chi²."""
        return 8 * self.parameter * self.unit


def price_of(fits: list[Refined], lines: Lines) -> Price:
    best = min(fits, key=lambda one: _misfit(one, lines))
    repeated = correlation_time(best)
    unit = max(1.0, _misfit(best, lines) * repeated)
    return Price(unit=unit, parameter=float(np.log(lines.count / repeated if unit > 1 else lines.count)))


def _misfit(fit: Refined, lines: Lines) -> float:
    return fit.chi2 / max(lines.count - fit.layout.size, 1)


def _no_longer_pays(tried: list[Refined], lines: Lines) -> bool:
    """Whether the last `PATIENCE` poles together took less than their price, or less than a tenth of what there was to take."""
    if len(tried) <= PATIENCE:
        return False
    before, after = tried[-1 - PATIENCE], tried[-1]
    gain = before.chi2 - after.chi2
    return gain < (after.layout.size - before.layout.size) * np.log(lines.count) or gain < 0.1 * before.chi2


def _chosen(tried: list[Refined], lines: Lines, modes: int | None) -> tuple[Refined, list[Refined], str]:
    if modes is not None:
        return _converged(tried[-1], lines), tried, f"{tried[-1].layout.modes} poles, as asked for"
    price = price_of(tried, lines)
    rigid = _rigid_only(lines)[0]
    best = min([rigid, *tried], key=price.criterion)
    if best is rigid:
        return rigid, tried, "rigid: neither a pole nor a residual mass pays"
    pruned = _pruned(_converged(best, lines), lines, price)
    return pruned, tried, _why(pruned, tried, lines, price)


def _converged(at: Refined, lines: Lines) -> Refined:
    return refine(at.vector, at.layout, lines)


def _pruned(at: Refined, lines: Lines, price: Price) -> Refined:
    """Poles go, the weakest first, while that costs less than they are worth; any that became no resonance go, too."""
    while at.layout.modes:
        room = _room(at, lines)
        lost = bool(room.min() <= 0)
        weakest = int(np.argmin(room if lost else [_worth(at, r) for r in range(at.layout.modes)]))
        shorter = _without(at, weakest, lines)
        if not lost and price.criterion(shorter) > price.criterion(at):
            return at
        at = shorter
    return at


def _room(at: Refined, lines: Lines) -> Array:
    """(m,) distance of ln f and ln zeta of every pole from where a resonance ends."""
    blocks, m = at.layout.blocks, at.layout.modes
    x = at.vector[blocks["frequency"].start : blocks["damping"].stop]
    low, high = (limit[: 2 * m] for limit in limits(at.layout, lines))
    return np.asarray(np.minimum(x - low, high - x).reshape(2, m).min(axis=0, initial=np.inf))


def _worth(at: Refined, r: int) -> float:
    """What chi² would rise by without pole r, to second order in its participation, all else refitted (Wald)."""
    place = at.layout.blocks["participation"].start + 6 * r + np.arange(6)
    covariance = np.linalg.pinv(at.information)[np.ix_(place, place)]
    return float(at.vector[place] @ np.linalg.solve(covariance, at.vector[place]))


def _without(at: Refined, r: int, lines: Lines) -> Refined:
    parameters, terms = model.unpack(at.vector, at.layout)
    rest = np.delete(np.arange(at.layout.modes), r)
    fewer = model.chosen(terms, rest)
    layout = model.layout_of(fewer, widths=OVERLAP)
    return refine(model.pack(parameters, fewer, layout), layout, lines, iterations=20)


def _why(best: Refined, tried: list[Refined], lines: Lines, price: Price) -> str:
    left = f"{best.layout.modes} poles leave a misfit of {_misfit(best, lines):.3g}"
    longer = [one for one in tried if one.layout.modes > best.layout.modes]
    if not longer:
        return f"{left}; nothing else in it is a resonance"
    gain = max(best.chi2 - longer[0].chi2, 0.0)
    return f"{left}; one more would take {gain:.3g} out of chi², less than its price of {price.pole:.3g}"


# --- the result ------------------------------------------------------------------------------------------------------


def _result(found: Refined, history: list[Refined], reason: str, data: Lines, thin: Lines, reference_point: Array) -> Fitted:
    ordered, layout = model.ascending(found.vector, found.layout)
    final = refine(ordered, layout, data, iterations=20)
    parameters, terms = model.unpack(final.vector, layout)
    misfit = final.chi2 / max(data.count - layout.size, 1)
    said = linearised(final.vector, layout, thin)
    information = said.information / price_of([said], thin).unit
    deviations = np.abs(full(leftover(final.vector, layout, data) / data.deviation))
    asymmetry, pairs = data.asymmetry
    return Fitted(
        parameters=parameters,
        covariance=covariance_of_the_ten(information),
        terms=terms,
        reference_point=reference_point,
        misfit=misfit,
        asymmetry=asymmetry / pairs,
        modes=layout.modes,
        reason=reason,
        history=tuple(Trial(layout=one.layout, vector=one.vector, chi2=one.chi2) for one in history),
        residual=np.sqrt(np.mean(deviations**2, axis=0)),
        band=(float(data.frequency[0]), float(data.frequency[-1])),
        converged=found.converged and final.converged,
        layout=layout,
        vector=final.vector,
        information=information,
    )


def covariance_of_the_ten(information: Array) -> Array:
    """(10, 10) in the units of Eq. 4; everything else is estimated with them."""
    d = unit_of(information)
    covariance = np.linalg.pinv(information / np.outer(d, d), hermitian=True) / np.outer(d, d)
    unit = model.inertia_scale()
    return np.asarray(covariance[:10, :10] * np.outer(unit, unit))
