"""The whole way of one identification: campaigns to spectra, spectra to a dynamic mass, and from both, two ways, ten parameters.

Both ways stand side by side in the result: the paper's own, Eqs. 6 to 11, and the self-calibrated one, in which every tolerance
of the measurement chain is estimated with them. What the data say about themselves - condition, redundancy, closed checks - is
kept with them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.inertia import Inertia
from identification import dynamic_mass
from identification.base_motion import BaseMotion, Exclusions, Resultants, base_motion, resultants
from identification.campaign import problems_of_runs
from identification.consistency import Finding
from identification.dynamic_mass import CrossMotion, Estimate, from_runs
from identification.plain import covariance_of, of_tares, plain, tolerances_of
from identification.request import Evidence, Identified, Known, Request, Settings, TareSpectra, evidence_of, settings_of
from identification.self_calibration.fit import calibrated, fitted, identified
from identification.self_calibration.likelihood import Rows, normal
from identification.self_calibration.problem import Assembly, Part, assembled, of_fmd
from identification.self_calibration.solve import inverse
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import spectra

Progress = Callable[[float], None]
"""Told the share that is done."""

READ, PLAIN, CALIBRATED = 0.2, 0.4, 0.9
"""Shares of the work that are done with the spectra, with the plain way, with the self-calibrated one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Identification:
    """All that an identification found.

    Attributes
    ----------
    request : what was asked
    article, tares : spectra of the campaigns, excluded lines still in them
    motion, load : base motions and resultants of the article's campaign about F, with what is redundant
    estimate : dynamic mass of the whole set-up, FMD included, and the condition number at every line
    exclusions : lines that were left out, and why
    crossed : what the quotient of the driven axis would have cost; None where runs drive several axes
    plain, self_calibrated : the article's ten parameters about F, both ways; None where the joint fit failed
    warnings : sentences
    """

    request: Request
    article: Spectra
    tares: tuple[Spectra, ...]
    motion: BaseMotion
    load: Resultants
    estimate: Estimate
    exclusions: Exclusions
    crossed: CrossMotion | None
    plain: Identified
    self_calibrated: Identified | None
    warnings: tuple[str, ...]


