"""The four errors, each with what it means and what is to be thought of it. Figures come from the engine, thresholds are
stated here.

A chi² can be bought: tolerances swallow a fault without a trace in it, at an absurd price in themselves. So chi² and the sum
of squares of the tolerances are judged together. What tolerances cost when nothing is wrong is known: each moves from its
prior to its posterior, so that the sum of z² is expected to be sum(1 - sd²/tolerance²), the number of tolerances that the
data really tell.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from identification.self_calibration.solve import total
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import cost_of, freedom
from validation.estimation.problem import IDENTIFIED, TOLERANCES, Evaluation, Fit, Parameter, Problem
from validation.output import derived, entry, percent, two_digits

GOOD, DOUBTFUL, FAILED = VERDICTS = ("good", "doubtful", "failed")

STANDS_OUT = 4.0
"""[sd] from which a spot is no chance: the worst cell of a sound series reaches about three. Held by test_maps_and_spots.py."""

MISFIT = 1.5
"""[chi²/dof] from which data and model contradict each other, whatever the tolerances. Held by comparing/test_shown.py."""

MORE = 1.5
"""[factor] on the larger of what measurement tolerances explain and the error on fitted data, from which an error on held-out
data is too large. Held by comparing/test_shown.py."""

NOTICED = 1.05
"""[factor] on what measurement tolerances explain, from which those of modes are told. Exercised by test_maps_and_spots.py."""

UNLIKELY = 1e-3
"""[probability] of a sum of squares below which it is no chance: tolerances are absurd, or an explanation explains too little.
Held by test_classical.py."""

ABSURD = 4.0
"""[sd] of one tolerance that no careful laboratory has. Exercised by test_maps_and_spots.py."""

TOLERANCES_NAMED = 5
"""[count] of tolerances that are named. Exercised by test_maps_and_spots.py."""


@dataclass(frozen=True, kw_only=True)
class StatedError:
    """One error.

    Attributes
    ----------
    name : "nominal error"
    figure : with its unit
    meaning : a sentence
    verdict : of `VERDICTS`; empty where there is nothing to be judged
    text : the verdict in words
    """

    name: str
    figure: str
    meaning: str
    verdict: str = entry(null="", default="")
    text: str = ""


@dataclass(frozen=True, kw_only=True)
class ExplainedError:
    """What the plain error comes to by what it does not fit, when nothing is wrong.

    Attributes
    ----------
    measurement : per cent, by tolerances of the measurement
    with_modes : per cent, by these and by what the model leaves open of its modes: participation, and damping between them
    """

    measurement: float
    with_modes: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Tolerance:
    """A tolerance as a fit moved it.

    Attributes
    ----------
    parameter : whose it is
    offset : from nominal
    z : offset / tolerance
    """

    parameter: Parameter = entry("name", write=lambda of: of.name)
    offset: float = entry("offset_si")

    @property
    def moved(self) -> float:
        """How far from nominal, of a factor by what share."""
        return float(np.expm1(self.offset)) if self.parameter.logarithmic else self.offset

    @property
    @derived("tolerance_si")
    def prior(self) -> float:
        """Standard deviation of what was known beforehand."""
        return self.parameter.tolerance

    @property
    @derived("z", before="offset_si")
    def z(self) -> float:
        """In standard deviations of what was known beforehand."""
        return self.offset / self.parameter.tolerance


def tolerances(of: Fit) -> tuple[Tolerance, ...]:
    """The tolerances of a fit, the most absurd first; what is identified is one as far as anything is known of it beforehand.

    The price is without these: a laboratory has to find them. But an FMD that ends farther off than anybody
    would build one has taken what is missing elsewhere.
    """
    both = zip(of.parameters, of.offsets, strict=True)
    kinds = (*TOLERANCES, IDENTIFIED)
    found = [Tolerance(parameter=one, offset=float(x)) for one, x in both if one.kind in kinds and one.tolerance > 0]
    return tuple(sorted((one for one in found if np.isfinite(one.parameter.tolerance)), key=lambda one: -abs(one.z)))


def expected_z2(of: Fit) -> float:
    """Sum of z² that the tolerances of a fit come to when nothing is wrong."""
    prior = np.array([one.tolerance for one in of.parameters])
    counted = [one.kind in TOLERANCES and 0 < one.tolerance < np.inf for one in of.parameters]
    share = np.diag(of.covariance)[counted] / prior[counted] ** 2
    return float(np.sum(np.clip(1 - share, 0.0, 1.0)))


def absurd(of: Fit) -> bool:
    """Whether the tolerances of a fit, together or one of them, cost more than chance."""
    return costly(of.tolerance_z2, expected_z2(of), largest_z(of))


def largest_z(of: Fit) -> float:
    """|z| of the tolerance that a fit moved farthest; 0 where there is none."""
    return max((abs(one.z) for one in tolerances(of)[:1]), default=0.0)


def costly(z2: float, expected: float, largest: float) -> bool:
    """Whether a sum `z2` of z², where about `expected` is due, is more than chance, or the `largest` z of one tolerance is."""
    if largest >= ABSURD:
        return True
    if z2 <= max(expected, 1.0):  # what is due or less is never unlikely
        return False
    from scipy.special import chdtrc

    return bool(chdtrc(max(expected, 1.0), z2) < UNLIKELY)


def told(of: Evaluation, explained: ExplainedError, peak: float, due: float | None = None) -> tuple[StatedError, ...]:
    """The four errors of `of`.

    Parameters
    ----------
    explained : what the plain error would be by tolerances alone
    peak : the worst spot of the maps [sigma]
    due : as `due_misfit`
    """
    high = peak >= STANDS_OUT
    said = f"a sound laboratory would miss by up to {percent(explained.measurement)}"
    if explained.with_modes > NOTICED * explained.measurement:
        said += f", with the tolerances of its modes by up to {percent(explained.with_modes)}"
    if not high and of.plain.percent > max(explained.measurement, explained.with_modes):
        said += " beside noise"
    is_told = any(one.kind == IDENTIFIED and one.name.startswith("fmd") for one in of.plain_fit.parameters)
    plain = StatedError(
        name="plain error",
        figure=percent(of.plain.percent),
        meaning=f"sensors as calibrated; {'the FMD identified, ' * is_told}modes within what the model declares",
        verdict=FAILED if high else GOOD,
        text=f"{said}, but nowhere by {two_digits(peak)} sigma as here" if high else f"{said}, and nothing stands out",
    )
    nominal = percent(of.nominal.percent)
    as_it_stands = StatedError(name="nominal error", figure=nominal, meaning="the model as it stands, nothing fitted")
    return (as_it_stands, plain, _fitted(of.fitted, due), _held_out(of, explained, plain.verdict))


def _fitted(of: Fit, due: float | None) -> StatedError:
    ratio = misfit(of)
    moved, too_much = tolerances(of), absurd(of)
    paying = [one for one in moved if one.parameter.kind in TOLERANCES]
    far = [one for one in moved if abs(one.z) >= ABSURD][:TOLERANCES_NAMED] or paying[:1]
    worst = ", ".join(f"{one.parameter.name} by {one.z:+.1f} standard deviations" for one in far)
    if ratio > MISFIT:
        verdict, text = FAILED, "no tolerance explains the data" + (f", not even moved too far: {worst}" if too_much else "")
    elif too_much:
        verdict, text = FAILED, f"χ² is good only because the fit moved tolerances too far: {worst}"
    else:
        verdict, text = GOOD, "data and tolerances agree"
    allowed = "" if due is None else f" ({two_digits(due)} by noise alone)"
    return StatedError(
        name="fitted error",
        figure=f"χ² {ratio:.3g}, z² {two_digits(of.tolerance_z2)}",
        meaning=f"every tolerance fitted: χ² per degree of freedom{allowed}, and its prior penalty, the sum of z² of "
        f"{of.tolerances} tolerances, about {expected_z2(of):.0f} in a sound laboratory",
        verdict=verdict,
        text=text,
    )


def misfit(of: Fit) -> float:
    """Chi² per degree of freedom."""
    return of.chi2 / max(of.degrees_of_freedom, 1)


def due_misfit(of: Fit, problem: Problem, *, as_read: bool = True) -> float | None:
    """Chi² per degree of freedom that noise and tolerances come to by themselves in the fit `of` of `problem`; of shapes not
    what was read of them but what a sound model may be off counts, unless `as_read`.

    None without a table of modes: of lines by the hundred it is about 1. With J the whitened derivatives of the data, P what is
    known beforehand, C = (J^T J + P)^-1 and S the share of each variance that is noise, the residual (1 - J C J^T) (J x + n) has
    the mean square

        tr C P C J^T J + sum_b s_b (count_b - 2 tr C M_b + tr C M_b C J^T J),      M_b = J_b^T J_b of every run.
    """
    if not any(one.measured.is_real or one.measured.read is not None for one in problem.predictions):
        return None
    cost = cost_of(problem, of.parameters, FLOOR)
    by_run = cost.by_run(of.offsets)
    C, M = of.covariance, total(by_run.values(), len(of.offsets)).matrix
    known = np.array([1 / one.tolerance**2 if 0 < one.tolerance < np.inf else 0.0 for one in of.parameters])
    CM = C @ M
    found = float(np.sum((C * known) * CM.T))
    for prediction, lines, seen in cost.observed:
        read = prediction.measured.read[:, lines] if as_read and prediction.measured.read is not None else seen.noise
        variance = np.square(seen.noise) + np.square(FLOOR * seen.floor)
        counts = freedom(seen, partial(prediction.at, of.by_name, lines, derivatives=False), FLOOR)
        for k, run in enumerate(seen.runs):
            own = C @ by_run[prediction.measured.name, run].matrix
            if not (count := float(np.sum(counts[k]))):
                continue  # inputs that nobody measured take all
            share = float(np.sum(counts[k] * np.square(read[k]) / variance[k])) / count
            found += share * (count - 2 * float(np.trace(own)) + float(np.sum(own * CM.T)))
    return found / max(of.degrees_of_freedom, 1)


def _held_out(of: Evaluation, explained: ExplainedError, plain: str) -> StatedError:
    meaning = "plain error on data used only for checking, predicted and not fitted"
    # What is left where all of a configuration was held out: without a verdict, since no fit knows what it alone has
    others, before = of.held_out_configurations, of.held_out_configurations_nominal
    if others is None or before is None:
        beside: str = ""
    else:
        told = f"{percent(others.percent)}, nominal {percent(before.percent)}"
        beside = f"a configuration never seen, its modes and what acts there alone unfitted: {told}"
    if of.held_out is None:
        none = "nothing is left for checking: each set of data is one run"
        return StatedError(name="held-out error", figure="–", meaning=meaning, text=beside or none)
    high = of.held_out.percent > MORE * max(of.plain.percent, explained.measurement)
    verdict, said = GOOD, "the fit holds on data that it has not seen"
    if high:
        verdict, said = DOUBTFUL, "what was fitted does not hold there"
    elif plain == FAILED:
        verdict, said = "", "hardly larger than on what was fitted: it is the model that fails, there as here"
    return StatedError(
        name="held-out error",
        figure=percent(of.held_out.percent),
        meaning=meaning,
        verdict=verdict,
        text=f"{said}; beside it, {beside}" if beside else said,
    )
