"""Band study: how far the ten parameters move with the band and with the number of poles - the quality that the paper asks for.

A parameter that inertia fixes does not know where a band begins and ends, nor how many poles describe the rest. One that moves is
made of how elasticity is modelled. Every cell is a fit of its own, begun from the fit of the whole band but free of it. Cells
that leave their data unexplained are drawn but do not count, nor do those whose own noise hides what is asked for.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import PARAMETERS, Inertia
from identification.elastic import fit as elastic
from identification.elastic import model
from identification.elastic.fit import FLOOR, REACH, Fitted, Lines, Trial
from identification.elastic.model import ElasticLayout

LIMIT = 0.01
"""Spread, in the scale of a parameter, up to which it is trusted."""

EXPLAINED = 2.0
"""Misfit, in units of the best of the same band and of 1, up to which a cell explains its data."""

FEWEST = 3
"""Cells that a verdict takes."""

NARROWEST = 1.25
"""Ratio of the ends of a band."""

LOWER = 4
"""Stops of the rigid way below those of the others."""

QUANTITIES = ("mass_kg", "cog_x_m", "cog_y_m", "cog_z_m", "moi_xx_kgm2", "moi_yy_kgm2", "moi_zz_kgm2")
"""What a stability map draws: CoG from the reference point, moments about the CoG."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StudiedFit:
    """One fit.

    Attributes
    ----------
    band : (low, high) [Hz]
    count : number of poles that was asked for; 0 is the rigid way
    modes : how many of them are within reach of the band
    parameters : (10,) of Eq. 4 about the reference point
    covariance : (10, 10) of these, from noise and model error
    misfit : chi² per degree of freedom
    plausible : whether it explains its data as well as the best of its band does
    """

    band: tuple[float, float]
    count: int
    modes: int
    parameters: Array
    covariance: Array
    misfit: float
    plausible: bool = False

    @property
    def deviation(self) -> Array:
        """(10,) standard deviations."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True, eq=False, kw_only=True)
class BandStudy:
    """Results over start and stop of the band and over the number of poles.

    Attributes
    ----------
    starts, stops : (s,), (e,) [Hz]
    counts : (c,) numbers of poles, 0 first
    cells : those that were fitted
    fitted : the fit of the whole band
    """

    starts: Array
    stops: Array
    counts: tuple[int, ...]
    cells: tuple[StudiedFit, ...]
    fitted: Fitted

    def map(self, of: str = "parameters") -> Array:
        """(s, e, c, 10) `parameters` or `deviation`, (s, e, c, 10, 10) `covariance`, (s, e, c) `misfit` or `plausible`.

        nan where no band was fitted.
        """
        ends = {"parameters": (10,), "deviation": (10,), "covariance": (10, 10), "misfit": (), "plausible": ()}[of]
        out = np.full((len(self.starts), len(self.stops), len(self.counts), *ends), np.nan)
        for cell in self.cells:
            out[self._place(cell)] = getattr(cell, of)
        return out

    @property
    def quantities(self) -> Array:
        """(s, e, c, 7) in the order of `QUANTITIES`, nan where no band was fitted or a mass is not above zero."""
        out = np.full((len(self.starts), len(self.stops), len(self.counts), 7), np.nan)
        for cell in self.cells:
            if cell.parameters[0] > 0:
                inertia = Inertia(parameters=cell.parameters)
                out[self._place(cell)] = np.concatenate([[inertia.mass], inertia.cog, inertia.moments_cog])
        return out

    @property
    def scale(self) -> Array:
        """(10,) what a parameter's spread is measured by: mass, mass times the radius of gyration, moments about the CoG."""
        inertia = self.fitted.inertia
        moments = np.abs(inertia.moments_cog)
        radius = np.sqrt(moments.sum() / 2 / inertia.mass)
        products = [np.sqrt(moments[i] * moments[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
        return np.array([inertia.mass, *3 * [inertia.mass * radius], *moments, *products])

    def spread(self, *, rigid: bool = False) -> Array:
        """(10,) how far nine of ten cells stay within of the result, for `rigid` half the range of the rigid way.

        Only cells count that explain their data and know the parameter to half of `LIMIT`; nan where they are too few.
        """
        if rigid:
            return np.asarray(np.ptp([cell.parameters for cell in self.cells if cell.count == 0], axis=0) / 2)
        counted = [cell for cell in self.cells if cell.plausible]
        if not counted:
            return np.full(10, np.nan)
        away = np.array([np.abs(cell.parameters - self.fitted.parameters) for cell in counted])
        telling = np.array([cell.deviation <= LIMIT / 2 * self.scale for cell in counted])
        enough = telling.sum(axis=0) >= FEWEST
        return np.array([np.quantile(away[telling[:, k], k], 0.9) if enough[k] else np.nan for k in range(10)])

    def verdicts(self, *, rigid: bool = False) -> Mapping[str, str]:
        """In words, by parameter; `rigid` judges the way without elastic terms."""
        shares = self.spread(rigid=rigid) / self.scale
        made = {}
        for name, share in zip(PARAMETERS, shares, strict=True):
            moved_by = float(share)
            if np.isnan(moved_by):
                made[name] = "not identifiable from this data: too few bands explain it; record a wider band, or with less noise"
            else:
                moved = f"{100 * moved_by:.2g} % of its scale over the bands" + ("" if rigid else " and numbers of poles")
                if moved_by <= LIMIT:
                    made[name] = f"trustworthy: it moves by {moved}"
                else:
                    add = "take the elastic terms" if rigid else "record lower frequencies, or take weighing and pendulum as data"
                    made[name] = f"dominated by elasticity: it moves by {moved}; {add}"
        return made

    def _place(self, cell: StudiedFit) -> tuple[int, int, int]:
        low, high = cell.band
        return int(np.argmin(np.abs(self.starts - low))), int(np.argmin(np.abs(self.stops - high))), self.counts.index(cell.count)


def study(
    dynamic_mass: DynamicMass,
    *,
    weights: npt.ArrayLike | None = None,
    floor: float = FLOOR,
    starts: Sequence[float] | None = None,
    stops: Sequence[float] | None = None,
    counts: Sequence[int] | None = None,
    fitted: Fitted | None = None,
    progress: Callable[[float], None] | None = None,
) -> BandStudy:
    """Fit every band from `starts` to `stops` [Hz] with every number of poles in `counts`.

    Parameters
    ----------
    weights, floor : as for `fit`
    starts, stops : four and five within the lines when None; the rigid way ends lower, too, down to where hardly a band is left
    counts : the rigid way, the number that `fitted` has, one less and one more when None; numbers that the search of `fitted` did
        not try are left out
    fitted : fit of the whole band, made here when None
    progress : called with the share done

    Raises
    ------
    BadInput : as `fit`; no band with at least a ratio of 1.25 between its ends.
    """
    tell = progress or (lambda share: None)
    whole = fitted or elastic.fit(dynamic_mass, weights=weights, floor=floor, progress=lambda share: tell(0.3 * share))
    low, high = whole.band
    middle = (high / low) ** 0.45
    first = np.geomspace(low, low * middle, 4) if starts is None else np.asarray(starts, dtype=np.float64)
    last = np.geomspace(high / middle, high, 5) if stops is None else np.asarray(stops, dtype=np.float64)
    # By the number of poles the fit to begin from; the rigid way first
    known = {one.modes: one for one in whole.history if one.layout.residual}
    if whole.layout.residual:
        known[whole.modes] = Trial(layout=whole.layout, vector=whole.vector, chi2=np.nan)
    wanted = range(max(whole.modes - 1, 1), whole.modes + 2) if counts is None else counts
    rigid = Trial(layout=ElasticLayout(modes=0, residual=False), vector=np.zeros(10), chi2=np.nan)
    trials = {0: rigid, **{count: known[count] for count in wanted if count in known and count > 0}}
    # Further stops for the rigid way, which is right but far below the first mode: down to the narrowest band of all
    lower = (
        (np.geomspace(NARROWEST * first[0], last[0], LOWER + 1)[:-1] if last[0] > NARROWEST * first[0] else np.zeros(0))
        if stops is None
        else np.zeros(0)
    )
    bands = _bands(first, last)
    if not bands:
        problem = f"no band ends above {NARROWEST:g} of its start"
        raise BadInput("band study", "", problem, "Widen the band, or leave the study out")
    cells: list[StudiedFit] = []
    for k, band in enumerate(bands):
        data = elastic.lines_of(dynamic_mass, weights, floor, band)
        found = [_cell(count, trial, data, band) for count, trial in trials.items()]
        explained = EXPLAINED * max(min(cell.misfit for cell in found), min(whole.misfit, 1.0), 1.0)
        cells += [replace(cell, plausible=cell.misfit <= explained) for cell in found]
        tell(0.3 + 0.7 * (k + 1) / len(bands))
    # Nothing tells here whether the rigid way explains its data, so that these cells are drawn and judge nothing.
    cells += [_cell(0, trials[0], elastic.lines_of(dynamic_mass, weights, floor, band), band) for band in _bands(first, lower)]
    return BandStudy(starts=first, stops=np.concatenate([lower, last]), counts=tuple(trials), cells=tuple(cells), fitted=whole)


def _bands(starts: Array, stops: Array) -> list[tuple[float, float]]:
    return [(float(low), float(high)) for low in starts for high in stops if high >= NARROWEST * low]


def _cell(count: int, trial: Trial, data: Lines, band: tuple[float, float]) -> StudiedFit:
    thin = data.at(elastic.kept(data))
    if count:
        # The poles of a trial within reach of the band; of those above, the static share goes to the residual mass
        parameters, terms = model.unpack(trial.vector, trial.layout)
        f, L = terms.frequency, terms.participation
        near = (f > REACH[0] * band[0]) & (f < REACH[1] * band[1])
        above = L[f >= REACH[1] * band[1]] / (2 * np.pi * f[f >= REACH[1] * band[1], None])
        left = model.chosen(replace(terms, residual=terms.residual + above.T @ above), np.flatnonzero(near))
        place = np.cumsum(near) - 1
        pairs = tuple((int(place[r]), int(place[s])) for r, s in trial.layout.pairs if near[r] and near[s])
        layout = ElasticLayout(modes=int(near.sum()), pairs=pairs)
        start = model.pack(parameters, left, layout)
    else:
        layout, start = trial.layout, trial.vector
    found = elastic.refine(start, layout, thin, iterations=15, accuracy=1e-4)
    return StudiedFit(
        band=band,
        count=count,
        modes=layout.modes,
        parameters=model.unpack(found.vector, layout)[0],
        covariance=elastic.covariance_of_the_ten(found.information / elastic.price_of([found], thin).unit),
        misfit=found.chi2 / max(thin.count - layout.size, 1),
    )