def identify(request: Request, progress: Progress | None = None) -> Identification:
    """Everything that `request` asks for.

    Raises
    ------
    BadInput : as `spectra`, `from_runs`, `calibrated`; tare and article of different hardware without `any_hardware`; hardly a
        line left.
    CheckFailed : an estimate that does not settle.
    """
    tell = progress or (lambda share: None)
    campaigns = [request.campaign, *(tare.campaign for tare in request.tares)]
    for problem in (problem for campaign in campaigns for problem in problems_of_runs(campaign)):
        raise problem  # runs that do not drive six motions, before any spectrum is made
    ends = np.linspace(0.0, READ, len(campaigns) + 1)
    article, *tares = (
        spectra(one, method=request.method, band=request.band, progress=_between(tell, *ends[k : k + 2]))
        for k, one in enumerate(campaigns)
    )
    motion, load = base_motion(article, gravity=request.campaign.gravity), resultants(article)
    try:
        estimate = from_runs(load.values, motion.values, article.frequency, article.table.origin)
    except BadInput as error:
        source = request.campaign.source
        raise BadInput(source, error.field, error.problem, error.remedy) from None
    left_out = estimate.excitation.excluded(request.condition_limit)
    if np.count_nonzero(left_out.kept) < 2:
        why = f": {'; '.join(left_out.reasons)}" if left_out.reasons else ""
        said = f"the base motions are told apart at hardly any line{why}"
        remedy = "Drive every one of the six axes in a run of its own, or raise --condition-limit"
        raise BadInput(request.campaign.source, "runs", said, remedy)

    # What is to be taken for rigid is cut well below its first resonance, as far as one would keep of it by hand
    warnings = [*request.campaign.warnings, *article.warnings]
    for tare, read in zip(request.tares, tares, strict=True):
        warnings += [f"{tare.campaign.article}: {text}" for text in (*tare.campaign.warnings, *read.warnings)]
    processing = request.campaign.processing
    if processing is not None and processing.method != request.method and article.method != "spectra":
        asked = processing.method
        warnings.append(f"campaign.toml asks for {asked}, {request.method} was used; --spectra {asked} follows the file")
    warnings = list(dict.fromkeys(warnings))
    resonance = None
    if request.modes == 0:
        H, kept = estimate.dynamic_mass, left_out.kept
        resonance = first_resonance(replace(H, frequency=H.frequency[kept], matrix=H.matrix[kept]))
    if resonance is not None and request.band is None:
        lines = article.frequency[left_out.kept]
        stop = max(STOP * resonance, float(lines[min(FEWEST, len(lines)) - 1]))
        reason = f"above {stop:.4g} Hz: a rigid body is wanted, and the first resonance stands at {resonance:.4g} Hz"
        left_out = Exclusions(kept=left_out.kept & (article.frequency <= stop), reasons=(*left_out.reasons, reason))
        highest = article.frequency[left_out.kept][-1]
        below = [tare.at(tare.frequency <= highest) for tare in tares]
    else:
        below = tares
    used = article.at(left_out.kept)
    if resonance is not None:
        low, high = used.frequency[[0, -1]]
        warnings.append(
            f"taken for rigid from {low:g} to {high:g} Hz, with its first resonance at {resonance:.4g} Hz: elasticity shifts "
            "every figure; --modes auto allows for it, --band chooses another band"
        )

    evidence, settings = evidence_of(request, used, below), settings_of(request)
    by_paper = plain(evidence, settings, progress=_between(tell, READ, PLAIN))
    try:
        jointly = calibrated(evidence, settings, progress=_between(tell, PLAIN, CALIBRATED))
    except (CheckFailed, np.linalg.LinAlgError) as error:
        jointly = None
        warnings.append(f"the self-calibrated way failed, the plain result is all there is: {error}")
    try:
        crossed = dynamic_mass.cost(load.values, motion.values, article.axes, estimate)
    except BadInput:
        crossed = None  # a pattern of several axes has no quotient
    return Identification(
        request=request,
        article=article,
        tares=tuple(tares),
        motion=motion,
        load=load,
        estimate=estimate,
        exclusions=left_out,
        crossed=crossed,
        plain=replace(by_paper, resonance=resonance),
        self_calibrated=None if jointly is None else replace(jointly, resonance=resonance),
        warnings=tuple(warnings),
    )


# Where a structure that is taken for rigid still nearly is: below the first resonance that its dynamic mass shows.
#
# A rigid body's dynamic mass is the same at every line (Eq. 1). One diagonal entry that has grown by half is on its way to a
# resonance, and the largest value before it falls again is where it stands; one that grows up to the last line resonates beyond
# it. Elasticity raises it by about (f / f1)² below that, so that a few per cent remain in a band that ends well below.

GROWN = 1.5
"""Of its size at the low end, from which an entry of the dynamic mass rises towards a resonance: no sensor is as wrong."""

FALLEN = 0.7
"""Of its largest value so far, below which an entry has passed its peak: noise alone does not throw it down so far."""

STOP = 0.6
"""Where a rigid band ends, as a share of the first resonance."""

LOW_END = 0.05
"""Share of the lines that is their low end."""

FEWEST = 10
"""Lines that a band keeps however low the resonance: fewer cannot tell how far the result still moves with the band."""


def first_resonance(dynamic_mass: DynamicMass) -> float | None:
    """The lowest frequency [Hz] at which a diagonal entry of `dynamic_mass` peaks; the last line where one grows to the end.

    None where nothing resonates in sight of the band.
    """
    found = []
    for size in np.abs(np.diagonal(dynamic_mass.matrix, axis1=1, axis2=2)).T:
        level = float(np.median(size[: max(int(LOW_END * len(size)), 3)]))
        grown = np.flatnonzero(size > GROWN * level)
        if len(grown):
            rising = size[grown[0] :]
            fallen = np.flatnonzero(rising < FALLEN * np.maximum.accumulate(rising))
            found.append(int(grown[0] + np.argmax(rising[: fallen[0]] if len(fallen) else rising)))
    return float(dynamic_mass.frequency[min(found)]) if found else None


