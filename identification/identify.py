"""The whole way of one identification: campaigns to spectra, spectra to a dynamic mass, and from both, two ways, ten parameters.

Both ways stand side by side in the result: the paper's own, Eqs. 6 to 11, and the self-calibrated one, in which every tolerance
of the measurement chain is estimated with them. What the data say about themselves - condition, redundancy, closed checks - is
kept with them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput, CheckFailed
from identification import cross_motion, excitation, rigid_band
from identification.base_motion import BaseMotion, base_motion
from identification.campaign import Campaign
from identification.campaign_runs import problems_of_runs
from identification.cross_motion import CrossMotion
from identification.dynamic_mass import Estimate, from_runs
from identification.evidence import Evidence, Settings, evidence_of, settings_of
from identification.excitation import Exclusions
from identification.identified import Identified
from identification.plain import plain
from identification.request import Request
from identification.resultants import Resultants, resultants
from identification.self_calibration.calibrated import calibrated
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
    _require_runs(request)
    settings = settings_of(request)
    article, *tares = _spectra(request, _between(tell, 0.0, READ))
    motion, load = base_motion(article, gravity=request.campaign.gravity), resultants(article)
    estimate = _estimate(request.campaign, load, motion, article)
    driven = excitation.exclusions(estimate.excitation, request.condition_limit)
    _require_lines(driven, request.campaign)
    resonance = _resonance(request, estimate.dynamic_mass, driven)
    left_out = driven if resonance is None or request.band is not None else _nearly_rigid(driven, article.frequency, resonance)
    used = article.at(left_out.kept)
    highest = used.frequency[-1]
    below = [tare.at(tare.frequency <= highest) if left_out is not driven else tare for tare in tares]
    evidence = evidence_of(request, used, below)
    by_paper = plain(evidence, settings, progress=_between(tell, READ, PLAIN))
    jointly, failed = _jointly(evidence, settings, _between(tell, PLAIN, CALIBRATED))
    return Identification(
        request=request,
        article=article,
        tares=tuple(tares),
        motion=motion,
        load=load,
        estimate=estimate,
        exclusions=left_out,
        crossed=_crossed(load, motion, article, estimate),
        plain=replace(by_paper, resonance=resonance),
        self_calibrated=None if jointly is None else replace(jointly, resonance=resonance),
        warnings=(*_warnings(request, article, tares), *_taken_for_rigid(resonance, used), *failed),
    )


def _require_runs(request: Request) -> None:
    """Refuse campaigns whose runs do not drive six motions, before any spectrum is made.

    Raises
    ------
    BadInput : what is missing in the article's campaign, or in a tare's.
    """
    for campaign in (request.campaign, *(tare.campaign for tare in request.tares)):
        for problem in problems_of_runs(campaign):
            raise problem


def _estimate(campaign: Campaign, load: Resultants, motion: BaseMotion, article: Spectra) -> Estimate:
    try:
        return from_runs(load.values, motion.values, article.frequency, article.table.origin)
    except BadInput as error:
        source = campaign.source
        raise BadInput(source=source, field=error.field, problem=error.problem, remedy=error.remedy) from None


def _jointly(evidence: Evidence, settings: Settings, tell: Progress) -> tuple[Identified | None, tuple[str, ...]]:
    """The self-calibrated way, which may fail where the plain one does not; why it did."""
    try:
        return calibrated(evidence, settings, progress=tell), ()
    except (CheckFailed, np.linalg.LinAlgError) as error:
        return None, (f"the self-calibrated way failed, the plain result is all there is: {error}",)


def _between(tell: Progress, start: float, end: float) -> Progress:
    return lambda share: tell(start + (end - start) * share)


def _spectra(request: Request, tell: Progress) -> list[Spectra]:
    campaigns = [request.campaign, *(tare.campaign for tare in request.tares)]
    ends = np.linspace(0.0, 1.0, len(campaigns) + 1)
    return [
        spectra(one, method=request.method, band=request.band, progress=_between(tell, *ends[k : k + 2]))
        for k, one in enumerate(campaigns)
    ]


def _require_lines(left_out: Exclusions, campaign: Campaign) -> None:
    """Refuse a campaign whose runs tell six motions apart nowhere.

    Raises
    ------
    BadInput : hardly any line is left.
    """
    if np.count_nonzero(left_out.kept) < 2:
        why = f": {'; '.join(left_out.reasons)}" if left_out.reasons else ""
        raise BadInput(
            source=campaign.source,
            field="runs",
            problem=f"the base motions are told apart at hardly any line{why}",
            remedy="Drive every one of the six axes in a run of its own, or raise --condition-limit",
        )


def _resonance(request: Request, H: DynamicMass, driven: Exclusions) -> float | None:
    """[Hz] The first resonance of what is to be taken for rigid; None where elastic terms are fitted, or nothing resonates."""
    if request.modes != 0:
        return None
    used = DynamicMass(frequency=H.frequency[driven.kept], matrix=H.matrix[driven.kept], reference_point=H.reference_point)
    return rigid_band.first_resonance(used)


def _nearly_rigid(driven: Exclusions, frequency: npt.NDArray[np.float64], resonance: float) -> Exclusions:
    """The lines of `driven` that lie below the `resonance`, as far as one would keep of them by hand."""
    stop = rigid_band.stop_below(resonance, frequency[driven.kept])
    reason = f"above {stop:.4g} Hz: a rigid body is wanted, and the first resonance stands at {resonance:.4g} Hz"
    return Exclusions(kept=driven.kept & (frequency <= stop), reasons=(*driven.reasons, reason))


def _taken_for_rigid(resonance: float | None, used: Spectra) -> list[str]:
    if resonance is None:
        return []
    low, high = used.frequency[[0, -1]]
    return [
        f"taken for rigid from {low:g} to {high:g} Hz, with its first resonance at {resonance:.4g} Hz: elasticity shifts every "
        "figure; --modes auto allows for it, --band chooses another band"
    ]


def _crossed(load: Resultants, motion: BaseMotion, article: Spectra, estimate: Estimate) -> CrossMotion | None:
    try:
        return cross_motion.cost(load.values, motion.values, article.axes, estimate)
    except BadInput:
        return None  # a pattern of several axes has no quotient


def _warnings(request: Request, article: Spectra, tares: Sequence[Spectra]) -> tuple[str, ...]:
    said = [*request.campaign.warnings, *article.warnings]
    for tare, read in zip(request.tares, tares, strict=True):
        said += [f"{tare.campaign.article}: {text}" for text in (*tare.campaign.warnings, *read.warnings)]
    processing = request.campaign.processing
    if processing is not None and processing.method != request.method and article.method != "spectra":
        asked = processing.method
        said.append(f"campaign.toml asks for {asked}, {request.method} was used; --spectra {asked} follows the file")
    return tuple(dict.fromkeys(said))