def _between(tell: Progress, start: float, end: float) -> Progress:
    return lambda share: tell(start + (end - start) * share)


# What a campaign that has not been run would tell: the covariance of the joint fit at its own solution, before any data.
#
# The likelihood of the joint fit needs no measured numbers to say how sharp it is, only what is planned: channels, base motions,
# noise, tolerances and about what the article will be. The covariance (J^T J + priors)^-1 is linearised at the planned truth;
# the spectra handed in are those that exact channels would read. A sensor is left out by its weight, zero in every campaign.


@dataclass(frozen=True, eq=False, kw_only=True)
class Expected:
    """What a planned campaign would tell about the article's ten parameters about F.

    Attributes
    ----------
    best : self-calibrated, with everything that is planned
    plain : by Eqs. 6 to 11 from the same
    untared : (10, 10) covariance when there is no tare and the FMD is known as before; None where none is planned anyway
    without : by channel, (10, 10) covariance when it is lost in all campaigns
    """

    best: Identified
    plain: Identified
    untared: Array | None
    without: Mapping[str, Array]

    def __post_init__(self) -> None:
        object.__setattr__(self, "without", MappingProxyType(dict(self.without)))


def expected(
    evidence: Evidence, settings: Settings, fmd: Known, *, lost: bool = True, progress: Callable[[float], None] | None = None
) -> Expected:
    """What `evidence`, planned and exact, would tell.

    Parameters
    ----------
    fmd : what is known of the FMD without any tare
    lost : whether every channel is left out in turn
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : channels that do not tell six motions and six loads.
    """
    tell = progress or (lambda share: None)
    plainly = plain(evidence, settings, progress=lambda share: tell(0.3 * share))
    problem = assembled(evidence, settings)
    tell(0.4)
    solution = fitted(problem, settings, progress=lambda share: tell(0.4 + 0.2 * share))
    # By campaign how its channels answer to everything at the planned truth, which no weight changes
    planned = [
        (part, part.rows(problem.layout, solution.x), part.selection(problem.layout)) for part in problem.parts(settings.floor)
    ]
    names = problem.campaigns[0].chain.names if lost else ()
    without = {}
    for k, name in enumerate(names):
        tell(0.6 + 0.4 * k / len(names))
        without[name] = covariance(problem, [_information(*one, blind=name) for one in planned])
    untared = None
    if evidence.tares:
        before = np.zeros((len(problem.layout), len(problem.layout)))  # information about the FMD that was there before
        at = problem.layout.at(problem.campaigns[0].structure.bodies[0].block)
        before[at, at] = inverse(fmd.covariance)
        untared = covariance(problem, [_information(*planned[0]), before])
    tell(1.0)
    return Expected(best=identified(problem, solution, settings), plain=plainly, untared=untared, without=without)


def covariance(problem: Assembly, information: Sequence[Array]) -> Array:
    """(10, 10) of the article's parameters from `information` (k, k) about the joint vector, and the priors."""
    rows, article = problem.layout.knowledge[0], problem.layout.at("article")
    return inverse(np.sum(information, axis=0) + rows.T @ rows)[article, article]


def _information(part: Part, rows: Rows, selection: Array, blind: str | None = None) -> Array:
    """J^T J (k, k) of a campaign, to which the channel `blind` says nothing."""
    observed = part.observed
    if blind is not None:
        weight = observed.weight.copy()
        weight[:, :, part.chain.names.index(blind)] = 0.0
        observed = replace(observed, weight=weight)
    return np.asarray(selection.T @ normal(observed, rows).matrix @ selection)


# The FMD by itself, to be carried with its covariance into what is identified later (`Evidence.fmd`).

_DEFAULT = Settings()


def fmd(
    tares: Sequence[TareSpectra],
    settings: Settings = _DEFAULT,
    *,
    self_calibrated: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Known:
    """The FMD's ten parameters about F from `tares`, self-calibrated or by Eqs. 6 to 11, with their covariance.

    Raises
    ------
    BadInput : no tare, or tares of different hardware.
    """
    if not tares:
        raise BadInput("tare", "tares", "the FMD needs a campaign on a known article", "Add one")
    stated = sorted({tare.hardware for tare in tares if tare.hardware})
    if len(stated) > 1:
        problem = f"one FMD is asked for, found campaigns of {', '.join(stated)}"
        raise BadInput("tare", "campaign.hardware", problem, "Give those of one hardware")
    if self_calibrated:
        joint = of_fmd(tares, settings)
        found = identified(joint, fitted(joint, settings, progress=progress), settings)
        return Known(inertia=found.inertia, covariance=found.covariance)
    by_paper = of_tares(list(tares), settings)
    tolerances = tolerances_of(tares[0].spectra, settings)
    return Known(inertia=Inertia(parameters=by_paper.ten), covariance=covariance_of(by_paper, tolerances))


# Whether the data bear the figures that came out of them: what contradicts itself is said before any interval.
#
# An interval holds where the model does. Channels that disagree, a misfit far above what noise and model error leave, tolerances
# that had to be bent far beyond what a laboratory is off by, a fit that did not settle: each says that the model does not hold,
# and then no interval is worth its digits. Simulated laboratories with ordinary tolerances leave a misfit of 0.8 to 1.2 and a
# mean z² of 0.7 to 1.2; a channel in a wrong unit leaves hundreds.

MISFIT = 3.0
"""chi² per degree of freedom up to which noise and model error are what they were taken for."""

BENT = 3.0
"""Mean z² of the tolerances up to which they were bent no farther than those of an ordinary laboratory."""

BROKEN = 10.0
"""Tolerances beyond which a closed check without a suspect speaks against the data.

279 sound campaigns reached 3.6; spectra in files, whose noise is not known and counts as 0, a few more.
"""

TRUSTWORTHY, ELASTIC = "trustworthy", "dominated by elasticity"
"""How the verdicts begin that a failed model takes back, and those that have named the reason themselves."""

CORRECT = "correct the channel (`unit`, `direction`, or its name in the files) in campaign.toml and identify again"


def contradictions(checks: Iterable[Finding]) -> tuple[str, ...]:
    """Closed checks that fail, in words: a channel that is suspected by name, else everything that does not hold."""
    failed = [one for one in checks if not one.holds]
    named = [one.text for one in failed if one.suspects]
    return tuple(named or (one.text for one in failed if one.value > BROKEN or one.name == "diagonal"))


def failures(one: Identified) -> tuple[str, ...]:
    """What the fit itself says against its model, in words."""
    said = []
    if one.misfit > MISFIT:  # false where noise is not known
        said.append(f"the fit leaves {sqrt(one.misfit):.3g} times what noise and model error explain: the model does not hold")
    if one.tolerances and one.surprise > BENT * one.tolerances:
        rms = sqrt(one.surprise / one.tolerances)
        moved = f"the fit moved the {one.tolerances} tolerances by {rms:.3g} of their standard deviations (rms)"
        said.append(f"{moved}, farther than a sound laboratory is off: the model does not hold")
    if not one.converged:
        said.append("the fit did not converge")
    return tuple(said)


def judged(told: Mapping[str, str], against: tuple[str, ...], failed: tuple[str, ...]) -> dict[str, str]:
    """The verdicts `told`, behind what speaks against all of them.

    Parameters
    ----------
    against : contradictions of the data, which come first in every verdict
    failed : failures of the fit; elasticity is a reason for these, so a verdict that names it stays
    """
    made = {}
    for name, said in told.items():
        reasons = against or (() if said.startswith(ELASTIC) else failed)
        if not reasons:
            made[name] = said
        else:
            advice = CORRECT if reasons[0].startswith("it looks as if") else "see what `massline check` says of the channels"
            kept = "" if said.startswith(TRUSTWORTHY) else f"; {said}"
            made[name] = f"not trustworthy: {reasons[0]}; {advice}{kept}"
    return made
